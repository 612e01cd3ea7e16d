// Techniques with a temporal history, through the C API: what it gains where nothing moves, that it does not drift, and what hosts
// rely on (cuts, sizes, eyes, memory, nothing built after lwPrewarm).
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "support/camera_matrices.h"
#include "support/lit_room.h"
#include "support/packed_light.h"
#include "support/scoped_api.h"

using namespace lightwell::test;

namespace {

double tiles(double x, double z) { return (int(std::floor(x * 9.1)) + int(std::floor(z * 9.1))) % 2 != 0 ? 0.15 : 0.8; }

// A wall and a ceiling under a camera that histories are followed through; here it never moves, so any will do.
struct Scene : WallAndCeiling {
    Scene(std::uint32_t width, std::uint32_t height) : WallAndCeiling(width, height) {
        gbuffer.camera = testCamera(kRightHanded, {0.3, 0.5, 3.0}).matrices();
    }
};

LWRsmDesc rsmDesc(std::uint32_t history) {
    LWRsmDesc desc;
    lwDefaultRsm(&desc);
    desc.vpls = 64;
    desc.history = history;
    return desc;
}

LWSsvpDesc ssvpDesc(std::uint32_t history) {
    LWSsvpDesc desc;
    lwDefaultSsvp(&desc);
    desc.vpls = 64;
    desc.bounces = 1;
    desc.history = history;
    return desc;
}

LWFrame frameOf(const LWLight& light, std::uint32_t reset = 0) {
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.lightCount = 1;
    frame.lights = &light;
    frame.reset = reset;
    return frame;
}

constexpr std::uint32_t kWidth = 96, kHeight = 64;

}  // namespace

TEST_CASE("with a history a static view nears the light of all texels, and stays there for 500 frames", "[history]") {
    TestDevice device(16);
    LitFloor floor(96, tiles);
    Scene scene(kWidth, kHeight);
    TestView view(device, kWidth, kHeight);
    LWRsmDesc all = rsmDesc(0);
    all.vpls = 0;
    all.interleave = 1;
    TestTechnique limit(device, all), alone(device, rsmDesc(0)), kept(device, rsmDesc(32));
    limit.update({floor.light});
    alone.update({floor.light});
    const std::vector<float> truth = limit.render(view, scene.gbuffer);
    const double error = difference(alone.render(view, scene.gbuffer), truth);
    double late = 0.0, worst = 0.0, first = 0.0, last = 0.0;
    for (int f = 0; f < 500; ++f) {
        kept.update({floor.light});
        const std::vector<float> picture = kept.render(view, scene.gbuffer);
        if (f < 64) continue;
        const double now = difference(picture, truth);
        worst = std::max(worst, now);
        late = now;
        if (f < 164) first += meanOf(picture) / 100.0;
        if (f >= 400) last += meanOf(picture) / 100.0;
    }
    CHECK(late < 0.7 * error);
    CHECK(worst < 0.8 * error);
    // Means over 100 frames of sample sets that never come again.
    CHECK(last == Approx(first).epsilon(1e-3));
    CHECK(kept.count("history_new") == 0);
}

TEST_CASE("a cut starts anew: the picture of a technique that has just been made", "[history]") {
    TestDevice device(GENERATE(1u, 16u));
    LitFloor floor(32, tiles), other(32, [](double, double) { return 0.3; });
    Scene scene(kWidth, kHeight);
    TestView view(device, kWidth, kHeight), another(device, kWidth, kHeight);
    const bool isSsvp = GENERATE(false, true);
    const LWRsmDesc rsm = rsmDesc(16);
    const LWSsvpDesc ssvp = ssvpDesc(16);
    const auto make = [&] { return std::make_unique<TestTechnique>(device, isSsvp ? "ssvp" : "rsm", isSsvp ? static_cast<const void*>(&ssvp) : &rsm); };
    const auto fresh = make(), cut = make();
    for (int f = 0; f < 5; ++f) {
        cut->update({floor.light});
        cut->render(view, scene.gbuffer);
    }
    cut->update(frameOf(other.light, 1));
    fresh->update(frameOf(other.light, 1));
    CHECK(cut->render(view, scene.gbuffer) == fresh->render(another, scene.gbuffer));
    CHECK(cut->count("history_new") == (kWidth - 1) * kHeight);
}

