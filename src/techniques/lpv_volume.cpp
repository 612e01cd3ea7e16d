#include "techniques/lpv_volume.h"

#include "techniques/lpv_step_cascades.h"
#include "techniques/lpv_step_volume.h"
#include "techniques/lpv_sweep_cascades.h"
#include "techniques/lpv_sweep_volume.h"

namespace lightwell {

std::unique_ptr<LpvVolume> makeLpvVolume(Device& device, const LWLpvDesc& desc, int hidden) {
    const bool sweeps = desc.transport == LW_LPV_TRANSPORT_SWEEP;
    if (desc.cascades > 1 && sweeps) return std::make_unique<LpvSweepCascades>(device, desc, hidden);
    if (desc.cascades > 1) return std::make_unique<LpvStepCascades>(device, desc);
    if (sweeps) return std::make_unique<LpvSweepVolume>(device, desc, hidden);
    return std::make_unique<LpvStepVolume>(device, desc);
}

std::uint64_t estimateLpvVolumeBytes(const LWLpvDesc& desc, const FrameShape& shape) {
    const bool sweeps = desc.transport == LW_LPV_TRANSPORT_SWEEP;
    if (desc.cascades > 1) return sweeps ? LpvSweepCascades::estimateBytes(desc, shape) : LpvStepCascades::estimateBytes(desc, shape);
    return sweeps ? LpvSweepVolume::estimateBytes(desc, shape) : LpvStepVolume::estimateBytes(desc, shape);
}

}  // namespace lightwell
