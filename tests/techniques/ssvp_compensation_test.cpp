// Technique ssvp with compensation of bounding, through the C API: a wall beside a lit floor, both in view.
#include <catch2/catch.hpp>
#include <cmath>

#include "support/choices.h"
#include "support/lit_room.h"
#include "support/scoped_api.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 96, kHeight = 136;
constexpr double kPi = 3.14159265358979323846, kExitance = 0.8;

double evenly(double, double) { return kExitance; }

// Orthographic, from above at 45 degrees: the wall z = 0 in the upper half, LitFloor's floor in the lower; lengths times
// `scale`. The first column is background.
struct Corner {
    PlanarPixels position{kWidth, kHeight, 3}, normal{kWidth, kHeight, 3}, radiance{kWidth, kHeight, 3};
    LWGBuffer gbuffer{};
    explicit Corner(double scale = 1.0) {
        for (std::uint32_t y = 0; y < kHeight; ++y)
            for (std::uint32_t x = 1; x < kWidth; ++x) {
                const double u = ((x + 0.5) / kWidth - 0.5) * scale, v = (y + 0.5) / kHeight, l = kExitance / kPi;
                const bool wall = v < 0.5;
                position.set(x, y, wall ? Vec{u, (1.0 - 2.0 * v) * scale, 0.0} : Vec{u, 0.0, (2.0 * v - 1.0) * scale});
                normal.set(x, y, wall ? Vec{0, 0, 1} : Vec{0, 1, 0});
                radiance.set(x, y, wall ? Vec{} : Vec{l, l, l});
            }
        gbuffer.structSize = sizeof gbuffer;
        gbuffer.position = position.image();
        gbuffer.normal = normal.image();
        gbuffer.directRadiance = radiance.image();
        const double s = std::sqrt(0.5), view[16] = {1, 0, 0, 0, 0, s, -s, 0, 0, s, s, -2 * scale, 0, 0, 0, 1};
        const double projection[16] = {2 / scale, 0, 0, 0, 0, 2 * s / scale, 0, 0, 0, 0, -0.25 / scale, 0, 0, 0, 0, 1};
        for (int i = 0; i < 16; ++i) {
            gbuffer.camera.view[i] = float(view[i]);
            gbuffer.camera.projection[i] = float(projection[i]);
        }
    }
    Corner(const Corner&) = delete;
};

LWSsvpDesc descOf(std::uint32_t compensation) {
    LWSsvpDesc desc;
    lwDefaultSsvp(&desc);
    desc.vpls = 64;
    desc.bounces = 1;
    desc.visibility = LW_VISIBILITY_NONE;
    desc.compensation = compensation;
    return desc;
}

std::vector<float> render(LWDevice device, const LWSsvpDesc& desc, const LitFloor& floor, const Corner& corner) {
    TestTechnique technique(device, desc);
    TestView view(device, kWidth, kHeight);
    technique.update({floor.light});
    return technique.render(view, corner.gbuffer);
}

// Relative error of the wall's rows up to 0.2 above the floor, the middle half of each: root mean square.
double errorBesideEdge(const std::vector<float>& light, const Corner& corner) {
    double squares = 0.0, count = 0.0;
    for (std::uint32_t y = 0; y < kHeight / 2; ++y) {
        const Vec p = corner.position.get(kWidth / 2, y);
        if (p.y > 0.2) continue;
        for (std::uint32_t x = kWidth / 4; x < 3 * kWidth / 4; ++x) {
            const Vec at = corner.position.get(x, y);
            const std::vector<Vec> floor{{-0.5, 0, 0}, {0.5, 0, 0}, {0.5, 0, 1}, {-0.5, 0, 1}};
            const double truth = polygonIrradiance(floor, at, {0, 0, 1}, kExitance);
            const double off = double(light[y * kWidth + x]) / truth - 1.0;
            squares += off * off;
            count += 1.0;
        }
    }
    return std::sqrt(squares / count);
}

}  // namespace

TEST_CASE("the light beside a lit floor's edge is nearer to the truth with compensation", "[ssvp][compensation]") {
    TestDevice device(GENERATE(1u, 16u));
    const LitFloor floor(64, evenly);
    const Corner corner;
    LWSsvpDesc plain = descOf(0), compensated = descOf(32);
    const bool half = GENERATE(false, true);
    plain.resolution = compensated.resolution = half ? LW_RESOLUTION_HALF : LW_RESOLUTION_FULL;
    plain.sampling = compensated.sampling = GENERATE(LW_SAMPLING_FLUX, LW_SAMPLING_UNIFORM);
    // A VPL's radius is five pixels; at half resolution two and a half, and the row beside the edge counts twice: there which cluster a pixel
    // gets counts for more than the bounds, in a single set of VPLs.
    const std::uint32_t sets = half ? 8 : 1;
    double before = 0.0, after = 0.0;
    std::vector<float> without, with;
    for (std::uint32_t seed = 0; seed < sets; ++seed) {
        plain.seed = compensated.seed = seed;
        without = render(device, plain, floor, corner);
        with = render(device, compensated, floor, corner);
        before += errorBesideEdge(without, corner) / sets;
        after += errorBesideEdge(with, corner) / sets;
    }
    CAPTURE(half, before, after);
    CHECK(after < (half ? 0.8 : 0.6) * before);
    // It takes nothing away, and floor does not light floor.
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = 0; x < kWidth; ++x) {
            REQUIRE(with[y * kWidth + x] >= without[y * kWidth + x] * 0.99999f);
            if (y > kHeight / 2 + 4) REQUIRE(with[y * kWidth + x] == without[y * kWidth + x]);
        }
}

