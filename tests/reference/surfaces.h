// Plain serial double-precision twins of the gather and its filters: no tiling, no lanes, no float
// tricks. They state what the kernels compute, pixel by pixel.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "shared/subset_order.h"
#include "shared/vpl_types.h"

namespace lightwell::reference {

struct Vec {
    double x = 0, y = 0, z = 0;
};
inline Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec operator*(Vec a, double s) { return {a.x * s, a.y * s, a.z * s}; }
inline double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec unit(Vec a) { return a * (1.0 / std::sqrt(dot(a, a))); }

// Packed planes of width * height floats, as the rig uploads them.
struct Image {
    std::uint32_t width = 0, height = 0;
    std::vector<float> planes;
    Image(std::uint32_t w, std::uint32_t h, std::uint32_t count = 3) : width(w), height(h), planes(std::size_t(w) * h * count) {}
    std::size_t at(std::uint32_t x, std::uint32_t y) const { return std::size_t(y) * width + x; }
    Vec get(std::uint32_t x, std::uint32_t y) const {
        const std::size_t n = std::size_t(width) * height, i = at(x, y);
        return {planes[i], planes[n + i], planes[2 * n + i]};
    }
    void set(std::uint32_t x, std::uint32_t y, Vec v) {
        const std::size_t n = std::size_t(width) * height, i = at(x, y);
        planes[i] = float(v.x);
        planes[n + i] = float(v.y);
        planes[2 * n + i] = float(v.z);
    }
};

struct Surface {
    Vec position, normal;
    bool valid = false;
};
inline Surface surfaceAt(const Image& position, const Image& normal, std::uint32_t x, std::uint32_t y) {
    Surface s{position.get(x, y), normal.get(x, y)};
    const double n2 = dot(s.normal, s.normal);
    s.valid = n2 > 0.25 && n2 < 4.0 && std::isfinite(s.position.x + s.position.y + s.position.z);
    if (s.valid) s.normal = s.normal * (1.0 / std::sqrt(n2));
    return s;
}

inline lw_vpl makeVpl(Vec position, Vec normal, Vec flux, double area) {
    lw_vpl v{};
    v.positionArea = {{float(position.x), float(position.y), float(position.z), float(area)}};
    v.normal = {{float(normal.x), float(normal.y), float(normal.z), float(area / (4.0 * 3.14159265358979323846))}};
    v.flux = {{float(flux.x), float(flux.y), float(flux.z), 0.0f}};
    return v;
}

// E += Phi / pi * c_p c / (d^2 + (1 + 3 c_p^2)/4 * A / pi), with the cosines as cosines.
inline Vec vplIrradiance(const lw_vpl& v, const Surface& s) {
    const double pi = 3.14159265358979323846;
    const Vec to = Vec{v.positionArea.s[0], v.positionArea.s[1], v.positionArea.s[2]} - s.position;
    const double d = std::sqrt(dot(to, to));
    if (d == 0.0) return {};
    const double c = std::max(0.0, dot(to, s.normal) / d);
    const double cp = std::max(0.0, -dot(to, {v.normal.s[0], v.normal.s[1], v.normal.s[2]}) / d);
    const double w = cp * c / (pi * (d * d + 0.25 * (1.0 + 3.0 * cp * cp) * v.positionArea.s[3] / pi));
    return Vec{v.flux.s[0], v.flux.s[1], v.flux.s[2]} * w;
}

// The raw interleaved image: pixel (x, y) takes subset (y mod n) * n + x mod n, times n^2.
inline Image gather(const Image& position, const Image& normal, const std::vector<lw_vpl>& vpls, lw_subset_order order,
                    std::uint32_t n) {
    Image out(position.width, position.height);
    for (std::uint32_t y = 0; y < out.height; ++y)
        for (std::uint32_t x = 0; x < out.width; ++x) {
            const Surface s = surfaceAt(position, normal, x, y);
            if (!s.valid) continue;
            const std::size_t first = std::size_t((y % n) * n + x % n) * std::size_t(order.capacity);
            Vec sum;
            for (std::size_t k = 0; k < std::size_t(order.capacity); ++k) sum = sum + vplIrradiance(vpls[first + k], s);
            out.set(x, y, sum * double(n * n));
        }
    return out;
}

// Neighbour q on the tangent plane of s (within the slope), weight linear in the cosine from 0.8 on.
inline double edgeWeight(const Surface& s, const Surface& q, double slope = 0.7) {
    if (!q.valid) return 0.0;
    const Vec d = q.position - s.position;
    const double off = dot(d, s.normal);
    if (off * off > slope * slope * dot(d, d)) return 0.0;
    return std::clamp((dot(q.normal, s.normal) - 0.8) / 0.2, 0.0, 1.0);
}

// The slope within which a pixel's neighbours are its own surface: three times the sine of what leads to the pixels beside it, in quadrature with 0.05; of two
// on opposite sides the lesser, of rows and columns the larger; 0.7 at most, and where there is nothing beside it.
inline double edgeSlope(const Image& position, const Image& normal, std::uint32_t x, std::uint32_t y) {
    const Surface s = surfaceAt(position, normal, x, y);
    const auto sine = [&](int dx, int dy) {
        const int qx = int(x) + dx, qy = int(y) + dy;
        if (qx < 0 || qy < 0 || qx >= int(position.width) || qy >= int(position.height)) return 1.0;
        const Vec d = position.get(std::uint32_t(qx), std::uint32_t(qy)) - s.position;
        const double found = std::abs(dot(d, s.normal)) / std::sqrt(dot(d, d));
        return found < 1.0 ? found : 1.0;  // also where it is no number
    };
    const double lean = std::max(std::min(sine(-1, 0), sine(1, 0)), std::min(sine(0, -1), sine(0, 1)));
    return std::min(std::hypot(3.0 * lean, 0.05), 0.7);
}

// n x n window around each pixel, moved inside at the border.
inline Image filter(const Image& position, const Image& normal, const Image& light, std::uint32_t n) {
    Image out(light.width, light.height);
    auto first = [n](std::uint32_t at, std::uint32_t size) {
        const int last = std::max(int(size) - int(n), 0);
        return std::uint32_t(std::clamp(int(at) - int(n / 2 - 1), 0, last));
    };
    for (std::uint32_t y = 0; y < out.height; ++y)
        for (std::uint32_t x = 0; x < out.width; ++x) {
            const Surface s = surfaceAt(position, normal, x, y);
            if (!s.valid) continue;
            const double slope = edgeSlope(position, normal, x, y);
            Vec sum;
            double weight = 0.0;
            for (std::uint32_t j = first(y, out.height); j < std::min(first(y, out.height) + n, out.height); ++j)
                for (std::uint32_t i = first(x, out.width); i < std::min(first(x, out.width) + n, out.width); ++i) {
                    const double w = edgeWeight(s, surfaceAt(position, normal, i, j), slope);
                    sum = sum + light.get(i, j) * w;
                    weight += w;
                }
            out.set(x, y, sum * (1.0 / weight));
        }
    return out;
}

// Half resolution: the first valid pixel of each 2x2 block: (0,0), (1,1), (1,0), (0,1).
inline void downsample(const Image& position, const Image& normal, Image& halfPosition, Image& halfNormal) {
    const std::uint32_t order[4][2] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
    for (std::uint32_t y = 0; y < halfPosition.height; ++y)
        for (std::uint32_t x = 0; x < halfPosition.width; ++x)
            for (const auto& [dx, dy] : order) {
                const std::uint32_t fx = 2 * x + dx, fy = std::min(2 * y + dy, position.height - 1);
                if (fx >= position.width) continue;
                const Surface s = surfaceAt(position, normal, fx, fy);
                if (!s.valid) continue;
                halfPosition.set(x, y, s.position);
                halfNormal.set(x, y, s.normal);
                break;
            }
}

// Sum over the 3x3 samples around a pixel, each with its tent times what `weigh` makes of its surface, and the sum of those weights.
template <typename Weigh>
std::pair<Vec, double> sumOfSamples(const Image& halfPosition, const Image& halfNormal, const Image& halfLight, std::uint32_t x, std::uint32_t y, Weigh weigh) {
    std::pair<Vec, double> sum;
    for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
            const int hx = int(x / 2) + i, hy = int(y / 2) + j;
            if (hx < 0 || hy < 0 || hx >= int(halfLight.width) || hy >= int(halfLight.height)) continue;
            const double tx = 1.0 - std::abs(2 * hx - int(x)) / 3.0, ty = 1.0 - std::abs(2 * hy - int(y)) / 3.0;
            const Surface q = surfaceAt(halfPosition, halfNormal, std::uint32_t(hx), std::uint32_t(hy));
            if (tx <= 1e-9 || ty <= 1e-9 || !q.valid) continue;
            const double w = tx * ty * weigh(q);
            sum.first = sum.first + halfLight.get(std::uint32_t(hx), std::uint32_t(hy)) * w;
            sum.second += w;
        }
    return sum;
}

