// Technique lpv with transport=sweep through the C API.
#include <catch2/catch.hpp>
#include <cmath>

#include "support/lpv_room.h"
#include "support/packed_light.h"
#include "support/scoped_api.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 45, kHeight = 16;

double evenProfile(double, double) { return 1.0; }

LWLpvDesc sweepOf(std::uint32_t size) {
    LWLpvDesc desc;
    lwDefaultLpv(&desc);
    desc.size = size;
    desc.transport = LW_LPV_TRANSPORT_SWEEP;
    desc.directions = 96;
    return desc;
}

std::vector<float> render(LWDevice device, const LWLpvDesc& desc, const LWFrame& frame, const WallAndCeiling& scene) {
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    technique.update(frame);
    return technique.render(view, scene.gbuffer);
}

}  // namespace

TEST_CASE("a sweep lights the ceiling as a polygon does, and a plate between stops it", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(96, evenProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const std::vector<LWLight> lights = {floor.light};
    const RoomTriangles open(std::nullopt), closed(0.5);
    LWLpvDesc desc = sweepOf(32);
    desc.directions = 384;
    const auto lit = render(device, desc, roomFrame(lights, &open.geometry), scene),
               dark = render(device, desc, roomFrame(lights, &closed.geometry), scene);
    CHECK(ceilingError(lit, scene, kWidth, kHeight) < 0.05);
    double shadow = 0.0;
    for (std::uint32_t y = kHeight / 2; y < kHeight; ++y)
        for (std::uint32_t x = 1; x < kWidth; ++x) shadow += double(dark[y * kWidth + x]) / (kWidth * kHeight / 2);
    // The floor's edges lie open around the plate's by a cell.
    CHECK(shadow < 0.01);
}

TEST_CASE("sweeps: same input, same bits, over runs, widths and frames that share one out", "[lpv]") {
    LitFloor floor(64, evenProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const RoomTriangles room(0.5);
    const std::vector<LWLight> lights = {floor.light};
    LWLpvDesc desc = sweepOf(16);
    desc.bounces = 2;
    TestDevice wide(16), scalar(1);
    const auto first = render(wide, desc, roomFrame(lights, &room.geometry), scene);
    CHECK(meanOf(first) > 0.0);
    for (int run = 0; run < 5; ++run) CHECK(render(wide, desc, roomFrame(lights, &room.geometry), scene) == first);
    CHECK(render(scalar, desc, roomFrame(lights, &room.geometry), scene) == first);
    desc.frames = 4;
    TestTechnique technique(wide, "lpv", &desc);
    TestView view(wide, kWidth, kHeight);
    technique.update(roomFrame({}, &room.geometry));
    technique.update(roomFrame(lights, &room.geometry));
    for (int frame = 1; frame < 8; ++frame) {
        CHECK(meanOf(technique.render(view, scene.gbuffer)) == 0.0);
        technique.update(roomFrame(lights, &room.geometry));
    }
    CHECK(technique.render(view, scene.gbuffer) == first);
    LWFrame cut = roomFrame({}, &room.geometry);
    cut.reset = 1;
    technique.update(cut);
    CHECK(meanOf(technique.render(view, scene.gbuffer)) == 0.0);
}

TEST_CASE("sweeps compile nothing after lwPrewarm, and take the memory that was estimated", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(32, evenProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const RoomTriangles room(std::nullopt);
    LWLpvDesc desc = sweepOf(16);
    desc.bounces = 2;
    desc.frames = 2;
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    const std::vector<LWLight> lights = {floor.light};
    technique.update(roomFrame(lights, &room.geometry));
    technique.render(view, scene.gbuffer);
    LWViewDesc size{};
    size.structSize = sizeof size;
    size.maxWidth = kWidth;
    size.maxHeight = kHeight;
    std::uint64_t estimate = 0;
    const LWFrame frame = roomFrame(lights, &room.geometry);
    REQUIRE(lwEstimateFrameMemory(device, "lpv", &desc, &size, &frame, &estimate) == LW_SUCCESS);
    CHECK(technique.stats().deviceBytes <= estimate);
    CHECK(technique.stats().deviceBytes > estimate / 2);
    technique.update(roomFrame(lights, nullptr));
    technique.render(view, scene.gbuffer);
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
}

TEST_CASE("sweeps refuse what they cannot do, and say what", "[lpv]") {
    TestDevice device(16);
    LWTechnique none = nullptr;
    LWLpvDesc desc = sweepOf(128);
    CHECK(lwCreateLpv(device, &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("size") && Contains("64") && Contains("128"));
    desc = sweepOf(16);
    desc.directions = 25;
    CHECK(lwCreateLpv(device, &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("directions") && Contains("25"));
    desc = sweepOf(16);
    desc.frames = 5;
    CHECK(lwCreateLpv(device, &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("frames") && Contains("5"));
}
