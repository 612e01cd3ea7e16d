// Technique lpv with rests: light that is as it was is not carried again, and no bit of any frame tells.
#include <catch2/catch.hpp>
#include <string>

#include "support/choices.h"
#include "support/lpv_room.h"
#include "support/scoped_api.h"

using namespace lightwell::test;

namespace {

constexpr std::uint32_t kWidth = 45, kHeight = 16;

LWLpvDesc descOf(LWLpvTransport transport, bool rests) {
    LWLpvDesc desc;
    lwDefaultLpv(&desc);
    desc.size = 16;
    desc.steps = 7;
    desc.transport = transport;
    desc.directions = 24;
    desc.rests = rests ? 1 : 0;
    return desc;
}

}  // namespace

TEST_CASE("lpv with rests has the bits of that without in every frame, and rests where nothing changes", "[lpv][rests]") {
    const std::uint32_t width = GENERATE(1u, 16u);
    const LWLpvTransport transport = GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP);
    CAPTURE(width, int(transport));
    TestDevice device(width);
    const LitFloor bright(32, [](double, double) { return 0.8; }), dim(32, [](double x, double) { return x < 0.0 ? 0.8 : 0.4; }),
        dark(32, [](double, double) { return 0.0; });
    RoomTriangles open(std::nullopt), closed(0.5);
    open.geometry.version = 1;
    closed.geometry.version = 2;
    const WallAndCeiling scene(kWidth, kHeight);
    const LWLpvDesc plain = descOf(transport, false), thrifty = descOf(transport, true);
    TestTechnique reference(device, "lpv", &plain), technique(device, "lpv", &thrifty);
    TestView view(device, kWidth, kHeight), other(device, kWidth, kHeight);

    struct Step {
        const LitFloor* floor;
        const RoomTriangles* room;
        float sky;
        std::uint32_t reset;
        bool rests;
        const char* what;
    };
    // Propagated light comes from the border's cells where there is a sky.
    const Step steps[] = {{&bright, &open, 0.0f, 0, false, "a first frame"},
                          {&bright, &open, 0.0f, 0, true, "still"},
                          {&dim, &open, 0.0f, 0, false, "half of the floor dimmer"},
                          {&dim, &open, 0.0f, 0, true, "still"},
                          {&dim, &closed, 0.0f, 0, false, "a plate comes"},
                          {&dim, &closed, 0.0f, 0, true, "still"},
                          {&dim, &closed, 0.5f, 0, false, "a sky"},
                          {&dim, &closed, 0.5f, 0, true, "still"},
                          {&dark, &closed, 0.0f, 0, false, "darkness"},
                          {&dark, &closed, 0.0f, 0, true, "still dark"},
                          {&bright, &open, 0.0f, 1, false, "a cut"},
                          {&bright, &open, 0.0f, 0, true, "still"}};
    for (const Step& step : steps) {
        CAPTURE(step.what);
        const std::vector<LWLight> lights = {step.floor->light};
        LWFrame frame = roomFrame(lights, &step.room->geometry);
        for (float& c : frame.environment) c = step.sky;
        frame.reset = step.reset;
        reference.update(frame);
        technique.update(frame);
        CHECK(technique.render(view, scene.gbuffer) == reference.render(other, scene.gbuffer));
        CHECK((reasonOf(technique, "rests").substr(0, 3) == "yes") == step.rests);
    }
    CHECK(reasonOf(reference, "rests").empty());
}

TEST_CASE("lpv with rests: memory as estimated, nothing compiled late, what it does not go with is refused", "[lpv][rests]") {
    TestDevice device(16);
    const LitFloor floor(32, [](double, double) { return 0.8; });
    const WallAndCeiling scene(kWidth, kHeight);
    LWFrame frame = roomFrame({}, nullptr);
    frame.lights = &floor.light;
    frame.lightCount = 1;
    LWViewDesc viewDesc{};
    viewDesc.structSize = sizeof viewDesc;
    viewDesc.maxWidth = kWidth;
    viewDesc.maxHeight = kHeight;
    for (const LWLpvTransport transport : {LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP}) {
        const LWLpvDesc desc = descOf(transport, true);
        TestView view(device, kWidth, kHeight);
        TestTechnique technique(device, "lpv", &desc);
        REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
        const LWDeviceInfo before = device.info();
        technique.update(frame);
        technique.render(view, scene.gbuffer);
        CHECK(device.info().programsBuilt == before.programsBuilt);
        CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
        std::uint64_t estimate = 0;
        REQUIRE(lwEstimateFrameMemory(device, "lpv", &desc, &viewDesc, &frame, &estimate) == LW_SUCCESS);
        CHECK(technique.stats().deviceBytes <= estimate);
    }
    const auto refused = [&](LWLpvDesc desc, const char* name) {
        LWTechnique none = nullptr;
        CHECK(lwCreateLpv(device, &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
        CHECK(lastError(device).find(name) != std::string::npos);
    };
    LWLpvDesc sweep = descOf(LW_LPV_TRANSPORT_SWEEP, true), propagate = descOf(LW_LPV_TRANSPORT_PROPAGATE, true);
    refused(descOf(LW_LPV_TRANSPORT_COARSE_TO_FINE, true), "transport");
    sweep.bounces = 2;
    refused(sweep, "bounces");
    sweep.bounces = 1;
    sweep.frames = 2;
    refused(sweep, "frames");
    propagate.autoError = 0.1f;
    refused(propagate, "autoError");
    propagate.autoError = 0.0f;
    propagate.cascades = 2;
    refused(propagate, "cascades");
}