// By samples within the slope of their block's; else within 0.7; else by likeness of normals. Returns the number of pixels lit by the last.
inline std::uint32_t upsample(const Image& position, const Image& normal, const Image& halfPosition,
                              const Image& halfNormal, const Image& halfLight, Image& out) {
    std::uint32_t fallbacks = 0;
    for (std::uint32_t y = 0; y < out.height; ++y)
        for (std::uint32_t x = 0; x < out.width; ++x) {
            const Surface s = surfaceAt(position, normal, x, y);
            if (!s.valid) continue;
            const auto sum = [&](auto weigh) { return sumOfSamples(halfPosition, halfNormal, halfLight, x, y, weigh); };
            const double slope = edgeSlope(halfPosition, halfNormal, x / 2, y / 2);
            auto [light, weight] = sum([&](const Surface& q) { return edgeWeight(s, q, slope); });
            if (weight <= 1e-4) std::tie(light, weight) = sum([&](const Surface& q) { return edgeWeight(s, q); });
            if (weight <= 1e-4) {
                std::tie(light, weight) = sum([&](const Surface& q) { return std::max(0.0, dot(q.normal, s.normal)) + 1e-3; });
                ++fallbacks;
            }
            out.set(x, y, light * (1.0 / weight));
        }
    return fallbacks;
}

