#include "passes/voxel_grid.h"

#include <algorithm>

#include "compute/device.h"
#include "passes/vpl_list.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "voxel_grid/voxel_grid";
constexpr const char* kTriangles = "voxel_grid/voxel_triangles";
constexpr const char* kSurfels = "voxel_grid/voxel_surfels";
constexpr std::size_t kMarkRun = 16;     // MARK_RUN of the kernels
constexpr std::size_t kOutsideRun = 64;  // OUTSIDE_RUN
// Work-items that share out the bricks, each every so many-th: more of them than any device runs at once, few enough that a frame
// without changes launches them for nothing.
constexpr std::size_t kWorkers = 1024;
constexpr Range kListGroup{64, 1};

std::uint32_t bricksOf(std::uint32_t size) {
    const std::uint32_t side = size / LW_VOXEL_BRICK;
    return side * side * side;
}

// A sparse grid's first guess: the six sides of a room.
std::uint32_t firstSlots(std::uint32_t size, bool sparse) {
    const std::uint32_t side = size / LW_VOXEL_BRICK;
    return sparse ? std::min(bricksOf(size), 6 * side * side) : bricksOf(size);
}

// Parts that a brick is shared out in: where work-items are lanes, thousands run at once; and a grid of few bricks has some that
// hold most of the scene, which its other cores would wait for. What comes out is the same.
Defines tasksOf(const Device& device, std::uint32_t size) {
    return {{"FILL_TASKS", device.width() == 1 ? "8" : size <= 64 ? "4" : "1"}};
}

std::size_t chunksOf(std::size_t count) { return (count + LW_VOXEL_CHUNK - 1) / LW_VOXEL_CHUNK; }
std::size_t surfaceBytes(std::uint32_t slots) {
    return std::size_t(slots) * LW_VOXEL_BRICK_VOXELS * LW_SURFACE_PLANES * sizeof(cl_uint);
}

}  // namespace

VoxelGrid::VoxelGrid(Device& device, std::uint32_t size, Keeps keeps)
    : device_(device),
      size_(size),
      brickCount_(bricksOf(size)),
      sparse_(keeps == Keeps::occupied),
      fills_(keeps != Keeps::none),
      begin_(device.programs().kernel(kProgram, "voxel_grid_begin")),
      mark_(device.programs().kernel(kProgram, "voxel_grid_mark")),
      census_(device.programs().kernel(kProgram, "voxel_grid_census")),
      freeSlots_(device.programs().kernel(kProgram, "voxel_grid_free")),
      scan_(device.programs().kernel(kProgram, "voxel_grid_scan")),
      listFree_(device.programs().kernel(kProgram, "voxel_grid_list_free")),
      give_(device.programs().kernel(kProgram, "voxel_grid_give")),
      occupy_(device.programs().kernel(kTriangles, "voxel_triangles_occupy", tasksOf(device, size))),
      fill_(device.programs().kernel(kTriangles, "voxel_triangles_fill", tasksOf(device, size))),
      outside_(device.programs().kernel(kTriangles, "voxel_triangles_outside", tasksOf(device, size))),
      occupySurfels_(device.programs().kernel(kSurfels, "voxel_surfels_occupy", tasksOf(device, size))),
      fillSurfels_(device.programs().kernel(kSurfels, "voxel_surfels_fill", tasksOf(device, size))),
      bins_(device, size) {}

