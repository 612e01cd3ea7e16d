// See host_light.h.
#include "host_light.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cli {
namespace {

using studio::JsonObject;
using studio::JsonValue;
using studio::Light;
using studio::LightKind;

constexpr double kPi = 3.14159265358979323846;
constexpr float kRadians = float(kPi / 180.0);
// How far a map's camera may stand from its lamp, relative to their distance from the origin and 1 unit: rounding of files.
constexpr double kSamePlace = 1e-4;
// Cosine of the angle between a sun's rays and its map's axis.
constexpr double kSameWay = 0.99999;
constexpr std::size_t kMostProfile = 1024;  // as LWLight, as is the largest factor
constexpr float kLargestFactor = 1e6f;

void readSpotCone(JsonObject& o, Light& light) {
    light.direction = o.need("direction", "three numbers").direction();
    const JsonValue outer = o.need("outer_cone_degrees", "half of the cone's angle");
    light.outerCone = outer.number(0.0f, 90.0f) * kRadians;
    if (const auto inner = o.find("inner_cone_degrees")) {
        const float angle = inner->number() * kRadians;
        if (!(angle >= 0.0f && angle <= light.outerCone)) inner->fail("an angle from 0 to outer_cone_degrees");
        light.innerCone = angle;
    }
}

void readEmission(JsonObject& o, Light& light) {
    if (light.kind == LightKind::Sun) {
        light.emitted = o.need("irradiance", "W/m^2 on a plane that faces the sun").colour();
        return;
    }
    const auto intensity = o.find("intensity"), power = o.find("power");
    if (intensity && power) power->fail("nothing beside intensity");
    if (power)
        light.emitted = power->colour() / float(4.0 * kPi);
    else
        light.emitted = o.need("intensity", "W/sr on the axis, or power").colour();
}

std::vector<float> readProfile(JsonObject& o) {
    std::vector<float> profile;
    const auto value = o.find("profile");
    if (!value) return profile;
    for (const JsonValue& item : value->list()) {
        profile.push_back(item.number());
        if (profile.back() < 0.0f || profile.back() > kLargestFactor) item.fail("a factor from 0 to 1e6");
    }
    if (profile.size() < 2 || profile.size() > kMostProfile) value->fail(fmt::format("2 to {} factors", kMostProfile));
    return profile;
}

void checkCamera(const JsonValue& value, const Light& light, const HostCamera& camera) {
    if (camera.isOrthographic() != (light.kind == LightKind::Sun))
        value.fail(light.kind == LightKind::Sun ? "an orthographic camera for a sun" : "a perspective camera for a spot or point light");
    if (light.kind == LightKind::Sun) {
        if (glm::dot(camera.forward(), glm::dvec3(light.direction)) < kSameWay)
            value.fail(fmt::format("a camera along the sun's rays, ({:.4g}, {:.4g}, {:.4g})", light.direction.x, light.direction.y, light.direction.z));
        return;
    }
    const glm::dvec3 lamp(light.position);
    if (glm::length(camera.eye() - lamp) > kSamePlace * (1.0 + glm::length(lamp)))
        value.fail(fmt::format("a camera in the lamp, at ({:.6g}, {:.6g}, {:.6g}); it stands at ({:.6g}, {:.6g}, {:.6g})", lamp.x, lamp.y, lamp.z,
                               camera.eye().x, camera.eye().y, camera.eye().z));
}

std::vector<HostCamera> readCameras(JsonObject& o, const Light& light) {
    const JsonValue list = o.need("cameras", "a list of the cameras of its maps");
    std::vector<HostCamera> cameras;
    for (const JsonValue& item : list.list()) {
        JsonObject object = item.object();
        cameras.emplace_back(object);
        object.finish();
        checkCamera(item, light, cameras.back());
    }
    if (cameras.empty()) list.fail("at least one camera");
    return cameras;
}

LightKind readKind(const JsonValue& value) {
    const std::string kind = value.text();
    if (kind == "sun") return LightKind::Sun;
    if (kind == "spot") return LightKind::Spot;
    if (kind != "point") value.fail("\"sun\", \"spot\" or \"point\"");
    return LightKind::Point;
}

HostLight readLight(JsonObject& o) {
    HostLight host;
    Light& light = host.light;
    light.kind = readKind(o.need("kind", "\"sun\", \"spot\" or \"point\""));
    if (light.kind == LightKind::Sun)
        light.direction = o.need("direction", "three numbers, the way its light travels").direction();
    else
        light.position = o.need("position", "three numbers").vector();
    if (light.kind == LightKind::Spot) readSpotCone(o, light);
    readEmission(o, light);
    if (light.kind == LightKind::Spot) host.profile = readProfile(o);
    if (const auto from = o.find("flux_from")) {
        const std::string word = from->text();
        if (word != "lamp" && word != "direct") from->fail("\"lamp\" or \"direct\"");
        host.fluxFromDirect = word == "direct";
    }
    host.cameras = readCameras(o, light);
    return host;
}

}  // namespace

glm::dvec3 HostLight::emittedAlong(const glm::dvec3& toSurface) const {
    double factor = double(studio::coneFalloff(light, glm::vec3(toSurface)));
    if (!profile.empty()) {
        const double cosine = std::clamp(glm::dot(glm::dvec3(light.direction), toSurface), -1.0, 1.0);
        const double at = std::acos(cosine) / kPi * double(profile.size() - 1);
        const std::size_t below = std::min(std::size_t(at), profile.size() - 2);
        const double share = at - double(below);
        factor *= double(profile[below]) * (1.0 - share) + double(profile[below + 1]) * share;
    }
    return glm::dvec3(light.emitted) * factor;
}

HostLight readLightFile(const std::string& path) {
    return readHostFile(path, "lightwell-light", readLight);
}

}  // namespace cli
