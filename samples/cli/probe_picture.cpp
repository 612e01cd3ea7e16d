// Probes as small white spheres in a view's picture, each in the light that it holds.
#include <algorithm>
#include <cmath>

#include "image.h"
#include "probe_grid.h"

namespace cli {
namespace {

constexpr float kPi = 3.14159265f;

// A pixel's ray: from the eye through its middle.
struct Rays {
    glm::vec3 eye, forward, across, down;
    int width, height;
    Rays(const studio::GBuffer& gbuffer)
        : eye(gbuffer.camera.position), width(gbuffer.width), height(gbuffer.height) {
        const studio::Camera& camera = gbuffer.camera;
        forward = glm::normalize(camera.target - camera.position);
        const glm::vec3 right = glm::normalize(glm::cross(forward, camera.up));
        const float half = std::tan(0.5f * camera.verticalFov);
        down = -glm::cross(right, forward) * half;
        across = right * (half * float(width) / float(height));
    }
    glm::vec3 at(int x, int y) const {
        const float u = (float(x) + 0.5f) / float(width) * 2.0f - 1.0f,
                    v = (float(y) + 0.5f) / float(height) * 2.0f - 1.0f;
        return glm::normalize(forward + across * u + down * v);
    }
};

// Distance to a sphere along a ray, infinity where it misses.
float hitSphere(const glm::vec3& from, const glm::vec3& along, const glm::vec3& centre, float radius) {
    const glm::vec3 to = centre - from;
    const float middle = glm::dot(to, along), off = glm::dot(to, to) - middle * middle;
    if (middle <= 0.0f || off > radius * radius) return INFINITY;
    return middle - std::sqrt(radius * radius - off);
}

}  // namespace

void drawProbes(const ProbeGrid& grid, const studio::GBuffer& gbuffer, float radius,
                studio::Image& picture) {
    const Rays rays(gbuffer);
    const std::size_t pixels = std::size_t(gbuffer.width) * std::size_t(gbuffer.height);
    std::vector<float> nearest(pixels);
    for (int y = 0; y < gbuffer.height; ++y)
        for (int x = 0; x < gbuffer.width; ++x) {
            const bool some = glm::length(gbuffer.normal.rgb(x, y)) > 0.0f;
            nearest[std::size_t(y) * std::size_t(gbuffer.width) + std::size_t(x)] =
                some ? glm::length(gbuffer.position.rgb(x, y) - rays.eye) : INFINITY;
        }
    std::vector<float>* planes[3] = {&picture.plane("R"), &picture.plane("G"), &picture.plane("B")};
    const float perUnit = 0.5f * float(gbuffer.height) / std::tan(0.5f * gbuffer.camera.verticalFov);
    for (const Probe& probe : grid.probes) {
        if (probe.validity == 0.0f) continue;
        const glm::vec3 to = probe.position - rays.eye;
        const float depth = glm::dot(to, rays.forward);
        if (depth < 2.0f * radius) continue;
        // The square of pixels around it, with room for the perspective's stretch towards the picture's
        // edge.
        const float scale = perUnit / depth;
        const int reach = int(2.0f * radius * scale) + 2;
        const int cx = int(0.5f * float(gbuffer.width) +
                           glm::dot(to, glm::normalize(rays.across)) * scale),
                  cy = int(0.5f * float(gbuffer.height) +
                           glm::dot(to, glm::normalize(rays.down)) * scale);
        for (int y = std::max(cy - reach, 0); y < std::min(cy + reach, gbuffer.height); ++y)
            for (int x = std::max(cx - reach, 0); x < std::min(cx + reach, gbuffer.width); ++x) {
                const glm::vec3 ray = rays.at(x, y);
                const float distance = hitSphere(rays.eye, ray, probe.position, radius);
                const std::size_t at = std::size_t(y) * std::size_t(gbuffer.width) + std::size_t(x);
                if (!(distance < nearest[at])) continue;
                nearest[at] = distance;
                const glm::vec3 radiance =
                    irradianceOf(probe, glm::normalize(rays.eye + ray * distance - probe.position)) /
                    kPi;
                for (int c = 0; c < 3; ++c) (*planes[c])[at] = radiance[c];
            }
    }
}

}  // namespace cli
