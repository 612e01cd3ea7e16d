// What a host relies on with technique lpv's specularRadiance: memory, nothing compiled after lwPrewarm, refusals, frames, cameras.
#include <catch2/catch.hpp>

#include "support/lpv_mirrors.h"
#include "support/lpv_specular_bytes.h"
#include "support/packed_light.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;

TEST_CASE("specular radiance: nothing is compiled after lwPrewarm, memory is as estimated", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(32, evenProfile);
    const Mirrors scene;
    const RoomTriangles room(1.0);
    const auto transport = GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP);
    const auto resolution = GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_HALF);
    const LWLpvDesc desc = descOf(transport, resolution);
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    const std::vector<LWLight> lights = {floor.light};
    const LWFrame frame = frameOf(lights, &room.geometry);
    technique.update(frame);
    render(technique, device, view, scene.gbuffer);
    render(technique, device, view, scene.gbuffer, {true, true});
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
    LWViewDesc size{};
    size.structSize = sizeof size;
    size.maxWidth = kWidth;
    size.maxHeight = kHeight;
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateFrameMemory(device, "lpv", &desc, &size, &frame, &estimate) == LW_SUCCESS);
    // The estimate is of images that have to be unpacked; these are used in place, or copied as they are.
    const std::uint64_t unpacked = (3 + 3 + 3 + 1) * sizeof(float) * 48 * kHeight + specularUnpackedBytes(48 * kHeight);
    const std::uint64_t held = technique.stats().deviceBytes;
    if (device.info().hostUnifiedMemory && transport == LW_LPV_TRANSPORT_PROPAGATE)
        CHECK(held + unpacked == estimate);
    else
        CHECK(held <= estimate);
}

TEST_CASE("specular radiance: who cannot make it says so, as does one without a camera", "[lpv]") {
    TestDevice device(16);
    Mirrors scene;
    PlanarPixels pixels(kWidth, kHeight, 3);
    LWOutput output{};
    output.structSize = sizeof output;
    output.specularRadiance = pixels.image();
    TestView view(device, kWidth, kHeight);
    LWRsmDesc rsm;
    lwDefaultRsm(&rsm);
    TestTechnique other(device, rsm);
    other.update(frameOf({}, nullptr));
    CHECK(lwRender(other, view, &scene.gbuffer, &output) == LW_ERROR_UNSUPPORTED);
    CHECK_THAT(lastError(device), Contains("output.specularRadiance") && Contains("rsm"));
    const LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_PROPAGATE);
    TestTechnique technique(device, "lpv", &desc);
    technique.update(frameOf({}, nullptr));
    LWLpvDesc nested = descOf(GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP));
    nested.cascades = 3;
    TestTechnique cascaded(device, "lpv", &nested);
    cascaded.update(frameOf({}, nullptr));
    CHECK(lwRender(cascaded, view, &scene.gbuffer, &output) == LW_ERROR_UNSUPPORTED);
    CHECK_THAT(lastError(device), Contains("output.specularRadiance") && Contains("cascades=1") && Contains("got cascades=3"));
    scene.gbuffer.camera = LWCamera{};
    CHECK(lwRender(technique, view, &scene.gbuffer, &output) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("gbuffer.camera"));
}

TEST_CASE("frames of a sweep: specular radiance is that of the light that irradiance shows", "[lpv]") {
    TestDevice device(16);
    const Mirrors scene;
    const RoomTriangles room(1.0);
    LitFloor dim(96, evenProfile), bright(96, [](double, double) { return 3.0; });
    const std::vector<LWLight> dimLights = {dim.light}, brightLights = {bright.light};
    LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_SWEEP);
    desc.size = 16;
    desc.bounces = 2;
    const auto now = [&](const std::vector<LWLight>& lights) { return renderOnce(device, desc, frameOf(lights, &room.geometry), scene.gbuffer); };
    const std::vector<float> ofDim = now(dimLights), ofBright = now(brightLights);
    REQUIRE(meanOf(ofBright) > 2.5 * meanOf(ofDim));
    desc.frames = 4;
    // Asked for in every frame, or by the last one first.
    for (const bool always : {true, false}) {
        TestTechnique technique(device, "lpv", &desc);
        TestView view(device, kWidth, kHeight);
        technique.update(frameOf(dimLights, &room.geometry));
        CHECK((render(technique, device, view, scene.gbuffer).specular == ofDim));
        for (std::uint32_t update = 1; update <= 2 * desc.frames; ++update) {
            CAPTURE(always, update);
            technique.update(frameOf(brightLights, &room.geometry));
            const bool isComplete = update == desc.bounces * desc.frames;
            if (always || isComplete) CHECK((render(technique, device, view, scene.gbuffer).specular == (isComplete ? ofBright : ofDim)));
        }
    }
}

TEST_CASE("specular radiance of an orthographic view is that of an eye far away, whichever way its axis points", "[lpv]") {
    TestDevice device(16);
    LitFloor floor(96, evenProfile);
    const RoomTriangles room(1.0);
    const std::vector<LWLight> lights = {floor.light};
    const LWFrame frame = frameOf(lights, &room.geometry);
    const LWLpvDesc desc = descOf(LW_LPV_TRANSPORT_SWEEP);
    Mirrors scene(1.0, 0.1f);
    const glm::dvec3 towards = glm::normalize(glm::dvec3(0.1, 0.9, -0.3));
    scene.gbuffer.camera = lookAt(-1e5 * towards, glm::dvec3(0.0), 0.7).matrices();
    const std::vector<float> far = renderOnce(device, desc, frame, scene.gbuffer);
    CHECK(meanOf(far) > 0.01);
    for (const bool isLeft : {false, true}) {
        TestCamera camera = lookAt(-2.0 * towards, glm::dvec3(0.0), 2.0);
        camera.orthographic = true;
        camera.leftHanded = isLeft;
        scene.gbuffer.camera = camera.matrices();
        CAPTURE(isLeft);
        CHECK(difference(renderOnce(device, desc, frame, scene.gbuffer), far) < 0.03);
    }
}
