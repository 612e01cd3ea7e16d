// What a host relies on with technique cone_tracing: refusals, memory, nothing compiled after lwPrewarm, nothing made anew in a static
// scene, outputs of each kind, points.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "support/choices.h"
#include "support/cone_box.h"
#include "support/points_rig.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;

namespace {

constexpr std::uint32_t kWidth = 37, kHeight = 26;
const TestCamera kInside = lookAt({0.2, 0.1, 0.9}, {0, 0, -1}, 1.2);

struct Outputs {
    PlanarPixels irradiance{kWidth, kHeight, 3}, specular{kWidth, kHeight, 3}, refracted{kWidth, kHeight, 3}, validity{kWidth, kHeight, 1},
        open{kWidth, kHeight, 1}, shadow{kWidth, kHeight, 1};
    LWOutput output{};
    Outputs() {
        output.structSize = sizeof output;
        output.irradiance = irradiance.image();
        output.validity = validity.image();
        output.ambientOcclusion = open.image();
        output.specularRadiance = specular.image();
        output.refractedRadiance = refracted.image();
        output.shadow = shadow.image();
    }
};

void render(LWDevice device, LWTechnique technique, const TestView& view, const LWGBuffer& gbuffer, const LWOutput& output) {
    const LWStatus status = lwRender(technique, view, &gbuffer, &output);
    INFO(lastError(device));
    REQUIRE(status == LW_SUCCESS);
    REQUIRE(lwFinish(device) == LW_SUCCESS);
}

}  // namespace

TEST_CASE("cones: all outputs at once are each as alone, and as wide as they are known to be", "[cone_tracing][long]") {
    TestDevice device(16);
    const auto resolution = GENERATE(LW_CONE_RESOLUTION_FULL, LW_CONE_RESOLUTION_QUARTER, LW_CONE_RESOLUTION_INTERLEAVED,
                                     LW_CONE_RESOLUTION_HALF_INTERLEAVED);
    const ConeBox box(2.0, false, 1.0, 0.5, 64);
    const DrawnView drawn(box.walls, kInside, kWidth, kHeight);
    LWConeTracingDesc desc = coneDesc(32, LW_VOXEL_MODE_ANISOTROPIC, resolution);
    TestTechnique technique(device, "cone_tracing", &desc);
    TestView view(device, kWidth, kHeight);
    technique.update(box.frame);
    Outputs all;
    render(device, technique, view, drawn.gbuffer, all.output);
    using Image = LWImage LWOutput::*;
    const std::pair<Image, PlanarPixels Outputs::*> each[] = {{&LWOutput::irradiance, &Outputs::irradiance},
                                                              {&LWOutput::validity, &Outputs::validity},
                                                              {&LWOutput::ambientOcclusion, &Outputs::open},
                                                              {&LWOutput::specularRadiance, &Outputs::specular},
                                                              {&LWOutput::refractedRadiance, &Outputs::refracted},
                                                              {&LWOutput::shadow, &Outputs::shadow}};
    for (const auto& [image, pixels] : each) {
        Outputs one;
        LWOutput output{};
        output.structSize = sizeof output;
        output.*image = one.output.*image;
        render(device, technique, view, drawn.gbuffer, output);
        CHECK((one.*pixels).packed() == (all.*pixels).packed());
    }
    // Inside of the box nothing lies outside of the grid; a mirror shows the walls' radiance, but for what cones let through.
    for (const float v : all.validity.packed()) REQUIRE(v == Approx(1.0).margin(1e-4));
    for (const PlanarPixels* share : {&all.open, &all.shadow})
        for (const float v : const_cast<PlanarPixels*>(share)->packed()) REQUIRE((v >= 0.0f && v <= 1.0f));
    CHECK(meanOf(all.specular.packed()) > 0.5 * 2.0 / ConeBox::kPi);
    CHECK(meanOf(all.specular.packed()) < 1.2 * 2.0 / ConeBox::kPi);
    CHECK(meanOf(all.open.packed()) < 0.999);
}

