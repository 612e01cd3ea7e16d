// Chooses the number of lanes per work-item by timing the same gather at several widths.
#include <algorithm>

#include "compute/probe_queue.h"

namespace lightwell {
namespace {

// Enough work-items at width 16 to occupy a large GPU, few enough for 10 ms on two scalar CPU cores.
constexpr std::size_t kPixels = 262144;
constexpr std::size_t kGroup = 64;
constexpr int kFirstCount = 32, kMostCount = 32 << 12;
// Runs shorter than this drown in launch cost; the light count grows until they are longer.
constexpr double kShortestRun = 2e-3;
constexpr int kRuns = 3;

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
    std::uint32_t best = 1;
    double bestTime = 0.0;
    for (const std::uint32_t width : {1u, 8u, 16u}) {
        Kernel& kernel = device.programs().kernel("probe/width", "probe_gather", {}, width);
        const auto timeOnce = [&] {
            const Stopwatch watch;
            queue.enqueue(kernel, kPixels / width, kGroup, 1, pixels.get(), lights.get(), cl_int(count),
                          out.get());
            queue.finish();
            return watch.seconds();
        };
        timeOnce();  // the driver compiles at the first launch
        double time = timeOnce();
        while (width == 1 && time < kShortestRun && count < kMostCount) {
            count *= 4;
            time = timeOnce();
        }
        for (int run = 1; run < kRuns; ++run) time = std::min(time, timeOnce());
        if (width == 1 || time < bestTime) {
            best = width;
            bestTime = time;
        }
    }
    return best;
}

}  // namespace lightwell
