#include "passes/lpv_pyramid.h"

#include <algorithm>

#include "compute/device.h"
#include "passes/lpv_plane_layers.h"
#include "shared/lpv_types.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "lpv_pyramid/lpv_pyramid";
constexpr Range kCellGroup{16, 4};

Range cellsOf(std::uint32_t size) { return {size, std::size_t(size) * size}; }

}  // namespace

std::uint32_t LpvPyramid::levelsOf(std::uint32_t size) {
    std::uint32_t levels = 1;
    while (size >> levels >= kCoarsest) ++levels;
    return levels;
}

std::uint32_t LpvPyramid::stepsOn(std::uint32_t level, std::uint32_t size, std::uint32_t steps) {
    if (steps > 0) return steps;
    return level + 1 == levelsOf(size) ? kCoarsestSteps : kFewSteps;
}

LpvPyramid::LpvPyramid(Device& device, std::uint32_t size, std::uint32_t steps)
    : device_(device),
      steps_(steps),
      coarserPlace_(device.programs().kernel(kProgram, "lpv_pyramid_place")),
      down_(device.programs().kernel(kProgram, "lpv_pyramid_down")),
      up_(device.programs().kernel(kProgram, "lpv_pyramid_up")) {
    for (std::uint32_t level = 0; level < levelsOf(size); ++level)
        levels_.push_back({size >> level, LpvPropagation(device, size >> level), Buffer(), Buffer()});
}

const Buffer& LpvPyramid::record(Executor& executor, const Buffer& injected, const Buffer& place, const Blockers& blockers) {
    const auto count = std::uint32_t(levels_.size());
    std::vector<const Buffer*> sums;
    for (std::uint32_t i = 0; i < count; ++i) {
        Level& level = levels_[i];
        if (i > 0) {
            const Level& finer = levels_[i - 1];
            if (!level.injected) {
                level.injected = LpvPropagation::makeGrid(executor, level.size, "light of a coarser grid");
                level.place = Buffer(device_, sizeof(LwLpvPlace), "place of a coarser grid");
            }
            executor.run("lpv_pyramid.place", coarserPlace_, {1, 1}, {1, 1}, i > 1 ? finer.place : place, level.place);
            executor.run("lpv_pyramid.down", down_, cellsOf(level.size), kCellGroup, finer.propagation.before(), *sums.back(),
                         cl_int(level.size), level.injected);
        }
        const std::uint32_t steps = stepsOn(i, levels_.front().size, steps_);
        sums.push_back(&level.propagation.record(executor, i > 0 ? level.injected : injected, steps,
                                                 blockers(i, i > 0 ? level.place : place)));
    }
    for (std::uint32_t i = count; i-- > 0;) {
        const bool isFirst = i == 0, hasCoarse = i + 1 < count;
        if (isFirst && !hasCoarse) break;
        executor.run("lpv_pyramid.up", up_, cellsOf(levels_[i].size), kCellGroup, *sums[i], isFirst ? injected : levels_[i].injected,
                     cl_int(isFirst ? 1 : 0), hasCoarse ? *sums[i + 1] : injected, cl_int(hasCoarse ? 1 : 0),
                     cl_int(levels_[i].size));
    }
    return *sums.front();
}

std::uint64_t LpvPyramid::bytes() const {
    std::uint64_t total = 0;
    for (const Level& level : levels_) total += level.propagation.bytes() + level.place.bytes() + level.injected.bytes();
    return total;
}

std::uint64_t LpvPyramid::estimateBytes(std::uint32_t size, std::uint32_t steps) {
    std::uint64_t total = 0;
    for (std::uint32_t level = 0; level < levelsOf(size); ++level)
        total += LpvPropagation::estimateBytes(size >> level, stepsOn(level, size, steps)) +
                 (level ? LpvPropagation::gridBytes(size >> level) + sizeof(LwLpvPlace) : 0);
    return total;
}

namespace {

// As the kernels do it, of a plane's layers: four cells of each of two layers become one.
LpvPlaneLayers coarser(const LpvPlaneLayers& fine) {
    LpvPlaneLayers result((fine.c0.size() - 2) / 2);
    for (std::size_t j = 1; j + 1 < result.c0.size(); ++j) {
        result.c0[j] = 4.0 * (fine.c0[2 * j - 1] + fine.c0[2 * j]);
        result.c1[j] = 4.0 * (fine.c1[2 * j - 1] + fine.c1[2 * j]);
    }
    return result;
}

void addCoarser(LpvPlaneLayers& fine, const LpvPlaneLayers& coarse) {
    const double last = double(coarse.c0.size() - 3);
    for (std::size_t j = 1; j + 1 < fine.c0.size(); ++j) {
        const double inside = std::clamp(0.5 * double(j - 1) - 0.25, 0.0, last);
        const auto lower = std::size_t(std::min(inside, last - 1.0));
        const double share = inside - double(lower);
        fine.c0[j] += 0.25 * ((1.0 - share) * coarse.c0[lower + 1] + share * coarse.c0[lower + 2]);
        fine.c1[j] += 0.25 * ((1.0 - share) * coarse.c1[lower + 1] + share * coarse.c1[lower + 2]);
    }
}

}  // namespace

double LpvPyramid::calibration(std::uint32_t size, std::uint32_t steps, bool isBlocked) {
    std::vector<LpvPlaneLayers> sums;
    LpvPlaneLayers moving = LpvPlaneLayers::plane(size);
    for (std::uint32_t level = 0; level < levelsOf(size); ++level) {
        if (level > 0) moving = coarser(moving);
        LpvPlaneLayers sum = level > 0 ? LpvPlaneLayers(moving.c0.size() - 2) : moving;
        for (std::uint32_t i = 0; i < stepsOn(level, size, steps); ++i) {
            moving = moving.stepped(isBlocked);
            sum.add(moving);
        }
        sums.push_back(sum);
    }
    for (std::size_t level = sums.size() - 1; level > 0; --level) addCoarser(sums[level - 1], sums[level]);
    return sums.front().calibration();
}

}  // namespace lightwell
