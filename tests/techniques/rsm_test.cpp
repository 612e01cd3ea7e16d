// Technique rsm through the C API: its limit, its convergence, what must not change it, and what a host
// relies on (several views, sizes and lights; nothing built after lwPrewarm). Some lines over 300: one list of what every technique promises.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <string>

#include "support/lit_room.h"
#include "support/packed_light.h"
#include "support/scoped_api.h"
#include "techniques/rsm_rig.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

double uniformProfile(double, double) { return 1.0; }

constexpr std::uint32_t kWidth = 96, kHeight = 64;

// Midpoint quadrature of 1/96 cells from 1/10 away, and the bounding of each texel's own area.
constexpr double kPolygonTolerance = 5e-4;
// The bound on the log-log slope of the error; independent samples have -0.5.
constexpr double kSlope = -0.4;
// Different sums of the same terms in float.
constexpr double kRounding = 3e-6;
// 1,024 VPLs from both maps against every texel of both, in the mean over the view.
constexpr double kMeanOf1024 = 0.003;

}  // namespace

TEST_CASE("all texels reach the polygon's irradiance", "[rsm]") {
    TestDevice device(GENERATE(1u, 16u));
    LitFloor floor(96, uniformProfile);
    WallAndCeiling scene(33, 32);
    const auto e = render(device, descOf(0, 1), {floor.light}, scene, 33, 32);
    const std::vector<Vec> corners = {{-0.5, 0, 0}, {0.5, 0, 0}, {0.5, 0, 1}, {-0.5, 0, 1}};
    double worst = 0.0;
    for (std::uint32_t y = 0; y < 32; ++y)
        for (std::uint32_t x = 0; x < 33; ++x) {
            const double got = double(e[y * 33 + x]);
            if (x == 0) {
                CHECK(got == 0.0);
                continue;
            }
            const Vec p = scene.position.get(x, y), n = scene.normal.get(x, y);
            worst = std::max(worst, std::abs(got / polygonIrradiance(corners, p, n, 1.0) - 1.0));
        }
    CHECK(worst < kPolygonTolerance);
}

TEST_CASE("the error falls with the number of VPLs, faster by flux than uniformly", "[rsm]") {
    TestDevice device(16);
    LitFloor floor(128, spotProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const auto limit = render(device, descOf(0, 1), {floor.light}, scene, kWidth, kHeight);
    auto error = [&](std::uint32_t vpls, LWVplSampling sampling) {
        double sum = 0.0;  // over seeds: one low-discrepancy set may be lucky
        for (std::uint32_t seed = 1; seed <= 4; ++seed) {
            LWRsmDesc desc = descOf(vpls, 1);
            desc.sampling = sampling;
            desc.seed = seed;
            sum += std::pow(difference(render(device, desc, {floor.light}, scene, kWidth, kHeight), limit), 2.0);
        }
        return std::sqrt(sum / 4.0);
    };
    const double few = error(64, LW_SAMPLING_FLUX), many = error(4096, LW_SAMPLING_FLUX);
    CAPTURE(few, many);
    CHECK(std::log(many / few) / std::log(64.0) < kSlope);
    for (const std::uint32_t vpls : {64u, 256u, 1024u}) {
        CAPTURE(vpls);
        CHECK(error(vpls, LW_SAMPLING_FLUX) < error(vpls, LW_SAMPLING_UNIFORM));
    }
}

TEST_CASE("VPLs chosen for the view light it as all texels do, in the mean of seeds; without a view they are refused", "[rsm]") {
    TestDevice device(16);
    LitFloor floor(128, spotProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const double limit = meanOf(render(device, descOf(0, 1), {floor.light}, scene, kWidth, kHeight));
    TestView view(device, kWidth, kHeight);
    const LWSourceView source{view, &scene.gbuffer};
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.lights = &floor.light;
    frame.lightCount = 1;
    LWRsmDesc desc = descOf(1024, 1);
    desc.sampling = LW_SAMPLING_VIEW;
    double mean = 0.0;
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
        desc.seed = seed;
        TestTechnique technique(device, desc);
        CHECK(lwUpdate(technique, &frame) == LW_ERROR_INVALID_ARGUMENT);
        CHECK(lastError(device).find("frame.sourceViews: expected") != std::string::npos);
        frame.sourceViews = &source;
        frame.sourceViewCount = 1;
        technique.update(frame);
        const auto picture = technique.render(view, scene.gbuffer);
        mean += meanOf(picture) / 8.0;
        technique.update(frame);
        CHECK(technique.render(view, scene.gbuffer) == picture);
        const LWStats stats = technique.stats();
        for (std::uint32_t i = 0; i < stats.choiceCount; ++i) CHECK(std::string(stats.choices[i].name) != "frame.sourceViews");
        LWViewDesc size{};
        size.structSize = sizeof size;
        size.maxWidth = kWidth;
        size.maxHeight = kHeight;
        std::uint64_t bytes = 0;
        CHECK(lwEstimateFrameMemory(device, "rsm", &desc, &size, &frame, &bytes) == LW_SUCCESS);
        CHECK(stats.deviceBytes <= bytes);
        frame.sourceViews = nullptr;
        frame.sourceViewCount = 0;
    }
    CHECK(std::abs(mean / limit - 1.0) < kMeanOf1024);
}

TEST_CASE("same input, same bits: runs and widths", "[rsm]") {
    LitFloor floor(64, spotProfile);
    WallAndCeiling scene(kWidth, kHeight);
    LWRsmDesc desc = descOf(256, 4);
    desc.resolution = GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_HALF, LW_RESOLUTION_QUARTER);
    TestDevice wide(16), scalar(1);
    const auto first = render(wide, desc, {floor.light}, scene, kWidth, kHeight);
    for (int run = 0; run < 10; ++run) CHECK(render(wide, desc, {floor.light}, scene, kWidth, kHeight) == first);
    CHECK(render(scalar, desc, {floor.light}, scene, kWidth, kHeight) == first);
}

