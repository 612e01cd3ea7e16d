#include "passes/sweep_directions.h"

#include <algorithm>
#include <cmath>

#include "shared/lpv_sweep_types.h"

namespace lightwell {
namespace {

constexpr double kPi = 3.14159265358979323846;

int dominantAxis(const std::array<double, 3>& d) {
    int axis = 0;
    for (int a = 1; a < 3; ++a)
        if (std::abs(d[std::size_t(a)]) > std::abs(d[std::size_t(axis)])) axis = a;
    return axis;
}

int groupOf(const SweepDirection& direction) {
    const auto& d = direction.d;
    return 8 * dominantAxis(d) + (d[0] > 0 ? 1 : 0) + (d[1] > 0 ? 2 : 0) + (d[2] > 0 ? 4 : 0);
}

// The triples make the mean of |d.axis| over the set a half, as it is over the sphere.
void addPermutations(std::vector<SweepDirection>& set, std::array<double, 3> triple, std::uint32_t count) {
    double squared = 0.0;
    for (const double t : triple) squared += t * t;
    for (double& t : triple) t /= std::sqrt(squared);
    std::sort(triple.begin(), triple.end());
    do
        for (int signs = 0; signs < 8; ++signs) {
            SweepDirection direction{triple, 4.0 * kPi / count};
            for (int a = 0; a < 3; ++a)
                if (signs >> a & 1) direction.d[std::size_t(a)] = -direction.d[std::size_t(a)];
            set.push_back(direction);
        }
    while (std::next_permutation(triple.begin(), triple.end()));
}

// Of the rectangle from (0, 0) to (u, v) at distance 1.
double solidAngle(double u, double v) { return std::atan(u * v / std::sqrt(1.0 + u * u + v * v)); }

void addCube(std::vector<SweepDirection>& set, std::uint32_t n) {
    const auto edge = [n](double i) { return std::tan(kPi / 4.0 * (2.0 * i / n - 1.0)); };
    for (int face = 0; face < 6; ++face)
        for (std::uint32_t j = 0; j < n; ++j)
            for (std::uint32_t i = 0; i < n; ++i) {
                const double u = edge(i + 0.5), v = edge(j + 0.5), length = std::sqrt(1.0 + u * u + v * v);
                const double u0 = edge(i), u1 = edge(i + 1.0), v0 = edge(j), v1 = edge(j + 1.0);
                SweepDirection direction{};
                const auto axis = std::size_t(face / 2);
                direction.d[axis] = (face % 2 ? -1.0 : 1.0) / length;
                direction.d[(axis + 1) % 3] = u / length;
                direction.d[(axis + 2) % 3] = v / length;
                direction.weight = solidAngle(u1, v1) - solidAngle(u0, v1) - solidAngle(u1, v0) + solidAngle(u0, v0);
                set.push_back(direction);
            }
}

// The normal of a number, see lpv_sweep_types.h.
std::array<double, 3> normalOf(int bin) {
    const int code = bin < 13 ? bin : bin + 1;
    std::array<double, 3> n = {code % 3 - 1.0, code / 3 % 3 - 1.0, code / 9 - 1.0};
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (double& x : n) x /= length;
    return n;
}

}  // namespace

std::vector<SweepDirection> sweepDirections(std::uint32_t count) {
    std::vector<SweepDirection> set;
    if (count == 24)
        addPermutations(set, {0.5 - std::sqrt(6.0) / 12.0, 0.5 - std::sqrt(6.0) / 12.0, 0.5 + std::sqrt(6.0) / 6.0}, count);
    else if (count == 48)
        addPermutations(set, {0.15069, 0.49166, 0.85765}, count);
    else
        addCube(set, std::uint32_t(std::lround(std::sqrt(count / 6.0))));
    std::stable_sort(set.begin(), set.end(),
                     [](const SweepDirection& a, const SweepDirection& b) { return groupOf(a) < groupOf(b); });
    return set;
}

std::vector<float> sweepTable(const std::vector<SweepDirection>& directions) {
    std::vector<float> table(directions.size() * LW_SWEEP_DIRECTION);
    for (std::size_t i = 0; i < directions.size(); ++i) {
        float* to = table.data() + i * LW_SWEEP_DIRECTION;
        const auto& d = directions[i].d;
        const int axis = dominantAxis(d);
        const double along = std::abs(d[std::size_t(axis)]);
        const double lane = std::abs(d[axis == 0 ? 1 : 0]) / along, row = std::abs(d[axis == 2 ? 1 : 2]) / along;
        to[LW_SWEEP_SHARES + 1] = float(lane * (1.0 - row));
        to[LW_SWEEP_SHARES + 2] = float((1.0 - lane) * row);
        to[LW_SWEEP_SHARES + 3] = float(lane * row);
        to[LW_SWEEP_SHARES] = 1.0f - to[LW_SWEEP_SHARES + 1] - to[LW_SWEEP_SHARES + 2] - to[LW_SWEEP_SHARES + 3];
        for (std::size_t a = 0; a < 3; ++a) to[LW_SWEEP_WEIGHTS + a] = float(directions[i].weight * std::abs(d[a]));
        for (int k = 0; k < LW_SWEEP_NORMALS; ++k) {
            const auto n = normalOf(k);
            const double cosine = n[0] * d[0] + n[1] * d[1] + n[2] * d[2];
            to[LW_SWEEP_SEND + k] = float(std::max(cosine, 0.0) / (kPi * along));
            if (k < LW_SWEEP_SHEETS) to[LW_SWEEP_STOP + k] = float(std::abs(cosine) / along);
        }
    }
    return table;
}

}  // namespace lightwell
