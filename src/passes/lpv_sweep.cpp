#include "passes/lpv_sweep.h"

#include <algorithm>
#include <initializer_list>
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

LpvSweep::LpvSweep(Device& device, const LpvSweepOptions& options, const LpvSweep* sharing)
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
      coverTriangles_(device.programs().kernel(kCover, "lpv_sweep_cover_triangles")),
      resolve_(device.programs().kernel(kSweep, "lpv_sweep_resolve")),
      march_(device.programs().kernel(kSweep, "lpv_sweep_march")),
      combine_(device.programs().kernel(kSweep, "lpv_sweep_combine")),
      pack_(device.programs().kernel(kSweep, "lpv_sweep_pack")),
      gather_(device.programs().kernel("lpv_sweep/lpv_sweep_read", "lpv_sweep_gather")),
      harmonics_(device.programs().kernel("lpv_sweep/lpv_sweep_read", "lpv_sweep_harmonics")),
      scratch_(sharing ? sharing->scratch_ : std::make_shared<Scratch>()),
      ownsScratch_(!sharing),
      ownsFlights_(!sharing || options.frames > 1) {
    flights_[kAll] = ownsFlights_ ? std::make_shared<Flight>() : sharing->flights_[kAll];
    flights_[kOuter] = options.frames > 1 && options.hasInner ? std::make_shared<Flight>() : flights_[kAll];
}

void LpvSweep::reserve(Flight& flight) const {
    if (flight.parts) return;
    const auto make = [&](std::uint64_t bytes, const char* what) { return Buffer(device_, std::size_t(bytes), what); };
    flight.sources = make(sourceBytes(options_), "light that cells send");
    flight.sheets = make(sheetBytes(options_), "cover of cells");
    flight.used = make(usedBytes(options_), "normals of rows");
    flight.parts = make(partBytes(options_), "light that arrives in cells");
}

void LpvSweep::reserve(Executor& executor) {
    if (totalCells_) return;
    const auto make = [&](std::uint64_t bytes, const char* what) { return Buffer(device_, std::size_t(bytes), what); };
    const auto cleared = [&](std::uint64_t bytes, const char* what) {
        Buffer buffer = make(bytes, what);
        executor.fill("lpv_sweep.clear", buffer, 0, 0, buffer.bytes());
        return buffer;
    };
    if (!scratch_->sides) {
        const std::vector<float> table = sweepTable(sweepDirections(options_.directions));
        scratch_->directions = make(tableBytes(options_), "directions of sweeps");
        executor.writeCopy("lpv_sweep.upload", scratch_->directions, 0, scratch_->directions.bytes(), table.data());
        scratch_->lights = make(lightBytes(options_), "sums of light");
        scratch_->carried = make(carriedBytes(options_), "planes of light");
        scratch_->sides = make(sideBytes(options_), "light that arrives at cells' sides");
    }
    for (const std::shared_ptr<Flight>& flight : flights_) reserve(*flight);
    areas_ = cleared(areaBytes(options_), "sums of area");
    cover_ = cleared(sizeof(LwSweepCover), "state of what covers");
    outside_ = cleared(sizeof(cl_uint), "lights outside of the grid");
    largest_ = make(sizeof(cl_uint), "the most that arrives");
    place_ = cleared(sizeof(LwLpvPlace), "place of a sweep");
    unitPlace_ = cleared(sizeof(LwLpvPlace), "place of a bounce");
    shownPlace_ = cleared(sizeof(LwLpvPlace), "place of what is shown");
    if (options_.hasInner) outerLargest_ = make(sizeof(cl_uint), "the most that arrives from outside");
    if (options_.hasInner) outerCells_ = make(packedBytes(options_), "cells of light from outside");
    if (options_.bounces > 1) bounceCells_ = make(packedBytes(options_), "cells of a bounce");
    if (options_.frames > 1) shownCells_ = make(packedBytes(options_), "cells that are shown");
    totalCells_ = make(packedBytes(options_), "cells of sweeps");
}

