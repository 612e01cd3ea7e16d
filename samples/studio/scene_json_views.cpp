// Cameras and lights of a scene JSON, see docs/scenes.md.
#include "scene_json_parts.h"

namespace studio {
namespace {

void readCameraFields(JsonObject& o, Camera& camera, bool all) {
    const auto position = o.find("position"), target = o.find("target"), up = o.find("up"),
               fov = o.find("vertical_fov_degrees"), aspect = o.find("aspect"), near = o.find("near"),
               far = o.find("far");
    if (all)
        o.need("position", "the camera's position"), o.need("target", "a point the camera looks at"),
            o.need("vertical_fov_degrees", "the whole vertical angle");
    if (position) camera.position = position->vector();
    if (target) camera.target = target->vector();
    if (up) camera.up = up->direction();
    if (fov) camera.verticalFov = fov->number(0.0f, 170.0f) * kDegrees;
    if (aspect) camera.aspect = aspect->number(0.0f, 100.0f);
    if (near) camera.nearPlane = near->number(0.0f, kAny);
    if (far) camera.farPlane = far->number(camera.nearPlane, kAny);
    const glm::vec3 side = glm::cross(glm::normalize(camera.target - camera.position), camera.up);
    if (!(glm::length(side) > 1e-4f))
        o.value().fail("a target away from the position and off the up axis");
}

void readLightFields(JsonObject& o, Light& light, bool all) {
    const bool sun = light.kind == LightKind::Sun, spot = light.kind == LightKind::Spot;
    if (!sun) {
        const auto position = o.find("position");
        if (all) o.need("position", "the light's position");
        if (position) light.position = position->vector();
    }
    if (sun || spot) {
        const auto direction = o.find("direction");
        const auto target = spot ? o.find("target") : std::nullopt;
        if (direction && target) target->fail("nothing beside a direction");
        if (all && !direction && !target) o.need("direction", "the way the light travels");
        if (direction) light.direction = direction->direction();
        if (target) {
            const glm::vec3 way = target->vector() - light.position;
            if (!(glm::length(way) > 0.0f)) target->fail("a point away from the light's position");
            light.direction = glm::normalize(way);
        }
    }
    const char* key = sun ? "irradiance" : "intensity";
    const auto emitted = o.find(key);
    if (all) o.need(key, sun ? "the irradiance facing the sun, W/m^2" : "the intensity, W/sr");
    if (emitted) light.emitted = emitted->colour();
    if (!spot) return;
    const auto inner = o.find("inner_cone_degrees"), outer = o.find("outer_cone_degrees");
    if (all) o.need("outer_cone_degrees", "half of the cone's angle");
    if (outer) light.outerCone = outer->number(0.0f, 90.0f) * kDegrees;
    if (inner) light.innerCone = inner->number() * kDegrees;
    if (inner && light.innerCone < 0.0f) inner->fail("half of an angle, not negative");
    if (light.innerCone > light.outerCone)
        (inner ? *inner : *outer).fail("an inner cone of at most the outer one");
}

}  // namespace

void readJsonCamera(const JsonValue& value, Scene& scene) {
    JsonObject o = value.object();
    Camera camera;
    const JsonValue name = o.need("name", "the camera's name");
    camera.name = name.text();
    for (const Camera& other : scene.cameras)
        if (other.name == camera.name) name.fail("a name that no other camera has");
    readCameraFields(o, camera, true);
    if (const auto keys = o.find("keys"))
        scene.cameraTracks.push_back(
            {int(scene.cameras.size()), readKeys<Camera>(*keys, [&](JsonObject& k) {
                 Camera at = camera;
                 readCameraFields(k, at, false);
                 return at;
             })});
    o.finish();
    scene.cameras.push_back(camera);
}

void readJsonLight(const JsonValue& value, Scene& scene) {
    JsonObject o = value.object();
    Light light;
    const JsonValue name = o.need("name", "the light's name"),
                    kind = o.need("kind", "sun, spot or point");
    light.name = name.text();
    for (const Light& other : scene.lights)
        if (other.name == light.name) name.fail("a name that no other light has");
    const std::string word = kind.text();
    if (word == "sun")
        light.kind = LightKind::Sun;
    else if (word == "spot")
        light.kind = LightKind::Spot;
    else if (word == "point")
        light.kind = LightKind::Point;
    else
        kind.fail("sun, spot or point");
    readLightFields(o, light, true);
    if (const auto keys = o.find("keys"))
        scene.lightTracks.push_back(
            {int(scene.lights.size()), readKeys<Light>(*keys, [&](JsonObject& k) {
                 Light at = light;
                 readLightFields(k, at, false);
                 return at;
             })});
    o.finish();
    scene.lights.push_back(light);
}

}  // namespace studio
