// Technique rsm with fewer pixels gathered, interleaved or not: what is kept of the light, and pictures of any size.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/packed_light.h"
#include "techniques/rsm_rig.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 96, kHeight = 64;

// Interleaving deals the same 256 VPLs out: means differ by what the pixels' places in the pattern have to do
// with the light, filtered or not, and by half-resolution samples that stand for their neighbours.
constexpr double kMeanFiltered = 0.01, kMeanUnfiltered = 0.02, kMeanHalf = 0.01;
// Rows beside the edge between wall and ceiling find only half of the subsets in their window, and a wider
// window meets more of them: times the interleaving, beside what a window's blur takes.
constexpr double kFilterBase = 0.02, kFilterPerSide = 0.01;
// A sample two pixels away stands for a pixel; steepest where the wall meets the floor.
constexpr double kHalfError = 0.05;

}  // namespace

TEST_CASE("interleaving, filter and half resolution keep the light", "[rsm]") {
    TestDevice device(GENERATE(1u, 16u));
    LitFloor floor(64, spotProfile);
    WallAndCeiling scene(kWidth, kHeight);
    const auto full = render(device, descOf(256, 1), {floor.light}, scene, kWidth, kHeight);
    const double mean = meanOf(full);
    for (const std::uint32_t n : {2u, 4u, 8u}) {
        CAPTURE(n);
        LWRsmDesc desc = descOf(256, n);
        const auto filtered = render(device, desc, {floor.light}, scene, kWidth, kHeight);
        CHECK(std::abs(meanOf(filtered) / mean - 1.0) < kMeanFiltered);
        CHECK(difference(filtered, full) < kFilterBase + kFilterPerSide * n);
        desc.filter = 0;
        const double raw = meanOf(render(device, desc, {floor.light}, scene, kWidth, kHeight));
        CHECK(std::abs(raw / mean - 1.0) < kMeanUnfiltered);
    }
    LWRsmDesc reduced = descOf(256, 1);
    for (const LWResolution resolution : {LW_RESOLUTION_HALF, LW_RESOLUTION_QUARTER}) {
        const int times = int(resolution);
        CAPTURE(times);
        reduced.resolution = resolution;
        const auto fewer = render(device, reduced, {floor.light}, scene, kWidth, kHeight);
        CHECK(std::abs(meanOf(fewer) / mean - 1.0) < times * kMeanHalf);
        CHECK(difference(fewer, full) < times * kHalfError);
    }
}

namespace {

// The surface that `times` halvings leave of the block at (x, y): of each two by two the first that there is.
bool findSurface(const WallAndCeiling& scene, int times, std::uint32_t x, std::uint32_t y, Vec& position, Vec& normal) {
    if (times == 0) {
        position = scene.position.get(x, y);
        normal = scene.normal.get(x, y);
        return dot(normal, normal) > 0.0;
    }
    for (const auto& at : {std::pair{0, 0}, std::pair{1, 1}, std::pair{1, 0}, std::pair{0, 1}})
        if (findSurface(scene, times - 1, 2 * x + std::uint32_t(at.first), 2 * y + std::uint32_t(at.second), position, normal)) return true;
    return false;
}

}  // namespace

TEST_CASE("a quarter of the resolution gathers what a view of the pixels that are left would", "[rsm]") {
    TestDevice device(GENERATE(1u, 16u));
    LitFloor floor(64, spotProfile);
    const WallAndCeiling scene(kWidth, kHeight);
    const int times = GENERATE(1, 2);
    const std::uint32_t width = kWidth >> times, height = kHeight >> times;
    WallAndCeiling left(width, height);
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            Vec position{}, normal{};
            if (!findSurface(scene, times, x, y, position, normal)) position = normal = {};
            left.position.set(x, y, position);
            left.normal.set(x, y, normal);
        }
    LWRsmDesc desc = descOf(256, 4);
    const auto expected = render(device, desc, {floor.light}, left, width, height);
    desc.resolution = times == 1 ? LW_RESOLUTION_HALF : LW_RESOLUTION_QUARTER;
    TestTechnique technique(device, desc);
    TestView view(device, kWidth, kHeight);
    technique.update({floor.light});
    technique.render(view, scene.gbuffer);
    std::vector<float> filtered(expected.size());
    REQUIRE(lwReadDebugView(technique, view, "filtered", filtered.data(), filtered.size()) == LW_SUCCESS);
    CHECK(filtered == expected);
}

TEST_CASE("pictures of a few pixels and of odd sizes: the same bits at any width", "[rsm]") {
    const LitFloor floor(32, spotProfile);
    TestDevice scalar(1), wide(16);
    for (const auto& [width, height] : {std::pair{1u, 1u}, std::pair{2u, 3u}, std::pair{5u, 1u}, std::pair{17u, 6u}, std::pair{67u, 35u}}) {
        WallAndCeiling scene(width, height);
        for (std::uint32_t i = 0; i < width * height; i += 7) scene.normal.set(i % width, i / width, {});  // holes, and one surface at least
        if (width == 1) scene.normal.set(0, 0, {0, -1, 0});
        scene.position.at(width - 1, 0, 1) = std::nanf("");
        for (int kind = 0; kind < 4; ++kind) {
            LWRsmDesc desc = descOf(64, 4);
            desc.resolution = kind == 1 ? LW_RESOLUTION_HALF : kind == 2 ? LW_RESOLUTION_QUARTER : LW_RESOLUTION_FULL;
            desc.autoResolution = kind == 3 ? 0.2f : 0.0f;
            CAPTURE(width, height, kind);
            const auto light = render(scalar, desc, {floor.light}, scene, width, height);
            CHECK(std::all_of(light.begin(), light.end(), [](float e) { return e >= 0.0f && e < 100.0f; }));
            CHECK(render(wide, desc, {floor.light}, scene, width, height) == light);
        }
    }
}
