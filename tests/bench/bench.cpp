// Benchmarks through the C API, named <technique>.<pass's verb>.<size>.<count>: device time of one pass,
// or of a frame from the host's images to the host's output. docs/performance.md says how to run them.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

#include "box_frame.h"
#include "static_vpl_cases.h"

namespace {

// Operations per pixel and virtual light of the bounded gather (docs/techniques/rsm.md).
constexpr double kOperationsPerPair = 33.0;

LWDevice device = nullptr;
LWRoofline roofline;

void check(LWStatus status) {
    if (status == LW_SUCCESS) return;
    const char* message = "";
    lwGetLastError(device, &message);
    throw std::runtime_error(std::string(lwStatusName(status)) + ": " + message);
}

struct Case {
    const char* name;
    const char* pass;  // whose time is reported; null: the whole frame's
    std::uint32_t width, height;
    LWRsmDesc desc;
};

// Technique, view and frame of a case, warmed up.
class Setup {
public:
    explicit Setup(const Case& c) : box_(c.width, c.height, 256) {
        LWViewDesc size;
        LW_INIT(size);
        size.maxWidth = c.width;
        size.maxHeight = c.height;
        check(lwCreateView(device, &size, &view_));
        check(lwCreateRsm(device, &c.desc, &technique_));
        check(lwPrewarm(technique_, view_));
        for (int i = 0; i < 2; ++i) run();
    }
    ~Setup() {
        lwReleaseTechnique(technique_);
        lwReleaseView(view_);
    }
    Setup(const Setup&) = delete;
    Setup& operator=(const Setup&) = delete;
    void run() {
        check(lwUpdate(technique_, &box_.frame));
        check(lwRender(technique_, view_, &box_.gbuffer, &box_.output));
        check(lwFinish(device));
    }
    // Of the last run; the frame's total when `pass` is null.
    double deviceSeconds(const char* pass) {
        LWStats stats;
        LW_INIT(stats);
        check(lwGetStats(technique_, &stats));
        double milliseconds = pass ? -1.0 : stats.totalMilliseconds;
        for (std::uint32_t i = 0; pass && i < stats.passCount; ++i)
            if (!std::strcmp(stats.passes[i].name, pass)) milliseconds = stats.passes[i].milliseconds;
        if (milliseconds < 0.0)
            throw std::runtime_error(std::string("no device time of ") + (pass ? pass : "the frame"));
        return milliseconds * 1e-3;
    }

private:
    bench::BoxFrame box_;
    LWView view_ = nullptr;
    LWTechnique technique_ = nullptr;
};

void runCase(benchmark::State& state, const Case& c) {
    try {
        Setup setup(c);
        double hostSeconds = 0.0, deviceSeconds = 0.0;
        for (auto iteration : state) {
            (void)iteration;
            const auto begin = std::chrono::steady_clock::now();
            setup.run();
            hostSeconds +=
                std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
            const double seconds = setup.deviceSeconds(c.pass);
            deviceSeconds += seconds;
            state.SetIterationTime(seconds);
        }
        const double frames = double(state.iterations());
        state.counters["host_ms"] = 1e3 * hostSeconds / frames;
        const double share = 1.0 / double(c.desc.interleave * c.desc.interleave);
        const double pairs = double(c.width) * c.height * c.desc.vpls * share;
        if (c.pass && std::strstr(c.pass, ".gather") && c.desc.vpls > 0)
            state.counters["share_of_peak"] =
                kOperationsPerPair * pairs * frames / deviceSeconds / (roofline.multiplyAddGflops * 1e9);
    } catch (const std::exception& error) {
        state.SkipWithError(error.what());
    }
}

LWRsmDesc rsm(std::uint32_t vpls, std::uint32_t interleave,
              LWResolution resolution = LW_RESOLUTION_FULL) {
    LWRsmDesc desc;
    lwDefaultRsm(&desc);
    desc.vpls = vpls;
    desc.interleave = interleave;
    desc.resolution = resolution;
    return desc;
}

void registerCases() {
    const Case cases[] = {
        {"rsm.gather.1280x720.n256", "interleaved_gather.gather", 1280, 720, rsm(256, 1)},
        {"rsm.gather.1280x720.n256i4", "interleaved_gather.gather", 1280, 720, rsm(256, 4)},
        {"rsm.gather.1920x1080.n256i4", "interleaved_gather.gather", 1920, 1080, rsm(256, 4)},
        {"rsm.frame.1280x720.n256", nullptr, 1280, 720, rsm(256, 1)},
        {"rsm.frame.1280x720.n256i4", nullptr, 1280, 720, rsm(256, 4)},
        {"rsm.frame.1280x720.n256half", nullptr, 1280, 720, rsm(256, 1, LW_RESOLUTION_HALF)},
        {"rsm.frame.1920x1080.n256i4", nullptr, 1920, 1080, rsm(256, 4)},
        {"rsm.frame.160x90.n64i2", nullptr, 160, 90, rsm(64, 2)},
    };
    for (const Case& c : cases)
        benchmark::RegisterBenchmark(c.name, [c](benchmark::State& state) { runCase(state, c); })
            ->UseManualTime()
            ->Unit(benchmark::kMillisecond);
}

void describeDevice() {
    LWDeviceInfo info;
    LW_INIT(info);
    check(lwGetDeviceInfo(device, &info));
    benchmark::AddCustomContext("lightwell", lwVersion());
    benchmark::AddCustomContext("device", info.name);
    benchmark::AddCustomContext("platform", info.platform);
    benchmark::AddCustomContext("driver", info.driver);
    benchmark::AddCustomContext("width", std::to_string(info.width));
    benchmark::AddCustomContext("multiply_add_gflops", std::to_string(roofline.multiplyAddGflops));
    benchmark::AddCustomContext("bandwidth_gbps", std::to_string(roofline.bandwidthGBps));
    if (const char* commit = std::getenv("LIGHTWELL_COMMIT"))
        benchmark::AddCustomContext("commit", commit);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        check(lwCreateDevice(nullptr, &device));
        LW_INIT(roofline);
        check(lwProbeDevice(device, &roofline));
        describeDevice();
    } catch (const std::exception& error) {
        std::fprintf(stderr, "lightwell_bench: %s\n", error.what());
        return 1;
    }
    registerCases();
    bench::registerStaticVplCases(device);
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    const std::size_t ran = benchmark::RunSpecifiedBenchmarks();
    lwReleaseDevice(device);
    return ran == 0 ? 1 : 0;
}
