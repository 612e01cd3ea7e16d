// Light propagation face by face in double precision, from the geometry of a cell alone: no matrix is taken from the kernels.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace lightwell::reference {

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

    // What one step makes of this, added to `to`.
    void stepInto(LpvTwin& to) const {
        for (int z = 0; z < nz; ++z)
            for (int y = 0; y < ny; ++y)
                for (int x = 0; x < nx; ++x)
                    for (int way = 0; way < 6; ++way) send(to, x, y, z, way / 2, way % 2 ? 1 : -1);
    }

private:
    // From a cell through the five far faces of its neighbour along `axis`.
    void send(LpvTwin& to, int x, int y, int z, int axis, int sign) const {
        const double front = frontAngle() / kPi, side = sideAngle() / kPi, root5 = std::sqrt(5.0);
        const int sizes[3] = {nx, ny, nz};
        int target[3] = {x, y, z};
        target[axis] += sign;
        for (int a = 0; a < 3; ++a) {
            if (sideways && a < 2) target[a] = (target[a] + sizes[a]) % sizes[a];
            if (target[a] < 0 || target[a] >= sizes[a]) return;
        }
        const std::array<double, 4>& from = cells[std::size_t((z * ny + y) * nx + x)];
        std::array<double, 4>& into = to.at(target[0], target[1], target[2]);
        double e[3] = {0, 0, 0};
        e[axis] = sign;
        addLobe(into, front * intensity(from, e[0], e[1], e[2]), e[0], e[1], e[2]);
        for (int other = 0; other < 3; ++other)
            for (int way = -1; way <= 1; way += 2) {
                if (other == axis) continue;
                double f[3] = {0, 0, 0}, d[3];
                f[other] = way;
                for (int a = 0; a < 3; ++a) d[a] = (2 * e[a] + f[a]) / root5;
                addLobe(into, side * intensity(from, d[0], d[1], d[2]), f[0], f[1], f[2]);
            }
    }
};

}  // namespace lightwell::reference
