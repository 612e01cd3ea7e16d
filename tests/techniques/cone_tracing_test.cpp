// Technique cone_tracing through the C API: light that is known without tracing anything.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/cone_box.h"
#include "support/lpv_room.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 61, kHeight = 44;
constexpr double kPi = 3.14159265358979323846;

const TestCamera kInside = lookAt({0.2, 0.1, 0.9}, {0, 0, -1}, 1.2);

double evenProfile(double, double) { return 1.0; }

// Least and most of a picture.
std::pair<double, double> rangeOf(const std::vector<float>& values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return {double(*low), double(*high)};
}

}  // namespace

// What cones lose of a closed box: slanted ones get past a wall between samples that lie on both sides
// of it, and in edges they begin within the other wall's voxels (docs/techniques/cone_gather.md).
TEST_CASE("in a closed box of even walls the irradiance is theirs, but for what cones let through", "[cone_tracing]") {
    TestDevice device(GENERATE(1u, 16u));
    const bool emits = GENERATE(false, true);
    const auto mode = GENERATE(LW_VOXEL_MODE_ISOTROPIC, LW_VOXEL_MODE_ANISOTROPIC, LW_VOXEL_MODE_SH2);
    const ConeBox box(2.0, emits);
    const DrawnView drawn(box.walls, kInside, kWidth, kHeight);
    const std::vector<float> light = renderCones(device, coneDesc(32, mode), box.frame, drawn.gbuffer, kWidth, kHeight);
    const double mean = meanOf(light) / 2.0;
    const auto [least, most] = rangeOf(light);
    CAPTURE(emits, int(mode), mean, least, most);
    if (mode == LW_VOXEL_MODE_ANISOTROPIC) {
        CHECK(mean > 0.94);
        CHECK(mean < 1.02);
        CHECK(most < 2.0 * 1.2);
        CHECK(least > 2.0 * 0.65);
    } else {
        // Walls are open to cones wider than they are thick: 1 - 2^-k on level k.
        CHECK(mean > 0.25);
        CHECK(mean < 0.6);
    }
}

TEST_CASE("cones: lengths times ten, light as it is, the same picture", "[cone_tracing]") {
    TestDevice device(16);
    const ConeBox small(2.0), large(2.0, false, 10.0);
    const DrawnView near(small.walls, kInside, kWidth, kHeight), far(small.walls, kInside, kWidth, kHeight, 10.0);
    const LWConeTracingDesc desc = coneDesc(32, LW_VOXEL_MODE_ANISOTROPIC, LW_CONE_RESOLUTION_INTERLEAVED);
    const std::vector<float> a = renderCones(device, desc, small.frame, near.gbuffer, kWidth, kHeight),
                             b = renderCones(device, desc, large.frame, far.gbuffer, kWidth, kHeight);
    // Positions are rounded differently; a texel on a voxel's border may be its neighbour's.
    CHECK(difference(a, b) < 2e-3);
}

TEST_CASE("cones: same input, same bits, over runs and numbers of cores; widths agree", "[cone_tracing]") {
    const ConeBox box(2.0, false, 1.0, 0.5, 64);
    const DrawnView drawn(box.walls, kInside, kWidth, kHeight);
    LWConeTracingDesc desc = coneDesc(32, LW_VOXEL_MODE_ANISOTROPIC, LW_CONE_RESOLUTION_INTERLEAVED);
    desc.cascades = 2;
    desc.normalAware = 2;  // what 1 reads, and where it lies about the plane
    TestDevice wide(16), scalar(1);
    const std::vector<float> first = renderCones(wide, desc, box.frame, drawn.gbuffer, kWidth, kHeight);
    CHECK(meanOf(first) > 0.0);
    for (int run = 0; run < 10; ++run) CHECK(renderCones(wide, desc, box.frame, drawn.gbuffer, kWidth, kHeight) == first);
    const std::vector<float> narrow = renderCones(scalar, desc, box.frame, drawn.gbuffer, kWidth, kHeight);
    double worst = 0.0;
    const double mean = meanOf(first);
    for (std::size_t i = 0; i < first.size(); ++i)
        worst = std::max(worst, std::abs(double(narrow[i]) - double(first[i])) / (std::abs(double(first[i])) + mean));
    CHECK(worst < 1e-5);  // design.md's bound on widths
}

