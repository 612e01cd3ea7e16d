#include "techniques/lpv_volume.h"

#include "techniques/lpv_step_volume.h"
#include "techniques/lpv_sweep_volume.h"

namespace lightwell {

std::unique_ptr<LpvVolume> makeLpvVolume(Device& device, const LWLpvDesc& desc, int hidden) {
    if (desc.transport == LW_LPV_TRANSPORT_SWEEP) return std::make_unique<LpvSweepVolume>(device, desc, hidden);
    return std::make_unique<LpvStepVolume>(device, desc);
}

std::uint64_t estimateLpvVolumeBytes(const LWLpvDesc& desc, const FrameShape& shape) {
    return desc.transport == LW_LPV_TRANSPORT_SWEEP ? LpvSweepVolume::estimateBytes(desc, shape)
                                                    : LpvStepVolume::estimateBytes(desc, shape);
}

}  // namespace lightwell
