// What counts as a pixel's own surface where filters and up-sampling take its slope from the pixels beside it (kernels/shared/edge_slope.h).
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "passes/joint_bilateral.h"
#include "reference/surfaces.h"
#include "support/gather_rig.h"
#include "support/kernel_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Image;
using reference::Vec;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
// Means and interpolations of a few floats.
constexpr double kTolerance = 2e-6;

struct Picture {
    Image position, normal;
};

Image filterOn(KernelRig& rig, const Picture& picture, const Image& light, std::uint32_t n) {
    return filterImage(rig, picture.position, picture.normal, light, n);
}

// The light of every second pixel and row, and what up-sampling makes of it.
Image upsampleOn(KernelRig& rig, const Picture& picture, const Image& light, int& fallbacks) {
    const std::uint32_t w = light.width, h = light.height, hw = JointBilateral::halved(w), hh = JointBilateral::halved(h);
    Image half(hw, hh);
    for (std::uint32_t y = 0; y < hh; ++y)
        for (std::uint32_t x = 0; x < hw; ++x) half.set(x, y, light.get(2 * x, 2 * y));
    const Guarded p = rig.uploadPlanes(picture.position.planes, w, h, 3, kNaN), n = rig.uploadPlanes(picture.normal.planes, w, h, 3, kNaN);
    const Guarded hp = rig.makePlanes(hw, hh, 3), hn = rig.makePlanes(hw, hh, 3), e = rig.uploadPlanes(half.planes, hw, hh, 3, kNaN);
    const Guarded out = rig.makePlanes(w, h, 3), counts = rig.upload(std::vector<cl_int>{0, 0});
    const auto full = [&](const Guarded& buffer) { return rig.planes(buffer, w, h, 3); };
    const auto halved = [&](const Guarded& buffer) { return rig.planes(buffer, hw, hh, 3); };
    JointBilateral pass(rig.device());
    pass.recordDownsample(rig.executor(), full(p), full(n), halved(hp), halved(hn));
    pass.recordUpsample(rig.executor(), full(p), full(n), halved(hp), halved(hn), halved(e), full(out), counts);
    rig.device().finish();
    fallbacks = rig.download<cl_int>(counts)[1];
    Image result(w, h);
    result.planes = rig.downloadPlanes(full(out));
    return result;
}

// A ceiling, from row (`turned`: column) `edge` on hidden by a sheet 2 cm below it, seen so that a row is 10 cm long.
Picture layers(std::uint32_t w, std::uint32_t h, std::uint32_t edge, bool turned) {
    Picture picture{Image(w, h), Image(w, h)};
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x) {
            const std::uint32_t along = turned ? y : x, away = turned ? x : y;
            picture.position.set(x, y, {0.02 * along, away < edge ? 2.0 : 1.98, 0.1 * away});
            picture.normal.set(x, y, {0, -1, 0});
        }
    return picture;
}

// A flat facet of a curved surface: its normals lean away from it, by `degrees`, along the rows or (`turned`) the columns.
Picture facet(std::uint32_t w, std::uint32_t h, double degrees, bool turned = false) {
    const double angle = degrees * 3.14159265358979323846 / 180.0;
    Picture picture{Image(w, h), Image(w, h)};
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x) {
            picture.position.set(x, y, {0.05 * x, 0.04 * y, 0.0});
            picture.normal.set(x, y, {turned ? 0 : std::sin(angle), turned ? std::sin(angle) : 0, std::cos(angle)});
        }
    return picture;
}

// A cylinder along the columns, seen from without: `radius` pixels wide from its middle, of which `columns` are in the picture.
Picture cylinder(std::uint32_t columns, std::uint32_t h, double radius) {
    Picture picture{Image(columns, h), Image(columns, h)};
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < columns; ++x) {
            const double side = (x + 0.5 - columns / 2.0) / radius, front = std::sqrt(1.0 - side * side);
            picture.position.set(x, y, {radius * side, double(y), radius * front});
            picture.normal.set(x, y, {side, 0, front});
        }
    return picture;
}

}  // namespace

