// Steps of a light propagation volume with blockers: against faces one by one in double, flux that is accounted for, and how much
// gets through walls.
#include <catch2/catch.hpp>
#include <cmath>

#include "support/lpv_surfels.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::LpvTwin;
using reference::LpvWalls;

namespace {

constexpr double kConserved = 1e-5;

LpvCells propagated(LpvSurfelRig& rig, const LpvCells& cells, std::uint32_t steps, const LpvBlockers* blockers,
                    std::uint32_t units = 0) {
    LpvPropagation pass(rig.device(), std::uint32_t(cells.size), units);
    const Guarded injected = rig.upload(cells.laidOut());
    const Buffer& result = pass.record(rig.executor(), injected, steps, blockers);
    rig.device().finish();
    CHECK(pass.bytes() == LpvPropagation::estimateBytes(std::uint32_t(cells.size), steps));
    return LpvCells::of(result, cells.size);
}

LpvTwin colourOf(const LpvCells& cells, int colour) {
    const int n = cells.size;
    LpvTwin twin(n, n, n);
    for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x)
                for (int b = 0; b < 4; ++b) twin.at(x, y, z)[std::size_t(b)] = double(cells.at(4 * colour + b, x, y, z));
    return twin;
}

// The sum of what was injected and all that the steps make of it.
LpvTwin twinPropagated(LpvTwin now, int steps, const LpvWalls& walls) {
    LpvTwin sum = now;
    for (int i = 0; i < steps; ++i) {
        LpvTwin next(now.nx, now.ny, now.nz);
        now.stepInto(next, &walls);
        now = next;
        for (std::size_t c = 0; c < sum.cells.size(); ++c)
            for (std::size_t b = 0; b < 4; ++b) sum.cells[c][b] += now.cells[c][b];
    }
    return sum;
}

LpvCells twinPropagated(const LpvCells& cells, int steps, const LpvWalls& walls) {
    const int n = cells.size;
    LpvCells result(n);
    for (int colour = 0; colour < LW_LPV_COLOURS; ++colour) {
        LpvTwin sum = twinPropagated(colourOf(cells, colour), steps, walls);
        for (int z = 0; z < n; ++z)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x)
                    for (int b = 0; b < 4; ++b) result.at(4 * colour + b, x, y, z) = float(sum.at(x, y, z)[std::size_t(b)]);
    }
    return result;
}

void compareSteps(int steps) {
    const LpvCells cells = randomLight(16, 0);
    const std::vector<LpvSurfel> surfels = randomLpvSurfels(16, 1500, 1.5);
    LpvSurfelRig wide(16, 16), narrow(1, 16);
    const LpvBlockers blockers = wide.block(surfels), same = narrow.block(surfels);
    const LpvCells result = propagated(wide, cells, std::uint32_t(steps), &blockers);
    CHECK(disagreement(result.values, twinPropagated(cells, steps, wallsOf(16, surfels)).values) == "");
    CHECK(bitDifference(propagated(narrow, cells, std::uint32_t(steps), &same).values, result.values) == "");
}

}  // namespace

TEST_CASE("blocked steps are those of faces one by one, to the border, at both widths", "[lpv_blocked]") { compareSteps(1); }
TEST_CASE("several blocked steps are as well", "[lpv_blocked][large]") { compareSteps(GENERATE(2, 5)); }

TEST_CASE("where nothing blocks, blocked steps give the bits of free ones", "[lpv_blocked][large]") {
    const std::uint32_t width = GENERATE(1u, 16u);
    const LpvCells cells = randomLight(16, 0);
    LpvSurfelRig rig(width, 16);
    const LpvBlockers none = rig.block({});
    for (const std::uint32_t steps : {1u, 2u, 9u}) {
        CAPTURE(steps);
        CHECK(bitDifference(propagated(rig, cells, steps, &none).values, propagated(rig, cells, steps, nullptr).values) == "");
    }
}

TEST_CASE("blocked steps in waves are the same to the bit, whatever the parts and their number", "[lpv_blocked][large]") {
    const int size = 32;
    const LpvCells cells = randomLight(size, 0);
    // Half of the grid, so that some runs are free.
    std::vector<LpvSurfel> surfels = randomLpvSurfels(size, 2000, 1.5);
    for (LpvSurfel& s : surfels) s.place[0] *= 0.45;
    LpvSurfelRig wide(16, size), narrow(1, size);
    const LpvBlockers blockers = wide.block(surfels), same = narrow.block(surfels);
    for (const std::uint32_t steps : {2u, 7u, 33u}) {
        const LpvCells one = propagated(narrow, cells, steps, &same);
        for (const std::uint32_t units : {1u, 2u, 64u}) {
            CAPTURE(steps, units);
            CHECK(bitDifference(propagated(wide, cells, steps, &blockers, units).values, one.values) == "");
        }
    }
}

