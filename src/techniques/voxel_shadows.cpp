#include "techniques/voxel_shadows.h"

#include <cstddef>

#include "compute/report.h"

namespace lightwell {

VoxelShadows::VoxelShadows(Device& device, std::uint32_t size)
    : device_(device), place_(device, size, 1), grid_(device, size, VoxelGrid::Keeps::none), visibility_(device, size) {}

void VoxelShadows::recordVoxels(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const VoxelSurfaces& surfaces,
                                bool forget) {
    box_.look(frame);
    if (forget || surfaces.isOther) grid_.forget();
    if (forget) visibility_.forget();
    GridPlacement placement;
    placement.hasBox = box_.isSome();
    for (int a = 0; a < 3; ++a) {
        placement.low[a] = box_.low()[a];
        placement.high[a] = box_.high()[a];
    }
    placement.refit = forget;
    place_.record(executor, rsms, frame.vpls, frame.vplCount, placement);
    if (surfaces.triangles) grid_.record(executor, *surfaces.triangles, place_.place());
    else grid_.record(executor, surfaces.surfels, place_.place());
}

void VoxelShadows::recordSights(Executor& executor, const std::vector<VoxelVisibility::Clusters>& lists) {
    visibility_.record(executor, place_.place(), grid_.occupied(), lists);
}

void VoxelShadows::report(Report& report) const {
    grid_.report(device_, report);
    report.counts.push_back({"clusters_swept", 0});
    if (const Buffer& sight = sights().sight) report.read(device_, "clusters_swept", sight, offsetof(LwVoxelSight, swept));
}

std::uint64_t VoxelShadows::estimateBytes(std::uint32_t size, std::uint32_t clusters, std::uint64_t surfels, const FrameShape& shape) {
    return GridPlace::estimateBytes(shape.vplCount) + VoxelGrid::estimateBytes(size, VoxelGrid::Keeps::none) +
           VoxelGridBins::estimateBytes(size, surfels) + VoxelVisibility::estimateBytes(size, clusters);
}

}  // namespace lightwell
