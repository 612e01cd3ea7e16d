// Where the view is taken from: a scene's camera, flown by mouse and keys, or led along a path.
#pragma once

#include <string>
#include <vector>

#include "scene.h"

namespace viewer {

// Keys of a camera over time, as a scene JSON's camera has them (docs/scenes.md), alone in a file.
class CameraPath {
public:
    // std::runtime_error naming the file, the key, what was expected and what came.
    explicit CameraPath(const std::string& file);
    CameraPath(const studio::Scene& scene, int camera);  // the scene's own keys
    CameraPath() = default;
    bool isEmpty() const { return keys_.empty(); }
    studio::Camera at(float time) const;
    float duration() const { return keys_.empty() ? 0.0f : keys_.back().first; }
    void add(float time, const studio::Camera& camera);  // after all others: a second after the last where the clock has not moved on
    void write(const std::string& file) const;

private:
    std::vector<std::pair<float, studio::Camera>> keys_;
};

class CameraControl {
public:
    // `extent`: of the scene, m: how fast the camera flies.
    CameraControl(const studio::Camera& camera, float extent) : camera_(camera), speed_(0.1f * extent) {}
    const studio::Camera& camera() const { return camera_; }
    void set(const studio::Camera& camera) { camera_ = camera; }
    // By what ImGui has of mouse and keyboard; true when something moved.
    bool fly(float seconds);
    float& speed() { return speed_; }

private:
    studio::Camera camera_;
    float speed_;  // m/s
};

}  // namespace viewer
