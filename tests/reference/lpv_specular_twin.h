// Specular rays through the cells of a light propagation volume in double precision, cell by cell as lpv_specular_types.h has them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "reference/surfaces.h"

namespace lightwell::reference {

struct SpecularTwin {
    int size, levels;
    bool hasFaces;
    std::array<double, 3> environment;
    std::vector<float> cells;  // 16 floats each, all levels

    int sideOf(int level) const { return size >> level; }
    std::size_t firstOf(int level) const {
        std::size_t first = 0;
        for (int l = 0; l < level; ++l) first += std::size_t(sideOf(l)) * std::size_t(sideOf(l)) * std::size_t(sideOf(l));
        return first;
    }
    const float* cell(int level, const std::array<int, 3>& i) const {
        const std::size_t n = std::size_t(sideOf(level));
        return &cells[16 * (firstOf(level) + (std::size_t(i[2]) * n + std::size_t(i[1])) * n + std::size_t(i[0]))];
    }
    double closed(int level, const std::array<int, 3>& i, int axis) const { return double(cell(level, i)[4 * axis + 3]); }

    // What gets from a cell into the one beside it along an axis; each on its level.
    double passes(int levelFrom, const std::array<int, 3>& from, int levelTo, const std::array<int, 3>& to, int axis, bool up) const {
        if (!hasFaces || up) return 1 - closed(levelTo, to, axis);
        return (levelFrom > 0 ? 1 : 1 - closed(levelFrom, from, axis)) * (levelTo > 0 ? 1 - closed(levelTo, to, axis) : 1);
    }

    // What the cells between `low` and the next, all in one plane across axis A, send against d.
    std::array<double, 3> sentAgainst(int level, const std::array<int, 3>& low, const std::array<double, 3>& share, std::size_t A,
                                      const std::array<double, 3>& d) const {
        double mean[16] = {};
        for (int k = 0; k < 8; ++k) {
            double weight = 1;
            std::array<int, 3> i = low;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const bool high = k >> axis & 1;
                weight *= high ? share[axis] : 1 - share[axis];
                i[axis] += high && axis != A ? 1 : 0;
            }
            for (int f = 0; f < 16; ++f) mean[f] += weight * double(cell(level, i)[f]);
        }
        std::array<double, 3> sent{};
        for (std::size_t c = 0; c < 3; ++c) {
            const double x = mean[4 + c], y = mean[8 + c], z = mean[12 + c];
            sent[c] = std::max(0.0, -(x * d[0] + y * d[1] + z * d[2])) + 0.25 * std::max(0.0, mean[c] - std::sqrt(x * x + y * y + z * z));
        }
        return sent;
    }