TEST_CASE("scale changes nothing but rounding", "[rsm]") {
    TestDevice device(16);
    auto at = [&](double scale) {
        LitFloor floor(64, spotProfile, scale);
        WallAndCeiling scene(kWidth, kHeight, scale);
        return render(device, descOf(256, 4), {floor.light}, scene, kWidth, kHeight);
    };
    const auto metres = at(1.0);
    for (const double scale : {10.0, 0.1, 1000.0}) {
        CAPTURE(scale);
        CHECK(difference(at(scale), metres) < kRounding);
    }
}

TEST_CASE("lights of different kinds add up", "[rsm]") {
    TestDevice device(16);
    LitFloor sun(32, uniformProfile), spot(48, spotProfile);
    spot.light.kind = LW_LIGHT_SPOT;
    // The spot's map is seen in perspective from y = 1.
    const float projection[16] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, -1.001f, -0.01f, 0, 0, -1, 0};
    std::memcpy(spot.rsm.camera.projection, projection, sizeof projection);
    WallAndCeiling scene(kWidth, kHeight);
    const auto both = render(device, descOf(0, 1), {sun.light, spot.light}, scene, kWidth, kHeight);
    const auto one = render(device, descOf(0, 1), {sun.light}, scene, kWidth, kHeight);
    const auto other = render(device, descOf(0, 1), {spot.light}, scene, kWidth, kHeight);
    std::vector<float> sum(one.size());
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = one[i] + other[i];
    CHECK(difference(both, sum) < kRounding);
    // Drawn together, they share the VPLs.
    const double drawn = meanOf(render(device, descOf(1024, 1), {sun.light, spot.light}, scene, kWidth, kHeight));
    CHECK(std::abs(drawn / meanOf(both) - 1.0) < kMeanOf1024);
}

TEST_CASE("one update serves several views; sizes change without allocation", "[rsm]") {
    TestDevice device(16);
    LitFloor floor(64, spotProfile);
    WallAndCeiling left(kWidth, kHeight), right(61, 40);
    const LWRsmDesc desc = descOf(256, 4);
    const auto leftAlone = render(device, desc, {floor.light}, left, kWidth, kHeight);
    const auto rightAlone = render(device, desc, {floor.light}, right, 61, 40);

    TestTechnique technique(device, desc);
    TestView leftView(device, kWidth, kHeight), rightView(device, 128, 128);
    technique.update({floor.light});
    CHECK(technique.render(leftView, left.gbuffer) == leftAlone);
    rightView.resize(61, 40);
    CHECK(technique.render(rightView, right.gbuffer) == rightAlone);
    const std::uint64_t bytes = technique.stats().deviceBytes;
    rightView.resize(kWidth, kHeight);
    CHECK(technique.render(rightView, left.gbuffer) == leftAlone);
    rightView.resize(61, 40);
    CHECK(technique.render(rightView, right.gbuffer) == rightAlone);
    CHECK(technique.stats().deviceBytes == bytes);
}

TEST_CASE("after lwPrewarm 500 frames with resizes build nothing", "[rsm]") {
    TestDevice device(16);
    LitFloor floor(32, spotProfile);
    LWRsmDesc desc = descOf(64, 4);
    desc.resolution = GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_QUARTER);
    if (desc.resolution == LW_RESOLUTION_QUARTER) desc.sampling = LW_SAMPLING_VIEW;
    TestTechnique technique(device, desc);
    TestView view(device, 64, 64);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    WallAndCeiling scene(64, 64), small(40, 24);
    for (int frame = 0; frame < 500; ++frame) {
        const bool isSmall = frame % 5 == 4;
        view.resize(isSmall ? 40 : 64, isSmall ? 24 : 64);
        const LWSourceView source{view, isSmall ? &small.gbuffer : &scene.gbuffer};
        LWFrame seen{};
        seen.structSize = sizeof seen;
        seen.lightCount = seen.sourceViewCount = 1;
        seen.lights = &floor.light;
        seen.sourceViews = &source;
        technique.update(seen);
        technique.render(view, *source.gbuffer);
    }
    const LWDeviceInfo after = device.info();
    CHECK(after.programsBuilt == before.programsBuilt);
    CHECK(after.programsLoaded == before.programsLoaded);
    CHECK(after.kernelsSpecialised == before.kernelsSpecialised);
}

