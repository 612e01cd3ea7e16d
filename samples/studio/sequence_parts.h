// What the catalogue's sequences are made of; for sequence*.cpp only.
#pragma once

#include "sequence.h"

namespace studio {

struct SequenceMaker {
    SequenceEntry entry;
    FailureSequence (*make)(const SequenceSize& size);
};
// In the catalogue's order.
const std::vector<SequenceMaker>& sequenceMakers();

// sequence_views.cpp
FailureSequence makePan(const SequenceSize& size);
FailureSequence makeDolly(const SequenceSize& size);
FailureSequence makeCut(const SequenceSize& size);
FailureSequence makeOffScreen(const SequenceSize& size);
FailureSequence makeSmallScale(const SequenceSize& size);
FailureSequence makeLargeScale(const SequenceSize& size);
FailureSequence makeResolutionChange(const SequenceSize& size);
FailureSequence makeGrazing(const SequenceSize& size);
FailureSequence makeEmpty(const SequenceSize& size);
FailureSequence makeNoLight(const SequenceSize& size);
// sequence_lights.cpp
FailureSequence makeSlowSweep(const SequenceSize& size);
FailureSequence makeQuickSweep(const SequenceSize& size);
FailureSequence makeMovingObject(const SequenceSize& size);
FailureSequence makeThinWalls(const SequenceSize& size);
FailureSequence makeGridCrossing(const SequenceSize& size);
FailureSequence makeTinyEmitter(const SequenceSize& size);
FailureSequence makeSphericalRoom(const SequenceSize& size);
FailureSequence makeOpeningDoor(const SequenceSize& size);
FailureSequence makeBlockedLight(const SequenceSize& size);

// sequence_probe.cpp
// Median depth of the middle fifth of the picture, along rays: a post in the very middle says little.
// Where nothing is seen there, the scene's diagonal.
float middleDepth(const RayScene& scene, const Camera& camera);
// How far a ball of this radius gets, its margin less beside a wall; at most the scene's diagonal where
// nothing is in the way.
float freeWay(const RayScene& scene, const glm::vec3& from, const glm::vec3& direction, float radius);
// From a spot along its axis, from a point light the median of six directions.
float litDistance(const RayScene& scene, const Light& light);
// Paths per pixel, a power of two, that bring the first frame's truth of one bounce to this relMSE: by a
// pilot of 16. Throws std::invalid_argument when the first camera sees nothing.
int samplesFor(const std::shared_ptr<const Scene>& scene, const SequenceSize& size, double noise);

void requireSequenceSize(const SequenceSize& size);  // throws std::invalid_argument

// Frame f of a scene at time f, the scene's keys being one per frame.
SequenceFrame& addFrame(FailureSequence& sequence, const SequenceSize& size,
                        std::shared_ptr<const Scene> scene, const Camera& camera);
// One scene, seen by a camera that moves.
FailureSequence makeFlight(const SequenceSize& size, const std::shared_ptr<Scene>& scene,
                           const std::function<Camera(int frame)>& cameraOf);
// The only light of the scene, keyed frame by frame.
void sweepLight(Scene& scene, const SequenceSize& size, const std::function<Light(int frame)>& lightOf);
Camera cameraOf(const Scene& scene, const char* name);
double shareOf(int frame, const SequenceSize& size);  // 0 in the first frame, 1 in the last
FailureSequence withSamples(int samples, FailureSequence sequence);

// A shipped scene (scene.h) that a sequence changes.
std::shared_ptr<Scene> shippedScene(const std::string& name);
// Scene "rooms" with its door as it stands at a time of its own.
std::shared_ptr<Scene> roomsWithDoorAt(float time);
// One light in place of all others.
void setLight(Scene& scene, const Light& light);
Light makeSpot(const glm::vec3& position, const glm::vec3& target, float intensity, float outerDegrees);
Camera makeCamera(const glm::vec3& position, const glm::vec3& target, float degrees);
// Turned about the vertical axis through its position: that of the world which its up is nearest to.
Camera yawed(const Camera& camera, float degrees);
Camera moved(const Camera& camera, const glm::vec3& by);

// Two yards under the open sky, `thickness` of wall between them, a lamp in the left one. Nothing rises
// above the walls, so that no light gets across, at any bounce; a camera from above sees both.
struct Yards {
    static constexpr float kHeight = 1.0f;  // of all walls, m
    static std::shared_ptr<Scene> make(float thickness);
    static std::uint8_t region(float thickness, const glm::vec3& position);
};
// A lamp in an open-topped shaft as high as the walls of the yard that it stands in: nothing of the yard
// gets light.
struct Shaft {
    static constexpr float kHalf = 0.4f;  // of its inner width, m
    static std::shared_ptr<Scene> make();
    static std::uint8_t region(const glm::vec3& position);
};
// A corridor along +x with blocks on both sides.
std::shared_ptr<Scene> makeCorridor();

}  // namespace studio
