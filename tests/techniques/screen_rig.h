// One frame of a technique that looks at the view's own pixels, through the C API.
#pragma once

#include "support/scoped_api.h"
#include "support/view_scene.h"

namespace lightwell::test {

inline ScreenResult renderScreen(TestTechnique& technique, const TestView& view, LWDevice device, const LWGBuffer& gbuffer,
                                 unsigned outputs = kIrradiance | kValidity | kAmbient) {
    PlanarPixels irradiance(view.width(), view.height(), 3), validity(view.width(), view.height(), 1),
        ambient(view.width(), view.height(), 1);
    LWOutput output{};
    output.structSize = sizeof output;
    if (outputs & kIrradiance) output.irradiance = irradiance.image();
    if (outputs & kValidity) output.validity = validity.image();
    if (outputs & kAmbient) output.ambientOcclusion = ambient.image();
    LWFrame frame;
    LW_INIT(frame);
    technique.update(frame);
    const LWStatus status = lwRender(technique, view, &gbuffer, &output);
    INFO(lastError(device));
    REQUIRE(status == LW_SUCCESS);
    REQUIRE(lwFinish(device) == LW_SUCCESS);
    ScreenResult result;
    if (outputs & kIrradiance) result.irradiance = irradiance.packed();
    if (outputs & kValidity) result.validity = validity.packed();
    if (outputs & kAmbient) result.ambient = ambient.packed();
    return result;
}

// Every pixel on its own: nothing interleaved.
inline LWHorizonDesc horizonDesc(std::uint32_t directions, std::uint32_t steps, LWResolution resolution = LW_RESOLUTION_FULL) {
    LWHorizonDesc desc;
    lwDefaultHorizon(&desc);
    desc.directions = directions;
    desc.steps = steps;
    desc.interleave = 1;
    desc.resolution = resolution;
    return desc;
}

// A lit floor patch and the wall over its far edge, all in view.
inline ViewScene litScene(double radiance = 1.0) {
    ViewScene scene;
    scene.quad({-0.5, 0, 0}, {1, 0, 0}, {0, 0, 1}, radiance);
    scene.quad({-0.5, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.0);
    return scene;
}

// On a fresh technique.
inline ScreenResult renderScreen(LWDevice device, const char* name, const void* desc, DrawnView& drawn,
                                 unsigned outputs = kIrradiance | kValidity | kAmbient) {
    TestTechnique technique(device, name, desc);
    TestView view(device, drawn.position.width(), drawn.position.height());
    return renderScreen(technique, view, device, drawn.gbuffer, outputs);
}

}  // namespace lightwell::test
