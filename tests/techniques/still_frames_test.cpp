// Frames at rest: ssvp keeps VPLs, clusters and maps that would come out the same, and no bit of any frame tells.
#include <catch2/catch.hpp>
#include <functional>
#include <string>
#include <vector>

#include "support/choices.h"
#include "support/lpv_room.h"
#include "support/scoped_api.h"
#include "support/small_ssvp.h"
#include "support/walls.h"
#include "techniques/still_frames.h"

using namespace lightwell::test;
using lightwell::StillFrames;

namespace {

constexpr std::uint32_t kWidth = 45, kHeight = 16;
constexpr int kSettling = 16, kSettlingOfMany = 48;  // of a bounce with clusters, as in ssvp_options.cpp

LWSsvpDesc small() {
    LWSsvpDesc desc = smallSsvp(LW_VISIBILITY_HARD, 2, 2);
    desc.clusters = 4;
    desc.secondVpls = 8;
    return desc;
}

// A lit floor in a room with a shelf, whose host tells its map's version or not.
struct Host {
    LitFloor floor{32, [](double x, double) { return x < 0.0 ? 0.8 : 0.2; }};
    Walls walls = Walls::room();
    bool asSurfels = false;
    std::uint64_t mapVersion = 1, geometryVersion = 1;
    double origin = 0.0;
    std::vector<LWVpl> vpls;

    Host() { walls.add({-0.5, 0.4, 0.0}, {0.4, 0, 0}, {0, 0, 0.8}); }

    void update(TestTechnique& technique, bool told, std::uint32_t reset = 0, const LWSourceView* source = nullptr) {
        LWRsm map = floor.rsm;
        map.version = told ? mapVersion : 0;
        LWLight light = floor.light;
        light.rsms = &map;
        const std::vector<LWLight> lights{light};
        LWFrame frame = roomFrame(lights, asSurfels ? walls.describeSurfels(0.05, geometryVersion) : walls.describe(geometryVersion));
        frame.reset = reset;
        frame.worldOrigin[0] = origin;
        frame.vpls = vpls.data();
        frame.vplCount = std::uint32_t(vpls.size());
        frame.sourceViews = source;
        frame.sourceViewCount = source ? 1 : 0;
        technique.update(frame);
    }
};

bool isKept(TestTechnique& technique) {
    std::uint32_t launches = 0;
    for (const char* pass : {"vpl_sampling.draw", "kmeans.assign", "kmeans.finish", "paraboloid_map.place", "second_bounce.draw",
                             "clustered_gather.order"})
        launches += launchesOf(technique, pass);
    CHECK((launches == 0) == !reasonOf(technique, "ssvp.vpls").empty());
    return launches == 0;
}

struct Variant {
    const char* name;
    std::function<void(LWSsvpDesc&, Host&)> change;
    int settling;       // updates
    bool looks = true;  // at geometry
};

const Variant kVariants[] = {
    {"defaults", [](LWSsvpDesc&, Host&) {}, 2 * kSettling},
    {"careful, four bounces", [](LWSsvpDesc& desc, Host&) { desc.visibility = LW_VISIBILITY_CAREFUL, desc.bounces = 4; }, 3 * kSettling},
    {"clusters anew in every frame", [](LWSsvpDesc& desc, Host&) { desc.warmStart = 0; }, 2 * kSettling},
    {"no clusters, no shadows, one bounce", [](LWSsvpDesc& desc, Host&) { desc.clusters = 0, desc.visibility = LW_VISIBILITY_NONE, desc.bounces = 1; }, kSettling, false},
    {"no clusters, a bounce of many VPLs drawn from each VPL",
     [](LWSsvpDesc& desc, Host&) { desc.clusters = 0, desc.visibility = LW_VISIBILITY_NONE, desc.bounces = 3, desc.secondVpls = 64; }, kSettlingOfMany},
    {"surfels, half resolution where light is even",
     [](LWSsvpDesc& desc, Host& host) { desc.autoResolution = 0.2f, host.asSurfels = true; }, 2 * kSettling},
};

struct Step {
    const char* what;
    std::function<void(Host&)> change;
    bool isKept;  // the frame after it, at rest before
    bool isOfGeometry = false;
    std::uint32_t reset = 0;
};

const Step kSteps[] = {
    {"a light that dims",
     [](Host& host) {
         for (std::uint32_t i = 0; i < 12; ++i) host.floor.flux.set(i, 7, {0, 0, 0});
         host.mapVersion = 2;
     },
     false},
    {"a version of the same triangles", [](Host& host) { host.geometryVersion = 2; }, true, true},
    {"a shelf more", [](Host& host) { host.walls.add({0.1, 0.6, 0.1}, {0.3, 0, 0}, {0, 0, 0.3}), host.geometryVersion = 3; }, false, true},
    {"a cut", [](Host&) {}, false, false, 1},
    {"the world's origin elsewhere", [](Host& host) { host.origin = 1.0; }, false},
};

}  // namespace