TEST_CASE("the length of normals does not matter", "[rsm]") {
    TestDevice device(GENERATE(1u, 16u));
    LitFloor floor(64, spotProfile);
    WallAndCeiling scene(kWidth, kHeight);
    LWRsmDesc desc = descOf(256, 4);
    desc.resolution = GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_HALF, LW_RESOLUTION_QUARTER);
    const auto unit = render(device, desc, {floor.light}, scene, kWidth, kHeight);
    for (const float length : {0.7f, 0.95f, 1.5f}) {
        WallAndCeiling other(kWidth, kHeight);
        for (std::uint32_t y = 0; y < kHeight; ++y)
            for (std::uint32_t x = 0; x < kWidth; ++x) other.normal.set(x, y, scene.normal.get(x, y) * double(length));
        CAPTURE(length);
        CHECK(difference(render(device, desc, {floor.light}, other, kWidth, kHeight), unit) < kRounding);
    }
}

TEST_CASE("an output inside a larger image leaves its neighbours alone", "[rsm]") {
    TestDevice device(16);
    LitFloor floor(64, spotProfile);
    const std::uint32_t width = 37, height = 21;  // not a multiple of 16, in rows of 96
    WallAndCeiling scene(width, height);
    TestTechnique technique(device, descOf(64, 4));
    TestView view(device, width, height);
    technique.update({floor.light});
    const auto expected = technique.render(view, scene.gbuffer);
    PlanarPixels atlas(96, height, 3);
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < 96; ++x) atlas.set(x, y, {-7, -7, -7});
    LWOutput output{};
    output.structSize = sizeof output;
    output.irradiance = atlas.image();
    output.irradiance.width = width;
    REQUIRE(lwRender(technique, view, &scene.gbuffer, &output) == LW_SUCCESS);
    REQUIRE(lwFinish(device) == LW_SUCCESS);
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < 96; ++x)
            REQUIRE(atlas.get(x, y).x == (x < width ? double(expected[y * width + x]) : -7.0));
}

TEST_CASE("stats name the passes, count what was refused, and memory is as estimated", "[rsm]") {
    TestDevice device(16);
    LitFloor floor(64, spotProfile);
    WallAndCeiling scene(kWidth, kHeight);
    scene.position.at(7, 7, 0) = std::nanf("");
    LWRsmDesc desc = descOf(256, 4);
    desc.resolution = GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_HALF, LW_RESOLUTION_QUARTER);
    TestTechnique technique(device, desc);
    TestView view(device, kWidth, kHeight);
    technique.update({floor.light});
    technique.render(view, scene.gbuffer);
    const LWStats stats = technique.stats();
    bool gathered = false;
    for (std::uint32_t i = 0; i < stats.passCount; ++i)
        gathered = gathered || std::string(stats.passes[i].name) == "interleaved_gather.gather";
    CHECK(gathered);
    CHECK(technique.count("vpls") == 256);
    CHECK(technique.count("rejected_pixels") == 1);

    LWViewDesc viewDesc{};
    viewDesc.structSize = sizeof viewDesc;
    viewDesc.maxWidth = kWidth;
    viewDesc.maxHeight = kHeight;
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateMemory(device, "rsm", &desc, &viewDesc, 64 * 64, &estimate) == LW_SUCCESS);
    // The estimate holds room for inputs that have to be unpacked; here all are used in place.
    CHECK(stats.deviceBytes <= estimate);
    CHECK(stats.deviceBytes > estimate / 4);
}

TEST_CASE("every texel counts as a VPL, the padding of rows does not", "[rsm]") {
    TestDevice device(16);
    LitFloor floor(13, uniformProfile);
    TestTechnique technique(device, descOf(0, 4));
    CHECK(technique.count("vpls") == 0);
    technique.update({floor.light});
    CHECK(technique.count("vpls") == 13 * 13);
}

TEST_CASE("rsm refuses what it cannot make", "[rsm]") {
    TestDevice device(16);
    LitFloor floor(32, spotProfile);
    WallAndCeiling scene(kWidth, kHeight);
    TestTechnique technique(device, descOf(64, 4));
    TestView view(device, kWidth, kHeight);
    technique.update({floor.light});
    PlanarPixels scalar(kWidth, kHeight, 1);
    LWOutput output{};
    output.structSize = sizeof output;
    output.ambientOcclusion = scalar.image();
    CHECK(lwRender(technique, view, &scene.gbuffer, &output) == LW_ERROR_UNSUPPORTED);
    CHECK(lastError(device).find("ambientOcclusion") != std::string::npos);
    LWRsmDesc bad = descOf(64, 3);
    LWTechnique none = nullptr;
    CHECK(lwCreateRsm(device, &bad, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("interleave") != std::string::npos);
}
