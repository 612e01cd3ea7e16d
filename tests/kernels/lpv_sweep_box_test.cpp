// The three boxes that sweeps are measured by, 64 units a side: the irradiance of the ceiling against Lambert's polygon formula, of
// the light's parts that a wall leaves in sight.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/lit_room.h"
#include "support/lpv_rig.h"
#include "support/sweep_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

constexpr double kBox = 64.0, kWall = 32.0;

struct Box {
    double lightX0, lightX1, lightY0, lightY1;  // of exitance 1 on the floor
    double wallHeight;                          // of a wall across the box at x = kWall, or 0
};

double litFrom(const Box& box, Vec p, double x0, double x1) {
    if (x0 >= x1) return 0.0;
    return polygonIrradiance({{x0, box.lightY0, 0}, {x1, box.lightY0, 0}, {x1, box.lightY1, 0}, {x0, box.lightY1, 0}}, p,
                             {0, 0, -1}, 1.0);
}

// A point of the ceiling sees of the light what is on its side of the wall, and beyond it what lies further off than the ray over
// the wall's upper edge meets the floor.
double truthAt(const Box& box, Vec p) {
    if (box.wallHeight <= 0.0) return litFrom(box, p, box.lightX0, box.lightX1);
    const double edge = p.x - (p.x - kWall) * p.z / (p.z - box.wallHeight);
    const double left = std::min(edge, kWall), right = std::max(edge, kWall);
    return litFrom(box, p, box.lightX0, std::min(box.lightX1, left)) + litFrom(box, p, std::max(box.lightX0, right), box.lightX1);
}

// Root of the sum of squares of E - truth over that of the truth.
double errorOf(SweepRig& rig, const Box& box) {
    std::vector<Vec> points;
    for (int j = 0; j < 64; ++j)
        for (int i = 0; i < 64; ++i) points.push_back({i + 0.5, j + 0.5, kBox});
    const std::vector<double> found = rig.read(points, {0, 0, -1});
    double difference = 0.0, truths = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double truth = truthAt(box, points[i]);
        difference += (found[i] - truth) * (found[i] - truth);
        truths += truth * truth;
    }
    return std::sqrt(difference / truths);
}

double sweepBox(const Box& box, std::uint32_t size, std::uint32_t directions) {
    LpvSweepOptions options;
    options.size = size;
    options.directions = directions;
    const double cell = kBox / size;
    SweepRig rig(16, options, cell);
    std::vector<lw_vpl> lights;
    std::vector<Disc> wall;
    addEmitter(lights, {box.lightX0, box.lightY0, 0}, {box.lightX1 - box.lightX0, 0, 0}, {0, box.lightY1 - box.lightY0, 0}, 0.5);
    if (box.wallHeight > 0) addDiscs(wall, {kWall, 0, 0}, {0, 0, box.wallHeight}, {0, kBox, 0}, 0.5);  // faces the light
    rig.sweep(lights, wall);
    return errorOf(rig, box);
}

}  // namespace

// The figures of a prototype in double are 0.03, 0.14, 0.12 for 16 cells a side, 0.03, 0.18, 0.09 for 32.
TEST_CASE("sweeps light the ceilings of three boxes as polygons do", "[lpv_sweep][large]") {
    const Box floor{0, 64, 0, 64, 0}, patch{28, 36, 28, 36, 0}, wall{8, 24, 24, 40, 16}, across{24, 40, 24, 40, 16};
    CHECK(sweepBox(floor, 16, 384) < 0.03);
    CHECK(sweepBox(patch, 16, 384) < 0.14);
    CHECK(sweepBox(wall, 16, 384) < 0.12);
    CHECK(sweepBox(floor, 32, 384) < 0.03);
    CHECK(sweepBox(patch, 32, 384) < 0.18);
    CHECK(sweepBox(wall, 32, 384) < 0.09);
    // A light on both sides of the wall: a quarter of it, or an eighth, is in the wall's own cells.
    CHECK(sweepBox(across, 16, 384) == Approx(0.20).margin(0.01));
    CHECK(sweepBox(across, 32, 384) == Approx(0.14).margin(0.01));
    // Few directions make beams of a small light.
    CHECK(sweepBox(patch, 32, 96) > 0.9);
}

// A floor of exitance 1 in 64^3 cells: what faces it from cell 8 should get 0.95, from the ceiling 0.25. Of 128 steps of
// propagation, twice as many as there are cells and calibrated for straight transport, a third arrives at the one, nothing at the other.
TEST_CASE("swept light arrives where propagated light does not", "[lpv_sweep][large]") {
    constexpr int kCells = 64;
    const double root = std::sqrt(3.14159265358979323846), kappa = 4.0 / 7.0;
    LpvCells cells(kCells);
    for (int y = 0; y < kCells; ++y)
        for (int x = 0; x < kCells; ++x) {
            cells.at(0, x, y, 0) = float(0.5 / root);
            cells.at(3, x, y, 0) = float(1.0 / (root * std::sqrt(3.0)));
        }
    KernelRig propagation(16);
    LpvPropagation steps(propagation.device(), kCells);
    const Guarded injected = propagation.upload(cells.laidOut());
    const Buffer& result = steps.record(propagation.executor(), injected, 128);
    propagation.device().finish();
    const LpvCells spread = LpvCells::of(result, kCells);
    // A surface that faces the floor from the centre of cell z, read half a cell off: between two cells.
    const auto facing = [&](int z) {
        double sum = 0.0;
        for (const int at : {z - 1, z})
            sum += 0.5 * kappa * (root / 2.0 * double(spread.at(0, 32, 32, at)) + root / std::sqrt(3.0) * double(spread.at(3, 32, 32, at)));
        return sum;
    };
    CHECK(facing(8) == Approx(0.36).margin(0.005));
    CHECK(facing(63) < 1e-3);

    LpvSweepOptions options;
    options.size = kCells;
    options.directions = 1536;  // 6 (size / 4)^2
    SweepRig rig(16, options);
    std::vector<lw_vpl> lights;
    addEmitter(lights, {0, 0, 0}, {kBox, 0, 0}, {0, kBox, 0}, 0.5);
    rig.sweep(lights, {});
    const Box floor{0, 64, 0, 64, 0};
    for (const double height : {8.5, 16.5, 32.5, 64.0}) {
        const Vec point{32.3, 32.3, height};
        CAPTURE(height);
        CHECK(rig.read({point}, {0, 0, -1})[0] == Approx(truthAt(floor, point)).epsilon(0.05));
    }
}
