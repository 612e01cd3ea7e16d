// Steps of a light propagation volume: against faces one by one in double, conservation, and how far light gets.
#include "passes/lpv_propagation.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "reference/lpv_twin.h"
#include "support/lpv_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::LpvTwin;

namespace {

// Sums of some ten thousand floats, each rounded.
constexpr double kConserved = 1e-5;

LpvCells propagated(std::uint32_t width, const LpvCells& cells, std::uint32_t steps, std::uint32_t units = 0) {
    KernelRig rig(width);
    LpvPropagation pass(rig.device(), std::uint32_t(cells.size), units);
    const Guarded injected = rig.upload(cells.laidOut());
    const Buffer& result = pass.record(rig.executor(), injected, steps);
    rig.device().finish();
    CHECK(pass.bytes() == LpvPropagation::estimateBytes(std::uint32_t(cells.size), steps));
    return LpvCells::of(result, cells.size);
}

// The sum of what was injected and all that the steps make of it.
LpvCells twinPropagated(const LpvCells& cells, int steps) {
    const int n = cells.size;
    LpvCells result(n);
    for (int colour = 0; colour < LW_LPV_COLOURS; ++colour) {
        LpvTwin now(n, n, n), sum(n, n, n);
        for (int z = 0; z < n; ++z)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x)
                    for (int b = 0; b < 4; ++b) sum.at(x, y, z)[std::size_t(b)] = double(cells.at(4 * colour + b, x, y, z));
        now = sum;
        for (int i = 0; i < steps; ++i) {
            LpvTwin next(n, n, n);
            now.stepInto(next);
            now = next;
            for (std::size_t c = 0; c < sum.cells.size(); ++c)
                for (std::size_t b = 0; b < 4; ++b) sum.cells[c][b] += now.cells[c][b];
        }
        for (int z = 0; z < n; ++z)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x)
                    for (int b = 0; b < 4; ++b) result.at(4 * colour + b, x, y, z) = float(sum.at(x, y, z)[std::size_t(b)]);
    }
    return result;
}

// Exitance 1 in the lowest of `layers` layers of an infinite plane; irradiance on cell centres after so many steps, on surfaces
// that face it and ones that face away.
struct PlaneLight {
    std::vector<double> facing, away;
    PlaneLight(int layers, int steps) {
        LpvTwin now(1, 1, layers, true), sum(1, 1, layers, true);
        LpvTwin::addLobe(now.at(0, 0, 0), 1.0 / LpvTwin::kPi, 0, 0, 1);
        sum = now;
        for (int i = 0; i < steps; ++i) {
            LpvTwin next(1, 1, layers, true);
            now.stepInto(next);
            now = next;
            for (std::size_t c = 0; c < sum.cells.size(); ++c)
                for (std::size_t b = 0; b < 4; ++b) sum.cells[c][b] += now.cells[c][b];
        }
        for (const auto& c : sum.cells) {
            const double even = std::sqrt(LpvTwin::kPi) / 2.0 * c[0], odd = std::sqrt(LpvTwin::kPi / 3.0) * c[3];
            facing.push_back(std::max(0.0, even + odd));
            away.push_back(std::max(0.0, even - odd));
        }
    }
    double calibration() const { return 4.0 / (facing[1] + facing[2] + facing[3] + facing[4]); }
};

}  // namespace

TEST_CASE("the solid angles of a cell's far faces make a sixth of the sphere", "[lpv_propagation]") {
    CHECK(LpvTwin::frontAngle() == Approx(0.4006696846).epsilon(1e-9));
    CHECK(LpvTwin::sideAngle() == Approx(0.4234313544).epsilon(1e-9));
    CHECK(LpvTwin::frontAngle() == Approx(LW_LPV_FRONT_ANGLE).epsilon(1e-14));
    CHECK(LpvTwin::sideAngle() == Approx(LW_LPV_SIDE_ANGLE).epsilon(1e-14));
}

TEST_CASE("steps are those of faces one by one, to the border, at both widths", "[lpv_propagation]") {
    const int steps = GENERATE(1, 2, 5);
    const LpvCells cells = randomLight(16, 0), expected = twinPropagated(cells, steps);
    const LpvCells wide = propagated(16, cells, steps);
    CHECK(disagreement(wide.values, expected.values) == "");
    CHECK(bitDifference(propagated(1, cells, steps).values, wide.values) == "");
    CHECK(bitDifference(propagated(16, cells, 0).values, cells.values) == "");
}