    std::array<double, 3> march(const std::array<double, 3>& at, const std::array<double, 3>& d, double tangent) const {
        const auto size_ = double(size);
        int a = 0;
        for (int i = 1; i < 3; ++i)
            if (std::abs(d[std::size_t(i)]) > std::abs(d[std::size_t(a)])) a = i;
        const std::size_t A = std::size_t(a);
        const double sign = d[A] > 0 ? 1 : -1, slope = 1 / std::abs(d[A]);
        const double start = sign > 0 ? at[A] : size_ - at[A];
        int level = 0, plane = std::min(std::max(int(start), 0), size - 1);
        std::array<int, 3> before{};
        for (std::size_t i = 0; i < 3; ++i) before[i] = std::min(std::max(int(at[i]), 0), size - 1);
        before[A] = sign > 0 ? plane : size - 1 - plane;
        int levelBefore = 0;
        bool moved = plane + 0.5 < start;
        if (moved) ++plane;
        std::array<double, 3> light{};
        double through = 1;
        for (; plane < sideOf(level); ++plane, moved = true) {
            while (level + 1 < levels && plane % 2 == 0 && tangent * (plane * double(1 << level) - start) * slope >= double(1 << level)) {
                if (plane > 0)
                    for (std::size_t i = 0; i < 3; ++i) {
                        if (i == A) continue;
                        std::array<int, 3> here = before;
                        for (int& x : here) x >>= level - levelBefore;
                        here[A] = sign > 0 ? plane - 1 : sideOf(level) - plane;
                        const bool isUp = d[i] > 0, down = d[i] < 0;
                        if ((here[i] % 2 == 1) != down) continue;
                        std::array<int, 3> beside = here;
                        beside[i] += down ? -1 : 1;
                        through *= passes(level, here, level, beside, int(i), isUp);
                    }
                ++level;
                plane /= 2;
            }
            const double scale = double(1 << level), distance = ((plane + 0.5) * scale - start) * slope;
            std::array<double, 3> p{};
            bool outside = false;
            for (std::size_t i = 0; i < 3; ++i) {
                p[i] = at[i] + d[i] * distance;
                outside = outside || (i != A && !(p[i] >= 0 && p[i] <= size_));
            }
            if (outside) break;
            const int n = sideOf(level), along = sign > 0 ? plane : n - 1 - plane;
            std::array<int, 3> low{}, own{};
            std::array<double, 3> share{};
            for (std::size_t i = 0; i < 3; ++i) {
                const double x = i == A ? double(along) : std::min(std::max(p[i] / scale - 0.5, 0.0), double(n - 1));
                low[i] = i == A ? along : std::min(int(x), n - 2);
                share[i] = i == A ? 0.0 : x - low[i];
                own[i] = low[i] + (share[i] >= 0.5 ? 1 : 0);
            }
            const std::array<double, 3> sent = sentAgainst(level, low, share, A, d);
            for (std::size_t c = 0; c < 3; ++c) light[c] += through * scale * slope * sent[c];
            std::array<int, 3> at_ = before;
            for (int& i : at_) i >>= level - levelBefore;
            if (moved) {
                at_[A] = along;
                through *= passes(levelBefore, before, level, at_, int(A), sign > 0);
            }
            for (std::size_t i = 0; i < 3; ++i) {
                if (i == A || own[i] == at_[i]) continue;
                std::array<int, 3> next = at_;
                next[i] = own[i];
                through *= passes(level, at_, level, next, int(i), own[i] > at_[i]);
                at_ = next;
            }
            if (through < 1e-3) return light;
            before = own;
            levelBefore = level;
        }
        for (std::size_t c = 0; c < 3; ++c) light[c] += through * environment[c];
        return light;
    }

    // n, v: unit, v . n > 0.
    std::array<double, 3> lobe(const std::array<double, 3>& at, Vec n, Vec v, double roughness) const {
        const double alpha = roughness * roughness, a2 = alpha * alpha, nv = dot(n, v), pi = 3.14159265358979323846;
        const auto of = [](Vec d) { return std::array<double, 3>{d.x, d.y, d.z}; };
        if (roughness <= 0.2) return march(at, of(n * (2 * nv) - v), 2 * alpha * std::sqrt(nv));
        const Vec t = unit(v - n * nv), b = {n.y * t.z - n.z * t.y, n.z * t.x - n.x * t.z, n.x * t.y - n.y * t.x};
        std::array<double, 3> sum{};
        double weights = 0;
        for (int i = 0; i < 8; ++i) {
            const double u = (i + 0.5) / 8, angle = 2 * pi * ((i & 1) / 2.0 + (i >> 1 & 1) / 4.0 + (i >> 2) / 8.0);
            const double theta = std::atan(alpha * std::sqrt(u / (1 - u)));
            const Vec h = t * (std::sin(theta) * std::cos(angle)) + b * (std::sin(theta) * std::sin(angle)) + n * std::cos(theta);
            const Vec l = h * (2 * dot(h, v)) - v;
            if (dot(l, n) <= 0 || dot(h, v) <= 0) continue;
            const double c2 = std::cos(theta) * std::cos(theta), density = a2 / (pi * std::pow(c2 * (a2 - 1) + 1, 2.0));
            const double pdf = density * std::cos(theta) / (4 * dot(h, v));
            const auto found = march(at, of(l), 0.5 * std::sqrt(1 / (8 * pdf) / pi));
            for (std::size_t c = 0; c < 3; ++c) sum[c] += dot(l, n) * found[c];
            weights += dot(l, n);
        }
        for (double& x : sum) x = weights > 0 ? x / weights : 0;
        return sum;
    }
};

}  // namespace lightwell::reference
