// The history of techniques that look at the view's own pixels: what it gains where nothing moves, for each of their outputs, that
// it does not drift, and that a cut starts anew.
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "support/packed_light.h"
#include "techniques/screen_rig.h"

using namespace lightwell::test;

namespace {

constexpr std::uint32_t kWidth = 64, kHeight = 48;

// Patterns as they are, so that what a frame alone shows is its noise.
LWHorizonDesc horizonWith(std::uint32_t history) {
    LWHorizonDesc desc;
    lwDefaultHorizon(&desc);
    desc.filter = 0;
    desc.resolution = LW_RESOLUTION_FULL;
    desc.history = history;
    return desc;
}

LWAoDesc aoWith(std::uint32_t history, std::uint32_t samples) {
    LWAoDesc desc;
    lwDefaultAo(&desc);
    desc.samples = samples;
    desc.filter = 0;
    desc.packing = 0;
    desc.radius = 0.5f;
    desc.resolution = LW_RESOLUTION_FULL;
    desc.history = history;
    return desc;
}

DrawnView litView() { return DrawnView(litScene(2.0), lookAt({0.7, 1.4, 2.4}, {0, 0.4, 0.3}, 0.42), kWidth, kHeight); }

// Frames of `kept` near `truth`, more than `alone` is, and stay there.
// From frame 192 on: the bounds' measure of the noise takes some 128 frames to settle. horizon, windows of 64 frames from 0 on, against
// frames 64 to 640: with bounds -0.5, -0.2, 0.0 %, then within 0.09 %; without (history_clamp=0) -0.2 %, then within 0.05 %, first
// to last. Nothing goes on drifting.
// noise: of a mean over 128 frames of patterns that never come again, as a share.
void checkStatic(LWDevice device, TestTechnique& kept, const ScreenResult& alone, const ScreenResult& truth, double noise) {
    DrawnView drawn = litView();
    TestView view(device, kWidth, kHeight);
    double first = 0.0, last = 0.0, worst = 0.0;
    const double error = difference(alone.irradiance, truth.irradiance);
    ScreenResult result;
    for (int f = 0; f < 500; ++f) {
        result = renderScreen(kept, view, device, drawn.gbuffer);
        if (f < 64) continue;
        worst = std::max(worst, difference(result.irradiance, truth.irradiance));
        if (f >= 192 && f < 320) first += meanOf(result.irradiance) / 128.0;
        if (f >= 372) last += meanOf(result.irradiance) / 128.0;
    }
    CAPTURE(error, worst, first, last);
    CHECK(worst < 0.7 * error);
    CHECK(last == Approx(first).epsilon(noise));
    CHECK(difference(result.validity, truth.validity) < 0.7 * difference(alone.validity, truth.validity));
    CHECK(difference(result.ambient, truth.ambient) < 0.7 * difference(alone.ambient, truth.ambient));
    CHECK(kept.count("history_new") == 0);
}

LWFrame frameOf(std::uint32_t reset) {
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.reset = reset;
    return frame;
}

}  // namespace

TEST_CASE("with a history horizon nears all slices at once, and stays there for 500 frames", "[horizon][history]") {
    TestDevice device(16);
    LWHorizonDesc all = horizonWith(0);
    all.interleave = 1;
    all.filter = 1;
    const LWHorizonDesc alone = horizonWith(0), kept = horizonWith(32);
    DrawnView drawn = litView();
    const auto single = renderScreen(device, "horizon", &alone, drawn), truth = renderScreen(device, "horizon", &all, drawn);
    TestTechnique technique(device, "horizon", &kept);
    checkStatic(device, technique, single, truth, 1e-3);
}

TEST_CASE("with a history ao nears many points, and stays there for 500 frames", "[ao][history]") {
    TestDevice device(16);
    LWAoDesc all = aoWith(0, 64);
    all.filter = 1;
    const LWAoDesc alone = aoWith(0, 8);
    LWAoDesc kept = aoWith(32, 8);
    // A point in eight that hits is a bright frame among many dark ones, which bounds take for a leap (docs/temporal_history.md).
    kept.historyClamp = 0.0f;
    DrawnView drawn = litView();
    const auto single = renderScreen(device, "ao", &alone, drawn), truth = renderScreen(device, "ao", &all, drawn);
    TestTechnique technique(device, "ao", &kept);
    // Without bounds the mean is linear and cannot drift: what is left is the noise of light that few points find. Ten windows
    // of 64 frames differ from their mean by 0.3 % (standard deviation) in no order, and so do halves of 200 frames.
    checkStatic(device, technique, single, truth, 1e-2);
}

TEST_CASE("a cut starts such histories anew", "[horizon][ao][history]") {
    const char* name = GENERATE("horizon", "ao");
    TestDevice device(GENERATE(1u, 16u));
    const LWHorizonDesc horizon = horizonWith(16);
    const LWAoDesc ao = aoWith(16, 8);
    const void* desc = name[0] == 'h' ? static_cast<const void*>(&horizon) : &ao;
    DrawnView drawn = litView();
    const auto run = [&](int before) {
        TestTechnique technique(device, name, desc);
        TestView view(device, kWidth, kHeight);
        for (int f = 0; f < before; ++f) renderScreen(technique, view, device, drawn.gbuffer);
        technique.update(frameOf(1));
        PlanarPixels irradiance(kWidth, kHeight, 3), ambient(kWidth, kHeight, 1);
        LWOutput output{};
        output.structSize = sizeof output;
        output.irradiance = irradiance.image();
        output.ambientOcclusion = ambient.image();
        REQUIRE(lwRender(technique, view, &drawn.gbuffer, &output) == LW_SUCCESS);
        REQUIRE(lwFinish(device) == LW_SUCCESS);
        return std::make_pair(irradiance.packed(), ambient.packed());
    };
    const auto fresh = run(0), cut = run(5);
    CHECK(cut.first == fresh.first);
    CHECK(cut.second == fresh.second);
}

TEST_CASE("ambient occlusion alone has a history, too", "[horizon][history]") {
    TestDevice device(16);
    LWHorizonDesc all = horizonWith(0);
    all.interleave = 1;
    all.filter = 1;
    const LWHorizonDesc alone = horizonWith(0), kept = horizonWith(32);
    DrawnView drawn = litView();
    const auto single = renderScreen(device, "horizon", &alone, drawn, kAmbient), truth = renderScreen(device, "horizon", &all, drawn, kAmbient);
    TestTechnique technique(device, "horizon", &kept);
    TestView view(device, kWidth, kHeight);
    ScreenResult result;
    for (int f = 0; f < 48; ++f) result = renderScreen(technique, view, device, drawn.gbuffer, kAmbient);
    CHECK(difference(result.ambient, truth.ambient) < 0.7 * difference(single.ambient, truth.ambient));
}
