// Technique lpv, both ways of transport, where inputs are at their ends: what must still be true of the light, and of what is said.
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "support/choices.h"
#include "support/lpv_room.h"
#include "support/packed_light.h"
#include "support/scoped_api.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 45, kHeight = 16;

double evenProfile(double, double) { return 1.0; }

LWLpvDesc descOf(LWLpvTransport transport, std::uint32_t bounces = 1) {
    LWLpvDesc desc;
    lwDefaultLpv(&desc);
    desc.size = 16;
    desc.transport = transport;
    desc.directions = 96;
    desc.bounces = bounces;
    return desc;
}

LWFrame frameOf(const std::vector<LWLight>& lights, const LWGeometry* geometry, const std::vector<LWVpl>& vpls = {}) {
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.lights = lights.data();
    frame.lightCount = std::uint32_t(lights.size());
    frame.vpls = vpls.data();
    frame.vplCount = std::uint32_t(vpls.size());
    frame.geometry = geometry;
    return frame;
}

}  // namespace

TEST_CASE("neither the unit of length nor that of light changes more than rounding", "[lpv]") {
    TestDevice device(16);
    LWLpvDesc desc = descOf(GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP, LW_LPV_TRANSPORT_COARSE_TO_FINE), 2);
    if (desc.transport == LW_LPV_TRANSPORT_COARSE_TO_FINE) desc.size = 32;  // two grids
    const auto at = [&](double scale, double exitance) {
        LitFloor floor(48, [&](double, double) { return exitance; }, scale);
        WallAndCeiling scene(kWidth, kHeight, scale);
        const RoomTriangles room(1.0, scale);
        const std::vector<LWLight> lights = {floor.light};
        TestTechnique technique(device, "lpv", &desc);
        TestView view(device, kWidth, kHeight);
        technique.update(frameOf(lights, &room.geometry));
        std::vector<float> light = technique.render(view, scene.gbuffer);
        for (float& value : light) value = float(double(value) / exitance);
        return light;
    };
    const auto one = at(1.0, 1.0);
    CHECK(meanOf(one) > 0.01);
    for (const double scale : {1e-6, 1e-3, 1.0, 1e3, 1e6})
        for (const double exitance : {1e-20, 1.0, 1e20}) {
            CAPTURE(scale, exitance);
            CHECK(difference(at(scale, exitance), one) < 3e-6);
        }
}

TEST_CASE("light that is beyond float's range is brought down, and counted", "[lpv]") {
    TestDevice device(GENERATE(1u, 16u));
    LWLpvDesc desc = descOf(GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP, LW_LPV_TRANSPORT_COARSE_TO_FINE), 2);
    if (desc.transport == LW_LPV_TRANSPORT_COARSE_TO_FINE) desc.size = 32;  // two grids
    const double scale = 1e-3;
    WallAndCeiling scene(kWidth, kHeight, scale);
    const RoomTriangles room(1.0, scale);
    std::vector<LWVpl> vpls(70000);
    for (std::size_t i = 0; i < vpls.size(); ++i) {
        vpls[i].position[0] = float(scale * (double(i % 100) / 100 - 0.5));
        vpls[i].position[2] = float(scale * (double(i / 100 % 100) / 100));
        vpls[i].normal[1] = 1.0f;
        for (float& flux : vpls[i].flux) flux = 1e30f;
    }
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    technique.update(frameOf({}, &room.geometry, vpls));
    std::uint64_t full = 0;
    const std::vector<float> light = technique.render(view, scene.gbuffer);
    for (std::size_t i = 0; i < light.size(); ++i) {
        CHECK((light[i] >= 0.0f && light[i] <= 1e36f));
        full += i < kWidth * kHeight && light[i] == 1e36f ? 1 : 0;
    }
    CHECK(full > 0);
    CHECK(technique.count("saturated_pixels") == full);
}

TEST_CASE("sweeps: triangles may face either way", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(96, evenProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const std::vector<LWLight> lights = {floor.light};
    const RoomTriangles room(1.0, 1.0, GENERATE(false, true));
    LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_SWEEP);
    desc.size = 32;
    desc.directions = 384;
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    technique.update(frameOf(lights, &room.geometry));
    const auto light = technique.render(view, scene.gbuffer);
    CHECK(ceilingError(light, scene, kWidth, kHeight) < 0.05);
}

