// What a scene's sequences need to know of it before they move: depths, ways without walls, and how many
// paths a quiet truth takes.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "gbuffer.h"
#include "lit_points.h"
#include "path_tracer.h"
#include "sequence_parts.h"

namespace studio {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

// Distance to the nearest surface, if any.
std::optional<float> reach(const RayScene& scene, const glm::vec3& origin, const glm::vec3& direction) {
    Hit hit;
    if (!scene.trace(origin, direction, 0.0f, kFar, hit)) return std::nullopt;
    return hit.distance;
}

float medianOr(std::vector<float> values, float otherwise) {
    if (values.empty()) return otherwise;
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

struct Axes {
    glm::vec3 right, up;
    explicit Axes(const glm::vec3& ahead) {
        const glm::vec3 other =
            std::abs(ahead.y) < 0.9f ? glm::vec3(0.0f, 1.0f, 0.0f) : glm::vec3(1.0f, 0.0f, 0.0f);
        right = glm::normalize(glm::cross(ahead, other));
        up = glm::cross(right, ahead);
    }
};

}  // namespace

float middleDepth(const RayScene& scene, const Camera& camera) {
    constexpr int kRays = 5;  // each way
    constexpr float kShare = 0.2f;
    const glm::vec3 ahead = glm::normalize(camera.target - camera.position);
    const Axes axes(ahead);
    const float tangent = std::tan(0.5f * camera.verticalFov) * kShare;
    std::vector<float> depths;
    for (int i = 0; i < kRays * kRays; ++i) {
        const glm::vec2 at = 2.0f * glm::vec2(i % kRays, i / kRays) / float(kRays - 1) - 1.0f;
        const glm::vec3 direction =
            glm::normalize(ahead + tangent * (axes.right * at.x + axes.up * at.y));
        if (const auto depth = reach(scene, camera.position, direction)) depths.push_back(*depth);
    }
    return medianOr(depths, scene.diagonal());
}

float freeWay(const RayScene& scene, const glm::vec3& from, const glm::vec3& direction, float radius) {
    constexpr int kAround = 8;
    const Axes axes(direction);
    float way = reach(scene, from, direction).value_or(scene.diagonal());
    for (int i = 0; i < kAround; ++i) {
        const float angle = 2.0f * kPi * float(i) / float(kAround);
        const glm::vec3 aside = axes.right * std::cos(angle) + axes.up * std::sin(angle);
        // Beside a wall the margin shrinks: what stands behind it is in nobody's way.
        const float room = std::min(radius, 0.5f * reach(scene, from, aside).value_or(kFar));
        if (const auto to = reach(scene, from + aside * room, direction)) way = std::min(way, *to);
    }
    return way;
}

float litDistance(const RayScene& scene, const Light& light) {
    std::vector<glm::vec3> directions = {light.direction};
    if (light.kind == LightKind::Point)
        directions = {{1.0f, 0.0f, 0.0f},  {-1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f},
                      {0.0f, -1.0f, 0.0f}, {0.0f, 0.0f, 1.0f},  {0.0f, 0.0f, -1.0f}};
    std::vector<float> distances;
    for (const glm::vec3& direction : directions)
        if (const auto distance = reach(scene, light.position, direction))
            distances.push_back(*distance);
    return medianOr(distances, 0.25f * scene.diagonal());
}

int samplesFor(const std::shared_ptr<const Scene>& scene, const SequenceSize& size, double noise) {
    // More than the most is an hour for eight scenes; flicker's floor asks for it, see
    // docs/stability.md.
    constexpr int kPilot = 16, kFewest = 16, kMost = 128;
    constexpr int kHeight = 45;  // enough pixels to tell a mean noise
    const RayScene rays(scene, 0.0f);
    const int height = std::min(size.height, kHeight);
    const int width = std::max(1, size.width * height / size.height);
    const Camera& camera = scene->cameras[0];
    const GBuffer view = renderGBuffer(rays, camera, width, height, camera, 0.0f);
    PathTracerOptions options;
    options.samplesPerPixel = kPilot;
    options.maxBounces = 1;
    const Image pilot = tracePaths(rays, view, options);
    const std::vector<float>& valid = pilot.plane("validity");
    if (std::none_of(valid.begin(), valid.end(), [](float v) { return v > 0.0f; }))
        throw std::invalid_argument(
            fmt::format("camera \"{}\" of scene \"{}\": expected surfaces in view, got none",
                        camera.name, scene->name));
    // Independent samples: noise falls with their number.
    const double needed = kPilot * estimateNoise(pilot, {"bounce1"}) / noise;
    int samples = kFewest;
    while (samples < kMost && double(samples) < needed) samples *= 2;
    return samples;
}

}  // namespace studio
