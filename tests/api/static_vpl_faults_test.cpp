// A driver that fails at any call of technique static_vpl's frames, with shadows or with the list of lights: it is told, and the
// next frames are right.
#include <catch2/catch.hpp>

#include "api/failing_frames.h"

using namespace lightwell::test;

namespace {

// Places on the rig's floor under a lamp and an aimed spot, two of them by their distance, past a soft sphere.
struct Lit : ApiScene {
    explicit Lit(std::uint32_t count) {
        faceDown(*this);
        for (std::uint32_t i = 0; i < count; ++i) {
            LWStaticVpl place{};
            place.position[0] = 0.2f * float(i % 4) - 0.3f;
            place.position[2] = 0.2f * float(i / 4) - 0.3f;
            place.normal[1] = 1.0f;
            place.reflectance[0] = place.reflectance[1] = place.reflectance[2] = 0.5f;
            place.weight = i < 2 ? 0.0f : 0.1f;
            places.push_back(place);
        }
        for (LWLight& lamp : lamps) {
            lamp = LWLight{};
            lamp.structSize = sizeof lamp;
            lamp.kind = LW_LIGHT_SPOT;
            lamp.position[1] = 0.8f;
            lamp.direction[1] = -1.0f;
            lamp.outerConeAngle = 1.4f;
            for (float& i : lamp.radiantIntensity) i = 2.0f;
        }
        lamps[1].hit = hit;
        lamps[0].receivers = LW_RECEIVERS_UNBAKED;
        blocker.radius = 0.2f;
        frame.lights = lamps;
        frame.lightCount = 2;
        frame.staticVpls = places.data();
        frame.staticVplCount = count;
        frame.blockers = &blocker;
        frame.blockerCount = 1;
    }
    std::vector<LWStaticVpl> places;
    LWLight lamps[2];
    LWBlocker blocker{};
    float hit[3] = {0, 0, 0};
};

constexpr std::uint32_t kPlaces = 6;

// Places on the rig's floor under the surfaces above it, and a plate in between, as triangles.
struct Shadowed : ApiScene {
    Shadowed() {
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
    LWStaticVpl vpls[kPlaces] = {};
    LWLight sun{};
    LWGeometry geometry{};
    float vertices[18] = {-0.2f, 0.25f, -1, 0.1f, 0.25f, -1, 0, 0.25f, 1, -1, 0, -1, 0, 0, 1, 1, 0, -1};
};

}  // namespace

TEST_CASE("whichever OpenCL call of a static_vpl frame fails, it is told, and the next frames are right", "[faults][static_vpl]") {
    LWStaticVplDesc desc;
    lwDefaultStaticVpl(&desc);
    desc.variant = GENERATE(LW_STATIC_VPL_STATIC, LW_STATIC_VPL_PHANTOM);
    desc.bounces = 2;
    desc.comparisons = 1;
    desc.lights = 4;
    desc.smoothing = 0.5f;
    Lit scene(20), before(12);
    scene.frame.reset = 1;  // or lights begin where the last frame left them
    CAPTURE(desc.variant);
    checkFailingFrames({[&](LWDevice device, LWTechnique* technique) { return lwCreateStaticVpl(device, &desc, technique); }, 1,
                        [](LWTechnique technique, std::vector<double>& values) {
                            LWListedLight lights[4] = {};
                            std::uint32_t count = 0;
                            const LWStatus status = lwReadLightList(technique, lights, 4, &count);
                            for (std::uint32_t i = 0; i < count; ++i)
                                for (int a = 0; a < 3; ++a) {
                                    values.push_back(double(lights[i].position[a]));
                                    values.push_back(double(lights[i].flux[a]));
                                    values.push_back(double(lights[i].bakedFlux[a]));
                                }
                            return status;
                        }},
                       before, scene);
}

TEST_CASE("whichever OpenCL call of a static_vpl frame with shadows fails, it is told, and the next frames are right", "[faults][static_vpl]") {
    LWStaticVplDesc desc;
    lwDefaultStaticVpl(&desc);
    desc.bounces = 2;
    desc.visibility = GENERATE(LW_VISIBILITY_HARD, LW_VISIBILITY_VOXEL);
    desc.clusters = desc.visibility == LW_VISIBILITY_HARD ? 2 : 0;
    desc.mapSize = 64;
    desc.voxels = 32;
    Shadowed scene, before;
    before.geometry.triangleCount = 1;
    before.geometry.vertexCount = 3;
    scene.geometry.version = 1;
    scene.frame.reset = 1;  // clusters begin with it
    CAPTURE(desc.visibility);
    checkFailingFrames({[&](LWDevice device, LWTechnique* technique) { return lwCreateStaticVpl(device, &desc, technique); }, 7, {}},
                       before, scene);
}