TEST_CASE("light does not cross between parallel layers at a grazing angle", "[edge_slope]") {
    const auto width = GENERATE(1u, 16u);
    const auto edge = GENERATE(20u, 21u, 22u, 23u);  // of all places in a window and in a block
    const auto turned = GENERATE(false, true);
    const auto size = testSize(std::make_pair(67u, 41u));
    CAPTURE(width, edge, turned);
    KernelRig rig(width);
    const Picture picture = layers(size.first, size.second, edge, turned);
    Image light(size.first, size.second);
    for (std::uint32_t y = 0; y < size.second; ++y)
        for (std::uint32_t x = 0; x < size.first; ++x) light.set(x, y, (turned ? x : y) < edge ? Vec{1, 1, 1} : Vec{20, 20, 20});
    int fallbacks = -1;
    const Image filtered = filterOn(rig, picture, light, GENERATE(2u, 4u)), upsampled = upsampleOn(rig, picture, light, fallbacks);
    CHECK(fallbacks == 0);
    for (std::uint32_t y = 0; y < size.second; ++y)
        for (std::uint32_t x = 0; x < size.first; ++x) {
            CAPTURE(x, y);
            REQUIRE(filtered.get(x, y).x == Approx(light.get(x, y).x).epsilon(kTolerance));
            REQUIRE(upsampled.get(x, y).x == Approx(light.get(x, y).x).epsilon(kTolerance));
        }
}

TEST_CASE("a surface whose normals lean away from its facets keeps its whole window", "[edge_slope]") {
    const auto width = GENERATE(1u, 16u);
    const auto degrees = GENERATE(0.0, 15.0, 30.0);
    const auto size = testSize(std::make_pair(67u, 41u));
    const auto turned = GENERATE(false, true);
    CAPTURE(width, degrees, turned);
    KernelRig rig(width);
    const Picture picture = facet(size.first, size.second, degrees, turned);
    // What interleaving makes: of each 4 x 4 pixels one has all the light.
    Image pattern(size.first, size.second);
    for (std::uint32_t y = 0; y < size.second; ++y)
        for (std::uint32_t x = 0; x < size.first; ++x) pattern.set(x, y, x % 4 == 1 && y % 4 == 2 ? Vec{16, 16, 16} : Vec{});
    const Image filtered = filterOn(rig, picture, pattern, 4);
    for (std::uint32_t y = 0; y < size.second; ++y)
        for (std::uint32_t x = 0; x < size.first; ++x) REQUIRE(filtered.get(x, y).x == Approx(1.0).epsilon(kTolerance));

    Image ramp(size.first, size.second);
    for (std::uint32_t y = 0; y < size.second; ++y)
        for (std::uint32_t x = 0; x < size.first; ++x) ramp.set(x, y, Vec{1.0 + 0.1 * x + 0.2 * y, 1, 1});
    int fallbacks = -1;
    const Image upsampled = upsampleOn(rig, picture, ramp, fallbacks);
    CHECK(fallbacks == 0);
    for (std::uint32_t y = 2; y + 3 < size.second; ++y)  // where every sample of the tent is there
        for (std::uint32_t x = 2; x + 3 < size.first; ++x) REQUIRE(upsampled.get(x, y).x == Approx(ramp.get(x, y).x).epsilon(kTolerance));
}

TEST_CASE("the filter of a curved surface equals its serial twin", "[edge_slope]") {
    // Leans by 0.2 to 3 degrees from pixel to pixel: slopes between the least and the largest.
    const auto width = GENERATE(1u, 16u);
    const auto radius = GENERATE(20.0, 60.0);
    const auto n = GENERATE(2u, 4u, 8u);
    const auto size = testSize(std::make_pair(35u, 21u));
    CAPTURE(width, radius, n);
    KernelRig rig(width);
    const Picture picture = cylinder(size.first, size.second, radius);
    const Image light = reference::randomImage(size.first, size.second, 17);
    CHECK(disagreement(filterOn(rig, picture, light, n).planes, reference::filter(picture.position, picture.normal, light, n).planes, 2e-5, 1e-3) == "");
}