void VoxelGrid::reserve(Executor& executor) {
    if (slots_ == 0) slots_ = firstSlots(size_, sparse_);
    const std::size_t bricks = brickCount_;
    if (!state_) {
        state_ = Buffer(device_, sizeof(LwVoxelGrid), "state of voxels");
        executor.fill("voxel_grid.clear", state_, 0, 0, state_.bytes());
    }
    occupied_.reserve(device_, bricks * LW_VOXEL_WORDS * sizeof(cl_uint), "occupied voxels");
    bricks_.reserve(device_, bricks * sizeof(cl_int), "bricks of voxels");
    changed_.reserve(device_, bricks * sizeof(cl_int), "bricks of voxels that have changed");
    list_.reserve(device_, bricks * sizeof(cl_int), "list of bricks of voxels");
    owners_.reserve(device_, slots_ * sizeof(cl_int), "owners of the voxels' slots");
    free_.reserve(device_, slots_ * sizeof(cl_int), "free slots of voxels");
    chunks_.reserve(device_, (chunksOf(bricks) + chunksOf(slots_)) * sizeof(cl_int), "counts of bricks of voxels");
    if (fills_) surfaces_.reserve(device_, surfaceBytes(slots_), "surfaces of voxels");
}

// Room for what the last record whose counts have come back has wanted, and a quarter more.
void VoxelGrid::grow() {
    const LwVoxelGrid* counts = counts_.take();
    if (!sparse_ || !counts || counts->dropped == 0) return;
    const std::uint32_t wanted = std::uint32_t(counts->slots + counts->dropped);
    if (wanted <= slots_) return;
    slots_ = std::min(brickCount_, wanted + wanted / 4);
    isKept_ = false;
}

void VoxelGrid::begin(Executor& executor, Source source, std::uint64_t revision, Emission emission, bool changesKnown,
                      const Buffer& place) {
    grow();
    reserve(executor);
    const bool isSame = isKept_ && source == source_ && revision == revision_;
    const bool isPart = isKept_ && source == source_ && changesKnown && revision == revision_ + 1;
    executor.run("voxel_grid.begin", begin_, {1, 1}, {1, 1}, place, cl_int(isSame ? 0 : isPart ? 1 : 2), emission.largest,
                 emission.found ? *emission.found : place, cl_int(emission.found ? LW_SURFEL_LARGEST : -1), cl_int(slots_), state_);
    isKept_ = false;  // until all is enqueued
    source_ = source;
    revision_ = revision;
}

void VoxelGrid::mark(Executor& executor, const Buffer* boxes, const Buffer& place) {
    executor.run("voxel_grid.begin", mark_, {(brickCount_ + kMarkRun - 1) / kMarkRun, 1}, kListGroup, boxes ? *boxes : place,
                 cl_int(boxes ? 1 : 0), cl_int(size_), changed_, list_, state_);
}

void VoxelGrid::giveSlots(Executor& executor) {
    const std::size_t brickChunks = chunksOf(brickCount_), slotChunks = chunksOf(slots_);
    // The slots' counts lie behind the bricks'.
    executor.run("voxel_grid.slots", census_, {brickChunks, 1}, kListGroup, occupied_, cl_int(size_), cl_int(sparse_ ? 1 : 0),
                 bricks_, owners_, chunks_, state_);
    executor.run("voxel_grid.slots", freeSlots_, {slotChunks, 1}, kListGroup, owners_, cl_int(slots_), chunks_, cl_int(brickChunks),
                 state_);
    executor.run("voxel_grid.slots", scan_, {1, 1}, {1, 1}, chunks_, cl_int(brickChunks), cl_int(slotChunks), state_);
    executor.run("voxel_grid.slots", listFree_, {slotChunks, 1}, kListGroup, owners_, cl_int(slots_), chunks_, cl_int(brickChunks),
                 free_, state_);
    executor.run("voxel_grid.slots", give_, {brickChunks, 1}, kListGroup, occupied_, cl_int(size_), cl_int(sparse_ ? 1 : 0), chunks_,
                 free_, bricks_, owners_, changed_, list_, state_);
}

void VoxelGrid::readCounts(Executor& executor) {
    if (sparse_ && slots_ < brickCount_) counts_.record(executor, "voxel_grid.counts", state_, 0);
}