TEST_CASE("sweeps: triangles without area are not what blocks, and the stats say so", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(48, evenProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const std::vector<LWLight> lights = {floor.light};
    TestView view(device, kWidth, kHeight);
    const float flat[9] = {0, 0, 0, 0, 0, 0, 0.5f, 1, 1};
    LWGeometry geometry{};
    geometry.structSize = sizeof geometry;
    geometry.vertices = flat;
    geometry.vertexCount = 3;
    geometry.triangleCount = 1;
    const LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_SWEEP, 2);
    TestTechnique technique(device, "lpv", &desc);
    const RoomTriangles room(1.0);
    technique.update(frameOf(lights, &room.geometry));
    CHECK(reasonOf(technique, "blockers").find("triangles") == 0);
    CHECK(reasonOf(technique, "frame.geometry") == "");
    technique.update(frameOf(lights, &geometry));
    CHECK(meanOf(technique.render(view, scene.gbuffer)) > 0.01);
    CHECK(reasonOf(technique, "blockers").find("the texels of all RSMs") == 0);
    CHECK(reasonOf(technique, "bounces").find("one") == 0);
    CHECK(reasonOf(technique, "frame.geometry").find("no triangle has an area") != std::string::npos);
}

TEST_CASE("the grid is fitted to triangles, not to vertices that none of them has", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(48, evenProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const std::vector<LWLight> lights = {floor.light};
    TestView view(device, kWidth, kHeight);
    const LWLpvDesc desc = descOf(GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP));
    const RoomTriangles room(1.0);
    std::vector<float> shared = {1000, 1000, 1000};
    shared.insert(shared.end(), room.vertices.begin(), room.vertices.end());
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i < 3 * room.geometry.triangleCount; ++i) indices.push_back(i + 1);
    LWGeometry geometry = room.geometry;
    geometry.vertices = shared.data();
    geometry.vertexCount += 1;
    geometry.indices = indices.data();
    TestTechnique own(device, "lpv", &desc), of_many(device, "lpv", &desc);
    own.update(frameOf(lights, &room.geometry));
    of_many.update(frameOf(lights, &geometry));
    CHECK(of_many.render(view, scene.gbuffer) == own.render(view, scene.gbuffer));
}

TEST_CASE("memory is not estimated of sweeps that cannot be made", "[lpv]") {
    TestDevice device(16);
    LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_SWEEP);
    desc.size = 128;
    LWViewDesc size{};
    size.structSize = sizeof size;
    size.maxWidth = kWidth;
    size.maxHeight = kHeight;
    std::uint64_t estimate = 0;
    CHECK(lwEstimateMemory(device, "lpv", &desc, &size, 1000, &estimate) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("size") != std::string::npos);
}

TEST_CASE("sweeps: the stats say when triangles are too many for the surfels that they are drawn as", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(48, evenProfile);
    const std::vector<LWLight> lights = {floor.light};
    LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_SWEEP);
    desc.extent = 1.125f;
    desc.center[1] = desc.center[2] = 0.5f;
    // Floor, wall and ceiling of area 1, and far from the grid a wall of so much.
    for (const double area : {40.0, 60.0}) {
        RoomTriangles room(1.0);
        room.quad({1000, 0, 0}, {std::sqrt(area), 0, 0}, {0, std::sqrt(area), 0}, 1.0, false);
        room.geometry.vertices = room.vertices.data();
        room.geometry.vertexCount = std::uint32_t(room.vertices.size() / 3);
        room.geometry.triangleCount = room.geometry.vertexCount / 3;
        TestTechnique technique(device, "lpv", &desc);
        technique.update(frameOf(lights, &room.geometry));
        CAPTURE(area);
        CHECK((reasonOf(technique, "blockers.holes") != "") == (area + 3.0 > 40.0 * 1.125 * 1.125));
    }
}

