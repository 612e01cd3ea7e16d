// Ranges, defaults and sweeps of technique rsm's parameters.
#include "techniques/rsm_parameters.h"

#include <cstddef>

#include "techniques/history_parameters.h"
#include "techniques/parameter_table.h"

namespace lightwell {
namespace {

constexpr const char* kSamplingNames[] = {"flux", "uniform", "view", nullptr};
constexpr const char* kResolutionNames[] = {"full", "half", "quarter", nullptr};
constexpr const char* kVisibilityNames[] = {"none", "voxel", nullptr};
constexpr double kVoxelsValues[] = {32, 64, 128, 256};
constexpr double kInterleaveValues[] = {1, 2, 4, 8};
constexpr double kInterleaveSweep[] = {1, 4};
constexpr double kVplSweep[] = {64, 256, 1024, 4096};
constexpr double kSamplingSweep[] = {LW_SAMPLING_FLUX, LW_SAMPLING_UNIFORM};
constexpr double kResolutionSweep[] = {LW_RESOLUTION_FULL, LW_RESOLUTION_HALF, LW_RESOLUTION_QUARTER};
constexpr double kVisibilitySweep[] = {LW_RSM_VISIBILITY_NONE, LW_RSM_VISIBILITY_VOXEL};

}  // namespace

const std::vector<LWParameter>& rsmParameters() {
    static const std::vector<LWParameter> table = {
        swept(parameter("vpls", "virtual point lights drawn from all RSMs together; 0: every texel. Error falls and time grows with it",
                        LW_PARAMETER_UINT, offsetof(LWRsmDesc, vpls), 0, 1u << 24, 256),
              kVplSweep),
        swept(choosing(parameter("sampling", "what VPLs are drawn by: reflected flux, every texel alike, or flux by what it brings the surfaces that source views show", LW_PARAMETER_ENUM,
                                 offsetof(LWRsmDesc, sampling), 0, 2, LW_SAMPLING_FLUX),
                       kSamplingNames),
              kSamplingSweep),
        swept(allowing(parameter("interleave", "n of n x n pixels that share out the VPLs: time falls with n^2, noise at edges grows",
                                 LW_PARAMETER_UINT, offsetof(LWRsmDesc, interleave), 1, 8, 4),
                       kInterleaveValues),
              kInterleaveSweep),
        parameter("filter", "edge-aware n x n filter after an interleaved gather", LW_PARAMETER_BOOL,
                  offsetof(LWRsmDesc, filter), 0, 1, 1),
        swept(choosing(parameter("resolution", "pixels that are gathered; half, quarter: every second or fourth column and row, up-sampled after",
                                 LW_PARAMETER_ENUM, offsetof(LWRsmDesc, resolution), 0, 2, LW_RESOLUTION_FULL),
                       kResolutionNames),
              kResolutionSweep),
        parameter("seed", "shift of the sample set; 0: unshifted", LW_PARAMETER_UINT, offsetof(LWRsmDesc, seed), 0,
                  4294967295.0, 0),
        historyParameter(offsetof(LWRsmDesc, history)),
        historyClampParameter(offsetof(LWRsmDesc, historyClamp)),
        swept(choosing(parameter("visibility", "of VPLs: none, or past the voxels that the scene occupies, shared by clusters of VPLs",
                                 LW_PARAMETER_ENUM, offsetof(LWRsmDesc, visibility), 0, 1, LW_RSM_VISIBILITY_NONE),
                       kVisibilityNames),
              kVisibilitySweep),
        allowing(parameter("voxels", "a side of the grid that visibility=voxel looks through: finer occluders; memory and drawing time with its cube",
                           LW_PARAMETER_UINT, offsetof(LWRsmDesc, voxels), 32, 256, 64),
                 kVoxelsValues),
        parameter("auto_resolution", "gathered at half resolution, but for pixels around which light found there differs by more than this share, or that it "
                                     "lacks: time falls as it is raised; 0: as `resolution` says",
                  LW_PARAMETER_FLOAT, offsetof(LWRsmDesc, autoResolution), 0, 10, 0)};
    return table;
}

// Dachsbacher and Stamminger 2005 gather 400 samples of the shadow map at a low resolution, interpolate, and
// repair the pixels where that fails; our half resolution stands for theirs.
const std::vector<LWSetting>& rsmSettings() {
    static const std::vector<LWSetting> settings = {{"Dachsbacher 2005", "vpls=400 interleave=1 resolution=half"}};
    return settings;
}

}  // namespace lightwell

extern "C" void lwDefaultRsm(LWRsmDesc* desc) {
    if (!desc) return;
    *desc = LWRsmDesc{};
    desc->structSize = sizeof *desc;
    desc->vpls = 256;
    desc->sampling = LW_SAMPLING_FLUX;
    desc->interleave = 4;
    desc->filter = 1;
    desc->resolution = LW_RESOLUTION_FULL;
    desc->historyClamp = lightwell::TemporalHistoryOptions{}.clamp;
    desc->visibility = LW_RSM_VISIBILITY_NONE;
    desc->voxels = 64;
}
