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
    if (desc.transport == LW_LPV_TRANSPORT_COARSE_TO_FINE)
        fail(LW_ERROR_INVALID_ARGUMENT, "desc.transport: expected propagate or sweep with rests=1, got coarse_to_fine");
    if (desc.cascades > 1) fail(LW_ERROR_INVALID_ARGUMENT, "desc.cascades: expected 1 with rests=1, got ", desc.cascades);
    const bool sweeps = desc.transport == LW_LPV_TRANSPORT_SWEEP;
    if (sweeps && desc.bounces > 1) fail(LW_ERROR_INVALID_ARGUMENT, "desc.bounces: expected 1 with rests=1, got ", desc.bounces);
    if (sweeps && desc.frames > 1) fail(LW_ERROR_INVALID_ARGUMENT, "desc.frames: expected 1 with rests=1, got ", desc.frames);
    if (!sweeps && desc.autoError > 0.0f) fail(LW_ERROR_INVALID_ARGUMENT, "desc.autoError: expected 0 with rests=1, got ", desc.autoError);
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
