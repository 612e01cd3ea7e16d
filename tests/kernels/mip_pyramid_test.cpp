// The pyramid of a G-buffer against its serial twin, conserved quantities and closed forms.
#include "kernels/pyramid_rig.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace lightwell;
using namespace lightwell::test;
using reference::PyramidLevel;
using reference::Vec;

namespace {

// Positions are copies, normals three roundings. Areas and radiances: the offset from the eye, its cube, a few
// divisions, then sums of four on each level.
constexpr double kTwinTolerance = 1e-5;
// Which child is nearest, or on the kept surface, is rounding's where two are equally so: such a texel is another one.
constexpr double kTwinShare = 5e-3;

// A corner, a slab before it and background, seen by a camera; light, a character that only receives, bad numbers.
PyramidScene cornerScene(std::uint32_t w, std::uint32_t h, const PinholeCamera& camera) {
    PyramidScene scene(w, h);
    const Image light = reference::randomImage(w, h, 3);
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x) {
            const double u = (x + 0.5) / w, v = (y + 0.5) / h;
            if (v < 0.1) continue;
            Vec point{0, 0, -4}, n{0, 0, 1};
            if (u > 0.3 && u < 0.5 && v > 0.3 && v < 0.8) point.z = -2.0;
            else if (v > 0.6) { point = {0, -0.3, 0}; n = reference::unit({0.1, 1, 0.05}); }
            scene.position.set(x, y, camera.onPlane(x + 0.5, y + 0.5, point, n));
            scene.normal.set(x, y, n * 0.9);
            scene.radiance.set(x, y, light.get(x, y));
            if (u > 0.7 && v > 0.5 && v < 0.9) scene.mask[scene.position.at(x, y)] = 1.0f;
        }
    return scene;
}

}  // namespace

TEST_CASE("a pyramid equals its serial twin", "[mip_pyramid]") {
    const auto width = GENERATE(1u, 16u);
    const auto size = testSize(GENERATE(std::make_pair(1u, 1u), std::make_pair(2u, 31u), std::make_pair(33u, 8u), std::make_pair(131u, 57u)));
    const std::uint32_t first = GENERATE(0u, 1u);
    CAPTURE(width, size.first, size.second, first);
    KernelRig rig(width);
    const auto [w, h] = size;
    const PinholeCamera camera{{0.2, 0.3, 0.5}, 0.4, w, h};
    PyramidScene scene = cornerScene(w, h, camera);
    int bad = 0;
    if (w > 30) {
        scene.radiance.set(w - 2, h - 1, {kNoNumber, 1, 1});
        scene.radiance.set(w / 3, h - 1, {1, -1, 1});
        scene.normal.set(w - 1, h - 1, {0.1, 0, 0});  // no normal: rejected
        bad = 1;
    }
    const PyramidOptions options{kPyramidRadiance | kPyramidArea | kPyramidDepth, first, 4};
    const PyramidRead read = build(rig, scene, camera, options);
    CHECK(read.counts == std::vector<cl_int>{bad, 2 * bad});
    PyramidLevel level = reference::pyramidBase(scene.position, scene.normal, scene.radiance, camera, [&](std::uint32_t x, std::uint32_t y) {
        return scene.mask[scene.position.at(x, y)] != 0.0f;
    });
    for (std::uint32_t k = 0; k <= 4; ++k) {
        if (k > 0) level = reference::pyramidReduce(level, k % 2 == 0);
        if (k < first) continue;
        CAPTURE(k);
        const std::size_t i = k - first;
        Image position(level.width, level.height), normal(level.width, level.height), radiance(level.width, level.height);
        std::vector<float> area, depth;
        for (std::uint32_t y = 0; y < level.height; ++y)
            for (std::uint32_t x = 0; x < level.width; ++x) {
                const reference::PyramidTexel& t = level.at(x, y);
                position.set(x, y, t.s.position);
                normal.set(x, y, t.s.normal);
                radiance.set(x, y, t.radiance);
                area.push_back(float(t.area));
                depth.push_back(float(t.depth));
            }
        REQUIRE(read.position[i].width == level.width);
        REQUIRE(read.position[i].height == level.height);
        CHECK(disagreement(read.position[i].planes, position.planes, kTwinTolerance, kTwinShare) == "");
        CHECK(disagreement(read.normal[i].planes, normal.planes, kTwinTolerance, kTwinShare) == "");
        CHECK(disagreement(read.radiance[i].planes, radiance.planes, kTwinTolerance, kTwinShare) == "");
        CHECK(disagreement(read.area[i], area, kTwinTolerance, kTwinShare) == "");
        CHECK(disagreement(read.depth[i], depth, kTwinTolerance, kTwinShare) == "");
    }
}