TEST_CASE("pixels whose normals leave their block's plane are lit by samples near theirs", "[edge_slope]") {
    // Samples of a flat wall; in a corner of each block the normal map leans by 20 degrees: a sample's slope is 0.05.
    const auto width = GENERATE(1u, 16u);
    const auto size = testSize(std::make_pair(67u, 41u));
    KernelRig rig(width);
    Picture picture = facet(size.first, size.second, 0.0);
    const Picture leaning = facet(size.first, size.second, 20.0);
    for (std::uint32_t y = 1; y < size.second; y += 2)
        for (std::uint32_t x = 1; x < size.first; x += 2) picture.normal.set(x, y, leaning.normal.get(x, y));
    Image light(size.first, size.second);
    for (float& value : light.planes) value = 3.0f;
    int fallbacks = -1;
    const Image upsampled = upsampleOn(rig, picture, light, fallbacks);
    CHECK(fallbacks == 0);
    for (const float value : upsampled.planes) REQUIRE(value == Approx(3.0).epsilon(kTolerance));
}

TEST_CASE("pixels that no sample is like are lit by the likest, and counted", "[edge_slope]") {
    // Normals of lone pixels, in odd rows and columns, stand at 60 degrees to the wall's.
    const auto width = GENERATE(1u, 16u);
    const auto size = testSize(std::make_pair(67u, 41u));
    const std::uint32_t w = size.first, h = size.second, hw = JointBilateral::halved(w), hh = JointBilateral::halved(h);
    CAPTURE(width);
    KernelRig rig(width);
    Picture picture = facet(w, h, 0.0);
    const Picture turned = facet(w, h, 60.0);
    int lone = 0;
    for (std::uint32_t y = 1; y < h; y += 6)
        for (std::uint32_t x = 1; x < w; x += 4, ++lone) picture.normal.set(x, y, turned.normal.get(x, y));
    const Image light = reference::randomImage(w, h, 29);
    Image halfPosition(hw, hh), halfNormal(hw, hh), half(hw, hh), expected(w, h);
    reference::downsample(picture.position, picture.normal, halfPosition, halfNormal);
    for (std::uint32_t y = 0; y < hh; ++y)
        for (std::uint32_t x = 0; x < hw; ++x) half.set(x, y, light.get(2 * x, 2 * y));
    int fallbacks = -1;
    const Image upsampled = upsampleOn(rig, picture, light, fallbacks);
    CHECK(int(reference::upsample(picture.position, picture.normal, halfPosition, halfNormal, half, expected)) == lone);
    CHECK(fallbacks == lone);
    CHECK(disagreement(upsampled.planes, expected.planes, 1e-5) == "");
}

TEST_CASE("slopes do not depend on a scene's scale, and what is beside a surface may be no number", "[edge_slope]") {
    const auto width = GENERATE(1u, 16u);
    const auto size = testSize(std::make_pair(67u, 41u));
    KernelRig rig(width);
    Picture picture{Image(size.first, size.second), Image(size.first, size.second)};
    reference::fillCorner(picture.position, picture.normal);
    const Image light = reference::randomImage(size.first, size.second, 3);
    Picture large = picture;
    for (float& value : large.position.planes) value *= 1024.0f;
    int fallbacks = 0;
    CHECK(bitDifference(filterOn(rig, large, light, 4).planes, filterOn(rig, picture, light, 4).planes) == "");
    CHECK(bitDifference(upsampleOn(rig, large, light, fallbacks).planes, upsampleOn(rig, picture, light, fallbacks).planes) == "");

    Picture torn = facet(size.first, size.second, 10.0);
    for (std::uint32_t y = 0; y < size.second; y += 5)
        for (std::uint32_t x = 0; x < size.first; x += 7) {
            const double bad[] = {kNaN, std::numeric_limits<double>::infinity(), -1e38};
            torn.position.set(x, y, {bad[x % 3], bad[y % 3], 0});
            torn.normal.set(x, y, {});
        }
    Image constant(size.first, size.second);
    for (float& value : constant.planes) value = 0.5f;
    const Image filtered = filterOn(rig, torn, constant, 4), upsampled = upsampleOn(rig, torn, constant, fallbacks);
    for (std::uint32_t y = 0; y < size.second; ++y)
        for (std::uint32_t x = 0; x < size.first; ++x) {
            const double expected = y % 5 == 0 && x % 7 == 0 ? 0.0 : 0.5;
            REQUIRE(filtered.get(x, y).x == Approx(expected).epsilon(kTolerance));
            REQUIRE(upsampled.get(x, y).x == Approx(expected).epsilon(kTolerance));
        }
}
