// Technique static_vpl's visibility: a plate between VPLs and walls, rooms that are open or shut, who
// shares what, refusals. The oracle asks whether a VPL's ray crosses the plate, in double precision.
#include <catch2/catch.hpp>

#include "support/static_vpl_plates.h"

using namespace lightwell::test;
using namespace lightwell::test::plates;

TEST_CASE("static_vpl: a plate shadows what the rays through it would light", "[static_vpl][shadows]") {
    const LWVisibility visibility =
        GENERATE(LW_VISIBILITY_HARD, LW_VISIBILITY_SOFT, LW_VISIBILITY_VOXEL, LW_VISIBILITY_STRICT);
    LWStaticVplDesc desc = descOf(visibility, 256);
    desc.voxels = 128;
    StaticRig rig(GENERATE(1u, 16u), desc);
    WallAndCeiling view(kWidth, kHeight);
    TestView target(rig.device, kWidth, kHeight);
    Walls walls = withPlate();
    const std::size_t count = visibility == LW_VISIBILITY_VOXEL ? 1 : 4;
    rig.update(litFloor(count, walls.describe()));
    const auto e = rig.technique.render(target, view.gbuffer);
    const auto vpls = rig.vpls();
    REQUIRE(vpls.size() == count);
    // Texels reach so far across the border; past voxels an edge's light is a mean over neighbours, again
    // and again on its way.
    const double border = visibility == LW_VISIBILITY_VOXEL ? 0.12 : 0.03,
                 tolerance = visibility == LW_VISIBILITY_VOXEL ? 0.03 : kRounding;
    int clear = 0, shadowed = 0, doubted = 0;
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = 1; x < kWidth; ++x) {
            const glm::dvec3 p = at(view.position, x, y), n = at(view.normal, x, y);
            double expected = 0.0, open = 0.0;
            bool isClear = true;
            for (const auto& vpl : vpls) {
                const double inside = within(vpl.position, p), light = twinLight(vpl, p, n);
                isClear = isClear && std::abs(inside) > border;
                open += light;
                if (inside < 0.0) expected += light;
            }
            if (!isClear) continue;
            ++clear;
            if (expected < open) ++shadowed;
            CAPTURE(x, y, open);
            // Strict: as with hard maps, but for what is doubted, beside edges and in corners: less.
            const bool isDoubted = visibility == LW_VISIBILITY_STRICT && double(e[y * kWidth + x]) < expected * (1.0 - tolerance);
            doubted += isDoubted;
            if (isDoubted) continue;
            REQUIRE(double(e[y * kWidth + x]) ==
                    Approx(expected).epsilon(tolerance).margin(tolerance * open + 1e-7));
        }
    CHECK(clear > 500);
    CHECK(doubted < clear / 4);
    CHECK(shadowed > (visibility == LW_VISIBILITY_VOXEL ? 40 : 100));
}

TEST_CASE("static_vpl: where nothing stands, shadows change no bit", "[static_vpl][shadows]") {
    WallAndCeiling view(kWidth, kHeight);
    Walls walls = open();
    const StaticScene scene = litFloor(20, walls.describe());
    LWStaticVplDesc desc = descOf(GENERATE(LW_VISIBILITY_HARD, LW_VISIBILITY_SOFT));
    desc.bounces = GENERATE(1u, 2u);
    desc.secondDistance = 0.6f;
    desc.shadowedBounces = GENERATE(1u, 2u);
    LWStaticVplDesc off = desc;
    off.visibility = LW_VISIBILITY_NONE;
    for (const std::uint32_t width : {1u, 16u}) {
        CAPTURE(width, desc.bounces);
        CHECK(bitDifference(render(width, desc, scene, view), render(width, off, scene, view)) == "");
    }
}

