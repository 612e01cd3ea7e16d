#include "render_inputs.h"

#include <atomic>

#include "describe_triangles.h"
#include "lightwell/lightwell.hpp"

namespace cli {
namespace {

void copyVector(const glm::vec3& from, float (&to)[3]) {
    for (int i = 0; i < 3; ++i) to[i] = from[i];
}

// GLM stores columns, Lightwell reads rows.
void copyMatrix(const glm::mat4& from, float (&to)[16]) {
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) to[4 * row + column] = from[column][row];
}

LWCamera describeCamera(const glm::mat4& view, const glm::mat4& projection) {
    LWCamera camera{};
    copyMatrix(view, camera.view);
    copyMatrix(projection, camera.projection);
    return camera;
}

LWCamera describeCamera(const studio::Camera& camera, int width, int height) {
    return describeCamera(camera.viewMatrix(), camera.projectionMatrix(width, height));
}

LWGBuffer describeGBuffer(const studio::GBuffer& from) {
    LWGBuffer to = lightwell::make<LWGBuffer>();
    to.position = describePlanes(from.position);
    to.normal = describePlanes(from.normal);
    to.albedo = describePlanes(from.albedo);
    to.directRadiance = describePlanes(from.direct);
    to.motion = describePlanes(from.motion);
    to.camera = describeCamera(from.camera, from.width, from.height);
    to.previousCamera = describeCamera(from.previousCamera, from.width, from.height);
    return to;
}

LWRsm describeRsm(const studio::Rsm& from) {
    LWRsm to = lightwell::make<LWRsm>();
    to.position = describePlanes(from.position);
    to.normal = describePlanes(from.normal);
    to.flux = describePlanes(from.flux);
    to.camera = describeCamera(from.view, from.projection);
    return to;
}

LWLight describeLight(const studio::Light& from, const std::vector<LWRsm>& rsms) {
    LWLight to = lightwell::make<LWLight>();
    copyVector(from.position, to.position);
    copyVector(from.direction, to.direction);
    switch (from.kind) {
        case studio::LightKind::Sun:
            to.kind = LW_LIGHT_DIRECTIONAL;
            break;
        case studio::LightKind::Spot:
            to.kind = LW_LIGHT_SPOT;
            break;
        case studio::LightKind::Point:
            to.kind = LW_LIGHT_POINT;
            break;
    }
    copyVector(from.emitted, from.kind == studio::LightKind::Sun ? to.irradiance : to.radiantIntensity);
    to.innerConeAngle = from.innerCone;
    to.outerConeAngle = from.outerCone;
    to.rsmCount = std::uint32_t(rsms.size());
    to.rsms = rsms.data();
    return to;
}

}  // namespace

LWImage describePlanes(const studio::PlanarBuffer& buffer) {
    constexpr LWFormat kFormats[] = {LW_FORMAT_FLOAT1, LW_FORMAT_PLANAR_FLOAT2, LW_FORMAT_PLANAR_FLOAT3};
    LWImage image{};
    image.host = buffer.data();
    image.format = kFormats[buffer.planes() - 1];
    image.width = std::uint32_t(buffer.width());
    image.height = std::uint32_t(buffer.height());
    image.byteRowStride = std::int64_t(buffer.rowFloats()) * std::int64_t(sizeof(float));
    image.bytePlaneStride = std::int64_t(buffer.planeFloats() * sizeof(float));
    return image;
}

RenderInputs::RenderInputs(const studio::RayScene& scene, const studio::Camera& camera,
                           const InputOptions& options)
    : scene_(scene),
      time_(options.time),
      scale_(options.scale),
      gbuffer_(studio::renderGBuffer(
          scene, camera, options.width, options.height,
          options.previousCamera != nullptr ? *options.previousCamera : camera,
          options.previousCamera != nullptr ? options.previousTime : options.time)),
      lwGBuffer_(describeGBuffer(gbuffer_)),
      triangles_(studio::sceneTriangles(scene)),
      lwGeometry_(describeTriangles(triangles_)),
      hasFocus_(options.focus.kind != FrameFocus::Kind::None) {
    for (const auto& [source, before] : options.sources)
        sources_.push_back(studio::renderGBuffer(
            scene, source, options.width, options.height, before,
            options.previousCamera != nullptr ? options.previousTime : options.time));
    for (const studio::GBuffer& source : sources_) lwSources_.push_back(describeGBuffer(source));
    studio::RsmOptions rsmOptions = options.rsm;
    rsmOptions.view = &gbuffer_;
    static std::atomic<std::uint64_t> lastVersion{0};
    const std::uint64_t version = ++lastVersion;
    for (std::size_t i = 0; i < scene.scene().lights.size(); ++i) {
        const studio::Light light = scene.scene().lightAt(int(i), options.time);
        rsmOptions.cascades = light.kind == studio::LightKind::Sun ? options.rsm.cascades : 1;
        rsms_.push_back(studio::renderRsms(scene, light, rsmOptions));
        std::vector<LWRsm> described;
        for (const studio::Rsm& rsm : rsms_.back()) described.push_back(describeRsm(rsm));
        versionedRsms_.push_back(described);
        for (LWRsm& rsm : versionedRsms_.back()) rsm.version = version;
        lwRsms_.push_back(std::move(described));
        // A moved vector keeps its data's address.
        lights_.push_back(describeLight(light, lwRsms_.back()));
        versionedLights_.push_back(describeLight(light, versionedRsms_.back()));
    }
    copyVector(scene.scene().sky, environment_);
    const bool isPoint = options.focus.kind == FrameFocus::Kind::Point;
    copyVector(isPoint ? options.focus.point : camera.position, focus_);
}

std::uint64_t RenderInputs::rsmTexelCount() const {
    std::uint64_t count = 0;
    for (const auto& ofLight : rsms_)
        for (const studio::Rsm& rsm : ofLight)
            count += std::uint64_t(rsm.width) * std::uint64_t(rsm.height);
    return count;
}

namespace {

void scaleCamera(studio::Camera& camera, float factor) {
    camera.position *= factor;
    camera.target *= factor;
    camera.nearPlane *= factor;
    camera.farPlane *= factor;
}

void scaleLight(studio::Light& light, float factor) {
    light.position *= factor;
    if (light.kind != studio::LightKind::Sun) light.emitted *= factor * factor;
}

}  // namespace

void scaleScene(studio::Scene& scene, float factor) {
    for (studio::Mesh& mesh : scene.meshes)
        for (glm::vec3& position : mesh.positions) position *= factor;
    for (studio::Object& object : scene.objects)
        for (studio::PoseKey& key : object.keys) key.translation *= factor;
    for (studio::Camera& camera : scene.cameras) scaleCamera(camera, factor);
    for (studio::Light& light : scene.lights) scaleLight(light, factor);
    for (auto& track : scene.cameraTracks)
        for (auto& key : track.keys) scaleCamera(key.second, factor);
    for (auto& track : scene.lightTracks)
        for (auto& key : track.keys) scaleLight(key.second, factor);
}

}  // namespace cli
