// What technique ssvp's maps show, by the source of its occluders: shadows, errors, what is drawn anew and when. Some lines over 300: one rig serves all.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/host_image.h"
#include "support/lit_room.h"
#include "support/packed_light.h"
#include "support/scoped_api.h"
#include "support/walls.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 96, kHeight = 64;
// Of the open room with and without shadows. Triangles leave 0.006 to 0.012 with maps of 256^2 (ssvp_test.cpp); discs
// along the edges of walls reach round them.
constexpr double kCorners = 0.02;
// Through a lid: as ssvp_test.cpp allows.
constexpr double kLeak = 0.02;

double plain(double, double) { return 0.5; }

// 1,024 VPLs of each of two sets, each seen by itself: means differ by what both sets leave, and by the second bounce's draws.
constexpr double kMeanByView = 0.02;

LWSsvpDesc descOf(LWOccluders occluders, std::uint32_t bounces, std::uint32_t mapSize = 64) {
    LWSsvpDesc desc;
    lwDefaultSsvp(&desc);
    desc.bounces = bounces;
    desc.mapSize = mapSize;
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

std::vector<float> inRoom(const std::vector<float>& values) { return lightwell::test::inRoom(values, kWidth, kHeight); }

std::string choiceOf(TestTechnique& technique, const std::string& name) {
    const LWStats stats = technique.stats();
    for (std::uint32_t i = 0; i < stats.choiceCount; ++i)
        if (name == stats.choices[i].name) return stats.choices[i].reason;
    return "";
}

// The room's walls and the lid over its floor, as occluders of one kind.
const LWGeometry* describe(Walls& walls, bool asSurfels, std::uint64_t version) {
    return asSurfels ? walls.describeSurfels(0.01, version) : walls.describe(version);
}

}  // namespace

TEST_CASE("surfels: an open room blocks nothing, a lid blocks all", "[ssvp][surfels]") {
    TestDevice device(GENERATE(1u, 16u));
    LitFloor floor(64, plain);
    WallAndCeiling scene(kWidth, kHeight);
    const bool asSurfels = GENERATE(true, false);
    LWSsvpDesc desc = descOf(LW_OCCLUDERS_SURFELS, 1, 256), unshadowed = desc;
    unshadowed.visibility = LW_VISIBILITY_NONE;
    TestTechnique technique(device, desc), bare(device, unshadowed);
    TestView view(device, kWidth, kHeight);
    Walls room = Walls::room();
    technique.update(Frame(floor, describe(room, asSurfels, 1)).frame);
    CHECK(choiceOf(technique, "occluders") ==
          (asSurfels ? "the host's surfels, splatted" : "triangles, sampled to surfels by area and splatted"));
    bare.update(Frame(floor, room.describe(1)).frame);
    const auto open = technique.render(view, scene.gbuffer);
    CAPTURE(asSurfels);
    CHECK(difference(inRoom(open), inRoom(bare.render(view, scene.gbuffer))) < kCorners);
    Walls closed = Walls::room();
    closed.add({-0.6, 0.05, -0.1}, {1.2, 0, 0}, {0, 0, 1.2});
    technique.update(Frame(floor, describe(closed, asSurfels, 2)).frame);
    CHECK(meanOf(technique.render(view, scene.gbuffer)) < kLeak * meanOf(open));
}

TEST_CASE("the second bounce of surfels is that of triangles", "[ssvp][surfels]") {
    TestDevice device(16);
    LitFloor floor(64, plain);
    WallAndCeiling scene(kWidth, kHeight);
    Walls room = Walls::room(), covered = Walls::room();
    TestView view(device, kWidth, kHeight);
    TestTechnique one(device, descOf(LW_OCCLUDERS_TRIANGLES, 1, 128)), two(device, descOf(LW_OCCLUDERS_TRIANGLES, 2, 128)),
        surfels(device, descOf(LW_OCCLUDERS_SURFELS, 2, 128));
    one.update(Frame(floor, room.describe()).frame);
    two.update(Frame(floor, room.describe()).frame);
    surfels.update(Frame(floor, covered.describeSurfels(0.02)).frame);
    const double direct = meanOf(inRoom(one.render(view, scene.gbuffer)));
    const double expected = meanOf(inRoom(two.render(view, scene.gbuffer))) - direct;
    CHECK(expected > 0.05 * direct);
    CHECK(meanOf(inRoom(surfels.render(view, scene.gbuffer))) - direct == Approx(expected).epsilon(0.03));
}

