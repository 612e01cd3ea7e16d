// Technique lpv with transport=coarse_to_fine through the C API.
#include <catch2/catch.hpp>
#include <cmath>

#include "support/choices.h"
#include "support/lpv_room.h"
#include "support/packed_light.h"
#include "support/scoped_api.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;

namespace {

constexpr std::uint32_t kWidth = 29, kHeight = 16;

double evenProfile(double, double) { return 1.0; }

LWLpvDesc descOf(std::uint32_t size) {
    LWLpvDesc desc;
    lwDefaultLpv(&desc);
    desc.size = size;
    desc.transport = LW_LPV_TRANSPORT_COARSE_TO_FINE;
    return desc;
}

std::vector<float> render(LWDevice device, const LWLpvDesc& desc, const LWFrame& frame, const WallAndCeiling& scene) {
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    technique.update(frame);
    return technique.render(view, scene.gbuffer);
}

}  // namespace

TEST_CASE("coarse to fine: light arrives where steps of one grid leave none, and a plate takes most of it", "[lpv]") {
    LitFloor floor(64, evenProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const RoomTriangles open(std::nullopt), closed(0.5);
    const std::vector<LWLight> lights = {floor.light};
    TestDevice wide(16), scalar(1);
    const LWLpvDesc desc = descOf(32);
    const auto lit = render(wide, desc, roomFrame(lights, &open.geometry), scene);
    for (int run = 0; run < 3; ++run) CHECK(render(wide, desc, roomFrame(lights, &open.geometry), scene) == lit);
    CHECK(render(scalar, desc, roomFrame(lights, &open.geometry), scene) == lit);
    const auto dark = render(wide, desc, roomFrame(lights, &closed.geometry), scene);
    LWLpvDesc steps = desc;
    steps.transport = LW_LPV_TRANSPORT_PROPAGATE;
    steps.steps = 4;
    const auto near = render(wide, steps, roomFrame(lights, &open.geometry), scene);
    const auto ceiling = [](const std::vector<float>& light) {
        double sum = 0.0;
        for (std::uint32_t y = kHeight / 2; y < kHeight; ++y)
            for (std::uint32_t x = 1; x < kWidth; ++x) sum += double(light[y * kWidth + x]);
        return sum;
    };
    CHECK(ceiling(near) < 1e-3 * ceiling(lit));
    CHECK(ceiling(dark) < 0.5 * ceiling(lit));
}

TEST_CASE("coarse to fine compiles nothing after lwPrewarm, and takes the memory that was estimated", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(32, evenProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const RoomTriangles room(std::nullopt);
    LWLpvDesc desc = descOf(32);
    desc.autoError = 0.5f;
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    const std::vector<LWLight> lights = {floor.light};
    const LWFrame frame = roomFrame(lights, &room.geometry);
    technique.update(frame);
    technique.render(view, scene.gbuffer);
    CHECK(technique.count("steps") == 4 + 128);
    CHECK(reasonOf(technique, "auto_error") != "");
    LWViewDesc size{};
    size.structSize = sizeof size;
    size.maxWidth = kWidth;
    size.maxHeight = kHeight;
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateFrameMemory(device, "lpv", &desc, &size, &frame, &estimate) == LW_SUCCESS);
    CHECK(technique.stats().deviceBytes <= estimate);
    CHECK(technique.stats().deviceBytes > estimate / 2);
    technique.update(roomFrame(lights, nullptr));
    technique.render(view, scene.gbuffer);
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
}

TEST_CASE("coarse to fine has one grid to read: cascades are refused, also by estimates", "[lpv]") {
    TestDevice device(16);
    LWLpvDesc desc = descOf(32);
    desc.cascades = 3;
    LWTechnique none = nullptr;
    CHECK(lwCreateLpv(device, &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("cascades") && Contains("coarse_to_fine") && Contains("3"));
    LWViewDesc size{};
    size.structSize = sizeof size;
    size.maxWidth = kWidth;
    size.maxHeight = kHeight;
    const LWFrame frame = roomFrame({}, nullptr);
    std::uint64_t estimate = 0;
    CHECK(lwEstimateMemory(device, "lpv", &desc, &size, 1024, &estimate) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("cascades") && Contains("coarse_to_fine"));
    CHECK(lwEstimateFrameMemory(device, "lpv", &desc, &size, &frame, &estimate) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("cascades") && Contains("coarse_to_fine"));
}
