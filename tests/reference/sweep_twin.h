// Discrete ordinates through a cube of cells in double, light by light and direction by direction, with each surface's own normal.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace lightwell::reference {

struct SweepTwin {
    struct Patch {
        std::array<int, 3> cell;
        std::array<double, 3> normal;
        double amount;  // flux, or area
    };
    int n;
    std::vector<Patch> lights, blockers;
    std::vector<double> arrived[6];  // at sides that face +x, -x, +y, -y, +z, -z

    explicit SweepTwin(int size) : n(size) {
        for (auto& side : arrived) side.resize(std::size_t(n) * std::size_t(n) * std::size_t(n));
    }
    std::size_t index(const std::array<int, 3>& c) const { return std::size_t((c[2] * n + c[1]) * n + c[0]); }

    // Cells of side 1.
    void sweep(const std::array<double, 3>& d, double weight) {
        std::size_t a = 0;
        for (std::size_t i = 1; i < 3; ++i)
            if (std::abs(d[i]) > std::abs(d[a])) a = i;
        const std::size_t b = (a + 1) % 3, c = (a + 2) % 3, cells = arrived[0].size();
        std::vector<double> sends(cells), covers(cells), stops(cells), leaving(cells);
        for (const Patch& p : lights)
            sends[index(p.cell)] += p.amount / 3.14159265358979323846 * std::max(0.0, cosine(p.normal, d)) / std::abs(d[a]);
        for (const Patch& p : blockers) {
            stops[index(p.cell)] += p.amount * std::abs(cosine(p.normal, d)) / std::abs(d[a]);
            covers[index(p.cell)] += p.amount * std::max({std::abs(p.normal[0]), std::abs(p.normal[1]), std::abs(p.normal[2])});
        }
        for (int k = 0; k < n; ++k)
            for (int j = 0; j < n; ++j)
                for (int i = 0; i < n; ++i) {
                    std::array<int, 3> at{};
                    at[a] = d[a] > 0 ? k : n - 1 - k;
                    at[b] = j;
                    at[c] = i;
                    const double light = before(leaving, at, d, a, b, c);
                    const std::size_t here = index(at);
                    for (std::size_t side = 0; side < 3; ++side)
                        arrived[2 * side + (d[side] > 0 ? 1 : 0)][here] += weight * light * std::abs(d[side]);
                    const double open = std::max(0.0, 1.0 - covers[here]);
                    const double through = stops[here] > 0 ? open / (open + stops[here]) : 1.0;
                    leaving[here] = light * through + sends[here];
                }
    }

private:
    static double cosine(const std::array<double, 3>& x, const std::array<double, 3>& y) {
        return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
    }
    // Bilinear in the plane before, from where the direction comes.
    double before(const std::vector<double>& leaving, std::array<int, 3> at, const std::array<double, 3>& d, std::size_t a,
                  std::size_t b, std::size_t c) const {
        at[a] -= d[a] > 0 ? 1 : -1;
        if (at[a] < 0 || at[a] >= n) return 0.0;
        const double fromB = at[b] - d[b] / std::abs(d[a]), fromC = at[c] - d[c] / std::abs(d[a]);
        const int b0 = int(std::floor(fromB)), c0 = int(std::floor(fromC));
        double sum = 0.0;
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j) {
                at[b] = b0 + i;
                at[c] = c0 + j;
                if (at[b] < 0 || at[b] >= n || at[c] < 0 || at[c] >= n) continue;
                const double share = (i ? fromB - b0 : 1.0 - fromB + b0) * (j ? fromC - c0 : 1.0 - fromC + c0);
                sum += share * leaving[index(at)];
            }
        return sum;
    }
};

}  // namespace lightwell::reference