TEST_CASE("cones compile nothing after lwPrewarm, and take no more memory than was estimated", "[cone_tracing][long]") {
    TestDevice device(16);
    const ConeBox box(2.0, false, 1.0, 0.5, 32);
    const DrawnView drawn(box.walls, kInside, kWidth, kHeight);
    // Each set of options is a program of its own, which takes seconds to compile: two that have all kernels between them.
    const bool isFirst = GENERATE(true, false);
    LWConeTracingDesc desc = coneDesc(32, isFirst ? LW_VOXEL_MODE_ANISOTROPIC : LW_VOXEL_MODE_SH2,
                                      isFirst ? LW_CONE_RESOLUTION_INTERLEAVED
                                              : GENERATE(LW_CONE_RESOLUTION_HALF, LW_CONE_RESOLUTION_HALF_INTERLEAVED));
    desc.interpolation = isFirst ? LW_CONE_INTERPOLATION_TRILINEAR : LW_CONE_INTERPOLATION_TETRAHEDRAL;
    desc.bounces = desc.mode == LW_VOXEL_MODE_SH2 ? 1 : 0;
    desc.cascades = desc.mode == LW_VOXEL_MODE_SH2 ? 2 : 1;
    desc.normalAware = isFirst ? 1 : 2;
    desc.occlusion = desc.bounces ? LW_CONE_OCCLUSION_ALL : LW_CONE_OCCLUSION_NEAR;
    TestTechnique technique(device, "cone_tracing", &desc);
    TestView view(device, kWidth, kHeight);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    LWViewDesc size{};
    size.structSize = sizeof size;
    size.maxWidth = kWidth;
    size.maxHeight = kHeight;
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateFrameMemory(device, "cone_tracing", &desc, &size, &box.frame, &estimate) == LW_SUCCESS);
    Outputs all;
    for (int frame = 0; frame < 3; ++frame) {
        technique.update(box.frame);
        render(device, technique, view, drawn.gbuffer, all.output);
        CHECK(technique.stats().deviceBytes <= estimate);
    }
    LWFrame dark = box.frame;
    dark.geometry = nullptr;
    technique.update(dark);
    technique.render(view, drawn.gbuffer);
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
}

TEST_CASE("cones in several large grids compile nothing after lwPrewarm, whatever is asked for", "[cone_tracing][long]") {
    TestDevice device(16);
    const ConeBox box(2.0, false, 1.0, 0.5, 32);
    const DrawnView drawn(box.walls, kInside, kWidth, kHeight);
    LWConeTracingDesc desc = coneDesc(128, LW_VOXEL_MODE_ISOTROPIC, LW_CONE_RESOLUTION_FULL);
    desc.cascades = 3;
    desc.shadowLight = 3;  // which no frame of lwPrewarm's has
    TestTechnique technique(device, "cone_tracing", &desc);
    TestView view(device, kWidth, kHeight);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    technique.update(box.frame);
    Outputs all;
    all.output.shadow = LWImage{};
    render(device, technique, view, drawn.gbuffer, all.output);
    LWOutput validity{};
    validity.structSize = sizeof validity;
    validity.validity = all.output.validity;
    render(device, technique, view, drawn.gbuffer, validity);
    const PointList list = PointList::ofScene(drawn).part(0, 3);
    renderPoints(device, technique, list);
    renderPoints(device, technique, list, kPointHarmonics | kPointValidity, false);
    renderPoints(device, technique, list, kPointValidity);
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
}

TEST_CASE("cones: dense grids of the screen's surfels take no more memory than was estimated", "[cone_tracing]") {
    TestDevice device(16);
    const ConeBox box(2.0, false, 1.0, 0.5, 128);
    LWConeTracingDesc desc = coneDesc(32);
    desc.source = LW_VOXEL_SOURCE_SCREEN;
    desc.sparse = 0;
    TestTechnique technique(device, "cone_tracing", &desc);
    LWViewDesc size{};
    size.structSize = sizeof size;
    size.maxWidth = size.maxHeight = 1;
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateFrameMemory(device, "cone_tracing", &desc, &size, &box.frame, &estimate) == LW_SUCCESS);
    technique.update(box.frame);
    CHECK(technique.stats().deviceBytes <= estimate);
}

