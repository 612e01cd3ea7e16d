#include "passes/voxel_grid_bins.h"

#include <algorithm>

#include "compute/device.h"
#include "passes/vpl_list.h"
#include "shared/voxel_bins.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "voxel_grid/voxel_bins";
constexpr const char* kPass = "voxel_grid.bins";
constexpr std::size_t kRun = 32;     // BINS_RUN of the kernels
constexpr std::size_t kChunk = 128;  // BINS_CHUNK
constexpr Range kListGroup{16, 1};

std::size_t listsOf(std::uint32_t size) { return std::size_t(bin_lists(lw_int(size))); }
std::size_t chunksOf(std::uint32_t size) { return (listsOf(size) + kChunk - 1) / kChunk; }

}  // namespace

VoxelGridBins::VoxelGridBins(Device& device, std::uint32_t size)
    : device_(device),
      size_(size),
      count_(device.programs().kernel(kProgram, "voxel_bins_count")),
      addUp_(device.programs().kernel(kProgram, "voxel_bins_chunks")),
      scan_(device.programs().kernel(kProgram, "voxel_bins_scan")),
      begin_(device.programs().kernel(kProgram, "voxel_bins_begin")),
      list_(device.programs().kernel(kProgram, "voxel_bins_list")) {}

void VoxelGridBins::record(Executor& executor, const SurfelSet& surfels, const Buffer& place, const Buffer& state) {
    const std::size_t lists = listsOf(size_), chunks = chunksOf(size_);
    counts_.reserve(device_, lists * sizeof(cl_int), "counts of surfels in bricks");
    if (!isCounted_) executor.fill(kPass, counts_, 0, 0, lists * sizeof(cl_int));
    isCounted_ = false;  // until all is enqueued
    chunks_.reserve(device_, chunks * sizeof(cl_int), "sums of surfels in bricks");
    begins_.reserve(device_, (lists + 1) * sizeof(cl_int), "where bricks' surfels begin");
    listOf_.reserve(device_, std::max<std::size_t>(surfels.count, 1) * sizeof(cl_int), "surfels' bricks");
    order_.reserve(device_, std::max<std::size_t>(surfels.count, 1) * sizeof(cl_int), "surfels by bricks");
    const Range over = gridOver((surfels.count + kRun - 1) / kRun);
    const cl_int stride = cl_int(surfels.planes.planeStride), count = cl_int(surfels.count), size = cl_int(size_);
    if (count)
        executor.run(kPass, count_, over, kListGroup, surfels.planes.memory, stride, count, place, size, listOf_, counts_,
                     state);
    executor.run(kPass, addUp_, {chunks, 1}, kListGroup, counts_, cl_int(lists), chunks_, state);
    executor.run(kPass, scan_, {1, 1}, {1, 1}, chunks_, cl_int(chunks), state);
    executor.run(kPass, begin_, {chunks, 1}, kListGroup, counts_, cl_int(lists), chunks_, begins_, state);
    if (count)
        executor.run(kPass, list_, over, kListGroup, listOf_, count, place, counts_, begins_, order_, state);
    isCounted_ = true;
}

std::uint64_t VoxelGridBins::estimateBytes(std::uint32_t size, std::uint64_t surfelCount) {
    return (2 * listsOf(size) + 1 + chunksOf(size) + 2 * std::max<std::uint64_t>(surfelCount, 1)) * sizeof(cl_int);
}

}  // namespace lightwell