TEST_CASE("compensation: same bits, any unit, shown, counted, prewarmed and estimated", "[ssvp][compensation]") {
    TestDevice device(16);
    const LitFloor floor(64, evenly), large(64, evenly, 4.0);
    const Corner corner, largeCorner(4.0);
    LWSsvpDesc desc = descOf(8);
    desc.resolution = GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_HALF, LW_RESOLUTION_QUARTER);
    TestTechnique technique(device, desc);
    TestView view(device, kWidth, kHeight);
    const LWStatus warmed = lwPrewarm(technique, view);
    CAPTURE(lastError(device));
    REQUIRE(warmed == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    technique.update({floor.light});
    const auto first = technique.render(view, corner.gbuffer);
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
    for (int run = 0; run < 10; ++run) REQUIRE(technique.render(view, corner.gbuffer) == first);
    CHECK(render(device, desc, large, largeCorner) == first);

    const std::size_t shrink = std::size_t(1) << (2 * desc.resolution);
    std::vector<float> shown(std::size_t(kWidth) * kHeight * 3 / shrink);
    REQUIRE(lwReadDebugView(technique, view, "compensation", shown.data(), shown.size()) == LW_SUCCESS);
    double sum = 0.0;
    for (const float v : shown) {
        REQUIRE(v >= 0.0f);
        sum += double(v);
    }
    CHECK(sum > 0.0);
    // A VPL's disc is 0.07 wide in radius, the samples reach a quarter of 1.41.
    CHECK(technique.count("compensation_capped") == 0);

    TestTechnique fresh(device, desc);
    fresh.update({floor.light});
    fresh.render(view, corner.gbuffer);
    LWViewDesc viewDesc{};
    viewDesc.structSize = sizeof viewDesc;
    viewDesc.maxWidth = kWidth;
    viewDesc.maxHeight = kHeight;
    std::uint64_t estimate = 0, without = 0;
    REQUIRE(lwEstimateMemory(device, "ssvp", &desc, &viewDesc, 64 * 64, &estimate) == LW_SUCCESS);
    CHECK(fresh.stats().deviceBytes <= estimate);
    const LWSsvpDesc plain = descOf(0);
    REQUIRE(lwEstimateMemory(device, "ssvp", &plain, &viewDesc, 64 * 64, &without) == LW_SUCCESS);
    CHECK(without < estimate);
}

TEST_CASE("compensation names what it lacks", "[ssvp][compensation]") {
    TestDevice device(16);
    const LitFloor floor(64, evenly);
    const Corner corner;
    TestTechnique technique(device, descOf(4));
    TestView view(device, kWidth, kHeight);
    technique.update({floor.light});
    PlanarPixels irradiance(kWidth, kHeight, 3);
    LWOutput output{};
    output.structSize = sizeof output;
    output.irradiance = irradiance.image();
    LWGBuffer bare = corner.gbuffer;
    bare.directRadiance = LWImage{};
    CHECK(lwRender(technique, view, &bare, &output) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("gbuffer.directRadiance") != std::string::npos);
    bare = corner.gbuffer;
    bare.camera = LWCamera{};
    CHECK(lwRender(technique, view, &bare, &output) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("gbuffer.camera.view") != std::string::npos);
    technique.render(view, corner.gbuffer);
    LWSsvpDesc many = descOf(65);
    LWTechnique none = nullptr;
    CHECK(lwCreateSsvp(device, &many, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("compensation") != std::string::npos);
}

TEST_CASE("light that is kept at rest is compensated with the bits of light made anew", "[ssvp][compensation][still]") {
    TestDevice device(16);
    const LitFloor floor(32, evenly);
    const Corner corner;
    TestTechnique technique(device, descOf(4)), reference(device, descOf(4));
    TestView view(device, kWidth, kHeight), other(device, kWidth, kHeight);
    LWRsm told = floor.rsm;
    told.version = 1;
    LWLight light = floor.light;
    light.rsms = &told;
    for (int i = 0; i < 20; ++i) {
        technique.update({light});
        reference.update({floor.light});
        CHECK(technique.render(view, corner.gbuffer) == reference.render(other, corner.gbuffer));
    }
    CHECK(launchesOf(technique, "vpl_sampling.draw") == 0);
    CHECK(launchesOf(reference, "vpl_sampling.draw") == 1);
}
