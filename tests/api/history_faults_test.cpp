// A driver that fails at any call of a frame of a technique that keeps frames: it is told, and what follows is what follows a
// reset, not a mean with half a frame.
#include <catch2/catch.hpp>
#include <functional>
#include <string>
#include <vector>

#include "api/api_rig.h"
#include "support/cl_faults.h"

using namespace lightwell::test;

namespace {

constexpr int kMostCalls = 2000, kFrames = 3;

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

struct Maker {
    const char* name;
    std::function<LWStatus(LWDevice, LWTechnique*)> make;
    int stride;  // of the calls that fail: some of many alike
};

std::vector<Maker> makers() {
    return {{"rsm",
             [](LWDevice device, LWTechnique* technique) {
                 LWRsmDesc desc;
                 lwDefaultRsm(&desc);
                 desc.vpls = 8;  // few, so that frames differ
                 desc.history = 8;
                 return lwCreateRsm(device, &desc, technique);
             },
             3},
            {"ssvp",
             [](LWDevice device, LWTechnique* technique) {
                 LWSsvpDesc desc;
                 lwDefaultSsvp(&desc);
                 desc.vpls = 8;
                 desc.clusters = 2;
                 desc.secondVpls = 4;
                 desc.mapSize = 64;
                 desc.history = 8;
                 return lwCreateSsvp(device, &desc, technique);
             },
             17},
            {"screen_space",
             [](LWDevice device, LWTechnique* technique) {
                 LWScreenSpaceDesc desc;
                 lwDefaultScreenSpace(&desc);
                 desc.start = LW_START_FULL;
                 desc.levels = 2;
                 desc.samples = 8;
                 desc.radius = 64.0f;  // of 720 rows: reaches across the wall's foot
                 desc.history = 8;
                 return lwCreateScreenSpace(device, &desc, technique);
             },
             7},
            {"horizon",
             [](LWDevice device, LWTechnique* technique) {
                 LWHorizonDesc desc;
                 lwDefaultHorizon(&desc);
                 desc.directions = 4;
                 desc.history = 8;
                 return lwCreateHorizon(device, &desc, technique);
             },
             7}};
}

}  // namespace

TEST_CASE("whichever OpenCL call of a frame fails, frames that are kept start anew", "[faults][history]") {
    ApiScene scene(48, 48);
    // A wall beside the floor, so that the view has light to send and to receive.
    HostImage radiance(LW_FORMAT_FLOAT3, scene.position.width(), scene.position.height());
    for (std::uint32_t y = 0; y < scene.position.height(); ++y)
        for (std::uint32_t x = 0; x < scene.position.width(); ++x) {
            const double u = (x + 0.5) / scene.position.width(), v = (y + 0.5) / scene.position.height();
            const bool wall = x < scene.position.width() / 2;
            scene.position.set(x, y, u - 0.5, wall ? 0.5 - u : 0.0, v - 0.5);
            scene.normal.set(x, y, wall ? 0.70710678 : 0.0, wall ? 0.70710678 : 1.0, 0);
            radiance.set(x, y, wall ? 1.0 : 0.1, 0.5, 0.25);
        }
    scene.gbuffer.directRadiance = radiance.image();
    scene.gbuffer.camera = scene.gbuffer.previousCamera = scene.rsm.camera;
    for (const Maker& maker : makers()) {
        ApiRig rig(makeDevice(16, [](void*, LWLogLevel, const char*) {}), scene);
        const auto create = [&] {
            lwReleaseTechnique(rig.technique);
            rig.technique = nullptr;
            REQUIRE(maker.make(rig.device, &rig.technique) == LW_SUCCESS);
        };
        CAPTURE(maker.name);
        create();
        rig.frame(scene);
        std::vector<std::vector<double>> expected;
        for (int frame = 0; frame < kFrames; ++frame) {
            scene.frame.reset = frame == 0 ? 1 : 0;
            rig.frame(scene);
            expected.push_back(pixelsOf(scene));
        }
        CHECK((expected[0] != expected[1]));
        int faults = 0;
        for (int call = 0; call < kMostCalls; ++call) {
            create();
            rig.frame(scene);
            LWStatus updated, rendered, finished;
            bool happened;
            std::string function;
            {
                const ClFault fault(call * maker.stride, CL_OUT_OF_RESOURCES);
                updated = lwUpdate(rig.technique, &scene.frame);
                rendered = lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output);
                finished = lwFinish(rig.device);
                happened = fault.happened();
                function = fault.function();
            }
            if (!happened) break;
            ++faults;
            CAPTURE(call, function, updated, rendered, finished);
            CHECK(int(isDriverError(updated)) + int(isDriverError(rendered)) + int(isDriverError(finished)) == 1);
            if (isDriverError(finished)) continue;  // all of it was on its way
            for (int after = 0; after < kFrames; ++after) {
                rig.frame(scene);
                CAPTURE(after);
                REQUIRE((pixelsOf(scene) == expected[std::size_t(after)]));
            }
        }
        CHECK(faults > 5);
    }
}
