// Frames of which one OpenCL call fails, whichever it is: it is told once, and the next frames are
// right.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "api/api_rig.h"
#include "support/cl_faults.h"

namespace lightwell::test {

inline std::vector<double> pixelsOf(const ApiScene& scene) {
    std::vector<double> all;
    for (std::uint32_t y = 0; y < scene.irradiance.height(); ++y)
        for (std::uint32_t x = 0; x < scene.irradiance.width(); ++x)
            for (int c = 0; c < 3; ++c) all.push_back(scene.irradiance.value(x, y, c));
    return all;
}

// The second half of the picture on a slope that faces down on the rest, where light of the floor
// arrives.
inline void faceDown(ApiScene& scene) {
    for (std::uint32_t y = 0; y < scene.position.height(); ++y)
        for (std::uint32_t x = scene.position.width() / 2; x < scene.position.width(); ++x) {
            const double u = (x + 0.5) / scene.position.width(), v = (y + 0.5) / scene.position.height();
            scene.position.set(x, y, u - 0.5, 0.9, v - 0.5);
            scene.normal.set(x, y, 0, -1, 0);
        }
}

// The rig's floor, and a slope that looks down on it, as triangles.
struct FloorAndSlope : ApiScene {
    FloorAndSlope() {
        geometry.structSize = sizeof geometry;
        geometry.vertices = vertices;
        geometry.vertexCount = 6;
        geometry.triangleCount = 2;
        frame.geometry = &geometry;
    }
    LWGeometry geometry{};
    float vertices[18] = {-1, 0, -1, 0, 0, 1, 1, 0, -1, -1, 1, -1, 1, 1, -1, 0, 1, 1};
};

struct FailingFrames {
    std::function<LWStatus(LWDevice, LWTechnique*)> create;
    int each = 1;  // every so many calls: some of many alike
    // One more call of each frame, where there is one; what it brings goes behind the picture.
    std::function<LWStatus(LWTechnique, std::vector<double>&)> more;
};

// `before`: another scene of the same rig, so that all that is kept from frame to frame has to be made
// anew in the frame that fails. The device keeps its log to itself.
inline void checkFailingFrames(const FailingFrames& frames, const ApiScene& before,
                               const ApiScene& scene) {
    constexpr int kMostCalls = 2000;
    ApiRig rig(makeDevice(16, [](void*, LWLogLevel, const char*) {}), scene);
    const auto create = [&] {
        lwReleaseTechnique(rig.technique);
        REQUIRE(frames.create(rig.device, &rig.technique) == LW_SUCCESS);
    };
    const auto whole = [&](const ApiScene& of) {
        rig.frame(of);
        std::vector<double> values = pixelsOf(of);
        if (frames.more) REQUIRE(frames.more(rig.technique, values) == LW_SUCCESS);
        return values;
    };
    create();
    const std::vector<double> expected = whole(scene);
    REQUIRE(*std::max_element(expected.begin(), expected.end()) > 1e-3);
    for (int call = 0; call < kMostCalls; ++call) {
        create();
        const bool again = call % 2 == 0;  // the fault in the second frame, or in the first
        if (again) whole(before);
        std::vector<LWStatus> told;
        std::vector<double> unused;
        bool happened;
        std::string function;
        {
            const ClFault fault(call / 2 * frames.each, CL_OUT_OF_RESOURCES);
            told.push_back(lwUpdate(rig.technique, &scene.frame));
            if (frames.more) told.push_back(frames.more(rig.technique, unused));
            told.push_back(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output));
            told.push_back(lwFinish(rig.device));
            happened = fault.happened();
            function = fault.function();
        }
        CAPTURE(call, again, function, told);
        if (!happened) {
            CHECK(told.front() == LW_SUCCESS);
            if (again) continue;
            return;
        }
        CHECK(std::count_if(told.begin(), told.end(), [](LWStatus status) {
                  return status == LW_ERROR_OUT_OF_MEMORY || status == LW_ERROR_DEVICE ||
                         status == LW_ERROR_INTERNAL;
              }) == 1);
        for (int after = 0; after < 2; ++after) REQUIRE(whole(scene) == expected);
    }
    FAIL("no end of calls that fail");
}

}  // namespace lightwell::test
