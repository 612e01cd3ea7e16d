// Technique static_vpl's list of lights: any flux, read often, late, and after frames that were refused.
#include <catch2/catch.hpp>
#include <string>

#include "support/static_vpl_rig.h"

using namespace lightwell::test;

TEST_CASE("lights have place and axis whatever their flux", "[static_vpl]") {
    LWStaticVplDesc desc = keepAll();
    desc.lights = 2;
    StaticRig rig(GENERATE(1u, 16u), desc);
    StaticScene scene;
    // Two clusters a metre wide, one facing up, one facing along x.
    for (int i = 0; i < 4; ++i) {
        scene.vpls.push_back(staticVpl({0.3 * i, 0, 0}, {0, 1, 0.1}, 1.0));
        scene.vpls.push_back(staticVpl({10, 4 + 0.3 * i, 0}, {1, -0.1, 0}, 1.0));
    }
    for (const double flux : {1e-42, 1e-30, 1e-24, 1e-20, 1.0, 1e10, 1e20, 1e26, 1e29}) {
        CAPTURE(flux);
        scene.lights = {sunLight({0, -1, 0}, glm::dvec3(flux)), sunLight({-1, 0, 0}, glm::dvec3(flux))};
        rig.update(scene);
        rig.lights();
        rig.update(scene);
        const auto lights = rig.lights();
        REQUIRE(lights.size() == 2);
        for (const LWListedLight& light : lights) {
            CHECK(glm::length(vec(light.axis)) == Approx(1.0).epsilon(1e-5));
            const bool up = light.position[0] < 5.0f;
            CHECK(glm::dot(vec(light.axis),
                           glm::normalize(up ? glm::dvec3(0, 1, 0.1) : glm::dvec3(1, -0.1, 0))) ==
                  Approx(1.0).epsilon(1e-5));
            CHECK(double(light.position[0]) == Approx(up ? 0.45 : 10.0).epsilon(1e-3));
            CHECK(light.vpls == 4);
        }
    }
}

TEST_CASE("the list is the last whole update's, however often and late it is read", "[static_vpl]") {
    LWStaticVplDesc desc = keepAll();
    desc.lights = 5;
    StaticRig rig(16, desc);
    StaticScene scene;
    scene.vpls = roomOfPlaces(60, 4);
    scene.lights = {pointLight({2, 1.5, 2.5}, {10, 12, 14})};
    const auto bits = [&] {
        const auto lights = rig.lights();
        const auto* bytes = reinterpret_cast<const char*>(lights.data());
        return std::string(bytes, lights.size() * sizeof(LWListedLight));
    };
    rig.update(scene);
    LWListedLight one{};
    std::uint32_t count = 0;
    CHECK(lwReadLightList(rig.technique, &one, 1, &count) == LW_ERROR_INVALID_ARGUMENT);
    lastError(rig.device);
    const std::string first = bits();
    CHECK(bits() == first);
    StaticScene refused = scene;
    refused.vpls.resize(10);
    refused.vpls[9].weight = -1.0f;
    CHECK(rig.tryUpdate(refused) == LW_ERROR_INVALID_ARGUMENT);
    refused = scene;
    refused.blockers.resize(1025);
    CHECK(rig.tryUpdate(refused) == LW_ERROR_INVALID_ARGUMENT);
    lastError(rig.device);
    CHECK(bits() == first);
    // Another number of places and lights, and back, is another scene; the first one comes out as it
    // did.
    StaticScene other = scene;
    other.vpls.resize(7);
    other.lights.push_back(sunLight({0, -1, 0}, {1, 1, 1}));
    rig.update(other);
    CHECK(bits() != first);
    rig.update(scene);
    CHECK(bits() == first);
}
