// What a scene's parts mean at a time: texture look-up, poses, camera matrices, light profiles.
//
// The spot profile is that of KHR_lights_punctual (Khronos glTF extension registry): a linear ramp in
// the cosine between the outer and the inner cone, squared. One profile serves shadow maps, direct
// light, the path tracer and every technique.
#include "scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

namespace studio {
namespace {

// Linear value of each 8-bit sRGB code (IEC 61966-2-1).
std::array<float, 256> makeSrgbTable() {
    std::array<float, 256> table{};
    for (int i = 0; i < 256; ++i) {
        const double c = i / 255.0;
        table[std::size_t(i)] = float(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    return table;
}

// Index of the key interval that holds `time` and the position in it; ends hold.
template <class Keys, class TimeOf>
std::pair<std::size_t, float> locate(const Keys& keys, float time, TimeOf timeOf) {
    if (time <= timeOf(keys.front())) return {0, 0.0f};
    if (time >= timeOf(keys.back())) return {keys.size() - 1, 0.0f};
    std::size_t next = 1;
    while (timeOf(keys[next]) <= time) ++next;
    const float start = timeOf(keys[next - 1]);
    return {next - 1, (time - start) / (timeOf(keys[next]) - start)};
}

Camera mixed(const Camera& a, const Camera& b, float t) {
    Camera c = a;
    c.position = glm::mix(a.position, b.position, t);
    c.target = glm::mix(a.target, b.target, t);
    c.up = glm::mix(a.up, b.up, t);
    c.verticalFov = glm::mix(a.verticalFov, b.verticalFov, t);
    c.aspect = glm::mix(a.aspect, b.aspect, t);
    c.nearPlane = glm::mix(a.nearPlane, b.nearPlane, t);
    c.farPlane = glm::mix(a.farPlane, b.farPlane, t);
    return c;
}

Light mixed(const Light& a, const Light& b, float t) {
    Light l = a;
    l.position = glm::mix(a.position, b.position, t);
    const glm::vec3 direction = glm::mix(a.direction, b.direction, t);
    // Opposite keys meet at zero in the middle; the earlier one is kept there.
    l.direction = glm::length(direction) > 1e-6f ? glm::normalize(direction) : a.direction;
    l.emitted = glm::mix(a.emitted, b.emitted, t);
    l.innerCone = glm::mix(a.innerCone, b.innerCone, t);
    l.outerCone = glm::mix(a.outerCone, b.outerCone, t);
    return l;
}

template <class T>
T trackAt(const std::vector<Track<T>>& tracks, int index, const T& rest, float time) {
    for (const Track<T>& track : tracks) {
        if (track.target != index || track.keys.empty()) continue;
        const auto [key, t] = locate(track.keys, time, [](const auto& k) { return k.first; });
        T value = t > 0.0f ? mixed(track.keys[key].second, track.keys[key + 1].second, t)
                           : track.keys[key].second;
        value.name = rest.name;
        return value;
    }
    return rest;
}

template <class T>
const T& checked(const std::vector<T>& items, int index, const char* what) {
    if (index < 0 || std::size_t(index) >= items.size())
        throw std::runtime_error(
            fmt::format("{} index: expected 0 .. {}, got {}", what, long(items.size()) - 1, index));
    return items[std::size_t(index)];
}

}  // namespace

glm::vec4 Texture::lookup(glm::vec2 uv) const {
    static const std::array<float, 256> kLinear = makeSrgbTable();
    // Texel centres lie at (i + 0.5) / size; row 0 is v = 0, the picture's top.
    const float x = (uv.x - std::floor(uv.x)) * float(width) - 0.5f;
    const float y = (uv.y - std::floor(uv.y)) * float(height) - 0.5f;
    const float fx = std::floor(x), fy = std::floor(y);
    const auto wrap = [](int i, int n) { return i < 0 ? i + n : (i >= n ? i - n : i); };
    const int x0 = wrap(int(fx), width), x1 = wrap(int(fx) + 1, width);
    const int y0 = wrap(int(fy), height), y1 = wrap(int(fy) + 1, height);
    const auto texel = [this](int tx, int ty) {
        const std::uint8_t* p = &rgba[(std::size_t(ty) * std::size_t(width) + std::size_t(tx)) * 4];
        return glm::vec4(kLinear[p[0]], kLinear[p[1]], kLinear[p[2]], float(p[3]) * (1.0f / 255.0f));
    };
    return glm::mix(glm::mix(texel(x0, y0), texel(x1, y0), x - fx),
                    glm::mix(texel(x0, y1), texel(x1, y1), x - fx), y - fy);
}

glm::mat4 Object::poseAt(float time) const {
    if (keys.empty()) return glm::mat4(1.0f);
    const auto [key, t] = locate(keys, time, [](const PoseKey& k) { return k.time; });
    glm::vec3 translation = keys[key].translation;
    glm::quat rotation = keys[key].rotation;
    if (t > 0.0f) {
        translation = glm::mix(translation, keys[key + 1].translation, t);
        rotation = glm::slerp(rotation, keys[key + 1].rotation, t);
    }
    return glm::translate(glm::mat4(1.0f), translation) * glm::mat4_cast(glm::normalize(rotation));
}

glm::mat4 Camera::viewMatrix() const {
    return glm::lookAtRH(position, target, up);
}

glm::mat4 Camera::projectionMatrix(int width, int height) const {
    return glm::perspectiveRH_ZO(verticalFov, float(width) / float(height), nearPlane, farPlane);
}

float coneFalloff(const Light& light, const glm::vec3& toSurface) {
    if (light.kind != LightKind::Spot) return 1.0f;
    const float cosine = glm::dot(light.direction, toSurface);
    const float cosOuter = std::cos(light.outerCone), cosInner = std::cos(light.innerCone);
    if (cosine <= cosOuter) return 0.0f;
    if (cosine >= cosInner) return 1.0f;
    const float ramp = (cosine - cosOuter) / (cosInner - cosOuter);
    return ramp * ramp;
}

LightArrival arrivalOf(const Light& light, const glm::vec3& position) {
    if (light.kind == LightKind::Sun)
        return {-light.direction, light.emitted, std::numeric_limits<float>::infinity()};
    const glm::vec3 way = light.position - position;
    const float squared = glm::dot(way, way);
    if (squared <= 0.0f) return {};
    const float distance = std::sqrt(squared);
    const glm::vec3 toLight = way / distance;
    return {toLight, light.emitted * (coneFalloff(light, -toLight) / squared), distance};
}

Camera Scene::cameraAt(int index, float time) const {
    const Camera camera = trackAt(cameraTracks, index, checked(cameras, index, "camera"), time);
    // Keys that are right may meet between: a camera that flies through its target.
    // In double: squares of small lengths are beyond floats.
    const glm::dvec3 way = glm::dvec3(camera.target) - glm::dvec3(camera.position), up(camera.up);
    if (!(glm::length(glm::cross(way, up)) > 1e-4 * glm::length(way) * glm::length(up)))
        throw std::runtime_error(fmt::format(
            "camera \"{}\" at {} s: expected a target away from the position and off the up axis",
            camera.name, time));
    return camera;
}

Light Scene::lightAt(int index, float time) const {
    return trackAt(lightTracks, index, checked(lights, index, "light"), time);
}

int Scene::findCamera(const std::string& cameraName) const {
    std::string names;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        if (cameraName.empty() || cameras[i].name == cameraName) return int(i);
        names += (i == 0 ? "" : ", ") + cameras[i].name;
    }
    throw std::runtime_error(fmt::format("camera \"{}\" of scene \"{}\": expected one of: {}",
                                         cameraName, name,
                                         names.empty() ? "(the scene has none)" : names));
}

void Scene::bounds(glm::vec3& lower, glm::vec3& upper) const {
    lower = glm::vec3(std::numeric_limits<float>::max());
    upper = -lower;
    for (const Mesh& mesh : meshes) {
        const glm::mat4 pose = objects[std::size_t(mesh.object)].poseAt(0.0f);
        for (const glm::uvec3& triangle : mesh.triangles)
            for (int corner = 0; corner < 3; ++corner) {
                const glm::vec3 p(pose * glm::vec4(mesh.positions[triangle[corner]], 1.0f));
                lower = glm::min(lower, p);
                upper = glm::max(upper, p);
            }
    }
}

}  // namespace studio