TEST_CASE("what the screen shows casts shadows: a shelf that the view sees", "[ssvp][surfels]") {
    TestDevice device(GENERATE(1u, 16u));
    LitFloor floor(64, plain);
    WallAndCeiling scene(kWidth, kHeight);
    // A view from below of a shelf a little above the floor, as occluder alone.
    constexpr std::uint32_t kShelf = 128;
    PlanarPixels position(kShelf, kShelf, 3), normal(kShelf, kShelf, 3);
    for (std::uint32_t y = 0; y < kShelf; ++y)
        for (std::uint32_t x = 0; x < kShelf; ++x) {
            position.set(x, y, {1.4 * ((x + 0.5) / kShelf - 0.5), 0.05, 1.4 * ((y + 0.5) / kShelf) - 0.2});
            normal.set(x, y, {0, -1, 0});
        }
    LWGBuffer shelf{};
    shelf.structSize = sizeof shelf;
    shelf.position = position.image();
    shelf.normal = normal.image();
    TestView view(device, kWidth, kHeight), below(device, kShelf, kShelf);
    const LWSourceView source{below, &shelf};
    TestTechnique technique(device, descOf(GENERATE(LW_OCCLUDERS_AUTO, LW_OCCLUDERS_SCREEN), 1, 128));
    technique.update(Frame(floor, nullptr).frame);
    CHECK(choiceOf(technique, "occluders") == "RSM texels and source views, splatted anew in every frame");
    const auto open = technique.render(view, scene.gbuffer);
    LWSsvpDesc none = descOf(LW_OCCLUDERS_AUTO, 1);
    none.visibility = LW_VISIBILITY_NONE;
    TestTechnique bare(device, none);
    bare.update(Frame(floor, nullptr).frame);
    CHECK(difference(open, bare.render(view, scene.gbuffer)) < 1e-3);  // the floor does not shadow itself
    technique.update(Frame(floor, nullptr, &source).frame);
    CHECK(meanOf(technique.render(view, scene.gbuffer)) < kLeak * meanOf(open));
    CHECK(technique.count("surfels") == 64 * 64 + kShelf * kShelf);
}

TEST_CASE("a still frame redraws no map of surfels, and every map of the screen, with the same bits", "[ssvp][surfels]") {
    TestDevice device(16);
    LitFloor floor(64, plain);
    WallAndCeiling scene(kWidth, kHeight);
    Walls room = Walls::room();
    const auto [occluders, asSurfels] = GENERATE(std::pair{LW_OCCLUDERS_SURFELS, true}, std::pair{LW_OCCLUDERS_SURFELS, false},
                                                 std::pair{LW_OCCLUDERS_SCREEN, false});
    TestTechnique technique(device, descOf(occluders, 2));
    TestView view(device, kWidth, kHeight);
    const LWSourceView source{view, &scene.gbuffer};
    const Frame still(floor, describe(room, asSurfels, 1), &source);
    std::vector<float> settled;
    for (int i = 0; i < 16; ++i) {
        technique.update(still.frame);
        const auto e = technique.render(view, scene.gbuffer);
        if (i < 10) {  // clusters settle
            settled = e;
            continue;
        }
        CHECK(e == settled);
        CHECK(technique.count("maps_redrawn") == (occluders == LW_OCCLUDERS_SCREEN ? 16 : 0));
    }
    technique.update(Frame(floor, describe(room, asSurfels, 2), &source).frame);
    CHECK(technique.render(view, scene.gbuffer) == settled);
    // Of surfels it is not known which changed; triangles, the same ones again, are not even sampled anew.
    CHECK(technique.count("maps_redrawn") == (occluders == LW_OCCLUDERS_SURFELS && !asSurfels ? 0 : 16));
}