void LpvSweep::recordCover(Executor& executor, const LpvSweepInput& input) {
    const bool hasTriangles = input.triangles != nullptr, hasSurfels = input.surfels.count > 0;
    const std::uint64_t revision = hasTriangles ? input.triangles->revision : hasSurfels ? input.surfels.revision : 0;
    executor.run("lpv_sweep.begin", begin_, {1, 1}, {1, 1}, place_, cl_uint(revision), cl_uint(revision >> 32),
                 cl_int(input.restart || !(hasTriangles || hasSurfels) ? 1 : 0), cl_int(hasTriangles ? 1 : 0), cl_int(options_.size),
                 cover_);
    const std::size_t size = options_.size;
    executor.run("lpv_sweep.clear", clear_, {size, size * size}, kCellGroup, areas_, cl_int(size), cover_);
    if (hasTriangles) {
        const GeometryInput& geometry = *input.triangles;
        executor.run("lpv_sweep.cover", coverTriangles_, gridOver(geometry.nodeCount), kListGroup, geometry.nodes,
                     cl_int(geometry.nodeCount), geometry.triangles.memory, cl_int(geometry.triangles.planeStride), place_,
                     cl_int(size), cover_, areas_);
    } else if (hasSurfels) {
        const Planes& planes = input.surfels.planes;
        executor.run("lpv_sweep.cover", coverSurfels_, runsOf(input.surfels.count), kListGroup, planes.memory,
                     cl_int(planes.planeStride), cl_int(input.surfels.count), place_, cl_int(options_.size),
                     cl_float(input.areaScale), cover_, areas_);
    } else if (input.rsms.texels) {
        executor.run("lpv_sweep.cover", coverTexels_, runsOf(input.rsms.texels.width), kListGroup, input.rsms.texels,
                     cl_int(input.rsms.texels.width), place_, cl_int(options_.size), 1.0f, cover_, areas_);
    }
}

void LpvSweep::recordLights(Executor& executor, const LpvSweepInput& input, const Buffer* inner) {
    const Buffer& left = inner ? *inner : place_;  // a kernel's argument must be some memory
    const cl_int hasInner = inner ? 1 : 0;
    executor.fill("lpv_sweep.clear", scratch_->lights, 0, 0, scratch_->lights.bytes());
    executor.fill("lpv_sweep.clear", outside_, 0, 0, outside_.bytes());
    if (input.rsms.texels)
        executor.run("lpv_sweep.inject", injectTexels_, runsOf(input.rsms.texels.width), kListGroup, input.rsms.texels,
                     cl_int(input.rsms.texels.width), place_, left, hasInner, cl_int(options_.size), scratch_->lights, outside_);
    if (input.authoredCount)
        executor.run("lpv_sweep.inject", injectVpls_, runsOf(input.authoredCount), kListGroup, input.authored,
                     cl_int(input.authoredCount), place_, left, hasInner, cl_int(options_.size), scratch_->lights, outside_);
}

void LpvSweep::recordRelight(Executor& executor, const SurfelSet& surfels, const Buffer* inner) {
    executor.fill("lpv_sweep.clear", scratch_->lights, 0, 0, scratch_->lights.bytes());
    executor.run("lpv_sweep.unit", unit_, {1, 1}, {1, 1}, place_, largest_, bitsFor(surfels.count), unitPlace_);
    if (surfels.count == 0) return;
    executor.run("lpv_sweep.relight", relight_, runsOf(surfels.count), kListGroup, surfels.planes.memory,
                 cl_int(surfels.planes.planeStride), cl_int(surfels.count), unitPlace_, inner ? *inner : place_,
                 cl_int(inner ? 1 : 0), cl_int(options_.size), bounceCells(), scratch_->lights);
}

void LpvSweep::recordResolve(Executor& executor, const Buffer& place, const Flight& flight, LpvRest* rest) {
    if (rest) rest->begin(executor);
    const std::size_t size = options_.size;
    executor.run("lpv_sweep.resolve", resolve_, {size, LW_SWEEP_ORDERS * size}, {4, 1}, scratch_->lights, areas_, cover_, place,
                 cl_int(size), flight.sources, flight.sheets, flight.used, cl_int(rest ? 1 : 0), rest ? rest->changed() : outside_);
    if (rest) rest->decide(executor, place, &cover_, isWhole_ && isSameSky_);
    isWhole_ = false;
}

