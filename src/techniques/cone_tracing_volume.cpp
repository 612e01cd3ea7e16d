#include "techniques/cone_tracing_volume.h"

#include <algorithm>
#include <cstddef>

#include "compute/device.h"
#include "techniques/cone_tracing_view.h"

namespace lightwell {
namespace {

// Cells that grids are snapped to: all levels but the top three stay where they are in the world while a grid moves.
std::uint32_t unitOf(const LWConeTracingDesc& desc) { return desc.size / 8; }

std::uint32_t brickCount(std::uint32_t size) { return std::uint32_t(voxel_table(lw_int(size), 1)); }
std::uint32_t mipBrickCount(std::uint32_t size) { return std::uint32_t(voxel_table_size(lw_int(size))) - brickCount(size); }

// A sparse grid's first guess, before counts come back: bricks in two boxes' sides, each with its upper neighbours, whose aprons
// it fills. All of a small grid's.
std::uint32_t firstSlots(std::uint32_t size) {
    const std::uint32_t side = size / LW_VOXEL_BRICK;
    return std::min(brickCount(size), std::max(512u, 12 * side * side));
}
std::uint32_t firstMipSlots(std::uint32_t size) { return std::min(mipBrickCount(size), firstSlots(size) / 2); }

bool isEndless(const LWConeTracingDesc& desc) { return desc.bounces == 0; }

// Light that voxels send on is smooth: as many cones as pixels have, but no more than nine.
ConeGatherOptions bounceOptions(const LWConeTracingDesc& desc) {
    ConeGatherOptions options = coneOptions(desc);
    options.cones = std::min(options.cones, 9u);
    options.interleaved = options.near = false;
    return options;
}

VoxelVolume volumeOf(const LWConeTracingDesc& desc) {
    VoxelVolume volume;
    volume.size = desc.size;
    volume.cascades = desc.cascades;
    volume.mode = desc.mode;
    volume.sparse = desc.sparse != 0;
    volume.sides = coneSides(desc);
    return volume;
}

}  // namespace

ConeTracingVolume::ConeTracingVolume(Device& device, const LWConeTracingDesc& desc, int hidden)
    : device_(device),
      desc_(desc),
      surfaces_(device, desc, hidden),
      places_(device, desc.size, unitOf(desc), desc.cascades),
      volume_(volumeOf(desc)),
      baseSlots_(firstSlots(desc.size)),
      mipSlots_(firstMipSlots(desc.size)) {
    for (std::uint32_t c = 0; c < desc.cascades; ++c) {
        grids_.push_back(std::make_unique<VoxelGrid>(device, desc.size, desc.sparse != 0));
        mips_.push_back(std::make_unique<VoxelMips>(device, desc.size, c));
        lights_.push_back(std::make_unique<VoxelLight>(device, desc.size, c));
        wanted_.push_back(std::make_unique<LateRead<LwVoxelWork>>());
        if (isEndless(desc)) receivers_.push_back(std::make_unique<VoxelReceivers>(device, desc.size));
    }
    if (!isEndless(desc)) return;
    bounce_ = std::make_unique<ConeGather>(device, bounceOptions(desc));
    bounceCounts_ = Buffer(device, ConeGather::kCounts * sizeof(cl_int), "counts of further bounces");
}

void ConeTracingVolume::check(const LWFrame& frame) {
    surfaces_.check(frame);
    RsmInput::check(device_, frame);
    box_.look(frame);
}

GridPlacement ConeTracingVolume::placementOf(const LWFrame& frame, bool refit) const {
    GridPlacement placement;
    placement.extent = desc_.extent;
    placement.hasBox = box_.isSome();
    placement.refit = refit;
    placement.hasFocus = frame.focus != nullptr;
    for (int a = 0; a < 3; ++a) {
        placement.centre[a] = float(double(desc_.center[a]) - frame.worldOrigin[a]);
        placement.low[a] = box_.low()[a];
        placement.high[a] = box_.high()[a];
        placement.focus[a] = frame.focus ? frame.focus[a] : 0.0f;
    }
    return placement;
}

// Room for what frames have wanted, and a quarter more.
void ConeTracingVolume::growSlots() {
    for (const auto& wanted : wanted_) {
        const LwVoxelWork* work = wanted->take();
        if (!work || !volume_.sparse) continue;
        const auto base = std::uint32_t(work->baseWanted), mips = std::uint32_t(work->mipsWanted);
        if (base > baseSlots_) baseSlots_ = std::min(brickCount(desc_.size), base + base / 4);
        if (mips > mipSlots_) mipSlots_ = std::min(mipBrickCount(desc_.size), mips + mips / 4);
    }
}

void ConeTracingVolume::record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, bool refit) {
    if (surfaces_.import(executor, frame, rsms))
        for (const auto& grid : grids_) grid->forget();
    places_.record(executor, rsms, nullptr, 0, placementOf(frame, refit));
    places_.recordTable(executor);
    // What voxels have heard of each other is of another scene.
    if (bounce_ && frame.reset)
        for (std::size_t c = 0; c < lights_.size(); ++c)
            lights_[c] = std::make_unique<VoxelLight>(device_, desc_.size, std::uint32_t(c));
    growSlots();
    const bool isNew = volume_.reserve(executor, baseSlots_, mipSlots_);
    for (std::size_t c = 0; c < grids_.size(); ++c) {
        surfaces_.record(executor, *grids_[c], places_.grid(c).place());
        mips_[c]->recordTables(executor, grids_[c]->occupied(), grids_[c]->changed(), isNew, volume_);
        if (isNew) lights_[c]->forget();
        const VoxelSurfaces surfaces = VoxelSurfaces::of(*grids_[c]);
        const Buffer& place = places_.grid(c).place();
        if (bounce_) receivers_[c]->record(executor, surfaces, place, *mips_[c], *lights_[c]);
        lights_[c]->record(executor, rsms, surfaces, place, *mips_[c], volume_, cl_int(desc_.normalAware), bool(bounce_));
        mips_[c]->recordFilter(executor, volume_);
        if (volume_.sparse) wanted_[c]->record(executor, "voxel_mips.counts", mips_[c]->work(), 0);
    }
    for (std::size_t c = 0; c < 3; ++c) environment_[c] = frame.environment[c];
    if (bounce_) recordBounce(executor);
}

