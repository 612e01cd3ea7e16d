// Light of a voxel volume along a few cones at a view's pixels or at points (kernels/cone_gather).
// docs/techniques/cone_gather.md.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "passes/cone_directions.h"
#include "passes/harmonics.h"
#include "passes/voxel_volume.h"

namespace lightwell {

struct ConeGatherOptions {
    std::uint32_t size = 128, cascades = 1;
    LWVoxelMode mode = LW_VOXEL_MODE_ISOTROPIC;
    bool sides = false;  // VoxelVolume's
    std::uint32_t cones = 9;
    bool interleaved = false;
    double nudge = 1.0;     // voxels along the normal
    double step = 1.0;      // cells
    double distance = 1.0;  // sides of the largest grid
    bool opacityCorrection = true, apertureOffset = false;
    bool near = false;               // light is dimmed by what stands nearer than where cones begin
    double occlusionDistance = 1.0;  // sides of the largest grid
    bool startPlane = false;  // samples see voxels before the plane of the surface that a cone leaves alone
    bool tetrahedral = false;        // samples are interpolated between four voxels, not eight
};

// What cones are traced in.
struct ConeWorld {
    const VoxelVolume& volume;
    const Buffer& places;      // LwGridPlace of each cascade, finest first
    const float* environment;  // radiance of three colours, of what nothing stops
};

class ConeGather {
public:
    ConeGather(Device& device, const ConeGatherOptions& options);

    // Pass "cone_gather.trace" (".trace_open" of ambient occlusion alone). irradiance, validity, open:
    // none where not wanted; interleaved, `irradiance` has kGathered planes, which recordFilter makes
    // the three of, and the others are left. counts: kCounts ints, raised by the number of pixels that
    // are neither surface nor background, of those whose light was brought down, and of surfaces that
    // the grid does not have. wantsOpen: interleaved, whether ambient occlusion is among what is
    // gathered.
    static constexpr std::size_t kCounts = 3;
    static constexpr std::uint32_t kGathered = 6;  // the last one of ambient occlusion alone
    void recordTrace(Executor& executor, const Planes& position, const Planes& normal,
                     const ConeWorld& world, const Planes& irradiance, const Planes& validity,
                     const Planes& open, const Buffer& counts, bool wantsOpen = false);
    // Pass "cone_gather.filter". Interleaved only. Of the results each may be empty.
    void recordFilter(Executor& executor, const Planes& position, const Planes& normal,
                      const Planes& gathered, const Planes& irradiance, const Planes& validity,
                      const Planes& open);

    // Pass "cone_gather.harmonics": the light that arrives at points, in two bands of spherical
    // harmonics, from cones over the sphere. `normal` may be empty; points with one begin off their
    // surface. harmonics, validity: none where not wanted. counts: the second and third of those.
    void recordHarmonics(Executor& executor, const Planes& position, const Planes& normal,
                         const ConeWorld& world, const Harmonics& harmonics, const Planes& validity,
                         const Buffer& counts);

    const ConeGatherOptions& options() const { return options_; }
    std::uint64_t bytes() const {
        return cones_.bytes() + steps_.bytes() + sphereCones_.bytes() + sphereSteps_.bytes();
    }
    static std::uint64_t estimateBytes(const ConeGatherOptions& options);

private:
    void prepare(Executor& executor);
    Kernel& traceOf(bool light, bool open);
    Kernel& filterOf(bool open);

    Device& device_;
    ConeGatherOptions options_;
    ConeWindow window_;
    Buffer cones_, steps_, sphereCones_, sphereSteps_;
    lw_int sphereCount_ = 0;
    bool isUploaded_ = false;
};

// A table of cones on the device, and where their steps end.
void uploadCones(Executor& executor, const ConeTable& table, Buffer& cones, Buffer& steps);
ConeSchedule coneSchedule(const ConeGatherOptions& options);
// What all kernels of the pass take of a frame; reach in voxels.
LwConeView coneView(const ConeWorld& world, const ConeGatherOptions& options);

// Kernels' view of a volume, and the options that its programs are built with.
LwConeGrids coneGrids(const VoxelVolume& volume);
Defines coneDefines(const ConeGatherOptions& options, bool light, bool open);

}  // namespace lightwell
