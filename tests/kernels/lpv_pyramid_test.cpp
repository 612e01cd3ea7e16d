// Propagation on a pyramid of grids, against the same in double, face by face; and that each path is counted once.
#include "passes/lpv_pyramid.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "reference/lpv_twin.h"
#include "support/lpv_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::LpvTwin;

namespace {

LpvCells carried(std::uint32_t width, const LpvCells& cells, std::uint32_t steps) {
    KernelRig rig(width);
    const auto size = std::uint32_t(cells.size);
    LpvPyramid pass(rig.device(), size, steps);
    const Guarded injected = rig.upload(cells.laidOut()), place = rig.upload(std::vector<LwLpvPlace>(1));
    LpvCells result(cells.size);
    for (int frame = 0; frame < 2; ++frame) {
        const Buffer& light = pass.record(rig.executor(), injected, place, [](std::uint32_t, const Buffer&) { return nullptr; });
        rig.device().finish();
        result = LpvCells::of(light, cells.size);
    }
    CHECK(pass.bytes() == LpvPyramid::estimateBytes(size, steps));
    return result;
}

// What reaches the cells of a grid of n a side, of light that is to go on there: so many steps, and what coarser grids make of the
// last. Interpolation by what each coarse cell's neighbour on that side counts, a quarter.
LpvTwin reached(const LpvTwin& given, std::uint32_t finest, std::uint32_t level, std::uint32_t steps) {
    const int n = given.nx, half = n / 2;
    LpvTwin now = given, sum(n, n, n);
    for (std::uint32_t i = 0; i < LpvPyramid::stepsOn(level, finest, steps); ++i) {
        LpvTwin next(n, n, n);
        now.stepInto(next);
        now = next;
        for (std::size_t c = 0; c < sum.cells.size(); ++c)
            for (std::size_t b = 0; b < 4; ++b) sum.cells[c][b] += now.cells[c][b];
    }
    if (level + 1 == LpvPyramid::levelsOf(finest)) return sum;
    LpvTwin coarse(half, half, half);
    for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x)
                for (std::size_t b = 0; b < 4; ++b) coarse.at(x / 2, y / 2, z / 2)[b] += now.at(x, y, z)[b];
    LpvTwin beyond = reached(coarse, finest, level + 1, steps);
    for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x)
                for (int k = 0; k < 8; ++k) {
                    const int fine[3] = {x, y, z};
                    int at[3];
                    double share = 0.25;  // of the light: a coarse cell's goes through four times the area
                    for (int a = 0; a < 3; ++a) {
                        const bool other = k >> a & 1;
                        at[a] = fine[a] / 2 + (other ? (fine[a] % 2 ? 1 : -1) : 0);
                        at[a] = std::min(std::max(at[a], 0), half - 1);
                        share *= other ? 0.25 : 0.75;
                    }
                    for (std::size_t b = 0; b < 4; ++b) sum.at(x, y, z)[b] += share * beyond.at(at[0], at[1], at[2])[b];
                }
    return sum;
}

LpvCells twin(const LpvCells& cells, std::uint32_t steps) {
    const int n = cells.size;
    LpvCells result(n);
    for (int colour = 0; colour < LW_LPV_COLOURS; ++colour) {
        LpvTwin given(n, n, n);
        for (int z = 0; z < n; ++z)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x)
                    for (int b = 0; b < 4; ++b) given.at(x, y, z)[std::size_t(b)] = double(cells.at(4 * colour + b, x, y, z));
        LpvTwin light = reached(given, std::uint32_t(n), 0, steps);
        for (int z = 0; z < n; ++z)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x)
                    for (std::size_t b = 0; b < 4; ++b)
                        result.at(4 * colour + int(b), x, y, z) = float(light.at(x, y, z)[b] + given.at(x, y, z)[b]);
    }
    return result;
}

}  // namespace

TEST_CASE("a pyramid's grids carry light as faces one by one do, at both widths", "[lpv_pyramid][large]") {
    const LpvCells cells = randomLight(32, 0);
    for (const std::uint32_t steps : {0u, 1u, 3u}) {
        CAPTURE(steps);
        const LpvCells wide = carried(16, cells, steps);
        CHECK(disagreement(wide.values, twin(cells, steps).values) == "");
        CHECK(bitDifference(carried(1, cells, steps).values, wide.values) == "");
    }
    // The smallest grid is all there is.
    const LpvCells small = randomLight(16, 0);
    KernelRig rig(16);
    LpvPropagation plain(rig.device(), 16);
    const Guarded injected = rig.upload(small.laidOut());
    const Buffer& light = plain.record(rig.executor(), injected, LpvPyramid::kCoarsestSteps);
    rig.device().finish();
    CHECK(bitDifference(carried(16, small, 0).values, LpvCells::of(light, 16).values) == "");
}

// Away from the border each step's light has all of the flux: of three grids' steps, in the finest one's unit an eighth more cells and
// a quarter of the light, so twice as much for each level.
TEST_CASE("each path is counted once on all grids together", "[lpv_pyramid][large]") {
    LpvCells cells(64);
    for (int c = 0; c < LW_LPV_COLOURS; ++c) cells.at(4 * c, 31, 33, 30) = 1.0f;
    const LpvCells light = carried(16, cells, 2);
    for (int c = 0; c < LW_LPV_COLOURS; ++c) CHECK(light.sum(4 * c) == Approx(1.0 + 2.0 + 2.0 * 2.0 + 4.0 * 2.0).epsilon(1e-5));
}

// Two steps on each grid bring no light from the border to the middle: there the plane is infinite.
TEST_CASE("a plane lights the cells above it by 1 from all grids together", "[lpv_pyramid]") {
    const double root = std::sqrt(LpvTwin::kPi);
    LpvCells cells(32);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x)
            for (int c = 0; c < LW_LPV_COLOURS; ++c) {
                cells.at(4 * c, x, y, 0) = float(0.5 / root);
                cells.at(4 * c + 3, x, y, 0) = float(1.0 / (root * std::sqrt(3.0)));
            }
    const LpvCells light = carried(16, cells, 2);
    const double kappa = LpvPyramid::calibration(32, 2, false);
    double sum = 0.0;
    for (int z = 1; z <= 4; ++z)
        sum += 0.25 * kappa * (root / 2.0 * double(light.at(0, 15, 16, z)) + root / std::sqrt(3.0) * double(light.at(3, 15, 16, z)));
    CHECK(sum == Approx(1.0).epsilon(1e-5));
}
