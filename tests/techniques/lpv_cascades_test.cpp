// Technique lpv with cascades through the C API.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <optional>

#include "support/lpv_room.h"
#include "support/packed_light.h"
#include "support/scoped_api.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;

namespace {

constexpr std::uint32_t kWidth = 45, kHeight = 16;

double evenProfile(double, double) { return 1.0; }

// Of cells of 1/4, 1/8 and 1/16 with 16 cells a side.
LWLpvDesc descOf(LWLpvTransport transport, std::uint32_t cascades = 3, float extent = 4.0f, std::uint32_t size = 16) {
    LWLpvDesc desc;
    lwDefaultLpv(&desc);
    desc.size = size;
    desc.transport = transport;
    desc.directions = 96;
    desc.cascades = cascades;
    desc.extent = extent;
    return desc;
}

LWFrame frameOf(const std::vector<LWLight>& lights, const LWGeometry* geometry, const std::array<float, 3>* focus) {
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.lights = lights.data();
    frame.lightCount = std::uint32_t(lights.size());
    frame.geometry = geometry;
    frame.focus = focus ? focus->data() : nullptr;
    return frame;
}

struct Room {
    LitFloor floor{96, evenProfile};
    WallAndCeiling view{kWidth, kHeight};
    RoomTriangles triangles;
    std::vector<LWLight> lights{floor.light};
    explicit Room(std::optional<double> lid = std::nullopt) : triangles(lid) {}

    std::vector<float> render(LWDevice device, const LWLpvDesc& desc, const std::array<float, 3>* focus) {
        TestTechnique technique(device, "lpv", &desc);
        return render(device, technique, focus);
    }
    std::vector<float> render(LWDevice device, TestTechnique& technique, const std::array<float, 3>* focus) {
        TestView target(device, kWidth, kHeight);
        technique.update(frameOf(lights, &triangles.geometry, focus));
        return technique.render(target, view.gbuffer);
    }
};

LWLpvTransport anyTransport() { return GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP); }

}  // namespace

TEST_CASE("cascades: a focus that stays within a cell changes nothing, to the bit; one that comes back neither", "[lpv_cascades]") {
    TestDevice device(16);
    Room room;
    const LWLpvDesc desc = descOf(anyTransport());
    TestTechnique technique(device, "lpv", &desc);
    const std::array<float, 3> here = {0.01f, 0.52f, 0.51f}, there = {0.06f, 0.55f, 0.56f}, away = {0.3f, 0.9f, 0.2f};
    const std::vector<float> first = room.render(device, technique, &here);
    CHECK(meanOf(first) > 0.0);
    CHECK((room.render(device, technique, &there) == first));
    CHECK((room.render(device, technique, &away) != first));
    CHECK((room.render(device, technique, &here) == first));
    CHECK((room.render(device, desc, &here) == first));
}

// Steps along an axis, along all, beyond the finest grid's side, and back; a lid comes and goes meanwhile.
TEST_CASE("cascades: wherever the focus has been, the picture is that of a technique made where it is, to the bit", "[lpv_cascades]") {
    TestDevice device(16);
    Room open, closed(0.8);
    const LWLpvDesc desc = descOf(anyTransport());
    TestTechnique technique(device, "lpv", &desc);
    std::array<float, 3> focus = {0.03f, 0.53f, 0.53f};
    constexpr int kSteps[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, -2, 0}, {1, 1, 1}, {-3, 2, -1}, {0, 0, 5}, {20, -3, 1}, {-20, 3, -5}, {-40, 9, 9}};
    int at = 0;
    for (const int(&step)[3] : kSteps) {
        for (std::size_t a = 0; a < 3; ++a) focus[a] += 0.0625f * float(step[a]);
        Room& room = at == 4 || at == 5 || at == 8 ? closed : open;
        const std::vector<float> walked = room.render(device, technique, &focus);
        INFO("stop " << at);
        CHECK((room.render(device, desc, &focus) == walked));
        ++at;
    }
}

