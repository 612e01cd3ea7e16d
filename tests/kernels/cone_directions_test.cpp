// Sets of cones: what a cone's mean light makes of light that is known, and where its samples lie.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "passes/cone_directions.h"
#include "passes/cone_rays.h"

using namespace lightwell;

namespace {

constexpr double kPi = 3.14159265358979323846;
using Direction = std::array<double, 3>;

// The mean of f over a cone's directions, evenly.
double meanOver(const ConeDirection& cone, const std::function<double(const Direction&)>& f) {
    const Direction& w = cone.d;
    Direction u = std::abs(w[0]) < 0.9 ? Direction{1, 0, 0} : Direction{0, 1, 0};
    const double along = u[0] * w[0] + u[1] * w[1] + u[2] * w[2];
    double length = 0;
    for (std::size_t a = 0; a < 3; ++a) u[a] -= along * w[a], length += u[a] * u[a];
    for (double& x : u) x /= std::sqrt(length);
    const Direction v{w[1] * u[2] - w[2] * u[1], w[2] * u[0] - w[0] * u[2], w[0] * u[1] - w[1] * u[0]};
    constexpr int kRings = 40, kTurns = 80;
    double sum = 0;
    for (int i = 0; i < kRings; ++i)
        for (int j = 0; j < kTurns; ++j) {
            const double z = 1 - (i + 0.5) / kRings * (1 - std::cos(cone.halfAngle)),
                         r = std::sqrt(1 - z * z);
            const double turn = 2 * kPi * (j + 0.5) / kTurns;
            Direction d;
            for (std::size_t a = 0; a < 3; ++a)
                d[a] = z * w[a] + r * (std::cos(turn) * u[a] + std::sin(turn) * v[a]);
            sum += f(d);
        }
    return sum / (kRings * kTurns);
}

// Irradiance over pi, by the cones.
double gathered(std::uint32_t count, const std::function<double(const Direction&)>& f) {
    double sum = 0;
    for (const ConeDirection& cone : coneHemisphere(count)) sum += cone.weight * meanOver(cone, f);
    return sum;
}

// An infinite wall up to 45 degrees that stands towards `turn`, over the exact value.
double wallError(std::uint32_t count, double turn) {
    const double c = std::cos(turn), s = std::sin(turn);
    return gathered(count, [=](const Direction& d) { return d[0] * c + d[1] * s > d[2] ? 1.0 : 0.0; }) /
               ((1 - std::sqrt(0.5)) / 2) -
           1;
}

}  // namespace

TEST_CASE("sets of cones share out the hemisphere", "[cone_directions]") {
    const std::uint32_t count = GENERATE(6u, 9u, 16u, 64u, 256u);
    double weights = 0, solid = 0;
    const auto set = coneHemisphere(count);
    REQUIRE(set.size() == count);
    for (const ConeDirection& cone : set) {
        weights += cone.weight;
        solid += 2 * kPi * (1 - std::cos(cone.halfAngle));
        CHECK(std::hypot(cone.d[0], cone.d[1], cone.d[2]) == Approx(1.0));
        // No cone's axis nearer to the surface than half its aperture.
        CHECK(std::asin(cone.d[2]) > cone.halfAngle - 0.02);
    }
    CHECK(weights == Approx(1.0));
    // Narrow cones are their cells' solid angles; wide ones overlap and leave gaps.
    if (count >= 16) CHECK(solid == Approx(2 * kPi).epsilon(1e-9));
    const ConeWindow window = coneWindow(count);
    CHECK(window.columns * window.rows * window.perPixel == count);
}

TEST_CASE("cones of the sphere have its first bands", "[cone_directions]") {
    const std::uint32_t count = GENERATE(6u, 9u, 16u, 64u, 256u);
    double sum[3][3] = {}, mean[3] = {}, weights = 0;
    for (const ConeDirection& cone : coneSphere(count)) {
        weights += cone.weight;
        for (std::size_t a = 0; a < 3; ++a) {
            mean[a] += cone.weight * cone.d[a];
            for (std::size_t b = 0; b < 3; ++b) sum[a][b] += cone.weight * cone.d[a] * cone.d[b];
        }
    }
    CHECK(weights == Approx(1.0));
    for (std::size_t a = 0; a < 3; ++a) {
        CHECK(mean[a] == Approx(0.0).margin(1e-9));
        // Exact for an icosahedron; cells' middles have the z of their middles.
        for (std::size_t b = 0; b < 3; ++b)
            CHECK(sum[a][b] == Approx(a == b ? 1.0 / 3.0 : 0.0).margin(count <= 9 ? 1e-9 : 0.03));
    }
}

