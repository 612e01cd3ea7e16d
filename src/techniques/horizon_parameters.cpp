// Ranges, defaults and sweeps of technique horizon's parameters.
#include "techniques/horizon_parameters.h"

#include <cstddef>

#include "techniques/history_parameters.h"
#include "techniques/parameter_table.h"

namespace lightwell {
namespace {

constexpr const char* kResolutionNames[] = {"full", "half", nullptr};
constexpr const char* kWeightingNames[] = {"cosine", "uniform", nullptr};
constexpr double kDirectionValues[] = {4, 8, 16, 24, 40, 48};
constexpr double kStepValues[] = {1, 2, 4, 8};
constexpr double kInterleaveValues[] = {1, 2, 4, 8, 16};
constexpr double kDirectionSweep[] = {8, 16, 40};
constexpr double kStepSweep[] = {1, 2, 4};
constexpr double kThicknessSweep[] = {0.03, 0.1};
constexpr double kResolutionSweep[] = {LW_RESOLUTION_FULL, LW_RESOLUTION_HALF};

}  // namespace

const std::vector<LWParameter>& horizonParameters() {
    static const std::vector<LWParameter> table = {
        swept(allowing(parameter("directions", "slices of the hemisphere: error falls and time grows with them", LW_PARAMETER_UINT,
                                 offsetof(LWHorizonDesc, directions), 4, 48, 16),
                       kDirectionValues),
              kDirectionSweep),
        swept(allowing(parameter("steps", "along each side of a slice whenever the distance doubles: what is thin is missed with few",
                                 LW_PARAMETER_UINT, offsetof(LWHorizonDesc, steps), 1, 8, 2),
                       kStepValues),
              kStepSweep),
        allowing(parameter("interleave", "rows of pixels that share out the slices, or the most rows that do so evenly: time falls with it, noise at edges grows",
                           LW_PARAMETER_UINT, offsetof(LWHorizonDesc, interleave), 1, 16, 8),
                 kInterleaveValues),
        parameter("filter", "edge-aware filter over the rows that share out the slices", LW_PARAMETER_BOOL,
                  offsetof(LWHorizonDesc, filter), 0, 1, 1),
        swept(choosing(parameter("resolution", "pixels that are gathered; half: every second column and row, up-sampled after",
                                 LW_PARAMETER_ENUM, offsetof(LWHorizonDesc, resolution), 0, 1, LW_RESOLUTION_HALF),
                       kResolutionNames),
              kResolutionSweep),
        parameter("reach", "how far a pixel looks, in image heights: light from farther away is missed", LW_PARAMETER_FLOAT,
                  offsetof(LWHorizonDesc, reach), 1e-3, 4, 1),
        swept(parameter("thickness", "of everything along the view, in image heights at its depth: thin things leak with little, hide too much with much",
                        LW_PARAMETER_FLOAT, offsetof(LWHorizonDesc, thickness), 0, 10, 0.03),
              kThicknessSweep),
        parameter("ambient_radius", "what ambient occlusion counts lies nearer, in image heights at the pixel's depth", LW_PARAMETER_FLOAT,
                  offsetof(LWHorizonDesc, ambientRadius), 1e-6, 1e6, 0.2),
        choosing(parameter("weighting", "of ambient occlusion: directions by their cosine, or all alike", LW_PARAMETER_ENUM,
                           offsetof(LWHorizonDesc, weighting), 0, 1, LW_AMBIENT_COSINE),
                 kWeightingNames),
        historyParameter(offsetof(LWHorizonDesc, history)),
        historyClampParameter(offsetof(LWHorizonDesc, historyClamp))};
    return table;
}

const std::vector<LWSetting>& horizonSettings() {
    static const std::vector<LWSetting> settings = {
        {"fast", "directions=8"},
        {"near", "reach=0.25"},
        {"fine", "directions=16 steps=4 interleave=1 resolution=full"},
        {"limit", "directions=40 steps=8 interleave=1 resolution=full"}};
    return settings;
}

}  // namespace lightwell

extern "C" void lwDefaultHorizon(LWHorizonDesc* desc) {
    if (!desc) return;
    *desc = LWHorizonDesc{};
    desc->structSize = sizeof *desc;
    desc->directions = 16;
    desc->steps = 2;
    desc->interleave = 8;
    desc->filter = 1;
    desc->resolution = LW_RESOLUTION_HALF;
    desc->reach = 1.0f;
    desc->thickness = 0.03f;
    desc->ambientRadius = 0.2f;
    desc->weighting = LW_AMBIENT_COSINE;
    desc->historyClamp = lightwell::TemporalHistoryOptions{}.clamp;
}