TEST_CASE("cascades: widths 1 and 16 give the same bits", "[lpv_cascades]") {
    TestDevice wide(16), scalar(1);
    Room room;
    const LWLpvDesc desc = descOf(anyTransport());
    const std::array<float, 3> focus = {0.01f, 0.52f, 0.51f};
    CHECK((room.render(wide, desc, &focus) == room.render(scalar, desc, &focus)));
}

// A floor of exitance 1 by a ceiling, whose light is known. The finest grid, of side 1 and cells of 1/16, is moved up, so that the
// floor is all in it, on its border, and outside of it, where the middle grid brings its light: counted twice it would be 1 off, lost
// as much.
TEST_CASE("sweeps through cascades: near and far light together are the polygon's, wherever the border is", "[lpv_cascades]") {
    TestDevice device(16);
    Room room;
    LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_SWEEP);
    desc.directions = 216;
    const float height = GENERATE(0.3f, 0.45f, 0.48f, 0.52f, 0.55f, 0.6f, 0.8f, 1.0f);
    const std::array<float, 3> focus = {0.01f, height, 0.51f};
    INFO("height " << height);
    CHECK(ceilingError(room.render(device, desc, &focus), room.view, kWidth, kHeight) < 0.08);
}

TEST_CASE("sweeps through cascades: far light in a fine grid is no worse than that of one grid as coarse as where it comes from",
          "[lpv_cascades]") {
    TestDevice device(16);
    Room room;
    LWLpvDesc one = descOf(LW_LPV_TRANSPORT_SWEEP, 1, 2.0f), nested = descOf(LW_LPV_TRANSPORT_SWEEP, 2, 2.0f);
    one.directions = nested.directions = 216;
    const std::array<float, 3> focus = {0.01f, 1.05f, 0.51f};  // the fine grid holds the ceiling alone
    const double coarse = ceilingError(room.render(device, one, &focus), room.view, kWidth, kHeight),
                 fine = ceilingError(room.render(device, nested, &focus), room.view, kWidth, kHeight);
    CHECK(coarse < 0.08);
    CHECK(fine < coarse + 0.01);
}

// All of the room lies where the finest grid, of side 2, has all of a pixel's light; no triangles, which a single grid draws by chance.
TEST_CASE("cascades: what lies in the finest grid alone has the bits of that grid alone", "[lpv_cascades]") {
    TestDevice device(16);
    Room room;
    room.triangles.geometry = LWGeometry{};
    room.triangles.geometry.structSize = sizeof(LWGeometry);
    const LWLpvTransport transport = anyTransport();
    LWLpvDesc nested = descOf(transport, 3, 8.0f), one = descOf(transport, 1, 2.0f);
    nested.geometryVolume = one.geometryVolume = LW_GEOMETRY_VOLUME_OFF;
    const std::array<float, 3> focus = {0.01f, 0.51f, 0.51f};
    const std::vector<float> light = room.render(device, one, &focus);
    CHECK(meanOf(light) > 0.0);
    CHECK((room.render(device, nested, &focus) == light));
}

// The finest grid holds the ceiling alone: it reads what a single grid as coarse as the next one has there, half a fine cell off the
// ceiling where that is read half a coarse one off. (Propagated light does not reach a truth to compare with.)
TEST_CASE("cascades: light of the coarser grid alone is that grid's", "[lpv_cascades]") {
    TestDevice device(16);
    Room room;
    room.triangles.geometry = LWGeometry{};
    room.triangles.geometry.structSize = sizeof(LWGeometry);
    const LWLpvTransport transport = anyTransport();
    LWLpvDesc nested = descOf(transport, 2, 4.0f), one = descOf(transport, 1, 4.0f);
    nested.geometryVolume = one.geometryVolume = LW_GEOMETRY_VOLUME_OFF;
    const std::array<float, 3> focus = {0.01f, 1.55f, 0.51f};
    CHECK(difference(room.render(device, nested, &focus), room.render(device, one, &focus)) < 0.12);
}

