// What the bounded geometry term takes from near light, gathered from the screen (Kollig and Keller 2004; Novák,
// Engelhardt and Dachsbacher 2011). docs/techniques/ssvp_compensation.md derives it.
#pragma once

#include <cstdint>
#include <vector>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "lightwell/lightwell.h"
#include "shared/compensation_types.h"
#include "shared/subset_order.h"

namespace lightwell {

struct CompensationOptions {
    std::uint32_t interleave = 4;  // the gather's
    std::uint32_t samples = 4;     // of each pixel; a window of interleave^2 pixels has as many sets of them
    bool uniformArea = false;      // VPLs drawn by area, not by flux
};

// One image's surfaces as the gather reads them: memory of BoundingCompensation::recordSenders.
class CompensationSenders {
public:
    static lw_sender_layout layout(std::uint32_t width, std::uint32_t height, std::uint32_t interleave);
    static std::uint64_t estimateBytes(std::uint32_t width, std::uint32_t height, std::uint32_t interleave);
    // Makes room for images up to this size. Throws UNSUPPORTED beyond the kernels' indices.
    void reserve(Device& device, std::uint32_t width, std::uint32_t height, std::uint32_t interleave);

    const Buffer& planes() const { return planes_; }
    std::uint64_t bytes() const { return planes_.bytes(); }

private:
    Buffer planes_;
};

class BoundingCompensation {
public:
    BoundingCompensation(Device& device, const CompensationOptions& options);

    // The samples of all subsets, one subset after the other, for an image of this size: distances from one pixel to `reach`,
    // spread by their logarithm.
    static std::vector<lw_near_sample> samples(const CompensationOptions& options, float reach);
    // Pixels: a quarter of the image's longer side.
    static float reachOf(std::uint32_t width, std::uint32_t height);
    // Of pixels of a width x height image. Throws as Camera does, naming `name`.
    static lw_pixel_area pixelArea(const LWCamera& camera, std::uint32_t width, std::uint32_t height, const char* name);

    // Pass "bounding_compensation.scale": what VPLs stand for, of a list whose first `drawn` were drawn from texels.
    void recordScale(Executor& executor, const Buffer& vpls, lw_subset_order order, std::uint32_t drawn);
    // Pass "bounding_compensation.halve": radiance of the half-resolution surfaces that were chosen.
    void recordHalve(Executor& executor, const Planes& position, const Planes& normal, const Planes& radiance,
                     const Planes& halfPosition, const Planes& halfNormal, const Planes& halfRadiance);
    // Pass "bounding_compensation.senders". counts[3] grows by the lit pixels whose VPLs' discs are wider than the samples'
    // reach.
    void recordSenders(Executor& executor, const Planes& position, const Planes& normal, const Planes& radiance,
                       const lw_pixel_area& camera, const CompensationSenders& senders, const Buffer& counts);
    // Pass "bounding_compensation.gather": adds the light to irradiance (3 planes), or, `alone`, puts it there. counts[2] grows
    // by the pixels that adding brings down to LW_LARGEST_IRRADIANCE.
    void recordGather(Executor& executor, const Planes& position, const Planes& normal, const CompensationSenders& senders,
                      bool alone, const Planes& irradiance, const Buffer& counts);

    std::uint64_t bytes() const { return scale_.bytes() + samples_.bytes(); }
    static std::uint64_t estimateBytes(const CompensationOptions& options);

private:
    CompensationOptions options_;
    Kernel &scaleOf_, &halve_, &makeSenders_, &gather_;
    Buffer scale_;    // as bounding_compensation_scale leaves it
    Buffer samples_;  // lw_near_sample
};

}  // namespace lightwell