// What this frame's voxels send to each other: the next frame's have it.
void ConeTracingVolume::recordBounce(Executor& executor) {
    executor.fill("cone_gather.counts", bounceCounts_, 0, 0, bounceCounts_.bytes());
    for (std::size_t c = 0; c < grids_.size(); ++c) {
        const VoxelReceivers& at = *receivers_[c];
        bounce_->recordTrace(executor, at.position(), at.normal(), world(), at.irradiance(), {}, {}, bounceCounts_);
        receivers_[c]->recordHeard(executor, *lights_[c]);
    }
}

std::vector<LWChoice> ConeTracingVolume::choices(const LWFrame& frame) const {
    std::vector<LWChoice> choices = surfaces_.choices(frame);
    if (desc_.cascades > 1) choices.push_back(places_.choice());
    return choices;
}

void ConeTracingVolume::report(Report& report) const {
    surfaces_.report(report);
    for (const auto& grid : grids_) grid->report(device_, report);
    for (const auto& light : lights_) light->report(device_, report);
    for (const auto& receivers : receivers_) receivers->report(device_, report);
    if (!volume_.state) return;
    for (std::size_t c = 0; c < grids_.size(); ++c) {
        const std::size_t at = c * sizeof(LwVoxelState);
        report.read(device_, "lit_bricks", volume_.state, at + offsetof(LwVoxelState, baseBricks));
        report.read(device_, "coarser_bricks", volume_.state, at + offsetof(LwVoxelState, mipBricks));
        report.read(device_, "dropped_bricks", volume_.state, at + offsetof(LwVoxelState, droppedBricks));
        report.read(device_, "changed_bricks", volume_.state, at + offsetof(LwVoxelState, changedBricks));
    }
}

void ConeTracingVolume::addDebugViews(std::vector<DebugView>& views) const {
    const Planes places = places_.debugPlanes();
    if (!places) return;
    views.push_back({"places", "a row for each grid from the finest on: its lower corner (3), voxels to a unit of length, a voxel's side, and "
                     "three numbers of its own", places, {}});
}

std::uint64_t ConeTracingVolume::bytes() const {
    std::uint64_t total = surfaces_.bytes() + places_.bytes() + volume_.bytes();
    for (const auto& grid : grids_) total += grid->bytes();
    for (const auto& mips : mips_) total += mips->bytes();
    for (const auto& light : lights_) total += light->bytes();
    for (const auto& receivers : receivers_) total += receivers->bytes();
    if (bounce_) total += bounce_->bytes() + bounceCounts_.bytes();
    return total;
}

// Which bricks a scene fills is not known beforehand: all.
std::uint64_t ConeTracingVolume::estimateBytes(const LWConeTracingDesc& desc, const FrameShape& shape) {
    const std::uint64_t bricks = brickCount(desc.size), mipBricks = mipBrickCount(desc.size);
    const VoxelVolume volume = volumeOf(desc);
    const std::uint64_t words = bricks * volume.basePlanes() + mipBricks * volume.mipPlanes();
    std::uint64_t grid = VoxelGrid::estimateBytes(desc.size, false) + VoxelMips::estimateBytes(desc.size) +
                         VoxelLight::estimateBytes(desc.size, desc.mode, volume.sides, isEndless(desc), std::uint32_t(bricks),
                                                  shape.paddedTexels) +
                         words * LW_VOXEL_STRIDE * sizeof(cl_uint) + volume.tableSize() * sizeof(cl_int) + sizeof(LwVoxelState);
    if (isEndless(desc)) grid += VoxelReceivers::estimateBytes(desc.size, std::uint32_t(bricks));
    return ConeTracingSurfaces::estimateBytes(desc, shape) + GridPlaces::estimateBytes(desc.cascades, 0) + desc.cascades * grid +
           (isEndless(desc) ? ConeGather::estimateBytes(bounceOptions(desc)) + ConeGather::kCounts * sizeof(cl_int) : 0);
}

}  // namespace lightwell