// The ceiling lies in the finest grid, the floor in it (extent 8) or below (4).
TEST_CASE("cascades: light of the world stays when grids move by a cell", "[lpv_cascades]") {
    TestDevice device(16);
    Room room;
    const LWLpvTransport transport = anyTransport();
    const float extent = GENERATE(4.0f, 8.0f);
    const LWLpvDesc desc = descOf(transport, 3, extent);
    TestTechnique technique(device, "lpv", &desc);
    const float cell = extent / 64.0f;
    const std::array<float, 3> here = {0.5f * cell, 0.72f, 0.47f}, there = {1.5f * cell, 0.72f, 0.47f};
    const std::vector<float> first = room.render(device, technique, &here), moved = room.render(device, technique, &there);
    CHECK((moved != first));
    INFO("extent " << extent);
    CHECK(difference(moved, first) < (transport == LW_LPV_TRANSPORT_SWEEP ? 0.02 : 0.05));
}

TEST_CASE("cascades: a light's maps, split into nested ones or not, light alike", "[lpv_cascades]") {
    TestDevice device(16);
    const LWLpvTransport transport = anyTransport();
    Room room;
    LitFloor coarse(32, evenProfile), fine(32, evenProfile), whole(64, evenProfile);
    // The middle of the floor, a quarter of it, a finer map of its own.
    for (std::uint32_t j = 0; j < 32; ++j)
        for (std::uint32_t i = 0; i < 32; ++i) {
            const double x = ((i + 0.5) / 32 - 0.5) / 2, z = 0.25 + (j + 0.5) / 64, power = 0.25 / 1024;
            fine.position.set(i, j, {x, 0.0, z});
            fine.flux.set(i, j, {power, power, power});
        }
    for (float& m : fine.rsm.camera.projection) m = 0.0f;
    fine.rsm.camera.projection[0] = fine.rsm.camera.projection[5] = 4.0f;
    fine.rsm.camera.projection[10] = -0.5f;
    fine.rsm.camera.projection[15] = 1.0f;
    const std::array<LWRsm, 2> maps = {fine.rsm, coarse.rsm};
    LWLight split = coarse.light;
    split.rsmCount = 2;
    split.rsms = maps.data();
    // Sums in cells are the same, of texels that lie in cells whole; but for the brightest texel, whose bits light is kept in.
    const LWLpvDesc desc = descOf(transport);
    const std::array<float, 3> focus = {0.01f, 0.3f, 0.51f};
    room.lights = {split};
    const std::vector<float> parts = room.render(device, desc, &focus);
    room.lights = {whole.light};
    const std::vector<float> one = room.render(device, desc, &focus);
    CHECK(difference(parts, one) < 1e-5);
}

TEST_CASE("sweeps through cascades: frames that share directions out, and further bounces, end at the same bits", "[lpv_cascades]") {
    TestDevice device(16);
    Room room(0.5);
    LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_SWEEP, 2);
    desc.bounces = 2;
    const std::array<float, 3> focus = {0.01f, 0.6f, 0.51f};
    const std::vector<float> once = room.render(device, desc, &focus);
    desc.bounces = 1;
    CHECK(meanOf(once) > meanOf(room.render(device, desc, &focus)));
    desc.bounces = 2;
    desc.frames = 4;
    TestTechnique technique(device, "lpv", &desc);
    const std::vector<LWLight> lit = room.lights;
    room.lights.clear();
    const std::array<float, 3> elsewhere = {0.3f, 0.6f, 0.51f};
    CHECK(meanOf(room.render(device, technique, &elsewhere)) == 0.0);
    room.lights = lit;
    for (int frame = 1; frame < 8; ++frame) CHECK(meanOf(room.render(device, technique, &focus)) == 0.0);
    CHECK((room.render(device, technique, &focus) == once));
}

