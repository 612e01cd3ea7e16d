// Techniques rsm and ssvp with visibility=voxel through the C API: what blocks and what does not, from whichever of a frame's inputs
// voxels are made, and what a host relies on.
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <string>

#include "support/host_image.h"
#include "support/lit_room.h"
#include "support/packed_light.h"
#include "support/points_rig.h"
#include "support/scoped_api.h"
#include "support/walls.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 96, kHeight = 64;
// The same terms added up in another order.
constexpr double kRounding = 3e-6;
// Through a lid, of the open room's light: as ssvp_test.cpp allows of maps.
constexpr double kLeak = 0.001;

double plain(double, double) { return 0.5; }

LWRsmDesc rsmOf(LWRsmVisibility visibility, std::uint32_t interleave = 4) {
    LWRsmDesc desc;
    lwDefaultRsm(&desc);
    desc.visibility = visibility;
    desc.interleave = interleave;
    return desc;
}

LWSsvpDesc ssvpOf(LWVisibility visibility, std::uint32_t bounces, LWOccluders occluders = LW_OCCLUDERS_AUTO) {
    LWSsvpDesc desc;
    lwDefaultSsvp(&desc);
    desc.visibility = visibility;
    desc.bounces = bounces;
    desc.mapSize = 64;
    desc.occluders = occluders;
    return desc;
}

struct Frame {
    std::vector<LWLight> lights;
    LWFrame frame{};
    Frame(const LitFloor& floor, const LWGeometry* geometry, const LWSourceView* source = nullptr) : lights{floor.light} {
        frame.structSize = sizeof frame;
        frame.lights = lights.data();
        frame.lightCount = 1;
        frame.geometry = geometry;
        frame.sourceViews = source;
        frame.sourceViewCount = source ? 1 : 0;
    }
};

// The floor, and blocks that stand in no light's way: so that nothing is in the way.
Walls openScene(double s = 1.0) {
    Walls walls;
    walls.add(Vec{-0.5, 0, 0} * s, Vec{1, 0, 0} * s, Vec{0, 0, 1} * s);
    walls.add(Vec{-0.6, 1.2, -0.1} * s, Vec{1.2, 0, 0} * s, Vec{0, 0, 1.2} * s);
    return walls;
}
Walls lidded(double s = 1.0) {
    Walls walls = openScene(s);
    walls.add(Vec{-0.6, 0.08, -0.1} * s, Vec{1.2, 0, 0} * s, Vec{0, 0, 1.2} * s);
    return walls;
}

std::string choiceOf(TestTechnique& technique, const std::string& name) {
    const LWStats stats = technique.stats();
    for (std::uint32_t i = 0; i < stats.choiceCount; ++i)
        if (name == stats.choices[i].name) return stats.choices[i].reason;
    return "";
}

}  // namespace

TEST_CASE("voxels that are in no light's way change nothing", "[rsm][ssvp][voxels]") {
    TestDevice device(GENERATE(1u, 16u));
    LitFloor floor(64, plain);
    WallAndCeiling scene(kWidth, kHeight);
    TestView view(device, kWidth, kHeight);
    Walls open = openScene();
    const Frame frame(floor, open.describe());
    const auto picture = [&](const auto& desc) {
        TestTechnique technique(device, desc);
        technique.update(frame.frame);
        return technique.render(view, scene.gbuffer);
    };
    CHECK(picture(ssvpOf(LW_VISIBILITY_VOXEL, 1)) == picture(ssvpOf(LW_VISIBILITY_NONE, 1)));
    CHECK(difference(picture(rsmOf(LW_RSM_VISIBILITY_VOXEL, 1)), picture(rsmOf(LW_RSM_VISIBILITY_NONE, 1))) < kRounding);
}

TEST_CASE("a lid over the light leaves next to none, whatever voxels are made of", "[rsm][ssvp][voxels]") {
    TestDevice device(16);
    LitFloor floor(64, plain);
    WallAndCeiling scene(kWidth, kHeight);
    TestView view(device, kWidth, kHeight);
    Walls open = openScene(), closed = lidded();
    const bool asSurfels = GENERATE(true, false);
    const auto describe = [&](Walls& walls, std::uint64_t version) {
        return asSurfels ? walls.describeSurfels(0.01, version) : walls.describe(version);
    };
    const auto check = [&](TestTechnique& technique) {
        technique.update(Frame(floor, describe(open, 1)).frame);
        const double lit = meanOf(technique.render(view, scene.gbuffer));
        technique.update(Frame(floor, describe(closed, 2)).frame);
        CAPTURE(asSurfels, lit);
        CHECK(meanOf(technique.render(view, scene.gbuffer)) < kLeak * lit);
        CHECK(choiceOf(technique, "occluders") ==
              (asSurfels ? "the host's surfels: every voxel that they touch" : "triangles: every voxel that they touch"));
        CHECK(technique.count("clusters_swept") == technique.count("clusters"));
        // The lid gone, all is as before, but for clusters that have settled meanwhile.
        technique.update(Frame(floor, describe(open, 3)).frame);
        CHECK(meanOf(technique.render(view, scene.gbuffer)) == Approx(lit).epsilon(5e-3));
    };
    TestTechnique rsm(device, rsmOf(LW_RSM_VISIBILITY_VOXEL)), ssvp(device, ssvpOf(LW_VISIBILITY_VOXEL, 1));
    check(rsm);
    check(ssvp);
}

