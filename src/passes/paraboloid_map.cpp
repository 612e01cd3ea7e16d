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
constexpr const char* kDraw = "paraboloid_map/paraboloid_draw";
constexpr std::uint32_t kSmallest = 64, kLargest = 512;
// Room for large triangles: those that find none are drawn where they were found, by one work-item each. Sponza
// leaves two or three hundred on each map of 256 texels a side.
constexpr std::uint32_t kLargePerMap = 1024;
// Work-items that share the list of large triangles, whatever its length.
constexpr std::size_t kListItems = 1024;

// Work-items that draw: a few of very different cost make a group on a CPU, where each group costs little.
Range drawGroup(const Device& device) { return {device.width() == 1 ? std::size_t(64) : std::size_t(1), 1}; }

void checkCount(std::uint32_t size, std::uint64_t maps, std::uint64_t groups) {
    constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
    if (2 * maps * size * size > kMost || maps * groups > kMost)
        fail(LW_ERROR_UNSUPPORTED, "clusters: ", maps, " maps of ", size, " x ", size,
             " texels exceed the 32-bit indices of the kernels");
}

std::uint64_t groupsOf(std::uint64_t triangles) {
    const std::uint64_t perPadding = 16 * LW_TRIANGLE_GROUP;
    return (triangles + perPadding - 1) / perPadding * 16;
}

}  // namespace

ParaboloidMap::ParaboloidMap(Device& device, std::uint32_t size)
    : device_(device),
      size_(size),
      place_(device.programs().kernel(kProgram, "paraboloid_map_place")),
      clear_(device.programs().kernel(kProgram, "paraboloid_map_clear")),
      depth_(device.programs().kernel(kDraw, "paraboloid_map_depth")),
      depthLarge_(device.programs().kernel(kDraw, "paraboloid_map_depth_large")),
      identity_(device.programs().kernel(kDraw, "paraboloid_map_identity")),
      identityLarge_(device.programs().kernel(kDraw, "paraboloid_map_identity_large")),
      resolve_(device.programs().kernel(kProgram, "paraboloid_map_resolve")),
      planes_(device.programs().kernel(kProgram, "paraboloid_map_planes")) {
    if (size < kSmallest || size > kLargest || size % 16 != 0)
        fail(LW_ERROR_INVALID_ARGUMENT, "mapSize: expected a multiple of 16 in ", kSmallest, " .. ", kLargest,
             ", got ", size);
}

void ParaboloidMap::reserve(std::uint32_t clusterCount) {
    checkCount(size_, clusterCount, 0);
    const std::size_t maps = std::max(clusterCount, 1u), texels = maps * size_ * size_;
    // What a map holds from the last frame is lost where its memory grows.
    if (records_.bytes() < texels * 8 || frames_.bytes() < maps * sizeof(lw_paraboloid)) drawnCount_ = 0;
    frames_.reserve(device_, maps * sizeof(lw_paraboloid), "frames of paraboloid maps");
    state_.reserve(device_, maps * sizeof(cl_int), "states of paraboloid maps");
    records_.reserve(device_, texels * 8, "records of paraboloid maps");
    albedo_.reserve(device_, texels * 4, "albedo of paraboloid maps");
    counters_.reserve(device_, LW_MAP_COUNTERS * sizeof(cl_uint), "counters of paraboloid maps");
}

void ParaboloidMap::reserveTriangles(std::uint32_t clusterCount, std::uint32_t groupCount) {
    checkCount(size_, clusterCount, groupCount);
    const std::size_t maps = std::max(clusterCount, 1u);
    candidates_.reserve(device_, maps * std::max(groupCount, 16u) * sizeof(cl_uint), "candidates of paraboloid maps");
    large_.reserve(device_, maps * kLargePerMap * sizeof(lw_large_triangle), "large triangles of paraboloid maps");
    diagonal_.reserve(device_, sizeof(float), "the triangles' extent");
}

void ParaboloidMap::recordPlaces(Executor& executor, const Buffer& clusters, std::uint32_t clusterCount,
                                 const Buffer& diagonal, std::uint64_t revision) {
    reserve(clusterCount);
    mapCount_ = clusterCount;
    executor.fill("paraboloid_map.clear", counters_, 0, 0, LW_MAP_COUNTERS * sizeof(cl_uint));
    if (clusterCount == 0) return;
    const cl_int force = clusterCount > drawnCount_ || revision != drawnRevision_ ? 1 : 0;
    executor.run("paraboloid_map.place", place_, {clusterCount, 1}, {1, 1}, clusters, cl_int(clusterCount), diagonal, force,
                 frames_, state_, counters_);
    const std::size_t texels = std::size_t(size_) * size_;
    executor.run("paraboloid_map.clear", clear_, {texels, clusterCount}, {64, 1}, state_, cl_int(texels), records_);
    drawnCount_ = 0;  // where what draws fails, all of them again
}

