#include "techniques/lpv_sweep_volume.h"

#include "compute/device.h"
#include "compute/error.h"

namespace lightwell {

LpvSweepOptions LpvSweepVolume::optionsOf(const LWLpvDesc& desc) {
    if (desc.size > LpvSweep::kLargestSize)
        fail(LW_ERROR_INVALID_ARGUMENT, "desc.size: expected at most ", LpvSweep::kLargestSize, " with transport=sweep, got ",
             desc.size);
    LpvSweepOptions options;
    options.size = desc.size;
    options.directions = desc.directions;
    options.bounces = desc.bounces;
    options.frames = desc.frames;
    return options;
}

LpvSweepVolume::LpvSweepVolume(Device& device, const LWLpvDesc& desc, int hidden)
    : device_(device),
      surfaces_(device, desc, hidden),
      grid_(device, desc.size),
      sweep_(device, optionsOf(desc)),
      specular_(device, desc.size, desc.frames > 1),
      packsLater_(desc.bounces == 1 && desc.frames == 1) {
    if (desc.rests) rest_.emplace(device);
}

void LpvSweepVolume::record(Executor& executor, const LWFrame& frame, const RsmInput& rsms,
                            const LpvPlacement& placement) {
    grid_.recordPlace(executor, rsms, frame.vpls, frame.vplCount, placement);
    const bool restart = surfaces_.import(executor, frame) || placement.refit;
    sweep_.record(executor, {rsms, grid_.authored(), frame.vplCount, grid_.place(), surfaces_.surfels(), surfaces_.areaScale(), restart,
                             frame.environment, nullptr, packsLater_ ? nullptr : &specular_, rest_ ? &*rest_ : nullptr});
    isPacked_ = !packsLater_;
}

void LpvSweepVolume::report(Report& report) const {
    surfaces_.report(report);
    if (rest_ && sweep_.outside()) rest_->report(device_, report);
    report.counts.push_back({"lights_outside", 0});
    if (sweep_.outside()) report.read(device_, "lights_outside", sweep_.outside(), 0);
}

std::uint64_t LpvSweepVolume::estimateBytes(const LWLpvDesc& desc, const FrameShape& shape) {
    return LpvGrid::estimatePlaceBytes(shape.vplCount) + LpvSweep::estimateBytes(optionsOf(desc)) +
           LpvSpecular::estimateBytes(desc.size, desc.frames > 1) + LpvSurfaces::estimateBytes(desc, shape) +
           (desc.rests ? LpvRest::estimateBytes() : 0);
}

}  // namespace lightwell