TEST_CASE("what the screen shows is voxels, too: a shelf that a view sees", "[rsm][ssvp][voxels]") {
    TestDevice device(16);
    LitFloor floor(64, plain);
    WallAndCeiling scene(kWidth, kHeight);
    constexpr std::uint32_t kShelf = 128;
    PlanarPixels position(kShelf, kShelf, 3), normal(kShelf, kShelf, 3);
    for (std::uint32_t y = 0; y < kShelf; ++y)
        for (std::uint32_t x = 0; x < kShelf; ++x) {
            position.set(x, y, {1.4 * ((x + 0.5) / kShelf - 0.5), 0.08, 1.4 * ((y + 0.5) / kShelf) - 0.2});
            normal.set(x, y, {0, -1, 0});
        }
    LWGBuffer shelf{};
    shelf.structSize = sizeof shelf;
    shelf.position = position.image();
    shelf.normal = normal.image();
    TestView view(device, kWidth, kHeight), below(device, kShelf, kShelf);
    const LWSourceView source{below, &shelf};
    const auto check = [&](TestTechnique& technique) {
        technique.update(Frame(floor, nullptr).frame);
        const double lit = meanOf(technique.render(view, scene.gbuffer));
        technique.update(Frame(floor, nullptr, &source).frame);
        CHECK(meanOf(technique.render(view, scene.gbuffer)) < 0.02 * lit);
        CHECK(choiceOf(technique, "occluders").find("RSM texels and source views") != std::string::npos);
    };
    TestTechnique rsm(device, rsmOf(LW_RSM_VISIBILITY_VOXEL)), ssvp(device, ssvpOf(LW_VISIBILITY_VOXEL, 1, LW_OCCLUDERS_SCREEN));
    check(rsm);
    check(ssvp);
}

TEST_CASE("further bounces come from the first one's maps; no others are drawn", "[ssvp][voxels]") {
    TestDevice device(16);
    LitFloor floor(64, plain);
    WallAndCeiling scene(kWidth, kHeight);
    TestView view(device, kWidth, kHeight);
    Walls room = Walls::room();
    const auto render = [&](std::uint32_t bounces, std::uint64_t maps) {
        TestTechnique technique(device, ssvpOf(LW_VISIBILITY_VOXEL, bounces));
        technique.update(Frame(floor, room.describe()).frame);
        const double light = meanOf(inRoom(technique.render(view, scene.gbuffer), kWidth, kHeight));
        CHECK(technique.count("maps_redrawn") == maps);
        return light;
    };
    const double one = render(1, 0), two = render(2, 8), three = render(3, 16);
    CHECK(two > 1.05 * one);
    CHECK(three > two);
}

TEST_CASE("still frames sweep no cluster and have the same bits; so have ten runs and both widths", "[rsm][ssvp][voxels]") {
    TestDevice wide(16), scalar(1);
    LitFloor floor(64, plain);
    WallAndCeiling scene(kWidth, kHeight);
    Walls room = Walls::room();
    room.add({-0.3, 0.3, 0.1}, {0.5, 0, 0}, {0, 0.1, 0.5});
    const Frame frame(floor, room.describe());
    LWRsmDesc desc = rsmOf(LW_RSM_VISIBILITY_VOXEL);
    const auto fresh = [&](LWDevice device) {
        TestView view(device, kWidth, kHeight);
        TestTechnique technique(device, desc);
        technique.update(frame.frame);
        return technique.render(view, scene.gbuffer);
    };
    const auto first = fresh(wide);
    for (int run = 0; run < 10; ++run) CHECK(fresh(wide) == first);
    CHECK(fresh(scalar) == first);
    TestTechnique technique(wide, desc);
    TestView view(wide, kWidth, kHeight);
    std::vector<float> settled;
    for (int i = 0; i < 14; ++i) {
        technique.update(frame.frame);
        const auto e = technique.render(view, scene.gbuffer);
        if (i > 10) {  // clusters have settled
            CHECK(technique.count("clusters_swept") == 0);
            CHECK(e == settled);
        }
        settled = e;
    }
}

