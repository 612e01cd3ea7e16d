// Serial double-precision twin of the horizon gather: slice by slice with angles from atan2, the measure as GTAO's integral
// writes it, and one boolean per sector. It shares the pattern and the pyramid with the kernels, nothing else.
#pragma once

#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <vector>

#include "inputs/camera.h"
#include "passes/horizon_gather.h"

namespace lightwell::reference {

struct HorizonLevel {
    std::uint32_t width, height;
    std::vector<float> planes;
    glm::dvec3 get(int x, int y, std::size_t first) const {
        const std::size_t n = std::size_t(width) * height, i = std::size_t(y) * width + std::size_t(x);
        return {planes[first * n + i], planes[(first + 1) * n + i], planes[(first + 2) * n + i]};
    }
};

// The measure between V and an angle on a side whose normal leans towards it by gamma.
inline double measureTo(double angle, double gamma, bool uniform) {
    if (uniform) return 1.0 - std::cos(angle);
    return 0.25 * (std::cos(gamma) - std::cos(2.0 * angle - gamma) + 2.0 * angle * std::sin(gamma));
}

struct HorizonSlice {
    glm::dvec3 v, t;          // towards the eye, and across it along the line
    double gamma, projected;  // the normal's angle and length in the slice
    double before, total;     // measure of the side against the line, of both
};

inline HorizonSlice sliceOf(glm::dvec3 n, glm::dvec3 v, glm::dvec3 line, bool uniform) {
    constexpr double kHalfPi = 1.5707963267948966;
    HorizonSlice s;
    s.v = v;
    s.t = glm::normalize(line - v * glm::dot(line, v));
    const double nv = std::fmax(glm::dot(n, v), 1e-3), nt = glm::dot(n, s.t);
    s.gamma = std::atan2(nt, nv);
    s.projected = std::hypot(nv, nt);
    s.before = measureTo(kHalfPi - s.gamma, -s.gamma, uniform);
    s.total = s.before + measureTo(kHalfPi + s.gamma, s.gamma, uniform);
    return s;
}

// A point of the slice's plane as an angle from V on one side.
inline double angleOf(glm::dvec3 d, const HorizonSlice& s, double side) {
    return std::atan2(side * glm::dot(d, s.t), glm::dot(d, s.v));
}

inline std::vector<float> horizonGather(const std::vector<HorizonLevel>& levels, const HorizonPattern& pattern, const Camera& camera,
                                        const HorizonRanges& ranges, const HorizonPatternOptions& options, std::uint32_t fullHeight,
                                        bool light, bool uniform, std::uint32_t turn) {
    constexpr double kHalfPi = 1.5707963267948966, kSectors = LW_HORIZON_SECTORS;
    const HorizonLevel& base = levels[0];
    const std::size_t plane = std::size_t(base.width) * base.height, open = light ? 4 : 0;
    std::vector<float> out(plane * (light ? 6 : 2), 0.0f);
    const glm::dvec3 perI = camera.rays().perI, perJ = camera.rays().perJ;
    const bool perspective = camera.perspective();
    const double height = glm::length(perJ) * fullHeight, thick = ranges.thickness * height;
    for (int y = 0; y < int(base.height); ++y)
        for (int x = 0; x < int(base.width); ++x) {
            const glm::dvec3 p = base.get(x, y, 0), n = base.get(x, y, 3);
            if (glm::dot(n, n) < 0.25) continue;
            const double depth = camera.axial(p), radius = ranges.ambientRadius * height * (perspective ? depth : 1.0);
            const glm::dvec3 axis = glm::dot(n, camera.axis()) > 0.0 ? camera.axis() : -camera.axis();
            const glm::dvec3 v = perspective ? glm::normalize(camera.eye() - p) : axis;
            std::array<double, 6> sum{};
            for (std::uint32_t i = 0; i < options.directions / options.rows; ++i) {
                const lw_horizon_slice& slice = pattern.slices[(std::size_t(y) + turn) % options.rows + i * options.rows];
                const glm::dvec3 line = double(slice.dx) * perI + double(slice.dy) * perJ;
                const HorizonSlice s = sliceOf(n, v, line, uniform);
                const double turned = double(slice.rounding) + 0.9 * std::fmod(0.6180339887 * turn, 1.0), rounding = turned < 0.95 ? turned : turned - 0.9;
                std::array<bool, LW_HORIZON_SECTORS> covered{}, near{};
                std::array<double, 4> found{};
                for (int against = 0; against < 2; ++against)
                    for (int k = 0; k < slice.steps; ++k) {
                        const lw_horizon_step& step = pattern.steps[std::size_t(slice.first[against] + k)];
                        const HorizonLevel& level = levels[std::size_t(step.level)];
                        // Shifts of an 8 x 8 pattern, in sixteenths of a texel.
                        const double texel = std::ldexp(1.0, step.level);
                        const bool blends = step.level >= 3;
                        const auto shifted = [&](int sixteenth) { return blends ? std::floor((2 * sixteenth - 7) * texel / 16.0) : 0.0; };
                        const double placeX = x + step.phaseX + shifted((x + 3 * int(turn)) % 8),
                                     placeY = y + step.phaseY + shifted((3 * x + 5 * (y + int(turn)) + int(turn / 8)) % 8);
                        const int tx = int(std::floor(placeX / texel)) + step.dx, ty = int(std::floor(placeY / texel)) + step.dy;
                        if (tx < 0 || ty < 0 || tx >= int(level.width) || ty >= int(level.height)) continue;
                        if (blends && (placeX + step.dx * texel >= base.width || placeY + step.dy * texel >= base.height)) continue;
                        const glm::dvec3 q = level.get(tx, ty, 0), m = level.get(tx, ty, 3), d = q - p;
                        const double up = glm::dot(d, n), sign = against ? -1.0 : 1.0;
                        if (glm::dot(m, m) < 0.25 || up <= 0.01 * glm::length(d)) continue;
                        // The plane of q, met by the rays at begin and end.
                        double least = HUGE_VAL, last = 0.0;
                        glm::dvec3 farthest{0.0};
                        for (const double at : {double(step.begin), double(step.end)}) {
                            glm::dvec3 end;
                            if (perspective) {
                                const glm::dvec3 ray = (p - camera.eye()) / depth + line * (sign * at);
                                const double zq = camera.axial(q), seen = -glm::dot(m, q - camera.eye()) / zq, held = std::fmax(seen, 0.02);
                                const double z = zq * held / std::fmax(held - seen - glm::dot(m, ray), 0.25 * held);
                                end = camera.eye() + ray * z - p;
                                const double angle = angleOf(end, s, sign);
                                if (angle > last || least == HUGE_VAL) farthest = end + ray * (z * thick);
                                last = std::fmax(last, angle);
                                least = std::fmin(least, angle);
                            } else {
                                const double facing = glm::dot(m, v), rise = glm::dot(d, v) + (glm::dot(m, d - v * glm::dot(d, v)) - at * sign * glm::dot(m, line)) / std::fmax(facing, 0.02);
                                end = v * rise + line * (sign * at);
                                const double angle = angleOf(end, s, sign);
                                if (angle > last || least == HUGE_VAL) farthest = end - v * thick;
                                last = std::fmax(last, angle);
                                least = std::fmin(least, angle);
                            }
                        }
                        const double gamma = sign * s.gamma, horizon = kHalfPi + gamma;
                        const double front = std::fmin(least, horizon), back = std::fmax(front, std::fmin(angleOf(farthest, s, sign), horizon));
                        const auto border = [&](double angle) {
                            const double sectors = kSectors * (s.before + sign * measureTo(angle, gamma, uniform)) / s.total;
                            return int(std::floor(std::fmin(std::fmax(sectors + rounding, 0.0), kSectors)));
                        };
                        const int lo = std::min(border(front), border(back)), hi = std::max(border(front), border(back));
                        for (int b = lo; b < hi; ++b) {
                            const std::size_t at = std::size_t(b);
                            near[at] = near[at] || glm::length(d) < radius;
                            if (light && !covered[at] && glm::dot(d, m) < 0.0) {
                                const glm::dvec3 l = level.get(tx, ty, 6);
                                for (int a = 0; a < 3; ++a) found[std::size_t(a)] += l[a] / kSectors;
                                found[3] += 1.0 / kSectors;
                            }
                            covered[at] = true;
                        }
                    }
                // Steps of equal angle in the image, turned into angles about V.
                const glm::dvec3 across = line - v * glm::dot(line, v);
                double weight = double(slice.share) * std::fabs(glm::dot(glm::cross(perI, perJ), v)) / glm::dot(across, across);
                if (!uniform) weight *= s.projected * s.total;
                for (std::size_t a = 0; a < 4; ++a) sum[a] += weight * found[a];
                for (const bool b : near) sum[4] += weight * (b ? 0.0 : 1.0 / kSectors);
                sum[5] += weight;
            }
            const std::size_t i = std::size_t(y) * base.width + std::size_t(x);
            for (std::size_t a = light ? 0 : 4; a < 6; ++a) out[(a - (4 - open)) * plane + i] = float(sum[a]);
        }
    return out;
}

}  // namespace lightwell::reference
