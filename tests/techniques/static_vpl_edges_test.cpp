// Technique static_vpl where numbers, counts and options end: what floats cannot square, places that
// coincide, thresholds that nothing can reach, receivers that nobody is.
#include <catch2/catch.hpp>
#include <limits>

#include "support/kernel_rig.h"
#include "support/packed_light.h"
#include "support/static_vpl_rig.h"

using namespace lightwell::test;

TEST_CASE("lights and second bounce lie between their VPLs, however far apart and bright these are",
          "[static_vpl]") {
    LWStaticVplDesc desc = keepAll();
    desc.lights = GENERATE(1u, 16u);
    desc.bounces = 2;
    StaticRig rig(GENERATE(1u, 16u), desc);
    StaticScene scene;
    scene.vpls = {staticVpl({9e8, 0, 0}, {0, 1, 0}, 1e18), staticVpl({-9e8, 0, 0}, {0, 1, 0}, 1e18),
                  staticVpl({0, 0, 9e8}, {0, 1, 0}, 1e18)};
    scene.lights = {sunLight({0, -1, 0}, glm::dvec3(1e30))};
    rig.update(scene);
    const auto vpls = rig.vpls();
    REQUIRE(vpls.size() == 4);
    CHECK(vpls[3].position.x == Approx(0.0).margin(1e3));
    CHECK(vpls[3].position.z == Approx(3e8).epsilon(1e-5));
    CHECK(vpls[3].normal.y == Approx(-1.0));
    for (const LWListedLight& light : rig.lights())
        for (int a = 0; a < 3; ++a) {
            CHECK(std::isfinite(light.position[a]));
            CHECK(std::isfinite(light.axis[a]));
            CHECK(std::isfinite(light.flux[a]));
            CHECK(std::isfinite(light.spotIntensity[a]));
        }
}

TEST_CASE("a weight too small for floats is small, not automatic", "[static_vpl]") {
    LWStaticVplDesc desc = keepAll();
    desc.unitArea = 1e-30f;
    StaticRig rig(GENERATE(1u, 16u), desc);
    StaticScene scene;
    scene.vpls = {staticVpl({0, 0, 0}, {0, 1, 0}, 0.0), staticVpl({1, 0, 0}, {0, 1, 0}, 1e-20),
                  staticVpl({2, 0, 0}, {0, 1, 0}, 1e-12), staticVpl({3, 0, 0}, {0, 1, 0}, 1.0)};
    scene.lights = {sunLight({0, -1, 0}, {1, 1, 1})};
    rig.update(scene);
    const auto areas = rig.areas();
    CHECK(areas[0] == Approx(kRigPi / 4.0));
    CHECK(areas[1] < 1e-30);
    CHECK(areas[2] < 1e-30);
    CHECK(areas[3] == Approx(1e-30));
}

TEST_CASE("light that no receiver gets culls nothing", "[static_vpl]") {
    StaticRig rig(GENERATE(1u, 16u), staticDesc());
    StaticScene scene;
    scene.vpls = {staticVpl({0, 0, 0}, {0, 1, 0}), staticVpl({1, 0, 0}, {0, -1, 0})};
    scene.vpls[0].receivers = LW_RECEIVERS_BAKED;
    scene.lights = {sunLight({0, -1, 0}, {1e6, 1e6, 1e6}), sunLight({0, 1, 0}, {1, 1, 1})};
    scene.lights[0].receivers = LW_RECEIVERS_UNBAKED;
    rig.update(scene);
    CHECK(rig.technique.count("kept_vpls") == 1);
}

TEST_CASE("after the dark the strongest VPL comes back, whatever threshold and hysteresis",
          "[static_vpl]") {
    LWStaticVplDesc desc = staticDesc();
    const auto pair =
        GENERATE(std::make_pair(0.02f, 100.0f), std::make_pair(1.0f, 2.0f),
                 std::make_pair(0.01f, 100.0f), std::make_pair(1.0f, 1.0f), std::make_pair(0.5f, 2.0f));
    desc.cullRelative = pair.first;
    desc.hysteresis = pair.second;
    CAPTURE(pair.first, pair.second);
    StaticRig rig(GENERATE(1u, 16u), desc);
    StaticScene scene;
    scene.vpls = roomOfPlaces(37, 3);
    const std::vector<LWLight> lamp = {pointLight({2, 1.5, 2.5}, {10.1, 12.3, 14.7})};
    scene.lights = lamp;
    rig.update(scene);
    CHECK(rig.technique.count("kept_vpls") >= 1);
    scene.lights.clear();
    rig.update(scene);
    CHECK(rig.technique.count("kept_vpls") == 0);
    scene.lights = lamp;
    rig.update(scene);
    CHECK(rig.technique.count("kept_vpls") >= 1);
}

