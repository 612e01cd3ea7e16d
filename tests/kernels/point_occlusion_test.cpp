// Points in each pixel's hemisphere: what nothing hides is open, light is linear in what sends it, and widths agree. The closed
// forms are tests/techniques/ao_test.cpp's.
#include "passes/point_occlusion.h"

#include <catch2/catch.hpp>
#include <limits>
#include <vector>

#include "inputs/camera.h"
#include "passes/mip_pyramid.h"
#include "passes/weighted_filter.h"
#include "support/kernel_rig.h"
#include "support/sphere_corner.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr std::uint32_t kLightPlanes = 6;  // light rgb, validity, open, weight
// Discrete decisions, hidden or not, that rounding may turn over; design of the dialect.
constexpr double kShare = 1e-3;

// The weighted sums of a full-resolution view.
std::vector<float> gathered(KernelRig& rig, DrawnView& drawn, const PointOcclusionOptions& options) {
    const std::uint32_t w = drawn.position.width(), h = drawn.position.height();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Guarded p = rig.uploadPlanes(drawn.position.packed(), w, h, 3, nan), n = rig.uploadPlanes(drawn.normal.packed(), w, h, 3, nan);
    const Guarded l = rig.uploadPlanes(drawn.radiance.packed(), w, h, 3, nan), m = rig.uploadPlanes(drawn.receiveMask.packed(), w, h, 1, nan);
    const Guarded counts = rig.upload(std::vector<cl_int>{0, 0});
    const Camera camera(drawn.gbuffer.camera, w, h, "camera");
    PyramidOptions pyramid;
    pyramid.extras = kPyramidDepth | (options.light ? std::uint32_t(kPyramidRadiance) : 0u);
    pyramid.firstLevel = pyramid.lastLevel = 0;
    PyramidLevels levels(rig.device(), w, h, pyramid);
    MipPyramid(rig.device(), pyramid.extras)
        .record(rig.executor(), rig.planes(p, w, h, 3), rig.planes(n, w, h, 3), options.light ? rig.planes(l, w, h, 3) : Planes{},
                rig.planes(m, w, h, 1), camera, levels, counts);
    const std::uint32_t planes = WeightedFilter::planes(options.light);
    const Guarded out = rig.makePlanes(w, h, planes);
    PointOcclusion pass(rig.device(), options);
    pass.record(rig.executor(), levels.level(0), 1, h, camera, 0, rig.planes(out, w, h, planes));
    rig.device().finish();
    return rig.downloadPlanes(rig.planes(out, w, h, planes));
}

PointOcclusionOptions optionsOf(bool light) {
    PointOcclusionOptions options;
    options.radius = 0.3;
    options.light = light;
    return options;
}

}  // namespace

TEST_CASE("nothing hides a plane's points, and background has no weight", "[point_occlusion]") {
    KernelRig rig(GENERATE(1u, 16u));
    const bool light = GENERATE(false, true);
    const auto [w, h] = testSize({37, 29});
    ViewScene scene;
    scene.quad({-0.3, -0.3, 0}, {0.6, 0, 0}, {0, 0.6, 0}, 1.0);
    DrawnView drawn(scene, lookAt({0, 0, 2}, {0, 0, 0}, 0.5), w, h);
    const auto sums = gathered(rig, drawn, optionsOf(light));
    const std::size_t pixels = std::size_t(w) * h, open = sums.size() - 2 * pixels;
    std::size_t surfaces = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        const auto normal = drawn.normal.get(std::uint32_t(i % w), std::uint32_t(i / w));
        const bool on = reference::dot(normal, normal) > 0.5;
        surfaces += on;
        CAPTURE(i, on);
        REQUIRE((sums[open + pixels + i] > 0.0f) == on);
        REQUIRE(double(sums[open + i]) == Approx(double(sums[open + pixels + i])).margin(1e-6));
        if (light) REQUIRE(sums[i] == 0.0f);
    }
    REQUIRE(surfaces > 20);
    REQUIRE(surfaces < pixels);
}

TEST_CASE("a corner is partly hidden, and its light doubles with what sends it", "[point_occlusion]") {
    KernelRig rig(GENERATE(1u, 16u));
    const auto [w, h] = testSize({37, 29});
    DrawnView drawn(sphereCorner(), cornerCamera(false), w, h);
    const auto once = gathered(rig, drawn, optionsOf(true));
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x) drawn.radiance.set(x, y, drawn.radiance.get(x, y) * 2.0);
    const auto twice = gathered(rig, drawn, optionsOf(true));
    const std::size_t pixels = std::size_t(w) * h;
    REQUIRE(once.size() == kLightPlanes * pixels);
    std::size_t lit = 0, hidden = 0;
    for (std::size_t i = 0; i < 3 * pixels; ++i) {
        REQUIRE(twice[i] == 2.0f * once[i]);  // a power of two: exact
        lit += once[i] > 0.0f;
    }
    for (std::size_t i = 0; i < pixels; ++i) hidden += once[4 * pixels + i] < once[5 * pixels + i];
    CHECK(lit > 30);
    CHECK(hidden > 10);
}

TEST_CASE("widths agree", "[point_occlusion][large]") {
    const bool light = GENERATE(false, true);
    std::vector<float> first;
    for (const std::uint32_t width : {1u, 4u, 8u, 16u}) {
        KernelRig rig(width);
        DrawnView drawn(sphereCorner(), cornerCamera(false), 131, 57);
        const auto sums = gathered(rig, drawn, optionsOf(light));
        if (first.empty()) first = sums;
        CAPTURE(width, light);
        CHECK(disagreement(sums, first, 1e-5, kShare) == "");
    }
}
