#include "chart_frames.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

#include "film.h"

namespace cli {
namespace {

constexpr int kFewestOfSlow = 3;
constexpr double kVerySlow = 3.0;  // times the patience

double processorMilliseconds() {
    std::timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * double(time.tv_sec) + 1e-6 * double(time.tv_nsec);
}

std::uint64_t hashOf(const studio::PlanarBuffer& buffer) {
    std::uint64_t hash = 6;
    for (int plane = 0; plane < buffer.planes(); ++plane)
        for (int y = 0; y < buffer.height(); ++y)
            hash = studio::hashBytes(buffer.row(plane, y), std::size_t(buffer.width()) * sizeof(float),
                                     hash);
    return hash;
}

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
    ChartedFrames charted;
    std::vector<double> walls, processors, totals;
    const auto measureFrame = [&](bool reset) {
        const double before = processorMilliseconds();
        charted.last = renderer.renderFrame(inputs, reset);
        processors.push_back(processorMilliseconds() - before);
        walls.push_back(charted.last.wallMilliseconds);
        totals.push_back(charted.last.totalMilliseconds);
    };
    const auto forget = [&] {
        walls.clear();
        processors.clear();
        totals.clear();
    };
    for (int i = 0; i < limits.warmUp && (i == 0 || seconds() < limits.patience); ++i) {
        measureFrame(i == 0);
        if (i == 0 && seconds() > limits.patience) break;  // it counts
        forget();
        ++charted.warmUp;
    }

    charted.frames = int(walls.size());
    if (charted.frames == 0) start = Clock::now();
    const auto isEnough = [&](double past) {
        if (charted.frames >= limits.most) return true;
        if (charted.frames >= limits.fewest && past >= limits.seconds) return true;
        if (charted.frames >= kFewestOfSlow && past >= limits.patience) return true;
        return charted.frames >= 1 && past >= kVerySlow * limits.patience;
    };
    while (!isEnough(seconds())) {
        measureFrame(limits.warmUp == 0 && charted.frames == 0);
        ++charted.frames;
    }
    charted.wall = summarise(std::move(walls));
    charted.processor = summarise(std::move(processors));
    charted.device = summarise(std::move(totals));
    return charted;
}

void renderAgain(IndirectRenderer& renderer, const RenderInputs& inputs, int frames) {
    std::uint64_t before = 0;
    for (int i = 0; i < frames; ++i) {
        renderer.renderFrame(inputs, i == 0);
        const std::uint64_t now = hashOf(renderer.irradiance());
        if (i > 0 && now == before) return;
        before = now;
    }
}

}  // namespace cli
