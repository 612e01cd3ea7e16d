// Technique lpv's output specularRadiance through the C API: what mirrors and glossy surfaces show.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/lpv_mirrors.h"
#include "support/packed_light.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr double kPi = 3.14159265358979323846;
// A side of the floor's: 13 or 14 to a cell, whose light differs by 7 % of the mean at most.
constexpr std::uint32_t kTexels = 384;

// Of pixels that are mirrors of the floor, two cells from its border: of exitance 1, radiance 1 / pi.
void checkFloor(const std::vector<float>& light, const Mirrors& scene, double tolerance) {
    int count = 0;
    double sum = 0.0;
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = 1; x < kWidth; ++x) {
            const Vec floor = scene.floorOf(x, y);
            if (std::abs(floor.x) > 0.42 || floor.z < 0.08 || floor.z > 0.92 || scene.position.get(x, y).y > 1.0) continue;
            CAPTURE(x, y, floor.x, floor.z);
            ++count;
            sum += double(light[y * kWidth + x]);
            CHECK(double(light[y * kWidth + x]) == Approx(1.0 / kPi).epsilon(tolerance));
        }
    CHECK(count > 100);
    CHECK(sum / count == Approx(1.0 / kPi).epsilon(0.04));
}

}  // namespace

TEST_CASE("mirrors of a lit floor read its radiance, and background nothing", "[lpv]") {
    const auto transport = GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP, LW_LPV_TRANSPORT_COARSE_TO_FINE);
    const std::uint32_t width = GENERATE(1u, 16u);
    CAPTURE(int(transport), width);
    TestDevice device(width);
    LitFloor floor(kTexels, evenProfile);
    const Mirrors scene;
    const RoomTriangles room(1.0);
    const std::vector<LWLight> lights = {floor.light};
    TestTechnique technique(device, "lpv", [&] {
        static LWLpvDesc desc;
        desc = descOf(transport);
        return &desc;
    }());
    TestView view(device, kWidth, kHeight);
    technique.update(frameOf(lights, &room.geometry));
    const Picture alone = render(technique, device, view, scene.gbuffer);
    checkFloor(alone.specular, scene, 0.16);
    for (std::uint32_t y = 0; y < kHeight; ++y) CHECK(alone.specular[y * kWidth] == 0.0f);
    CHECK(technique.count("specular_pixels") + technique.count("pixels_outside") == (kWidth - 1) * kHeight);
    const Picture both = render(technique, device, view, scene.gbuffer, {true, true});
    CHECK(both.specular == alone.specular);
    CHECK(both.irradiance == render(technique, device, view, scene.gbuffer, {false, true}).irradiance);
    // Lights that go out leave nothing.
    technique.update(frameOf({}, &room.geometry));
    for (const float value : render(technique, device, view, scene.gbuffer).specular) CHECK(value == 0.0f);
}

TEST_CASE("specular radiance: same bits at both widths, any unit of length, half resolution", "[lpv]") {
    const auto transport = GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP);
    TestDevice wide(16), scalar(1);
    LitFloor floor(96, evenProfile);
    const Mirrors scene(1.0, 0.3f);
    const RoomTriangles room(1.0);
    const std::vector<LWLight> lights = {floor.light};
    const LWFrame frame = frameOf(lights, &room.geometry);
    const auto first = renderOnce(wide, descOf(transport), frame, scene.gbuffer);
    CHECK(meanOf(first) > 0.03);
    CHECK(renderOnce(scalar, descOf(transport), frame, scene.gbuffer) == first);
    for (const double scale : {37.0, 0.01}) {
        CAPTURE(scale);
        LitFloor other(96, evenProfile, scale);
        const Mirrors scaled(scale, 0.3f);
        const RoomTriangles otherRoom(1.0, scale);
        const std::vector<LWLight> otherLights = {other.light};
        // Texels and surfels that rounding puts into the next cell, and rays that it sends there.
        CHECK(difference(renderOnce(wide, descOf(transport), frameOf(otherLights, &otherRoom.geometry), scaled.gbuffer), first) < 0.03);
    }
    const auto half = renderOnce(wide, descOf(transport, LW_RESOLUTION_HALF), frame, scene.gbuffer);
    // Two pixels are a tenth of the room: the mirrored floor's border is as wide as that.
    CHECK(difference(half, first) < 0.5);
    CHECK(meanOf(half) == Approx(meanOf(first)).epsilon(0.05));
}

TEST_CASE("specular radiance: without roughness it is that of 0.5; what is not a number is 1", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(96, evenProfile);
    const RoomTriangles room(1.0);
    const std::vector<LWLight> lights = {floor.light};
    const LWFrame frame = frameOf(lights, &room.geometry);
    const LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_SWEEP, GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_HALF));
    Mirrors none(1.0, 0.2f);
    none.gbuffer.roughness = LWImage{};
    CHECK(renderOnce(device, desc, frame, none.gbuffer) == renderOnce(device, desc, frame, Mirrors(1.0, 0.5f).gbuffer));
    CHECK(renderOnce(device, desc, frame, Mirrors(1.0, std::numeric_limits<float>::quiet_NaN()).gbuffer) ==
          renderOnce(device, desc, frame, Mirrors(1.0, 1.0f).gbuffer));
}

TEST_CASE("rays that leave the grid bring the environment's radiance", "[lpv]") {
    const auto transport = GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP, LW_LPV_TRANSPORT_COARSE_TO_FINE);
    TestDevice device(16);
    LitFloor floor(96, [](double, double) { return 0.0; });
    const Mirrors scene;
    const RoomTriangles room(1.0);
    const std::vector<LWLight> lights = {floor.light};
    const auto light = renderOnce(device, descOf(transport), frameOf(lights, &room.geometry, 2.0f), scene.gbuffer);
    int open = 0, closed = 0;
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = 1; x < kWidth; ++x) {
            // The room has no sides but the back wall: rays that miss the floor by far leave, those that meet it are stopped.
            const Vec p = scene.floorOf(x, y);
            if (scene.position.get(x, y).y > 1.0) continue;
            const bool meets = std::abs(p.x) < 0.42 && p.z > 0.08 && p.z < 0.92;
            const bool misses = scene.normal.get(x, y).y < 0.0 && p.z > 0.1 && (std::abs(p.x) > 0.62 || p.z > 1.12);
            CAPTURE(int(transport), x, y, p.x, p.z);
            if (meets) CHECK(light[y * kWidth + x] < 0.02f);
            if (misses) CHECK(double(light[y * kWidth + x]) == Approx(2.0).epsilon(0.02));
            closed += meets ? 1 : 0;
            open += misses ? 1 : 0;
        }
    CHECK(closed > 100);
    CHECK(open > 100);
}
