// Technique ssvp through the C API: what walls block and what they don't, bounces, bad cases, and what a
// host relies on. Some lines over 300: one rig serves all.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/lit_room.h"
#include "support/packed_light.h"
#include "support/scoped_api.h"
#include "support/walls.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 96, kHeight = 64;
// The same VPLs in another order of summation.
constexpr double kRounding = 1e-5;
// Pixels within half a texel of a corner may read the texel round it: root mean square 0.05 to 0.07 with
// maps of 64^2, 0.006 to 0.012 with 256^2, nothing but the rows beside the ceiling with 512^2.
constexpr double kCorners = 0.015;
// What the issue allows through a closed wall.
constexpr double kLeak = 0.02;

double tiledProfile(double x, double z) {
    return (int(std::floor(x * 5.0)) + int(std::floor(z * 5.0))) % 2 != 0 ? 0.2 : 0.8;
}

LWSsvpDesc descOf(std::uint32_t clusters, std::uint32_t bounces) {
    LWSsvpDesc desc;
    lwDefaultSsvp(&desc);
    desc.clusters = clusters;
    desc.bounces = bounces;
    desc.mapSize = 64;
    return desc;
}

LWFrame frameOf(const std::vector<LWLight>& lights, const LWGeometry* geometry) {
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.lightCount = std::uint32_t(lights.size());
    frame.lights = lights.data();
    frame.geometry = geometry;
    return frame;
}

std::vector<float> render(LWDevice device, const LWSsvpDesc& desc, const std::vector<LWLight>& lights,
                          const LWGeometry* geometry, const WallAndCeiling& scene) {
    TestTechnique technique(device, desc);
    TestView view(device, scene.position.width(), scene.position.height());
    technique.update(frameOf(lights, geometry));
    return technique.render(view, scene.gbuffer);
}

std::vector<float> inRoom(const std::vector<float>& values) { return lightwell::test::inRoom(values, kWidth, kHeight); }

bool areFinite(const std::vector<float>& values) {
    return std::all_of(values.begin(), values.end(),
                       [](float v) { return std::isfinite(v) && v >= 0.0f; });
}

}  // namespace

TEST_CASE("without maps it is rsm, and says so", "[ssvp]") {
    TestDevice device(GENERATE(1u, 16u));
    LitFloor floor(64, tiledProfile);
    WallAndCeiling scene(kWidth, kHeight);
    LWSsvpDesc desc = descOf(8, 1);
    desc.visibility = LW_VISIBILITY_NONE;
    desc.interleave = desc.clusterGroups = 1;
    LWRsmDesc plain;
    lwDefaultRsm(&plain);
    plain.interleave = 1;
    TestTechnique rsm(device, plain), ssvp(device, desc);
    TestView view(device, kWidth, kHeight);
    rsm.update({floor.light});
    ssvp.update({floor.light});
    const auto expected = rsm.render(view, scene.gbuffer);
    CHECK(difference(ssvp.render(view, scene.gbuffer), expected) < kRounding);
    SECTION("interleaved, it is as far from it as rsm is") {
        plain.interleave = desc.interleave = 4;
        desc.clusterGroups = GENERATE(1u, 4u);
        TestTechnique rsmDealt(device, plain), ssvpDealt(device, desc);
        rsmDealt.update({floor.light});
        ssvpDealt.update({floor.light});
        const auto dealt = ssvpDealt.render(view, scene.gbuffer), rsmsDealt = rsmDealt.render(view, scene.gbuffer);
        CAPTURE(desc.clusterGroups);
        CHECK(difference(dealt, expected) < 1.5 * difference(rsmsDealt, expected));
    }
    const LWStats stats = ssvp.stats();
    CHECK(std::any_of(stats.choices, stats.choices + stats.choiceCount, [](const LWChoice& choice) {
        return std::string(choice.name) == "occluders" && std::string(choice.reason).find("none") == 0;
    }));
}

