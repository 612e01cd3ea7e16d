// Indirect light of the levels of a G-buffer's mip pyramid, each from a ring of texels around the receiver (Soler et
// al. 2009). kernels/screen_gather says what a texel receives.
#pragma once

#include <vector>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "passes/level_planes.h"
#include "passes/mip_pyramid.h"
#include "shared/screen_types.h"

namespace lightwell {

// A view's memory: levels of senders as the gather reads them, and of light before and after filter or sum.
class ScreenLevels {
public:
    ScreenLevels() = default;
    ScreenLevels(Device& device, std::uint32_t maxWidth, std::uint32_t maxHeight, LevelRange range, std::uint32_t interleave);
    static std::uint64_t estimateBytes(std::uint32_t maxWidth, std::uint32_t maxHeight, LevelRange range, std::uint32_t interleave);

    // For an image of this size; clears what lies between and beside the levels when they come to stand elsewhere.
    void resize(Executor& executor, std::uint32_t width, std::uint32_t height);

    LevelRange range() const { return range_; }
    // Dealt: rows of interleave segments; layout as kernels take it (w: distance of segments).
    const Buffer& dealt() const { return dealt_; }
    cl_int4 dealtLayout(std::uint32_t k) const { return dealtLayouts_[k - range_.first]; }
    // LW_LIGHT_PLANES planes with borders of zeros: what a level gathers by itself; and a second image.
    Planes own(std::uint32_t k) const { return own_[k - range_.first]; }
    Planes other(std::uint32_t k) const { return other_[k - range_.first]; }
    std::uint64_t bytes() const { return dealt_.bytes() + lightMemory_[0].bytes() + lightMemory_[1].bytes(); }

private:
    LevelRange range_;
    std::uint32_t interleave_ = 1, width_ = 0, height_ = 0;
    Buffer dealt_, lightMemory_[2];
    std::vector<cl_int4> dealtLayouts_;
    std::vector<Planes> own_, other_;
};

class ScreenGather {
public:
    // The pyramid must have exactly radiance and area beside position and normal.
    static constexpr std::uint32_t kExtras = kPyramidRadiance | kPyramidArea;

    // interleave: 1, 2 or 4. planned: every gather has a plan, or else none has.
    ScreenGather(Device& device, std::uint32_t interleave, bool planned = false);

    // Pass "screen_gather.deal": level k in the layout that the gather reads; with a plan of ScreenPlan not where it has no samples.
    void recordDeal(Executor& executor, const PyramidLevels& pyramid, const ScreenLevels& levels, std::uint32_t k,
                    const Buffer* plan = nullptr);
    // Pass "screen_gather.level1" for the first level, and so on: light of level k; `samples`: interleave^2 patterns of sampleCount.
    void recordGather(Executor& executor, const ScreenLevels& levels, std::uint32_t k, const Buffer& samples,
                      std::uint32_t sampleCount, bool bounded, const Planes& light);
    // The same by a plan of ScreenPlan, which has how many of the patterns are taken (behind them stand those of half as many, and so
    // on) and for which level those of `discs` are. A level without samples is left as it is, or cleared with interleave = 1.
    void recordGather(Executor& executor, const ScreenLevels& levels, std::uint32_t k, const Buffer& samples, const Buffer& discs,
                      std::uint32_t sampleCount, bool bounded, const Planes& light, const Buffer& plan);

private:
    template <typename... More>
    void runGather(Executor& executor, const ScreenLevels& levels, std::uint32_t k, const Buffer& samples, std::uint32_t sampleCount,
                   bool bounded, const Planes& light, const More&... more);

    std::uint32_t interleave_;
    Kernel &deal_, &gather_;
};

}  // namespace lightwell