// At width 1 step by step through the whole grid; else several in one wave, in as many parts as there is work for.
TEST_CASE("steps in waves are the same to the bit, whatever the parts and their number", "[lpv_propagation][large]") {
    const int size = GENERATE(16, 32);
    const LpvCells cells = randomLight(size, 0);
    for (const std::uint32_t steps : {1u, 2u, 3u, 7u, 16u, 33u}) {
        const LpvCells one = propagated(1, cells, steps);
        for (const std::uint32_t units : {1u, 2u, 7u, 64u}) {
            CAPTURE(size, steps, units);
            CHECK(bitDifference(propagated(16, cells, steps, units).values, one.values) == "");
        }
    }
}

TEST_CASE("a step keeps all light, and 0.36864 of its direction", "[lpv_propagation]") {
    const LpvCells cells = randomLight(32, 6);
    const LpvCells once = propagated(16, cells, 1), five = propagated(16, cells, 5);
    double directed = 0.0, kept = 0.0;
    for (int p = 0; p < LW_LPV_PLANES; ++p) {
        if (p % LW_LPV_BANDS == 0) {
            CHECK(once.sum(p) / cells.sum(p) - 1.0 == Approx(1.0).epsilon(kConserved));
            CHECK(five.sum(p) / cells.sum(p) == Approx(6.0).epsilon(kConserved));
        } else {
            directed += std::abs(cells.sum(p));
            kept += std::abs(once.sum(p) - cells.sum(p));
        }
    }
    CHECK(kept / directed == Approx(0.36864).epsilon(kConserved));
}

// The table of docs/techniques/lpv.md, from faces in double; then the same from the pass, whose grid is too small to be
// infinite sideways but whose middle does not know before light has come from the border.
TEST_CASE("a plane's light spreads with the square root of the steps", "[lpv_propagation]") {
    struct Row {
        int steps;
        double calibration;
    };
    for (const Row& row : {Row{16, 1.70}, Row{32, 1.10}, Row{64, 0.81}, Row{128, 0.66}, Row{1024, 0.49}}) {
        CAPTURE(row.steps);
        const PlaneLight plane(64, row.steps);
        CHECK(plane.calibration() == Approx(row.calibration).margin(0.005));
        CHECK(LpvPropagation::calibration(64, std::uint32_t(row.steps)) == Approx(plane.calibration()).epsilon(1e-12));
    }
    const PlaneLight few(64, 16), more(64, 256), many(64, 8192);
    CHECK(few.facing[8] == Approx(0.003).margin(0.0005));
    CHECK(few.facing[16] < 1e-9);
    CHECK(more.facing[8] == Approx(0.95).margin(0.005));
    CHECK(more.facing[16] == Approx(0.27).margin(0.005));
    CHECK(more.facing[32] == Approx(0.005).margin(0.0005));
    CHECK(many.facing[8] == Approx(2.0).margin(0.05));
    CHECK(many.facing[16] == Approx(1.7).margin(0.05));
    CHECK(many.facing[32] == Approx(1.1).margin(0.05));
    // What the plane itself, whose cell is the lowest, reads of its own light: the truth is nothing.
    CHECK(PlaneLight(32, 16).away[0] * LpvPropagation::calibration(32, 16) == Approx(1.34).margin(0.005));
    CHECK(PlaneLight(32, 64).away[0] * LpvPropagation::calibration(32, 64) == Approx(0.94).margin(0.005));
    const PlaneLight middle(64, 128);
    CHECK(middle.away[8] / middle.facing[8] == Approx(0.94).margin(0.005));
}

TEST_CASE("a wide plane in the pass's grid lights the cells above it by 1", "[lpv_propagation]") {
    const int size = 32, steps = 15;
    LpvCells cells(size);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            for (int c = 0; c < LW_LPV_COLOURS; ++c) {
                cells.at(4 * c, x, y, 0) = float(std::sqrt(LpvTwin::kPi) / 2.0 / LpvTwin::kPi);
                cells.at(4 * c + 3, x, y, 0) = float(std::sqrt(LpvTwin::kPi / 3.0) / LpvTwin::kPi);
            }
    const LpvCells result = propagated(16, cells, steps);
    const PlaneLight plane(size, steps);
    double sum = 0.0;
    for (int z = 1; z <= 8; ++z) {
        const double e = std::sqrt(LpvTwin::kPi) / 2.0 * double(result.at(0, 15, 16, z)) +
                         std::sqrt(LpvTwin::kPi / 3.0) * double(result.at(3, 15, 16, z));
        CHECK(e == Approx(plane.facing[std::size_t(z)]).epsilon(1e-5));
        if (z <= 4) sum += e * LpvPropagation::calibration(size, steps) / 4.0;
    }
    CHECK(sum == Approx(1.0).epsilon(1e-5));
}
