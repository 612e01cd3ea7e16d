// What techniques need to shadow the light of clusters of VPLs by voxels: a grid fitted to the scene, which of its voxels hold
// something, and what clusters see past those.
#pragma once

#include <cstdint>
#include <vector>

#include "inputs/frame_shape.h"
#include "inputs/geometry_box.h"
#include "inputs/geometry_input.h"
#include "inputs/rsm_input.h"
#include "inputs/surfel_set.h"
#include "passes/grid_place.h"
#include "passes/voxel_grid.h"
#include "passes/voxel_visibility.h"
#include "techniques/technique.h"

namespace lightwell {

// What a frame's voxels are made of: triangles, or else surfels.
struct VoxelSurfaces {
    const GeometryInput* triangles = nullptr;
    SurfelSet surfels;
    bool isOther = false;  // than the last frame's were: revisions say nothing
};

class VoxelShadows {
public:
    VoxelShadows(Device& device, std::uint32_t size);

    // Throws what recordVoxels() would say of this frame's triangles, which the grid reaches around also where voxels are made of others.
    void check(const LWFrame& frame) { box_.look(frame); }
    // Passes "grid_place.*" and "voxel_grid.*". forget: of what was left of earlier frames nothing counts.
    void recordVoxels(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const VoxelSurfaces& surfaces, bool forget);
    // Passes "voxel_visibility.*", of those voxels.
    void recordSights(Executor& executor, const std::vector<VoxelVisibility::Clusters>& lists);

    VoxelSights sights() const { return visibility_.sights(); }
    void report(Report& report) const;
    std::uint64_t bytes() const { return place_.bytes() + grid_.bytes() + visibility_.bytes(); }
    // surfels: that voxels are made of, as many as VoxelSurfaces has; 0: triangles.
    static std::uint64_t estimateBytes(std::uint32_t size, std::uint32_t clusters, std::uint64_t surfels, const FrameShape& shape);

private:
    Device& device_;
    GeometryBox box_;
    GridPlace place_;
    VoxelGrid grid_;
    VoxelVisibility visibility_;
};

}  // namespace lightwell
