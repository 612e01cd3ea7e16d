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
    CHECK(pass.bytes() == LpvPropagation::estimateBytes(std::uint32_t(cells.size), steps, blockers != nullptr));
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

// The sum of what was injected and all that the steps make of it, the first of them free.
LpvTwin twinPropagated(LpvTwin now, int steps, const LpvWalls& walls) {
    LpvTwin sum = now;
    for (int i = 0; i < steps; ++i) {
        LpvTwin next(now.nx, now.ny, now.nz);
        now.stepInto(next, i == 0 ? nullptr : &walls);
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

}  // namespace

TEST_CASE("blocked steps are those of faces one by one, to the border, at both widths", "[lpv_blocked]") {
    const int steps = GENERATE(1, 2, 5);
    const LpvCells cells = randomLight(16, 0);
    const std::vector<LpvSurfel> surfels = randomLpvSurfels(16, 1500, 1.5);
    LpvSurfelRig wide(16, 16), narrow(1, 16);
    const LpvBlockers blockers = wide.block(surfels), same = narrow.block(surfels);
    const LpvCells result = propagated(wide, cells, std::uint32_t(steps), &blockers);
    CHECK(disagreement(result.values, twinPropagated(cells, steps, wallsOf(16, surfels)).values) == "");
    CHECK(bitDifference(propagated(narrow, cells, std::uint32_t(steps), &same).values, result.values) == "");
}

TEST_CASE("where nothing blocks, blocked steps give the bits of free ones", "[lpv_blocked]") {
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

TEST_CASE("what is sent arrives or is blocked: no light is lost or made", "[lpv_blocked]") {
    const int n = 32;
    const LpvCells cells = randomLight(n, 6);
    const std::vector<LpvSurfel> surfels = randomLpvSurfels(n, 20000, 0.8);
    LpvSurfelRig rig(16, n);
    const LpvBlockers blockers = rig.block(surfels);
    // Of the second step: the third sum's difference from the second.
    const LpvCells once = propagated(rig, cells, 1, &blockers), twice = propagated(rig, cells, 2, &blockers);
    const LpvWalls walls = wallsOf(n, surfels);
    for (int colour = 0; colour < LW_LPV_COLOURS; ++colour) {
        const double sent = once.sum(4 * colour) - cells.sum(4 * colour), arrived = twice.sum(4 * colour) - once.sum(4 * colour);
        LpvTwin first(n, n, n), second(n, n, n);
        colourOf(cells, colour).stepInto(first);
        const double taken = first.stepInto(second, &walls);
        CHECK(sent / cells.sum(4 * colour) == Approx(1.0).epsilon(kConserved));
        CHECK((arrived + taken) / sent == Approx(1.0).epsilon(kConserved));
        CHECK(taken / sent > 0.1);
    }
}

TEST_CASE("blockers everywhere let nothing arrive after the first step", "[lpv_blocked]") {
    std::vector<LpvSurfel> surfels;
    for (int layer = 0; layer <= 16; ++layer)
        for (int axis = 0; axis < 3; ++axis) addLpvWall(surfels, 16, axis, layer, 1.0, 1);
    for (LpvSurfel& s : surfels) s.area = 4.0;
    LpvSurfelRig rig(16, 16);
    const LpvBlockers blockers = rig.block(surfels);
    const LpvCells cells = randomLight(16, 0);
    const LpvCells once = propagated(rig, cells, 1, nullptr), five = propagated(rig, cells, 5, &blockers);
    CHECK(disagreement(five.values, once.values) == "");
}

// Flux beyond a wall of full cells, in sheets a cell apart, that a lamp of 3 x 3 cells in front of it sends, as a share of what
// is there without the wall.
TEST_CASE("each sheet of a wall lets a fiftieth of the light through", "[lpv_blocked]") {
    const int n = 32, steps = 32;
    LpvCells cells(n);
    for (int x = 15; x <= 17; ++x)
        for (int y = 15; y <= 17; ++y) {
            cells.at(0, x, y, 10) = float(std::sqrt(LpvTwin::kPi) / 2.0 / LpvTwin::kPi);
            cells.at(3, x, y, 10) = float(std::sqrt(LpvTwin::kPi / 3.0) / LpvTwin::kPi);
        }
    LpvSurfelRig rig(16, n);
    double open = 0.0;
    std::vector<double> shares;
    for (int sheets = 0; sheets <= 3; ++sheets) {
        std::vector<LpvSurfel> surfels;
        for (int i = 0; i < sheets; ++i) addLpvWall(surfels, n, 2, 13.0 + i);
        const LpvBlockers blockers = rig.block(surfels, {}, std::uint64_t(sheets + 1));
        const LpvCells result = propagated(rig, cells, steps, &blockers);
        double beyond = 0.0;
        for (int z = 16; z < n; ++z)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x) beyond += double(result.at(0, x, y, z));
        if (sheets == 0) open = beyond;
        shares.push_back(beyond / open);
    }
    CAPTURE(shares[1], shares[2], shares[3]);
    CHECK(shares[1] == Approx(2.1e-2).epsilon(0.02));
    CHECK(shares[2] == Approx(5.0e-4).epsilon(0.02));
    CHECK(shares[3] == Approx(1.2e-5).epsilon(0.03));
}
