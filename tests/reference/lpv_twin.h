// Light propagation face by face in double precision, from the geometry of a cell alone: no matrix is taken from the kernels.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace lightwell::reference {

// What blocks between the cells of a grid of n a side, in double: vectors at the (n + 1)^3 corners. Lengths are in cells.
struct LpvWalls {
    int n;
    std::vector<std::array<double, 4>> corners;
    explicit LpvWalls(int size) : n(size), corners(std::size_t(size + 1) * std::size_t(size + 1) * std::size_t(size + 1)) {}
    std::array<double, 4>& at(int x, int y, int z) { return corners[std::size_t((z * (n + 1) + y) * (n + 1) + x)]; }
    const std::array<double, 4>& at(int x, int y, int z) const { return corners[std::size_t((z * (n + 1) + y) * (n + 1) + x)]; }

    // A surfel at the corner that is nearest; false: none is.
    bool add(const double* place, const double* normal, double area) {
        int i[3];
        for (int a = 0; a < 3; ++a) {
            i[a] = int(std::floor(place[a] + 0.5));
            if (i[a] < 0 || i[a] > n) return false;
        }
        const double pi = 3.14159265358979323846;
        const double side = normal[0] + 1.8 * normal[1] + 3.4 * normal[2] < 0 ? -1.0 : 1.0;
        std::array<double, 4>& c = at(i[0], i[1], i[2]);
        c[0] += area * std::sqrt(pi) / 2.0;
        for (std::size_t a = 0; a < 3; ++a) c[a + 1] += area * std::sqrt(pi / 3.0) * side * normal[a];
        return true;
    }
    // What gets along d through the face between a cell and its lower neighbour along `axis`.
    double through(int axis, const int* cell, const double* d) const {
        double mean[4] = {};
        for (int k = 0; k < 4; ++k) {
            int i[3] = {cell[0], cell[1], cell[2]};
            i[(axis + 1) % 3] += k & 1;
            i[(axis + 2) % 3] += k >> 1;
            for (std::size_t b = 0; b < 4; ++b) mean[b] += at(i[0], i[1], i[2])[b] / 4.0;
        }
        const double pi = 3.14159265358979323846, even = mean[0] / (2.0 * std::sqrt(pi));
        const double odd = std::sqrt(3.0 / (4.0 * pi)) * (mean[1] * d[0] + mean[2] * d[1] + mean[3] * d[2]);
        const double blocked = std::max(even + odd, even - odd) / (0.25 + 1.0 / std::sqrt(5.0));
        return 1.0 - std::min(1.0, std::max(0.0, blocked));
    }
};

// One colour of a grid of nx * ny * nz cells: c0, c1.x, c1.y, c1.z of each.
struct LpvTwin {
    int nx = 0, ny = 0, nz = 0;
    bool sideways = false;  // x and y go round
    std::vector<std::array<double, 4>> cells;

    LpvTwin(int x, int y, int z, bool periodic = false)
        : nx(x), ny(y), nz(z), sideways(periodic), cells(std::size_t(x) * std::size_t(y) * std::size_t(z)) {}
    std::array<double, 4>& at(int x, int y, int z) { return cells[std::size_t((z * ny + y) * nx + x)]; }

    static constexpr double kPi = 3.14159265358979323846;
    static double intensity(const std::array<double, 4>& c, double x, double y, double z) {
        return c[0] / (2.0 * std::sqrt(kPi)) + std::sqrt(3.0 / (4.0 * kPi)) * (c[1] * x + c[2] * y + c[3] * z);
    }
    static void addLobe(std::array<double, 4>& c, double power, double x, double y, double z) {
        c[0] += power * std::sqrt(kPi) / 2.0;
        c[1] += power * std::sqrt(kPi / 3.0) * x;
        c[2] += power * std::sqrt(kPi / 3.0) * y;
        c[3] += power * std::sqrt(kPi / 3.0) * z;
    }
    // Solid angle of the rectangle a x b at distance d whose corner lies straight ahead.
    static double corner(double a, double b, double d) { return std::atan(a * b / (d * std::sqrt(a * a + b * b + d * d))); }
    static double frontAngle() { return 4.0 * corner(0.5, 0.5, 1.5); }
    // A side face: at distance 1/2, one unit wide, reaching from 1/2 to 3/2 along.
    static double sideAngle() { return 2.0 * (corner(0.5, 1.5, 0.5) - corner(0.5, 0.5, 0.5)); }

    // What one step makes of this, added to `to`. Returns what the walls have taken of the first coefficients' sum.
    double stepInto(LpvTwin& to, const LpvWalls* walls = nullptr) const {
        double taken = 0.0;
        for (int z = 0; z < nz; ++z)
            for (int y = 0; y < ny; ++y)
                for (int x = 0; x < nx; ++x)
                    for (int way = 0; way < 6; ++way) taken += send(to, x, y, z, way / 2, way % 2 ? 1 : -1, walls);
        return taken;
    }

private:
    // From a cell through the five far faces of its neighbour along `axis`.
    double send(LpvTwin& to, int x, int y, int z, int axis, int sign, const LpvWalls* walls) const {
        const double front = frontAngle() / kPi, side = sideAngle() / kPi, root5 = std::sqrt(5.0);
        const int sizes[3] = {nx, ny, nz};
        int target[3] = {x, y, z};
        target[axis] += sign;
        for (int a = 0; a < 3; ++a) {
            if (sideways && a < 2) target[a] = (target[a] + sizes[a]) % sizes[a];
            if (target[a] < 0 || target[a] >= sizes[a]) return 0.0;
        }
        const std::array<double, 4>& from = cells[std::size_t((z * ny + y) * nx + x)];
        std::array<double, 4>& into = to.at(target[0], target[1], target[2]);
        const int place[3] = {x, y, z};
        double e[3] = {0, 0, 0}, taken = 0.0;
        e[axis] = sign;
        const auto arrive = [&](double power, const double* d, const double* f) {
            const double share = walls ? walls->through(axis, sign > 0 ? target : place, d) : 1.0;
            addLobe(into, share * power, f[0], f[1], f[2]);
            taken += (1.0 - share) * power * std::sqrt(kPi) / 2.0;
        };
        arrive(front * intensity(from, e[0], e[1], e[2]), e, e);
        for (int other = 0; other < 3; ++other)
            for (int way = -1; way <= 1; way += 2) {
                if (other == axis) continue;
                double f[3] = {0, 0, 0}, d[3];
                f[other] = way;
                for (int a = 0; a < 3; ++a) d[a] = (2 * e[a] + f[a]) / root5;
                arrive(side * intensity(from, d[0], d[1], d[2]), d, f);
            }
        return taken;
    }
};

}  // namespace lightwell::reference
