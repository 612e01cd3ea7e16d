// Serial double-precision twin of paraboloid maps: directions of texels, and what a ray meets first.
#pragma once

#include <array>
#include <limits>

#include "reference/surfaces.h"
#include "shared/paraboloid_types.h"

namespace lightwell::reference {

inline Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline double length(Vec a) { return std::sqrt(dot(a, a)); }
inline Vec vecOf(const lw_float4& v) { return {double(v.s[0]), double(v.s[1]), double(v.s[2])}; }

// 105 degrees from the axis, by its definition.
inline const double kRim = std::tan(52.5 / 180.0 * 3.14159265358979323846);

struct ParaboloidFrame {
    Vec origin, x, y, z;
    explicit ParaboloidFrame(const lw_paraboloid& f)
        : origin(vecOf(f.origin)), x(vecOf(f.axisX)), y(vecOf(f.axisY)), z(vecOf(f.axisZ)) {}
    Vec world(Vec local) const { return x * local.x + y * local.y + z * local.z; }
    Vec local(Vec d) const { return {dot(d, x), dot(d, y), dot(d, z)}; }
};

inline double discOf(double texel, std::uint32_t size) { return ((texel + 0.5) / size * 2.0 - 1.0) * kRim; }
inline bool isBeforeRim(std::uint32_t x, std::uint32_t y, std::uint32_t size) {
    return std::hypot(discOf(x, size), discOf(y, size)) < kRim * (1.0 - 1e-6);
}
inline Vec localDirection(double texelX, double texelY, std::uint32_t size) {
    const double u = discOf(texelX, size), v = discOf(texelY, size), r2 = u * u + v * v;
    return Vec{2.0 * u, 2.0 * v, 1.0 - r2} * (1.0 / (1.0 + r2));
}

struct Triangle {
    Vec a, b, c;
    Vec normal() const { return unit(cross(b - a, c - a)); }
};

// The distance along unit `d` at which a triangle is met, infinity if it is not. Moeller and Trumbore's: another
// formula than the kernels'.
inline double meet(const Triangle& t, Vec origin, Vec d) {
    const double miss = std::numeric_limits<double>::infinity();
    const Vec e1 = t.b - t.a, e2 = t.c - t.a, p = cross(d, e2), s = origin - t.a, q = cross(s, e1);
    const double det = dot(e1, p);
    if (det == 0.0) return miss;
    const double u = dot(s, p) / det, v = dot(d, q) / det, distance = dot(e2, q) / det;
    return u < 0.0 || v < 0.0 || u + v > 1.0 || distance <= 0.0 ? miss : distance;
}

struct Nearest {
    double distance = std::numeric_limits<double>::infinity();
    double second = std::numeric_limits<double>::infinity();  // the next triangle's
    std::size_t triangle = 0;
};

inline Nearest nearest(const std::vector<Triangle>& triangles, Vec origin, Vec d) {
    Nearest n;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const double distance = meet(triangles[i], origin, d);
        if (distance < n.distance) {
            n.second = n.distance;
            n.distance = distance;
            n.triangle = i;
        } else {
            n.second = std::min(n.second, distance);
        }
    }
    return n;
}

}  // namespace lightwell::reference