TEST_CASE("cones: light of a floor on a ceiling is the polygon's, the nearer the finer voxels and cones are", "[cone_tracing][large]") {
    TestDevice device(16);
    constexpr std::uint32_t kAcross = 45, kDown = 32;
    LitFloor floor(128, evenProfile);
    WallAndCeiling scene(kAcross, kDown);
    const RoomTriangles room(1.0);
    const std::vector<LWLight> lights = {floor.light};
    LWConeTracingDesc coarse = coneDesc(32), fine = coneDesc(128);
    fine.cones = 256;
    fine.step = 0.25f;
    const double coarseError = ceilingError(renderCones(device, coarse, roomFrame(lights, &room.geometry), scene.gbuffer, kAcross, kDown),
                                            scene, kAcross, kDown),
                 fineError = ceilingError(renderCones(device, fine, roomFrame(lights, &room.geometry), scene.gbuffer, kAcross, kDown),
                                          scene, kAcross, kDown);
    CAPTURE(coarseError, fineError);
    CHECK(fineError < coarseError);
    CHECK(fineError < 0.15);
}

TEST_CASE("cones: all bounces of a furnace add up to its exitance over what it absorbs", "[cone_tracing]") {
    TestDevice device(16);
    const double albedo = 0.5;
    const ConeBox box(1.0, true, 1.0, albedo);
    const DrawnView drawn(box.walls, kInside, kWidth, kHeight);
    LWConeTracingDesc desc = coneDesc(32);
    const double one = meanOf(renderCones(device, desc, box.frame, drawn.gbuffer, kWidth, kHeight));
    desc.bounces = 0;
    TestTechnique technique(device, "cone_tracing", &desc);
    TestView view(device, kWidth, kHeight);
    std::vector<double> frames;
    for (int f = 0; f < 8; ++f) {
        technique.update(box.frame);
        frames.push_back(meanOf(technique.render(view, drawn.gbuffer)));
    }
    CAPTURE(one, frames.front(), frames[1], frames.back());
    CHECK(frames.front() == Approx(one).epsilon(1e-3));
    for (std::size_t f = 1; f < frames.size(); ++f) CHECK(frames[f] > frames[f - 1] * (1.0 - 1e-3));
    // Each bounce has `one` of the one before's light, since that much of it arrives.
    CHECK(frames.back() == Approx(one / (1.0 - albedo * one)).epsilon(0.1));
}

TEST_CASE("cones: a sky in an empty grid lights every surface with pi times its radiance", "[cone_tracing][long]") {
    TestDevice device(GENERATE(1u, 16u));
    const auto resolution = GENERATE(LW_CONE_RESOLUTION_FULL, LW_CONE_RESOLUTION_HALF, LW_CONE_RESOLUTION_QUARTER,
                                     LW_CONE_RESOLUTION_INTERLEAVED, LW_CONE_RESOLUTION_HALF_INTERLEAVED);
    const ConeBox box(2.0);
    const DrawnView drawn(box.walls, kInside, kWidth, kHeight);
    LWConeTracingDesc desc = coneDesc(32, LW_VOXEL_MODE_ISOTROPIC, resolution);
    desc.extent = 8.0f;
    LWFrame frame{};
    frame.structSize = sizeof frame;
    for (int c = 0; c < 3; ++c) frame.environment[c] = 0.25f * float(c + 1);
    const std::vector<float> light = renderCones(device, desc, frame, drawn.gbuffer, kWidth, kHeight);
    for (std::size_t i = 0; i < light.size(); ++i) {
        const double expected = kPi * 0.25 * double(i / (kWidth * kHeight) + 1);
        REQUIRE(double(light[i]) == Approx(expected).epsilon(1e-4));
    }
}