TEST_CASE("auto takes triangles before surfels before the screen, from frame to frame", "[ssvp][surfels]") {
    TestDevice device(16);
    LitFloor floor(64, plain);
    WallAndCeiling scene(kWidth, kHeight);
    Walls triangles = Walls::room(), surfels = Walls::room();
    TestView view(device, kWidth, kHeight);
    // Clusters anew in every frame, so that a technique's past does not show.
    LWSsvpDesc desc = descOf(LW_OCCLUDERS_AUTO, 2);
    desc.warmStart = 0;
    TestTechnique technique(device, desc);
    const auto renderOf = [&](const LWGeometry* geometry, LWOccluders expected) {
        technique.update(Frame(floor, geometry).frame);
        desc.occluders = expected;
        TestTechnique fresh(device, desc);
        fresh.update(Frame(floor, geometry).frame);
        CHECK(technique.count("maps_redrawn") == 16);
        return std::pair{technique.render(view, scene.gbuffer), fresh.render(view, scene.gbuffer)};
    };
    LWGeometry both = *surfels.describeSurfels(0.05);
    const LWGeometry own = *triangles.describe();
    both.triangleCount = own.triangleCount;
    both.vertices = own.vertices;
    both.vertexCount = own.vertexCount;
    for (int i = 0; i < 2; ++i) {
        const auto [a, b] = renderOf(&both, LW_OCCLUDERS_TRIANGLES);
        CHECK(a == b);
        const auto [c, d] = renderOf(surfels.describeSurfels(0.05, std::uint64_t(2 + i)), LW_OCCLUDERS_SURFELS);
        CHECK(c == d);
        const auto [e, f] = renderOf(nullptr, LW_OCCLUDERS_SCREEN);
        CHECK(e == f);
    }
}

TEST_CASE("occluders that a frame does not bring are refused by name, and the last frame stays in force", "[ssvp][surfels]") {
    TestDevice device(16);
    LitFloor floor(64, plain);
    Walls room = Walls::room();
    const auto refused = [&](LWOccluders occluders, const LWFrame& frame) {
        TestTechnique technique(device, descOf(occluders, 2));
        CHECK(lwUpdate(technique, &frame) == LW_ERROR_INVALID_ARGUMENT);
        return lastError(device);
    };
    const Frame bare(floor, nullptr);
    CHECK(refused(LW_OCCLUDERS_TRIANGLES, bare.frame).find("occluders=triangles") != std::string::npos);
    CHECK(refused(LW_OCCLUDERS_SURFELS, bare.frame).find("frame.geometry: expected surfels or triangles") != std::string::npos);
    CHECK(refused(LW_OCCLUDERS_TRIANGLES, Frame(floor, room.describeSurfels(0.1)).frame).find("expected triangles") !=
          std::string::npos);
    LWVpl vpl{};
    vpl.normal[1] = 1.0f;
    LWFrame authored{};
    authored.structSize = sizeof authored;
    authored.vpls = &vpl;
    authored.vplCount = 1;
    CHECK(refused(LW_OCCLUDERS_SCREEN, authored).find("frame: expected RSMs or sourceViews") != std::string::npos);
    LWGeometry broken = *room.describeSurfels(0.1);
    broken.surfelArea = LWImage{};
    CHECK(refused(LW_OCCLUDERS_AUTO, Frame(floor, &broken).frame).find("frame.geometry.surfelArea") != std::string::npos);
    LWSsvpDesc desc = descOf(LW_OCCLUDERS_AUTO, 2);
    setEnum(desc.occluders, 4);
    LWTechnique none = nullptr;
    CHECK(lwCreateSsvp(device, &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("occluders") != std::string::npos);
}

TEST_CASE("nothing is compiled after prewarming, and memory is as estimated, whatever the occluders", "[ssvp][surfels][long]") {
    TestDevice device(16);
    LitFloor floor(64, plain);
    WallAndCeiling scene(kWidth, kHeight);
    const auto [occluders, asSurfels] =
        GENERATE(std::pair{LW_OCCLUDERS_AUTO, true}, std::pair{LW_OCCLUDERS_AUTO, false},
                 std::pair{LW_OCCLUDERS_SURFELS, true}, std::pair{LW_OCCLUDERS_SURFELS, false}, std::pair{LW_OCCLUDERS_SCREEN, false});
    const LWSsvpDesc desc = descOf(occluders, 2);
    TestTechnique technique(device, desc);
    TestView view(device, kWidth, kHeight);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    Walls room = Walls::room();
    const LWSourceView source{view, &scene.gbuffer};
    const Frame frame(floor, describe(room, asSurfels, 1), &source);
    technique.update(frame.frame);
    technique.render(view, scene.gbuffer);
    if (occluders == LW_OCCLUDERS_AUTO) {
        technique.update(Frame(floor, nullptr, &source).frame);
        technique.render(view, scene.gbuffer);
    }
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
    TestTechnique fresh(device, desc);
    fresh.update(frame.frame);
    fresh.render(view, scene.gbuffer);
    LWViewDesc viewDesc{};
    viewDesc.structSize = sizeof viewDesc;
    viewDesc.maxWidth = kWidth;
    viewDesc.maxHeight = kHeight;
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateFrameMemory(device, "ssvp", &desc, &viewDesc, &frame.frame, &estimate) == LW_SUCCESS);
    CHECK(fresh.stats().deviceBytes <= estimate);
    CHECK(fresh.stats().deviceBytes > estimate / 4);
}

