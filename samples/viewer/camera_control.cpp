#include "camera_control.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "scene_json_parts.h"

namespace viewer {
namespace {

constexpr float kRadiansPerPixel = 0.004f, kFaster = 5.0f;
constexpr float kLongestStep = 0.1f;  // s: after a frame that took longer nobody wants to be elsewhere
constexpr float kSteepest = 1.5f;  // radians from the horizon: a view along "up" has no sides

std::string vectorText(const glm::vec3& v) {
    return fmt::format("[{}, {}, {}]", v.x, v.y, v.z);
}

std::string keyText(const studio::Camera& camera) {
    return fmt::format("\"position\": {}, \"target\": {}, \"up\": {}, \"vertical_fov_degrees\": {}", vectorText(camera.position),
                       vectorText(camera.target), vectorText(camera.up), camera.verticalFov / studio::kDegrees);
}

// Direction of view turned about `up` and towards it, in radians.
glm::vec3 turned(const glm::vec3& forward, const glm::vec3& up, float about, float towards) {
    const float elevation = std::asin(std::clamp(glm::dot(forward, up), -1.0f, 1.0f));
    const glm::vec3 ahead = glm::normalize(forward - up * glm::dot(forward, up)), side = glm::cross(ahead, up);
    const glm::vec3 level = ahead * std::cos(about) + side * std::sin(about);
    const float angle = std::clamp(elevation + towards, -kSteepest, kSteepest);
    return level * std::cos(angle) + up * std::sin(angle);
}

}  // namespace

CameraPath::CameraPath(const std::string& file) {
    std::ifstream in(file);
    if (!in) throw std::runtime_error(fmt::format("{}: can't be read", file));
    nlohmann::json document;
    try {
        document = nlohmann::json::parse(in);
    } catch (const std::exception& error) {
        throw std::runtime_error(fmt::format("{}: {}", file, error.what()));
    }
    studio::Scene scene;
    studio::readJsonCamera(studio::JsonValue(document, file, "camera"), scene);
    if (scene.cameraTracks.empty())
        throw std::runtime_error(fmt::format("{}: expected a camera with \"keys\" (docs/viewer.md), got one without", file));
    keys_ = scene.cameraTracks[0].keys;
}

CameraPath::CameraPath(const studio::Scene& scene, int camera) {
    for (const studio::Track<studio::Camera>& track : scene.cameraTracks)
        if (track.target == camera) keys_ = track.keys;
}

studio::Camera CameraPath::at(float time) const {
    studio::Scene scene;
    scene.cameras.push_back(keys_.front().second);
    scene.cameraTracks.push_back({0, keys_});
    return scene.cameraAt(0, time);
}

void CameraPath::add(float time, const studio::Camera& camera) {
    if (!keys_.empty() && time <= keys_.back().first) time = keys_.back().first + 1.0f;
    keys_.emplace_back(time, camera);
}

void CameraPath::write(const std::string& file) const {
    std::ofstream out(file);
    out << "{\n  \"name\": \"path\", " << keyText(keys_.front().second) << ",\n  \"keys\": [\n";
    for (std::size_t i = 0; i < keys_.size(); ++i)
        out << fmt::format("    {{\"time\": {}, {}}}{}\n", keys_[i].first, keyText(keys_[i].second), i + 1 < keys_.size() ? "," : "");
    out << "  ]\n}\n";
    out.close();
    if (!out) throw std::runtime_error(fmt::format("{}: can't be written", file));
}

bool CameraControl::fly(float seconds) {
    const ImGuiIO& io = ImGui::GetIO();
    glm::vec3 forward = glm::normalize(camera_.target - camera_.position);
    const glm::vec3 up = glm::normalize(camera_.up);
    bool isMoved = false;
    // Held since the frame before: the way to where it was pressed is no drag.
    const bool isHeld = io.MouseDownDuration[ImGuiMouseButton_Left] > 0.0f || io.MouseDownDuration[ImGuiMouseButton_Right] > 0.0f;
    if (!io.WantCaptureMouse && isHeld && (io.MouseDelta.x != 0.0f || io.MouseDelta.y != 0.0f)) {
        forward = turned(forward, up, io.MouseDelta.x * kRadiansPerPixel, -io.MouseDelta.y * kRadiansPerPixel);
        isMoved = true;
    }
    const glm::vec3 side = glm::normalize(glm::cross(forward, up));
    glm::vec3 way(0.0f);
    const auto step = [&](int key, const glm::vec3& direction) {
        if (!io.WantCaptureKeyboard && ImGui::IsKeyDown(key)) way += direction;
    };
    step(GLFW_KEY_W, forward), step(GLFW_KEY_S, -forward);
    step(GLFW_KEY_D, side), step(GLFW_KEY_A, -side);
    step(GLFW_KEY_E, up), step(GLFW_KEY_Q, -up);
    if (way != glm::vec3(0.0f)) isMoved = true;
    camera_.position += way * (speed_ * std::min(seconds, kLongestStep) * (io.KeyShift ? kFaster : 1.0f));
    camera_.target = camera_.position + forward;
    return isMoved;
}

}  // namespace viewer
