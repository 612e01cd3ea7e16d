#include "passes/paraboloid_map.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/image_access.h"
#include "shared/paraboloid_map_types.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "paraboloid_map/paraboloid_map";
constexpr const char* kTrace = "paraboloid_map/paraboloid_trace";
constexpr std::uint32_t kSmallest = 64, kLargest = 512;

// Blocks of neighbouring texels make a group: elsewhere than on a CPU a square, whose rays keep together.
Range traceGroup(std::uint32_t width) { return width == 1 ? Range{8, 8} : Range{16, 1}; }

void checkCount(std::uint32_t size, std::uint64_t maps) {
    constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
    if (2 * maps * size * size > kMost)
        fail(LW_ERROR_UNSUPPORTED, "clusters: ", maps, " maps of ", size, " x ", size,
             " texels exceed the 32-bit indices of the kernels");
}

}  // namespace

ParaboloidMap::ParaboloidMap(Device& device, std::uint32_t size)
    : device_(device),
      size_(size),
      place_(device.programs().kernel(kProgram, "paraboloid_map_place")),
      clear_(device.programs().kernel(kProgram, "paraboloid_map_clear")),
      trace_(device.programs().kernel(kTrace, "paraboloid_map_trace")),
      notice_(device.programs().kernel(kTrace, "paraboloid_map_notice")),
      marks_(device.programs().kernel(kProgram, "paraboloid_map_marks")),
      planes_(device.programs().kernel(kProgram, "paraboloid_map_planes")) {
    if (size < kSmallest || size > kLargest || size % 16 != 0)
        fail(LW_ERROR_INVALID_ARGUMENT, "mapSize: expected a multiple of 16 in ", kSmallest, " .. ", kLargest,
             ", got ", size);
}

void ParaboloidMap::reserve(std::uint32_t clusterCount) {
    checkCount(size_, clusterCount);
    const std::size_t maps = std::max(clusterCount, 1u), texels = maps * size_ * size_;
    // What a map holds from the last frame is lost where its memory grows.
    if (records_.bytes() < texels * 8 || frames_.bytes() < maps * sizeof(lw_paraboloid)) drawnCount_ = 0;
    frames_.reserve(device_, maps * sizeof(lw_paraboloid), "frames of paraboloid maps");
    state_.reserve(device_, maps * sizeof(cl_int), "states of paraboloid maps");
    records_.reserve(device_, texels * 8, "records of paraboloid maps");
    albedo_.reserve(device_, texels * 4, "albedo of paraboloid maps");
    counters_.reserve(device_, LW_MAP_COUNTERS * sizeof(cl_uint), "counters of paraboloid maps");
}

void ParaboloidMap::place(Executor& executor, const Buffer& clusters, std::uint32_t clusterCount,
                          const Buffer& diagonal, bool force) {
    reserve(clusterCount);
    mapCount_ = clusterCount;
    executor.fill("paraboloid_map.clear", counters_, 0, 0, LW_MAP_COUNTERS * sizeof(cl_uint));
    if (clusterCount == 0) return;
    const cl_int all = clusterCount > drawnCount_ || force ? 1 : 0;
    executor.run("paraboloid_map.place", place_, {clusterCount, 1}, {1, 1}, clusters, cl_int(clusterCount), diagonal, all,
                 frames_, state_, counters_);
    drawnCount_ = 0;  // where what draws fails, all of them again
}

void ParaboloidMap::recordPlaces(Executor& executor, const Buffer& clusters, std::uint32_t clusterCount,
                                 const Buffer& diagonal, std::uint64_t revision) {
    place(executor, clusters, clusterCount, diagonal, revision != drawnRevision_);
    if (clusterCount == 0) return;
    const std::size_t texels = std::size_t(size_) * size_;
    executor.run("paraboloid_map.clear", clear_, {texels, mapCount_}, {64, 1}, state_, cl_int(texels), records_);
}

void ParaboloidMap::noteDrawn(std::uint64_t revision) {
    drawnCount_ = mapCount_;
    drawnRevision_ = revision;
}

void ParaboloidMap::recordMarks(Executor& executor) {
    if (mapCount_ == 0) return;
    executor.run("paraboloid_map.marks", marks_, {std::size_t(size_) * size_ / marks_.width(), mapCount_}, rowGroup(device_), state_,
                 cl_int(size_), records_);
}

