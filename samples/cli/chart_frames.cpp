#include "chart_frames.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace cli {
namespace {

constexpr int kFewestOfSlow = 3;
constexpr double kVerySlow = 3.0;  // times the patience

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
    Clock::time_point start = Clock::now();
    const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
    for (int i = 0; i < limits.warmUp && (i == 0 || seconds() < limits.patience); ++i)
        renderer.renderFrame(inputs, i == 0);

    ChartedFrames charted;
    std::vector<double> walls, totals;
    start = Clock::now();
    const auto isEnough = [&](double past) {
        if (charted.frames >= limits.most) return true;
        if (charted.frames >= limits.fewest && past >= limits.seconds) return true;
        if (charted.frames >= kFewestOfSlow && past >= limits.patience) return true;
        return charted.frames >= 1 && past >= kVerySlow * limits.patience;
    };
    while (!isEnough(seconds())) {
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
