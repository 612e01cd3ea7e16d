// LWRsm::version: maps that have not changed are not read again, and no bit of any frame tells.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>

#include "support/choices.h"
#include "support/lpv_room.h"
#include "support/scoped_api.h"

using namespace lightwell::test;

namespace {

constexpr std::uint32_t kWidth = 45, kHeight = 16;

// Small settings of each technique that reads RSMs.
struct Descs {
    LWRsmDesc rsm;
    LWSsvpDesc ssvp;
    LWLpvDesc lpv;
    LWConeTracingDesc cones;

    Descs() {
        lwDefaultRsm(&rsm);
        lwDefaultSsvp(&ssvp);
        lwDefaultLpv(&lpv);
        lwDefaultConeTracing(&cones);
        rsm.vpls = ssvp.vpls = 64;
        ssvp.clusters = 4;
        ssvp.mapSize = 64;
        lpv.size = 16;
        lpv.steps = 7;
        cones.size = 32;
    }
    const void* of(const std::string& technique) const {
        if (technique == "rsm") return &rsm;
        if (technique == "ssvp") return &ssvp;
        return technique == "lpv" ? static_cast<const void*>(&lpv) : &cones;
    }
};

// Two suns' maps of the same floor, with versions that frames tell or not.
struct Maps {
    LitFloor left{32, [](double x, double) { return x < 0.0 ? 0.8 : 0.1; }}, right{24, [](double x, double) { return x < 0.0 ? 0.1 : 0.6; }},
        elsewhere{24, [](double, double) { return 0.3; }};
    std::vector<LWRsm> rsms{left.rsm, right.rsm};
    double origin = 0.0;
    bool areCascades = false;  // of one light

    Maps() { rsms[0].version = rsms[1].version = 1; }
    void update(TestTechnique& technique, const LWGeometry& geometry, bool told, std::uint32_t reset) const {
        std::vector<LWRsm> maps = rsms;
        std::vector<LWLight> lights;
        for (LWRsm& map : maps) {
            if (!told) map.version = 0;
            lights.push_back(left.light);
            lights.back().rsms = &map;
        }
        if (areCascades) {
            lights.pop_back();
            lights.front().rsmCount = std::uint32_t(maps.size());
        }
        LWFrame frame = roomFrame(lights, &geometry);
        frame.reset = reset;
        frame.worldOrigin[0] = origin;
        technique.update(frame);
    }
};

struct Step {
    const char* what;
    std::function<void(Maps&)> change;
    std::uint32_t read;  // maps
    std::uint32_t reset = 0;
};

const Step kSteps[] = {
    {"a first frame", [](Maps&) {}, 2},
    {"still", [](Maps&) {}, 0},
    {"one dims, and has a texel that is no number",
     [](Maps& maps) {
         for (std::uint32_t i = 0; i < 12; ++i) maps.right.flux.set(i, 7, {0, 0, 0});
         maps.right.flux.at(3, 3, 1) = std::nanf("");
         maps.rsms[1].version = 2;
     },
     1},
    {"still", [](Maps&) {}, 0},
    {"no version told of the other", [](Maps& maps) { maps.rsms[0].version = 0; }, 1},
    {"nor now", [](Maps&) {}, 1},
    {"a version again", [](Maps& maps) { maps.rsms[0].version = 1; }, 1},
    {"a cut", [](Maps&) {}, 0, 1},
    {"a camera that stands elsewhere", [](Maps& maps) { maps.rsms[1].camera.projection[0] *= 1.25f; }, 1},
    {"other memory", [](Maps& maps) { maps.rsms[1].flux = maps.elsewhere.flux.image(); }, 1},
    {"still", [](Maps&) {}, 0},
    {"one light's cascades: what the finer one covers is the coarser one's no more", [](Maps& maps) { maps.areCascades = true; }, 1},
    {"still", [](Maps&) {}, 0},
    {"the finer one sees less", [](Maps& maps) { maps.rsms[0].camera.projection[0] *= 1.1f; }, 2},
    {"two lights again", [](Maps& maps) { maps.areCascades = false; }, 1},
    {"the world's origin elsewhere", [](Maps& maps) { maps.origin = 1.0; }, 2},
    {"still", [](Maps&) {}, 0},
    {"the lights change places", [](Maps& maps) { std::swap(maps.rsms[0], maps.rsms[1]); }, 2},
    {"one light less", [](Maps& maps) { maps.rsms.pop_back(); }, 1},
    {"still", [](Maps&) {}, 0},
};

}  // namespace

