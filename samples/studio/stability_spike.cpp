// Spikes: what stands in one frame only, by tiles of the picture, so that a flash of a small area counts
// like one of all of it.
#include <algorithm>

#include "stability_parts.h"

namespace studio {
namespace {

// By how much the middle of three values sticks out of the other two, whatever its side.
double stickingOut(double a, double middle, double b) {
    return std::max({0.0, middle - std::max(a, b), std::min(a, b) - middle});
}

constexpr std::size_t kTilesX = 20, kTilesY = 12;
using TileValues = std::vector<double>;  // of each tile; empty: no point is seen before and after

// What sticks out in frame t of the error of points seen in the frames before and after, less what the
// truth's light sticks out there: mean over each tile, relative to the frame's light.
TileValues flashes(const StabilitySequence& sequence, int t) {
    TileValues sums(kTilesX * kTilesY, 0.0), counts(kTilesX * kTilesY, 0.0);
    const StabilityFrame& after = sequence.frame(t + 1);
    bool isSeen = false;
    for (std::size_t pixel = 0; pixel < sequence.pixels(t + 1); ++pixel) {
        const std::size_t x = pixel % std::size_t(after.width), y = pixel / std::size_t(after.width);
        const std::size_t tile =
            y * kTilesY / std::size_t(after.height) * kTilesX + x * kTilesX / std::size_t(after.width);
        counts[tile] += 3.0;
        const std::int32_t at = sequence.before(t + 1, pixel);
        if (at == StabilitySequence::kNone) continue;
        const std::int32_t before = sequence.before(t, std::size_t(at));
        if (before == StabilitySequence::kNone) continue;
        isSeen = true;
        for (int c = 0; c < 3; ++c) {
            const auto sticksOut = [&](auto value) {
                return stickingOut((sequence.*value)(t - 1, std::size_t(before), c),
                                   (sequence.*value)(t, std::size_t(at), c),
                                   (sequence.*value)(t + 1, pixel, c));
            };
            sums[tile] += std::max(
                0.0, sticksOut(&StabilitySequence::error) - sticksOut(&StabilitySequence::truth));
        }
    }
    if (!isSeen) return {};
    for (std::size_t tile = 0; tile < sums.size(); ++tile)
        if (counts[tile] > 0.0) sums[tile] /= counts[tile] * sequence.scale(t);
    return sums;
}

}  // namespace

void findSpike(const StabilitySequence& sequence, StabilityIndices& result) {
    constexpr int kReach = 2;  // frames before and after whose median is the usual
    constexpr std::size_t kLeastFrames = 3;
    const int count = sequence.count();
    std::vector<TileValues> frames(result.frames.size());
    for (int t = 1; t + 1 < count; ++t) frames[std::size_t(t)] = flashes(sequence, t);
    for (int t = 1; t + 1 < count; ++t) {
        if (frames[std::size_t(t)].empty()) continue;
        std::vector<const TileValues*> around;
        for (int u = std::max(1, t - kReach); u <= std::min(count - 2, t + kReach); ++u)
            if (!frames[std::size_t(u)].empty()) around.push_back(&frames[std::size_t(u)]);
        if (around.size() < kLeastFrames) continue;
        double worst = 0.0;
        for (std::size_t tile = 0; tile < kTilesX * kTilesY; ++tile) {
            std::vector<double> values;
            for (const TileValues* each : around) values.push_back((*each)[tile]);
            worst = std::max(worst, frames[std::size_t(t)][tile] - median(std::move(values)));
        }
        result.frames[std::size_t(t)].spike = worst;
        result.spike = std::max(worst, result.spike.value_or(0.0));
    }
}

}  // namespace studio
