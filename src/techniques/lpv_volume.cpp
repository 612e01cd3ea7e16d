#include "techniques/lpv_volume.h"

#include "compute/error.h"
#include "techniques/lpv_pyramid_volume.h"
#include "techniques/lpv_step_cascades.h"
#include "techniques/lpv_step_volume.h"
#include "techniques/lpv_sweep_cascades.h"
#include "techniques/lpv_sweep_volume.h"

namespace lightwell {
namespace {

const LWLpvDesc& checkedPyramid(const LWLpvDesc& desc) {
    if (desc.cascades > 1)
        fail(LW_ERROR_INVALID_ARGUMENT, "desc.cascades: expected 1 with transport=coarse_to_fine, got ", desc.cascades);
    return desc;
}

// The light of one bounce in one grid, all of it in every frame, is what LpvRest knows.
void checkRests(const LWLpvDesc& desc) {
    if (!desc.rests) return;
    const auto refuse = [](const char* name, const char* expected) {
        fail(LW_ERROR_INVALID_ARGUMENT, "desc.", name, ": expected ", expected, " with rests=1, got another");
    };
    if (desc.transport == LW_LPV_TRANSPORT_COARSE_TO_FINE) refuse("transport", "propagate or sweep");
    if (desc.cascades > 1) refuse("cascades", "1");
    if (desc.transport == LW_LPV_TRANSPORT_SWEEP && desc.bounces > 1) refuse("bounces", "1");
    if (desc.transport == LW_LPV_TRANSPORT_SWEEP && desc.frames > 1) refuse("frames", "1");
    if (desc.transport == LW_LPV_TRANSPORT_PROPAGATE && desc.autoError > 0.0f) refuse("autoError", "0");
}

}  // namespace

std::unique_ptr<LpvVolume> makeLpvVolume(Device& device, const LWLpvDesc& desc, int hidden) {
    checkRests(desc);
    const bool sweeps = desc.transport == LW_LPV_TRANSPORT_SWEEP;
    if (desc.transport == LW_LPV_TRANSPORT_COARSE_TO_FINE) return std::make_unique<LpvPyramidVolume>(device, checkedPyramid(desc));
    if (desc.cascades > 1 && sweeps) return std::make_unique<LpvSweepCascades>(device, desc, hidden);
    if (desc.cascades > 1) return std::make_unique<LpvStepCascades>(device, desc);
    if (sweeps) return std::make_unique<LpvSweepVolume>(device, desc, hidden);
    return std::make_unique<LpvStepVolume>(device, desc);
}

std::uint64_t estimateLpvVolumeBytes(const LWLpvDesc& desc, const FrameShape& shape) {
    const bool sweeps = desc.transport == LW_LPV_TRANSPORT_SWEEP;
    if (desc.transport == LW_LPV_TRANSPORT_COARSE_TO_FINE) return LpvPyramidVolume::estimateBytes(checkedPyramid(desc), shape);
    if (desc.cascades > 1) return sweeps ? LpvSweepCascades::estimateBytes(desc, shape) : LpvStepCascades::estimateBytes(desc, shape);
    return sweeps ? LpvSweepVolume::estimateBytes(desc, shape) : LpvStepVolume::estimateBytes(desc, shape);
}

}  // namespace lightwell
