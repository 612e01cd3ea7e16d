#include "passes/voxel_visibility.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "compute/device.h"
#include "passes/vpl_list.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "voxel_visibility/voxel_visibility";
constexpr const char* kSweep = "voxel_visibility/voxel_sweep";
constexpr Range kListGroup{64, 1};
constexpr Range kRowGroup{4, 4};

std::uint64_t voxelsOf(std::uint32_t size) { return std::uint64_t(size) * size * size; }
std::uint64_t sightBytes(std::uint32_t size, std::uint32_t clusters) {
    return voxelsOf(size) * std::max(clusters, 1u) + 2 * LW_SIGHT_PAD;
}

std::size_t itemsOf(std::uint32_t rows) { return (rows + LW_SWEEP_ROWS - 1) / LW_SWEEP_ROWS; }

}  // namespace

VoxelVisibility::VoxelVisibility(Device& device, std::uint32_t size)
    : device_(device),
      size_(size),
      solid_(device.programs().kernel(kProgram, "voxel_visibility_solid")),
      placeEyes_(device.programs().kernel(kProgram, "voxel_visibility_eyes")),
      start_(device.programs().kernel(kSweep, "voxel_sweep_start")),
      whole_(device.programs().kernel(kSweep, "voxel_sweep_whole")),
      across_(device.programs().kernel(kSweep, "voxel_sweep_across")),
      along_(device.programs().kernel(kSweep, "voxel_sweep_along")) {}

std::uint64_t VoxelVisibility::bytes() const {
    return held_.bytes() + solids_.bytes() + sights_.bytes() + eyes_.bytes() + sight_.bytes();
}

std::uint64_t VoxelVisibility::estimateBytes(std::uint32_t size, std::uint32_t clusters) {
    return voxelsOf(size) / 8 + voxelsOf(size) + sightBytes(size, clusters) + std::max(clusters, 1u) * sizeof(LwVoxelEye) +
           sizeof(LwVoxelSight);
}

void VoxelVisibility::reserve(std::uint32_t clusters) {
    held_.reserve(device_, std::size_t(voxelsOf(size_) / 8), "voxels that hold something");
    solids_.reserve(device_, std::size_t(voxelsOf(size_)), "voxels that hold something");
    sights_.reserve(device_, std::size_t(sightBytes(size_, clusters)), "what clusters see of voxels");
    eyes_.reserve(device_, std::max(clusters, 1u) * sizeof(LwVoxelEye), "where clusters look from");
    sight_.reserve(device_, sizeof(LwVoxelSight), "place of the grid");
}

void VoxelVisibility::record(Executor& executor, const Buffer& place, const Buffer& occupied,
                             const std::vector<Clusters>& lists) {
    std::vector<std::uint32_t> counts;
    for (const Clusters& list : lists) counts.push_back(list.count);
    const std::uint32_t clusters = std::accumulate(counts.begin(), counts.end(), 0u);
    const bool isNew = counts != counts_;
    counts_.clear();  // should what follows fail
    reserve(clusters);
    if (isNew) {
        // What lies before the first voxel and after the last is read, although nothing takes it.
        executor.fill("voxel_visibility.clear", sights_, 0, 0, LW_SIGHT_PAD);
        executor.fill("voxel_visibility.clear", sights_, 0, std::size_t(sightBytes(size_, clusters)) - LW_SIGHT_PAD, LW_SIGHT_PAD);
        executor.fill("voxel_visibility.clear", eyes_, 0, 0, eyes_.bytes());
        executor.fill("voxel_visibility.clear", sight_, 0, 0, offsetof(LwVoxelSight, size));
        executor.fill("voxel_visibility.clear", sight_, size_, offsetof(LwVoxelSight, size), sizeof(cl_int));
    }
    executor.fill("voxel_visibility.clear", sight_, 0, offsetof(LwVoxelSight, changed), 2 * sizeof(cl_int));
    executor.run("voxel_visibility.solid", solid_, gridOver(std::size_t(voxelsOf(size_) / 32)), kListGroup, occupied,
                 cl_int(isNew ? 1 : 0), cl_int(size_), held_, solids_, sight_);
    cl_int first = 0;
    for (const Clusters& list : lists) {
        if (list.count)
            executor.run("voxel_visibility.eyes", placeEyes_, gridOver(list.count), kListGroup, list.clusters, cl_int(list.count),
                         first, cl_int(isNew ? 1 : 0), place, solids_, eyes_, sight_);
        first += cl_int(list.count);
    }
    if (clusters) recordSweep(executor, clusters);
    counts_ = std::move(counts);
}

void VoxelVisibility::recordSweep(Executor& executor, std::uint32_t clusters) {
    const cl_int count = cl_int(clusters), size = cl_int(size_);
    executor.run("voxel_visibility.sweep", start_, {clusters, 1}, kRowGroup, eyes_, count, size, solids_, sights_);
    if (whole_.width() > 1) {  // a CPU
        executor.run("voxel_visibility.sweep", whole_, {clusters, 1}, {1, 1}, eyes_, count, size, solids_, sights_);
        return;
    }
    for (std::uint32_t shell = 2; shell < size_; ++shell) {
        const std::size_t across = itemsOf(std::min(2 * shell - 1, size_)), along = itemsOf(std::min(2 * shell + 1, size_));
        executor.run("voxel_visibility.sweep", across_, {across, 2 * std::size_t(clusters)}, kRowGroup, eyes_, count, size,
                     cl_int(shell), solids_, sights_);
        executor.run("voxel_visibility.sweep", along_, {along, 4 * std::size_t(clusters)}, kRowGroup, eyes_, count, size,
                     cl_int(shell), solids_, sights_);
    }
}

}  // namespace lightwell
