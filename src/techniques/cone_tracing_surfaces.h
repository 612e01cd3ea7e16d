// Technique cone_tracing: what is made voxels of, from which of the host's inputs.
#pragma once

#include <cstdint>
#include <vector>

#include "inputs/frame_shape.h"
#include "inputs/geometry_input.h"
#include "inputs/rsm_input.h"
#include "inputs/screen_surfels.h"
#include "inputs/surfel_input.h"
#include "passes/voxel_grid.h"
#include "techniques/technique.h"

namespace lightwell {

class ConeTracingSurfaces {
public:
    enum class Source { none, triangles, surfels, screen };  // none: before the first frame

    // hidden: for twins that prewarm, of so many kinds of geometry frames are taken to have none: 1: triangles, 2: nor surfels.
    ConeTracingSurfaces(Device& device, const LWConeTracingDesc& desc, int hidden) : device_(device), desc_(desc), hidden_(hidden) {}

    // Throws what import() would say of this frame, whose RSMs are RsmInput's to check.
    void check(const LWFrame& frame) const;
    // True where grids must be made anew whatever their revision.
    bool import(Executor& executor, const LWFrame& frame, const RsmInput& rsms);
    // One grid's voxels of them. place: LwGridPlace.
    void record(Executor& executor, VoxelGrid& grid, const Buffer& place) const;

    Source source() const { return source_; }  // of the last import()
    // What of the frame's geometry and views is used, and what is not.
    std::vector<LWChoice> choices(const LWFrame& frame) const;
    void report(Report& report) const;
    std::uint64_t bytes() const { return triangles_.bytes() + surfels_.bytes() + screen_.bytes(); }
    // With what the grids keep of surfels.
    static std::uint64_t estimateBytes(const LWConeTracingDesc& desc, const FrameShape& shape);

private:
    static Source chosen(LWVoxelSource source, std::uint32_t triangles, std::uint32_t surfels);
    Source sourceOf(const LWFrame& frame) const;

    Device& device_;
    LWConeTracingDesc desc_;
    int hidden_;
    Source source_ = Source::none;
    GeometryInput triangles_;
    SurfelInput surfels_;
    ScreenSurfels screen_;
};

}  // namespace lightwell