TEST_CASE("a pyramid that starts at a quarter has the bits of one that starts at half", "[mip_pyramid]") {
    const auto width = GENERATE(1u, 16u);
    const auto size = testSize(GENERATE(std::make_pair(1u, 1u), std::make_pair(5u, 3u), std::make_pair(34u, 9u), std::make_pair(131u, 57u)));
    const std::uint32_t extras = GENERATE(std::uint32_t(kPyramidRadiance | kPyramidArea), std::uint32_t(kPyramidRadiance), 0u);
    CAPTURE(width, size.first, size.second, extras);
    KernelRig rig(width);
    const PinholeCamera camera{{0.1, 0.2, 0.5}, 0.4, size.first, size.second};
    const PyramidScene scene = cornerScene(size.first, size.second, camera);
    const PyramidRead half = build(rig, scene, camera, {extras, 1, 3}), quarter = build(rig, scene, camera, {extras, 2, 3});
    CHECK(quarter.counts == half.counts);
    for (std::size_t k = 0; k < 2; ++k) {
        CHECK(bitDifference(quarter.position[k].planes, half.position[k + 1].planes) == "");
        CHECK(bitDifference(quarter.normal[k].planes, half.normal[k + 1].planes) == "");
        if (extras & kPyramidRadiance) CHECK(bitDifference(quarter.radiance[k].planes, half.radiance[k + 1].planes) == "");
        if (extras & kPyramidArea) CHECK(bitDifference(quarter.area[k], half.area[k + 1]) == "");
    }
}

TEST_CASE("a pyramid has the same bits at every width, and fewer planes change nothing", "[mip_pyramid][large]") {
    const PinholeCamera camera{{0.2, 0.3, 0.5}, 0.4, 131, 57};
    const PyramidScene scene = cornerScene(131, 57, camera);
    const PyramidOptions options{kPyramidRadiance | kPyramidArea, 1, 4};
    KernelRig scalar(1);
    const PyramidRead first = build(scalar, scene, camera, options);
    for (const std::uint32_t width : {4u, 8u, 16u}) {
        KernelRig rig(width);
        const PyramidRead other = build(rig, scene, camera, options);
        for (std::size_t i = 0; i < 4; ++i) {
            CHECK(bitDifference(other.position[i].planes, first.position[i].planes) == "");
            CHECK(bitDifference(other.normal[i].planes, first.normal[i].planes) == "");
            CHECK(bitDifference(other.radiance[i].planes, first.radiance[i].planes) == "");
            CHECK(bitDifference(other.area[i], first.area[i]) == "");
        }
    }
    PyramidScene everyoneSends = scene;
    std::fill(everyoneSends.mask.begin(), everyoneSends.mask.end(), 0.0f);
    const PyramidRead full = build(scalar, everyoneSends, camera, {kPyramidRadiance | kPyramidDepth, 0, 3});
    const PyramidRead depth = build(scalar, everyoneSends, camera, {kPyramidDepth, 0, 3}), none = build(scalar, everyoneSends, camera, {0, 0, 3});
    for (std::size_t i = 0; i < 4; ++i) {
        CHECK(bitDifference(depth.position[i].planes, full.position[i].planes) == "");
        CHECK(bitDifference(depth.depth[i], full.depth[i]) == "");
        CHECK(bitDifference(none.normal[i].planes, full.normal[i].planes) == "");
    }
}

