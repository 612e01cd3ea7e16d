// The same three movements in any scene: the camera turns, the camera goes ahead, the light creeps.
//
// Steps are relative to what the scene's first camera sees and to what its lamps light, so that a
// cathedral and a doll's house move by as many pixels a frame. Nothing but that moves: objects, cameras
// and lights stand as they do at 0 s.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include "sequence_parts.h"

namespace studio {
namespace {

// Of the vertical angle of view: 0.75 degrees at 55, two and a half rows of pixels in 180. 32 frames
// turn by 24 degrees of the 86 that are in view then; three times as much leaves little to follow.
constexpr float kPanShare = 1.0f / 72.0f;
// Of the depth in the picture's middle: what stands there grows by half a per cent a frame.
constexpr float kDollyShare = 1.0f / 200.0f;
// Degrees that a lamp moves in a frame, seen from what it lights: `light_sweep_slow`'s 2 mm at 55 cm.
constexpr float kSweepAngle = 0.2f * kPi / 180.0f;
// Cameras and lamps turn back after so many frames, having used at most this share of the way before
// them: however long a sequence is, it ends in no wall.
constexpr int kTurnBack = 32;
constexpr float kUsedWay = 0.5f;
// relMSE of a frame's truth. Half as much doubles a run's time and lowers floors by a third.
constexpr double kTruthNoise = 0.04;
// Of the scene's diagonal: a camera or lamp with less way before it stands in a wall.
constexpr float kLeastWay = 1e-4f;

int stepsAt(int frame) {
    const int along = frame % (2 * kTurnBack);
    return along <= kTurnBack ? along : 2 * kTurnBack - along;
}

bool shines(const Light& light) {
    return light.emitted != glm::vec3(0.0f);
}

// A scene without time, its first camera at rest foremost.
std::shared_ptr<Scene> standStill(const Scene& moving) {
    const auto scene = std::make_shared<Scene>(moving);
    for (Object& object : scene->objects) {
        if (object.keys.empty()) continue;
        const glm::mat4 pose = object.poseAt(0.0f);
        object.keys = {{0.0f, glm::vec3(pose[3]), glm::quat_cast(glm::mat3(pose))}};
    }
    for (std::size_t i = 0; i < scene->lights.size(); ++i)
        scene->lights[i] = moving.lightAt(int(i), 0.0f);
    scene->lightTracks.clear();
    std::size_t first = 0;
    const auto moves = [&](std::size_t i) {
        return std::any_of(moving.cameraTracks.begin(), moving.cameraTracks.end(),
                           [&](const auto& track) { return std::size_t(track.target) == i; });
    };
    while (first < moving.cameras.size() && moves(first)) ++first;
    scene->cameras = {moving.cameraAt(int(first < moving.cameras.size() ? first : 0), 0.0f)};
    scene->cameraTracks.clear();
    return scene;
}

FailureSequence makeScenePan(const SequenceSize& size, const std::shared_ptr<Scene>& scene) {
    const Camera& start = scene->cameras[0];
    const float degrees = start.verticalFov * kPanShare * 180.0f / kPi;
    FailureSequence sequence =
        makeFlight(size, scene, [&](int f) { return yawed(start, -degrees * float(stepsAt(f))); });
    sequence.sweeps = "camera's turn, degrees";
    for (int f = 0; f < size.frames; ++f)
        sequence.frames[std::size_t(f)].value = double(degrees) * stepsAt(f);
    return sequence;
}

FailureSequence makeSceneDolly(const SequenceSize& size, const std::shared_ptr<Scene>& scene) {
    const Camera& start = scene->cameras[0];
    const RayScene rays(scene, 0.0f);
    const glm::vec3 ahead = glm::normalize(start.target - start.position);
    const float depth = middleDepth(rays, start);
    const float way = freeWay(rays, start.position, ahead, 0.01f * depth);
    if (way < kLeastWay * rays.diagonal())
        throw std::invalid_argument(fmt::format(
            "camera \"{}\" of scene \"{}\": expected room to move ahead, got a surface after {} m",
            start.name, scene->name, way));
    const float step = std::min(kDollyShare * depth, kUsedWay * way / float(kTurnBack));
    FailureSequence sequence =
        makeFlight(size, scene, [&](int f) { return moved(start, ahead * (step * float(stepsAt(f)))); });
    sequence.sweeps = "camera's way, m";
    for (int f = 0; f < size.frames; ++f)
        sequence.frames[std::size_t(f)].value = double(step) * stepsAt(f);
    return sequence;
}

// How one light goes on: by `move` metres, or turned towards `side`, an angle for each step.
struct LightStep {
    glm::vec3 move{0.0f}, side{0.0f};
    float angle = 0.0f;
    bool isAny() const { return angle != 0.0f || move != glm::vec3(0.0f); }
    Light after(const Light& light, int steps) const {
        Light there = light;
        there.position += move * float(steps);
        const float turned = angle * float(steps);
        if (angle != 0.0f)
            there.direction =
                glm::normalize(light.direction * std::cos(turned) + side * std::sin(turned));
        return there;
    }
};

// Across the picture, at right angles to where the light goes.
glm::vec3 sideOf(const Light& light, const Camera& camera) {
    const glm::vec3 ahead = glm::normalize(camera.target - camera.position);
    const glm::vec3 right = glm::normalize(glm::cross(ahead, camera.up));
    if (light.kind == LightKind::Point) return right;
    const glm::vec3 across = right - light.direction * glm::dot(right, light.direction);
    if (glm::dot(across, across) > 0.01f) return glm::normalize(across);
    return glm::normalize(camera.up - light.direction * glm::dot(camera.up, light.direction));
}

LightStep stepOf(const RayScene& rays, const Light& light, const Camera& camera) {
    LightStep step;
    step.side = sideOf(light, camera);
    if (light.kind != LightKind::Sun) {
        const float move = litDistance(rays, light) * std::tan(kSweepAngle);
        // A lamp keeps as far off walls as it moves in all.
        const float margin = 0.1f * move * float(kTurnBack);
        float way = freeWay(rays, light.position, step.side, margin);
        const float other = freeWay(rays, light.position, -step.side, margin);
        if (other > way) {
            way = other;
            step.side = -step.side;
        }
        const float most = kUsedWay * way / float(kTurnBack);
        if (most >= move || light.kind == LightKind::Point) {
            if (way >= kLeastWay * rays.diagonal()) step.move = step.side * std::min(move, most);
            return step;
        }
    }
    step.angle = kSweepAngle;  // suns, and spots without room
    return step;
}

FailureSequence makeSceneSweep(const SequenceSize& size, const std::shared_ptr<Scene>& scene) {
    const Camera camera = scene->cameras[0];
    const RayScene rays(scene, 0.0f);
    bool moves = false;
    for (std::size_t i = 0; i < scene->lights.size(); ++i) {
        const LightStep step = stepOf(rays, scene->lights[i], camera);
        moves = moves || (shines(scene->lights[i]) && step.isAny());
        Track<Light> track;
        track.target = int(i);
        for (int f = 0; f < size.frames; ++f)
            track.keys.emplace_back(float(f), step.after(scene->lights[i], stepsAt(f)));
        scene->lightTracks.push_back(std::move(track));
    }
    if (!moves)  // light at rest would be called steady
        throw std::invalid_argument(fmt::format(
            "lights of scene \"{}\": expected one with room to move, got point lights between walls",
            scene->name));
    FailureSequence sequence = makeFlight(size, scene, [&](int) { return camera; });
    sequence.sweeps = "lights' steps";
    // The camera rests: pixels keep points of their own as well as common ones from frame to frame, and
    // no noise of theirs adds up over the picture: Sibenik's floor of drift falls from 0.19 to 0.005.
    sequence.truthSharesPoints = false;
    for (int f = 0; f < size.frames; ++f) sequence.frames[std::size_t(f)].value = stepsAt(f);
    return sequence;
}

struct Movement {
    SequenceEntry entry;
    FailureSequence (*make)(const SequenceSize& size, const std::shared_ptr<Scene>& scene);
};
const std::vector<Movement>& movements() {
    static const std::vector<Movement> kMovements = {
        {{"camera_pan", "a turning camera", true}, makeScenePan},
        {{"camera_dolly", "a camera that moves ahead", true}, makeSceneDolly},
        {{"light_sweep_slow", "light that creeps", true}, makeSceneSweep},
    };
    return kMovements;
}

}  // namespace

const std::vector<SequenceEntry>& sceneMovements() {
    static const std::vector<SequenceEntry> kEntries = [] {
        std::vector<SequenceEntry> entries;
        for (const Movement& movement : movements()) entries.push_back(movement.entry);
        return entries;
    }();
    return kEntries;
}

FailureSequence makeMovement(const Scene& scene, const std::string& name, const SequenceSize& size) {
    requireSequenceSize(size);
    const auto movement = std::find_if(movements().begin(), movements().end(),
                                       [&](const Movement& known) { return known.entry.name == name; });
    if (movement == movements().end()) {
        std::vector<std::string> names;
        for (const Movement& known : movements()) names.push_back(known.entry.name);
        throw std::invalid_argument(
            fmt::format("sequence \"{}.{}\": expected after the scene's name one of: {}", scene.name,
                        name, fmt::join(names, ", ")));
    }
    const std::shared_ptr<Scene> still = standStill(scene);
    if (std::none_of(still->lights.begin(), still->lights.end(), shines))
        throw std::invalid_argument(
            fmt::format("scene \"{}\": expected a sun, spot or point light, got none that shines at 0 s",
                        scene.name));
    FailureSequence sequence = movement->make(size, still);
    sequence.name = scene.name + "." + name;
    sequence.failure = movement->entry.failure + " in scene " + scene.name;
    sequence.truthSamples = samplesFor(still, size, kTruthNoise);
    return sequence;
}

}  // namespace studio
