// lightwell.hpp: the C API's calls as C++17 objects.
#include <catch2/catch.hpp>
#include <memory>
#include <utility>
#include <vector>

#include "api/api_rig.h"
#include "api/api_scene.h"
#include "lightwell/lightwell.hpp"

using namespace lightwell::test;
using Catch::Matchers::Contains;

TEST_CASE("lightwell.hpp owns, shares and throws", "[api]") {
    ApiScene scene;
    auto desc = lightwell::Device::defaults();
    desc.width = 16;
    lightwell::Device device(desc);
    auto technique = std::make_unique<lightwell::Technique>(device, "rsm");
    lightwell::Technique copy = *technique;
    technique.reset();
    lightwell::View view(device, 24, 10);
    copy.prewarm(view);
    copy.update(scene.frame);
    copy.render(view, scene.gbuffer, scene.output);
    device.finish();
    CHECK(scene.lit());
    CHECK(copy.stats().frameIndex == 12345);
    CHECK(copy.debugViews(&view).size() > 0);
    CHECK(view.size() == std::pair<std::uint32_t, std::uint32_t>(24, 10));
    CHECK(device.estimateMemory("rsm", nullptr, 24, 10, 256) > 0);
    try {
        view.setSize(25, 10);
        FAIL("expected an exception");
    } catch (const lightwell::Error& error) {
        CHECK(error.status() == LW_ERROR_INVALID_ARGUMENT);
        CHECK_THAT(error.what(), Contains("lwSetViewSize") && Contains("25"));
    }
    CHECK_THROWS_WITH(lightwell::Technique(device, "fog"), Contains("fog"));
}

TEST_CASE("lightwell.hpp reads a list of lights", "[api]") {
    auto desc = lightwell::Device::defaults();
    desc.width = 16;
    lightwell::Device device(desc);
    // Only techniques that have one hand one out.
    CHECK_THROWS_WITH(lightwell::Technique(device, "rsm").readLightList(), Contains("rsm"));
    lightwell::Technique places(device, "static_vpl");
    LWStaticVpl vpls[2] = {};
    for (LWStaticVpl& vpl : vpls) {
        vpl.normal[1] = vpl.weight = 1.0f;
        for (float& part : vpl.reflectance) part = 0.5f;
    }
    vpls[1].position[0] = 1.0f;
    auto sun = lightwell::make<LWLight>();
    sun.kind = LW_LIGHT_DIRECTIONAL;
    sun.direction[1] = -1.0f;
    for (float& part : sun.irradiance) part = 4.0f;
    auto frame = lightwell::make<LWFrame>();
    frame.staticVpls = vpls;
    frame.staticVplCount = 2;
    frame.lights = &sun;
    frame.lightCount = 1;
    places.update(frame);
    const std::vector<LWListedLight> lights = places.readLightList();
    REQUIRE(lights.size() == 2);
    for (const LWListedLight& light : lights) CHECK(double(light.flux[0]) == Approx(2.0));
    CHECK(lights[1].position[0] == 1.0f);
    CHECK(device.estimateMemory("static_vpl", nullptr, 24, 10, frame) > 0);
}