TEST_CASE("maps of the same version are not read again, and frames have the bits of those that are", "[rsm][versions]") {
    const std::string name = GENERATE("rsm", "ssvp", "lpv", "cone_tracing");
    CAPTURE(name);
    const Descs descs;
    TestDevice device(16);
    RoomTriangles room(0.9);
    room.geometry.version = 1;
    const WallAndCeiling scene(kWidth, kHeight);
    TestTechnique reference(device, name.c_str(), descs.of(name)), technique(device, name.c_str(), descs.of(name));
    TestView view(device, kWidth, kHeight), other(device, kWidth, kHeight);
    Maps maps;
    for (const Step& step : kSteps) {
        CAPTURE(step.what);
        step.change(maps);
        maps.update(reference, room.geometry, false, step.reset);
        maps.update(technique, room.geometry, true, step.reset);
        CHECK(technique.render(view, scene.gbuffer) == reference.render(other, scene.gbuffer));
        CHECK(launchesOf(technique, "rsm_input.unpack") == step.read);
        CHECK(launchesOf(reference, "rsm_input.unpack") == maps.rsms.size());
        for (const char* count : {"rejected_texels", "covered_texels"}) CHECK(technique.count(count) == reference.count(count));
        CHECK(reasonOf(technique, "rsms").empty() == (step.read == maps.rsms.size()));
        if (name == "rsm") CHECK((launchesOf(technique, "vpl_sampling.row_sums") == 0) == (step.read == 0));
    }
    CHECK(reasonOf(reference, "rsms").empty());
}

TEST_CASE("what a version that stays says is believed, and a refused frame changes nothing", "[rsm][versions]") {
    const Descs descs;
    TestDevice device(16);
    RoomTriangles room(std::nullopt);
    const WallAndCeiling scene(kWidth, kHeight);
    TestTechnique technique(device, "rsm", &descs.rsm);
    TestView view(device, kWidth, kHeight);
    Maps maps;
    maps.update(technique, room.geometry, true, 0);
    const std::vector<float> before = technique.render(view, scene.gbuffer);
    for (std::uint32_t i = 0; i < 32; ++i) maps.left.flux.set(i, 16, {0, 0, 0});

    LWRsm broken = maps.rsms[0];
    broken.camera.view[3] = std::nanf("");
    LWLight light = maps.left.light;
    light.rsms = &broken;
    const std::vector<LWLight> refused{light};
    const LWFrame frame = roomFrame(refused, nullptr);
    REQUIRE(lwUpdate(technique, &frame) == LW_ERROR_INVALID_ARGUMENT);

    maps.update(technique, room.geometry, true, 0);
    CHECK(launchesOf(technique, "rsm_input.unpack") == 0);
    CHECK(technique.render(view, scene.gbuffer) == before);
    // A program built before maps had versions: its structs end before, and what lies behind is none.
    maps.rsms[0].structSize = maps.rsms[1].structSize = std::uint32_t(offsetof(LWRsm, version));
    maps.update(technique, room.geometry, true, 0);
    CHECK(launchesOf(technique, "rsm_input.unpack") == 2);
    CHECK(technique.render(view, scene.gbuffer) != before);
    maps.rsms[0].structSize = maps.rsms[1].structSize = sizeof(LWRsm);
    maps.rsms[0].version = 7;
    maps.update(technique, room.geometry, true, 0);
    CHECK(technique.render(view, scene.gbuffer) != before);
}
