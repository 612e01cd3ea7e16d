// Suns, spots and points as Scene's arrivalOf has them, for a whole batch in vector code.
#include "rival_arrivals.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ray_scene.h"
#include "simd_clones.h"

namespace studio {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kStep =
    1e30f;  // the ramp's slope where cones coincide: any difference of cosines fills it

STUDIO_SIMD void sunArrivals(const PathBatch& b, const float* toLight, Arrivals& to) {
    for (int i = 0; i < b.count; ++i) {
        float cosine = 0.0f, side = 0.0f;
        for (int c = 0; c < 3; ++c) {
            cosine += b.normal[c][i] * toLight[c];
            side += b.face[c][i] * toLight[c];
            to.direction[c][i] = toLight[c];
        }
        to.reach[i] = kInfinity;
        to.strength[i] = cosine > 0.0f && side > 0.0f ? cosine : 0.0f;
    }
}

// The ramp between the cones: (cosine off the axis - outer) * scale. The difference comes first, as the
// cosines of narrow cones agree in all but their last digits.
STUDIO_SIMD void lampArrivals(const PathBatch& b, const float* position, const float* axis, float outer,
                              float scale, Arrivals& to) {
    for (int i = 0; i < b.count; ++i) {
        const float x = position[0] - b.position[0][i], y = position[1] - b.position[1][i],
                    z = position[2] - b.position[2][i];
        const float squared = x * x + y * y + z * z;
        const float inverse = squared > 0.0f ? 1.0f / std::sqrt(squared) : 0.0f;
        const float lx = x * inverse, ly = y * inverse, lz = z * inverse;
        to.direction[0][i] = lx;
        to.direction[1][i] = ly;
        to.direction[2][i] = lz;
        to.reach[i] = squared * inverse * (1.0f - RayScene::kLightGap);
        const float cosine = b.normal[0][i] * lx + b.normal[1][i] * ly + b.normal[2][i] * lz;
        const float side = b.face[0][i] * lx + b.face[1][i] * ly + b.face[2][i] * lz;
        float ramp = (-axis[0] * lx - axis[1] * ly - axis[2] * lz - outer) * scale;
        ramp = ramp > 0.0f ? ramp : 0.0f;
        ramp = ramp < 1.0f ? ramp : 1.0f;
        to.strength[i] = cosine > 0.0f && side > 0.0f ? cosine * ramp * ramp * inverse * inverse : 0.0f;
    }
}

}  // namespace

void findArrivals(const Light& light, const PathBatch& batch, Arrivals& to) {
    if (light.kind == LightKind::Sun) {
        const glm::vec3 toLight = -light.direction;
        sunArrivals(batch, &toLight.x, to);
        return;
    }
    float outer = -2.0f, scale = 1.0f;  // beyond every cosine: 1 all round
    if (light.kind == LightKind::Spot) {
        outer = std::cos(light.outerCone);
        const float width = std::cos(light.innerCone) - outer;
        scale = width > 0.0f ? 1.0f / width : kStep;
    }
    lampArrivals(batch, &light.position.x, &light.direction.x, outer, scale, to);
}

}  // namespace studio
