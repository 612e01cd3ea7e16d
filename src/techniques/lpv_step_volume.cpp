#include "techniques/lpv_step_volume.h"

#include <algorithm>
#include <cstddef>

#include "compute/device.h"

namespace lightwell {

LpvStepVolume::LpvStepVolume(Device& device, const LWLpvDesc& desc)
    : device_(device),
      desc_(desc),
      calibration_(LpvPropagation::calibration(desc.size, stepsOf(desc), desc.geometryVolume != LW_GEOMETRY_VOLUME_OFF)),
      geometry_(device, desc),
      grid_(device, desc.size),
      propagation_(device, desc.size),
      read_(device, desc.size),
      specular_(device, desc.size) {
    if (desc.autoError > 0.0f) progress_.emplace(progressOf(device, desc));
    if (desc.rests) rest_.emplace(device);
}

void LpvStepVolume::record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const LpvPlacement& placement) {
    const bool isKnown = isWhole_;
    isWhole_ = false;
    geometry_.import(executor, frame, rsms);
    if (rest_) rest_->begin(executor);
    grid_.record(executor, rsms, frame.vpls, frame.vplCount, placement, frame.environment, rest_ ? &rest_->changed() : nullptr);
    const std::optional<LpvBlockers> blockers = geometry_.record(executor, grid_.place());
    if (rest_) rest_->decide(executor, grid_.place(), geometry_.state(), isKnown);
    propagated_ = &propagation_.record(executor, grid_.injected(), stepsOf(desc_), blockers ? &*blockers : nullptr,
                                       progress_ ? &*progress_ : nullptr, rest_ ? &rest_->state() : nullptr);
    read_.recordPack(executor, *propagated_, progress_ ? &progress_->state() : nullptr);
    specular_.startFrame(frame.environment);
    isWhole_ = true;
}

void LpvStepVolume::recordGather(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                                 const Planes& validity, const Buffer& counts) {
    read_.recordGather(executor, position, normal, grid_.place(), calibration_, desc_.damping != 0, irradiance, validity, counts);
}

void LpvStepVolume::recordHarmonics(Executor& executor, const Planes& position, const Planes& normal, const Harmonics& harmonics,
                                    const Planes& validity, const Buffer& counts) {
    read_.recordHarmonics(executor, position, normal, grid_.place(), calibration_, harmonics, validity, counts);
}

std::vector<LWChoice> LpvStepVolume::choices(const LWFrame& frame, double) const { return geometry_.choices(frame); }

void LpvStepVolume::report(Report& report) const {
    geometry_.report(report);
    report.counts.push_back({"steps", progress_ ? 0 : stepsOf(desc_)});
    if (progress_ && propagated_) reportProgress(device_, *progress_, report);
    if (rest_ && propagated_) rest_->report(device_, report);
    report.counts.push_back({"lights_outside", 0});
    if (propagated_) report.read(device_, "lights_outside", grid_.state(), LW_LPV_OUTSIDE * sizeof(cl_uint));
}

LpvProgress LpvStepVolume::progressOf(Device& device, const LWLpvDesc& desc) {
    return {device, desc.size, stepsOf(desc), desc.autoError, desc.geometryVolume != LW_GEOMETRY_VOLUME_OFF};
}

void LpvStepVolume::reportProgress(Device& device, const LpvProgress& progress, Report& report) {
    static constexpr const char* kReasons[] = {"all: more light than auto_error was on its way to the end",
                                               "ended where no more light than auto_error was on its way"};
    report.read(device, "steps", progress.state(), offsetof(LwLpvProgress, steps));
    report.readChoice(device, "steps", progress.state(), offsetof(LwLpvProgress, done), kReasons, 2);
}

void LpvStepVolume::addDebugViews(std::vector<DebugView>& views) const {
    if (!propagated_) return;
    views.push_back({"injected", "cells, slice below slice with two empty rows between: c0, c1 xyz of red, green, blue (W/sr)",
                     LpvPropagation::debugPlanes(grid_.injected(), desc_.size), {}});
    views.push_back({"propagated", "the same after all steps, with what was injected",
                     LpvPropagation::debugPlanes(*propagated_, desc_.size), {}});
}

std::uint64_t LpvStepVolume::bytes() const {
    return geometry_.bytes() + grid_.bytes() + propagation_.bytes() + read_.bytes() + specular_.bytes() + (progress_ ? progress_->bytes() : 0) +
           (rest_ ? rest_->bytes() : 0);
}

std::uint64_t LpvStepVolume::estimateBytes(const LWLpvDesc& desc, const FrameShape& shape) {
    return LpvGrid::estimateBytes(desc.size, shape.vplCount) + LpvPropagation::estimateBytes(desc.size, stepsOf(desc)) +
           LpvRead::estimateBytes(desc.size) + LpvStepSpecular::estimateBytes(desc.size) + LpvGeometry::estimateBytes(desc, shape) +
           (desc.autoError > 0.0f ? LpvProgress::estimateBytes(desc.size) : 0) + (desc.rests ? LpvRest::estimateBytes() : 0);
}

}  // namespace lightwell