TEST_CASE("sweeps: the host's surfels and VPLs alone need nothing that lwPrewarm did not build", "[lpv]") {
    TestDevice device(GENERATE(1u, 16u));
    WallAndCeiling scene(kWidth, kHeight);
    LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_SWEEP, 2);
    desc.frames = 2;
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    std::vector<LWVpl> vpls(70);
    for (LWVpl& vpl : vpls) {
        vpl.position[2] = 0.5f;
        vpl.normal[1] = vpl.flux[0] = vpl.flux[1] = vpl.flux[2] = 1.0f;
    }
    // A plate half way up.
    constexpr std::uint32_t kSide = 20, kCount = kSide * kSide;
    PlanarPixels position(kCount, 1, 3), normal(kCount, 1, 3), area(kCount, 1, 1);
    for (std::uint32_t i = 0; i < kCount; ++i) {
        position.set(i, 0, {(i % kSide + 0.5) / kSide - 0.5, 0.5, (i / kSide + 0.5) / kSide});
        normal.set(i, 0, {0, -1, 0});
        area.at(i, 0, 0) = 1.25f / kCount;
    }
    LWGeometry geometry{};
    geometry.structSize = sizeof geometry;
    geometry.surfelCount = kCount;
    geometry.surfelPosition = position.image();
    geometry.surfelNormal = normal.image();
    geometry.surfelArea = area.image();
    desc.extent = 1.125f;
    desc.center[1] = desc.center[2] = 0.5f;
    TestTechnique placed(device, "lpv", &desc);
    placed.update(frameOf({}, nullptr, vpls));
    const double open = meanOf(placed.render(view, scene.gbuffer));
    const LWFrame frame = frameOf({}, &geometry, vpls);
    placed.update(frame);
    const double shadowed = meanOf(placed.render(view, scene.gbuffer));
    CHECK(reasonOf(placed, "blockers") == "the host's surfels");
    CHECK(placed.count("surfels") == kCount);
    CHECK(shadowed < 0.5 * open);
    technique.update(frame);
    technique.update(frame);
    technique.update(frameOf({}, nullptr, vpls));
    technique.render(view, scene.gbuffer);
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
    LWViewDesc size{};
    size.structSize = sizeof size;
    size.maxWidth = kWidth;
    size.maxHeight = kHeight;
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateFrameMemory(device, "lpv", &desc, &size, &frame, &estimate) == LW_SUCCESS);
    CHECK(placed.stats().deviceBytes <= estimate);
}

TEST_CASE("frames of nothing, of one point, and grids of any extent: light is finite, and dark without light", "[lpv]") {
    TestDevice device(GENERATE(1u, 16u));
    WallAndCeiling scene(kWidth, kHeight);
    TestView view(device, kWidth, kHeight);
    LitFloor dark(16, [](double, double) { return 0.0; });
    const std::vector<LWLight> unlit = {dark.light};
    const RoomTriangles room(1.0);
    const LWLpvTransport transport = GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP);
    const auto check = [&](TestTechnique& technique, const LWFrame& frame, bool isLit) {
        technique.update(frame);
        for (const float value : technique.render(view, scene.gbuffer)) REQUIRE((value >= 0.0f && value <= 1e36f && (isLit || value == 0.0f)));
    };
    std::vector<LWVpl> point(100);
    for (LWVpl& vpl : point) vpl.normal[1] = vpl.flux[1] = 1.0f;
    for (const float extent : {0.0f, 1e-30f, 1e-17f, 1e-6f, 1.0f, 1e9f}) {
        LWLpvDesc desc = descOf(transport, 2);
        desc.extent = extent;
        CAPTURE(extent, int(transport));
        TestTechnique technique(device, "lpv", &desc);
        check(technique, frameOf({}, nullptr), false);
        check(technique, frameOf({}, nullptr, point), true);
        check(technique, frameOf(unlit, nullptr), false);
        check(technique, frameOf(unlit, &room.geometry), false);
        check(technique, frameOf({}, &room.geometry, point), true);
        check(technique, frameOf({}, nullptr), false);
    }
    for (const float extent : {-1.0f, INFINITY, NAN}) {
        LWLpvDesc desc = descOf(transport);
        desc.extent = extent;
        LWTechnique none = nullptr;
        CHECK(lwCreateLpv(device, &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
    }
}

TEST_CASE("nested grids: light that is brought down is counted once, whatever the width", "[lpv]") {
    LWLpvDesc desc = descOf(GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP));
    desc.cascades = 2;
    LitFloor floor(48, [](double, double) { return 1e37; }, 1e-3);
    const WallAndCeiling scene(kWidth, kHeight, 1e-3);
    const std::vector<LWLight> lights = {floor.light};
    const float middle[3] = {0.0f, 0.5e-3f, 0.0f};  // of the wall: the fine grid has a part of each row
    std::uint64_t counts[2];
    for (const std::uint32_t width : {1u, 16u}) {
        TestDevice device(width);
        TestTechnique technique(device, "lpv", &desc);
        TestView view(device, kWidth, kHeight);
        LWFrame frame = frameOf(lights, nullptr);
        frame.focus = middle;
        technique.update(frame);
        technique.render(view, scene.gbuffer);
        counts[width / 16] = technique.count("saturated_pixels");
    }
    CHECK((counts[0] > 0 && counts[0] <= kWidth * kHeight));
    CHECK(counts[0] == counts[1]);
}