TEST_CASE("a phantom does not glide from another light's", "[static_vpl]") {
    LWStaticVplDesc desc = staticDesc();
    desc.variant = LW_STATIC_VPL_PHANTOM;
    desc.smoothing = 0.9f;
    StaticRig rig(16, desc);
    StaticScene scene;
    scene.vpls = roomOfPlaces(24, 8);
    const float left[3] = {0.5f, 0.0f, 0.5f}, right[3] = {3.5f, 0.0f, 4.5f};
    scene.lights = {spotLight({0.5, 2, 0.5}, {0, -1, 0}, {5, 5, 5}, 0.1, 0.3),
                    spotLight({3.5, 2, 4.5}, {0, -1, 0}, {5, 5, 5}, 0.1, 0.3)};
    scene.lights[0].hit = left;
    rig.update(scene);
    scene.lights[0].hit = nullptr;
    scene.lights[1].hit = right;
    rig.update(scene);
    const auto vpls = rig.vpls();
    REQUIRE(!vpls.empty());
    CHECK(vpls.back().position.x == Approx(3.5));
    CHECK(vpls.back().position.z == Approx(4.5));
}

TEST_CASE("static_vpl: no places, no lights, nothing but light lists and dark pictures",
          "[static_vpl]") {
    LWStaticVplDesc desc = staticDesc();
    desc.bounces = 2;
    desc.interleave = GENERATE(1u, 2u);
    desc.variant = GENERATE(LW_STATIC_VPL_STATIC, LW_STATIC_VPL_PHANTOM);
    StaticRig rig(GENERATE(1u, 16u), desc);
    WallAndCeiling view(45, 32);
    TestView target(rig.device, 45, 32);
    StaticScene none, places, lights;
    places.vpls = roomOfPlaces(5, 1);
    const float hit[3] = {1, 0, 1};
    lights.lights = {pointLight({0, 1, 0}, {1, 1, 1}),
                     spotLight({1, 2, 1}, {0, -1, 0}, {1, 1, 1}, 0.1, 0.2)};
    lights.lights[1].hit = hit;
    for (const StaticScene* scene : {&none, &places, &lights, &none}) {
        rig.update(*scene);
        for (const float e : rig.technique.render(target, view.gbuffer)) REQUIRE(e == 0.0f);
        CHECK(rig.lights().empty());
        rig.planes("vpls");
        rig.planes("static_vpls");
    }
}

TEST_CASE("a thousand blockers, thousands of places, masks of any bits", "[static_vpl]") {
    LWStaticVplDesc desc = keepAll();
    desc.lights = 64;
    StaticRig rig(GENERATE(1u, 16u), desc);
    StaticScene scene;
    scene.vpls = roomOfPlaces(4096, 17);
    for (int i = 0; i < 1024; ++i) scene.block({3.9, 2.9, 4.9}, 0.05);
    scene.lights = {pointLight({2, 1.5, 2.5}, {1, 2, 3})};
    scene.lights[0].mask = 0x7f800001u;
    for (std::size_t i = 0; i < scene.vpls.size(); ++i) {
        const std::uint32_t masks[] = {0u, ~0u, 0x80000000u, 0x7f800001u, 0xff800002u, 1u, 0x7fc00000u};
        scene.vpls[i].lightMask = masks[i % 7];
    }
    rig.update(scene);
    const auto flux = rig.flux();
    glm::dvec3 all(0.0), listed(0.0);
    for (std::size_t i = 0; i < flux.size(); ++i) {
        CAPTURE(i);
        const LWStaticVpl& vpl = scene.vpls[i];
        const bool lit = vpl.lightMask == 0 || (vpl.lightMask & 0x7f800001u) != 0;
        const glm::dvec3 expected =
            lit ? twinIrradiance(scene, vpl, scene.lights[0]) * vec(vpl.reflectance) * double(vpl.weight)
                : glm::dvec3(0.0);
        if (glm::length(vec(vpl.position) - glm::dvec3(2, 1.5, 2.5)) > 1.0)
            for (int c = 0; c < 3; ++c)
                REQUIRE(flux[i][c] == Approx(expected[c]).epsilon(1e-3).margin(1e-6));
        all += flux[i];
    }
    for (const LWListedLight& light : rig.lights()) listed += vec(light.flux);
    for (int c = 0; c < 3; ++c) CHECK(listed[c] == Approx(all[c]).epsilon(1e-4));
}

