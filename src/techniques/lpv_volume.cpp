#include "techniques/lpv_volume.h"

#include "techniques/lpv_pyramid_volume.h"
#include "techniques/lpv_step_volume.h"
#include "techniques/lpv_sweep_volume.h"

namespace lightwell {

std::unique_ptr<LpvVolume> makeLpvVolume(Device& device, const LWLpvDesc& desc, int hidden) {
    if (desc.transport == LW_LPV_TRANSPORT_SWEEP) return std::make_unique<LpvSweepVolume>(device, desc, hidden);
    if (desc.transport == LW_LPV_TRANSPORT_COARSE_TO_FINE) return std::make_unique<LpvPyramidVolume>(device, desc);
    return std::make_unique<LpvStepVolume>(device, desc);
}

std::uint64_t estimateLpvVolumeBytes(const LWLpvDesc& desc, const FrameShape& shape) {
    if (desc.transport == LW_LPV_TRANSPORT_SWEEP) return LpvSweepVolume::estimateBytes(desc, shape);
    if (desc.transport == LW_LPV_TRANSPORT_COARSE_TO_FINE) return LpvPyramidVolume::estimateBytes(desc, shape);
    return LpvStepVolume::estimateBytes(desc, shape);
}

}  // namespace lightwell
