// Scenes of the catalogue that no shipped scene gives: yards, a shaft, a corridor.
#include <algorithm>
#include <cmath>

#include <glm/gtc/quaternion.hpp>

#include "scene_primitives.h"
#include "sequence_parts.h"

namespace studio {
namespace {

constexpr float kDegree = kPi / 180.0f;

int addMaterial(Scene& scene, const char* name, const glm::vec3& albedo) {
    Material material;
    material.name = name;
    material.albedo = albedo;
    scene.materials.push_back(material);
    return int(scene.materials.size()) - 1;
}

void addBox(Scene& scene, const char* name, const glm::vec3& lower, const glm::vec3& upper,
            int material) {
    Mesh mesh = makeBox(lower, upper);
    mesh.name = name;
    mesh.material = material;
    scene.meshes.push_back(std::move(mesh));
}

// Half the inner length (x) and width (z) of the yards, and how thick their outer walls are, m.
constexpr float kLong = 2.0f, kWide = 1.5f, kOuter = 0.1f;

// Floor and outer walls; walls reach into the floor and each other, so that no crack is left.
void addYard(Scene& scene, int floor, int wall) {
    const float h = Yards::kHeight, low = -kOuter, l = kLong, w = kWide, o = kOuter;
    addBox(scene, "floor", {-l - o, low, -w - o}, {l + o, 0.0f, w + o}, floor);
    addBox(scene, "left", {-l - o, low, -w - o}, {-l, h, w + o}, wall);
    addBox(scene, "right", {l, low, -w - o}, {l + o, h, w + o}, wall);
    addBox(scene, "back", {-l, low, -w - o}, {l, h, -w}, wall);
    addBox(scene, "front", {-l, low, w}, {l, h, w + o}, wall);
}

// The axis of the world that its up is nearest to: y, but not where z is up, nor in a plan seen from
// above, which a turn about y would leave as it is.
glm::vec3 verticalOf(const Camera& camera) {
    int nearest = 1;
    for (const int axis : {0, 2})
        if (std::abs(camera.up[axis]) > std::abs(camera.up[nearest])) nearest = axis;
    glm::vec3 vertical(0.0f);
    vertical[nearest] = camera.up[nearest] < 0.0f ? -1.0f : 1.0f;
    return vertical;
}

}  // namespace

std::shared_ptr<Scene> shippedScene(const std::string& name) {
    return std::make_shared<Scene>(loadScene(name));
}

std::shared_ptr<Scene> roomsWithDoorAt(float time) {
    const auto scene = shippedScene("rooms");
    for (Object& object : scene->objects) {
        if (object.keys.empty()) continue;
        const glm::mat4 pose = object.poseAt(time);
        object.keys = {{0.0f, glm::vec3(pose[3]), glm::quat_cast(glm::mat3(pose))}};
    }
    return scene;
}

void setLight(Scene& scene, const Light& light) {
    scene.lights = {light};
    scene.lightTracks.clear();
}

Light makeSpot(const glm::vec3& position, const glm::vec3& target, float intensity, float outerDegrees) {
    Light light;
    light.name = "lamp";
    light.kind = LightKind::Spot;
    light.position = position;
    light.direction = glm::normalize(target - position);
    light.emitted = glm::vec3(intensity);
    light.outerCone = outerDegrees * kDegree;
    light.innerCone = 0.85f * light.outerCone;
    return light;
}

Camera makeCamera(const glm::vec3& position, const glm::vec3& target, float degrees) {
    Camera camera;
    camera.name = "sequence";
    camera.position = position;
    camera.target = target;
    camera.verticalFov = degrees * kDegree;
    return camera;
}

Camera yawed(const Camera& camera, float degrees) {
    Camera turned = camera;
    const glm::quat rotation = glm::angleAxis(degrees * kDegree, verticalOf(camera));
    turned.target = camera.position + rotation * (camera.target - camera.position);
    return turned;
}

Camera moved(const Camera& camera, const glm::vec3& by) {
    Camera shifted = camera;
    shifted.position += by;
    shifted.target += by;
    return shifted;
}

std::shared_ptr<Scene> Yards::make(float thickness) {
    const auto scene = std::make_shared<Scene>();
    scene->name = "yards";
    const int floor = addMaterial(*scene, "floor", {0.6f, 0.5f, 0.35f});
    const int wall = addMaterial(*scene, "wall", {0.7f, 0.7f, 0.68f});
    addYard(*scene, floor, wall);
    // Grows into the dark yard: what is lit stays as it is.
    addBox(*scene, "partition", {0.0f, -kOuter, -kWide - kOuter}, {thickness, kHeight, kWide + kOuter},
           wall);
    // Its cone ends left of the partition, on the floor and on the left wall.
    setLight(*scene, makeSpot({-0.6f, 1.9f, 0.0f}, {-1.265f, 0.0f, 0.0f}, 20.0f, 30.0f));
    return scene;
}

std::uint8_t Yards::region(float thickness, const glm::vec3& p) {
    constexpr float kEdge = 1e-4f;
    if (p.y > kHeight - kEdge || std::max(std::abs(p.x) - kLong, std::abs(p.z) - kWide) > kEdge)
        return 0;  // tops of walls and what is outside
    return p.x > thickness - kEdge * thickness ? 1 : p.x < kEdge ? 2 : 0;
}

std::shared_ptr<Scene> Shaft::make() {
    const auto scene = std::make_shared<Scene>();
    scene->name = "shaft";
    const int floor = addMaterial(*scene, "floor", {0.6f, 0.5f, 0.35f});
    const int wall = addMaterial(*scene, "wall", {0.7f, 0.7f, 0.68f});
    addYard(*scene, floor, wall);
    constexpr float kThick = 0.05f, kIn = kHalf, kOut = kHalf + kThick;
    addBox(*scene, "shaft_left", {-kOut, -kOuter, -kOut}, {-kIn, Yards::kHeight, kOut}, wall);
    addBox(*scene, "shaft_right", {kIn, -kOuter, -kOut}, {kOut, Yards::kHeight, kOut}, wall);
    addBox(*scene, "shaft_back", {-kIn, -kOuter, -kOut}, {kIn, Yards::kHeight, -kIn}, wall);
    addBox(*scene, "shaft_front", {-kIn, -kOuter, kIn}, {kIn, Yards::kHeight, kOut}, wall);
    return scene;
}

std::uint8_t Shaft::region(const glm::vec3& p) {
    constexpr float kEdge = 1e-4f;
    if (p.y > Yards::kHeight - kEdge || std::max(std::abs(p.x) - kLong, std::abs(p.z) - kWide) > kEdge)
        return 0;
    return std::max(std::abs(p.x), std::abs(p.z)) < kHalf + kEdge ? 2 : 1;
}

std::shared_ptr<Scene> makeCorridor() {
    const auto scene = std::make_shared<Scene>();
    scene->name = "corridor";
    const int floor = addMaterial(*scene, "floor", {0.5f, 0.4f, 0.3f});
    const int wall = addMaterial(*scene, "wall", {0.72f, 0.7f, 0.66f});
    const int colours[] = {addMaterial(*scene, "red", {0.65f, 0.12f, 0.1f}),
                           addMaterial(*scene, "green", {0.15f, 0.5f, 0.2f}),
                           addMaterial(*scene, "blue", {0.15f, 0.2f, 0.6f})};
    constexpr float kEnd = 16.0f, kSide = 1.5f, kTop = 2.6f, o = 0.2f;
    addBox(*scene, "floor", {-o, -o, -kSide - o}, {kEnd + o, 0.0f, kSide + o}, floor);
    addBox(*scene, "ceiling", {-o, kTop, -kSide - o}, {kEnd + o, kTop + o, kSide + o}, wall);
    addBox(*scene, "left", {-o, 0.0f, -kSide - o}, {kEnd + o, kTop, -kSide}, wall);
    addBox(*scene, "right", {-o, 0.0f, kSide}, {kEnd + o, kTop, kSide + o}, wall);
    addBox(*scene, "start", {-o, 0.0f, -kSide}, {0.0f, kTop, kSide}, wall);
    addBox(*scene, "end", {kEnd, 0.0f, -kSide}, {kEnd + o, kTop, kSide}, wall);
    for (int i = 0; i < 12; ++i) {  // on alternating sides
        const float x = 2.5f + 1.1f * float(i), z = i % 2 == 0 ? -1.2f : 1.2f;
        addBox(*scene, "block", {x, -0.01f, z - 0.25f},
               {x + 0.5f, 0.7f + 0.1f * float(i % 4), z + 0.25f}, colours[i % 3]);
    }
    return scene;
}

}  // namespace studio
