// A driver that fails at any call of a frame of technique static_vpl with shadows: it is told, and the next frames are right.
#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "api/api_rig.h"
#include "support/cl_faults.h"

using namespace lightwell::test;

namespace {

constexpr int kMostCalls = 4000;
constexpr std::uint32_t kPlaces = 6;

bool isDriverError(LWStatus status) {
    return status == LW_ERROR_OUT_OF_MEMORY || status == LW_ERROR_DEVICE || status == LW_ERROR_INTERNAL;
}

// Places on the rig's floor under the surfaces above it, and a plate in between, as triangles.
struct Whole : ApiScene {
    Whole() {
        for (std::uint32_t i = 0; i < kPlaces; ++i) {
            vpls[i].position[0] = float(i) / kPlaces - 0.4f;
            vpls[i].normal[1] = 1.0f;
            for (float& part : vpls[i].reflectance) part = 0.5f;
        }
        sun.structSize = sizeof sun;
        sun.direction[1] = -1.0f;
        for (float& part : sun.irradiance) part = 4.0f;
        geometry.structSize = sizeof geometry;
        geometry.vertices = vertices;
        geometry.vertexCount = 6;
        geometry.triangleCount = 2;
        frame.geometry = &geometry;
        frame.lights = &sun;
        frame.lightCount = 1;
        frame.staticVpls = vpls;
        frame.staticVplCount = kPlaces;
    }
    std::vector<double> pixels() const {
        std::vector<double> all;
        for (std::uint32_t y = 0; y < irradiance.height(); ++y)
            for (std::uint32_t x = 0; x < irradiance.width(); ++x)
                for (int c = 0; c < 3; ++c) all.push_back(irradiance.value(x, y, c));
        return all;
    }
    LWStaticVpl vpls[kPlaces] = {};
    LWLight sun{};
    LWGeometry geometry{};
    float vertices[18] = {-0.2f, 0.25f, -1, 0.1f, 0.25f, -1, 0, 0.25f, 1, -1, 0, -1, 0, 0, 1, 1, 0, -1};
};

}  // namespace

TEST_CASE("whichever OpenCL call of a static_vpl frame with shadows fails, it is told, and the next frames are right", "[faults][static_vpl]") {
    LWStaticVplDesc desc;
    lwDefaultStaticVpl(&desc);
    desc.bounces = 2;
    desc.visibility = GENERATE(LW_VISIBILITY_HARD, LW_VISIBILITY_VOXEL);
    desc.clusters = desc.visibility == LW_VISIBILITY_HARD ? 2 : 0;
    desc.mapSize = 64;
    desc.voxels = 32;
    Whole scene;
    ApiRig rig(makeDevice(16, [](void*, LWLogLevel, const char*) {}), scene);
    // Before the frame that fails the scene is another, so that all that is kept from frame to frame has to be made anew.
    Whole before;
    before.geometry.triangleCount = 1;
    before.geometry.vertexCount = 3;
    scene.geometry.version = 1;
    scene.frame.reset = 1;  // clusters begin with it
    const auto create = [&] {
        lwReleaseTechnique(rig.technique);
        REQUIRE(lwCreateStaticVpl(rig.device, &desc, &rig.technique) == LW_SUCCESS);
    };
    create();
    rig.frame(scene);
    const std::vector<double> expected = scene.pixels();
    REQUIRE(*std::max_element(expected.begin(), expected.end()) > 1e-3);
    int faults = 0;
    for (int call = 0; call < kMostCalls; ++call) {
        create();
        const bool again = call % 2 == 0;  // the fault in the second frame, or in the first
        if (again) rig.frame(before);
        LWStatus updated, rendered, finished;
        bool happened;
        std::string function;
        {
            const ClFault fault(call / 2 * 7, CL_OUT_OF_RESOURCES);  // some of many alike
            updated = lwUpdate(rig.technique, &scene.frame);
            rendered = lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output);
            finished = lwFinish(rig.device);
            happened = fault.happened();
            function = fault.function();
        }
        CAPTURE(desc.visibility, call, again, function, updated, rendered, finished);
        if (!happened) {
            CHECK(updated == LW_SUCCESS);
            if (again) continue;
            break;
        }
        ++faults;
        CHECK(int(isDriverError(updated)) + int(isDriverError(rendered)) + int(isDriverError(finished)) == 1);
        for (int after = 0; after < 2; ++after) {
            rig.frame(scene);
            REQUIRE(scene.pixels() == expected);
        }
    }
    CHECK(faults > 20);
}
