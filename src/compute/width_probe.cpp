// Chooses the number of lanes per work-item by timing the same gather at several widths.
#include <algorithm>
#include <array>
#include <limits>

#include "compute/probe_queue.h"

namespace lightwell {
namespace {

// Enough work-items at width 16 to occupy a large GPU, few enough for 10 ms on two scalar CPU cores.
constexpr std::size_t kPixels = 262144;
constexpr std::size_t kGroup = 64;
constexpr int kFirstCount = 32, kMostCount = 32 << 12;
// Runs shorter than this drown in launch cost; the light count grows until they are longer.
constexpr double kShortestRun = 2e-3;
// Rounds over all widths, of which each keeps its best: the verdict is kept on disk, and a neighbour's burst on
// the machine must not decide it. With 3 runs in a row one machine chose 8 where 16 is faster.
constexpr int kRounds = 7;
constexpr std::array<std::uint32_t, 3> kWidths{1, 8, 16};

}  // namespace

std::uint32_t probeWidth(Device& device) {
    ProbeQueue queue(device);
    const Buffer pixels(device, kPixels * sizeof(float), "width probe");
    const Buffer out(device, kPixels * sizeof(float), "width probe");
    const Buffer lights(device, 64 * sizeof(float), "width probe");
    const cl_float half = 0.5f;
    checkCl(clEnqueueFillBuffer(queue.get(), pixels.get(), &half, sizeof half, 0, pixels.bytes(), 0,
                                nullptr, nullptr),
            "clEnqueueFillBuffer");
    checkCl(clEnqueueFillBuffer(queue.get(), lights.get(), &half, sizeof half, 0, lights.bytes(), 0,
                                nullptr, nullptr),
            "clEnqueueFillBuffer");

    int count = kFirstCount;
    const auto timeOnce = [&](std::uint32_t width) {
        Kernel& kernel = device.programs().kernel("probe/width", "probe_gather", {}, width);
        const Stopwatch watch;
        queue.enqueue(kernel, kPixels / width, kGroup, 1, pixels.get(), lights.get(), cl_int(count), out.get());
        queue.finish();
        return watch.seconds();
    };
    for (const std::uint32_t width : kWidths) timeOnce(width);  // the driver compiles at the first launch
    while (timeOnce(1) < kShortestRun && count < kMostCount) count *= 4;

    std::array<double, kWidths.size()> best;
    best.fill(std::numeric_limits<double>::max());
    for (int round = 0; round < kRounds; ++round)
        for (std::size_t i = 0; i < kWidths.size(); ++i) best[i] = std::min(best[i], timeOnce(kWidths[i]));
    return kWidths[std::size_t(std::min_element(best.begin(), best.end()) - best.begin())];
}

}  // namespace lightwell
