// Technique lpv with cascades together with what else it can do: a sky, an error target, bounces over frames, half resolution.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <optional>

#include "support/choices.h"
#include "support/lpv_room.h"
#include "support/packed_light.h"
#include "support/scoped_api.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;

namespace {

constexpr std::uint32_t kWidth = 45, kHeight = 16;
constexpr std::uint32_t kDiscs = 32;  // along the floor
constexpr double kPi = 3.14159265358979323846;
constexpr std::array<float, 3> kFocus = {0.01f, 0.52f, 0.51f};

double evenProfile(double, double) { return 1.0; }

// Of 24 directions, whose sum over even light is pi itself. With an extent of 4 the finest of three grids has a side of 1.
LWLpvDesc descOf(LWLpvTransport transport, std::uint32_t cascades = 3, float extent = 4.0f) {
    LWLpvDesc desc;
    lwDefaultLpv(&desc);
    desc.size = 16;
    desc.transport = transport;
    desc.directions = 24;
    desc.cascades = cascades;
    desc.extent = extent;
    return desc;
}

LWLpvTransport anyTransport() { return GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP); }

// A lit floor, a sky, both or neither, and what blocks: triangles, surfels that cover the floor, or nothing but what the RSM sees.
struct Scene {
    enum Blockers { kNone, kTriangles, kSurfels };
    LitFloor floor;
    WallAndCeiling view;
    RoomTriangles triangles;
    std::vector<LWLight> lights;
    PlanarPixels surfelAt{kDiscs * kDiscs, 1, 3}, surfelNormal{kDiscs * kDiscs, 1, 3}, surfelArea{kDiscs * kDiscs, 1, 1};
    std::array<float, 3> focus = kFocus;
    LWGeometry geometry{};
    LWFrame frame{};

    Scene(Blockers blockers, bool isLit, float sky, double scale = 1.0)
        : floor(64, evenProfile, scale), view(kWidth, kHeight, scale), triangles(0.9, scale) {
        if (isLit) lights.push_back(floor.light);
        for (float& f : focus) f *= float(scale);
        geometry = triangles.geometry;
        if (blockers == kSurfels) coverFloor(scale);
        frame.structSize = sizeof frame;
        frame.lights = lights.data();
        frame.lightCount = std::uint32_t(lights.size());
        frame.focus = focus.data();
        frame.geometry = blockers == kNone ? nullptr : &geometry;
        for (float& e : frame.environment) e = sky;
    }
    Scene(const Scene&) = delete;

    std::vector<float> render(LWDevice device, TestTechnique& technique, int frames = 1) const {
        TestView target(device, kWidth, kHeight);
        for (int f = 0; f < frames; ++f) technique.update(frame);
        return technique.render(target, view.gbuffer);
    }
    std::vector<float> render(LWDevice device, const LWLpvDesc& desc, int frames = 1) const {
        TestTechnique technique(device, "lpv", &desc);
        return render(device, technique, frames);
    }

private:
    void coverFloor(double scale) {
        for (std::uint32_t i = 0; i < kDiscs * kDiscs; ++i) {
            surfelAt.set(i, 0, {scale * ((i % kDiscs + 0.5) / kDiscs - 0.5), 0.0, scale * (i / kDiscs + 0.5) / kDiscs});
            surfelNormal.set(i, 0, {0, 1, 0});
            surfelArea.at(i, 0, 0) = float(scale * scale / (kDiscs * kDiscs));
        }
        geometry = LWGeometry{};
        geometry.structSize = sizeof geometry;
        geometry.surfelCount = kDiscs * kDiscs;
        geometry.surfelPosition = surfelAt.image();
        geometry.surfelNormal = surfelNormal.image();
        geometry.surfelArea = surfelArea.image();
    }
};

}  // namespace

TEST_CASE("sweeps through cascades: an empty sky is pi L in each grid and on their borders", "[lpv_cascades]") {
    TestDevice device(GENERATE(1u, 16u));
    LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_SWEEP);
    desc.bounces = 3;  // of which a sky is in the first alone
    desc.frames = GENERATE(1u, 4u);
    const Scene scene(Scene::kNone, false, 0.5f);
    const std::vector<float> light = scene.render(device, desc);
    for (std::uint32_t i = 0; i < light.size(); ++i)
        if (i % kWidth > 0) REQUIRE(double(light[i]) == Approx(0.5 * kPi).epsilon(3e-6));
}

