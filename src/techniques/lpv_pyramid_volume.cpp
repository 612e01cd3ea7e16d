#include "techniques/lpv_pyramid_volume.h"

#include <optional>

#include "compute/device.h"

namespace lightwell {

LpvPyramidVolume::LpvPyramidVolume(Device& device, const LWLpvDesc& desc)
    : device_(device),
      desc_(desc),
      calibration_(LpvPyramid::calibration(desc.size, desc.steps, desc.geometryVolume != LW_GEOMETRY_VOLUME_OFF)),
      geometry_(device, desc, LpvPyramid::levelsOf(desc.size)),
      grid_(device, desc.size),
      pyramid_(device, desc.size, desc.steps),
      read_(device, desc.size),
      specular_(device, desc.size) {}

void LpvPyramidVolume::record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const LpvPlacement& placement) {
    geometry_.import(executor, frame, rsms);
    grid_.record(executor, rsms, frame.vpls, frame.vplCount, placement, frame.environment);
    std::optional<LpvBlockers> blockers;
    propagated_ = &pyramid_.record(executor, grid_.injected(), grid_.place(), [&](std::uint32_t level, const Buffer& place) {
        const std::optional<LpvBlockers> found = geometry_.record(executor, place, level);
        if (found) blockers.emplace(*found);
        return found ? &*blockers : nullptr;
    });
    read_.recordPack(executor, *propagated_);
    specular_.startFrame(frame.environment);
}

void LpvPyramidVolume::recordGather(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                                    const Planes& validity, const Buffer& counts) {
    read_.recordGather(executor, position, normal, grid_.place(), calibration_, desc_.damping != 0, irradiance, validity, counts);
}

void LpvPyramidVolume::recordHarmonics(Executor& executor, const Planes& position, const Planes& normal, const Harmonics& harmonics,
                                       const Planes& validity, const Buffer& counts) {
    read_.recordHarmonics(executor, position, normal, grid_.place(), calibration_, harmonics, validity, counts);
}

std::vector<LWChoice> LpvPyramidVolume::choices(const LWFrame& frame, double) const {
    std::vector<LWChoice> choices = geometry_.choices(frame);
    if (desc_.autoError > 0.0f)
        choices.push_back({"auto_error", "not used: transport=coarse_to_fine takes few steps on each grid"});
    return choices;
}

void LpvPyramidVolume::report(Report& report) const {
    geometry_.report(report);
    std::uint64_t steps = 0;
    for (std::uint32_t level = 0; level < LpvPyramid::levelsOf(desc_.size); ++level)
        steps += LpvPyramid::stepsOn(level, desc_.size, desc_.steps);
    report.counts.push_back({"steps", steps});
    report.counts.push_back({"lights_outside", 0});
    if (propagated_) report.read(device_, "lights_outside", grid_.state(), LW_LPV_OUTSIDE * sizeof(cl_uint));
}

void LpvPyramidVolume::addDebugViews(std::vector<DebugView>& views) const {
    if (!propagated_) return;
    views.push_back({"injected", "cells, slice below slice with two empty rows between: c0, c1 xyz of red, green, blue (W/sr)",
                     LpvPropagation::debugPlanes(grid_.injected(), desc_.size), {}});
    views.push_back({"propagated", "the same after all grids' steps, with what was injected",
                     LpvPropagation::debugPlanes(*propagated_, desc_.size), {}});
}

std::uint64_t LpvPyramidVolume::bytes() const {
    return geometry_.bytes() + grid_.bytes() + pyramid_.bytes() + read_.bytes() + specular_.bytes();
}

std::uint64_t LpvPyramidVolume::estimateBytes(const LWLpvDesc& desc, const FrameShape& shape) {
    return LpvGrid::estimateBytes(desc.size, shape.vplCount) + LpvPyramid::estimateBytes(desc.size, desc.steps) +
           LpvRead::estimateBytes(desc.size) + LpvStepSpecular::estimateBytes(desc.size) +
           LpvGeometry::estimateBytes(desc, shape, LpvPyramid::levelsOf(desc.size));
}

}  // namespace lightwell
