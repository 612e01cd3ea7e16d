// Plain serial double-precision twins of the screen-space gather and of putting its levels together.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "reference/surfaces.h"
#include "shared/screen_types.h"

namespace lightwell::reference {

// A level as downloaded: texels of 10 planes, light of 4.
struct ScreenLevel {
    Image position, normal, radiance;
    std::vector<float> area;
};
using Light = Image;  // LW_LIGHT_PLANES planes

inline double planeAt(const Image& image, std::uint32_t plane, std::uint32_t x, std::uint32_t y) {
    return double(image.planes[std::size_t(plane) * image.width * image.height + image.at(x, y)]);
}
inline void setPlane(Image& image, std::uint32_t plane, std::uint32_t x, std::uint32_t y, double v) {
    image.planes[std::size_t(plane) * image.width * image.height + image.at(x, y)] = float(v);
}

// Bounded (or not) light from one texel that stands for `weight` of its area; the fourth: share of the hemisphere.
inline std::vector<double> fromTexel(const Surface& s, const ScreenLevel& level, std::uint32_t x, std::uint32_t y, double weight,
                                     bool bounded) {
    const double pi = 3.14159265358979323846;
    const Surface q = surfaceAt(level.position, level.normal, x, y);
    if (!q.valid) return {0, 0, 0, 0};
    const Vec to = q.position - s.position;
    const double d2 = dot(to, to), d = std::sqrt(d2);
    if (d == 0.0) return {0, 0, 0, 0};
    const double c = std::max(0.0, dot(to, s.normal) / d), cp = std::max(0.0, -dot(to, q.normal) / d);
    const double area = weight * double(level.area[level.position.at(x, y)]);
    const double w = std::min(c * cp * area / (d2 + (bounded ? 0.25 * (1.0 + 3.0 * cp * cp) * area / pi : 0.0)), 1e6);
    const Vec l = level.radiance.get(x, y);
    return {w * l.x, w * l.y, w * l.z, w / pi};
}

inline Light screenGather(const ScreenLevel& level, const std::vector<LwScreenSample>& samples, std::uint32_t count,
                          std::uint32_t n, bool bounded) {
    Light light(level.position.width, level.position.height, LW_LIGHT_PLANES);
    for (std::uint32_t y = 0; y < light.height; ++y)
        for (std::uint32_t x = 0; x < light.width; ++x) {
            const Surface s = surfaceAt(level.position, level.normal, x, y);
            if (!s.valid) continue;
            double sum[4] = {};
            for (std::uint32_t k = 0; k < count; ++k) {
                const LwScreenSample& sample = samples[std::size_t((y % n) * n + x % n) * count + k];
                const int tx = int(x) + sample.step * int(n) + sample.phase, ty = int(y) + sample.row;
                if (tx < 0 || ty < 0 || tx >= int(light.width) || ty >= int(light.height)) continue;
                const auto part = fromTexel(s, level, std::uint32_t(tx), std::uint32_t(ty), double(sample.weight), bounded);
                for (int a = 0; a < 4; ++a) sum[a] += part[std::size_t(a)];
            }
            for (std::uint32_t a = 0; a < 4; ++a) setPlane(light, a, x, y, sum[a]);
        }
    return light;
}

// Mean over the texels of its own surface up to n / 2 away from each, half of those at the ends.
inline Light screenFilter(const ScreenLevel& level, const Light& light, std::uint32_t n) {
    Light out(light.width, light.height, LW_LIGHT_PLANES);
    const int reach = int(n / 2);
    for (std::uint32_t y = 0; y < out.height; ++y)
        for (std::uint32_t x = 0; x < out.width; ++x) {
            const Surface s = surfaceAt(level.position, level.normal, x, y);
            if (!s.valid) continue;
            double sum[4] = {}, weight = 0.0;
            for (int j = -reach; j <= reach; ++j)
                for (int i = -reach; i <= reach; ++i) {
                    const int tx = int(x) + i, ty = int(y) + j;
                    if (tx < 0 || ty < 0 || tx >= int(out.width) || ty >= int(out.height)) continue;
                    const double share = (std::abs(i) == reach ? 0.5 : 1.0) * (std::abs(j) == reach ? 0.5 : 1.0);
                    const double w = share * edgeWeight(s, surfaceAt(level.position, level.normal, std::uint32_t(tx), std::uint32_t(ty)));
                    for (std::uint32_t a = 0; a < 4; ++a) sum[a] += w * planeAt(light, a, std::uint32_t(tx), std::uint32_t(ty));
                    weight += w;
                }
            for (std::uint32_t a = 0; a < 4; ++a) setPlane(out, a, x, y, sum[a] / weight);
        }
    return out;
}

// A level's light at the pixels of an image `factor` times as fine; returns how many surfaces no texel of their own reaches.
inline std::uint32_t screenUpsample(const Image& position, const Image& normal, const ScreenLevel& coarse, const Light& light,
                                    std::uint32_t factor, Light& out) {
    const auto spline = [](double d) {
        d = std::abs(d);
        return d < 0.5 ? 0.75 - d * d : d < 1.5 ? 0.5 * (1.5 - d) * (1.5 - d) : 0.0;
    };
    std::uint32_t lost = 0;
    for (std::uint32_t y = 0; y < out.height; ++y)
        for (std::uint32_t x = 0; x < out.width; ++x) {
            const Surface s = surfaceAt(position, normal, x, y);
            if (!s.valid) continue;
            const double cx = (x + 0.5) / factor - 0.5, cy = (y + 0.5) / factor - 0.5;
            double sum[4] = {}, rest[4] = {}, weight = 0.0, restWeight = 0.0;
            for (int j = -1; j <= 1; ++j)
                for (int i = -1; i <= 1; ++i) {
                    const int tx = int(x / factor) + i, ty = int(y / factor) + j;
                    if (tx < 0 || ty < 0 || tx >= int(light.width) || ty >= int(light.height)) continue;
                    const Surface q = surfaceAt(coarse.position, coarse.normal, std::uint32_t(tx), std::uint32_t(ty));
                    if (!q.valid) continue;
                    const double tent = spline(tx - cx) * spline(ty - cy), w = tent * edgeWeight(s, q);
                    const double r = tent * (std::max(0.0, dot(q.normal, s.normal)) + 1e-3);
                    for (std::uint32_t a = 0; a < 4; ++a) {
                        sum[a] += w * planeAt(light, a, std::uint32_t(tx), std::uint32_t(ty));
                        rest[a] += r * planeAt(light, a, std::uint32_t(tx), std::uint32_t(ty));
                    }
                    weight += w;
                    restWeight += r;
                }
            const bool isLost = weight <= 1e-4;
            lost += isLost ? 1 : 0;
            for (std::uint32_t a = 0; a < 4; ++a) setPlane(out, a, x, y, isLost ? rest[a] / restWeight : sum[a] / weight);
        }
    return lost;
}

}  // namespace lightwell::reference