// ------------------------------------------------------------------------------------ test scenes

// A floor that meets a wall, a slab standing before them, and background: depth edges, normal edges,
// grazing angles; normals of several lengths, as compact formats and interpolation leave them.
inline void fillCorner(Image& position, Image& normal) {
    for (std::uint32_t y = 0; y < position.height; ++y)
        for (std::uint32_t x = 0; x < position.width; ++x) {
            const double u = (x + 0.5) / position.width, v = (y + 0.5) / position.height;
            if (v < 0.1) continue;  // background
            if (u > 0.3 && u < 0.5 && v > 0.3 && v < 0.8) {
                position.set(x, y, {u, 1.0 - v, 0.7});
                normal.set(x, y, {0, 0, 0.7});
            } else if (v < 0.6) {
                position.set(x, y, {u, 1.0 - v, 0.0});
                normal.set(x, y, {0, 0, 1});
            } else {
                position.set(x, y, {u, 0.4, (v - 0.6) * 2.0});
                normal.set(x, y, {0, 1.5, 0});
            }
        }
}

inline Image randomImage(std::uint32_t width, std::uint32_t height, unsigned seed) {
    Image image(width, height);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(0.0f, 2.0f);
    for (float& v : image.planes) v = value(random);
    return image;
}

inline std::vector<lw_vpl> randomVpls(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-1.0, 2.0), component(-1.0, 1.0), flux(0.0, 1.0);
    std::vector<lw_vpl> vpls;
    while (vpls.size() < count) {
        const Vec n{component(random), component(random), component(random)};
        if (dot(n, n) < 0.01) continue;
        vpls.push_back(makeVpl({place(random), place(random), place(random)}, unit(n),
                               {flux(random), flux(random), flux(random)}, 0.01 * flux(random)));
    }
    return vpls;
}

}  // namespace lightwell::reference
