#include "passes/lpv_blocking.h"

#include "compute/device.h"
#include "passes/vpl_list.h"
#include "shared/lpv_types.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "lpv_blocking/lpv_blocking";
constexpr std::size_t kRun = 64;  // LPV_RUN of the kernels
constexpr Range kListGroup{16, 1};
constexpr Range kCellGroup{16, 4};
constexpr Range kRunGroup{1, 64};

std::uint64_t cornersOf(std::uint32_t size) { return std::uint64_t(lpv_corners(lw_int(size))); }
std::uint64_t sumBytes(std::uint32_t size) { return cornersOf(size) * LW_LPV_BANDS * 2 * sizeof(cl_uint); }
std::uint64_t mergedBytes(std::uint32_t size) { return cornersOf(size) * sizeof(cl_float4); }
std::uint64_t faceBytes(std::uint32_t size) {
    return std::uint64_t(LW_LPV_FACE_PLANES) * std::uint64_t(lpv_plane(lw_int(size))) * sizeof(float);
}
std::uint64_t runBytes(std::uint32_t size) { return std::uint64_t(size) * size * (size / LW_LPV_BLOCK_RUN) * sizeof(cl_int); }

}  // namespace

LpvBlocking::LpvBlocking(Device& device, std::uint32_t size)
    : device_(device),
      size_(size),
      begin_(device.programs().kernel(kProgram, "lpv_blocking_begin")),
      inject_(device.programs().kernel(kProgram, "lpv_blocking_inject")),
      rasterise_(device.programs().kernel(kProgram, "lpv_blocking_triangles")),
      merge_(device.programs().kernel(kProgram, "lpv_blocking_merge")),
      faceWays_(device.programs().kernel(kProgram, "lpv_blocking_faces")),
      markRuns_(device.programs().kernel(kProgram, "lpv_blocking_runs")) {}

void LpvBlocking::reserve(Executor& executor) {
    if (isKept_) return;
    sums_.reserve(device_, sumBytes(size_), "sums of blockers");
    merged_.reserve(device_, mergedBytes(size_), "blockers at the corners of cells");
    faces_.reserve(device_, faceBytes(size_), "what gets through the faces of cells");
    runs_.reserve(device_, runBytes(size_), "cells that blockers touch");
    state_.reserve(device_, sizeof(LwLpvBlockers), "state of blockers");
    executor.fill("lpv_blocking.clear", sums_, 0, 0, sums_.bytes());  // later ones are emptied by whoever reads them
    executor.fill("lpv_blocking.clear", faces_, 0, 0, faces_.bytes());
    executor.fill("lpv_blocking.clear", state_, 0, 0, state_.bytes());
}

void LpvBlocking::begin(Executor& executor, std::uint64_t revision, const Buffer& place, bool scrolls) {
    reserve(executor);
    executor.run("lpv_blocking.begin", begin_, {1, 1}, {1, 1}, place, cl_uint(revision), cl_uint(revision >> 32),
                 cl_int(isKept_ ? 0 : 1), cl_int(scrolls ? 1 : 0), cl_int(size_), state_);
    isKept_ = true;
}

void LpvBlocking::merge(Executor& executor, bool isFirst) {
    const std::size_t side = size_ + 1;
    executor.run("lpv_blocking.merge", merge_, {side, side * side}, kCellGroup, sums_, cl_int(size_), cl_int(isFirst ? 1 : 0),
                 merged_, other(), state_);
}

void LpvBlocking::end(Executor& executor) {
    const std::size_t lines = std::size_t(size_) * size_;
    executor.run("lpv_blocking.faces", faceWays_, {size_, lines}, kCellGroup, merged_, other(), cl_int(size_), faces_, state_);
    executor.run("lpv_blocking.faces", markRuns_, {size_ / LW_LPV_BLOCK_RUN, lines}, kRunGroup, merged_, other(), cl_int(size_), runs_,
                 state_);
}

void LpvBlocking::record(Executor& executor, const SurfelSet& surfels, const std::vector<SurfelRange>& views,
                         const Buffer& place) {
    begin(executor, surfels.revision, place, false);
    bool isFirst = true;
    for (const SurfelRange& view : views) {
        if (view.count == 0 || !surfels.planes) continue;
        executor.run("lpv_blocking.inject", inject_, gridOver((view.count + kRun - 1) / kRun), kListGroup, surfels.planes.memory,
                     cl_int(surfels.planes.planeStride), cl_int(view.first), cl_int(view.count), place, cl_int(size_), sums_,
                     state_);
        merge(executor, isFirst);
        isFirst = false;
    }
    if (isFirst) merge(executor, true);  // nothing blocks
    end(executor);
}

void LpvBlocking::record(Executor& executor, const GeometryInput& geometry, const Buffer& place) {
    other_.reserve(device_, mergedBytes(size_), "blockers at the corners of cells that stayed");
    begin(executor, geometry.revision, place, true);
    if (geometry.triangleCount)
        executor.run("lpv_blocking.inject", rasterise_, gridOver(geometry.nodeCount), kListGroup, geometry.nodes,
                     cl_int(geometry.nodeCount), geometry.triangles.memory, cl_int(geometry.triangles.planeStride), place,
                     cl_int(size_), sums_, state_);
    merge(executor, true);
    end(executor);
}

std::uint64_t LpvBlocking::bytes() const {
    return sums_.bytes() + merged_.bytes() + other_.bytes() + faces_.bytes() + runs_.bytes() + state_.bytes();
}

std::uint64_t LpvBlocking::estimateBytes(std::uint32_t size, bool scrolls) {
    return sumBytes(size) + (scrolls ? 2 : 1) * mergedBytes(size) + faceBytes(size) + runBytes(size) + sizeof(LwLpvBlockers);
}

}  // namespace lightwell