void LpvSweep::recordGroups(Executor& executor, const Flight& flight, const LpvRest* rest) {
    executor.run("lpv_sweep.march", march_, {step_, 1}, {1, 1}, flight.sources, flight.sheets, flight.used, scratch_->directions,
                 cl_int(options_.directions / LW_SWEEP_GROUPS), cl_int(options_.size), cl_int(nextGroup_), cl_int(step_),
                 scratch_->carried, flight.parts, bounce_ == 0 ? environment_ : cl_float4{}, rest ? rest->state() : place_,
                 cl_int(rest ? 1 : 0));
}

// What arrived in all groups becomes cells to read.
void LpvSweep::recordBounce(Executor& executor, Field field, const LpvRest* rest) {
    const std::size_t size = options_.size;
    const bool adds = field == kAll && bounce_ > 0;
    const Flight& flight = *flights_[field];
    const Buffer& largest = field == kAll ? largest_ : outerLargest_;
    const Buffer& cells = field == kOuter ? outerCells_ : adds ? bounceCells_ : totalCells_;
    const Buffer& state = rest ? rest->state() : place_;
    const cl_int watches = rest ? 1 : 0;
    executor.fill("lpv_sweep.clear", largest, 0, 0, largest.bytes());
    const std::size_t vectors = std::size_t(cellsOf(options_)) / combine_.width();
    executor.run("lpv_sweep.combine", combine_, {vectors, LW_SWEEP_ORDERS * LW_SWEEP_SIDES * LW_SWEEP_COLOURS}, {64, 1},
                 flight.parts, cl_int(size), scratch_->sides, state, watches);
    executor.run("lpv_sweep.pack", pack_, {size, size * size}, kCellGroup, scratch_->sides, flight.sheets, cl_int(size),
                 cl_int(adds ? 1 : 0), cells, totalCells_, largest, state, watches);
}

bool LpvSweep::begin(Executor& executor, bool restart) {
    reserve(executor);
    if (kept_.moves(executor))
        for (const Buffer* place : {&place_, &unitPlace_, &shownPlace_}) kept_.move(executor, *place, {});
    kept_.arrive(executor);
    const bool all = restart || !isShown_ || options_.frames == 1;
    if (all) nextGroup_ = bounce_ = 0;
    step_ = all ? LW_SWEEP_GROUPS : LW_SWEEP_GROUPS / options_.frames;
    return all;
}

void LpvSweep::recordStart(Executor& executor, const LpvSweepInput& input) {
    executor.copy("lpv_sweep.place", input.place.get(), place_.get(), 0, 0, sizeof(LwLpvPlace));
    const cl_float4 before = environment_;
    for (std::size_t k = 0; k < LW_SWEEP_COLOURS; ++k) environment_.s[k] = input.environment ? input.environment[k] : 0.0f;
    isSameSky_ = std::equal(before.s, before.s + LW_SWEEP_COLOURS, environment_.s);
    recordCover(executor, input);
}

// Light from outside first: its surfels read what arrived in all, which the next bounce's takes the place of.
bool LpvSweep::recordPart(Executor& executor, const LpvSweepInput& input, const Buffer* inner) {
    const bool isLast = nextGroup_ + step_ == LW_SWEEP_GROUPS;
    for (const Field field : {kOuter, kAll}) {
        if (field == kOuter && !options_.hasInner) continue;
        const Flight& flight = *flights_[field];
        if (nextGroup_ == 0 && bounce_ == 0)
            recordLights(executor, input, field == kOuter ? inner : nullptr);
        else if (nextGroup_ == 0)
            recordRelight(executor, input.surfels, field == kOuter ? inner : nullptr);
        if (nextGroup_ == 0) recordResolve(executor, bounce_ == 0 ? place_ : unitPlace_, flight, input.rest);
        if (nextGroup_ == 0 && field == kAll && input.specular)
            input.specular->recordPackSweep(executor, sources(), bounce_ > 0);
        recordGroups(executor, flight, input.rest);
        if (isLast) recordBounce(executor, field, input.rest);
    }
    nextGroup_ = isLast ? 0 : nextGroup_ + step_;
    if (isLast) ++bounce_;
    return isLast;
}

