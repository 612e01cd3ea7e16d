#include "passes/cone_directions.h"

#include <algorithm>
#include <cmath>

#include "inputs/camera.h"

namespace lightwell {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kWide = kPi / 6.0;

// Height above the surface, in voxels of the finest level, from which a sample has nothing of a flat
// surface's own voxels: they reach up to one voxel above it, and half a voxel more where interpolated.
constexpr double kNearHeight = 1.5;
// How nearly a cone may touch its own surface before apertureOffset moves it no further: of the six,
// five touch it.
constexpr double kLeastGap = 0.1;
// Half a cone's width over its distance at which one cell lies between a distance and twice that, so
// that cells are 0.87 to 0.43 of the cone's width. Interpolated cells weigh places by their distance
// with a deviation of half a side, a disc by a quarter of its diameter: a cell as wide as the cone sees
// what is half a cone beside it, the wall that the cone begins at and the next, and as coarse as it is
// closed where only a part is. Smaller than half, and what the cone meets between samples is missed.
constexpr double kCells = 0.57735026918962576;

void addWide(std::vector<ConeDirection>& set, double x, double y, double z) {
    const double length = std::sqrt(x * x + y * y + z * z);
    set.push_back({{x / length, y / length, z / length}, z / length, kWide});
}

// The square [-1, 1]^2 to the unit disc, areas to areas in proportion (Shirley and Chiu 1997).
std::array<double, 2> onDisc(double u, double v) {
    if (u == 0.0 && v == 0.0) return {0.0, 0.0};
    if (std::abs(u) > std::abs(v))
        return {u * std::cos(kPi / 4.0 * v / u), u * std::sin(kPi / 4.0 * v / u)};
    return {v * std::cos(kPi / 2.0 - kPi / 4.0 * u / v), v * std::sin(kPi / 2.0 - kPi / 4.0 * u / v)};
}

// Half the aperture of a cone of this solid angle.
double angleOf(double solid) {
    return std::acos(std::max(0.0, 1.0 - solid / (2.0 * kPi)));
}

// A cell of the square holds 1 / n^2 of the cosine. Its solid angle is the integral of 1 / cos over its
// part of the disc; where |u| > |v|, r = |u| and dphi = pi/4 dv / |u|, so that of |u| from a to b and
// |v| as far it is pi/4 (b - a) (asin b - asin a). A cell on the diagonal has twice what lies on one
// side of it.
double solidAngle(std::uint32_t i, std::uint32_t j, std::uint32_t n) {
    const double cell = 2.0 / n, u = std::abs((i + 0.5) * cell - 1.0) - 0.5 * cell,
                 v = std::abs((j + 0.5) * cell - 1.0) - 0.5 * cell;
    const double low = std::max(u, v), high = std::min(1.0, low + cell),
                 turned = std::asin(high) - std::asin(low);
    if (std::abs(u - v) > 0.5 * cell) return kPi / 4.0 * cell * turned;
    return kPi / 2.0 * (std::sqrt(1.0 - low * low) - std::sqrt(1.0 - high * high) - low * turned);
}

// The mean of a cell's directions by their cosines: with the cell's middle instead, 16 cones bring 7 %
// too much of light from straight above.
std::array<double, 3> meanDirection(std::uint32_t i, std::uint32_t j, std::uint32_t n) {
    constexpr std::uint32_t kParts = 32;
    std::array<double, 3> sum{0.0, 0.0, 0.0};
    for (std::uint32_t b = 0; b < kParts; ++b)
        for (std::uint32_t a = 0; a < kParts; ++a) {
            const auto p = onDisc(2.0 * (i + (a + 0.5) / kParts) / n - 1.0,
                                  2.0 * (j + (b + 0.5) / kParts) / n - 1.0);
            sum[0] += p[0];
            sum[1] += p[1];
            sum[2] += std::sqrt(1.0 - p[0] * p[0] - p[1] * p[1]);
        }
    const double length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    return {sum[0] / length, sum[1] / length, sum[2] / length};
}

std::uint32_t sideOf(std::uint32_t count) {
    return std::uint32_t(std::lround(std::sqrt(double(count))));
}

}  // namespace

std::vector<ConeDirection> coneHemisphere(std::uint32_t count) {
    std::vector<ConeDirection> set;
    if (count == 6) {
        set.push_back({{0.0, 0.0, 1.0}, 0.25, kWide});
        for (int k = 0; k < 5; ++k) {
            const double turn = 2.0 * kPi * k / 5.0, sine = std::sin(kPi / 3.0);
            set.push_back({{sine * std::cos(turn), sine * std::sin(turn), 0.5}, 0.15, kWide});
        }
        return set;
    }
    if (count == 9) {
        addWide(set, 0, 0, 1);
        for (int k = 0; k < 4; ++k) addWide(set, k & 1 ? 1 : -1, k & 2 ? 1 : -1, 1);
        for (int k = 0; k < 4; ++k)
            addWide(set, k == 0 ? 1 : k == 1 ? -1 : 0, k == 2 ? 1 : k == 3 ? -1 : 0, 1);
        double sum = 0.0;
        for (const ConeDirection& cone : set) sum += cone.weight;
        for (ConeDirection& cone : set) cone.weight /= sum;
        return set;
    }
    const std::uint32_t n = sideOf(count);
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i)
            set.push_back({meanDirection(i, j, n), 1.0 / count, angleOf(solidAngle(i, j, n))});
    return set;
}