Range ParaboloidMap::grid() const {
    const std::uint32_t columns = LW_BLOCK_COLUMNS_OF(trace_.width()), rows = trace_.width() / columns;
    return {size_ / columns, std::size_t(size_ / rows) * mapCount_};
}

void ParaboloidMap::notice(Executor& executor, const Buffer& changes) {
    executor.run("paraboloid_map.notice", notice_, grid(), traceGroup(notice_.width()), changes, frames_, records_,
                 cl_int(mapCount_), cl_int(size_), state_, counters_);
}

void ParaboloidMap::record(Executor& executor, const Buffer& clusters, std::uint32_t clusterCount,
                           const GeometryInput& geometry) {
    diagonal_.reserve(device_, sizeof(float), "the triangles' extent");
    cl_uint diagonal;
    std::memcpy(&diagonal, &geometry.diagonal, sizeof diagonal);
    executor.fill("paraboloid_map.clear", diagonal_, diagonal, 0, sizeof diagonal);
    const bool changed = geometry.revision != drawnRevision_, isNext = geometry.revision == drawnRevision_ + 1;
    const bool known = isNext && clusterCount <= drawnCount_;
    place(executor, clusters, clusterCount, diagonal_, changed && !known);
    if (clusterCount == 0) return;
    if (known) notice(executor, geometry.changes);
    // A kernel's argument must be some memory, also where none is read.
    const bool any = geometry.triangleCount != 0;
    const cl_mem triangles = any ? geometry.triangles.memory : records_.get(), nodes = any ? geometry.nodes.get() : records_.get();
    executor.run("paraboloid_map.trace", trace_, grid(), traceGroup(trace_.width()), triangles,
                 cl_int(geometry.triangles.planeStride), nodes, cl_int(any ? 1 : 0), frames_, state_, cl_int(clusterCount),
                 cl_int(size_), records_, albedo_);
    noteDrawn(geometry.revision);
}

void ParaboloidMap::recordKept(Executor& executor) {
    if (counters_) executor.fill("paraboloid_map.clear", counters_, 0, 0, LW_MAP_COUNTERS * sizeof(cl_uint));
}

Planes ParaboloidMap::debugShape() const {
    Planes planes;
    planes.width = size_;
    planes.height = size_ * mapCount_;
    planes.rowStride = size_;
    planes.planeStride = std::int64_t(size_) * planes.height;
    planes.count = 7;
    return planes;
}

void ParaboloidMap::recordPlanes(Executor& executor, const Planes& planes) {
    if (mapCount_ == 0) return;
    if (planes.planeStride * planes.count > std::numeric_limits<std::int32_t>::max())
        fail(LW_ERROR_UNSUPPORTED, "debug view maps: ", mapCount_, " maps of ", size_, " x ", size_,
             " texels exceed the 32-bit indices of the kernels");
    executor.run("paraboloid_map.planes", planes_, {std::size_t(size_) * size_ / planes_.width(), mapCount_},
                 rowGroup(device_), frames_, records_, albedo_, cl_int(size_), planes.memory,
                 cl_int(planes.planeStride));
}

void ParaboloidMap::report(Report& report) const {
    if (!counters_) return;
    report.read(device_, "maps_redrawn", counters_, LW_MAP_REDRAWN * sizeof(cl_uint));
}

std::uint64_t ParaboloidMap::bytes() const {
    return frames_.bytes() + state_.bytes() + records_.bytes() + albedo_.bytes() + counters_.bytes() +
           diagonal_.bytes();
}

std::uint64_t ParaboloidMap::estimateBytes(std::uint32_t size, std::uint32_t clusterCount) {
    return estimatePlacesBytes(size, clusterCount) + sizeof(float);
}

std::uint64_t ParaboloidMap::estimatePlacesBytes(std::uint32_t size, std::uint32_t clusterCount) {
    const std::uint64_t maps = std::max(clusterCount, 1u);
    checkCount(size, maps);
    return maps * (sizeof(lw_paraboloid) + sizeof(cl_int) + std::uint64_t(size) * size * 12) +
           LW_MAP_COUNTERS * sizeof(cl_uint);
}

}  // namespace lightwell
