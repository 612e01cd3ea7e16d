#include "passes/lpv_sweep.h"

#include <algorithm>
#include <vector>

#include "compute/device.h"
#include "passes/lpv_specular.h"
#include "passes/sweep_directions.h"
#include "passes/vpl_list.h"
#include "shared/lpv_sweep_types.h"

namespace lightwell {
namespace {

constexpr std::size_t kRun = 64;  // LW_SWEEP_RUN of the kernels
constexpr Range kListGroup{16, 1};
constexpr Range kCellGroup{16, 4};
constexpr const char* kInject = "lpv_sweep/lpv_sweep_inject";
constexpr const char* kCover = "lpv_sweep/lpv_sweep_cover";
constexpr const char* kSweep = "lpv_sweep/lpv_sweep";

Range runsOf(std::uint64_t count) { return gridOver(std::size_t((count + kRun - 1) / kRun)); }

// So that as many of the largest number do not overflow 63 bits.
cl_int bitsFor(std::uint64_t lights) {
    cl_int bits = 62;
    for (std::uint64_t n = 1; n < lights; n *= 2) --bits;
    return bits;
}

std::uint64_t cellsOf(const LpvSweepOptions& o) { return std::uint64_t(o.size) * o.size * o.size; }
std::uint64_t lightBytes(const LpvSweepOptions& o) { return cellsOf(o) * (2 * LW_SWEEP_SOURCES + 1) * sizeof(cl_uint); }
std::uint64_t areaBytes(const LpvSweepOptions& o) { return cellsOf(o) * (2 * LW_SWEEP_BLOCKS + 1) * sizeof(cl_uint); }
std::uint64_t sourceBytes(const LpvSweepOptions& o) { return cellsOf(o) * LW_SWEEP_ORDERS * LW_SWEEP_SOURCES * sizeof(float); }
std::uint64_t sheetBytes(const LpvSweepOptions& o) { return cellsOf(o) * LW_SWEEP_ORDERS * LW_SWEEP_BLOCKS * sizeof(float); }
std::uint64_t usedBytes(const LpvSweepOptions& o) { return std::uint64_t(LW_SWEEP_ORDERS) * o.size * o.size * 2 * sizeof(cl_uint); }
std::uint64_t carriedBytes(const LpvSweepOptions& o) {
    return std::uint64_t(o.directions) * LW_SWEEP_COLOURS * std::uint64_t(sweep_plane(lw_int(o.size))) * sizeof(float);
}
std::uint64_t partBytes(const LpvSweepOptions& o) { return cellsOf(o) * LW_SWEEP_GROUPS * LW_SWEEP_PARTS * sizeof(float); }
std::uint64_t sideBytes(const LpvSweepOptions& o) {
    return cellsOf(o) * LW_SWEEP_ORDERS * LW_SWEEP_SIDES * LW_SWEEP_COLOURS * sizeof(float);
}
std::uint64_t packedBytes(const LpvSweepOptions& o) { return cellsOf(o) * LW_SWEEP_CELL * sizeof(float); }
std::uint64_t tableBytes(const LpvSweepOptions& o) { return std::uint64_t(o.directions) * LW_SWEEP_DIRECTION * sizeof(float); }

}  // namespace

LpvSweep::LpvSweep(Device& device, const LpvSweepOptions& options)
    : device_(device),
      options_(options),
      injectTexels_(device.programs().kernel(kInject, "lpv_sweep_inject_texels")),
      injectVpls_(device.programs().kernel(kInject, "lpv_sweep_inject_vpls")),
      unit_(device.programs().kernel(kInject, "lpv_sweep_unit")),
      relight_(device.programs().kernel(kInject, "lpv_sweep_relight")),
      begin_(device.programs().kernel(kCover, "lpv_sweep_begin")),
      clear_(device.programs().kernel(kCover, "lpv_sweep_clear")),
      coverTexels_(device.programs().kernel(kCover, "lpv_sweep_cover_texels")),
      coverSurfels_(device.programs().kernel(kCover, "lpv_sweep_cover_surfels")),
      resolve_(device.programs().kernel(kSweep, "lpv_sweep_resolve")),
      march_(device.programs().kernel(kSweep, "lpv_sweep_march")),
      combine_(device.programs().kernel(kSweep, "lpv_sweep_combine")),
      pack_(device.programs().kernel(kSweep, "lpv_sweep_pack")),
      gather_(device.programs().kernel("lpv_sweep/lpv_sweep_read", "lpv_sweep_gather")) {}

void LpvSweep::reserve(Executor& executor) {
    if (totalCells_) return;
    const auto make = [&](std::uint64_t bytes, const char* what) { return Buffer(device_, std::size_t(bytes), what); };
    const auto cleared = [&](std::uint64_t bytes, const char* what) {
        Buffer buffer = make(bytes, what);
        executor.fill("lpv_sweep.clear", buffer, 0, 0, buffer.bytes());
        return buffer;
    };
    const std::vector<float> table = sweepTable(sweepDirections(options_.directions));
    directions_ = make(tableBytes(options_), "directions of sweeps");
    executor.writeCopy("lpv_sweep.upload", directions_, 0, directions_.bytes(), table.data());
    lights_ = make(lightBytes(options_), "sums of light");
    areas_ = cleared(areaBytes(options_), "sums of area");
    cover_ = cleared(sizeof(LwSweepCover), "state of what covers");
    sources_ = make(sourceBytes(options_), "light that cells send");
    sheets_ = make(sheetBytes(options_), "cover of cells");
    used_ = make(usedBytes(options_), "normals of rows");
    carried_ = make(carriedBytes(options_), "planes of light");
    parts_ = make(partBytes(options_), "light that arrives in cells");
    sides_ = make(sideBytes(options_), "light that arrives at cells' sides");
    outside_ = cleared(sizeof(cl_uint), "lights outside of the grid");
    largest_ = make(sizeof(cl_uint), "the most that arrives");
    place_ = cleared(sizeof(LwLpvPlace), "place of a sweep");
    unitPlace_ = cleared(sizeof(LwLpvPlace), "place of a bounce");
    shownPlace_ = cleared(sizeof(LwLpvPlace), "place of what is shown");
    if (options_.bounces > 1) bounceCells_ = make(packedBytes(options_), "cells of a bounce");
    if (options_.frames > 1) shownCells_ = make(packedBytes(options_), "cells that are shown");
    totalCells_ = make(packedBytes(options_), "cells of sweeps");
}

void LpvSweep::recordCover(Executor& executor, const LpvSweepInput& input) {
    const bool hasSurfels = input.surfels.count > 0;
    const std::uint64_t revision = hasSurfels ? input.surfels.revision : 0;
    executor.run("lpv_sweep.begin", begin_, {1, 1}, {1, 1}, place_, cl_uint(revision), cl_uint(revision >> 32),
                 cl_int(input.restart || !hasSurfels ? 1 : 0), cover_);
    const auto vectors = std::size_t(areaBytes(options_) / (16 * sizeof(cl_uint)));
    executor.run("lpv_sweep.clear", clear_, gridOver(vectors), kListGroup, areas_, cl_int(vectors), cover_);
    if (hasSurfels) {
        const Planes& planes = input.surfels.planes;
        executor.run("lpv_sweep.cover", coverSurfels_, runsOf(input.surfels.count), kListGroup, planes.memory,
                     cl_int(planes.planeStride), cl_int(input.surfels.count), place_, cl_int(options_.size),
                     cl_float(input.areaScale), cover_, areas_);
    } else if (input.rsms.texels) {
        executor.run("lpv_sweep.cover", coverTexels_, runsOf(input.rsms.texels.width), kListGroup, input.rsms.texels,
                     cl_int(input.rsms.texels.width), place_, cl_int(options_.size), 1.0f, cover_, areas_);
    }
}

void LpvSweep::recordLights(Executor& executor, const LpvSweepInput& input) {
    executor.fill("lpv_sweep.clear", lights_, 0, 0, lights_.bytes());
    executor.fill("lpv_sweep.clear", outside_, 0, 0, outside_.bytes());
    if (input.rsms.texels)
        executor.run("lpv_sweep.inject", injectTexels_, runsOf(input.rsms.texels.width), kListGroup, input.rsms.texels,
                     cl_int(input.rsms.texels.width), place_, cl_int(options_.size), lights_, outside_);
    if (input.authoredCount)
        executor.run("lpv_sweep.inject", injectVpls_, runsOf(input.authoredCount), kListGroup, input.authored,
                     cl_int(input.authoredCount), place_, cl_int(options_.size), lights_, outside_);
}

void LpvSweep::recordRelight(Executor& executor, const SurfelSet& surfels) {
    executor.fill("lpv_sweep.clear", lights_, 0, 0, lights_.bytes());
    executor.run("lpv_sweep.unit", unit_, {1, 1}, {1, 1}, place_, largest_, bitsFor(surfels.count), unitPlace_);
    if (surfels.count == 0) return;
    const Buffer& last = bounce_ == 1 ? totalCells_ : bounceCells_;
    executor.run("lpv_sweep.relight", relight_, runsOf(surfels.count), kListGroup, surfels.planes.memory,
                 cl_int(surfels.planes.planeStride), cl_int(surfels.count), unitPlace_, cl_int(options_.size), last, lights_);
}

void LpvSweep::recordResolve(Executor& executor, const Buffer& place) {
    const std::size_t size = options_.size;
    executor.run("lpv_sweep.resolve", resolve_, {size, LW_SWEEP_ORDERS * size}, {4, 1}, lights_, areas_, place,
                 cl_int(size), sources_, sheets_, used_);
}

void LpvSweep::recordGroups(Executor& executor, std::uint32_t count) {
    executor.run("lpv_sweep.march", march_, {count, 1}, {1, 1}, sources_, sheets_, used_, directions_,
                 cl_int(options_.directions / LW_SWEEP_GROUPS), cl_int(options_.size), cl_int(nextGroup_), cl_int(count), carried_,
                 parts_);
    nextGroup_ += count;
}

// What arrived in all groups becomes cells to read.
void LpvSweep::recordBounce(Executor& executor) {
    const std::size_t size = options_.size;
    const bool isFirst = bounce_ == 0;
    executor.fill("lpv_sweep.clear", largest_, 0, 0, largest_.bytes());
    const std::size_t vectors = std::size_t(cellsOf(options_)) / combine_.width();
    executor.run("lpv_sweep.combine", combine_, {vectors, LW_SWEEP_ORDERS * LW_SWEEP_SIDES * LW_SWEEP_COLOURS}, {64, 1}, parts_, cl_int(size), sides_);
    executor.run("lpv_sweep.pack", pack_, {size, size * size}, kCellGroup, sides_, sheets_, cl_int(size), cl_int(isFirst ? 0 : 1),
                 isFirst ? totalCells_ : bounceCells_, totalCells_, largest_);
    nextGroup_ = 0;
    ++bounce_;
}

void LpvSweep::record(Executor& executor, const LpvSweepInput& input) {
    reserve(executor);
    const bool all = input.restart || !isShown_ || options_.frames == 1;
    if (all) nextGroup_ = bounce_ = 0;
    const std::uint32_t step = all ? LW_SWEEP_GROUPS : LW_SWEEP_GROUPS / options_.frames;
    do {
        if (nextGroup_ == 0 && bounce_ == 0) {
            executor.copy("lpv_sweep.place", input.place.get(), place_.get(), 0, 0, sizeof(LwLpvPlace));
            recordCover(executor, input);
            recordLights(executor, input);
            recordResolve(executor, place_);
        } else if (nextGroup_ == 0) {
            recordRelight(executor, input.surfels);
            recordResolve(executor, unitPlace_);
        }
        if (nextGroup_ == 0 && input.specular) input.specular->recordPackSweep(executor, {sources_, sheets_, used_}, bounce_ > 0);
        recordGroups(executor, step);
        if (nextGroup_ == LW_SWEEP_GROUPS) recordBounce(executor);
    } while (all && bounce_ < options_.bounces);
    if (bounce_ < options_.bounces) return;
    bounce_ = 0;
    isShown_ = true;
    executor.copy("lpv_sweep.place", place_.get(), shownPlace_.get(), 0, 0, sizeof(LwLpvPlace));
    if (options_.frames > 1) std::swap(totalCells_, shownCells_);
    if (input.specular) input.specular->show(executor);
}

void LpvSweep::recordGather(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                            const Planes& validity, const Buffer& counts) {
    // A kernel's argument must be some memory, also where it is not touched.
    const auto orElse = [&](const Planes& planes) { return planes ? planes : position; };
    const Range items{(position.width + gather_.width() - 1) / gather_.width(), position.height};
    executor.run("lpv_sweep.gather", gather_, items, gather_.width() == 1 ? Range{64, 1} : Range{8, 1}, position, normal,
                 cl_int(position.width), cl_int(position.height), shownPlace_, cl_int(options_.size),
                 options_.frames > 1 ? shownCells_ : totalCells_, cl_int(irradiance ? 1 : 0), cl_int(validity ? 1 : 0),
                 orElse(irradiance), orElse(validity), counts);
}

std::uint64_t LpvSweep::bytes() const {
    std::uint64_t total = 0;
    for (const Buffer* b : {&directions_, &lights_, &areas_, &cover_, &sources_, &sheets_, &used_, &carried_, &parts_, &sides_, &outside_,
                            &largest_, &place_, &unitPlace_, &shownPlace_, &bounceCells_, &totalCells_, &shownCells_})
        total += b->bytes();
    return total;
}

std::uint64_t LpvSweep::estimateBytes(const LpvSweepOptions& o) {
    const std::uint64_t cellSets = 1 + (o.bounces > 1 ? 1 : 0) + (o.frames > 1 ? 1 : 0);
    return tableBytes(o) + lightBytes(o) + areaBytes(o) + sizeof(LwSweepCover) + sourceBytes(o) + sheetBytes(o) + usedBytes(o) +
           carriedBytes(o) + partBytes(o) + sideBytes(o) + 2 * sizeof(cl_uint) + 3 * sizeof(LwLpvPlace) + cellSets * packedBytes(o);
}

}  // namespace lightwell
