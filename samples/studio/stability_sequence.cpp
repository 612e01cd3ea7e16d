#include "stability_sequence.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace studio {
namespace {

void requireSize(std::size_t size, std::size_t expected, int t, const char* plane) {
    if (size != expected)
        throw std::invalid_argument(
            fmt::format("frame {}: {}: expected {} values, got {}", t, plane, expected, size));
}

void checkFrame(const StabilityFrame& frame, int t) {
    if (frame.width < 1 || frame.height < 1)
        throw std::invalid_argument(fmt::format("frame {}: expected a size of at least 1x1, got {}x{}",
                                                t, frame.width, frame.height));
    const std::size_t pixels = std::size_t(frame.width) * std::size_t(frame.height);
    requireSize(frame.image.size(), 3 * pixels, t, "image");
    requireSize(frame.truth.size(), 3 * pixels, t, "truth");
    requireSize(frame.surface.size(), pixels, t, "surface");
    requireSize(frame.previous.size(), pixels, t, "previous");
    if (!frame.region.empty()) requireSize(frame.region.size(), pixels, t, "region");
    for (const auto& [plane, name] :
         {std::pair{&frame.image, "image"}, std::pair{&frame.truth, "truth"}}) {
        std::size_t bad = 0;
        for (std::size_t i = 0; i < plane->size(); ++i)
            if (frame.surface[i % pixels] != 0 && !std::isfinite((*plane)[i])) ++bad;
        if (bad != 0)
            throw std::invalid_argument(fmt::format(
                "frame {}: {}: expected finite light on surfaces, got {} NaN or infinite values", t,
                name, bad));
    }
}

// Mean absolute value of one of a frame's images over surfaces and channels; 0 without surfaces.
double meanOver(const StabilityFrame& frame, const std::vector<float>& plane) {
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < plane.size(); ++i)
        if (frame.surface[i % frame.surface.size()] != 0) {
            sum += std::abs(double(plane[i]));
            count += 1.0;
        }
    return count > 0.0 ? sum / count : 0.0;
}

std::vector<std::int32_t> match(const StabilityFrame& frame, const StabilityFrame* last) {
    std::vector<std::int32_t> before(frame.surface.size(), StabilitySequence::kNone);
    if (last == nullptr || frame.isCut || frame.width != last->width || frame.height != last->height)
        return before;
    for (std::size_t pixel = 0; pixel < before.size(); ++pixel) {
        const glm::vec2 at = frame.previous[pixel];
        const bool isInside =
            at.x >= 0.0f && at.y >= 0.0f && at.x < float(frame.width) && at.y < float(frame.height);
        if (frame.surface[pixel] == 0 || !isInside) continue;  // NaN is not inside
        const std::int32_t from = std::int32_t(at.y) * frame.width + std::int32_t(at.x);
        if (last->surface[std::size_t(from)] != 0) before[pixel] = from;
    }
    return before;
}

}  // namespace

StabilitySequence::StabilitySequence(const std::vector<StabilityFrame>& frames) : frames_(frames) {
    double truth = 0.0, image = 0.0;
    for (int t = 0; t < count(); ++t) {
        checkFrame(frame(t), t);
        before_.push_back(match(frame(t), t == 0 ? nullptr : &frame(t - 1)));
        meanTruth_.push_back(meanOver(frame(t), frame(t).truth));
        truth += meanTruth_.back();
        image += meanOver(frame(t), frame(t).image);
    }
    // A lightless truth leaves the image's own light to compare with, and a black pair any number.
    if (truth > 0.0)
        least_ = kDarkShare * truth / double(count());
    else if (image > 0.0)
        least_ = image / double(count());
}

}  // namespace studio
