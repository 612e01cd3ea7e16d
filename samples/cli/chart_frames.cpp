#include "chart_frames.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace cli {
namespace {

constexpr int kFewestOfAll = 3;

}  // namespace

TimeFigures summarise(std::vector<double> milliseconds) {
    if (milliseconds.empty()) return {};
    std::sort(milliseconds.begin(), milliseconds.end());
    if (milliseconds.front() < 0.0) return {};
    const std::size_t count = milliseconds.size(), middle = count / 2;
    TimeFigures figures;
    figures.median =
        count % 2 != 0 ? milliseconds[middle] : 0.5 * (milliseconds[middle - 1] + milliseconds[middle]);
    figures.p99 = milliseconds[std::size_t(std::ceil(0.99 * double(count))) - 1];
    return figures;
}

ChartedFrames timeFrames(IndirectRenderer& renderer, const RenderInputs& inputs,
                         const FrameLimits& limits) {
    using Clock = std::chrono::steady_clock;
    for (int i = 0; i < limits.warmUp; ++i) renderer.renderFrame(inputs, i == 0);

    ChartedFrames charted;
    std::vector<double> walls, totals;
    const Clock::time_point start = Clock::now();
    const auto isEnough = [&] {
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        if (charted.frames >= limits.most) return true;
        if (charted.frames >= limits.fewest && seconds >= limits.seconds) return true;
        return charted.frames >= kFewestOfAll && seconds >= limits.patience;
    };
    while (!isEnough()) {
        charted.last = renderer.renderFrame(inputs, limits.warmUp == 0 && charted.frames == 0);
        walls.push_back(charted.last.wallMilliseconds);
        totals.push_back(charted.last.totalMilliseconds);
        ++charted.frames;
    }
    charted.wall = summarise(std::move(walls));
    charted.device = summarise(std::move(totals));
    return charted;
}

}  // namespace cli
