// A driver that fails at any call of technique cone_tracing's frames: it is told, and the next frames are right.
#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "api/api_rig.h"
#include "support/cl_faults.h"

using namespace lightwell::test;

namespace {

constexpr int kMostCalls = 2000;

std::vector<double> pixelsOf(const ApiScene& scene) {
    std::vector<double> all;
    for (std::uint32_t y = 0; y < scene.irradiance.height(); ++y)
        for (std::uint32_t x = 0; x < scene.irradiance.width(); ++x)
            for (int c = 0; c < 3; ++c) all.push_back(scene.irradiance.value(x, y, c));
    return all;
}

bool isDriverError(LWStatus status) {
    return status == LW_ERROR_OUT_OF_MEMORY || status == LW_ERROR_DEVICE || status == LW_ERROR_INTERNAL;
}

// The rig's floor, and a slope that looks down on it, as triangles.
struct Whole : ApiScene {
    Whole() {
        geometry.structSize = sizeof geometry;
        geometry.vertices = vertices;
        geometry.vertexCount = 6;
        geometry.triangleCount = 2;
        frame.geometry = &geometry;
    }
    LWGeometry geometry{};
    float vertices[18] = {-1, 0, -1, 0, 0, 1, 1, 0, -1, -1, 1, -1, 1, 1, -1, 0, 1, 1};
};

}  // namespace

TEST_CASE("whichever OpenCL call of a cone_tracing frame fails, it is told, and the next frames are right", "[faults][cone_tracing]") {
    LWConeTracingDesc desc;
    lwDefaultConeTracing(&desc);
    desc.size = 32;
    desc.extent = 3.0f;
    desc.resolution = GENERATE(LW_CONE_RESOLUTION_HALF, LW_CONE_RESOLUTION_INTERLEAVED);
    desc.bounces = desc.resolution == LW_CONE_RESOLUTION_HALF ? 1 : 0;
    Whole scene;
    // Faces down, or nothing would arrive.
    for (std::uint32_t y = 0; y < scene.position.height(); ++y)
        for (std::uint32_t x = 0; x < scene.position.width(); ++x)
            if (x >= scene.position.width() / 2) {
                const double u = (x + 0.5) / scene.position.width(), v = (y + 0.5) / scene.position.height();
                scene.position.set(x, y, u - 0.5, 0.9, v - 0.5);
                scene.normal.set(x, y, 0, -1, 0);
            }
    ApiRig rig(makeDevice(16, [](void*, LWLogLevel, const char*) {}), scene);
    // Before the frame that fails the scene is another, so that all that is kept from frame to frame has to be made anew.
    Whole before;
    before.geometry.triangleCount = 1;
    before.geometry.vertexCount = 3;
    scene.geometry.version = 1;
    scene.frame.reset = 1;  // further bounces begin with it
    const auto create = [&] {
        lwReleaseTechnique(rig.technique);
        REQUIRE(lwCreateConeTracing(rig.device, &desc, &rig.technique) == LW_SUCCESS);
    };
    create();
    rig.frame(scene);
    const std::vector<double> expected = pixelsOf(scene);
    double most = 0;
    for (const double value : expected) most = std::max(most, value);
    REQUIRE(most > 1e-3);
    for (int call = 0; call < kMostCalls; ++call) {
        create();
        const bool again = call % 2 == 0;  // the fault in the second frame, or in the first
        if (again) rig.frame(before);
        LWStatus updated, rendered, finished;
        bool happened;
        std::string function;
        {
            const ClFault fault(call / 2 * 29, CL_OUT_OF_RESOURCES);  // some of many alike
            updated = lwUpdate(rig.technique, &scene.frame);
            rendered = lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output);
            finished = lwFinish(rig.device);
            happened = fault.happened();
            function = fault.function();
        }
        CAPTURE(desc.resolution, call, again, function, updated, rendered, finished);
        if (!happened) {
            CHECK(updated == LW_SUCCESS);
            if (again) continue;
            break;
        }
        CHECK(int(isDriverError(updated)) + int(isDriverError(rendered)) + int(isDriverError(finished)) == 1);
        for (int after = 0; after < 2; ++after) {
            rig.frame(scene);
            REQUIRE(pixelsOf(scene) == expected);
        }
    }
}