TEST_CASE("static_vpl: walls shadow no wall, but for a texel where two of them meet",
          "[static_vpl][shadows]") {
    WallAndCeiling view(kWidth, kHeight);
    Walls room = Walls::room();
    const StaticScene scene = litFloor(20, room.describe());
    const LWStaticVplDesc desc = descOf(LW_VISIBILITY_HARD), off = staticDesc();
    const auto e = render(16, desc, scene, view), expected = render(16, off, scene, view);
    // A texel of 128 along a side sees 0.04 rad, and the walls from a metre and at a slant.
    constexpr double kMargin = 0.12;
    int compared = 0;
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = 1; x < kWidth; ++x) {
            const glm::dvec3 p = at(view.position, x, y), n = at(view.normal, x, y);
            const double along = n.z > 0.5 ? p.y : p.z;
            if (std::abs(p.x) > 0.5 - kMargin || along < kMargin || along > 1.0 - kMargin) continue;
            ++compared;
            CAPTURE(x, y);
            REQUIRE(e[y * kWidth + x] == expected[y * kWidth + x]);
        }
    CHECK(compared > 600);
}

TEST_CASE("static_vpl: a lid leaves the dark, phantoms' too", "[static_vpl][shadows]") {
    WallAndCeiling view(kWidth, kHeight);
    const bool asSurfels = GENERATE(false, true);
    Walls room = Walls::room(), lid = shut();
    const LWVisibility visibility = GENERATE(LW_VISIBILITY_HARD, LW_VISIBILITY_VOXEL);
    LWStaticVplDesc desc = descOf(visibility);
    desc.variant = LW_STATIC_VPL_PHANTOM;
    const float hit[3] = {0.1f, 0, 0.5f};
    const auto picture = [&](Walls& walls) {
        StaticScene scene = litFloor(20, asSurfels ? walls.describeSurfels(0.02) : walls.describe());
        scene.lights.push_back(spotLight({0.1, 0.04, 0.5}, {0, -1, 0}, {1, 1, 1}, 0.1, 0.4));
        scene.lights.back().hit = hit;
        StaticRig rig(16, desc);
        TestView target(rig.device, kWidth, kHeight);
        rig.update(scene);
        CHECK(rig.technique.count("phantom_vpls") == 1);
        CHECK(rig.technique.count("shadowed_vpls") == 21);
        return rig.technique.render(target, view.gbuffer);
    };
    CHECK(meanOf(picture(lid)) < 0.02 * meanOf(picture(room)));
}

TEST_CASE("static_vpl: VPLs opposite others are shadowed where that is asked for",
          "[static_vpl][shadows]") {
    WallAndCeiling view(kWidth, kHeight);
    Walls walls = open();
    const StaticScene scene = litFloor(20, walls.describe());
    LWStaticVplDesc desc = descOf(LW_VISIBILITY_HARD), one = desc;
    desc.bounces = 2;
    const bool outside = GENERATE(false, true);  // opposite lies beyond the ceiling, or before it
    desc.secondDistance = outside ? 2.4f : 0.8f;
    StaticRig rig(16, desc);
    rig.update(scene);
    CHECK(rig.technique.count("shadowed_vpls") == 20);
    CHECK(choiceOf(rig.technique, "shadowed_bounces") == "VPLs opposite others are not shadowed");
    const auto first = render(16, one, scene, view), open = render(16, desc, scene, view);
    desc.shadowedBounces = 2;
    StaticRig all(16, desc);
    all.update(scene);
    CHECK(all.technique.count("shadowed_vpls") == 21);
    CHECK(choiceOf(all.technique, "shadowed_bounces") == "");
    const auto both = render(16, desc, scene, view);
    CHECK(meanOf(open) > 1.01 * meanOf(first));
    CHECK(bitDifference(both, outside ? first : open) == "");
}

