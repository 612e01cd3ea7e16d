// Ambient occlusion and light of one bounce from a view's own pixels, slice by slice with a visibility bitmask
// (kernels/horizon_gather).
#pragma once

#include "compute/buffer.h"
#include "compute/executor.h"
#include "passes/horizon_pattern.h"
#include "passes/mip_pyramid.h"

namespace lightwell {

class Camera;

struct HorizonGatherOptions {
    HorizonPatternOptions pattern;
    bool light = true;     // or ambient occlusion alone
    bool uniform = false;  // ambient occlusion alone: every direction alike instead of weighted by its cosine
};

// In shares of the image's height at the pixel's own depth.
struct HorizonRanges {
    double thickness = 0.0;      // of everything, along the view
    double ambientRadius = 0.0;  // of ambient occlusion
};

// The pattern for one pyramid on the device.
class HorizonTables {
public:
    // Uploads ("horizon_gather.upload") where the pyramid lies elsewhere than before, or reach has changed. every: pixels
    // of the full image per pixel of the pyramid's first level.
    void prepare(Executor& executor, const HorizonPatternOptions& options, double reachPixels, double every,
                 const PyramidLevels& pyramid);
    static std::uint64_t estimateBytes(const HorizonPatternOptions& options, double reachPixels);

    const Buffer& slices() const { return slices_; }
    const Buffer& steps() const { return steps_; }
    std::uint64_t bytes() const { return slices_.bytes() + steps_.bytes(); }

private:
    Buffer slices_, steps_;
    double reach_ = -1.0;
    std::uint32_t width_ = 0, height_ = 0;
};

class HorizonGather {
public:
    HorizonGather(Device& device, const HorizonGatherOptions& options);

    // Pass "horizon_gather.gather" (".gather_ambient" without light) on level firstLevel of the pyramid of an image
    // that is fullHeight pixels high. turn: of the pattern, another one in every frame of a history. gathered: weighted sums,
    // as WeightedFilter takes them.
    void recordGather(Executor& executor, const PyramidLevels& pyramid, std::uint32_t fullHeight, const Camera& camera,
                      const HorizonRanges& ranges, const HorizonTables& tables, std::uint32_t turn, const Planes& gathered);

private:
    HorizonGatherOptions options_;
    Kernel& gather_;
};

}  // namespace lightwell
