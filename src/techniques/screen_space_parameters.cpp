// Ranges, defaults and sweeps of technique screen_space's parameters, and the settings of its paper.
#include "techniques/screen_space_parameters.h"

#include <cstddef>

#include "techniques/history_parameters.h"
#include "techniques/parameter_table.h"

namespace lightwell {
namespace {

constexpr const char* kStartNames[] = {"full", "half", "quarter", nullptr};
constexpr double kSampleValues[] = {8, 16, 32, 64, 128, 256};
constexpr double kInterleaveValues[] = {1, 2, 4};
constexpr double kStartSweep[] = {LW_START_HALF, LW_START_QUARTER};
constexpr double kLevelSweep[] = {3, 4, 5};
constexpr double kSampleSweep[] = {16, 64, 256};

}  // namespace

const std::vector<LWParameter>& screenSpaceParameters() {
    static const std::vector<LWParameter> table = {
        swept(choosing(parameter("start", "resolution that the first level is gathered at; halving it quarters the time and doubles the reach",
                                 LW_PARAMETER_ENUM, offsetof(LWScreenSpaceDesc, start), 0, 2, LW_START_QUARTER),
                       kStartNames),
              kStartSweep),
        swept(parameter("levels", "levels of the pyramid; each more doubles the reach and costs a quarter of the one before",
                        LW_PARAMETER_UINT, offsetof(LWScreenSpaceDesc, levels), 1, 6, 4),
              kLevelSweep),
        swept(allowing(parameter("samples", "texels gathered per texel and level; noise falls and time grows with it", LW_PARAMETER_UINT,
                                 offsetof(LWScreenSpaceDesc, samples), 8, 256, 64),
                       kSampleValues),
              kSampleSweep),
        parameter("radius", "inner radius of a level's ring, in its texels, of an image 720 rows high: reach grows with it, near light gets coarser",
                  LW_PARAMETER_FLOAT, offsetof(LWScreenSpaceDesc, radius), 1, 64, 20),
        allowing(parameter("interleave", "n of n x n texels with sample patterns of their own and a filter of that size; 1: one pattern for all",
                           LW_PARAMETER_UINT, offsetof(LWScreenSpaceDesc, interleave), 1, 4, 4),
                 kInterleaveValues),
        parameter("bounded", "point-to-disc form factor; off: the unbounded one, with spikes where surfaces meet", LW_PARAMETER_BOOL,
                  offsetof(LWScreenSpaceDesc, bounded), 0, 1, 1),
        parameter("cameras", "light that the frame's other source views see, too; costs as much again for each", LW_PARAMETER_BOOL,
                  offsetof(LWScreenSpaceDesc, cameras), 0, 1, 0),
        parameter("seed", "another set of samples; 0: unshifted", LW_PARAMETER_UINT, offsetof(LWScreenSpaceDesc, seed), 0, 4294967295.0, 0),
        historyParameter(offsetof(LWScreenSpaceDesc, history)),
        historyClampParameter(offsetof(LWScreenSpaceDesc, historyClamp)),
        parameter("auto_error", "relative error of the picture for which samples and levels may be fewer and start coarser, frame by frame: time falls as it is raised; 0: always the most",
                  LW_PARAMETER_FLOAT, offsetof(LWScreenSpaceDesc, autoError), 0, 1, 0)};
    return table;
}

const std::vector<LWSetting>& screenSpaceSettings() {
    // Soler et al. 2009, fig. 6, but the first, which is the default.
    static const std::vector<LWSetting> settings = {{"Soler 2009 quarter, 4 x 256", "start=quarter levels=4 samples=256"},
                                                    {"Soler 2009 half, 4 x 64", "start=half levels=4 samples=64"},
                                                    {"Soler 2009 half, 4 x 256", "start=half levels=4 samples=256"},
                                                    {"Soler 2009 half, 5 x 64", "start=half levels=5 samples=64"}};
    return settings;
}

}  // namespace lightwell

extern "C" void lwDefaultScreenSpace(LWScreenSpaceDesc* desc) {
    if (!desc) return;
    *desc = LWScreenSpaceDesc{};
    desc->structSize = sizeof *desc;
    desc->start = LW_START_QUARTER;
    desc->levels = 4;
    desc->samples = 64;
    desc->radius = 20.0f;
    desc->interleave = 4;
    desc->bounded = 1;
    desc->historyClamp = lightwell::TemporalHistoryOptions{}.clamp;
}