TEST_CASE("an open room blocks nothing, a lid blocks all", "[ssvp]") {
    TestDevice device(GENERATE(1u, 16u));
    LitFloor floor(64, tiledProfile);
    WallAndCeiling scene(kWidth, kHeight);
    LWSsvpDesc desc = descOf(GENERATE(1u, 8u, 0u), GENERATE(1u, 2u));
    desc.vpls = 64;
    desc.mapSize = 256;
    desc.visibility = GENERATE(LW_VISIBILITY_HARD, LW_VISIBILITY_SOFT, LW_VISIBILITY_STRICT);  // careful: ssvp_careful_test
    Walls room = Walls::room();
    LWSsvpDesc unshadowed = desc;
    unshadowed.visibility = LW_VISIBILITY_NONE;
    const auto open = render(device, desc, {floor.light}, room.describe(), scene);
    // Every pixel lies on a wall of the convex room and sees all of the floor: the maps must not cast
    // shadows of the walls upon themselves. (But for the view's first rows, which lie above the
    // ceiling.) Second-bounce VPLs lie in the corners themselves, where texels reach round: 0.026.
    if (desc.bounces == 1) {
        const auto through = render(device, unshadowed, {floor.light}, room.describe(), scene);
        CHECK(difference(inRoom(open), inRoom(through)) < kCorners);
    }
    Walls closed = Walls::room();
    closed.add({-0.6, 0.05, -0.1}, {1.2, 0, 0}, {0, 0, 1.2});
    const auto dark = render(device, desc, {floor.light}, closed.describe(), scene);
    CAPTURE(desc.clusters, desc.visibility, meanOf(open), meanOf(dark));
    CHECK(meanOf(dark) < kLeak * meanOf(open));
}

TEST_CASE("strict: light past rims counts less, and no light more, than with hard maps", "[ssvp]") {
    TestDevice device(GENERATE(1u, 16u));
    LitFloor floor(64, tiledProfile);
    WallAndCeiling scene(kWidth, kHeight);
    LWSsvpDesc desc = descOf(8, GENERATE(1u, 2u));
    desc.vpls = 64;
    desc.occluders = GENERATE(LW_OCCLUDERS_TRIANGLES, LW_OCCLUDERS_SURFELS, LW_OCCLUDERS_SCREEN);
    desc.interleave = GENERATE(1u, 4u);
    Walls room = Walls::room();
    room.add({-0.2, 0.3, 0.2}, {0.4, 0, 0}, {0, 0, 0.4});
    const auto hard = render(device, desc, {floor.light}, room.describe(), scene);
    desc.visibility = LW_VISIBILITY_STRICT;
    const auto strict = render(device, desc, {floor.light}, room.describe(), scene);
    REQUIRE(strict.size() == hard.size());
    int less = 0, more = 0;
    for (std::size_t i = 0; i < hard.size(); ++i) {
        less += strict[i] < 0.99f * hard[i];
        more += strict[i] > 1.0001f * hard[i];
    }
    CAPTURE(desc.bounces, int(desc.occluders), desc.interleave, less, meanOf(hard), meanOf(strict));
    CHECK(more == 0);
    // What RSM texels show, the floor alone, hides nothing of it.
    if (desc.occluders == LW_OCCLUDERS_SCREEN) {
        CHECK(meanOf(strict) == Approx(meanOf(hard)).epsilon(0.01));
    } else {
        CHECK(less > 50);
        CHECK(meanOf(strict) > 0.8 * meanOf(hard));
    }
}

TEST_CASE("the second bounce adds what a closed room reflects", "[ssvp]") {
    TestDevice device(GENERATE(1u, 16u));
    LitFloor floor(64, tiledProfile);
    WallAndCeiling scene(kWidth, kHeight);
    Walls room = Walls::room();
    const auto one = render(device, descOf(8, 1), {floor.light}, room.describe(), scene);
    double last = 0.0;
    for (const float albedo : {0.25f, 0.5f}) {
        std::vector<float> colours(room.vertices.size() / 3, albedo);
        room.geometry.triangleAlbedo = colours.data();
        const auto two = render(device, descOf(8, 2), {floor.light},
                                room.describe(std::uint64_t(albedo * 100)), scene);
        const double added = meanOf(two) - meanOf(one);
        CHECK(added > 0.0);
        if (last > 0.0)
            CHECK(added ==
                  Approx(2.0 * last).epsilon(2e-3));  // in proportion to the albedo, which is packed
        last = added;
        room.geometry.triangleAlbedo = nullptr;
    }
}

TEST_CASE("a still frame redraws no map, and ten have the same bits", "[ssvp]") {
    TestDevice device(16);
    LitFloor floor(64, tiledProfile);
    WallAndCeiling scene(kWidth, kHeight);
    Walls room = Walls::room();
    TestTechnique technique(device, descOf(8, 2));
    TestView view(device, kWidth, kHeight);
    const LWFrame frame = frameOf({floor.light}, room.describe());
    std::vector<LWLight> lights{floor.light};
    LWFrame still = frame;
    still.lights = lights.data();
    std::vector<float> settled;
    for (int i = 0; i < 20; ++i) {
        technique.update(still);
        const auto e = technique.render(view, scene.gbuffer);
        if (i < 10) {  // clusters settle
            settled = e;
            continue;
        }
        CHECK(e == settled);
        CHECK(technique.count("maps_redrawn") == 0);
    }
    still.geometry = room.describe(2);  // another version of the same
    technique.update(still);
    CHECK(technique.render(view, scene.gbuffer) == settled);
    CHECK(technique.count("maps_redrawn") == 0);
}

