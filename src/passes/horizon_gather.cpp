#include "passes/horizon_gather.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "compute/device.h"
#include "inputs/camera.h"

namespace lightwell {
namespace {

Range groupOf(const Kernel& kernel) { return kernel.width() == 1 ? Range{64, 1} : Range{8, 1}; }

Range itemsOver(std::uint32_t width, std::uint32_t height, const Kernel& kernel) {
    return {(width + kernel.width() - 1) / kernel.width(), height};
}

Defines definesOf(const HorizonGatherOptions& options) {
    return {{"LW_LIGHT", options.light ? "1" : "0"}, {"LW_UNIFORM", options.uniform ? "1" : "0"}};
}

lw_horizon_view viewOf(const Camera& camera, const HorizonRanges& ranges, const HorizonPatternOptions& pattern,
                       std::uint32_t turn, std::uint32_t fullHeight) {
    const glm::dvec3 i = camera.rays().perI, j = camera.rays().perJ;
    lw_horizon_view view{};
    view.eye = float4(camera.eye().x, camera.eye().y, camera.eye().z, camera.perspective() ? 1.0 : 0.0);
    view.axis = float4(camera.axis().x, camera.axis().y, camera.axis().z, ranges.ambientRadius);
    // Shares of the image's height become shares of the depth, or lengths where there is no perspective.
    view.perI = float4(i.x, i.y, i.z, ranges.thickness * glm::length(j) * fullHeight);
    view.perJ = float4(j.x, j.y, j.z, glm::length(j) * fullHeight);
    view.slices = cl_int(pattern.directions / pattern.rows);
    view.rows = cl_int(pattern.rows);
    // Every pixel takes all rows of slices in turn, and each of the 64 pairs of shifts once.
    view.turn = cl_int(turn % 64);
    view.rounding = float(0.9 * std::fmod(0.6180339887 * turn, 1.0));
    return view;
}

}  // namespace

void HorizonTables::prepare(Executor& executor, const HorizonPatternOptions& options, double reachPixels, double every,
                            const PyramidLevels& pyramid) {
    const std::uint32_t first = pyramid.options().firstLevel;
    const Planes base = pyramid.level(first);
    if (reachPixels == reach_ && base.width == width_ && base.height == height_) return;
    HorizonPattern pattern = horizonPattern(options, reachPixels, every);
    for (lw_horizon_step& step : pattern.steps) {
        const Planes level = pyramid.level(first + std::uint32_t(step.level));
        step.columns = cl_int(level.width);
        step.rows = cl_int(level.height);
        step.first = cl_int(level.offset);
        step.rowStride = cl_int(level.rowStride);
        step.planeStride = cl_int(level.planeStride);
    }
    const std::size_t sliceBytes = pattern.slices.size() * sizeof pattern.slices[0];
    const std::size_t stepBytes = pattern.steps.size() * sizeof pattern.steps[0];
    slices_.reserve(executor.device(), sliceBytes, "slices of the horizon gather");
    steps_.reserve(executor.device(), stepBytes, "steps of the horizon gather");
    executor.writeCopy("horizon_gather.upload", slices_, 0, sliceBytes, pattern.slices.data());
    executor.writeCopy("horizon_gather.upload", steps_, 0, stepBytes, pattern.steps.data());
    reach_ = reachPixels;
    width_ = base.width;
    height_ = base.height;
}

std::uint64_t HorizonTables::estimateBytes(const HorizonPatternOptions& options, double reachPixels) {
    const HorizonPattern pattern = horizonPattern(options, reachPixels, 1.0);
    return pattern.slices.size() * sizeof pattern.slices[0] + pattern.steps.size() * sizeof pattern.steps[0];
}

HorizonGather::HorizonGather(Device& device, const HorizonGatherOptions& options)
    : options_(options),
      gather_(device.programs().kernel("horizon_gather/horizon_gather", "horizon_gather_gather", definesOf(options))) {}

void HorizonGather::recordGather(Executor& executor, const PyramidLevels& pyramid, std::uint32_t fullHeight,
                                 const Camera& camera, const HorizonRanges& ranges, const HorizonTables& tables,
                                 std::uint32_t turn, const Planes& gathered) {
    executor.run(options_.light ? "horizon_gather.gather" : "horizon_gather.gather_ambient", gather_,
                 itemsOver(gathered.width, gathered.height, gather_), groupOf(gather_), pyramid.level(pyramid.options().firstLevel),
                 cl_int(gathered.width), cl_int(gathered.height), tables.slices(), tables.steps(),
                 viewOf(camera, ranges, options_.pattern, turn, fullHeight), gathered);
}

}  // namespace lightwell
