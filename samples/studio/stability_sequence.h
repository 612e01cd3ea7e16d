// A checked sequence of frames with what every stability index needs of it: which pixel of the frame
// before shows the same surface point, and the light that errors of a frame are relative to.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "stability_indices.h"

namespace studio {

class StabilitySequence {
public:
    // Throws std::invalid_argument as stabilityIndices does. `frames` must live as long.
    explicit StabilitySequence(const std::vector<StabilityFrame>& frames);

    int count() const { return int(frames_.size()); }
    const StabilityFrame& frame(int t) const { return frames_[std::size_t(t)]; }
    std::size_t pixels(int t) const {
        return std::size_t(frame(t).width) * std::size_t(frame(t).height);
    }
    bool isSurface(int t, std::size_t pixel) const { return frame(t).surface[pixel] != 0; }

    // The pixel of frame t - 1 that shows what `pixel` of frame t shows; kNone: revealed, or no surface.
    static constexpr std::int32_t kNone = -1;
    std::int32_t before(int t, std::size_t pixel) const { return before_[std::size_t(t)][pixel]; }

    double truth(int t, std::size_t pixel, int channel) const {
        return double(frame(t).truth[std::size_t(channel) * pixels(t) + pixel]);
    }
    double error(int t, std::size_t pixel, int channel) const {
        const std::size_t i = std::size_t(channel) * pixels(t) + pixel;
        return double(frame(t).image[i]) - double(frame(t).truth[i]);
    }
    double truthGrey(int t, std::size_t pixel) const {
        return (truth(t, pixel, 0) + truth(t, pixel, 1) + truth(t, pixel, 2)) / 3.0;
    }

    // The light that a frame's errors are relative to, W/m^2: the truth's mean over its surfaces and
    // channels, but at least a tenth of the mean over the sequence, so that a dark frame's errors count
    // as a viewer sees them who has just seen the others. Where the truth has no light in any frame, the
    // image's mean. Above 0.
    double scale(int t) const { return relativeTo(meanTruth_[std::size_t(t)]); }
    // The same for the truth's mean over some of the pixels.
    double relativeTo(double mean) const { return std::max(mean, least_); }

private:
    static constexpr double kDarkShare = 0.1;

    const std::vector<StabilityFrame>& frames_;
    std::vector<std::vector<std::int32_t>> before_;
    std::vector<double> meanTruth_;
    double least_ = 1.0;
};

}  // namespace studio
