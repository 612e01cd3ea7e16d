// A half-resolution G-buffer, and joint bilateral up-sampling of what was computed on it (Kopf et al.
// 2007).
#pragma once

#include "compute/buffer.h"
#include "compute/executor.h"

namespace lightwell {

class JointBilateral {
public:
    // channels: of what recordUpsample up-samples, 1 or 3; 5 for recordUpsampleAll. marks: 3, for recordUpsampleMarked.
    explicit JointBilateral(Device& device, std::uint32_t channels = 3, bool marks = false);

    static std::uint32_t halved(std::uint32_t size, std::uint32_t times = 1) { return times ? halved((size + 1) / 2, times - 1) : size; }

    // Pass "joint_bilateral.downsample": one surface of each 2x2 block of pixels.
    void recordDownsample(Executor& executor, const Planes& position, const Planes& normal,
                          const Planes& halfPosition, const Planes& halfNormal);
    // Pass "joint_bilateral.upsample". counts[0] grows by the pixels with neither a surface nor a
    // zero normal, counts[1] by those without a sample on their own surface. `validity`, where wanted and with 3 channels,
    // becomes 1 on surfaces and 0 elsewhere.
    void recordUpsample(Executor& executor, const Planes& position, const Planes& normal,
                        const Planes& halfPosition, const Planes& halfNormal, const Planes& halfIrradiance,
                        const Planes& irradiance, const Buffer& counts, const Planes& validity = {});
    // The same, and what it does not know the light of: `marks` (of RepairedPixels) has the pixels without a sample on their own surface and
    // those around which samples differ by more than `share` of the light.
    void recordUpsampleMarked(Executor& executor, const Planes& position, const Planes& normal, const Planes& halfPosition,
                              const Planes& halfNormal, const Planes& halfIrradiance, const Planes& irradiance, float share,
                              const Buffer& marks, const Planes& validity, const Buffer& counts);
    // As recordUpsample, of 5 planes: irradiance and two scalars, each of which may be empty.
    void recordUpsampleAll(Executor& executor, const Planes& position, const Planes& normal, const Planes& halfPosition,
                           const Planes& halfNormal, const Planes& halfLight, const Planes& irradiance,
                           const Planes& fourth, const Planes& fifth, const Buffer& counts);

private:
    std::uint32_t channels_;
    Kernel &downsample_, &upsample_;
};

}  // namespace lightwell