TEST_CASE("receivers in halves: any mask at a reduced resolution", "[static_vpl]") {
    LWStaticVplDesc desc = keepAll();
    StaticRig whole(16, desc);
    desc.resolution = GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_HALF, LW_RESOLUTION_QUARTER);
    StaticRig rig(16, desc);
    WallAndCeiling view(45, 32);
    TestView target(rig.device, 45, 32), other(whole.device, 45, 32);
    StaticScene scene;
    scene.vpls = {staticVpl({0, 0, 0.5}, {0, 1, 0}), staticVpl({0.2, 0, 0.7}, {0, 1, 0}),
                  staticVpl({-0.2, 0, 0.2}, {0, 1, 0}), staticVpl({-0.3, 0, 0.4}, {0, 1, 0})};
    scene.lights = {sunLight({0, -1, 0}, {1, 1, 1}), sunLight({0, -1, 0}, {1, 1, 1})};
    scene.lights[1].receivers = LW_RECEIVERS_UNBAKED;
    rig.update(scene);
    whole.update(scene);
    const auto all = whole.technique.render(other, view.gbuffer);
    const double unmasked = difference(rig.technique.render(target, view.gbuffer), all);
    PlanarPixels mask(45, 32, 1);
    const int kind = GENERATE(0, 1, 2, 3, 4);
    for (std::uint32_t y = 0; y < 32; ++y)
        for (std::uint32_t x = 0; x < 45; ++x) {
            const bool odd = (x & 1) || (y & 1);
            mask.at(x, y, 0) = kind == 0   ? float(odd)
                               : kind == 1 ? float(!odd)
                               : kind == 2 ? -1.0f
                               : kind == 3 ? NAN
                                           : 0.0f;
        }
    LWGBuffer masked = view.gbuffer;
    masked.bakedMask = mask.image();
    const auto split = rig.technique.render(target, masked);
    std::vector<float> expected;
    for (std::size_t i = 0; i < split.size(); ++i) {
        const float m = mask.at(std::uint32_t(i % (45 * 32) % 45), std::uint32_t(i % (45 * 32) / 45), 0);
        expected.push_back(all[i] * (m != 0.0f ? 0.5f : 1.0f));
    }
    CAPTURE(desc.resolution, kind);
    // At half resolution a mask by odd and even leaves one half no sample of its own beside its pixels:
    // the nearest ones.
    CHECK(difference(split, expected) <=
          (desc.resolution == LW_RESOLUTION_FULL ? 1e-6 : 2.5 * unmasked));
    CHECK(rig.technique.count("rejected_pixels") == 0);
}

TEST_CASE("a profile wants a direction", "[static_vpl]") {
    StaticRig rig(16, staticDesc());
    StaticScene scene;
    scene.vpls = {staticVpl({0, 0, 0}, {0, 1, 0})};
    scene.lights = {pointLight({0, 1, 0}, {1, 1, 1})};
    const float profile[2] = {1.0f, 0.0f};
    scene.lights[0].profile = profile;
    scene.lights[0].profileCount = 2;
    CHECK(rig.tryUpdate(scene) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(rig.device), Catch::Contains("frame.lights[0].direction"));
}

TEST_CASE("lamps and hits beyond reach are refused; at its end they put no number astray",
          "[static_vpl]") {
    LWStaticVplDesc desc = keepAll();
    desc.variant = LW_STATIC_VPL_PHANTOM;
    desc.bounces = 2;
    StaticRig rig(16, desc);
    StaticScene scene;
    scene.vpls = {staticVpl({0, 0, 0}, {0, 1, 0}), staticVpl({1, 0, 0}, {0, 1, 0})};
    const float hit[3] = {0, 0, 0}, far[3] = {0, -2e9f, 0};
    scene.lights = {spotLight({0, 3e30, 0}, {0, -1, 0}, {1, 1, 1}, 0.1, 0.2)};
    scene.lights[0].hit = hit;
    CHECK(rig.tryUpdate(scene) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(rig.device),
               Catch::Contains("frame.lights[0].position: expected at most 1e+09"));
    put(scene.lights[0].position, {0, 1e9, 0});
    scene.lights[0].hit = far;
    CHECK(rig.tryUpdate(scene) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(rig.device), Catch::Contains("frame.lights[0].hit: expected at most 1e+09"));
    scene.lights[0].hit = hit;
    rig.update(scene);
    for (const auto& plane : rig.planes("vpls"))
        for (const double value : plane) CHECK(std::isfinite(value));
    WallAndCeiling view(45, 32);
    TestView target(rig.device, 45, 32);
    for (const float e : rig.technique.render(target, view.gbuffer)) REQUIRE(e < 1e-12f);
}