TEST_CASE("what is sent arrives or is blocked: no light is lost or made", "[lpv_blocked][large]") {
    const int n = 32;
    const LpvCells cells = randomLight(n, 6);
    const std::vector<LpvSurfel> surfels = randomLpvSurfels(n, 20000, 0.8);
    LpvSurfelRig rig(16, n);
    const LpvBlockers blockers = rig.block(surfels);
    const LpvCells once = propagated(rig, cells, 1, &blockers);
    const LpvWalls walls = wallsOf(n, surfels);
    for (int colour = 0; colour < LW_LPV_COLOURS; ++colour) {
        const double sent = cells.sum(4 * colour), arrived = once.sum(4 * colour) - sent;
        LpvTwin second(n, n, n);
        const double taken = colourOf(cells, colour).stepInto(second, &walls);
        CHECK((arrived + taken) / sent == Approx(1.0).epsilon(kConserved));
        CHECK(taken / sent > 0.1);
    }
}

TEST_CASE("blockers everywhere let nothing arrive", "[lpv_blocked][large]") {
    std::vector<LpvSurfel> surfels;
    for (int layer = 0; layer <= 16; ++layer)
        for (int axis = 0; axis < 3; ++axis) addLpvWall(surfels, 16, axis, layer, 1.0, 1);
    for (LpvSurfel& s : surfels) s.area = 4.0;
    LpvSurfelRig rig(16, 16);
    const LpvBlockers blockers = rig.block(surfels);
    const LpvCells cells = randomLight(16, 0);
    CHECK(disagreement(propagated(rig, cells, 5, &blockers).values, cells.values) == "");
}

// Flux beyond a wall that a lamp of 3 x 3 cells in front of it sends, as a share of what is there without the wall. Its surfels
// cover so much of its cells' sides; sheets are a cell apart.
TEST_CASE("walls that fill their cells are opaque, half open ones let less through than they are open", "[lpv_blocked][large]") {
    const int n = 32, steps = 32;
    LpvCells cells(n);
    for (int x = 15; x <= 17; ++x)
        for (int y = 15; y <= 17; ++y) {
            cells.at(0, x, y, 10) = float(std::sqrt(LpvTwin::kPi) / 2.0 / LpvTwin::kPi);
            cells.at(3, x, y, 10) = float(std::sqrt(LpvTwin::kPi / 3.0) / LpvTwin::kPi);
        }
    LpvSurfelRig rig(16, n);
    std::uint64_t revision = 0;
    double open = 0.0;
    const auto share = [&](double covered, int sheets) {
        std::vector<LpvSurfel> surfels;
        for (int i = 0; i < sheets; ++i) addLpvWall(surfels, n, 2, 13.0 + i);
        for (LpvSurfel& s : surfels) s.area *= covered;
        const LpvBlockers blockers = rig.block(surfels, {}, ++revision);
        const LpvCells result = propagated(rig, cells, steps, &blockers);
        double beyond = 0.0;
        for (int z = 16; z < n; ++z)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x) beyond += double(result.at(0, x, y, z));
        if (sheets == 0) open = beyond;
        return beyond / open;
    };
    CHECK(share(1.0, 0) == 1.0);
    const double half = share(0.5, 1), most = share(0.9, 1), twice = share(0.9, 2);
    CAPTURE(half, most, twice);
    CHECK(std::abs(share(1.0, 1)) < 1e-6);
    CHECK(half > 0.1);
    CHECK(half < 0.5);
    CHECK(most < 0.1);
    CHECK(twice < 0.1 * most);
}

// As lpv_propagation_test's wide plane, with the plane itself in the way.
TEST_CASE("a wide plane that blocks lights the cells above it by 1", "[lpv_blocked][large]") {
    const int n = 32, steps = 15;
    LpvCells cells(n);
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x)
            for (int c = 0; c < LW_LPV_COLOURS; ++c) {
                cells.at(4 * c, x, y, 0) = float(std::sqrt(LpvTwin::kPi) / 2.0 / LpvTwin::kPi);
                cells.at(4 * c + 3, x, y, 0) = float(std::sqrt(LpvTwin::kPi / 3.0) / LpvTwin::kPi);
            }
    std::vector<LpvSurfel> surfels;
    addLpvWall(surfels, n, 2, 0.0);
    LpvSurfelRig rig(16, n);
    const LpvBlockers blockers = rig.block(surfels);
    const LpvCells result = propagated(rig, cells, steps, &blockers);
    const auto read = [&](int z, double sign) {
        const double even = std::sqrt(LpvTwin::kPi) / 2.0 * double(result.at(0, 15, 16, z));
        const double odd = std::sqrt(LpvTwin::kPi / 3.0) * double(result.at(3, 15, 16, z));
        return LpvPropagation::calibration(n, steps, true) * (even + sign * odd);
    };
    double sum = 0.0;
    for (int z = 1; z <= 4; ++z) sum += read(z, 1.0) / 4.0;
    CHECK(sum == Approx(1.0).epsilon(1e-5));
    // What the plane reads of its own light, 1.36 where nothing blocks after as many steps: the truth is nothing.
    CHECK(read(0, -1.0) == Approx(0.84).margin(0.005));
    CHECK(LpvPropagation::calibration(32, 64, true) == Approx(1.193).margin(0.001));
}
