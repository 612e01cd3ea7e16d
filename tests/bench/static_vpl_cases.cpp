#include "static_vpl_cases.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "box_frame.h"

namespace bench {
namespace {

constexpr float kGolden = 0.618034f, kPlastic = 0.754878f;

float part(float x) {
    return x - std::floor(x);
}

struct Room {
    std::vector<LWStaticVpl> vpls;
    std::vector<LWBlocker> blockers;
    std::vector<LWLight> lights;
    LWFrame frame;

    explicit Room(std::uint32_t count) : vpls(count), blockers(50), lights(3) {
        for (std::uint32_t i = 0; i < count; ++i) {
            LWStaticVpl& vpl = vpls[i];
            const std::uint32_t axis = i % 3;
            const bool far = i / 3 % 2 != 0;
            const float at[3] = {part(kGolden * float(i)), part(kPlastic * float(i)),
                                 part(0.5698403f * float(i))};
            const float size[3] = {6.0f, 3.0f, 8.0f};
            for (std::uint32_t a = 0; a < 3; ++a)
                vpl.position[a] = size[a] * (a == axis ? (far ? 1.0f : 0.0f) : at[a]);
            vpl.normal[axis] = far ? -1.0f : 1.0f;
            vpl.weight = 150.0f / float(count);
            for (float& rho : vpl.reflectance) rho = 0.6f;
        }
        for (std::size_t i = 0; i < blockers.size(); ++i) {
            blockers[i].center[0] = 6.0f * part(kPlastic * float(i));
            blockers[i].center[1] = 2.0f * part(kGolden * float(i));
            blockers[i].center[2] = 8.0f * float(i) / 50.0f;
            blockers[i].radius = 0.3f;
        }
        for (LWLight& light : lights) {
            LW_INIT(light);
            light.position[0] = 3.0f;
            light.position[1] = 1.7f;
            light.position[2] = 4.0f;
            light.direction[0] = 0.3f;
            light.direction[1] = -1.0f;
            light.innerConeAngle = 0.3f;
            light.outerConeAngle = 0.6f;
            for (int c = 0; c < 3; ++c) {
                light.irradiance[c] = 3.0f;
                light.radiantIntensity[c] = 40.0f;
            }
        }
        lights[1].kind = LW_LIGHT_POINT;
        lights[2].kind = LW_LIGHT_SPOT;
        LW_INIT(frame);
        frame.staticVpls = vpls.data();
        frame.staticVplCount = count;
        frame.blockers = blockers.data();
        frame.blockerCount = std::uint32_t(blockers.size());
        frame.lights = lights.data();
        frame.lightCount = std::uint32_t(lights.size());
    }
    Room(const Room&) = delete;

    // The torch sweeps: no frame is the last one's.
    void turn(int step) {
        lights[2].direction[0] = std::cos(0.01f * float(step));
        lights[2].direction[2] = std::sin(0.01f * float(step));
    }
};

bool failed(benchmark::State& state, LWDevice device, LWStatus status) {
    if (status == LW_SUCCESS) return false;
    const char* message = "";
    lwGetLastError(device, &message);
    state.SkipWithError(message);
    return true;
}

void run(benchmark::State& state, LWDevice device, std::uint32_t count, bool lists) {
    Room room(count);
    LWTechnique technique = nullptr;
    if (failed(state, device, lwCreateStaticVpl(device, nullptr, &technique))) return;
    std::vector<LWListedLight> lights(64);
    std::uint32_t listed = 0;
    const auto frame = [&](int step) {
        room.turn(step);
        const LWStatus status = lwUpdate(technique, &room.frame);
        if (status != LW_SUCCESS) return status;
        return lists ? lwReadLightList(technique, lights.data(), 64, &listed) : lwFinish(device);
    };
    for (int i = 0; i < 20; ++i)
        if (failed(state, device, frame(i))) break;
    int step = 20;
    for (auto iteration : state) {
        (void)iteration;
        if (failed(state, device, frame(step++))) break;
    }
    LWStats stats;
    LW_INIT(stats);
    if (!failed(state, device, lwGetStats(technique, &stats))) {
        state.counters["device_us"] = 1e3 * stats.totalMilliseconds;
        if (lists) state.counters["lights"] = double(listed);
    }
    lwReleaseTechnique(technique);
}

constexpr std::uint32_t kEyeWidth = 640, kEyeHeight = 360;

// One update and a picture for each eye; with `updatesEach`, as a host does that knows no better, an
// update for each of them.
void runEyes(benchmark::State& state, LWDevice device, std::size_t eyes, bool updatesEach) {
    Room room(200);
    LWTechnique technique = nullptr;
    if (failed(state, device, lwCreateStaticVpl(device, nullptr, &technique))) return;
    LWViewDesc desc;
    LW_INIT(desc);
    desc.maxWidth = kEyeWidth;
    desc.maxHeight = kEyeHeight;
    std::vector<std::unique_ptr<BoxFrame>> frames;
    std::vector<LWView> views(eyes);
    bool ready = true;
    for (LWView& view : views) {
        frames.push_back(std::make_unique<BoxFrame>(kEyeWidth, kEyeHeight, 1));
        ready = ready && !failed(state, device, lwCreateView(device, &desc, &view));
    }
    const auto frame = [&](int step) {
        room.turn(step);
        for (std::size_t eye = 0; eye < eyes; ++eye) {
            LWStatus status = LW_SUCCESS;
            if (eye == 0 || updatesEach) status = lwUpdate(technique, &room.frame);
            if (status == LW_SUCCESS)
                status = lwRender(technique, views[eye], &frames[eye]->gbuffer, &frames[eye]->output);
            if (status != LW_SUCCESS) return status;
        }
        return lwFinish(device);
    };
    for (int i = 0; ready && i < 20; ++i) ready = !failed(state, device, frame(i));
    int step = 20;
    for (auto iteration : state) {
        (void)iteration;
        if (!ready || failed(state, device, frame(step++))) break;
    }
    for (LWView view : views) lwReleaseView(view);
    lwReleaseTechnique(technique);
}

}  // namespace

void registerStaticVplCases(LWDevice device) {
    struct Eyes {
        const char* name;
        std::size_t count;
        bool updatesEach;
    };
    for (const Eyes& eyes : {Eyes{"one", 1, false}, Eyes{"two", 2, false}, Eyes{"two_updates", 2, true}})
        benchmark::RegisterBenchmark(
            ("static_vpl.eyes." + std::string(eyes.name)).c_str(),
            [=](benchmark::State& state) { runEyes(state, device, eyes.count, eyes.updatesEach); })
            ->UseRealTime()
            ->Unit(benchmark::kMicrosecond);
    for (const bool lists : {false, true})
        for (const std::uint32_t count : {20u, 200u, 2000u})
            benchmark::RegisterBenchmark(
                ("static_vpl." + std::string(lists ? "lights" : "update") + ".n" + std::to_string(count))
                    .c_str(),
                [=](benchmark::State& state) { run(state, device, count, lists); })
                ->UseRealTime()
                ->Unit(benchmark::kMicrosecond);
}

}  // namespace bench
