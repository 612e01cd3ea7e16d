// Techniques that look at the view's own pixels where hosts do odd things: outputs asked for now and then, sizes of a few pixels
// that change under a history, motion vectors that are no numbers.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "techniques/screen_rig.h"

using namespace lightwell::test;

namespace {

constexpr std::uint32_t kWidth = 64, kHeight = 48;
constexpr unsigned kAll = kIrradiance | kValidity | kAmbient;

TestCamera eye(double x = 0.7) { return lookAt({x, 1.4, 2.4}, {0, 0.4, 0.3}, 0.42); }

// A technique by name, with a history of so many frames.
struct Setting {
    std::string name;
    LWHorizonDesc horizon;
    LWAoDesc ao;
    LWScreenSpaceDesc screenSpace;

    Setting(const char* technique, std::uint32_t history, LWAmbientWeighting weighting = LW_AMBIENT_COSINE) : name(technique) {
        lwDefaultHorizon(&horizon);
        lwDefaultAo(&ao);
        lwDefaultScreenSpace(&screenSpace);
        horizon.history = ao.history = screenSpace.history = history;
        horizon.weighting = weighting;
    }
    const void* desc() const {
        return name == "horizon" ? static_cast<const void*>(&horizon) : name == "ao" ? static_cast<const void*>(&ao) : &screenSpace;
    }
    unsigned outputs() const { return name == "screen_space" ? kIrradiance | kValidity : kAll; }
};

// Without another update.
ScreenResult again(TestTechnique& technique, const TestView& view, LWDevice device, const LWGBuffer& gbuffer, unsigned outputs) {
    PlanarPixels irradiance(view.width(), view.height(), 3), validity(view.width(), view.height(), 1), ambient(view.width(), view.height(), 1);
    LWOutput output{};
    output.structSize = sizeof output;
    if (outputs & kIrradiance) output.irradiance = irradiance.image();
    if (outputs & kValidity) output.validity = validity.image();
    if (outputs & kAmbient) output.ambientOcclusion = ambient.image();
    REQUIRE(lwRender(technique, view, &gbuffer, &output) == LW_SUCCESS);
    REQUIRE(lwFinish(device) == LW_SUCCESS);
    return {irradiance.packed(), validity.packed(), ambient.packed()};
}

bool allFinite(const std::vector<float>& values) {
    return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

LWFrame emptyFrame() {
    LWFrame frame{};
    frame.structSize = sizeof frame;
    return frame;
}

}  // namespace

TEST_CASE("what was not made before has no history", "[horizon][ao][history]") {
    const auto setting = GENERATE(Setting("horizon", 16), Setting("ao", 16), Setting("horizon", 16, LW_AMBIENT_UNIFORM));
    // Outputs before, sizes before: light that was never made, that was made long ago, that was made in another size; likewise openness.
    const unsigned before = GENERATE(unsigned(kAmbient), unsigned(kIrradiance));
    const bool wasLarger = GENERATE(false, true);
    CAPTURE(setting.name, before, wasLarger);
    TestDevice device(16);
    DrawnView drawn(litScene(2.0), eye(), kWidth, kHeight), small(litScene(2.0), eye(), 40, 27);
    DrawnView& now = wasLarger ? small : drawn;
    const auto run = [&](bool renders) {
        TestTechnique technique(device, setting.name.c_str(), setting.desc());
        TestView view(device, kWidth, kHeight);
        if (renders) renderScreen(technique, view, device, drawn.gbuffer, kAll & ~before);
        if (!renders) technique.update(emptyFrame());
        if (wasLarger) view.resize(40, 27);
        for (int f = 0; f < 6; ++f)
            if (renders)
                renderScreen(technique, view, device, now.gbuffer, before);
            else
                technique.update(emptyFrame());
        return renderScreen(technique, view, device, now.gbuffer, kAll);
    };
    const ScreenResult got = run(true), fresh = run(false);
    if (before == kAmbient) {
        CHECK(got.irradiance == fresh.irradiance);
        CHECK(got.validity == fresh.validity);
    } else if (setting.horizon.weighting == LW_AMBIENT_UNIFORM) {  // else openness comes with light
        CHECK(got.ambient == fresh.ambient);
    }
}

TEST_CASE("outputs of one picture may be rendered one after another under a history", "[horizon][ao][history]") {
    const auto setting = GENERATE(Setting("horizon", 16), Setting("ao", 16), Setting("horizon", 16, LW_AMBIENT_UNIFORM));
    const bool ambientFirst = GENERATE(false, true);
    CAPTURE(setting.name, ambientFirst);
    TestDevice device(16);
    TestTechnique apart(device, setting.name.c_str(), setting.desc()), together(device, setting.name.c_str(), setting.desc());
    TestView view(device, kWidth, kHeight), other(device, kWidth, kHeight);
    for (int f = 0; f < 5; ++f) {
        DrawnView drawn(litScene(2.0), eye(0.7 + 0.003 * f), kWidth, kHeight);
        const ScreenResult one = renderScreen(apart, view, device, drawn.gbuffer, ambientFirst ? unsigned(kAmbient) : kAll);
        const ScreenResult two = again(apart, view, device, drawn.gbuffer, ambientFirst ? kAll : unsigned(kAmbient));
        const ScreenResult all = renderScreen(together, other, device, drawn.gbuffer, kAll);
        CAPTURE(f);
        CHECK((ambientFirst ? two : one).irradiance == all.irradiance);
        // Ambient occlusion alone may come from other kernels, whose rounding is its own.
        double off = 0.0;
        for (std::size_t i = 0; i < all.ambient.size(); ++i) off = std::max(off, std::fabs(double(two.ambient[i]) - double(all.ambient[i])));
        CHECK(off < 1e-3);
    }
    CHECK(apart.count("history_new") == together.count("history_new"));
}

TEST_CASE("sizes of a few pixels, and motion vectors that are no numbers, leave numbers and the memory that was said", "[horizon][ao][history]") {
    const auto setting = GENERATE(Setting("horizon", 4), Setting("ao", 4), Setting("screen_space", 4));
    const std::uint32_t width = GENERATE(1u, 16u);
    TestDevice device(width);
    CAPTURE(setting.name, width);
    const std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes = {{1, 1}, {3, 5}, {61, 1}, {1, 47}, {17, 33}, {64, 48}, {3, 5}};
    const auto run = [&] {
        TestTechnique technique(device, setting.name.c_str(), setting.desc());
        TestView view(device, kWidth, kHeight);
        std::vector<float> all;
        for (const auto& [w, h] : sizes) {
            view.resize(w, h);
            DrawnView drawn(litScene(2.0), eye(), w, h);
            std::vector<float> motion(2 * std::size_t(w) * h, 0.0f);
            for (std::size_t i = 0; i < motion.size(); i += 7)
                motion[i] = i % 2 ? std::numeric_limits<float>::quiet_NaN() : std::numeric_limits<float>::infinity();
            for (int f = 0; f < 3; ++f) {
                drawn.gbuffer.motion = {};
                if (f == 1) {
                    drawn.gbuffer.motion.host = motion.data();
                    drawn.gbuffer.motion.format = LW_FORMAT_FLOAT2;
                    drawn.gbuffer.motion.width = w;
                    drawn.gbuffer.motion.height = h;
                }
                const ScreenResult r = renderScreen(technique, view, device, drawn.gbuffer, setting.outputs());
                CAPTURE(w, h, f);
                CHECK(allFinite(r.irradiance));
                CHECK(allFinite(r.validity));
                CHECK(allFinite(r.ambient));
                all.insert(all.end(), r.irradiance.begin(), r.irradiance.end());
            }
        }
        LWViewDesc desc{};
        desc.structSize = sizeof desc;
        desc.maxWidth = kWidth;
        desc.maxHeight = kHeight;
        std::uint64_t estimate = 0;
        REQUIRE(lwEstimateMemory(device, setting.name.c_str(), setting.desc(), &desc, 0, &estimate) == LW_SUCCESS);
        CHECK(technique.stats().deviceBytes <= estimate);
        return all;
    };
    const std::vector<float> first = run();
    if (width == 16)
        for (int i = 1; i < 10; ++i) REQUIRE(run() == first);
}