// Steps do not get that far. What they bring is the coarsest grid's, whatever grids lie in it, but read half a fine cell off surfaces.
TEST_CASE("steps through cascades: an empty sky is the coarsest grid's, counted once", "[lpv_cascades]") {
    TestDevice device(16);
    LWLpvDesc nested = descOf(LW_LPV_TRANSPORT_PROPAGATE), one = descOf(LW_LPV_TRANSPORT_PROPAGATE, 1);
    nested.autoError = one.autoError = GENERATE(0.0f, 0.3f);
    const Scene scene(Scene::kNone, false, 0.5f);
    const std::vector<float> found = scene.render(device, nested), expected = scene.render(device, one);
    CHECK(meanOf(found) == Approx(meanOf(expected)).epsilon(0.1));
    CHECK(difference(found, expected) < 0.15);
}

TEST_CASE("cascades: a lamp's light and a sky's add up, over bounces and frames", "[lpv_cascades]") {
    TestDevice device(16);
    const LWLpvTransport transport = anyTransport();
    const auto blockers = GENERATE(Scene::kTriangles, Scene::kSurfels);
    LWLpvDesc desc = descOf(transport);
    const bool sweeps = transport == LW_LPV_TRANSPORT_SWEEP;
    desc.bounces = sweeps ? 3 : 1;
    const Scene lamp(blockers, true, 0.0f), sky(blockers, false, 0.5f), both(blockers, true, 0.5f);
    const std::vector<float> first = lamp.render(device, desc), second = sky.render(device, desc), found = both.render(device, desc);
    std::vector<float> sum(first.size());
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = first[i] + second[i];
    CHECK(meanOf(first) > 0.05);
    CHECK(meanOf(second) > 0.05);
    // What sweeps bring is read twice, which is not linear (lpv_sweep.md).
    CHECK(difference(found, sum) < (sweeps ? 0.02 : 1e-5));
    if (!sweeps) return;
    desc.bounces = 1;
    CHECK(meanOf(both.render(device, desc)) < 0.99 * meanOf(found));
    desc.bounces = 3;
    desc.frames = 4;
    CHECK((both.render(device, desc, 1 + 3 * 4) == found));
}

TEST_CASE("cascades: an error target of next to nothing has the bits of all steps", "[lpv_cascades]") {
    TestDevice device(16);
    LWLpvDesc all = descOf(LW_LPV_TRANSPORT_PROPAGATE), most = all;
    all.steps = most.steps = 21;
    most.autoError = 1e-9f;
    const Scene scene(Scene::kTriangles, true, 0.5f);
    TestTechnique fixed(device, "lpv", &all), ending(device, "lpv", &most);
    CHECK((scene.render(device, ending) == scene.render(device, fixed)));
    CHECK(fixed.count("steps") == 5 * 21);  // of three grids, and of what lies outside of two
    CHECK(ending.count("steps") == 4 * 21 + 7);  // outside of the finest is no lamp: seen at the first look
    CHECK_THAT(reasonOf(ending, "steps"), Contains("all") || Contains("ended"));
}