void LpvSweep::recordEnd(Executor& executor, LpvSpecular* specular) {
    bounce_ = 0;
    isShown_ = true;
    executor.copy("lpv_sweep.place", place_.get(), shownPlace_.get(), 0, 0, sizeof(LwLpvPlace));
    if (options_.frames > 1) std::swap(totalCells_, shownCells_);
    if (specular) specular->complete();
}

void LpvSweep::record(Executor& executor, const LpvSweepInput& input) {
    const bool all = begin(executor, input.restart);
    do {
        if (isAtStart()) recordStart(executor, input);
        recordPart(executor, input, nullptr);
    } while (all && !isDone());
    if (isDone()) recordEnd(executor, input.specular);
    isWhole_ = true;
}

void LpvSweep::recordGather(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                            const Planes& validity, const Buffer& counts, const Buffer* places, LpvLayer layer) {
    // A kernel's argument must be some memory, also where it is not touched.
    const auto orElse = [&](const Planes& planes) { return planes ? planes : position; };
    const Range items{(position.width + gather_.width() - 1) / gather_.width(), position.height};
    executor.run("lpv_sweep.gather", gather_, items, gather_.width() == 1 ? Range{64, 1} : Range{8, 1}, position, normal,
                 cl_int(position.width), cl_int(position.height), places ? *places : shownPlace_, cl_int(layer.index),
                 cl_int(layer.count), cl_int(options_.size), cells(), cl_int(irradiance ? 1 : 0), cl_int(validity ? 1 : 0),
                 orElse(irradiance), orElse(validity), counts);
}

void LpvSweep::recordHarmonics(Executor& executor, const Planes& position, const Planes& normal, const Harmonics& harmonics,
                               const Planes& validity, const Buffer& counts, const Buffer* places, LpvLayer layer) {
    // A kernel's argument must be some memory, also where it is not touched.
    const auto orElse = [&](const Planes& planes) { return planes ? planes : position; };
    const Range items{(position.width + harmonics_.width() - 1) / harmonics_.width(), position.height};
    executor.run("lpv_sweep.harmonics", harmonics_, items, harmonics_.width() == 1 ? Range{64, 1} : Range{8, 1}, position,
                 orElse(normal), cl_int(normal ? 1 : 0), cl_int(position.width), cl_int(position.height),
                 places ? *places : shownPlace_, cl_int(layer.index), cl_int(layer.count), cl_int(options_.size), cells(), cl_int(harmonics ? 1 : 0), cl_int(validity ? 1 : 0), orElse(harmonics.first),
                 harmonics.band, orElse(validity), counts);
}

std::uint64_t LpvSweep::bytes() const {
    std::uint64_t total = 0;
    const auto add = [&](std::initializer_list<const Buffer*> buffers) {
        for (const Buffer* b : buffers) total += b->bytes();
    };
    add({&areas_, &cover_, &outside_, &largest_, &outerLargest_, &place_, &unitPlace_, &shownPlace_, &bounceCells_, &totalCells_,
         &shownCells_, &outerCells_});
    if (ownsScratch_) add({&scratch_->directions, &scratch_->lights, &scratch_->carried, &scratch_->sides});
    for (int f = 0; f < kFields; ++f) {
        const Flight& flight = *flights_[f];
        if (f == kAll ? ownsFlights_ : flights_[f] != flights_[kAll])
            add({&flight.sources, &flight.sheets, &flight.used, &flight.parts});
    }
    return total;
}

std::uint64_t LpvSweep::estimateBytes(const LpvSweepOptions& o, std::uint32_t grids) {
    const std::uint64_t flight = sourceBytes(o) + sheetBytes(o) + usedBytes(o) + partBytes(o), fields = 2 * grids - 1;
    const std::uint64_t cellSets = 1 + (o.bounces > 1 ? 1 : 0) + (o.frames > 1 ? 1 : 0);
    const std::uint64_t own = areaBytes(o) + sizeof(LwSweepCover) + 2 * sizeof(cl_uint) + 3 * sizeof(LwLpvPlace) +
                              cellSets * packedBytes(o);
    const std::uint64_t outer = sizeof(cl_uint) + packedBytes(o);
    return tableBytes(o) + lightBytes(o) + carriedBytes(o) + sideBytes(o) + (o.frames > 1 ? fields : 1) * flight + grids * own +
           (grids - 1) * outer;
}

}  // namespace lightwell
