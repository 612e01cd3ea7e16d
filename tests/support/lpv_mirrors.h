// The lit room's wall and ceiling as mirrors, and technique lpv's radiance along their lobes.
#pragma once

#include <catch2/catch.hpp>
#include <vector>

#include "support/lpv_room.h"
#include "support/scoped_api.h"
#include "support/view_scene.h"

namespace lightwell::test {

inline constexpr std::uint32_t kWidth = 45, kHeight = 30;

inline double evenProfile(double, double) { return 1.0; }

inline LWLpvDesc descOf(LWLpvTransport transport, LWResolution resolution = LW_RESOLUTION_FULL) {
    LWLpvDesc desc;
    lwDefaultLpv(&desc);
    desc.transport = transport;
    desc.size = 32;
    desc.resolution = resolution;
    return desc;
}

inline LWFrame frameOf(const std::vector<LWLight>& lights, const LWGeometry* geometry, float environment = 0.0f) {
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.lights = lights.data();
    frame.lightCount = std::uint32_t(lights.size());
    frame.geometry = geometry;
    frame.environment[0] = frame.environment[1] = frame.environment[2] = environment;
    return frame;
}

// The lit room's wall and ceiling, seen from inside it.
struct Mirrors : WallAndCeiling {
    glm::dvec3 eye{0.0, 0.6, 0.5};
    PlanarPixels roughness{kWidth, kHeight, 1};
    explicit Mirrors(double scale = 1.0, float rough = 0.0f) : WallAndCeiling(kWidth, kHeight, scale) {
        eye *= scale;
        gbuffer.camera = lookAt(eye, eye + glm::dvec3(0.0, 0.2, -0.3), 0.7).matrices();
        for (std::uint32_t y = 0; y < kHeight; ++y)
            for (std::uint32_t x = 0; x < kWidth; ++x) roughness.at(x, y, 0) = rough;
        gbuffer.roughness = roughness.image();
    }
    // Where a mirrored ray meets the floor's plane, or far off.
    reference::Vec floorOf(std::uint32_t x, std::uint32_t y) const {
        const reference::Vec p = position.get(x, y), n = normal.get(x, y), v = reference::unit(reference::Vec{eye.x, eye.y, eye.z} - p);
        const reference::Vec r = n * (2.0 * reference::dot(v, n)) - v;
        return r.y < 0.0 ? p + r * (-p.y / r.y) : reference::Vec{1e9, 0, 1e9};
    }
};

struct Asked {
    bool specular = true, irradiance = false;
};

struct Picture {
    std::vector<float> specular, irradiance;
};

inline Picture render(TestTechnique& technique, LWDevice device, const TestView& view, const LWGBuffer& gbuffer, Asked asked = {}) {
    PlanarPixels specular(view.width(), view.height(), 3), irradiance(view.width(), view.height(), 3);
    LWOutput output{};
    output.structSize = sizeof output;
    if (asked.specular) output.specularRadiance = specular.image();
    if (asked.irradiance) output.irradiance = irradiance.image();
    const LWStatus status = lwRender(technique, view, &gbuffer, &output);
    INFO(lastError(device));
    REQUIRE(status == LW_SUCCESS);
    REQUIRE(lwFinish(device) == LW_SUCCESS);
    return {specular.packed(), irradiance.packed()};
}

inline std::vector<float> renderOnce(LWDevice device, const LWLpvDesc& desc, const LWFrame& frame, const LWGBuffer& gbuffer) {
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    technique.update(frame);
    return render(technique, device, view, gbuffer).specular;
}

}  // namespace lightwell::test
