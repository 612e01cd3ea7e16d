// Ranges, defaults and sweeps of technique cone_tracing's parameters.
#include "techniques/cone_tracing_parameters.h"

#include <cstddef>

#include "techniques/parameter_table.h"

namespace lightwell {
namespace {

constexpr double kSizeValues[] = {32, 64, 128, 256};
constexpr double kSizeSweep[] = {32, 64, 128};
constexpr const char* kModes[] = {"isotropic", "anisotropic", "sh2", nullptr};
constexpr double kModeSweep[] = {LW_VOXEL_MODE_ISOTROPIC, LW_VOXEL_MODE_ANISOTROPIC, LW_VOXEL_MODE_SH2};
constexpr double kConeValues[] = {6, 9, 16, 64, 256};
constexpr double kConeSweep[] = {9, 16, 64};
constexpr const char* kResolutions[] = {"full", "half", "quarter", "interleaved", "half_interleaved", nullptr};
constexpr double kResolutionSweep[] = {LW_CONE_RESOLUTION_HALF, LW_CONE_RESOLUTION_INTERLEAVED};
constexpr const char* kSources[] = {"auto", "triangles", "surfels", "screen", nullptr};
constexpr double kBounceValues[] = {0, 1};
constexpr const char* kAwareness[] = {"off", "on", "two_sided", nullptr};
constexpr const char* kInterpolations[] = {"trilinear", "tetrahedral", nullptr};
constexpr const char* kOcclusions[] = {"off", "all", "near", nullptr};

LWParameter centre(const char* name, std::size_t axis) {
    return parameter(name, "of the grids; with an extent, in frames without a focus", LW_PARAMETER_FLOAT,
                     offsetof(LWConeTracingDesc, center) + axis * sizeof(float), -1e9, 1e9, 0);
}

LWParameter flag(const char* name, const char* description, std::size_t offset, double defaultValue) {
    return parameter(name, description, LW_PARAMETER_BOOL, offset, 0, 1, defaultValue);
}

// What the voxels are.
std::vector<LWParameter> ofVoxels() {
    return {
        swept(allowing(parameter("size",
                                 "voxels along each side of a grid: thinner walls and sharper light; memory grows with its square, as "
                                 "surfaces do, and time a little less",
                                 LW_PARAMETER_UINT, offsetof(LWConeTracingDesc, size), 32, 256, 64),
                       kSizeValues),
              kSizeSweep),
        swept(choosing(parameter("mode",
                                 "of larger voxels: one radiance for all directions, one for each of six (walls stay closed; up to six times "
                                 "the memory, three times the reading), or spherical harmonics of two bands (four times)",
                                 LW_PARAMETER_ENUM, offsetof(LWConeTracingDesc, mode), 0, 2, LW_VOXEL_MODE_ANISOTROPIC),
                       kModes),
              kModeSweep),
        parameter("cascades",
                  "grids of `size` voxels, each half as large as the one around it: finer voxels near the eye (or the middle, without a "
                  "focus); memory and the time of voxels grow with their number",
                  LW_PARAMETER_UINT, offsetof(LWConeTracingDesc, cascades), 1, 4, 1),
        parameter("extent", "length of the largest grid's sides, in units of length; 0: fitted to what lights and geometry reach",
                  LW_PARAMETER_FLOAT, offsetof(LWConeTracingDesc, extent), 0, 1e9, 0),
        centre("center_x", 0),
        centre("center_y", 1),
        centre("center_z", 2),
        choosing(parameter("source",
                           "of voxels: the best that the frame has, its triangles, its surfels, or what RSMs and source views see, in every "
                           "frame anew: what none of them shows is not there",
                           LW_PARAMETER_ENUM, offsetof(LWConeTracingDesc, source), 0, 3, LW_VOXEL_SOURCE_AUTO),
                 kSources),
        allowing(parameter("bounces",
                           "1: one; 0: all, a bounce a frame: light that voxels send on, gathered at every voxel that has a surface; time "
                           "grows with their number",
                           LW_PARAMETER_UINT, offsetof(LWConeTracingDesc, bounces), 0, 1, 1),
                 kBounceValues),
        flag("sparse", "only bricks of voxels that hold something are stored and filtered; off: all, for comparison, with the same light",
             offsetof(LWConeTracingDesc, sparse), 1),
        flag("directional_opacity",
             "of the finest voxels too: light that passes along a wall is not dimmed by it; six times their memory, three times the reading",
             offsetof(LWConeTracingDesc, directionalOpacity), 0),
    };
}

// How they are followed.
std::vector<LWParameter> ofCones() {
    return {
        swept(allowing(parameter("cones",
                                 "that a pixel's light comes in: 6 or 9 of 60 degrees, more and narrower ones of the same weight; time "
                                 "grows with their number and, slowly, with how narrow they are",
                                 LW_PARAMETER_UINT, offsetof(LWConeTracingDesc, cones), 6, 256, 16),
                       kConeValues),
              kConeSweep),
        swept(choosing(parameter("resolution",
                                 "pixels that cones start at: all, one of 4, one of 16, up-sampled after; interleaved: all, with one cone "
                                 "each of those around it, filtered after; half_interleaved: both",
                                 LW_PARAMETER_ENUM, offsetof(LWConeTracingDesc, resolution), 0, 4, LW_CONE_RESOLUTION_INTERLEAVED),
                       kResolutions),
              kResolutionSweep),
        parameter("nudge",
                  "where cones begin, in voxels along the normal: more, and near light is missed; less, and surfaces light and shadow "
                  "themselves",
                  LW_PARAMETER_FLOAT, offsetof(LWConeTracingDesc, nudge), 0, 8, 1),
        parameter("step", "of a cone, in the cells that it reads: less, and bands fade; time grows with its inverse", LW_PARAMETER_FLOAT,
                  offsetof(LWConeTracingDesc, step), 0.125, 1, 1),
        parameter("distance", "that cones reach, in sides of the largest grid: less, and far light is missed; time falls little",
                  LW_PARAMETER_FLOAT, offsetof(LWConeTracingDesc, distance), 1e-3, 2, 1.75),
        flag("opacity_correction", "opacity follows the length of steps; off: each step takes its voxel's as it is, and finer steps darken",
             offsetof(LWConeTracingDesc, opacityCorrection), 1),
        flag("aperture_offset",
             "cones begin further off the wider they are, so that none takes light from its own surface; near light is missed more",
             offsetof(LWConeTracingDesc, apertureOffset), 0),
        choosing(parameter("normal_aware",
                           "cones see of a voxel what faces them alone, light and opacity, so that surfaces neither light nor shadow "
                           "themselves; takes geometry whose triangles or surfels face outwards, and the finest voxels' six sides. two_sided: "
                           "light alone; what faces away is opaque too, and cones read no voxel of the surface that they leave",
                           LW_PARAMETER_ENUM, offsetof(LWConeTracingDesc, normalAware), 0, 2, 1),
                 kAwareness),
        choosing(parameter("occlusion",
                           "what ambient occlusion from voxels dims of the light: nothing, as that has come past the voxels already; all, "
                           "which counts what is hidden twice; or all by what stands nearer than cones begin",
                           LW_PARAMETER_ENUM, offsetof(LWConeTracingDesc, occlusion), 0, 2, LW_CONE_OCCLUSION_OFF),
                 kOcclusions),
        parameter("occlusion_distance", "within which ambient occlusion counts what it meets, in sides of the largest grid",
                  LW_PARAMETER_FLOAT, offsetof(LWConeTracingDesc, occlusionDistance), 1e-3, 2, 0.125),
        parameter("shadow_light", "index of the light whose `shadow` is asked for", LW_PARAMETER_UINT,
                  offsetof(LWConeTracingDesc, shadowLight), 0, 1e6, 0),
        parameter("shadow_angle", "full angle of the shadow's cone, in radians: more, and shadows are softer and cost less",
                  LW_PARAMETER_FLOAT, offsetof(LWConeTracingDesc, shadowAngle), 1e-3, 1.5, 0.1),
        choosing(parameter("interpolation",
                           "between the voxels around each sample: eight, or the four of the tetrahedron that it lies in: a fifth less time, "
                           "up to a sixth more error",
                           LW_PARAMETER_ENUM, offsetof(LWConeTracingDesc, interpolation), 0, 1, LW_CONE_INTERPOLATION_TRILINEAR),
                 kInterpolations),
        parameter("refractive_index", "of what refracted radiance is seen through, to that around it", LW_PARAMETER_FLOAT,
                  offsetof(LWConeTracingDesc, refractiveIndex), 1, 4, 1.5),
    };
}

}  // namespace

const std::vector<LWParameter>& coneTracingParameters() {
    static const std::vector<LWParameter> table = [] {
        std::vector<LWParameter> all = ofVoxels();
        for (const LWParameter& parameter : ofCones()) all.push_back(parameter);
        return all;
    }();
    return table;
}

// Of ten Brug 2017: one radiance for all directions or SH, nine cones, and what faces away counts.
const std::vector<LWSetting>& coneTracingSettings() {
    static const std::vector<LWSetting> settings = {
        {"fast", "size=32 resolution=half"},
        {"fine", "size=128"},
        {"all bounces", "bounces=0"},
        {"cascaded", "cascades=4 size=32"},
        {"thesis 32", "size=32 mode=isotropic cones=9 resolution=full nudge=3.5 normal_aware=off"},
        {"thesis 128", "size=128 mode=isotropic cones=9 resolution=full nudge=3.5 normal_aware=off"},
        {"thesis 128 sh", "size=128 mode=sh2 cones=9 resolution=full nudge=3.5 normal_aware=off"},
        {"thesis 128 sh vao", "size=128 mode=sh2 cones=9 resolution=full nudge=3.5 normal_aware=off occlusion=all"},
    };
    return settings;
}

}  // namespace lightwell

extern "C" void lwDefaultConeTracing(LWConeTracingDesc* desc) {
    if (!desc) return;
    *desc = LWConeTracingDesc{};
    desc->structSize = sizeof *desc;
    desc->size = 64;
    desc->mode = LW_VOXEL_MODE_ANISOTROPIC;
    desc->cones = 16;
    desc->resolution = LW_CONE_RESOLUTION_INTERLEAVED;
    desc->cascades = 1;
    desc->source = LW_VOXEL_SOURCE_AUTO;
    desc->bounces = 1;
    desc->sparse = 1;
    desc->nudge = 1.0f;
    desc->step = 1.0f;
    desc->distance = 1.75f;
    desc->opacityCorrection = desc->normalAware = 1;
    desc->occlusion = LW_CONE_OCCLUSION_OFF;
    desc->occlusionDistance = 0.125f;
    desc->shadowAngle = 0.1f;
    desc->refractiveIndex = 1.5f;
    desc->interpolation = LW_CONE_INTERPOLATION_TRILINEAR;
}