TEST_CASE("at rest nothing of the light is made again, with the bits of a host that tells no versions", "[ssvp][still]") {
    const Variant& variant = GENERATE(from_range(std::begin(kVariants), std::end(kVariants)));
    CAPTURE(variant.name);
    TestDevice device(16);
    Host host;
    LWSsvpDesc desc = small();
    variant.change(desc, host);
    const WallAndCeiling scene(kWidth, kHeight);
    TestTechnique technique(device, desc), reference(device, desc);
    TestView view(device, kWidth, kHeight), other(device, kWidth, kHeight);
    const auto frame = [&](std::uint32_t reset) {
        host.update(technique, true, reset);
        host.update(reference, false, reset);
        CHECK(technique.render(view, scene.gbuffer) == reference.render(other, scene.gbuffer));
        CHECK_FALSE(isKept(reference));
        for (const char* count : {"vpls", "clusters", "second_vpls", "maps_redrawn"}) CHECK(technique.count(count) == reference.count(count));
        return isKept(technique);
    };
    for (int i = 0; i <= variant.settling + 2; ++i) CHECK(frame(0) == (i >= variant.settling));
    for (const Step& step : kSteps) {
        CAPTURE(step.what);
        // Surfels are not compared: another version is another set.
        const bool kept = step.isOfGeometry ? !variant.looks || (step.isKept && !host.asSurfels) : step.isKept;
        step.change(host);
        CHECK(frame(step.reset) == kept);
        for (int i = 1; i <= variant.settling; ++i) CHECK(frame(0) == (kept || i >= variant.settling));
    }
}

TEST_CASE("clusters of many VPLs have longer to come to rest after light that moved", "[ssvp][still]") {
    TestDevice device(16);
    Host host;
    LWSsvpDesc desc = small();
    desc.vpls = 4096;
    desc.clusters = 64;
    desc.bounces = 1;
    desc.visibility = LW_VISIBILITY_NONE;
    const WallAndCeiling scene(kWidth, kHeight);
    TestTechnique technique(device, desc), reference(device, desc);
    TestView view(device, kWidth, kHeight), other(device, kWidth, kHeight);
    for (int i = 0; i < kSettlingOfMany + 8; ++i) {
        if (i < 5) {  // a shadow that walks over the floor
            for (std::uint32_t y = 0; y < 32; ++y) host.floor.flux.set(std::uint32_t(6 * i), y, {0, 0, 0});
            ++host.mapVersion;
        }
        host.update(technique, true);
        host.update(reference, false);
        CHECK(technique.render(view, scene.gbuffer) == reference.render(other, scene.gbuffer));
        CHECK(isKept(technique) == (i >= 4 + kSettlingOfMany));
    }
}

TEST_CASE("what changes from frame to frame, or may, is made in every frame", "[ssvp][still]") {
    const auto change = GENERATE(as<std::function<void(LWSsvpDesc&, Host&)>>{}, [](LWSsvpDesc& desc, Host&) { desc.history = 8; },
                                 [](LWSsvpDesc& desc, Host&) { desc.autoError = 0.1f; }, [](LWSsvpDesc& desc, Host&) { desc.sampling = LW_SAMPLING_VIEW; },
                                 [](LWSsvpDesc& desc, Host&) { desc.visibility = LW_VISIBILITY_VOXEL; },
                                 [](LWSsvpDesc& desc, Host&) { desc.occluders = LW_OCCLUDERS_SCREEN; },
                                 [](LWSsvpDesc&, Host& host) {
                                     LWVpl vpl{};
                                     vpl.position[1] = 0.5f, vpl.position[2] = 0.5f;
                                     vpl.normal[1] = 1.0f;
                                     vpl.flux[0] = vpl.flux[1] = vpl.flux[2] = 1.0f;
                                     host.vpls.push_back(vpl);
                                 },
                                 [](LWSsvpDesc&, Host& host) { host.mapVersion = 0; });
    TestDevice device(16);
    Host host;
    LWSsvpDesc desc = small();
    change(desc, host);
    const WallAndCeiling scene(kWidth, kHeight);
    TestView view(device, kWidth, kHeight);
    const LWSourceView source{view, &scene.gbuffer};
    TestTechnique technique(device, desc);
    for (int i = 0; i < 2 * kSettling + 4; ++i) host.update(technique, true, 0, &source);
    CHECK_FALSE(isKept(technique));
}

TEST_CASE("frames are still after as many of the same as things take to settle, of all that is known", "[ssvp][still]") {
    StillFrames still(3);
    const auto note = [&](std::uint64_t light, std::uint64_t geometry, bool restart = false) { return still.note(light, geometry, restart); };
    for (const bool expected : {false, false, false, true, true}) CHECK(note(7, 9) == expected);
    CHECK_FALSE(note(8, 9));
    for (const bool expected : {false, false, true}) CHECK(note(8, 9) == expected);
    CHECK_FALSE(note(8, 10));
    for (const bool expected : {false, false, true}) CHECK(note(8, 10) == expected);
    CHECK_FALSE(note(8, 10, true));  // a cut counts as a first frame
    for (const bool expected : {false, false, true}) CHECK(note(8, 10) == expected);
    for (int i = 0; i < 8; ++i) CHECK_FALSE(note(0, 10));
    for (int i = 0; i < 8; ++i) CHECK_FALSE(note(8, 0));
    for (const bool expected : {false, false, false, true}) CHECK(note(8, 10) == expected);
}
