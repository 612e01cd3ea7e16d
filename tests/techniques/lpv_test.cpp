// Technique lpv through the C API: the plane that it is calibrated by, what must not change it, and what a host relies on.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "support/lit_room.h"
#include "support/lpv_specular_bytes.h"
#include "support/packed_light.h"
#include "support/scoped_api.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 45, kHeight = 16;
// Floats rounded in 15 steps, and light as whole numbers of 2^-30 of the brightest texel.
constexpr double kPlane = 2e-5;
// Positions of other units round to other bits.
constexpr double kRounding = 3e-6;

double evenProfile(double, double) { return 1.0; }
double spotProfile(double x, double z) { return x * x + (z - 0.4) * (z - 0.4) < 0.05 ? 3.0 : 0.0; }

LWLpvDesc descOf(std::uint32_t size, std::uint32_t steps, double extent = 0.0, Vec centre = {}) {
    LWLpvDesc desc;
    lwDefaultLpv(&desc);
    desc.geometryVolume = LW_GEOMETRY_VOLUME_OFF;
    desc.size = size;
    desc.steps = steps;
    desc.extent = float(extent);
    desc.center[0] = float(centre.x);
    desc.center[1] = float(centre.y);
    desc.center[2] = float(centre.z);
    return desc;
}

// Two triangles along the diagonal of the unit room, as the host's geometry: its box is the room's.
struct RoomBox {
    std::vector<float> vertices;
    LWGeometry geometry{};
    explicit RoomBox(double scale = 1.0) {
        const float h = float(0.5 * scale), one = float(scale);
        vertices = {-h, 0, 0, h, 0, 0, h, one, one};
        geometry.structSize = sizeof geometry;
        geometry.vertices = vertices.data();
        geometry.vertexCount = 3;
        geometry.triangleCount = 1;
    }
};

LWFrame frameOf(const std::vector<LWLight>& lights, const RoomBox* box = nullptr, const std::vector<LWVpl>& vpls = {}) {
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.lights = lights.data();
    frame.lightCount = std::uint32_t(lights.size());
    frame.vpls = vpls.data();
    frame.vplCount = std::uint32_t(vpls.size());
    if (box) frame.geometry = &box->geometry;
    return frame;
}

// Irradiance, and validity as its fourth plane.
std::vector<float> render(TestTechnique& technique, LWDevice device, const TestView& view, const LWGBuffer& gbuffer) {
    PlanarPixels irradiance(view.width(), view.height(), 3), validity(view.width(), view.height(), 1);
    LWOutput output{};
    output.structSize = sizeof output;
    output.irradiance = irradiance.image();
    output.validity = validity.image();
    const LWStatus status = lwRender(technique, view, &gbuffer, &output);
    INFO(lastError(device));
    REQUIRE(status == LW_SUCCESS);
    REQUIRE(lwFinish(device) == LW_SUCCESS);
    std::vector<float> result = irradiance.packed();
    const std::vector<float> valid = validity.packed();
    result.insert(result.end(), valid.begin(), valid.end());
    return result;
}

std::vector<float> render(LWDevice device, const LWLpvDesc& desc, const LWFrame& frame, const WallAndCeiling& scene) {
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    technique.update(frame);
    return render(technique, device, view, scene.gbuffer);
}

}  // namespace

TEST_CASE("a plane of exitance 1 lights what faces it by 1, in the mean over four cells", "[lpv]") {
    TestDevice device(GENERATE(1u, 16u));
    const double scale = GENERATE(1.0, 37.0);
    CAPTURE(scale);
    constexpr std::uint32_t kSize = 32;
    // The floor is the grid's bottom, and each cell gets 3 x 3 of its texels. 15 steps bring no light from
    // the border to the middle: there the floor is infinite.
    LitFloor floor(3 * kSize, evenProfile, scale);
    const double cell = scale / kSize;
    PlanarPixels position(16, 4, 3), normal(16, 4, 3);
    for (std::uint32_t j = 0; j < 4; ++j)
        for (std::uint32_t i = 0; i < 16; ++i) {
            // Read half a cell off, at the centres of cells 1 to 4 over the floor's middle.
            position.set(i, j, {-0.5 * cell, (j + 2.0) * cell, (15.5 + i % 2) * cell});
            normal.set(i, j, {0, -1, 0});
        }
    LWGBuffer gbuffer{};
    gbuffer.structSize = sizeof gbuffer;
    gbuffer.position = position.image();
    gbuffer.normal = normal.image();
    const LWLpvDesc desc = descOf(kSize, 15, scale, {0, 0.5 * scale, 0.5 * scale});
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, 16, 4);
    const std::vector<LWLight> lights = {floor.light};
    technique.update(frameOf(lights));
    const std::vector<float> light = render(technique, device, view, gbuffer);
    for (std::size_t c = 0; c < 4; ++c) {
        double sum = 0.0;
        for (std::size_t i = 0; i < 64; ++i) sum += double(light[64 * c + i]) / 64.0;
        CHECK(sum == Approx(1.0).epsilon(kPlane));
    }
    CHECK(technique.count("lights_outside") == 0);
    CHECK(technique.count("pixels_outside") == 0);
    CHECK(technique.count("steps") == 15);
}

