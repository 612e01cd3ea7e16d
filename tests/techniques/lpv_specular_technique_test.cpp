// Technique lpv's output specularRadiance through the C API.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/lpv_room.h"
#include "support/lpv_specular_bytes.h"
#include "support/packed_light.h"
#include "support/scoped_api.h"
#include "support/view_scene.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 45, kHeight = 30;
constexpr double kPi = 3.14159265358979323846;
// A side of the floor's: 13 or 14 to a cell, whose light differs by 7 % of the mean at most.
constexpr std::uint32_t kTexels = 384;

double evenProfile(double, double) { return 1.0; }

LWLpvDesc descOf(LWLpvTransport transport, LWResolution resolution = LW_RESOLUTION_FULL) {
    LWLpvDesc desc;
    lwDefaultLpv(&desc);
    desc.transport = transport;
    desc.size = 32;
    desc.resolution = resolution;
    return desc;
}

LWFrame frameOf(const std::vector<LWLight>& lights, const LWGeometry* geometry, float environment = 0.0f) {
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.lights = lights.data();
    frame.lightCount = std::uint32_t(lights.size());
    frame.geometry = geometry;
    frame.environment[0] = frame.environment[1] = frame.environment[2] = environment;
    return frame;
}

// The lit room's wall and ceiling, seen from inside it.
struct Mirrors : WallAndCeiling {
    glm::dvec3 eye{0.0, 0.6, 0.5};
    PlanarPixels roughness{kWidth, kHeight, 1};
    explicit Mirrors(double scale = 1.0, float rough = 0.0f) : WallAndCeiling(kWidth, kHeight, scale) {
        eye *= scale;
        gbuffer.camera = lookAt(eye, eye + glm::dvec3(0.0, 0.2, -0.3), 0.7).matrices();
        for (std::uint32_t y = 0; y < kHeight; ++y)
            for (std::uint32_t x = 0; x < kWidth; ++x) roughness.at(x, y, 0) = rough;
        gbuffer.roughness = roughness.image();
    }
    // Where a mirrored ray meets the floor's plane, or far off.
    Vec floorOf(std::uint32_t x, std::uint32_t y) const {
        const Vec p = position.get(x, y), n = normal.get(x, y), v = lightwell::reference::unit(Vec{eye.x, eye.y, eye.z} - p);
        const Vec r = n * (2.0 * lightwell::reference::dot(v, n)) - v;
        return r.y < 0.0 ? p + r * (-p.y / r.y) : Vec{1e9, 0, 1e9};
    }
};

struct Asked {
    bool specular = true, irradiance = false;
};

struct Picture {
    std::vector<float> specular, irradiance;
};

Picture render(TestTechnique& technique, LWDevice device, const TestView& view, const LWGBuffer& gbuffer, Asked asked = {}) {
    PlanarPixels specular(view.width(), view.height(), 3), irradiance(view.width(), view.height(), 3);
    LWOutput output{};
    output.structSize = sizeof output;
    if (asked.specular) output.specularRadiance = specular.image();
    if (asked.irradiance) output.irradiance = irradiance.image();
    const LWStatus status = lwRender(technique, view, &gbuffer, &output);
    INFO(lastError(device));
    REQUIRE(status == LW_SUCCESS);
    REQUIRE(lwFinish(device) == LW_SUCCESS);
    return {specular.packed(), irradiance.packed()};
}

std::vector<float> renderOnce(LWDevice device, const LWLpvDesc& desc, const LWFrame& frame, const LWGBuffer& gbuffer) {
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    technique.update(frame);
    return render(technique, device, view, gbuffer).specular;
}

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
    const auto transport = GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP);
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
    const auto transport = GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP);
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

TEST_CASE("specular radiance: nothing is compiled after lwPrewarm, memory is as estimated", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(32, evenProfile);
    const Mirrors scene;
    const RoomTriangles room(1.0);
    const auto transport = GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP);
    const auto resolution = GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_HALF);
    const LWLpvDesc desc = descOf(transport, resolution);
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    const std::vector<LWLight> lights = {floor.light};
    const LWFrame frame = frameOf(lights, &room.geometry);
    technique.update(frame);
    render(technique, device, view, scene.gbuffer);
    render(technique, device, view, scene.gbuffer, {true, true});
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
    LWViewDesc size{};
    size.structSize = sizeof size;
    size.maxWidth = kWidth;
    size.maxHeight = kHeight;
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateFrameMemory(device, "lpv", &desc, &size, &frame, &estimate) == LW_SUCCESS);
    // The estimate is of images that have to be unpacked; these are used in place, or copied as they are.
    const std::uint64_t unpacked = (3 + 3 + 3 + 1) * sizeof(float) * 48 * kHeight + specularUnpackedBytes(48 * kHeight);
    const std::uint64_t held = technique.stats().deviceBytes;
    if (device.info().hostUnifiedMemory && transport == LW_LPV_TRANSPORT_PROPAGATE)
        CHECK(held + unpacked == estimate);
    else
        CHECK(held <= estimate);
}

TEST_CASE("specular radiance: who cannot make it says so, as does one without a camera", "[lpv]") {
    TestDevice device(16);
    Mirrors scene;
    PlanarPixels pixels(kWidth, kHeight, 3);
    LWOutput output{};
    output.structSize = sizeof output;
    output.specularRadiance = pixels.image();
    TestView view(device, kWidth, kHeight);
    LWRsmDesc rsm;
    lwDefaultRsm(&rsm);
    TestTechnique other(device, rsm);
    other.update(frameOf({}, nullptr));
    CHECK(lwRender(other, view, &scene.gbuffer, &output) == LW_ERROR_UNSUPPORTED);
    CHECK_THAT(lastError(device), Contains("output.specularRadiance") && Contains("rsm"));
    const LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_PROPAGATE);
    TestTechnique technique(device, "lpv", &desc);
    technique.update(frameOf({}, nullptr));
    scene.gbuffer.camera = LWCamera{};
    CHECK(lwRender(technique, view, &scene.gbuffer, &output) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("gbuffer.camera"));
}
