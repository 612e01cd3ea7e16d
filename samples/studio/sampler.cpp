#include "sampler.h"

#include <algorithm>
#include <cmath>

namespace studio {
namespace {

constexpr float kQuarterPi = 0.78539816339744831f;

// Square to unit disc, areas and neighbourhoods kept.
glm::vec2 concentricDisc(glm::vec2 point) {
    const glm::vec2 p = 2.0f * point - 1.0f;
    if (p.x == 0.0f && p.y == 0.0f) return glm::vec2(0.0f);
    const bool wide = std::abs(p.x) > std::abs(p.y);
    const float radius = wide ? p.x : p.y;
    const float angle = wide ? kQuarterPi * (p.y / p.x) : kQuarterPi * (2.0f - p.x / p.y);
    return radius * glm::vec2(std::cos(angle), std::sin(angle));
}

}  // namespace

glm::vec3 sampleCosine(const glm::vec3& normal, glm::vec2 point) {
    const glm::vec2 disc = concentricDisc(point);
    const float height = std::sqrt(std::max(0.0f, 1.0f - glm::dot(disc, disc)));

    // Tangents without branches: T. Duff et al., "Building an Orthonormal Basis, Revisited" (JCGT 2017).
    const float sign = std::copysign(1.0f, normal.z);
    const float a = -1.0f / (sign + normal.z);
    const float b = normal.x * normal.y * a;
    const glm::vec3 tangent(1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    const glm::vec3 bitangent(b, sign + normal.y * normal.y * a, -normal.y);
    return glm::normalize(disc.x * tangent + disc.y * bitangent + height * normal);
}

}  // namespace studio