TEST_CASE("each eye has its own history", "[history]") {
    TestDevice device(16);
    LitFloor floor(32, tiles);
    Scene left(kWidth, kHeight), right(61, 40);
    const auto run = [&](bool withLeft, bool withRight) {
        TestTechnique technique(device, rsmDesc(16));
        TestView leftView(device, kWidth, kHeight), rightView(device, 61, 40);
        std::pair<std::vector<float>, std::vector<float>> pictures;
        for (int f = 0; f < 6; ++f) {
            technique.update({floor.light});
            if (withLeft) pictures.first = technique.render(leftView, left.gbuffer);
            if (withRight) pictures.second = technique.render(rightView, right.gbuffer);
        }
        return pictures;
    };
    const auto both = run(true, true);
    CHECK(both.first == run(true, false).first);
    CHECK(both.second == run(false, true).second);
}

TEST_CASE("a view rendered again in a frame shows what it did", "[history]") {
    TestDevice device(16);
    LitFloor floor(32, tiles);
    Scene scene(kWidth, kHeight);
    TestTechnique once(device, rsmDesc(16)), twice(device, rsmDesc(16));
    TestView view(device, kWidth, kHeight);
    for (int f = 0; f < 4; ++f) {
        once.update({floor.light});
        twice.update({floor.light});
        const std::vector<float> expected = once.render(view, scene.gbuffer);
        CHECK(twice.render(view, scene.gbuffer) == expected);
        CHECK(twice.render(view, scene.gbuffer) == expected);
    }
}

TEST_CASE("with a history, too, nothing is built or allocated after lwPrewarm and the first frame", "[history]") {
    TestDevice device(16);
    LitFloor floor(32, tiles);
    const bool half = GENERATE(false, true);
    LWRsmDesc desc = rsmDesc(16);
    desc.resolution = half ? LW_RESOLUTION_HALF : LW_RESOLUTION_FULL;
    TestTechnique technique(device, desc);
    TestView view(device, 64, 64);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    Scene scene(64, 64), small(40, 24);
    std::uint64_t bytes = 0;
    for (int frame = 0; frame < 20; ++frame) {
        const bool isSmall = frame % 5 == 4;
        view.resize(isSmall ? 40 : 64, isSmall ? 24 : 64);
        technique.update({floor.light});
        const std::vector<float> picture = technique.render(view, isSmall ? small.gbuffer : scene.gbuffer);
        for (const float e : picture) REQUIRE((e >= 0.0f && e < 10.0f));
        if (frame == 0) bytes = technique.stats().deviceBytes;
        CHECK(technique.stats().deviceBytes == bytes);
    }
    const LWDeviceInfo after = device.info();
    CHECK(after.programsBuilt == before.programsBuilt);
    CHECK(after.kernelsSpecialised == before.kernelsSpecialised);
}

TEST_CASE("a history needs the camera, and says so", "[history]") {
    TestDevice device(16);
    LitFloor floor(32, tiles);
    WallAndCeiling scene(kWidth, kHeight);
    TestTechnique technique(device, rsmDesc(16));
    TestView view(device, kWidth, kHeight);
    technique.update({floor.light});
    PlanarPixels irradiance(kWidth, kHeight, 3);
    LWOutput output{};
    output.structSize = sizeof output;
    output.irradiance = irradiance.image();
    CHECK(lwRender(technique, view, &scene.gbuffer, &output) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("gbuffer.camera") != std::string::npos);
}
