// Techniques that look at the view's own pixels after a frame whose commands failed on the device: what they write there once
// (patterns, tables, borders of images) has to be written again.
#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "api/api_rig.h"

using namespace lightwell::test;

namespace {

// Right half of the rig's floor becomes a slope that sees the left one.
void raiseWall(ApiScene& scene) {
    for (std::uint32_t y = 0; y < scene.position.height(); ++y)
        for (std::uint32_t x = 0; x < scene.position.width(); ++x)
            if (x >= scene.position.width() / 2) {
                const double u = (x + 0.5) / scene.position.width(), v = (y + 0.5) / scene.position.height();
                scene.position.set(x, y, u - 0.5, 1.0 - u, v - 0.5);
                scene.normal.set(x, y, -0.70710678, -0.70710678, 0);
            }
}

std::vector<double> pixelsOf(const HostImage& image) {
    std::vector<double> all;
    for (std::uint32_t y = 0; y < image.height(); ++y)
        for (std::uint32_t x = 0; x < image.width(); ++x)
            for (int c = 0; c < 3; ++c) all.push_back(image.value(x, y, c));
    return all;
}

}  // namespace

TEST_CASE("what failed frames did not bring to the device the next one does", "[horizon][ao][screen_space][history]") {
    const std::string name = GENERATE("horizon", "ao", "screen_space");
    const std::uint32_t history = GENERATE(0u, 4u);
    CAPTURE(name, history);
    ApiScene scene;
    raiseWall(scene);
    HostImage light(LW_FORMAT_FLOAT3, scene.position.width(), scene.position.height());
    for (std::uint32_t y = 0; y < light.height(); ++y)
        for (std::uint32_t x = 0; x < light.width(); ++x) light.set(x, y, 1.0, 1.0, 1.0);
    scene.gbuffer.directRadiance = light.image();
    const TestCamera camera = [] {
        TestCamera c = testCamera(kOrthographic, glm::dvec3(0, -2, 0));
        c.right = {1, 0, 0};
        c.up = {0, 0, -1};
        c.forward = {0, 1, 0};
        c.left = c.bottom = -0.5;
        c.rightEdge = c.top = 0.5;
        return c;
    }();
    scene.gbuffer.camera = camera.matrices();
    AdoptedRig rig(scene);
    LWHorizonDesc horizon;
    LWAoDesc ao;
    LWScreenSpaceDesc screenSpace;
    lwDefaultHorizon(&horizon);
    lwDefaultAo(&ao);
    lwDefaultScreenSpace(&screenSpace);
    ao.packing = 0;
    screenSpace.start = LW_START_FULL;
    screenSpace.autoError = GENERATE(0.0f, 0.1f);
    horizon.history = ao.history = screenSpace.history = history;
    const void* desc = name == "horizon" ? static_cast<const void*>(&horizon) : name == "ao" ? static_cast<const void*>(&ao) : &screenSpace;
    LWTechnique failed = nullptr, fresh = nullptr;
    REQUIRE(lwCreateTechnique(rig.device, name.c_str(), desc, &failed) == LW_SUCCESS);
    REQUIRE(lwCreateTechnique(rig.device, name.c_str(), desc, &fresh) == LW_SUCCESS);
    Gate gate(rig.host);
    scene.frame.sync = gate.sync();
    REQUIRE(lwUpdate(failed, &scene.frame) == LW_SUCCESS);
    REQUIRE(lwRender(failed, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    gate.open(-7777);
    REQUIRE(lwFinish(rig.device) == LW_ERROR_DEVICE);
    scene.frame.sync = nullptr;
    std::vector<std::vector<double>> pictures;
    for (const LWTechnique technique : {failed, fresh}) {
        REQUIRE(lwUpdate(technique, &scene.frame) == LW_SUCCESS);
        REQUIRE(lwRender(technique, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
        REQUIRE(lwFinish(rig.device) == LW_SUCCESS);
        pictures.push_back(pixelsOf(scene.irradiance));
        CHECK(lwReleaseTechnique(technique) == LW_SUCCESS);
    }
    CHECK(pictures[0] == pictures[1]);
    CHECK(*std::max_element(pictures[1].begin(), pictures[1].end()) > 1e-3);
}