TEST_CASE("cones: the thinner a wall between, the more of a lit room's light gets through", "[cone_tracing]") {
    TestDevice device(16);
    // A box with a wall of two faces across the middle; one half's floor is lit, the other half is seen.
    const auto leaked = [&](double thickness) {
        ConeBox box(0.0);
        LitWall floor(64, {-1, -1, -1}, {1 - 0.5 * thickness, 0, 0}, {0, 0, 2}, evenProfile);  // faces +y
        box.triangles.quad({-0.5 * thickness, -1, -1}, {0, 2, 0}, {0, 0, 2});  // faces -x
        box.triangles.quad({0.5 * thickness, -1, -1}, {0, 0, 2}, {0, 2, 0});   // faces +x
        LWFrame frame = box.frame;
        frame.lights = &floor.light;
        frame.lightCount = 1;
        frame.geometry = &box.triangles.geometry;
        ViewScene seen = box.walls;
        seen.quad({0.5 * thickness, -1, -1}, {0, 2, 0}, {0, 0, 2});
        const DrawnView drawn(seen, lookAt({0.9, 0, 0}, {0.6, 0, -1}, 0.6), kWidth, kHeight);
        return meanOf(renderCones(device, coneDesc(32), frame, drawn.gbuffer, kWidth, kHeight));
    };
    const double thin = leaked(0.01), voxel = leaked(0.0625), thick = leaked(0.375);
    CAPTURE(thin, voxel, thick);
    CHECK(thick <= voxel);
    CHECK(voxel <= thin * 1.05);
    CHECK(thin < 0.2);
    CHECK(thick < 0.02);
}

// Opaque from both sides (normal_aware=two_sided): walls must not close the cones that leave them, and sheets must be closed from behind.
TEST_CASE("cones: in a closed box of voxels that are opaque from both sides the irradiance is the walls'", "[cone_tracing]") {
    TestDevice device(16);
    const ConeBox box(2.0, GENERATE(false, true), 1.0, 0.5, 64);
    const DrawnView drawn(box.walls, kInside, kWidth, kHeight);
    LWConeTracingDesc desc = coneDesc(32);
    desc.normalAware = 2;
    const std::vector<float> light = renderCones(device, desc, box.frame, drawn.gbuffer, kWidth, kHeight);
    const auto [least, most] = rangeOf(light);
    const double mean = meanOf(light) / 2.0;
    CAPTURE(mean, least, most);
    CHECK(mean > 0.94);
    CHECK(mean < 1.02);
    CHECK(most < 2.0 * 1.2);
    // In edges: cones that leave along the second wall begin within its voxels, which close them (docs/techniques/cone_tracing.md). Were all lost
    // that lean away from it, half of the irradiance would be left, by symmetry, and in a corner, by two walls, a quarter. The view that sees
    // edges keeps 0.52 and the corner 0.45. The bounds of mean and most are not derived: the least mean that was measured is 0.941.
    CHECK(least > 2.0 * 0.5);
    const DrawnView corner(box.walls, lookAt({-0.7, -0.7, -0.7}, {-1, -1, -1}, 0.9), kWidth, kHeight);
    CHECK(rangeOf(renderCones(device, desc, box.frame, corner.gbuffer, kWidth, kHeight)).first > 2.0 * 0.25);
}

TEST_CASE("cones: a sheet stops from behind what a wall of two faces stops, where voxels are opaque from both sides", "[cone_tracing]") {
    TestDevice device(16);
    // Across the middle of the box, of one half whose floor is lit; the other half is seen.
    const auto seen = [&](bool isWall, std::uint32_t aware) {
        ConeBox box(0.0);
        LitWall floor(64, {-1, -1, -1}, {0.8, 0, 0}, {0, 0, 2}, evenProfile);
        box.triangles.quad({0.03, -1, -1}, {0, 2, 0}, {0, 0, 2});  // faces -x
        if (isWall) box.triangles.quad({0.03, -1, -1}, {0, 0, 2}, {0, 2, 0});
        LWFrame frame = box.frame;
        frame.lights = &floor.light;
        frame.lightCount = 1;
        frame.geometry = &box.triangles.geometry;
        const DrawnView drawn(box.walls, lookAt({0.3, 0.1, 0.9}, {0.9, 0, -1}, 0.6), kWidth, kHeight);
        LWConeTracingDesc desc = coneDesc(32);
        desc.normalAware = aware;
        return meanOf(renderCones(device, desc, frame, drawn.gbuffer, kWidth, kHeight));
    };
    const double open = seen(false, 1), wall = seen(true, 1), sheet = seen(false, 2);
    CAPTURE(open, wall, sheet);
    CHECK(wall < 0.8 * open);
    CHECK(sheet < 1.1 * wall);
}
