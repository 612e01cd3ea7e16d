// Ranges, defaults and sweeps of technique ssvp's parameters.
#include "techniques/ssvp_parameters.h"

#include <cstddef>

#include "techniques/history_parameters.h"
#include "techniques/parameter_table.h"

namespace lightwell {
namespace {

constexpr const char* kSamplingNames[] = {"flux", "uniform", "view", nullptr};
constexpr const char* kResolutionNames[] = {"full", "half", "quarter", nullptr};
constexpr const char* kVisibilityNames[] = {"none", "hard", "soft", "voxel", "strict", "careful", nullptr};
constexpr const char* kOccludersNames[] = {"auto", "triangles", "surfels", "screen", nullptr};
constexpr const char* kDirectionsNames[] = {"cosine", "disc", "square", nullptr};
constexpr double kInterleaveValues[] = {1, 2, 4, 8};
constexpr double kGroupValues[] = {1, 2, 4, 8, 16, 32, 64};
constexpr double kMapSizeValues[] = {64, 96, 128, 192, 256, 384, 512};
constexpr double kVplSweep[] = {256, 1024};
constexpr double kClusterSweep[] = {4, 8, 16, 32};
constexpr double kVisibilitySweep[] = {LW_VISIBILITY_HARD, LW_VISIBILITY_SOFT, LW_VISIBILITY_VOXEL, LW_VISIBILITY_STRICT};
constexpr double kVoxelsValues[] = {32, 64, 128, 256};
constexpr double kBouncesSweep[] = {1, 2};
constexpr double kResolutionSweep[] = {LW_RESOLUTION_FULL, LW_RESOLUTION_HALF, LW_RESOLUTION_QUARTER};

std::vector<LWParameter> makeTable() {
    const auto uint = [](const char* name, const char* description, std::size_t offset, double least, double most,
                         double standard) {
        return parameter(name, description, LW_PARAMETER_UINT, offset, least, most, standard);
    };
    const auto oneOf = [](const char* name, const char* description, std::size_t offset, const char* const* names,
                          double most, double standard) {
        return choosing(parameter(name, description, LW_PARAMETER_ENUM, offset, 0, most, standard), names);
    };
    const auto flag = [](const char* name, const char* description, std::size_t offset) {
        return parameter(name, description, LW_PARAMETER_BOOL, offset, 0, 1, 1);
    };
    return {
        swept(uint("vpls", "first-bounce virtual point lights, drawn from all RSMs together; error falls and time grows with it",
                   offsetof(LWSsvpDesc, vpls), 1, 1u << 16, 256),
              kVplSweep),
        oneOf("sampling", "what VPLs are drawn by: reflected flux, every texel alike, or flux by what it brings the surfaces that source views show", offsetof(LWSsvpDesc, sampling),
              kSamplingNames, 2, LW_SAMPLING_FLUX),
        swept(uint("clusters", "of VPLs that share a visibility map: fewer false shadows and leaks, and time, with more; 0: every VPL its own",
                   offsetof(LWSsvpDesc, clusters), 0, 64, 8),
              kClusterSweep),
        allowing(uint("map_size", "texels a side of a cluster's map: finer occluders, memory and drawing time with its square",
                      offsetof(LWSsvpDesc, mapSize), 64, 512, 128),
                 kMapSizeValues),
        swept(oneOf("visibility", "of VPLs: none; the map's nearest texel, its four nearest, or strictly: the nearest, with light past rims as far as the rest bears it out, carefully: light of bounces without shadows, too; past voxels instead of maps",
                    offsetof(LWSsvpDesc, visibility), kVisibilityNames, 5, LW_VISIBILITY_HARD),
              kVisibilitySweep),
        swept(uint("bounces", "indirect bounces; those after the first with VPLs drawn from the maps of the bounce before", offsetof(LWSsvpDesc, bounces), 1, 4, 2),
              kBouncesSweep),
        uint("shadowed_bounces", "bounces whose light is shadowed, by maps of their own clusters: less light through walls, time; of later ones none (visibility=careful with 2 or more: as far as shadowed light bears it out, at least a quarter)",
             offsetof(LWSsvpDesc, shadowedBounces), 1, 4, 2),
        uint("second_vpls", "VPLs of each bounce after the first for each cluster of the one before", offsetof(LWSsvpDesc, secondVpls), 1, 1024, 32),
        oneOf("directions", "in which second-bounce VPLs are drawn: by cosine, evenly on the map's disc, or on its square",
              offsetof(LWSsvpDesc, directions), kDirectionsNames, 2, LW_DIRECTIONS_COSINE),
        flag("warm_start", "clusters start where they were in the frame before", offsetof(LWSsvpDesc, warmStart)),
        allowing(uint("interleave", "n of n x n pixels that share out the VPLs: time falls with n^2, noise at edges grows",
                      offsetof(LWSsvpDesc, interleave), 1, 8, 4),
                 kInterleaveValues),
        allowing(uint("cluster_groups",
                      "of which a pixel is lit by one, its neighbours in the interleave's window by others: time falls, noise at edges grows",
                      offsetof(LWSsvpDesc, clusterGroups), 1, 64, 4),
                 kGroupValues),
        flag("filter", "edge-aware n x n filter after an interleaved gather", offsetof(LWSsvpDesc, filter)),
        swept(oneOf("resolution", "pixels that are gathered; half, quarter: every second or fourth column and row, up-sampled after",
                    offsetof(LWSsvpDesc, resolution), kResolutionNames, 2, LW_RESOLUTION_FULL),
              kResolutionSweep),
        uint("seed", "shift of the sample sets; 0: unshifted", offsetof(LWSsvpDesc, seed), 0, 4294967295.0, 0),
        oneOf("occluders", "what the maps show: the best that the frame has, its triangles, its surfels (or else its triangles, sampled), or what RSMs and source views see",
              offsetof(LWSsvpDesc, occluders), kOccludersNames, 3, LW_OCCLUDERS_AUTO),
        parameter("auto_error", "relative error of the picture for which vpls, clusters and bounces may be fewer, frame by frame: time falls as it is raised; 0: never fewer",
                  LW_PARAMETER_FLOAT, offsetof(LWSsvpDesc, autoError), 0, 1, 0),
        historyParameter(offsetof(LWSsvpDesc, history)),
        historyClampParameter(offsetof(LWSsvpDesc, historyClamp)),
        uint("compensation", "samples a pixel of the surfaces around it, for near light that VPLs of some size lack: corners brighten, time grows; 0: none",
             offsetof(LWSsvpDesc, compensation), 0, 64, 0),
        allowing(uint("voxels", "a side of the grid that visibility=voxel looks through: finer occluders; memory and drawing time with its cube",
                      offsetof(LWSsvpDesc, voxels), 32, 256, 64),
                 kVoxelsValues),
        parameter("auto_resolution", "gathered at half resolution, but for pixels around which light found there differs by more than this share, or that it "
                                     "lacks: time falls as it is raised; 0: as `resolution` says",
                  LW_PARAMETER_FLOAT, offsetof(LWSsvpDesc, autoResolution), 0, 10, 0)};
}

}  // namespace

const std::vector<LWParameter>& ssvpParameters() {
    static const std::vector<LWParameter> table = makeTable();
    return table;
}

// Aranha et al. 2020: 256 VPLs of each bounce, 8 clusters, second-bounce samples evenly on the map's disc.
const std::vector<LWSetting>& ssvpSettings() {
    static const std::vector<LWSetting> settings = {{"Aranha 2020", "sampling=uniform directions=disc shadowed_bounces=1"},
                                                    {"second bounce unshadowed", "shadowed_bounces=1"}};
    return settings;
}

}  // namespace lightwell

extern "C" void lwDefaultSsvp(LWSsvpDesc* desc) {
    if (!desc) return;
    *desc = LWSsvpDesc{};
    desc->structSize = sizeof *desc;
    desc->vpls = 256;
    desc->sampling = LW_SAMPLING_FLUX;
    desc->clusters = 8;
    desc->mapSize = 128;
    desc->visibility = LW_VISIBILITY_HARD;
    desc->bounces = 2;
    desc->shadowedBounces = 2;
    desc->secondVpls = 32;
    desc->directions = LW_DIRECTIONS_COSINE;
    desc->warmStart = 1;
    desc->interleave = 4;
    desc->clusterGroups = 4;
    desc->filter = 1;
    desc->resolution = LW_RESOLUTION_FULL;
    desc->historyClamp = lightwell::TemporalHistoryOptions{}.clamp;
    desc->voxels = 64;
}