TEST_CASE("nothing is compiled after prewarming, and memory is as estimated, whatever voxels are made of", "[rsm][ssvp][voxels][long]") {
    TestDevice device(16);
    const int source = GENERATE(0, 1, 2);
    LitFloor floor(source == 2 ? 512 : 64, plain);  // so many that lists of them would be missed
    WallAndCeiling scene(kWidth, kHeight);
    TestView view(device, kWidth, kHeight);
    Walls room = Walls::room();
    const LWSourceView seen{view, &scene.gbuffer};
    const Frame frame(floor, source == 0 ? room.describe() : source == 1 ? room.describeSurfels(0.02) : nullptr, &seen);
    const auto check = [&](const char* name, const auto& desc) {
        TestTechnique technique(device, desc);
        REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
        const LWDeviceInfo before = device.info();
        for (int i = 0; i < 3; ++i) {
            technique.update(frame.frame);
            technique.render(view, scene.gbuffer);
        }
        CAPTURE(name, source);
        CHECK(device.info().programsBuilt == before.programsBuilt);
        CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
        LWViewDesc viewDesc{};
        viewDesc.structSize = sizeof viewDesc;
        viewDesc.maxWidth = kWidth;
        viewDesc.maxHeight = kHeight;
        std::uint64_t estimate = 0;
        REQUIRE(lwEstimateFrameMemory(device, name, &desc, &viewDesc, &frame.frame, &estimate) == LW_SUCCESS);
        CHECK(technique.stats().deviceBytes <= estimate);
        CHECK(technique.stats().deviceBytes > estimate / 4);
    };
    check("rsm", rsmOf(LW_RSM_VISIBILITY_VOXEL));
    check("ssvp", ssvpOf(LW_VISIBILITY_VOXEL, 2));
}

TEST_CASE("voxels in another unit of length", "[rsm][voxels]") {
    TestDevice device(16);
    std::vector<float> metres;
    for (const double scale : {1.0, 1024.0, 1.0 / 1024.0}) {
        LitFloor floor(64, plain, scale);
        WallAndCeiling scene(kWidth, kHeight, scale);
        Walls room = Walls::room(scale);
        TestTechnique technique(device, rsmOf(LW_RSM_VISIBILITY_VOXEL));
        TestView view(device, kWidth, kHeight);
        technique.update(Frame(floor, room.describe()).frame);
        const auto e = technique.render(view, scene.gbuffer);
        if (metres.empty()) metres = e;
        CAPTURE(scale);
        CHECK(difference(e, metres) < 1e-5);
    }
}

TEST_CASE("grids of other sizes, and geometry that cannot be, are refused by name", "[rsm][ssvp][voxels]") {
    TestDevice device(16);
    LWTechnique none = nullptr;
    LWRsmDesc rsm = rsmOf(LW_RSM_VISIBILITY_VOXEL);
    rsm.voxels = 48;
    CHECK(lwCreateRsm(device, &rsm, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("voxels") != std::string::npos);
    rsm.voxels = 64;
    setEnum(rsm.visibility, 2);
    CHECK(lwCreateRsm(device, &rsm, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("visibility") != std::string::npos);
    LWSsvpDesc ssvp = ssvpOf(LW_VISIBILITY_VOXEL, 1);
    ssvp.voxels = 16;
    CHECK(lwCreateSsvp(device, &ssvp, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("voxels") != std::string::npos);
    LitFloor floor(64, plain);
    Walls room = Walls::room();
    TestTechnique technique(device, rsmOf(LW_RSM_VISIBILITY_VOXEL));
    LWGeometry broken = *room.describeSurfels(0.1);
    broken.surfelArea = LWImage{};
    const Frame frame(floor, &broken);
    CHECK(lwUpdate(technique, &frame.frame) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("frame.geometry.surfelArea") != std::string::npos);
}

TEST_CASE("a frame refused for triangles that only the grid reaches around leaves the last one whole", "[ssvp][voxels]") {
    TestDevice device(16);
    LitFloor floor(64, plain);
    WallAndCeiling scene(24, 16);
    Walls room = Walls::room();
    const LWSsvpDesc desc = ssvpOf(LW_VISIBILITY_VOXEL, 1, LW_OCCLUDERS_SURFELS);
    TestTechnique technique(device, desc), other(device, desc);
    for (TestTechnique* t : {&technique, &other}) t->update(Frame(floor, room.describeSurfels(0.02)).frame);
    const PointList points = PointList::ofScene(scene);
    const std::vector<float> before = renderPoints(device, other, points).irradiance;
    LWGeometry broken = room.geometry;
    const float vertices[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::uint32_t indices[3] = {0, 1, 3};  // of three
    broken.vertices = vertices;
    broken.indices = indices;
    broken.vertexCount = 3, broken.triangleCount = 1;
    Frame frame(floor, &broken);
    frame.frame.lightCount = 0;
    CHECK(lwUpdate(technique, &frame.frame) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("frame.geometry.indices[2]") != std::string::npos);
    CHECK((renderPoints(device, technique, points).irradiance == before));
    CHECK(meanOf(before) > 0.0);
}