void ParaboloidMap::noteDrawn(std::uint64_t revision) {
    drawnCount_ = mapCount_;
    drawnRevision_ = revision;
}

void ParaboloidMap::record(Executor& executor, const Buffer& clusters, std::uint32_t clusterCount,
                           const GeometryInput& geometry) {
    reserveTriangles(clusterCount, geometry.groupCount);
    cl_uint diagonal;
    std::memcpy(&diagonal, &geometry.diagonal, sizeof diagonal);
    executor.fill("paraboloid_map.clear", diagonal_, diagonal, 0, sizeof diagonal);
    recordPlaces(executor, clusters, clusterCount, diagonal_, geometry.revision);
    if (clusterCount == 0) return;
    const std::size_t texels = std::size_t(size_) * size_;
    if (geometry.triangleCount) draw(executor, geometry);
    // A kernel's argument must be some memory, also where none is read.
    const cl_mem triangles = geometry.triangleCount ? geometry.triangles.memory : records_.get();
    executor.run("paraboloid_map.resolve", resolve_, {texels / resolve_.width(), clusterCount}, rowGroup(device_),
                 triangles, cl_int(geometry.triangles.planeStride), frames_, state_, cl_int(size_),
                 cl_int(geometry.triangleCount ? 1 : 0), records_, albedo_);
    noteDrawn(geometry.revision);
}

void ParaboloidMap::draw(Executor& executor, const GeometryInput& geometry) {
    const cl_mem triangles = geometry.triangles.memory;
    const cl_int stride = cl_int(geometry.triangles.planeStride), groups = cl_int(geometry.groupCount);
    const cl_int count = cl_int(mapCount_), size = cl_int(size_);
    const cl_int capacity = cl_int(mapCount_ * kLargePerMap);
    const Range group = drawGroup(device_);
    const Range grid{geometry.groupCount / depth_.width(), (mapCount_ + LW_MAPS_PER_ITEM - 1) / LW_MAPS_PER_ITEM};
    executor.run("paraboloid_map.depth", depth_, grid, group, triangles, stride, geometry.groups, groups, frames_,
                 state_, count, size, records_, candidates_, large_, counters_, capacity);
    executor.run("paraboloid_map.depth_large", depthLarge_, {kListItems, 1}, group, triangles, stride, frames_, size,
                 records_, large_, counters_, capacity);
    executor.run("paraboloid_map.identity", identity_, grid, group, triangles, stride, groups, frames_, state_,
                 count, size, records_, candidates_);
    executor.run("paraboloid_map.identity_large", identityLarge_, {kListItems, 1}, group, triangles, stride, frames_,
                 size, records_, large_, counters_, capacity);
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
    report.read(device_, "inline_triangles", counters_, LW_MAP_INLINE * sizeof(cl_uint));
}

std::uint64_t ParaboloidMap::bytes() const {
    return frames_.bytes() + state_.bytes() + records_.bytes() + albedo_.bytes() + candidates_.bytes() +
           large_.bytes() + counters_.bytes() + diagonal_.bytes();
}

std::uint64_t ParaboloidMap::estimateBytes(std::uint32_t size, std::uint32_t clusterCount, std::uint32_t triangleCount) {
    const std::uint64_t groups = groupsOf(triangleCount), maps = std::max(clusterCount, 1u);
    checkCount(size, maps, groups);
    return estimatePlacesBytes(size, clusterCount) + sizeof(float) +
           maps * (std::max<std::uint64_t>(groups, 16) * sizeof(cl_uint) + kLargePerMap * sizeof(lw_large_triangle));
}

std::uint64_t ParaboloidMap::estimatePlacesBytes(std::uint32_t size, std::uint32_t clusterCount) {
    const std::uint64_t maps = std::max(clusterCount, 1u);
    checkCount(size, maps, 0);
    return maps * (sizeof(lw_paraboloid) + sizeof(cl_int) + std::uint64_t(size) * size * 12) +
           LW_MAP_COUNTERS * sizeof(cl_uint);
}

}  // namespace lightwell
