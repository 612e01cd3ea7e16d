// Ranges, defaults and sweeps of technique static_vpl's parameters.
#include "techniques/static_vpl_parameters.h"

#include <cstddef>

#include "techniques/parameter_table.h"

namespace lightwell {
namespace {

constexpr const char* kVariantNames[] = {"static", "phantom", nullptr};
constexpr const char* kResolutionNames[] = {"full", "half", "quarter", nullptr};
constexpr const char* kVisibilityNames[] = {"none", "hard", "soft", "voxel", "strict", nullptr};
constexpr const char* kOccludersNames[] = {"auto", "triangles", "surfels", nullptr};
constexpr double kMapSizeValues[] = {64, 96, 128, 192, 256, 384, 512};
constexpr double kVoxelsValues[] = {32, 64, 128, 256};
constexpr double kVisibilitySweep[] = {LW_VISIBILITY_NONE, LW_VISIBILITY_HARD};
constexpr double kInterleaveValues[] = {1, 2, 4, 8};
constexpr double kVariantSweep[] = {LW_STATIC_VPL_STATIC, LW_STATIC_VPL_PHANTOM};
constexpr double kBounceSweep[] = {1, 2};
constexpr double kInterleaveSweep[] = {1, 2};
constexpr double kResolutionSweep[] = {LW_RESOLUTION_FULL, LW_RESOLUTION_HALF, LW_RESOLUTION_QUARTER};

LWParameter real(const char* name, const char* description, std::size_t offset, double least,
                 double most, double value) {
    return parameter(name, description, LW_PARAMETER_FLOAT, offset, least, most, value);
}

LWParameter whole(const char* name, const char* description, std::size_t offset, double least,
                  double most, double value) {
    return parameter(name, description, LW_PARAMETER_UINT, offset, least, most, value);
}

}  // namespace

const std::vector<LWParameter>& staticVplParameters() {
    using Desc = LWStaticVplDesc;
    static const std::vector<LWParameter> table = {
        swept(choosing(parameter("variant",
                                 "what spot lights light: the static VPLs, or one phantom VPL each "
                                 "where their axis meets the scene",
                                 LW_PARAMETER_ENUM, offsetof(Desc, variant), 0, 1, LW_STATIC_VPL_STATIC),
                       kVariantNames),
              kVariantSweep),
        swept(whole("bounces",
                    "2: the light of VPLs comes back once more, from what is taken to lie opposite",
                    offsetof(Desc, bounces), 1, 2, 1),
              kBounceSweep),
        real("average_reflectance", "of what lies opposite; the second bounce grows in proportion",
             offsetof(Desc, averageReflectance), 0, 1, 0.5),
        real("second_distance",
             "of what lies opposite the static VPLs, m; 0: a mean side of their bounding box",
             offsetof(Desc, secondDistance), 0, 1e9, 0),
        real("second_area",
             "of what lies opposite, m^2: what it does not catch is lost; 0: it catches all",
             offsetof(Desc, secondArea), 0, 1e18, 0),
        real("unit_area", "m^2 that a VPL's weight of 1 stands for; all light grows in proportion",
             offsetof(Desc, unitArea), 1e-30, 1e18, 1),
        parameter(
            "automatic_weights",
            "as if all weights were 0: each VPL stands for a disc half-way to the nearest other one",
            LW_PARAMETER_BOOL, offsetof(Desc, automaticWeights), 0, 1, 0),
        whole("comparisons",
              "distances a frame between VPLs, for weights that are 0: time grows, the lag of moving "
              "VPLs' areas falls",
              offsetof(Desc, comparisons), 1, 1u << 24, 1u << 15),
        real("cull_relative",
             "VPLs weaker than this share of the strongest are left out: time falls, dim light is lost",
             offsetof(Desc, cullRelative), 0, 1, 1e-3),
        real("cull_absolute", "above 0: VPLs weaker than this are left out instead, W/sr",
             offsetof(Desc, cullAbsolute), 0, 1e30, 0),
        real("hysteresis", "how much stronger a VPL must be to come back: less coming and going, later",
             offsetof(Desc, hysteresis), 1, 100, 2),
        real("smoothing", "share of its last frame's place and look that a phantom keeps: calmer, later",
             offsetof(Desc, smoothing), 0, 0.99, 0),
        whole("lights", "that the light list has at most: nearer to all VPLs, more for the host to draw",
              offsetof(Desc, lights), 1, 64, 16),
        swept(allowing(whole("interleave",
                             "n of n x n pixels that share out the VPLs: time falls with n^2, a pattern "
                             "shows where they are few",
                             offsetof(Desc, interleave), 1, 8, 1),
                       kInterleaveValues),
              kInterleaveSweep),
        parameter("filter", "edge-aware n x n filter after an interleaved gather", LW_PARAMETER_BOOL,
                  offsetof(Desc, filter), 0, 1, 1),
        swept(
            choosing(parameter(
                         "resolution",
                         "pixels that are gathered; half, quarter: every second or fourth column and row, up-sampled after",
                         LW_PARAMETER_ENUM, offsetof(Desc, resolution), 0, 2, LW_RESOLUTION_FULL),
                     kResolutionNames),
            kResolutionSweep),
        swept(choosing(
                  parameter(
                      "visibility",
                      "of VPLs: none, or past the frame's geometry, by a map's nearest texel, its four "
                      "nearest, strictly (light past rims as far as the rest bears it out), or voxels: no light through walls, time and memory",
                      LW_PARAMETER_ENUM, offsetof(Desc, visibility), 0, 4, LW_VISIBILITY_NONE),
                  kVisibilityNames),
              kVisibilitySweep),
        whole("clusters",
              "VPLs up to which each sees for itself; more share so many maps or sweeps: fewer false "
              "shadows with "
              "more of them, memory and time; 0: always each for itself",
              offsetof(Desc, clusters), 0, 64, 32),
        allowing(
            whole("map_size",
                  "texels a side of a map: finer occluders, memory and drawing time with its square",
                  offsetof(Desc, mapSize), 64, 512, 128),
            kMapSizeValues),
        choosing(parameter(
                     "occluders",
                     "what shadows: the frame's triangles if it has some, else its surfels (or else its "
                     "triangles, sampled)",
                     LW_PARAMETER_ENUM, offsetof(Desc, occluders), 0, 2, LW_OCCLUDERS_AUTO),
                 kOccludersNames),
        real("lift",
             "how far off its surface a VPL looks from, of its disc's radius: fewer in the dark that "
             "lie inside; "
             "what is near casts less shadow",
             offsetof(Desc, lift), 0, 1, 0.05),
        whole("shadowed_bounces", "2: of the second bounce's VPLs too, which may lie behind walls",
              offsetof(Desc, shadowedBounces), 1, 2, 1),
        allowing(whole("voxels",
                       "a side of the grid that visibility=voxel looks through: finer occluders; memory "
                       "and drawing "
                       "time with its cube",
                       offsetof(Desc, voxels), 32, 256, 64),
                 kVoxelsValues)};
    return table;
}

// The paper culls at an absolute intensity, without hysteresis.
const std::vector<LWSetting>& staticVplSettings() {
    static const std::vector<LWSetting> settings = {
        {"Papaioannou 2025, static", "automatic_weights=on cull_absolute=0.01 hysteresis=1 bounces=2"},
        {"Papaioannou 2025, phantom",
         "variant=phantom automatic_weights=on cull_absolute=0.01 hysteresis=1 bounces=2"}};
    return settings;
}

}  // namespace lightwell

extern "C" void lwDefaultStaticVpl(LWStaticVplDesc* desc) {
    if (!desc) return;
    *desc = LWStaticVplDesc{};
    desc->structSize = sizeof *desc;
    desc->variant = LW_STATIC_VPL_STATIC;
    desc->bounces = 1;
    desc->averageReflectance = 0.5f;
    desc->unitArea = 1.0f;
    desc->comparisons = 1u << 15;
    desc->cullRelative = 1e-3f;
    desc->hysteresis = 2.0f;
    desc->lights = 16;
    desc->interleave = 1;
    desc->filter = 1;
    desc->resolution = LW_RESOLUTION_FULL;
    desc->visibility = LW_VISIBILITY_NONE;
    desc->clusters = 32;
    desc->mapSize = 128;
    desc->occluders = LW_OCCLUDERS_AUTO;
    desc->lift = 0.05f;
    desc->shadowedBounces = 1;
    desc->voxels = 64;
}