TEST_CASE("cone averages against the integral", "[cone_directions]") {
    const auto cosine = [](const Direction& d) { return d[2]; };
    const auto rest = [](const Direction& d) { return 1 - d[2]; };
    // methods of the source, to its digits.
    CHECK(gathered(9, cosine) / (2.0 / 3.0) - 1 == Approx(-0.012).margin(0.001));
    CHECK(gathered(9, rest) / (1.0 / 3.0) - 1 == Approx(0.024).margin(0.001));
    CHECK(gathered(6, cosine) / (2.0 / 3.0) - 1 == Approx(-0.125).margin(0.001));
    CHECK(gathered(6, rest) / (1.0 / 3.0) - 1 == Approx(0.25).margin(0.003));
    // A wall square to the first tangent; the set's turn about the normal matters: up to 7 % of nine.
    CHECK(wallError(9, 0.0) == Approx(0.04).margin(0.005));
    CHECK(wallError(6, 0.0) == Approx(0.45).margin(0.005));
    for (int k = 1; k < 8; ++k) {
        CHECK(wallError(9, 0.1 * k) > 0.025);
        CHECK(wallError(9, 0.1 * k) < 0.08);
    }
    // Narrow ones on the way to the integral.
    CHECK(gathered(16, cosine) / (2.0 / 3.0) - 1 == Approx(0.0).margin(0.02));
    CHECK(gathered(64, cosine) / (2.0 / 3.0) - 1 == Approx(0.0).margin(0.005));
    CHECK(gathered(256, cosine) / (2.0 / 3.0) - 1 == Approx(0.0).margin(0.002));
    CHECK(wallError(256, 0.0) == Approx(0.0).margin(0.02));
}

TEST_CASE("nine cones have the weights of their cosines", "[cone_directions]") {
    const auto set = coneHemisphere(9);
    CHECK(kPi * set[0].weight == Approx(0.51184).margin(5e-6));
    for (std::size_t k = 1; k < 5; ++k) CHECK(kPi * set[k].weight == Approx(0.29551).margin(5e-6));
    for (std::size_t k = 5; k < 9; ++k) CHECK(kPi * set[k].weight == Approx(0.36193).margin(5e-6));
}

TEST_CASE("samples lie behind each other in cells of half the cone's width, whatever they are cut into",
          "[cone_directions]") {
    ConeSchedule schedule;
    schedule.nudge = 1.5;
    schedule.reach = 128.0;
    schedule.levels = 8;
    const double sixty = kPi / 6;
    const auto whole = coneSteps(sixty, 1.0, schedule);
    REQUIRE(whole.size() == 7);
    for (std::size_t i = 0; i < whole.size(); ++i) {
        CHECK(double(whole[i].distance) == Approx(std::ldexp(1.5, int(i))));
        CHECK(whole[i].level == lw_int(i));
        CHECK(whole[i].exponent == 1.0f);
    }
    const double halfAngle = GENERATE(0.01, 0.1, 0.2, 0.3, 0.5235987755982988, 0.7);
    schedule.nudge = 2.0;
    for (int k = 0; k < 3; ++k) {
        schedule.step = std::ldexp(1.0, -k);
        // What each level has of the way adds up to the same: from twice its first distance on to twice
        // that.
        std::array<double, 8> lengths{};
        const auto steps = coneSteps(halfAngle, 1.0, schedule);
        CHECK(double(steps[0].distance) == Approx(2.0).margin(0.5 * schedule.step));
        double end = 2.0 - 0.5 * std::ldexp(schedule.step, int(steps[0].level));
        for (const LwConeStep& step : steps) {
            const double cell = std::ldexp(1.0, int(step.level)), length = double(step.exponent) * cell;
            // Each in the middle of its part, which begins where the last one ends.
            CHECK(double(step.distance) == Approx(end + 0.5 * length).epsilon(1e-5));
            end += length;
            lengths[std::size_t(step.level)] += length;
            CHECK(length <= 1.5 * schedule.step * cell);
            const double width = 2 * std::tan(halfAngle) * double(step.distance);
            if (step.level > 0)
                CHECK(cell > 0.29 * width);  // 1 / 4 t where there is one cell, least for the widest
            CHECK(cell < std::max(1.001, 1.1 * width));
        }
        const double first = std::max(1.0, std::round(std::tan(sixty) / std::tan(halfAngle)));
        for (int level = int(steps[0].level) + 1; level < int(steps.back().level); ++level)
            CHECK(lengths[std::size_t(level)] == Approx(std::ldexp(first, level)).epsilon(1e-5));
    }
}

TEST_CASE("offset by aperture keeps a cone's first sphere off the surface", "[cone_directions]") {
    ConeSchedule schedule;
    schedule.reach = 100.0;
    schedule.levels = 8;
    schedule.apertureOffset = true;
    const double cosine = std::sqrt(0.5);
    const double begin = double(coneSteps(kPi / 6, cosine, schedule)[0].distance);
    // At most half of a cell of 4 voxels off.
    CHECK(begin == Approx(1.0 / (cosine - std::sin(kPi / 6))).margin(2.0));
    schedule.near = true;
    schedule.nudge = 4.0;
    schedule.apertureOffset = false;
    const auto steps = coneSteps(kPi / 6, cosine, schedule);
    CHECK(double(steps[0].distance) == Approx(1.5 / cosine));
    double nearest = 0;
    for (const LwConeStep& step : steps)
        if (step.light == 0.0f) nearest += std::ldexp(double(step.exponent), int(step.level));
    CHECK(nearest == Approx(2.5 / cosine));  // voxels between there and where light counts
}

TEST_CASE("glossy cones open from one degree to eighty", "[cone_directions]") {
    CHECK(coneAperture(0) == Approx(0.5 * kPi / 180));
    CHECK(coneAperture(LW_CONE_APERTURES - 1) == Approx(40 * kPi / 180));
}