TEST_CASE("surfels and screen in another unit of length", "[ssvp][surfels]") {
    TestDevice device(16);
    const bool isScreen = GENERATE(false, true);
    std::vector<float> metres;
    for (const double scale : {1.0, 1024.0, 1.0 / 1024.0}) {
        LitFloor floor(64, plain, scale);
        WallAndCeiling scene(kWidth, kHeight, scale);
        Walls room = Walls::room(scale);
        TestTechnique technique(device, descOf(isScreen ? LW_OCCLUDERS_SCREEN : LW_OCCLUDERS_SURFELS, 2));
        TestView view(device, kWidth, kHeight);
        const LWSourceView source{view, &scene.gbuffer};
        technique.update(Frame(floor, room.describe(), &source).frame);
        const auto e = technique.render(view, scene.gbuffer);
        if (metres.empty()) metres = e;
        CAPTURE(isScreen, scale);
        CHECK(difference(e, metres) < 1e-5);
    }
}

TEST_CASE("VPLs chosen for source views are lit with maps of any kind, and refused without views", "[ssvp][sampling]") {
    TestDevice device(16);
    LitFloor floor(64, plain);
    WallAndCeiling scene(kWidth, kHeight);
    TestView view(device, kWidth, kHeight);
    const LWSourceView source{view, &scene.gbuffer};
    Walls room = Walls::room();
    LWSsvpDesc desc = descOf(LW_OCCLUDERS_AUTO, 2);
    desc.vpls = 1024;
    desc.clusters = 0;
    const auto meanBy = [&](LWVplSampling sampling) {
        desc.sampling = sampling;
        TestTechnique technique(device, desc);
        technique.update(Frame(floor, room.describe(1), &source).frame);
        return meanOf(technique.render(view, scene.gbuffer));
    };
    CHECK(meanBy(LW_SAMPLING_VIEW) == Approx(meanBy(LW_SAMPLING_FLUX)).epsilon(kMeanByView));
    desc.clusters = 8;
    desc.sampling = LW_SAMPLING_VIEW;
    desc.autoError = 0.1f;
    TestTechnique technique(device, desc);
    technique.update(Frame(floor, room.describe(1), &source).frame);
    CHECK(choiceOf(technique, "vpls_used") == "the most: only VPLs drawn by flux are chosen");
    CHECK(choiceOf(technique, "frame.sourceViews").empty());
    const Frame bare(floor, room.describe(1));
    CHECK(lwUpdate(technique, &bare.frame) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("frame.sourceViews: expected") != std::string::npos);
    desc.compensation = 4;
    LWTechnique none = nullptr;
    CHECK(lwCreateTechnique(device, "ssvp", &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("desc.compensation: expected 0") != std::string::npos);
}