TEST_CASE("cones: nothing is made anew in a static scene, and what moves within a grid's units changes nothing", "[cone_tracing]") {
    TestDevice device(16);
    const ConeBox box(2.0, false, 1.0, 0.5, 64);
    const DrawnView drawn(box.walls, kInside, kWidth, kHeight);
    LWConeTracingDesc desc = coneDesc(32);
    desc.cascades = 2;
    desc.extent = 4.0f;  // units of a finer grid's eighth: a quarter
    TestTechnique technique(device, "cone_tracing", &desc);
    TestView view(device, kWidth, kHeight);
    float focus[3] = {0.05f, 0.02f, 0.01f};
    LWFrame frame = box.frame;
    frame.focus = focus;
    technique.update(frame);
    const std::vector<float> first = technique.render(view, drawn.gbuffer);
    CHECK(meanOf(first) > 0.5);
    CHECK(technique.count("changed_bricks") > 0);
    technique.update(frame);
    CHECK(technique.render(view, drawn.gbuffer) == first);
    CHECK(technique.count("changed_bricks") == 0);
    focus[0] = -0.1f;
    focus[2] = 0.11f;
    technique.update(frame);
    CHECK(technique.render(view, drawn.gbuffer) == first);
    CHECK(technique.count("changed_bricks") == 0);
    focus[0] = 0.3f;
    technique.update(frame);
    CHECK(technique.render(view, drawn.gbuffer) != first);
    CHECK(technique.count("changed_bricks") > 0);
}

TEST_CASE("cones at points are those at pixels, to the bit, at full resolution", "[cone_tracing]") {
    TestDevice device(GENERATE(1u, 16u));
    const ConeBox box(2.0, false, 1.0, 0.5, 64);
    const DrawnView drawn(box.walls, kInside, kWidth, kHeight);
    const LWConeTracingDesc desc = coneDesc(32);
    TestTechnique technique(device, "cone_tracing", &desc);
    TestView view(device, kWidth, kHeight);
    technique.update(box.frame);
    const std::vector<float> picture = technique.render(view, drawn.gbuffer);
    const PointLights points = renderPoints(device, technique, PointList::ofScene(drawn));
    std::vector<float> pixels(picture.size());
    const std::size_t n = picture.size() / 3;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t c = 0; c < 3; ++c) pixels[3 * i + c] = picture[c * n + i];
    CHECK(points.irradiance == pixels);
}

TEST_CASE("cones: what a frame does not bring is refused, and what is not used is told", "[cone_tracing]") {
    TestDevice device(16);
    const ConeBox box(2.0, false, 1.0, 0.5, 32);
    const DrawnView drawn(box.walls, kInside, kWidth, kHeight);
    LWConeTracingDesc desc = coneDesc(32);
    const auto refused = [&](const LWConeTracingDesc& d, const LWFrame& frame, const char* word) {
        TestTechnique technique(device, "cone_tracing", &d);
        CHECK(lwUpdate(technique, &frame) == LW_ERROR_INVALID_ARGUMENT);
        CHECK_THAT(lastError(device), Contains(word));
    };
    LWFrame bare = box.frame;
    bare.geometry = nullptr;
    desc.source = LW_VOXEL_SOURCE_TRIANGLES;
    refused(desc, bare, "source=triangles");
    desc.source = LW_VOXEL_SOURCE_SURFELS;
    refused(desc, box.frame, "source=surfels");
    desc.source = LW_VOXEL_SOURCE_AUTO;
    LWFrame bright = box.frame;
    bright.environment[1] = 1e30f;
    refused(desc, bright, "frame.environment[1]");
    TestTechnique technique(device, "cone_tracing", &desc);
    technique.update(bare);
    CHECK(reasonOf(technique, "source").find("RSM texels") != std::string::npos);
    LWVpl vpl{};
    vpl.normal[1] = vpl.flux[0] = 1.0f;
    bare.vpls = &vpl;
    bare.vplCount = 1;
    bare.lightCount = 0;
    technique.update(bare);
    CHECK(reasonOf(technique, "frame.vpls").find("not used") != std::string::npos);
    Outputs all;
    TestView view(device, kWidth, kHeight);
    LWOutput shadow{};
    shadow.structSize = sizeof shadow;
    shadow.shadow = all.output.shadow;
    CHECK(lwRender(technique, view, &drawn.gbuffer, &shadow) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("output.shadow") && Contains("shadow_light"));
    LWTechnique none = nullptr;
    for (const auto& spoil : std::vector<std::function<void(LWConeTracingDesc&)>>{
             [](LWConeTracingDesc& d) { d.size = 48; }, [](LWConeTracingDesc& d) { d.cones = 8; }, [](LWConeTracingDesc& d) { d.cascades = 5; },
             [](LWConeTracingDesc& d) { d.nudge = NAN; }, [](LWConeTracingDesc& d) { d.step = 0.01f; },
             [](LWConeTracingDesc& d) { d.refractiveIndex = 0.5f; }, [](LWConeTracingDesc& d) { d.bounces = 2; },
             [](LWConeTracingDesc& d) { d.normalAware = 3; }}) {
        LWConeTracingDesc bad = coneDesc(32);
        spoil(bad);
        CAPTURE(bad.size, bad.cones, bad.cascades, bad.nudge, bad.step, bad.refractiveIndex, bad.bounces, bad.normalAware);
        CHECK(lwCreateConeTracing(device, &bad, &none) == LW_ERROR_INVALID_ARGUMENT);
        lwReleaseTechnique(none);
    }
}