TEST_CASE("a texel is the nearest pixel of exactly its own block", "[mip_pyramid]") {
    // Slanted and curved ground whose depths all differ, with holes: no twin, only the definition.
    KernelRig rig(16);
    const auto [w, h] = testSize(std::make_pair(150u, 45u));
    const PinholeCamera camera{{0, 0, 0}, 0.5, w, h};
    const PyramidScene scene = grainyScene(camera, w, h);
    const PyramidRead read = build(rig, scene, camera, {kPyramidDepth, 1, 5});
    for (std::uint32_t k = 1; k <= 5; ++k)
        for (std::uint32_t y = 0; y < PyramidLevels::sizeAt(h, k); ++y)
            for (std::uint32_t x = 0; x < PyramidLevels::sizeAt(w, k); ++x) {
                double nearest = 1e9;
                Vec point;
                for (std::uint32_t j = y << k; j < std::min((y + 1) << k, h); ++j)
                    for (std::uint32_t i = x << k; i < std::min((x + 1) << k, w); ++i)
                        if (scene.normal.get(i, j).z > 0 && -scene.position.get(i, j).z < nearest) {
                            nearest = -scene.position.get(i, j).z;
                            point = scene.position.get(i, j);
                        }
                const Vec got = read.position[k - 1].get(x, y);
                CAPTURE(k, x, y);
                REQUIRE(got.x == point.x);
                REQUIRE(got.y == point.y);
                REQUIRE(got.z == point.z);
                REQUIRE((read.normal[k - 1].get(x, y).z > 0) == (nearest < 1e9));
            }
}

TEST_CASE("areas of texels sum to the area seen and their flux is that of the base, on every level", "[mip_pyramid]") {
    // A plane seen at a slant fills the image: its area between the rays through the corners is a closed form.
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    const auto size = testSize(std::make_pair(78u, 46u));
    const Vec point{0, -1, -2}, n = reference::unit({0.3, 1.0, 0.9});
    double error = 0.0;
    for (const std::uint32_t finer : {1u, 2u}) {
        const std::uint32_t w = finer * size.first, h = finer * size.second;
        const PinholeCamera camera{{1, 2, 3}, 0.76 * h / w, w, h};
        PyramidScene scene(w, h);
        const Image light = reference::randomImage(w, h, 5);
        for (std::uint32_t y = 0; y < h; ++y)
            for (std::uint32_t x = 0; x < w; ++x) {
                scene.position.set(x, y, camera.onPlane(x + 0.5, y + 0.5, point, n));
                scene.normal.set(x, y, n);
                scene.radiance.set(x, y, light.get(x, y));
            }
        const Vec a = camera.onPlane(0, 0, point, n), b = camera.onPlane(w, 0, point, n), c = camera.onPlane(w, h, point, n),
                  d = camera.onPlane(0, h, point, n), p = c - a, q = d - b;
        const double area = 0.5 * std::abs(dot({p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x}, n));
        const PyramidRead read = build(rig, scene, camera, {kPyramidRadiance | kPyramidArea, 0, 5});
        double baseArea = 0.0, baseFlux = 0.0;
        for (std::size_t k = 0; k <= 5; ++k) {
            double sum = 0.0, flux = 0.0;
            for (std::size_t i = 0; i < read.area[k].size(); ++i) {
                sum += double(read.area[k][i]);
                flux += double(read.area[k][i]) * double(read.radiance[k].planes[i]);
            }
            if (k == 0) baseArea = sum, baseFlux = flux;
            CAPTURE(finer, k);
            CHECK(sum == Approx(baseArea).epsilon(1e-6));
            CHECK(flux == Approx(baseFlux).epsilon(1e-6));
        }
        // What is left is that of the midpoint rule over areas that grow from pixel to pixel: a quarter at twice the size.
        const double before = error;
        error = baseArea / area - 1.0;
        CAPTURE(finer, before, error);
        CHECK(std::abs(error) < (w > 70 ? 2e-3 : 5e-2));
        if (finer == 2) CHECK(error == Approx(before / 4.0).epsilon(0.1));
    }
}

