// The indices that docs/stability.md defines, one after the other. Pixels and channels are samples
// alike.
#include "stability_indices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "stability_parts.h"

namespace studio {
namespace {

// A mean that has no value without samples.
struct Mean {
    double sum = 0.0, count = 0.0;
    void add(double value) {
        sum += value;
        count += 1.0;
    }
    void add(const Mean& other) {
        sum += other.sum;
        count += other.count;
    }
    double value() const { return count > 0.0 ? sum / count : 0.0; }
    std::optional<double> optional() const {
        return count > 0.0 ? std::optional<double>(value()) : std::nullopt;
    }
};

void findErrors(const StabilitySequence& sequence, StabilityIndices& result) {
    for (int t = 0; t < sequence.count(); ++t) {
        Mean error, bias;
        for (std::size_t pixel = 0; pixel < sequence.pixels(t); ++pixel) {
            if (!sequence.isSurface(t, pixel)) continue;
            for (int c = 0; c < 3; ++c) {
                error.add(std::abs(sequence.error(t, pixel, c)));
                bias.add(sequence.error(t, pixel, c));
            }
        }
        FrameIndices& frame = result.frames[std::size_t(t)];
        frame.error = error.value() / sequence.scale(t);
        frame.bias = bias.value() / sequence.scale(t);
        result.error += frame.error / sequence.count();
        result.bias += frame.bias / sequence.count();
    }
}

void findFlicker(const StabilitySequence& sequence, StabilityIndices& result) {
    Mean all;
    for (int t = 1; t < sequence.count(); ++t) {
        Mean frame;
        for (std::size_t pixel = 0; pixel < sequence.pixels(t); ++pixel) {
            const std::int32_t before = sequence.before(t, pixel);
            if (before == StabilitySequence::kNone) continue;
            for (int c = 0; c < 3; ++c)
                frame.add(std::abs(sequence.error(t, pixel, c) -
                                   sequence.error(t - 1, std::size_t(before), c)) /
                          sequence.scale(t));
        }
        result.frames[std::size_t(t)].flicker = frame.optional();
        all.add(frame);
    }
    result.flicker = all.optional();
}

void findLeak(const StabilitySequence& sequence, StabilityIndices& result) {
    std::vector<Mean> inside(result.frames.size());
    Mean allInside, outside;
    for (int t = 0; t < sequence.count(); ++t) {
        const std::vector<std::uint8_t>& region = sequence.frame(t).region;
        for (std::size_t pixel = 0; pixel < region.size(); ++pixel) {
            if (!sequence.isSurface(t, pixel)) continue;
            for (int c = 0; c < 3; ++c) {
                if (region[pixel] == 1) inside[std::size_t(t)].add(sequence.error(t, pixel, c));
                if (region[pixel] == 2) outside.add(sequence.truth(t, pixel, c));
            }
        }
        allInside.add(inside[std::size_t(t)]);
    }
    if (allInside.count == 0.0 || outside.count == 0.0) return;
    const double light = sequence.relativeTo(outside.value());
    result.leak = allInside.value() / light;
    for (std::size_t t = 0; t < inside.size(); ++t)
        if (inside[t].count > 0.0) result.frames[t].leak = inside[t].value() / light;
}

// By how much the relative bias of the pixels that frames t - 1 and t share differs between them; empty
// where they share next to none, as at a cut.
std::optional<double> biasChange(const StabilitySequence& sequence, int t) {
    constexpr double kLeastShare = 0.1;  // of the pixels: a few at the rim do not speak for the picture
    double errorNow = 0.0, errorBefore = 0.0, truthNow = 0.0, truthBefore = 0.0, count = 0.0;
    for (std::size_t pixel = 0; pixel < sequence.pixels(t); ++pixel) {
        const std::int32_t before = sequence.before(t, pixel);
        if (before == StabilitySequence::kNone) continue;
        for (int c = 0; c < 3; ++c) {
            errorNow += sequence.error(t, pixel, c);
            truthNow += sequence.truth(t, pixel, c);
            errorBefore += sequence.error(t - 1, std::size_t(before), c);
            truthBefore += sequence.truth(t - 1, std::size_t(before), c);
        }
        count += 3.0;
    }
    if (count < 3.0 * kLeastShare * double(sequence.pixels(t))) return std::nullopt;
    return errorNow / count / sequence.relativeTo(truthNow / count) -
           errorBefore / count / sequence.relativeTo(truthBefore / count);
}

// The range of running medians: a flash does not move them, and noise of single frames hardly.
void findDrift(const StabilitySequence& sequence, StabilityIndices& result) {
    const int count = sequence.count(), window = std::max(3, count / 4);
    if (count < 2 * window) return;
    std::vector<double> curve{0.0}, medians;
    bool isSeen = false;
    for (int t = 1; t < count; ++t) {
        const std::optional<double> change = biasChange(sequence, t);
        isSeen = isSeen || change.has_value();
        curve.push_back(curve.back() + change.value_or(0.0));
    }
    if (!isSeen) return;  // no frame shows anything of the one before
    for (int first = 0; first + window <= count; ++first)
        medians.push_back(median({curve.begin() + first, curve.begin() + first + window}));
    for (int t = 0; t < count; ++t) {
        const int first = std::clamp(t - window / 2, 0, count - window);
        result.frames[std::size_t(t)].drift = medians[std::size_t(first)] - medians[0];
    }
    const auto [low, high] = std::minmax_element(medians.begin(), medians.end());
    result.drift = *high - *low;
}

// The frame and index that exceed most what a viewer notices; the greatest error where none is above 0.
void findWorstFrame(StabilityIndices& result) {
    constexpr StabilityNoticeable kNoticeable;
    double worst = 0.0, error = 0.0;
    int errorFrame = 0;
    for (std::size_t t = 0; t < result.frames.size(); ++t) {
        const FrameIndices& frame = result.frames[t];
        const std::pair<StabilityReason, double> shares[] = {
            {StabilityReason::Spike, frame.spike.value_or(0.0) / kNoticeable.spike},
            {StabilityReason::Flicker, frame.flicker.value_or(0.0) / kNoticeable.flicker},
            {StabilityReason::Ghost, frame.ghost.value_or(0.0) / kNoticeable.ghost},
            {StabilityReason::Leak, frame.leak.value_or(0.0) / kNoticeable.leak},
            {StabilityReason::Drift, std::abs(frame.drift.value_or(0.0)) / kNoticeable.drift}};
        for (const auto& [reason, share] : shares)
            if (share > worst) {
                worst = share;
                result.worstFrame = int(t);
                result.worstReason = reason;
            }
        if (frame.error > error) {
            error = frame.error;
            errorFrame = int(t);
        }
    }
    if (result.worstReason != StabilityReason::None || error == 0.0) return;
    result.worstFrame = errorFrame;
    result.worstReason = StabilityReason::Error;
}

}  // namespace

const char* stabilityReasonName(StabilityReason reason) {
    constexpr std::array<const char*, 7> kNames{"none", "error", "flicker", "ghost",
                                                "leak", "drift", "spike"};
    return kNames[std::size_t(reason)];
}

StabilityIndices stabilityIndices(const std::vector<StabilityFrame>& frames) {
    const StabilitySequence sequence(frames);
    StabilityIndices result;
    result.frames.resize(frames.size());
    findErrors(sequence, result);
    findFlicker(sequence, result);
    findGhost(sequence, result);
    findLeak(sequence, result);
    findDrift(sequence, result);
    findSpike(sequence, result);
    findWorstFrame(result);
    return result;
}

}  // namespace studio
