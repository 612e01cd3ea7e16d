// A floor lit by a sun, seen by one view: the smallest frame that a technique can light, through the
// API.
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "lightwell/lightwell.h"
#include "support/camera_matrices.h"
#include "support/host_image.h"

namespace lightwell::test {

inline LWDevice makeDevice(std::uint32_t width, LWLogCallback log = nullptr, void* user = nullptr) {
    LWDeviceDesc desc;
    lwDefaultDevice(&desc);
    desc.width = width;
    desc.log = log;
    desc.logUser = user;
    LWDevice device = nullptr;
    lwCreateDevice(&desc, &device);
    return device;
}

inline std::string lastError(LWDevice device = nullptr) {
    const char* message = nullptr;
    lwGetLastError(device, &message);
    return message;
}

class ApiScene {
public:
    explicit ApiScene(std::uint32_t w = 24, std::uint32_t h = 10)
        : position(LW_FORMAT_FLOAT3, w, h),
          normal(LW_FORMAT_FLOAT3, w, h),
          irradiance(LW_FORMAT_FLOAT3, w, h),
          validity(LW_FORMAT_FLOAT1, w, h),
          rsmPosition(LW_FORMAT_FLOAT3, kRsm, kRsm),
          rsmNormal(LW_FORMAT_FLOAT3, kRsm, kRsm),
          rsmFlux(LW_FORMAT_FLOAT3, kRsm, kRsm) {
        for (std::uint32_t y = 0; y < kRsm; ++y)
            for (std::uint32_t x = 0; x < kRsm; ++x) {
                rsmPosition.set(x, y, (x + 0.5) / kRsm - 0.5, 0, (y + 0.5) / kRsm - 0.5);
                rsmNormal.set(x, y, 0, 1, 0);
                rsmFlux.set(x, y, 1.0 / (kRsm * kRsm), 0.5 / (kRsm * kRsm), 0);
            }
        for (std::uint32_t y = 0; y < h; ++y)
            for (std::uint32_t x = 0; x < w; ++x) {
                position.set(x, y, (x + 0.5) / w - 0.5, 0.5, (y + 0.5) / h - 0.5);
                normal.set(x, y, 0, -1, 0);
            }
        TestCamera camera = testCamera(kOrthographic, glm::dvec3(0, 2, 0));
        camera.right = {1, 0, 0};
        camera.up = {0, 0, -1};
        camera.forward = {0, -1, 0};
        camera.left = camera.bottom = -0.5;
        camera.rightEdge = camera.top = 0.5;
        rsm.structSize = sizeof rsm;
        rsm.position = rsmPosition.image();
        rsm.normal = rsmNormal.image();
        rsm.flux = rsmFlux.image();
        rsm.camera = camera.matrices();
        light.structSize = sizeof light;
        light.kind = LW_LIGHT_DIRECTIONAL;
        light.direction[1] = -1;
        light.rsmCount = 1;
        light.rsms = &rsm;
        frame.structSize = sizeof frame;
        frame.frameIndex = 12345;
        frame.lightCount = 1;
        frame.lights = &light;
        gbuffer.structSize = sizeof gbuffer;
        gbuffer.position = position.image();
        gbuffer.normal = normal.image();
        output.structSize = sizeof output;
        output.irradiance = irradiance.image();
        output.validity = validity.image();
    }
    ApiScene(const ApiScene&) = delete;
    ApiScene& operator=(const ApiScene&) = delete;

    LWViewDesc viewDesc() const {
        LWViewDesc desc{};
        desc.structSize = sizeof desc;
        desc.maxWidth = position.width();
        desc.maxHeight = position.height();
        return desc;
    }
    bool lit() const {
        for (std::uint32_t y = 0; y < irradiance.height(); ++y)
            for (std::uint32_t x = 0; x < irradiance.width(); ++x)
                if (!(irradiance.value(x, y, 0) > 0.01 && irradiance.value(x, y, 2) == 0.0))
                    return false;
        return true;
    }

    static constexpr std::uint32_t kRsm = 16;
    HostImage position, normal, irradiance, validity, rsmPosition, rsmNormal, rsmFlux;
    LWRsm rsm{};
    LWLight light{};
    LWFrame frame{};
    LWGBuffer gbuffer{};
    LWOutput output{};
};

}  // namespace lightwell::test