std::vector<ConeDirection> coneSphere(std::uint32_t count) {
    std::vector<ConeDirection> set;
    if (count <= 9) {
        // The corners of an icosahedron: means of five bands of harmonics are exact (Delsarte, Goethals
        // and Seidel 1977).
        const double golden = (1.0 + std::sqrt(5.0)) / 2.0, length = std::sqrt(1.0 + golden * golden);
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (int k = 0; k < 4; ++k) {
                ConeDirection cone{{0.0, 0.0, 0.0}, 1.0 / 12.0, angleOf(4.0 * kPi / 12.0)};
                cone.d[axis] = (k & 1 ? 1.0 : -1.0) / length;
                cone.d[(axis + 1) % 3] = (k & 2 ? golden : -golden) / length;
                set.push_back(cone);
            }
        return set;
    }
    // Twice the disc, z = 1 - r^2 on either half: cells of the same solid angle.
    const std::uint32_t n = sideOf(count);
    for (int half = 0; half < 2; ++half)
        for (std::uint32_t j = 0; j < n; ++j)
            for (std::uint32_t i = 0; i < n; ++i) {
                const auto p = onDisc(2.0 * (i + 0.5) / n - 1.0, 2.0 * (j + 0.5) / n - 1.0);
                const double r2 = p[0] * p[0] + p[1] * p[1], z = 1.0 - r2, wide = std::sqrt(2.0 - r2);
                set.push_back({{p[0] * wide, p[1] * wide, half ? -z : z},
                               0.5 / count,
                               angleOf(2.0 * kPi / count)});
            }
    return set;
}

ConeWindow coneWindow(std::uint32_t count) {
    if (count == 6) return {2, 3, 1};
    if (count == 9) return {3, 3, 1};
    if (count == 16) return {4, 4, 1};
    return {8, 8, count / 64};
}

// Samples lie one behind the other without gaps, each in a cell of 2^level voxels as long as the part of
// the cone that it stands for: from `cells` of them off the apex to twice as far, then in cells of twice
// the side. Interpolated, cells reach one side to either side, so that what samples take of a thin wall
// adds up to all of it, and to no more.
std::vector<LwConeStep> coneSteps(double halfAngle, double cosine, const ConeSchedule& schedule) {
    const double tangent = std::tan(halfAngle);
    const double height =
        schedule.apertureOffset ? std::max(cosine - std::sin(halfAngle), kLeastGap) : cosine;
    const double begin = schedule.nudge / height;
    const double cells = std::max(1.0, std::round(kCells / tangent));
    const auto levelOf = [&](double d) {
        return d < 2.0 * cells ? 0 : int(std::floor(std::log2(d / cells)));
    };
    std::vector<LwConeStep> steps;
    const auto add = [&](double d, int level, double length, double light) {
        LwConeStep step{};
        step.distance = lw_float(d);
        step.exponent = schedule.corrected ? lw_float(std::ldexp(length, -level)) : 1.0f;
        step.light = lw_float(light);
        // 1 / (1 + lambda d), lambda so that a fifth is left at the reach.
        step.dimming =
            d <= schedule.openReach ? lw_float(1.0 / (1.0 + 4.0 * d / schedule.openReach)) : 0.0f;
        step.level = lw_int(std::min(level, int(schedule.levels) - 1));
        // Not before the last one's, where the level rises faster than the distance: a cone that has left does not come back.
        step.begins = lw_float(d - 0.5 * std::exp2(double(step.level)));
        if (!steps.empty()) step.begins = std::max(step.begins, steps.back().begins);
        steps.push_back(step);
    };
    if (schedule.near) {
        const double from = kNearHeight / cosine, length = begin - from;
        const auto parts =
            length > 0.0 ? std::size_t(std::ceil(length / std::min(1.0, schedule.step))) : 0;
        for (std::size_t i = 0; i < parts; ++i) {
            const double d = from + length * double(i) / double(parts);
            add(d, levelOf(d), length / double(parts), 0.0);
        }
    }
    int level = levelOf(begin);
    for (double from = std::max(0.0, begin - 0.5 * std::ldexp(schedule.step, level)), end;
         from < schedule.reach; from = end, ++level) {
        end = std::ldexp(2.0 * cells, level);
        const double parts = std::max(1.0, std::round(std::ldexp((end - from) / schedule.step, -level)));
        for (double i = 0.5; i < parts; ++i)
            add(from + (end - from) * i / parts, level, (end - from) / parts, 1.0);
    }
    return steps;
}

void ConeTable::add(const ConeDirection& direction, double cosine, const ConeSchedule& schedule) {
    const auto same = [&](const Known& k) {
        return std::abs(k.halfAngle - direction.halfAngle) < 1e-9 && std::abs(k.cosine - cosine) < 1e-9;
    };
    auto found = std::find_if(known_.begin(), known_.end(), same);
    if (found == known_.end()) {
        const std::vector<LwConeStep> more = coneSteps(direction.halfAngle, cosine, schedule);
        known_.push_back({direction.halfAngle, cosine, lw_int(steps.size()), lw_int(more.size())});
        steps.insert(steps.end(), more.begin(), more.end());
        found = known_.end() - 1;
    }
    LwCone cone{};
    cone.direction = float4(direction.d[0], direction.d[1], direction.d[2], direction.weight);
    cone.first = found->first;
    cone.count = found->count;
    cones.push_back(cone);
}

}  // namespace lightwell