TEST_CASE("same input, same bits: runs, widths, frames", "[lpv]") {
    LitFloor floor(64, spotProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const RoomBox box;
    const std::vector<LWLight> lights = {floor.light};
    const LWLpvDesc desc = descOf(16, 0);
    TestDevice wide(16), scalar(1);
    const auto first = render(wide, desc, frameOf(lights, &box), scene);
    CHECK(meanOf(first) > 0.0);
    for (int run = 0; run < 10; ++run) CHECK(render(wide, desc, frameOf(lights, &box), scene) == first);
    CHECK(render(scalar, desc, frameOf(lights, &box), scene) == first);
    TestTechnique technique(wide, "lpv", &desc);
    TestView view(wide, kWidth, kHeight);
    for (int frame = 0; frame < 3; ++frame) {
        technique.update(frameOf(lights, &box));
        CHECK(render(technique, wide, view, scene.gbuffer) == first);
    }
    CHECK(technique.count("steps") == 32);
}

TEST_CASE("the unit of length changes nothing but rounding", "[lpv]") {
    TestDevice device(16);
    const auto at = [&](double scale) {
        LitFloor floor(64, spotProfile, scale);
        WallAndCeiling scene(kWidth, kHeight, scale);
        const RoomBox box(scale);
        const std::vector<LWLight> lights = {floor.light};
        return render(device, descOf(32, 0), frameOf(lights, &box), scene);
    };
    const auto metres = at(1.0);
    for (const double scale : {10.0, 0.1, 1000.0}) {
        CAPTURE(scale);
        CHECK(difference(at(scale), metres) < kRounding);
    }
}

TEST_CASE("validity says where the grid is; background and what lies beyond get nothing", "[lpv]") {
    TestDevice device(GENERATE(1u, 16u));
    LitFloor floor(32, evenProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const std::vector<LWLight> lights = {floor.light};
    const double side = 0.7;
    const LWLpvDesc desc = descOf(16, 4, side, {0, 0.5, 0.3});
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    technique.update(frameOf(lights));
    const auto light = render(technique, device, view, scene.gbuffer);
    std::uint64_t beyond = 0;
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = 0; x < kWidth; ++x) {
            const Vec n = scene.normal.get(x, y), p = scene.position.get(x, y) + n * (0.5 * side / 16);
            const bool surface = n.x != 0 || n.y != 0 || n.z != 0;
            const bool inside = surface && std::abs(p.x) <= 0.35 && std::abs(p.y - 0.5) <= 0.35 && std::abs(p.z - 0.3) <= 0.35;
            beyond += surface && !inside ? 1 : 0;
            const std::size_t i = y * kWidth + x;
            CAPTURE(x, y);
            CHECK(light[3 * kWidth * kHeight + i] == (inside ? 1.0f : 0.0f));
            if (!inside) CHECK(light[i] == 0.0f);
        }
    CHECK(technique.count("pixels_outside") == beyond);
    CHECK(technique.count("lights_outside") > 0);
}

TEST_CASE("RSMs and authored VPLs add up, and lamps that go out leave nothing", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(32, evenProfile), spot(48, spotProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const LWLpvDesc desc = descOf(32, 32, 1.2, {0, 0.5, 0.5});
    std::vector<LWVpl> vpls(1);
    vpls[0].position[1] = 0.3f;
    vpls[0].position[2] = 0.7f;
    vpls[0].normal[2] = -1.0f;
    vpls[0].flux[1] = 0.2f;
    const std::vector<LWLight> both = {floor.light, spot.light}, one = {floor.light}, other = {spot.light};
    const auto sum = render(device, desc, frameOf(both, nullptr, vpls), scene);
    const auto a = render(device, desc, frameOf(one), scene), b = render(device, desc, frameOf(other), scene),
               c = render(device, desc, frameOf({}, nullptr, vpls), scene);
    std::vector<float> added;
    for (std::size_t i = 0; i < 3 * kWidth * kHeight; ++i) added.push_back(a[i] + b[i] + c[i]);
    const std::vector<float> light(sum.begin(), sum.begin() + 3 * kWidth * kHeight);
    // Sums are clamped at 0 once, their terms each.
    CHECK(difference(light, added) < 0.01);
    CHECK(std::abs(meanOf(light) / meanOf(added) - 1.0) < 0.01);

    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    technique.update(frameOf(both, nullptr, vpls));
    CHECK(render(technique, device, view, scene.gbuffer) == sum);
    technique.update(frameOf({}));
    const auto dark = render(technique, device, view, scene.gbuffer);
    for (std::size_t i = 0; i < 3 * kWidth * kHeight; ++i) CHECK(dark[i] == 0.0f);
}

TEST_CASE("a fitted grid stays where it is until it no longer fits, or reset", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(64, spotProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const std::vector<LWLight> lights = {floor.light};
    const LWLpvDesc desc = descOf(16, 0);
    RoomBox box, smaller;
    smaller.vertices[7] = 0.9f;  // the room's height
    smaller.geometry.version = 1;
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    technique.update(frameOf(lights, &box));
    const auto first = render(technique, device, view, scene.gbuffer);
    technique.update(frameOf(lights, &smaller));
    CHECK(render(technique, device, view, scene.gbuffer) == first);
    LWFrame frame = frameOf(lights, &smaller);
    frame.reset = 1;
    technique.update(frame);
    const auto fresh = render(technique, device, view, scene.gbuffer);
    CHECK(fresh != first);
    CHECK(fresh == render(device, desc, frameOf(lights, &smaller), scene));
}

TEST_CASE("nothing is compiled after lwPrewarm, memory is as estimated", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(32, evenProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const RoomBox box;
    const LWLpvDesc desc = descOf(16, GENERATE(0u, 1u));
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    std::vector<LWVpl> vpls(70);
    for (LWVpl& vpl : vpls) vpl.normal[0] = vpl.flux[0] = 1.0f;
    const std::vector<LWLight> lights = {floor.light, floor.light};
    technique.update(frameOf(lights, &box, vpls));
    render(technique, device, view, scene.gbuffer);
    technique.update(frameOf({}, nullptr, vpls));
    render(technique, device, view, scene.gbuffer);
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
    LWViewDesc size{};
    size.structSize = sizeof size;
    size.maxWidth = kWidth;
    size.maxHeight = kHeight;
    std::uint64_t estimate = 0;
    const LWFrame frame = frameOf(lights, &box, vpls);
    REQUIRE(lwEstimateFrameMemory(device, "lpv", &desc, &size, &frame, &estimate) == LW_SUCCESS);
    // The estimate is of images that have to be unpacked; these are used in place, or copied as they are.
    const std::uint64_t unpacked = (3 + 3 + 3 + 1) * sizeof(float) * 48 * kHeight, held = technique.stats().deviceBytes;
    if (device.info().hostUnifiedMemory)
        CHECK(held + unpacked + specularCellBytes(16) + specularViewBytes(0) + specularUnpackedBytes(48 * kHeight) == estimate);
    else
        CHECK(held <= estimate);
}

TEST_CASE("lpv refuses what it cannot do, and says what", "[lpv]") {
    TestDevice device(16);
    LWLpvDesc desc = descOf(20, 0);
    LWTechnique none = nullptr;
    CHECK(lwCreateLpv(device, &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("size") && Contains("20"));
    desc = descOf(16, 5000);
    CHECK(lwCreateLpv(device, &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("steps") && Contains("5000"));
    WallAndCeiling scene(kWidth, kHeight);
    desc = descOf(16, 2);
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    technique.update(frameOf({}));
    PlanarPixels pixels(kWidth, kHeight, 1);
    LWOutput output{};
    output.structSize = sizeof output;
    output.ambientOcclusion = pixels.image();
    CHECK(lwRender(technique, view, &scene.gbuffer, &output) == LW_ERROR_UNSUPPORTED);
    CHECK_THAT(lastError(device), Contains("output.ambientOcclusion") && Contains("lpv"));
}