TEST_CASE("a shift by one pixel shifts every level's light by one pixel", "[mip_pyramid][large]") {
    // "Half-pixel hell": a smooth spot on a wall that faces the camera. Its centroid on level k, with texels at
    // (i + 1/2) 2^k pixels, must be where it is on level 0, wherever the spot stands; so must the texels' points: within
    // rounding where they are the middle of an area, else, as one of the block's pixels, by no more than 0.26 texels.
    const bool hasArea = GENERATE(true, false);
    KernelRig rig(16);
    const std::uint32_t w = 192, h = 96;
    const PinholeCamera camera{{0, 0, 0}, 0.5, w, h};
    const PyramidOptions options{kPyramidRadiance | (hasArea ? kPyramidArea : 0u), 0, 4};
    for (std::uint32_t shift = 0; shift < 5; ++shift) {
        PyramidScene scene(w, h);
        const double cx = 90.0 + shift, cy = 50.0 + shift;
        for (std::uint32_t y = 0; y < h; ++y)
            for (std::uint32_t x = 0; x < w; ++x) {
                const double dx = x + 0.5 - cx, dy = y + 0.5 - cy, l = std::exp(-(dx * dx + dy * dy) / (2.0 * 12.0 * 12.0));
                scene.position.set(x, y, camera.ray(x + 0.5, y + 0.5));
                scene.normal.set(x, y, {0, 0, 1});
                scene.radiance.set(x, y, {l, l, l});
            }
        const PyramidRead read = build(rig, scene, camera, options);
        for (std::uint32_t k = 0; k <= 4; ++k) {
            double sum = 0.0, sx = 0.0, sy = 0.0, off = 0.0;
            const std::uint32_t lw = read.position[k].width, lh = read.position[k].height;
            const double texel = double(1u << k), step = 2.0 * camera.tangent / h;
            for (std::uint32_t y = 0; y < lh; ++y)
                for (std::uint32_t x = 0; x < lw; ++x) {
                    const double l = read.radiance[k].get(x, y).x, px = (x + 0.5) * texel, py = (y + 0.5) * texel;
                    sum += l;
                    sx += l * px;
                    sy += l * py;
                    const Vec p = read.position[k].get(x, y);
                    off = std::max({off, std::abs(p.x / step + 0.5 * w - px), std::abs(0.5 * h - p.y / step - py)});
                }
            CAPTURE(shift, k, hasArea);
            // A Gaussian of 12 pixels, sampled every 16 at most: the centroid of its samples is its own within 1e-3.
            CHECK(sx / sum == Approx(cx).margin(0.02));
            CHECK(sy / sum == Approx(cy).margin(0.02));
            CHECK(off <= (hasArea ? 1e-3 : 0.26 * texel));
        }
    }
}

TEST_CASE("background wins nowhere and sends nothing; those that only receive never hide a sender", "[mip_pyramid]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    const PinholeCamera camera{{0, 0, 0}, 0.5, 16, 4};
    PyramidScene scene(16, 4);
    // A wall two units away with a hole whose pixels claim to be nearer and bright, and a character at one unit.
    for (std::uint32_t y = 0; y < 4; ++y)
        for (std::uint32_t x = 0; x < 16; ++x) {
            scene.position.set(x, y, camera.ray(x + 0.5, y + 0.5) * (x % 2 ? 0.5 : 2.0));
            scene.normal.set(x, y, x % 2 ? Vec{} : Vec{0, 0, 1});
            scene.radiance.set(x, y, x % 2 ? Vec{9, 9, 9} : Vec{1, 1, 1});
            if (x >= 8 && y % 2 == 0) {
                scene.position.set(x, y, camera.ray(x + 0.5, y + 0.5));
                scene.normal.set(x, y, {0, 0, 1});
                scene.mask[scene.position.at(x, y)] = 7.0f;
            }
        }
    const PyramidRead read = build(rig, scene, camera, {kPyramidRadiance | kPyramidArea, 1, 2});
    for (std::uint32_t x = 0; x < 8; ++x) {
        CAPTURE(x);
        CHECK(read.radiance[0].get(x, 0).x == Approx(1.0));
        CHECK(read.position[0].get(x, 0).z == Approx(-2.0));
        // The wall's pixels in a block: two of four, of which a character hides one.
        CHECK(read.area[0][x] == Approx((x < 4 ? 2.0 : 1.0) * 4.0 * camera.pixelArea()));
    }
}