void VoxelGrid::record(Executor& executor, const GeometryInput& geometry, const Buffer& place) {
    begin(executor, Source::kTriangles, geometry.revision, {geometry.largestEmission, nullptr}, bool(geometry.changes), place);
    mark(executor, geometry.changes ? &geometry.changes : nullptr, place);
    const std::size_t workers = std::min<std::size_t>(kWorkers, brickCount_);
    const cl_int count = cl_int(geometry.triangleCount);
    const cl_mem triangles = count ? geometry.triangles.memory : place.get(), nodes = count ? geometry.nodes.get() : place.get();
    const cl_int stride = cl_int(geometry.triangles.planeStride);
    executor.run("voxel_grid.occupy", occupy_, {workers, 1}, {1, 1}, triangles, stride, count, nodes, place, cl_int(size_), list_,
                 occupied_, state_);
    if (count)
        executor.run("voxel_grid.occupy", outside_, {(geometry.triangleCount + kOutsideRun - 1) / kOutsideRun, 1}, kListGroup, triangles,
                     stride, count, place, cl_int(size_), state_);
    giveSlots(executor);
    if (fills_)
        executor.run("voxel_grid.fill", fill_, {workers, 1}, {1, 1}, triangles, stride, count,
                     cl_int(geometry.hasEmission ? GeometryInput::kEmission : -1), nodes, place, cl_int(size_), list_, bricks_,
                     cl_int(slots_), surfaces_, state_);
    readCounts(executor);
    isKept_ = true;
}

void VoxelGrid::record(Executor& executor, const SurfelSet& surfels, const Buffer& place) {
    begin(executor, Source::kSurfels, surfels.revision, {0.0f, surfels.emission}, false, place);
    mark(executor, nullptr, place);
    bins_.record(executor, surfels, place, state_);
    const std::size_t workers = std::min<std::size_t>(kWorkers, brickCount_);
    const cl_mem planes = surfels.planes ? surfels.planes.memory : place.get();
    const cl_int stride = cl_int(surfels.planes.planeStride);
    executor.run("voxel_grid.occupy", occupySurfels_, {workers, 1}, {1, 1}, planes, stride, bins_.begins(), bins_.order(), place,
                 cl_int(size_), list_, occupied_, state_);
    giveSlots(executor);
    if (fills_)
        executor.run("voxel_grid.fill", fillSurfels_, {workers, 1}, {1, 1}, planes, stride, cl_int(surfels.emission ? 1 : 0),
                     bins_.begins(), bins_.order(), place, cl_int(size_), list_, bricks_, cl_int(slots_), surfaces_, state_);
    readCounts(executor);
    isKept_ = true;
}

void VoxelGrid::report(Device& device, Report& report) const {
    if (!state_) return;
    const auto read = [&](const char* name, std::size_t offset) { report.read(device, name, state_, offset); };
    read("voxels", offsetof(LwVoxelGrid, voxels));
    read("voxel_bricks", offsetof(LwVoxelGrid, bricks));
    read("dropped_bricks", offsetof(LwVoxelGrid, dropped));
    read("outside_surfaces", offsetof(LwVoxelGrid, outside));
}

std::uint64_t VoxelGrid::bytes() const {
    return occupied_.bytes() + bricks_.bytes() + surfaces_.bytes() + changed_.bytes() + state_.bytes() + list_.bytes() +
           owners_.bytes() + free_.bytes() + chunks_.bytes() + bins_.bytes();
}

std::uint64_t VoxelGrid::estimateBytes(std::uint32_t size, Keeps keeps, std::uint32_t slots) {
    const std::uint64_t bricks = bricksOf(size);
    if (slots == 0) slots = firstSlots(size, keeps == Keeps::occupied);
    return bricks * (LW_VOXEL_WORDS + 3) * sizeof(cl_int) + (keeps == Keeps::none ? 0 : surfaceBytes(slots)) + 2 * std::uint64_t(slots) * sizeof(cl_int) +
           (chunksOf(bricks) + chunksOf(slots)) * sizeof(cl_int) + sizeof(LwVoxelGrid);
}

}  // namespace lightwell
