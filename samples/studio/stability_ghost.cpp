// Ghosts: how much worse surface points look shortly after they came into sight, or after their light
// changed, than the same points once settled.
#include <algorithm>
#include <cmath>

#include "stability_parts.h"

namespace studio {
namespace {

// Mean of |F-R| over the pixel's channels, relative to the frame's light.
double relativeError(const StabilitySequence& sequence, int t, std::size_t pixel) {
    double sum = 0.0;
    for (int c = 0; c < 3; ++c) sum += std::abs(sequence.error(t, pixel, c));
    return sum / (3.0 * sequence.scale(t));
}

// What the tracking of changes knows of a surface point: a state for each pixel, handed from frame to
// frame through StabilitySequence::before.
struct PointState {
    static constexpr int kSteady = -1;  // as old as the sequence
    int age = kSteady;                  // frames since it was revealed or its light changed
    double base = 0.0;                  // the truth's light at that time
    double young = 0.0;                 // its error at kGhostAge
};

// Halved or doubled, and not only in darkness.
bool hasChanged(double base, double now, double scale) {
    constexpr double kShare = 0.5, kDark = 0.1;
    return std::abs(now - base) > kShare * std::max({now, base, kDark * scale});
}

PointState follow(const StabilitySequence& sequence, int t, std::size_t pixel,
                  const std::vector<PointState>& last) {
    const double now = sequence.truthGrey(t, pixel);
    const std::int32_t before = sequence.before(t, pixel);
    PointState fresh;
    fresh.age = t == 0 ? PointState::kSteady : 0;
    fresh.base = now;
    if (before == StabilitySequence::kNone) return fresh;
    PointState state = last[std::size_t(before)];
    if (hasChanged(state.base, now, sequence.scale(t))) return fresh;
    if (state.age != PointState::kSteady) ++state.age;
    return state;
}

// Errors of the same surface points, young and settled.
struct Ghost {
    double young = 0.0, settled = 0.0, count = 0.0;
    void add(double youngError, double settledError) {
        young += youngError;
        settled += settledError;
        count += 1.0;
    }
    // Settled errors of under a percent of the light count as a percent, so that images without error
    // have a ghost, too.
    std::optional<double> value() const {
        constexpr double kLeastCount = 64.0, kLeastError = 0.01;
        if (count < kLeastCount) return std::nullopt;
        return (young - settled) / std::max(settled, kLeastError * count);
    }
};

}  // namespace

void findGhost(const StabilitySequence& sequence, StabilityIndices& result) {
    constexpr int kWait = kSettledAge - kGhostAge;
    std::vector<PointState> last, now;
    Ghost all;
    for (int t = 0; t < sequence.count(); ++t) {
        Ghost frame;
        now.assign(sequence.pixels(t), PointState());
        for (std::size_t pixel = 0; pixel < now.size(); ++pixel) {
            if (!sequence.isSurface(t, pixel)) continue;
            PointState& state = now[pixel] = follow(sequence, t, pixel, last);
            if (state.age == kGhostAge) state.young = relativeError(sequence, t, pixel);
            if (state.age != kSettledAge) continue;
            const double settled = relativeError(sequence, t, pixel);
            frame.add(state.young, settled);
            all.add(state.young, settled);
        }
        if (t >= kWait) result.frames[std::size_t(t - kWait)].ghost = frame.value();
        last.swap(now);
    }
    result.ghost = all.value();
}

}  // namespace studio
