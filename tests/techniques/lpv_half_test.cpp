// Technique lpv with resolution=half through the C API.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/lpv_room.h"
#include "support/lpv_specular_bytes.h"
#include "support/packed_light.h"
#include "support/scoped_api.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 45, kHeight = 16;
// As at full resolution: floats rounded in 15 steps, light as whole numbers of 2^-30 of the brightest texel.
constexpr double kPlane = 2e-5;
// A mean of nine equal floats, divided by the sum of its weights.
constexpr double kMean = 2e-6;

double evenProfile(double, double) { return 1.0; }

LWLpvDesc descOf(LWLpvTransport transport, std::uint32_t size, LWResolution resolution = LW_RESOLUTION_HALF) {
    LWLpvDesc desc;
    lwDefaultLpv(&desc);
    desc.geometryVolume = LW_GEOMETRY_VOLUME_OFF;
    desc.transport = transport;
    desc.size = size;
    desc.resolution = resolution;
    return desc;
}

LWFrame frameOf(const std::vector<LWLight>& lights, const LWGeometry* geometry = nullptr) {
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.lights = lights.data();
    frame.lightCount = std::uint32_t(lights.size());
    frame.geometry = geometry;
    return frame;
}

struct Picture {
    std::vector<float> irradiance, validity;
};

Picture render(TestTechnique& technique, LWDevice device, const TestView& view, const LWGBuffer& gbuffer, bool light = true,
               bool valid = true) {
    PlanarPixels irradiance(view.width(), view.height(), 3), validity(view.width(), view.height(), 1);
    LWOutput output{};
    output.structSize = sizeof output;
    if (light) output.irradiance = irradiance.image();
    if (valid) output.validity = validity.image();
    const LWStatus status = lwRender(technique, view, &gbuffer, &output);
    INFO(lastError(device));
    REQUIRE(status == LW_SUCCESS);
    REQUIRE(lwFinish(device) == LW_SUCCESS);
    return {irradiance.packed(), validity.packed()};
}

LWGBuffer gbufferOf(const PlanarPixels& position, const PlanarPixels& normal) {
    LWGBuffer gbuffer{};
    gbuffer.structSize = sizeof gbuffer;
    gbuffer.position = position.image();
    gbuffer.normal = normal.image();
    return gbuffer;
}

}  // namespace

TEST_CASE("at half resolution the plane of exitance 1 lights by 1, and either side of an edge is even", "[lpv]") {
    TestDevice device(GENERATE(1u, 16u));
    constexpr std::uint32_t kSize = 32, kColumns = 37, kRows = 5, kEdge = 17;
    // The floor is the grid's bottom; 15 steps bring no light from the border to the middle.
    LitFloor floor(3 * kSize, evenProfile);
    LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_PROPAGATE, kSize);
    desc.steps = 15;
    desc.extent = 1.0f;
    desc.center[1] = desc.center[2] = 0.5f;
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kColumns, kRows);
    const std::vector<LWLight> lights = {floor.light};
    technique.update(frameOf(lights));
    double sum = 0.0;
    // Surfaces that face the floor half a cell above the centres of two of the four cells, with an edge between them that the blocks
    // of two columns do not keep to.
    for (const int lower : {1, 2}) {
        const int upper = 5 - lower;
        PlanarPixels position(kColumns, kRows, 3), normal(kColumns, kRows, 3);
        for (std::uint32_t y = 0; y < kRows; ++y)
            for (std::uint32_t x = 0; x < kColumns; ++x) {
                position.set(x, y, {-0.5 / kSize, ((x < kEdge ? lower : upper) + 1.0) / kSize, (15.5 + x % 2) / kSize});
                normal.set(x, y, {0, -1, 0});
            }
        const std::vector<float> light = render(technique, device, view, gbufferOf(position, normal)).irradiance;
        for (std::uint32_t i = 0; i < light.size(); ++i) {
            CAPTURE(i % kColumns, i / kColumns);
            CHECK(double(light[i]) == Approx(double(light[i % kColumns < kEdge ? 0 : kColumns - 1])).epsilon(kMean));
        }
        CHECK(light[0] != Approx(light[kColumns - 1]).epsilon(0.01));
        sum += double(light[0]) + double(light[kColumns - 1]);
        CHECK(technique.count("upsample_fallbacks") == 0);
    }
    CHECK(sum / 4.0 == Approx(1.0).epsilon(kPlane));
}

TEST_CASE("a sweep read at half resolution lights the ceiling as a polygon does", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(96, evenProfile);
    WallAndCeiling scene(kWidth, 3 * kHeight);
    const std::vector<LWLight> lights = {floor.light};
    const RoomTriangles room(1.0);
    const LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_SWEEP, 32);
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, 3 * kHeight);
    technique.update(frameOf(lights, &room.geometry));
    const std::vector<float> light = render(technique, device, view, scene.gbuffer).irradiance;
    CHECK(ceilingError(light, scene, kWidth, 3 * kHeight) < 0.05);
}