TEST_CASE("cascades compile nothing after lwPrewarm, and take the memory that was estimated", "[lpv_cascades]") {
    TestDevice device(16);
    Room room;
    LWLpvDesc desc = descOf(anyTransport());
    desc.extent = 0.0f;
    desc.bounces = 2;
    desc.frames = 2;
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    const std::array<float, 3> focus = {0.01f, 0.6f, 0.51f};
    room.render(device, technique, &focus);
    LWViewDesc size{};
    size.structSize = sizeof size;
    size.maxWidth = kWidth;
    size.maxHeight = kHeight;
    std::uint64_t estimate = 0;
    const LWFrame frame = frameOf(room.lights, &room.triangles.geometry, &focus);
    REQUIRE(lwEstimateFrameMemory(device, "lpv", &desc, &size, &frame, &estimate) == LW_SUCCESS);
    CHECK(technique.stats().deviceBytes <= estimate);
    CHECK(technique.stats().deviceBytes > estimate / 2);
    CHECK(technique.count("cascades") == 3);
    technique.update(frameOf(room.lights, nullptr, nullptr));
    technique.render(view, room.view.gbuffer);
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
}

TEST_CASE("cascades: a light outside of all grids is counted once, one in any is not", "[lpv_cascades]") {
    TestDevice device(16);
    const LWLpvDesc desc = descOf(anyTransport());
    TestTechnique technique(device, "lpv", &desc);
    std::array<LWVpl, 4> vpls{};
    const float at[4] = {0.1f, 0.7f, 1.5f, 7.0f};  // in each grid, and in none
    for (std::size_t i = 0; i < 4; ++i) {
        vpls[i].position[0] = at[i];
        vpls[i].normal[1] = vpls[i].flux[0] = 1.0f;
    }
    const std::array<float, 3> focus = {0.0f, 0.0f, 0.0f};
    LWFrame frame = frameOf({}, nullptr, &focus);
    frame.vpls = vpls.data();
    frame.vplCount = 4;
    technique.update(frame);
    CHECK(technique.count("lights_outside") == 1);
}

TEST_CASE("cascades: a focus anywhere is legal, none as well; validity is the coarsest grid's", "[lpv_cascades]") {
    TestDevice device(16);
    Room room;
    LWLpvDesc desc = descOf(anyTransport(), 3, 0.0f);
    TestTechnique technique(device, "lpv", &desc);
    const std::vector<float> middle = room.render(device, technique, nullptr);
    CHECK(meanOf(middle) > 0.0);
    CHECK(technique.count("pixels_outside") == 0);
    for (const float far : {1e3f, -1e9f, 3e38f}) {
        const std::array<float, 3> focus = {far, 0.5f, 0.5f};
        const std::vector<float> light = room.render(device, technique, &focus);
        for (const float v : light) REQUIRE(std::isfinite(v));
        CHECK(meanOf(light) > 0.3 * meanOf(middle));
        CHECK(technique.count("pixels_outside") == 0);
    }
}

TEST_CASE("cascades refuse what they cannot do, and say what", "[lpv_cascades]") {
    TestDevice device(16);
    LWTechnique none = nullptr;
    const LWLpvDesc many = descOf(LW_LPV_TRANSPORT_PROPAGATE, 7), large = descOf(LW_LPV_TRANSPORT_SWEEP, 3, 4.0f, 128);
    CHECK(lwCreateLpv(device, &many, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("cascades") && Contains("1 .. 6") && Contains("7"));
    CHECK(lwCreateLpv(device, &large, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("size") && Contains("64") && Contains("128"));
    const LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_PROPAGATE);
    TestTechnique technique(device, "lpv", &desc);
    const std::array<float, 3> focus = {0.0f, std::numeric_limits<float>::quiet_NaN(), 0.0f};
    const LWFrame frame = frameOf({}, nullptr, &focus);
    CHECK(lwUpdate(technique, &frame) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("focus"));
}
