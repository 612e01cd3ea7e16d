#include "frame_inputs.h"

#include <cmath>

#include "../cli/describe_triangles.h"
#include "lightwell/lightwell.hpp"
#include "sun_fit.h"

namespace viewer {
namespace {

void copyVector(const glm::vec3& from, float (&to)[3]) {
    for (int i = 0; i < 3; ++i) to[i] = from[i];
}

// GLM, as OpenGL, stores columns; Lightwell reads rows. The projection is the picture's own, with clip z in [0,1] and +y
// up: that the raster is upside down is nothing that Lightwell sees, and depths are distances, not OpenGL's.
LWCamera describeCamera(const Eye& eye) {
    LWCamera camera{};
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) {
            camera.view[4 * row + column] = eye.view[column][row];
            camera.projection[4 * row + column] = eye.projection[column][row];
        }
    return camera;
}

// A spot that is too wide for one map has the faces of a cube, which Lightwell takes of point lights alone: such a one is
// a point light whose profile is the spot's.
std::vector<float> coneProfile(const studio::Light& spot) {
    constexpr std::size_t kSteps = 1024;
    std::vector<float> profile(kSteps);
    const studio::LightAxes axes(spot.direction);
    for (std::size_t i = 0; i < kSteps; ++i) {
        const double angle = double(studio::kPi) * double(i) / double(kSteps - 1);
        profile[i] = studio::coneFalloff(spot, glm::vec3(axes.right * std::sin(angle) - axes.back * std::cos(angle)));
    }
    return profile;
}

constexpr LWLightKind kLightKinds[] = {LW_LIGHT_DIRECTIONAL, LW_LIGHT_SPOT, LW_LIGHT_POINT};  // in the order of studio::LightKind

}  // namespace

void FrameInputs::read(const GBufferImages& images, const std::vector<LightMaps>& lights) {
    gbufferPixels_.begin();
    gbufferPixels_.add(images.depth, LW_FORMAT_FLOAT1);
    gbufferPixels_.add(images.normal, LW_FORMAT_OCT16X2);
    gbufferPixels_.add(images.albedo, LW_FORMAT_UNORM8X4_SRGB);
    gbufferPixels_.add(images.direct, LW_FORMAT_HALF4);
    gbufferPixels_.add(images.motion, LW_FORMAT_FLOAT2);
    gbufferPixels_.read();
    rsmPixels_.begin();
    for (const LightMaps& light : lights)
        for (const RsmImages& rsm : light.rsms) {
            rsmPixels_.add(rsm.depth, LW_FORMAT_FLOAT1);
            rsmPixels_.add(rsm.normal, LW_FORMAT_OCT16X2);
            rsmPixels_.add(rsm.flux, LW_FORMAT_FLOAT4);
        }
    rsmPixels_.read();
}

void FrameInputs::map(const Eye& now, const Eye& before, const std::vector<LightMaps>& lights,
                      const studio::SceneTriangles& triangles, const glm::vec3& sky) {
    gbufferPixels_.map();
    rsmPixels_.map();
    gbuffer_ = lightwell::make<LWGBuffer>();
    gbuffer_.depthKind = LW_DEPTH_AXIAL;
    gbuffer_.depth = gbufferPixels_.image(0);
    gbuffer_.normal = gbufferPixels_.image(1);
    gbuffer_.albedo = gbufferPixels_.image(2);
    gbuffer_.directRadiance = gbufferPixels_.image(3);
    gbuffer_.motion = gbufferPixels_.image(4);
    gbuffer_.camera = describeCamera(now);
    gbuffer_.previousCamera = describeCamera(before);
    lights_.clear();
    rsms_.clear();
    profiles_.clear();
    std::size_t plane = 0;
    for (const LightMaps& light : lights) describeLight(light, plane);
    geometry_ = cli::describeTriangles(triangles);
    copyVector(glm::vec3(glm::inverse(now.view)[3]), focus_);  // grids lie around the eye
    frame_ = lightwell::make<LWFrame>();
    frame_.lights = lights_.data();
    frame_.lightCount = std::uint32_t(lights_.size());
    frame_.geometry = &geometry_;
    copyVector(sky, frame_.environment);
    frame_.focus = focus_;
}

void FrameInputs::describeLight(const LightMaps& maps, std::size_t& plane) {
    std::vector<LWRsm> described;
    for (const RsmImages& image : maps.rsms) {
        LWRsm rsm = lightwell::make<LWRsm>();
        rsm.depthKind = LW_DEPTH_AXIAL;
        rsm.depth = rsmPixels_.image(plane++);
        rsm.normal = rsmPixels_.image(plane++);
        rsm.flux = rsmPixels_.image(plane++);
        rsm.camera = describeCamera(image.eye);
        described.push_back(rsm);
    }
    rsms_.push_back(std::move(described));
    const studio::Light& from = maps.light;
    LWLight light = lightwell::make<LWLight>();
    light.kind = kLightKinds[int(from.kind)];
    copyVector(from.position, light.position);
    copyVector(from.direction, light.direction);
    copyVector(from.emitted, from.kind == studio::LightKind::Sun ? light.irradiance : light.radiantIntensity);
    light.innerConeAngle = from.innerCone;
    light.outerConeAngle = from.outerCone;
    light.rsmCount = std::uint32_t(rsms_.back().size());
    light.rsms = rsms_.back().data();  // a moved vector keeps its data's address
    profiles_.push_back(light.rsmCount > 1 && light.kind == LW_LIGHT_SPOT ? coneProfile(from) : std::vector<float>());
    if (!profiles_.back().empty()) {
        light.kind = LW_LIGHT_POINT;
        light.profileCount = std::uint32_t(profiles_.back().size());
        light.profile = profiles_.back().data();
    }
    lights_.push_back(light);
}

}  // namespace viewer
