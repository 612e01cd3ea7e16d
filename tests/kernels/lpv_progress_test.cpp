// Steps that end by what still moves: how many, against the flux of steps face by face in double; and that nothing else changes.
#include "passes/lpv_progress.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "reference/lpv_twin.h"
#include "support/lpv_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::LpvTwin;

namespace {

constexpr int kSize = 16;

struct Ended {
    LpvCells cells{kSize};
    LwLpvProgress state{};
};

Ended until(std::uint32_t width, const LpvCells& cells, std::uint32_t steps, float target, std::uint32_t units = 0) {
    KernelRig rig(width);
    LpvPropagation pass(rig.device(), kSize, units);
    LpvProgress progress(rig.device(), kSize, steps, target, false);
    const Guarded injected = rig.upload(cells.laidOut());
    Ended ended;
    for (int frame = 0; frame < 2; ++frame) {  // nothing is left of the frame before
        const Buffer& result = pass.record(rig.executor(), injected, steps, nullptr, &progress);
        rig.device().finish();
        ended.cells = LpvCells::of(result, kSize);
        progress.state().download(0, sizeof ended.state, &ended.state);
    }
    CHECK(progress.bytes() == LpvProgress::estimateBytes(kSize));
    return ended;
}

LpvCells all(std::uint32_t width, const LpvCells& cells, std::uint32_t steps) {
    KernelRig rig(width);
    LpvPropagation pass(rig.device(), kSize);
    const Guarded injected = rig.upload(cells.laidOut());
    const Buffer& result = pass.record(rig.executor(), injected, steps);
    rig.device().finish();
    return LpvCells::of(result, kSize);
}

// Of each colour, the share of its light that still moves after each of so many steps.
std::vector<std::array<double, 3>> movingShares(const LpvCells& cells, int steps) {
    std::vector<std::array<double, 3>> shares(std::size_t(steps) + 1);
    for (int colour = 0; colour < LW_LPV_COLOURS; ++colour) {
        LpvTwin now(kSize, kSize, kSize);
        for (int z = 0; z < kSize; ++z)
            for (int y = 0; y < kSize; ++y)
                for (int x = 0; x < kSize; ++x)
                    for (int b = 0; b < 4; ++b) now.at(x, y, z)[std::size_t(b)] = double(cells.at(4 * colour + b, x, y, z));
        double given = 0.0;
        for (const auto& c : now.cells) given += c[0];
        for (std::size_t i = 0; i < shares.size(); ++i) {
            double sum = 0.0;
            for (const auto& c : now.cells) sum += c[0];
            shares[i][std::size_t(colour)] = given > 0.0 ? sum / given : 0.0;
            LpvTwin next(kSize, kSize, kSize);
            now.stepInto(next);
            now = next;
        }
    }
    return shares;
}

double largest(const std::array<double, 3>& shares) { return std::max(shares[0], std::max(shares[1], shares[2])); }

// A lamp in the middle, another colour's near the border, where its light leaves sooner; no blue.
LpvCells lamps() {
    LpvCells cells(kSize);
    cells.at(0, 8, 8, 8) = 1.0f;
    cells.at(4, 2, 9, 5) = 3.0f;
    cells.at(5, 2, 9, 5) = -3.0f;
    return cells;
}

}  // namespace

TEST_CASE("steps end at the first look that finds less light moving than the target", "[lpv_propagation][large]") {
    const LpvCells cells = lamps();
    constexpr std::uint32_t kSteps = 64;
    const auto shares = movingShares(cells, kSteps);
    for (const double target : {0.9, 0.5, 0.25, 0.1, 0.05}) {
        std::uint32_t expected = LW_LPV_LOOK;
        while (expected < kSteps && largest(shares[expected]) > target) expected += LW_LPV_LOOK;
        const Ended ended = until(16, cells, kSteps, float(target));
        CAPTURE(target);
        CHECK(std::uint32_t(ended.state.steps) == expected);
        CHECK(double(ended.state.moving) == Approx(largest(shares[expected])).epsilon(1e-4));
        CHECK(double(ended.state.scale) ==
              Approx(LpvPropagation::calibration(kSize, expected) / LpvPropagation::calibration(kSize, kSteps)).epsilon(1e-6));
        CHECK(bitDifference(ended.cells.values, all(16, cells, expected).values) == "");
        for (const std::uint32_t units : {1u, 7u, 64u}) {
            const Ended cut = until(16, cells, kSteps, float(target), units);
            CHECK(cut.state.steps == ended.state.steps);
            CHECK(bitDifference(cut.cells.values, ended.cells.values) == "");
        }
        const Ended narrow = until(1, cells, kSteps, float(target));
        CHECK(narrow.state.steps == ended.state.steps);
        CHECK(narrow.state.moving == ended.state.moving);
        CHECK(bitDifference(narrow.cells.values, ended.cells.values) == "");
    }
}

TEST_CASE("a target that is never met changes nothing, however many steps there are", "[lpv_propagation][large]") {
    const LpvCells cells = randomLight(kSize, 0);
    for (const std::uint32_t steps : {1u, 2u, 5u, 8u, 9u, 15u, 16u, 33u})
        for (const std::uint32_t width : {1u, 16u}) {
            const Ended ended = until(width, cells, steps, 0.0f);
            CAPTURE(steps, width);
            CHECK(std::uint32_t(ended.state.steps) == steps);
            CHECK(ended.state.scale == 1.0f);
            CHECK(bitDifference(ended.cells.values, all(width, cells, steps).values) == "");
        }
}

TEST_CASE("a target is a share: light's unit does not count, and no light is done at once", "[lpv_propagation][large]") {
    LpvCells cells = lamps();
    const Ended ended = until(16, cells, 32, 0.4f);
    for (float& value : cells.values) value *= 0x1p-40f;
    const Ended dim = until(16, cells, 32, 0.4f);
    CHECK(dim.state.steps == ended.state.steps);
    CHECK(dim.state.moving == ended.state.moving);
    const Ended dark = until(16, LpvCells(kSize), 32, 0.01f);
    CHECK(dark.state.steps == LW_LPV_LOOK);
    CHECK(dark.state.moving == 0.0f);
    CHECK(dark.cells.sum(0) == 0.0);
}

TEST_CASE("sums beyond float's range leave out no step", "[lpv_propagation]") {
    LpvCells cells(kSize);
    for (int i = 0; i < kSize; ++i) cells.at(0, i, 8, 8) = 1e38f;
    const Ended ended = until(16, cells, 24, 0.4f);
    CHECK(ended.state.steps == 24);
    CHECK(ended.state.done == 0);
}
