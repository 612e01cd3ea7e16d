// Ranges, defaults and sweeps of technique ao's parameters.
#include "techniques/ao_parameters.h"

#include <cstddef>

#include "techniques/history_parameters.h"
#include "techniques/parameter_table.h"

namespace lightwell {
namespace {

constexpr const char* kMethodNames[] = {"ssao", "ssdo", nullptr};
constexpr const char* kResolutionNames[] = {"full", "half", nullptr};
constexpr const char* kWeightingNames[] = {"cosine", "uniform", nullptr};
constexpr double kSampleSweep[] = {8, 16, 64};
constexpr double kRadiusSweep[] = {0.05, 0.2, 1};
constexpr double kPackingSweep[] = {0, 1};
constexpr double kResolutionSweep[] = {LW_RESOLUTION_FULL, LW_RESOLUTION_HALF};

}  // namespace

const std::vector<LWParameter>& aoParameters() {
    static const std::vector<LWParameter> table = {
        choosing(parameter("method", "ssao: ambient occlusion alone; ssdo: and one bounce from what occludes", LW_PARAMETER_ENUM,
                           offsetof(LWAoDesc, method), 0, 1, LW_AO_SSDO),
                 kMethodNames),
        swept(parameter("samples", "points in each pixel's hemisphere: error falls and time grows with them", LW_PARAMETER_UINT,
                        offsetof(LWAoDesc, samples), 4, 64, 16),
              kSampleSweep),
        swept(parameter("radius", "of the hemisphere, in image heights at the pixel's depth: light from farther away is missed, few points miss what is small",
                        LW_PARAMETER_FLOAT, offsetof(LWAoDesc, radius), 1e-3, 10, 0.2),
              kRadiusSweep),
        swept(parameter("packing", "points crowd towards the pixel; off: all at the radius", LW_PARAMETER_BOOL,
                        offsetof(LWAoDesc, packing), 0, 1, 1),
              kPackingSweep),
        parameter("range_check", "what is nearer to the eye by more than the radius hides nothing", LW_PARAMETER_BOOL,
                  offsetof(LWAoDesc, rangeCheck), 0, 1, 1),
        parameter("filter", "edge-aware 4 x 4 blur over the rotations of the points", LW_PARAMETER_BOOL,
                  offsetof(LWAoDesc, filter), 0, 1, 1),
        swept(choosing(parameter("resolution", "pixels that are gathered; half: every second column and row, up-sampled after",
                                 LW_PARAMETER_ENUM, offsetof(LWAoDesc, resolution), 0, 1, LW_RESOLUTION_HALF),
                       kResolutionNames),
              kResolutionSweep),
        choosing(parameter("weighting", "of the points' directions: by their cosine, or all alike", LW_PARAMETER_ENUM,
                           offsetof(LWAoDesc, weighting), 0, 1, LW_AMBIENT_COSINE),
                 kWeightingNames),
        historyParameter(offsetof(LWAoDesc, history)),
        historyClampParameter(offsetof(LWAoDesc, historyClamp))};
    return table;
}

const std::vector<LWSetting>& aoSettings() {
    static const std::vector<LWSetting> settings = {{"SSDO far", "radius=1 packing=off"}};
    return settings;
}

}  // namespace lightwell

extern "C" void lwDefaultAo(LWAoDesc* desc) {
    if (!desc) return;
    *desc = LWAoDesc{};
    desc->structSize = sizeof *desc;
    desc->method = LW_AO_SSDO;
    desc->samples = 16;
    desc->radius = 0.2f;
    desc->packing = 1;
    desc->rangeCheck = 1;
    desc->filter = 1;
    desc->resolution = LW_RESOLUTION_HALF;
    desc->weighting = LW_AMBIENT_COSINE;
    desc->historyClamp = lightwell::TemporalHistoryOptions{}.clamp;
}