TEST_CASE("static_vpl: VPLs beyond the clusters share, and the stats say so", "[static_vpl][shadows]") {
    WallAndCeiling view(kWidth, kHeight);
    Walls walls = withPlate();
    const StaticScene scene = litFloor(64, walls.describe());
    LWStaticVplDesc desc = descOf(LW_VISIBILITY_SOFT);
    desc.clusters = 64;
    StaticRig own(16, desc);
    TestView target(own.device, kWidth, kHeight);
    own.update(scene);
    CHECK(choiceOf(own.technique, "clusters") == "every VPL sees for itself");
    CHECK(own.technique.count("clusters") == 64);
    CHECK(own.technique.count("maps_redrawn") == own.technique.count("kept_vpls"));
    own.update(scene);
    CHECK(own.technique.count("maps_redrawn") == 0);
    const auto exact = own.technique.render(target, view.gbuffer);
    double before = 1.0;
    for (const std::uint32_t clusters : {4u, 16u, 32u}) {
        desc.clusters = clusters;
        StaticRig shared(16, desc);
        TestView sharedTarget(shared.device, kWidth, kHeight);
        shared.update(scene);
        CHECK(choiceOf(shared.technique, "clusters") ==
              "more VPLs than clusters: those of a cluster share what its middle one sees");
        CHECK(shared.technique.count("clusters") == clusters);
        const double error = difference(shared.technique.render(sharedTarget, view.gbuffer), exact);
        CAPTURE(clusters, error);
        CHECK(error < before);
        before = error;
    }
    CHECK(before < 0.1);
    desc.clusters = 0;
    CHECK(bitDifference(render(16, desc, scene, view), exact) == "");
}

TEST_CASE("static_vpl: what stands in the way may move, come and go", "[static_vpl][shadows]") {
    WallAndCeiling view(kWidth, kHeight);
    Walls left = withPlate(), right = withPlate(-0.4), none = open();
    const int kind = GENERATE(0, 1, 2);
    LWStaticVplDesc desc = descOf(kind < 2 ? LW_VISIBILITY_HARD : LW_VISIBILITY_VOXEL);
    desc.clusters = kind == 1 ? 8 : 0;
    StaticRig rig(16, desc);
    TestView target(rig.device, kWidth, kHeight);
    std::uint64_t version = 0;
    for (Walls* walls : {&left, &right, &none, &left}) {
        const StaticScene scene = litFloor(20, walls->describe(++version));
        rig.update(scene);
        rig.update(scene);  // clusters come to rest
        const auto moved = rig.technique.render(target, view.gbuffer);
        StaticRig fresh(16, desc);
        TestView freshTarget(fresh.device, kWidth, kHeight);
        fresh.update(scene);
        fresh.update(scene);
        const auto anew = fresh.technique.render(freshTarget, view.gbuffer);
        if (desc.clusters == 0) CHECK(bitDifference(moved, anew) == "");
        CHECK(difference(moved, anew) < 0.02);
    }
}

TEST_CASE("static_vpl: shadows without geometry are refused", "[static_vpl][shadows]") {
    Walls walls = Walls::room(), surfels = Walls::room();
    const auto refusal = [&](LWVisibility visibility, LWOccluders occluders,
                             const LWGeometry* geometry) {
        LWStaticVplDesc desc = descOf(visibility);
        desc.occluders = occluders;
        StaticRig rig(16, desc);
        const LWStatus status = rig.tryUpdate(litFloor(3, geometry));
        if (status == LW_SUCCESS) return std::string();
        CHECK(status == LW_ERROR_INVALID_ARGUMENT);
        return lastError(rig.device);
    };
    for (const LWVisibility visibility : {LW_VISIBILITY_HARD, LW_VISIBILITY_VOXEL}) {
        CHECK_THAT(refusal(visibility, LW_OCCLUDERS_AUTO, nullptr),
                   Catch::Contains("frame.geometry: expected triangles or surfels, as the technique's "
                                   "parameter visibility"));
        CHECK_THAT(refusal(visibility, LW_OCCLUDERS_SURFELS, nullptr),
                   Catch::Contains("occluders=surfels"));
        CHECK_THAT(refusal(visibility, LW_OCCLUDERS_TRIANGLES, surfels.describeSurfels(0.05)),
                   Catch::Contains("occluders=triangles"));
        CHECK(refusal(visibility, LW_OCCLUDERS_AUTO, surfels.describeSurfels(0.05)) == "");
        CHECK(refusal(visibility, LW_OCCLUDERS_SURFELS, walls.describe()) == "");
    }
    CHECK(refusal(LW_VISIBILITY_NONE, LW_OCCLUDERS_AUTO, nullptr) == "");
    LWStaticVplDesc desc = descOf(LW_VISIBILITY_HARD);
    desc.occluders = LW_OCCLUDERS_SCREEN;
    TestDevice device(16);
    LWTechnique technique = nullptr;
    CHECK(lwCreateStaticVpl(device, &desc, &technique) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Catch::Contains("occluders"));
}
