// Technique lpv with an error target: what steps it takes, and that nothing else is different from as many that were asked for.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/choices.h"
#include "support/lpv_room.h"
#include "support/packed_light.h"
#include "support/scoped_api.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;

namespace {

constexpr std::uint32_t kWidth = 29, kHeight = 16;

double spotProfile(double x, double z) { return x * x + (z - 0.4) * (z - 0.4) < 0.05 ? 3.0 : 0.0; }

LWLpvDesc descOf(std::uint32_t steps, float target) {
    LWLpvDesc desc;
    lwDefaultLpv(&desc);
    desc.size = 16;
    desc.steps = steps;
    desc.autoError = target;
    return desc;
}

LWFrame frameOf(const std::vector<LWLight>& lights, const LWGeometry* geometry) {
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.lights = lights.data();
    frame.lightCount = std::uint32_t(lights.size());
    frame.geometry = geometry;
    return frame;
}

}  // namespace

TEST_CASE("an error target takes as many steps as it needs, and gives the bits of so many", "[lpv]") {
    TestDevice device(GENERATE(1u, 16u));
    LitFloor floor(64, spotProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const RoomTriangles room(std::nullopt);
    const std::vector<LWLight> lights = {floor.light};
    const LWGeometry* geometry = GENERATE(true, false) ? &room.geometry : nullptr;
    const auto render = [&](LWLpvDesc desc, std::uint64_t* steps, std::string* reason) {
        desc.geometryVolume = geometry ? LW_GEOMETRY_VOLUME_AUTO : LW_GEOMETRY_VOLUME_OFF;
        TestTechnique technique(device, "lpv", &desc);
        TestView view(device, kWidth, kHeight);
        technique.update(frameOf(lights, geometry));
        const auto light = technique.render(view, scene.gbuffer);
        if (steps) *steps = technique.count("steps");
        if (reason) *reason = reasonOf(technique, "steps");
        return light;
    };
    std::uint64_t steps = 0, fewer = 0, all = 0;
    std::string ended, never;
    const auto found = render(descOf(256, 0.2f), &steps, &ended), rough = render(descOf(256, 0.6f), &fewer, nullptr);
    CHECK(steps < 256);
    CHECK(steps % 8 == 0);
    CHECK(fewer < steps);
    CHECK_THAT(ended, Contains("auto_error") && Contains("ended"));
    const auto asked = render(descOf(std::uint32_t(steps), 0.0f), nullptr, nullptr);
    // The calibration of these steps, rounded once more.
    for (std::size_t i = 0; i < asked.size(); ++i) REQUIRE(double(found[i]) == Approx(double(asked[i])).epsilon(4e-7).margin(1e-30));
    const auto most = render(descOf(24, 1e-9f), &all, &never);
    CHECK(all == 24);
    CHECK_THAT(never, Contains("all"));
    CHECK(most == render(descOf(24, 0.0f), nullptr, nullptr));
}

TEST_CASE("an error target compiles nothing after lwPrewarm, and takes the memory that was estimated", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(32, spotProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const RoomTriangles room(std::nullopt);
    const LWLpvDesc desc = descOf(33, 0.1f);
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    const std::vector<LWLight> lights = {floor.light};
    LWFrame frame = frameOf(lights, &room.geometry);
    frame.environment[1] = 0.5f;
    technique.update(frame);
    technique.render(view, scene.gbuffer);
    LWViewDesc size{};
    size.structSize = sizeof size;
    size.maxWidth = kWidth;
    size.maxHeight = kHeight;
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateFrameMemory(device, "lpv", &desc, &size, &frame, &estimate) == LW_SUCCESS);
    CHECK(technique.stats().deviceBytes <= estimate);
    CHECK(technique.stats().deviceBytes > estimate / 2);
    technique.update(frameOf(lights, nullptr));
    technique.render(view, scene.gbuffer);
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
}

TEST_CASE("an error target that is no share is refused by name", "[lpv]") {
    TestDevice device(16);
    for (const float target : {-0.1f, 1.5f, std::numeric_limits<float>::quiet_NaN()}) {
        const LWLpvDesc desc = descOf(0, target);
        LWTechnique none = nullptr;
        CHECK(lwCreateLpv(device, &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
        CHECK_THAT(lastError(device), Contains("auto_error") || Contains("autoError"));
    }
}
