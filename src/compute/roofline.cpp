// Measures multiply-add rate, streaming bandwidth and launch cost.
#include "compute/roofline.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "compute/probe_queue.h"
#include "compute/program.h"

namespace lightwell {
namespace {

constexpr std::size_t kGroup = 64;
constexpr double kMultiplyAddSeconds = 0.4, kTriadSeconds = 0.5;  // spent on repetitions of each
constexpr int kMostRuns = 30;
constexpr double kShortRun = 5e-3;  // a run is made longer until it takes this
constexpr double kLongRun = 0.1;    // a streamed array is made longer while it stays below this
constexpr int kFewestLaunches = 16, kMostLaunches = 1024;
constexpr double kChains = 12;  // LW_CHAINS of roofline.cl
// A streamed array; three of them exceed the last-level caches of today's machines, shared ones apart.
constexpr std::size_t kTriadBytes = std::size_t(96) << 20;

// The shortest of repeated runs of `run`, which returns its seconds, within a time.
template <class Run>
double shortest(double budget, Run run) {
    run();  // compiles at the first launch, touches the memory
    const Stopwatch watch;
    double best = run();
    for (int i = 1; i < kMostRuns && watch.seconds() < budget; ++i) best = std::min(best, run());
    return best;
}

double multiplyAddRate(Device& device, ProbeQueue& queue, const Buffer& out, std::size_t items) {
    Kernel& kernel = device.programs().kernel("probe/roofline", "probe_multiply_add");
    int steps = 256;
    const auto run = [&] {
        const Stopwatch watch;
        queue.enqueue(kernel, items, kGroup, 1, cl_float(0.5f), cl_float(1.0f), cl_int(steps),
                      out.get());
        queue.finish();
        return watch.seconds();
    };
    run();
    while (run() < kShortRun && steps < (1 << 20)) steps *= 2;
    const double time = shortest(kMultiplyAddSeconds, run);
    return 2.0 * kChains * device.width() * double(items) * steps / time;
}

double triadRate(Device& device, ProbeQueue& queue) {
    const std::size_t most = std::size_t(std::min(device.maxAllocation(), device.globalMemory() / 8));
    const std::size_t floats =
        std::min(kTriadBytes, most) / sizeof(float) / (256 * kGroup) * (256 * kGroup);
    const Buffer x(device, floats * sizeof(float), "roofline probe");
    const Buffer y(device, floats * sizeof(float), "roofline probe");
    const Buffer out(device, floats * sizeof(float), "roofline probe");
    const cl_float16 one = {{1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}};
    for (const Buffer* buffer : {&x, &y})
        checkCl(clEnqueueFillBuffer(queue.get(), buffer->get(), &one, sizeof one, 0, buffer->bytes(), 0,
                                    nullptr, nullptr),
                "clEnqueueFillBuffer");
    Kernel& kernel = device.programs().kernel("probe/roofline", "probe_triad");
    std::size_t used = floats / 16;
    const auto run = [&] {
        const Stopwatch watch;
        queue.enqueue(kernel, used / device.width(), kGroup, 1, x.get(), y.get(), cl_float(0.5f),
                      out.get());
        queue.finish();
        return watch.seconds();
    };
    run();
    while (used < floats && 2.0 * run() < kLongRun) used *= 2;  // slow devices stop early
    const double time = shortest(kTriadSeconds, run);
    return 3.0 * double(used * sizeof(float)) / time;
}

double launchSeconds(Device& device, ProbeQueue& queue, const Buffer& out) {
    Kernel& kernel = device.programs().kernel("probe/roofline", "probe_launch");
    int launches = kFewestLaunches;
    const auto run = [&] {
        const Stopwatch watch;
        queue.enqueue(kernel, 1, 1, launches, out.get());
        queue.finish();
        return watch.seconds();
    };
    run();
    while (run() < kShortRun && launches < kMostLaunches) launches *= 2;
    return shortest(0.05, run) / launches;
}

// Whether these can be any device's.
bool areRates(const LWRoofline& roofline) {
    for (const double rate : {roofline.multiplyAddGflops, roofline.bandwidthGBps, roofline.launchMicroseconds})
        if (!(rate > 0.0 && std::isfinite(rate))) return false;
    return roofline.structSize == sizeof roofline;
}

}  // namespace

LWRoofline probeRoofline(Device& device) {
    ProbeQueue queue(device);
    // Four groups per compute unit on CPUs; GPUs want their many resident threads.
    const std::size_t items =
        kGroup * std::max<std::size_t>(device.width() == 1 ? 4096 : 64, 4 * device.computeUnits());
    const Buffer out(device, items * device.width() * sizeof(float), "roofline probe");
    const cl_float zero = 0.0f;
    checkCl(clEnqueueFillBuffer(queue.get(), out.get(), &zero, sizeof zero, 0, out.bytes(), 0, nullptr,
                                nullptr),
            "clEnqueueFillBuffer");
    LWRoofline roofline{};
    roofline.structSize = sizeof roofline;
    roofline.width = device.width();
    roofline.multiplyAddGflops = multiplyAddRate(device, queue, out, items) * 1e-9;
    roofline.bandwidthGBps = triadRate(device, queue) * 1e-9;
    roofline.launchMicroseconds = launchSeconds(device, queue, out) * 1e6;
    return roofline;
}

StoreKey rooflineKey(const Device& device) {
    const std::string version = std::to_string(LW_VERSION_MAJOR) + "." + std::to_string(LW_VERSION_MINOR) + "." + std::to_string(LW_VERSION_PATCH);
    return hashKey({"roofline", version, programSource("probe/roofline"), device.identity(), std::to_string(device.computeUnits()),
                    std::to_string(device.width()), std::to_string(sizeof(LWRoofline))});
}

const LWRoofline& renewRoofline(Device& device) {
    const LWRoofline roofline = probeRoofline(device);
    device.roofline() = roofline;
    const auto* first = reinterpret_cast<const unsigned char*>(&roofline);
    if (const auto problem = device.programs().store().write(rooflineKey(device), {first, first + sizeof roofline})) device.warnOfCache(*problem);
    return *device.roofline();
}

const LWRoofline& knownRoofline(Device& device) {
    if (device.roofline()) return *device.roofline();
    const BinaryStore& store = device.programs().store();
    const StoreKey key = rooflineKey(device);
    BinaryStore::Bytes bytes;
    const BinaryStore::Found found = store.read(key, bytes);
    LWRoofline roofline{};
    if (found == BinaryStore::Found::kYes && bytes.size() == sizeof roofline) std::memcpy(&roofline, bytes.data(), sizeof roofline);
    if (!areRates(roofline)) {
        if (found != BinaryStore::Found::kNo)
            device.log(LW_LOG_WARNING, "cache: " + store.path(key) + " is damaged; the device's rates are measured again");
        return renewRoofline(device);
    }
    device.roofline() = roofline;
    return *device.roofline();
}

}  // namespace lightwell