// What they leave does not close them on either side of it, what they come to from behind does.
TEST_CASE("cones: single cones where voxels are opaque from both sides", "[cone_tracing]") {
    TestDevice device(16);
    const bool hasSheet = GENERATE(false, true);
    const ConeBox box(2.0, true);
    WallTriangles open;  // a floor that emits 1 W/(sr m^2), and over it a sheet; both face up
    open.quad({-1, -1, -1}, {2, 0, 0}, {0, 0, 2}, 0.5, 1.0);
    if (hasSheet) open.quad({-1.4, 0, -1.4}, {2.8, 0, 0}, {0, 0, 2.8});
    LWLight above{};
    above.structSize = sizeof above;
    above.kind = LW_LIGHT_DIRECTIONAL;
    above.direction[1] = -1.0f;
    LWFrame frame = box.frame;
    frame.lights = &above;
    frame.lightCount = 1;
    frame.geometry = &open.geometry;
    for (float& c : frame.environment) c = 0.5f;
    const DrawnView drawn(box.walls, lookAt({0.1, -0.2, 0.2}, {0, -1, 0}, 0.4), kWidth, kHeight);
    LWConeTracingDesc desc = coneDesc(32, LW_VOXEL_MODE_ANISOTROPIC, LW_CONE_RESOLUTION_FULL);
    desc.normalAware = 2;
    desc.extent = 3.0f;
    TestTechnique technique(device, "cone_tracing", &desc);
    TestView view(device, kWidth, kHeight);
    technique.update(frame);
    Outputs all;
    render(device, technique, view, drawn.gbuffer, all.output);
    CAPTURE(hasSheet, meanOf(all.shadow.packed()), meanOf(all.specular.packed()), meanOf(all.refracted.packed()));
    CHECK(meanOf(all.shadow.packed()) == Approx(hasSheet ? 0.0 : 1.0).margin(0.05));
    CHECK(meanOf(all.specular.packed()) == Approx(hasSheet ? 0.0 : 0.5).margin(0.05));
    // Down through the floor, whose own voxels are not read: nothing lies there.
    CHECK(meanOf(all.refracted.packed()) == Approx(0.5).margin(0.05));
}

TEST_CASE("cones: dense grids and sparse ones have the same light", "[cone_tracing]") {
    TestDevice device(16);
    const ConeBox box(2.0, false, 1.0, 0.5, 64);
    const DrawnView drawn(box.walls, kInside, kWidth, kHeight);
    LWConeTracingDesc desc = coneDesc(64);
    const std::vector<float> sparse = renderCones(device, desc, box.frame, drawn.gbuffer, kWidth, kHeight);
    desc.sparse = 0;
    CHECK(renderCones(device, desc, box.frame, drawn.gbuffer, kWidth, kHeight) == sparse);
}