TEST_CASE("half resolution: any size of picture, the same bits at both widths, validity of every pixel", "[lpv]") {
    const auto transport = GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP);
    TestDevice wide(16), scalar(1);
    LitFloor floor(32, evenProfile);
    const RoomTriangles room(1.0);
    const std::vector<LWLight> lights = {floor.light};
    const LWLpvDesc half = descOf(transport, 16), full = descOf(transport, 16, LW_RESOLUTION_FULL);
    TestTechnique halved(wide, "lpv", &half), whole(wide, "lpv", &full), narrow(scalar, "lpv", &half);
    for (TestTechnique* technique : {&halved, &whole, &narrow}) technique->update(frameOf(lights, &room.geometry));
    TestView view(wide, 67, 9), other(scalar, 67, 9);
    for (const auto& [w, h] : {std::pair{1u, 1u}, {2u, 1u}, {1u, 3u}, {3u, 5u}, {33u, 2u}, {67u, 9u}}) {
        CAPTURE(w, h);
        // A ceiling that goes on past the grid.
        PlanarPixels position(w, h, 3), normal(w, h, 3);
        for (std::uint32_t y = 0; y < h; ++y)
            for (std::uint32_t x = 0; x < w; ++x) {
                position.set(x, y, {0.02 * x - 0.3, 0.9, 0.5 + 0.02 * y});
                normal.set(x, y, {0, -1, 0});
            }
        view.resize(w, h);
        other.resize(w, h);
        const LWGBuffer gbuffer = gbufferOf(position, normal);
        const Picture a = render(halved, wide, view, gbuffer), b = render(whole, wide, view, gbuffer),
                      c = render(narrow, scalar, other, gbuffer);
        CHECK(a.validity == b.validity);
        CHECK(a.irradiance == c.irradiance);
        CHECK(a.validity == c.validity);
        CHECK(meanOf(b.irradiance) > 0.0);
        // Across the grid's border, where light ends at once, up-sampling reaches three columns.
        std::vector<float> found, expected;
        for (std::size_t i = 0; i < a.irradiance.size(); ++i) {
            const std::size_t x = i % w, row = i % (w * h) - x;
            if (b.validity[row + (x > 2 ? x - 3 : 0)] != b.validity[row + std::min<std::size_t>(x + 3, w - 1)]) continue;
            found.push_back(a.irradiance[i]);
            expected.push_back(b.irradiance[i]);
        }
        CHECK(found.size() + 18 * h >= a.irradiance.size());
        CHECK(difference(found, expected) < (w * h == 1 ? kMean : 0.05));
    }
}

TEST_CASE("half resolution: outputs alone are those of both, and counts say what was looked at", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(32, evenProfile);
    WallAndCeiling scene(kWidth, kHeight);
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    for (const std::uint32_t x : {5u, 6u, 40u}) scene.position.at(x, 9, 1) = kNan;
    LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_PROPAGATE, 16);
    desc.extent = 0.7f;
    desc.center[1] = 0.5f;
    desc.center[2] = 0.3f;
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    const std::vector<LWLight> lights = {floor.light};
    technique.update(frameOf(lights));
    const Picture both = render(technique, device, view, scene.gbuffer);
    CHECK(technique.count("rejected_pixels") == 3);
    const std::uint64_t beyond = technique.count("pixels_outside");
    const Picture light = render(technique, device, view, scene.gbuffer, true, false);
    CHECK(technique.count("rejected_pixels") == 3);
    CHECK(technique.count("pixels_outside") == beyond);
    CHECK(light.irradiance == both.irradiance);
    const Picture valid = render(technique, device, view, scene.gbuffer, false, true);
    CHECK(technique.count("rejected_pixels") == 3);
    CHECK(valid.validity == both.validity);
    std::uint64_t bad = 0;
    for (const float v : valid.validity) bad += v == 0.0f;
    // Beside the first column and what is rejected, validity is 0 outside.
    CHECK(technique.count("pixels_outside") == bad - kHeight - 3);
    CHECK(beyond > 0);
    CHECK(4 * beyond < 2 * technique.count("pixels_outside"));
    CHECK(4 * beyond > technique.count("pixels_outside") / 2);
}

TEST_CASE("half resolution: nothing is compiled after lwPrewarm, memory is as estimated", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(32, evenProfile);
    WallAndCeiling scene(kWidth, kHeight - 1);
    const RoomTriangles room(1.0);
    const auto transport = GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP);
    const auto resolution = GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_HALF);
    const LWLpvDesc desc = descOf(transport, 16, resolution);
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight - 1);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    const std::vector<LWLight> lights = {floor.light};
    technique.update(frameOf(lights, &room.geometry));
    for (const auto& [light, valid] : {std::pair{true, true}, {true, false}, {false, true}})
        render(technique, device, view, scene.gbuffer, light, valid);
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
    LWViewDesc size{};
    size.structSize = sizeof size;
    size.maxWidth = kWidth;
    size.maxHeight = kHeight - 1;
    std::uint64_t estimate = 0;
    const LWFrame frame = frameOf(lights, &room.geometry);
    REQUIRE(lwEstimateFrameMemory(device, "lpv", &desc, &size, &frame, &estimate) == LW_SUCCESS);
    // The estimate is of images that have to be unpacked; these are used in place, or copied as they are.
    const std::uint64_t unpacked = (3 + 3 + 3 + 1) * sizeof(float) * 48 * (kHeight - 1), held = technique.stats().deviceBytes;
    if (device.info().hostUnifiedMemory && transport == LW_LPV_TRANSPORT_PROPAGATE)
        CHECK(held + unpacked + specularCellBytes(16) + specularUnpackedBytes(48 * (kHeight - 1)) +
                  specularViewBytes(resolution == LW_RESOLUTION_HALF ? 32 * 8 : 0) ==
              estimate);
    else
        CHECK(held <= estimate);
}

TEST_CASE("half resolution: the light that was read is shown, at its size, when there is some", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(32, evenProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const std::vector<LWLight> lights = {floor.light};
    const LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_PROPAGATE, 16);
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    technique.update(frameOf(lights));
    std::vector<float> pixels(3 * 23 * 8);
    const auto read = [&] { return lwReadDebugView(technique, view, "gathered", pixels.data(), pixels.size()); };
    render(technique, device, view, scene.gbuffer);
    REQUIRE(read() == LW_SUCCESS);
    CHECK(meanOf(pixels) > 0.0);
    render(technique, device, view, scene.gbuffer, false, true);
    CHECK(read() != LW_SUCCESS);
}
