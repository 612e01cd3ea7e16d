// What one layer of a picture can tell of rays: each is followed over the pictured surfaces alone, pixel by pixel, in double
// precision, until it enters one: no slices, no sectors, no coarse levels. Surfaces are the planes of their pixels and reach
// `thickness` farther along the view, as a share of their depth.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "support/seen_scene.h"

namespace lightwell::reference {

class ScreenWalk {
public:
    ScreenWalk(const test::SceneView& scene, double thickness)
        : scene_(scene),
          view_(scene.camera.viewMatrix()),
          projection_(scene.camera.projectionMatrix(scene.width, scene.height)),
          thickness_(thickness) {}

    // Of a ray from a surface with this normal; false: it enters nothing that the picture shows.
    bool meets(const glm::dvec3& from, const glm::dvec3& normal, const glm::dvec3& direction, int* column, int* row) const {
        const glm::dvec3 start(view_ * glm::dvec4(from, 1.0)), n = glm::dmat3(view_) * normal;
        const glm::dvec3 way = glm::dmat3(view_) * direction;
        const Place a = placeOf(start, 1.0);
        // Up to just before the eye, or where the ray vanishes.
        const double towardsEye = way.z / -start.z;
        const Place b = towardsEye > 1e-9 ? placeOf(start + way * (0.999 / towardsEye), 1.0) : placeOf(way.z < -1e-9 ? way : glm::dvec3(way.x, way.y, -1e-9), 0.0);
        const double pixels = std::max(std::abs(b.x - a.x), std::abs(b.y - a.y));
        for (int i = 1; i <= int(pixels); ++i) {
            const Place middle = between(a, b, i / pixels);
            const int x = int(std::floor(middle.x)), y = int(std::floor(middle.y));
            if (x < 0 || y < 0 || x >= scene_.width || y >= scene_.height) return false;
            if (!scene_.hasSurface(x, y)) continue;
            const glm::dvec3 q(view_ * glm::dvec4(glm::dvec3(scene_.pixels.position.rgb(x, y)), 1.0)), d = q - start;
            if (glm::dot(d, n) <= kAbovePlane * glm::length(d)) continue;
            if (enters(q, glm::dmat3(view_) * glm::normalize(glm::dvec3(scene_.pixels.normal.rgb(x, y))),
                       between(a, b, (i - 0.5) / pixels), between(a, b, (i + 0.5) / pixels))) {
                *column = x;
                *row = y;
                return true;
            }
        }
        return false;
    }

private:
    // As in the gather (kernels/horizon_gather).
    static constexpr double kAbovePlane = 0.01, kLeastViewCosine = 0.02, kExtension = 0.25;
    struct Place {
        double x, y, inverseDepth;
    };

    Place placeOf(const glm::dvec3& p, double finite) const {
        const double inverse = -1.0 / p.z;
        const glm::dvec2 ndc((projection_[0][0] * p.x + projection_[2][0] * p.z) * inverse, (projection_[1][1] * p.y + projection_[2][1] * p.z) * inverse);
        return {(0.5 * ndc.x + 0.5) * scene_.width, (0.5 - 0.5 * ndc.y) * scene_.height, finite * inverse};
    }

    static Place between(const Place& a, const Place& b, double f) {
        return {a.x + (b.x - a.x) * f, a.y + (b.y - a.y) * f, a.inverseDepth + (b.inverseDepth - a.inverseDepth) * f};
    }

    // How much farther than the plane of q the ray is at a place, and the plane's depth.
    double behind(const glm::dvec3& q, const glm::dvec3& n, const Place& at, double* depth) const {
        const glm::dvec2 ndc(2.0 * at.x / scene_.width - 1.0, 1.0 - 2.0 * at.y / scene_.height);
        const glm::dvec3 ray((ndc.x + projection_[2][0]) / projection_[0][0], (ndc.y + projection_[2][1]) / projection_[1][1], -1.0);
        const double seen = glm::dot(n, q) / q.z, held = std::max(seen, kLeastViewCosine);
        *depth = -q.z * held / std::max(held - seen - glm::dot(n, ray), kExtension * held);
        return 1.0 / std::max(at.inverseDepth, 1e-30) - *depth;
    }

    bool enters(const glm::dvec3& q, const glm::dvec3& n, const Place& begin, const Place& end) const {
        double beginDepth, endDepth;
        const double first = behind(q, n, begin, &beginDepth), last = behind(q, n, end, &endDepth);
        return std::max(first, last) >= 0.0 && std::min(first - thickness_ * beginDepth, last - thickness_ * endDepth) <= 0.0;
    }

    const test::SceneView& scene_;
    glm::dmat4 view_, projection_;
    double thickness_;
};

}  // namespace lightwell::reference