TEST_CASE("nothing is compiled after prewarming", "[ssvp]") {
    TestDevice device(16);
    LitFloor floor(64, tiledProfile);
    WallAndCeiling scene(kWidth, kHeight);
    Walls room = Walls::room();
    LWSsvpDesc desc = descOf(8, 2);
    desc.resolution = GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_QUARTER);
    TestTechnique technique(device, desc);
    TestView view(device, kWidth, kHeight);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    std::vector<LWLight> lights{floor.light};
    for (int i = 0; i < 4; ++i) {
        LWFrame frame = frameOf(lights, i % 2 ? nullptr : room.describe(std::uint64_t(i + 1)));
        frame.reset = i == 2;
        technique.update(frame);
        technique.render(view, scene.gbuffer);
    }
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
}

TEST_CASE("no VPL, one, all at one place, light behind a wall: finite light, no more than there is",
          "[ssvp]") {
    TestDevice device(16);
    WallAndCeiling scene(kWidth, kHeight);
    Walls room = Walls::room();
    LWSsvpDesc desc = descOf(GENERATE(8u, 0u), 2);
    TestTechnique technique(device, desc);
    TestView view(device, kWidth, kHeight);
    technique.update(frameOf({}, room.describe()));
    const auto dark = technique.render(view, scene.gbuffer);
    CHECK(meanOf(dark) == 0.0);
    std::vector<LWVpl> vpls(20);
    for (LWVpl& v : vpls) {
        v.position[1] = 0.001f;
        v.position[2] = 0.5f;
        v.normal[1] = 1.0f;
        v.area = 0.01f;
        std::fill(std::begin(v.flux), std::end(v.flux), 1.0f);
    }
    LWFrame frame = frameOf({}, room.describe());
    frame.vpls = vpls.data();
    double one = 0.0;
    for (const std::uint32_t count : {1u, 20u}) {
        frame.vplCount = count;
        technique.update(frame);
        const auto e = technique.render(view, scene.gbuffer);
        CHECK(areFinite(e));
        CHECK(meanOf(e) > 0.0);
        if (count == 1) one = meanOf(e);
        // Dealt to 4 x 4 pixels in turn, one VPL reaches one pixel in sixteen, which the filter spreads.
        if (count == 20) CHECK(meanOf(e) == Approx(20.0 * one).epsilon(0.25));
    }
    for (LWVpl& v : vpls) v.position[1] = -0.5f;  // under the floor
    technique.update(frame);
    const auto below = technique.render(view, scene.gbuffer);
    CHECK(areFinite(below));
    CHECK(meanOf(below) < kLeak * 20.0 * one);
}

TEST_CASE("ssvp in another unit of length", "[ssvp]") {
    TestDevice device(16);
    LWSsvpDesc desc = descOf(8, 2);
    std::vector<float> metres;
    for (const double scale : {1.0, 1024.0, 1.0 / 1024.0}) {
        LitFloor floor(64, tiledProfile, scale);
        WallAndCeiling scene(kWidth, kHeight, scale);
        Walls room = Walls::room(scale);
        const auto e = render(device, desc, {floor.light}, room.describe(), scene);
        if (metres.empty()) metres = e;
        CAPTURE(scale);
        CHECK(difference(e, metres) < kRounding);
    }
}

TEST_CASE("ssvp: memory is as estimated, and parameters out of range are named", "[ssvp]") {
    TestDevice device(16);
    LitFloor floor(64, tiledProfile);
    WallAndCeiling scene(kWidth, kHeight);
    Walls room = Walls::room();
    LWSsvpDesc desc = descOf(8, 2);
    TestTechnique technique(device, desc);
    TestView view(device, kWidth, kHeight);
    std::vector<LWLight> lights{floor.light};
    const LWFrame frame = frameOf(lights, room.describe());
    technique.update(frame);
    technique.render(view, scene.gbuffer);
    LWViewDesc viewDesc{};
    viewDesc.structSize = sizeof viewDesc;
    viewDesc.maxWidth = kWidth;
    viewDesc.maxHeight = kHeight;
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateFrameMemory(device, "ssvp", &desc, &viewDesc, &frame, &estimate) == LW_SUCCESS);
    CHECK(technique.stats().deviceBytes <= estimate);
    CHECK(technique.stats().deviceBytes > estimate / 4);
    LWTechnique none = nullptr;
    desc.mapSize = 100;
    CHECK(lwCreateSsvp(device, &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("map_size") != std::string::npos);
    desc.mapSize = 128;
    desc.clusters = 65;
    CHECK(lwCreateSsvp(device, &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("clusters") != std::string::npos);
}