// All of the room lies where the finest grid, of side 2, has all of a pixel's light; without triangles, which a single grid draws by
// chance. No other grid has a light of its own that comes here.
TEST_CASE("cascades: each grid ends its steps by its own light, calibrated for as many", "[lpv_cascades]") {
    TestDevice device(16);
    LWLpvDesc nested = descOf(LW_LPV_TRANSPORT_PROPAGATE, 3, 8.0f), one = descOf(LW_LPV_TRANSPORT_PROPAGATE, 1, 2.0f);
    nested.steps = one.steps = 256;
    nested.autoError = one.autoError = 0.3f;
    nested.geometryVolume = one.geometryVolume = LW_GEOMETRY_VOLUME_OFF;
    const Scene scene(Scene::kNone, true, 0.0f);
    TestTechnique single(device, "lpv", &one);
    const std::vector<float> light = scene.render(device, single);
    CHECK(single.count("steps") < 256);
    CHECK(meanOf(light) > 0.0);
    CHECK((scene.render(device, nested) == light));

    // From the coarser grid alone: what the finest one is brought is calibrated as it is there. Its own steps ended at the first look.
    nested = descOf(LW_LPV_TRANSPORT_PROPAGATE, 2, 4.0f);
    one = descOf(LW_LPV_TRANSPORT_PROPAGATE, 1, 4.0f);
    nested.steps = one.steps = 256;
    nested.autoError = one.autoError = 0.3f;
    nested.geometryVolume = one.geometryVolume = LW_GEOMETRY_VOLUME_OFF;
    Scene far(Scene::kNone, true, 0.0f);
    far.focus[1] = 1.55f;
    CHECK(difference(far.render(device, nested), far.render(device, one)) < 0.12);
}

TEST_CASE("cascades with everything: widths 1 and 16 give the same bits, in the memory that was estimated, compiled before",
          "[lpv_cascades]") {
    TestDevice wide(16), scalar(1);
    const LWLpvTransport transport = anyTransport();
    const Scene::Blockers blockers = transport == LW_LPV_TRANSPORT_SWEEP ? Scene::kSurfels : GENERATE(Scene::kNone, Scene::kTriangles);
    LWLpvDesc desc = descOf(transport);
    desc.steps = 24;
    desc.autoError = 0.4f;
    desc.damping = 1;
    desc.resolution = LW_RESOLUTION_HALF;
    desc.bounces = 2;
    desc.frames = 2;
    const Scene scene(blockers, true, 0.5f);
    TestTechnique technique(wide, "lpv", &desc);
    TestView view(wide, kWidth, kHeight);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = wide.info();
    const std::vector<float> light = scene.render(wide, technique);
    CHECK(wide.info().programsBuilt == before.programsBuilt);
    CHECK(wide.info().kernelsSpecialised == before.kernelsSpecialised);
    CHECK(meanOf(light) > 0.1);
    LWViewDesc size{};
    size.structSize = sizeof size;
    size.maxWidth = kWidth;
    size.maxHeight = kHeight;
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateFrameMemory(wide, "lpv", &desc, &size, &scene.frame, &estimate) == LW_SUCCESS);
    CHECK(technique.stats().deviceBytes <= estimate);
    CHECK(technique.stats().deviceBytes > estimate / 2);
    CHECK((scene.render(scalar, desc) == light));
}

TEST_CASE("cascades: a scene that is a thousand times as large, or as small, is lit alike", "[lpv_cascades]") {
    TestDevice device(16);
    LWLpvDesc desc = descOf(anyTransport());
    desc.bounces = 2;
    const auto at = [&](double scale) {
        desc.extent = float(4.0 * scale);
        return Scene(Scene::kTriangles, true, 0.5f, scale).render(device, desc);
    };
    const std::vector<float> one = at(1.0);
    // A power of two leaves every bit; a thousand moves samples that lie on edges.
    for (const double scale : {std::ldexp(1.0, -10), std::ldexp(1.0, 10)}) CHECK((at(scale) == one));
    for (const double scale : {1e-3, 1e3}) CHECK(difference(at(scale), one) < 0.01);
}

TEST_CASE("sweeps through cascades: too few surfels for further bounces in the finest grid are told", "[lpv_cascades]") {
    TestDevice device(16);
    const Scene scene(Scene::kTriangles, true, 0.0f);
    const auto told = [&](std::uint32_t cascades, std::uint32_t bounces) {
        LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_SWEEP, cascades);
        desc.bounces = bounces;
        TestTechnique technique(device, "lpv", &desc);
        technique.update(scene.frame);
        return reasonOf(technique, "bounces.surfels");
    };
    CHECK(told(4, 2) == "");  // as many as there may be
    CHECK_THAT(told(5, 2), Contains("4,194,304"));
    CHECK(told(5, 1) == "");
}
