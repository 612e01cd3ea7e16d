#include "techniques/lpv_step_volume.h"

#include "compute/device.h"

namespace lightwell {
namespace {

// Light crosses a cell in a step at best (Kaplanyan and Dachsbacher 2010 take as many as the grid is long, twice over).
std::uint32_t stepsOf(const LWLpvDesc& desc) { return desc.steps ? desc.steps : 2 * desc.size; }

}  // namespace

LpvStepVolume::LpvStepVolume(Device& device, const LWLpvDesc& desc)
    : device_(device),
      desc_(desc),
      calibration_(LpvPropagation::calibration(desc.size, stepsOf(desc), desc.geometryVolume != LW_GEOMETRY_VOLUME_OFF)),
      geometry_(device, desc),
      grid_(device, desc.size),
      propagation_(device, desc.size),
      read_(device, desc.size),
      specular_(device, desc.size) {}

void LpvStepVolume::record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const LpvPlacement& placement) {
    geometry_.import(executor, frame, rsms);
    grid_.record(executor, rsms, frame.vpls, frame.vplCount, placement);
    const std::optional<LpvBlockers> blockers = geometry_.record(executor, grid_.place());
    propagated_ = &propagation_.record(executor, grid_.injected(), stepsOf(desc_), blockers ? &*blockers : nullptr);
    read_.recordPack(executor, *propagated_);
    isSpecularPacked_ = false;
}

void LpvStepVolume::recordGather(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                                 const Planes& validity, const Buffer& counts) {
    read_.recordGather(executor, position, normal, grid_.place(), calibration_, desc_.damping != 0, irradiance, validity, counts);
}

// What surfaces send is what was injected: light on its way through the cells belongs to no surface any more.
LpvSpecularGrid LpvStepVolume::specular(Executor& executor) {
    if (!isSpecularPacked_) {
        specular_.recordPackSteps(executor, grid_.injected(), grid_.place(), geometry_.corners());
        specular_.show(executor);
        isSpecularPacked_ = true;
    }
    return {specular_, grid_.place()};
}

std::vector<LWChoice> LpvStepVolume::choices(const LWFrame& frame, double) const { return geometry_.choices(frame); }

void LpvStepVolume::report(Report& report) const {
    geometry_.report(report);
    report.counts.push_back({"steps", stepsOf(desc_)});
    report.counts.push_back({"lights_outside", 0});
    if (propagated_) report.read(device_, "lights_outside", grid_.state(), LW_LPV_OUTSIDE * sizeof(cl_uint));
}

void LpvStepVolume::addDebugViews(std::vector<DebugView>& views) const {
    if (!propagated_) return;
    views.push_back({"injected", "cells, slice below slice with two empty rows between: c0, c1 xyz of red, green, blue (W/sr)",
                     LpvPropagation::debugPlanes(grid_.injected(), desc_.size), {}});
    views.push_back({"propagated", "the same after all steps, with what was injected",
                     LpvPropagation::debugPlanes(*propagated_, desc_.size), {}});
}

std::uint64_t LpvStepVolume::bytes() const {
    return geometry_.bytes() + grid_.bytes() + propagation_.bytes() + read_.bytes() +
           specular_.bytes();
}

std::uint64_t LpvStepVolume::estimateBytes(const LWLpvDesc& desc, const FrameShape& shape) {
    return LpvGrid::estimateBytes(desc.size, shape.vplCount) + LpvPropagation::estimateBytes(desc.size, stepsOf(desc)) +
           LpvRead::estimateBytes(desc.size) + LpvSpecular::estimateBytes(desc.size, false) + LpvGeometry::estimateBytes(desc, shape);
}

}  // namespace lightwell
