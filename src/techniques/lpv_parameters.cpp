// Ranges, defaults and sweeps of technique lpv's parameters.
#include "techniques/lpv_parameters.h"

#include <cstddef>

#include "techniques/parameter_table.h"

namespace lightwell {
namespace {

constexpr double kSizeValues[] = {16, 32, 64, 128};
constexpr double kSizeSweep[] = {16, 32, 64};
constexpr double kStepSweep[] = {0, 8, 16, 32};
constexpr const char* kVolumeNames[] = {"off", "auto", "triangles", "surfels", "screen", nullptr};
constexpr const char* kTransports[] = {"propagate", "sweep", "coarse_to_fine", nullptr};
constexpr double kDirectionValues[] = {24, 48, 96, 216, 384, 864, 1536};
constexpr double kFrameValues[] = {1, 2, 4, 6, 8, 12, 24};
constexpr double kCascadeSweep[] = {1, 3};
constexpr const char* kResolutionNames[] = {"full", "half", nullptr};
constexpr double kResolutionSweep[] = {LW_RESOLUTION_FULL, LW_RESOLUTION_HALF};

LWParameter centre(const char* name, std::size_t axis) {
    return parameter(name, "of the grid; with an extent, in frames without a focus", LW_PARAMETER_FLOAT,
                     offsetof(LWLpvDesc, center) + axis * sizeof(float), -1e9, 1e9, 0);
}

}  // namespace

const std::vector<LWParameter>& lpvParameters() {
    static const std::vector<LWParameter> table = {
        swept(allowing(parameter("size",
                                 "cells along each side of the grid: finer light, thinner leaks; time and memory grow with its cube, and "
                                 "the same steps bring light less far",
                                 LW_PARAMETER_UINT, offsetof(LWLpvDesc, size), 16, 128, 32),
                       kSizeValues),
              kSizeSweep),
        swept(parameter("steps",
                        "of propagation, each as far as the next cell; 0: twice the size. Time grows with it, range with its "
                        "square root. coarse_to_fine: on each grid; 0: 4, and 128 on the coarsest",
                        LW_PARAMETER_UINT, offsetof(LWLpvDesc, steps), 0, 1024, 0),
              kStepSweep),
        parameter("auto_error",
                  "of propagation: steps end, `steps` at most, once no more than this share of the light put in is still on its way; "
                  "0: never sooner",
                  LW_PARAMETER_FLOAT, offsetof(LWLpvDesc, autoError), 0, 1, 0),
        parameter("extent", "length of the (coarsest) grid's sides, in units of length; 0: fitted to what the lights and the triangles reach",
                  LW_PARAMETER_FLOAT, offsetof(LWLpvDesc, extent), 0, 1e9, 0),
        centre("center_x", 0),
        centre("center_y", 1),
        centre("center_z", 2),
        choosing(parameter("geometry_volume",
                           "what blocks light between cells: nothing, the best that the frame has, its triangles, its surfels "
                           "(or else its triangles), or what RSMs and source views see; walls leak less, steps take longer",
                           LW_PARAMETER_ENUM, offsetof(LWLpvDesc, geometryVolume), 0, 4, LW_GEOMETRY_VOLUME_AUTO),
                 kVolumeNames),
        parameter("damping",
                  "of light that grows weaker away from the surface it is read at, which comes from behind: less of it leaks, and "
                  "reading takes 2.5 times as long",
                  LW_PARAMETER_BOOL, offsetof(LWLpvDesc, damping), 0, 1, 0),
        choosing(parameter("transport",
                           "propagate: from cell to cell; sweep: straight, in a fixed set of directions, stopped by surfaces, to 64 cells "
                           "a side; coarse_to_fine: from cell to cell on a pyramid of grids, a few steps on each",
                           LW_PARAMETER_ENUM, offsetof(LWLpvDesc, transport), 0, 2, 0),
                 kTransports),
        allowing(parameter("directions",
                           "of sweeps: few make beams of small lights, 6 (size / 4)^2 and more do not; time grows with their number",
                           LW_PARAMETER_UINT, offsetof(LWLpvDesc, directions), 24, 1536, 384),
                 kDirectionValues),
        parameter("bounces", "of sweeps: light that surfels or triangles send on again; each takes a sweep", LW_PARAMETER_UINT,
                  offsetof(LWLpvDesc, bounces), 1, 8, 1),
        allowing(parameter("frames",
                           "that the directions of a bounce's sweep are spread over: less time a frame, and light as many frames late",
                           LW_PARAMETER_UINT, offsetof(LWLpvDesc, frames), 1, 24, 1),
                 kFrameValues),
        swept(choosing(parameter("resolution", "pixels that light is read at; half: every second column and row, up-sampled after",
                                 LW_PARAMETER_ENUM, offsetof(LWLpvDesc, resolution), 0, 1, LW_RESOLUTION_FULL),
                       kResolutionNames),
              kResolutionSweep),
        parameter("rests", "light that is as it was in the frame before is not carried again, with the same result: still lights take less time; of one "
                           "bounce in one grid",
                  LW_PARAMETER_BOOL, offsetof(LWLpvDesc, rests), 0, 1, 0),
        swept(parameter("cascades",
                        "grids of `size` cells, each half as large as the one around it: finer light near the eye (or the middle, without a "
                        "focus); time grows with twice their number",
                        LW_PARAMETER_UINT, offsetof(LWLpvDesc, cascades), 1, 6, 1),
              kCascadeSweep)};
    return table;
}

const std::vector<LWSetting>& lpvSettings() {
    static const std::vector<LWSetting> settings = {{"fast", "size=16 steps=16"}, {"fine", "size=64 steps=32"}, {"sweep", "transport=sweep size=16"},
                                                   {"sweep fine", "transport=sweep size=32"},
                                                   {"cascaded", "cascades=3"}, {"sweep cascaded", "transport=sweep size=16 cascades=3"}};
    return settings;
}

}  // namespace lightwell

extern "C" void lwDefaultLpv(LWLpvDesc* desc) {
    if (!desc) return;
    *desc = LWLpvDesc{};
    desc->structSize = sizeof *desc;
    desc->size = 32;
    desc->geometryVolume = LW_GEOMETRY_VOLUME_AUTO;
    desc->transport = LW_LPV_TRANSPORT_PROPAGATE;
    desc->directions = 384;
    desc->bounces = desc->frames = 1;
    desc->resolution = LW_RESOLUTION_FULL;
    desc->cascades = 1;
}
