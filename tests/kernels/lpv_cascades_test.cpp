// What a coarser grid brings into a finer one, against sums in double; where nested grids lie; which lights are whose.
#include "passes/lpv_cascades.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "passes/lpv_grid.h"
#include "shared/lpv_sweep_types.h"
#include "support/lpv_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr int kSize = 16;
constexpr std::size_t kCells = std::size_t(kSize) * kSize * kSize;

LwLpvPlace placeOf(double x, double y, double z, double cell) {
    LwLpvPlace place{};
    place.origin = {{float(x), float(y), float(z), float(1.0 / cell)}};
    place.cell = {{float(cell), 1.0f, 1.0f, 0.0f}};
    return place;
}

// Cells of 1/2 and, within them, of 1/4.
const LwLpvPlace kCoarse = placeOf(-1.0, 2.0, 0.5, 0.5), kFine = placeOf(0.75, 3.25, 4.5, 0.25);

std::vector<float> randomCells(std::size_t floats, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0.1f, 1.0f);
    std::vector<float> values(floats);
    for (float& v : values) v = unit(random);
    return values;
}

// Of sweeps: a cell is as open at all of its sides.
std::vector<float> randomSides(unsigned seed) {
    std::vector<float> cells = randomCells(LW_SWEEP_CELL * kCells, seed);
    for (std::size_t i = 0; i < kCells; ++i)
        for (std::size_t side = 1; side < LW_SWEEP_SIDES; ++side) cells[LW_SWEEP_CELL * i + 4 * side + 3] = cells[LW_SWEEP_CELL * i + 3];
    return cells;
}

// The eight coarse cells around the middle of a fine one, and their shares.
template <typename Visit>
void around(int x, int y, int z, Visit visit) {
    const int at[3] = {x, y, z};
    double f[3];
    int low[3];
    for (int a = 0; a < 3; ++a) {
        const double world = double(kFine.origin.s[a]) + (at[a] + 0.5) * 0.25;
        const double g = std::min(std::max((world - double(kCoarse.origin.s[a])) / 0.5 - 0.5, 0.0), kSize - 1.0);
        low[a] = std::min(int(g), kSize - 2);
        f[a] = g - low[a];
    }
    for (int k = 0; k < 8; ++k)
        visit(std::size_t(((low[2] + (k >> 2)) * kSize + low[1] + (k >> 1 & 1)) * kSize + low[0] + (k & 1)),
              (k & 1 ? f[0] : 1 - f[0]) * (k & 2 ? f[1] : 1 - f[1]) * (k & 4 ? f[2] : 1 - f[2]));
}

std::vector<float> stepsTwin(const std::vector<float>& far, std::vector<float> cells) {
    for (int i = 0; i < int(kCells); ++i) {
        double light[16] = {};
        around(i % kSize, i / kSize % kSize, i / kSize / kSize, [&](std::size_t cell, double share) {
            for (std::size_t b = 0; b < 16; ++b) light[b] += share * double(far[16 * cell + b]);
        });
        for (std::size_t b = 0; b < 16; ++b) cells[16 * std::size_t(i) + b] += float(light[b] / 4.0);
    }
    return cells;
}

struct SweepCells {
    std::vector<float> cells;
    double largest = 0.0;
};
SweepCells sweepsTwin(const std::vector<float>& far, std::vector<float> cells) {
    SweepCells result;
    for (int i = 0; i < int(kCells); ++i)
        for (std::size_t side = 0; side < LW_SWEEP_SIDES; ++side) {
            double light[4] = {};
            around(i % kSize, i / kSize % kSize, i / kSize / kSize, [&](std::size_t cell, double share) {
                for (std::size_t c = 0; c < 4; ++c) light[c] += share * double(far[LW_SWEEP_CELL * cell + 4 * side + c]);
            });
            float* to = &cells[LW_SWEEP_CELL * std::size_t(i) + 4 * side];
            for (std::size_t c = 0; c < 3; ++c) {
                to[c] += float(double(to[3]) * light[c] / light[3]);
                result.largest = std::max(result.largest, double(to[c]) / double(to[3]));
            }
        }
    result.cells = cells;
    return result;
}

}  // namespace

TEST_CASE("a coarser grid's light comes into a finer one's cells as sums in double say", "[lpv_cascades]") {
    KernelRig rig(GENERATE(1u, 16u));
    LpvCascades pass(rig.device(), kSize);
    const Guarded fine = rig.upload(std::vector<LwLpvPlace>{kFine}), coarse = rig.upload(std::vector<LwLpvPlace>{kCoarse});
    const std::vector<float> far = randomCells(16 * kCells, 1), near = randomCells(16 * kCells, 2);
    const Guarded farCells = rig.upload(far), cells = rig.upload(near);
    pass.recordSteps(rig.executor(), {fine, coarse}, farCells, cells);
    rig.device().finish();
    CHECK(disagreement(rig.download<float>(cells), stepsTwin(far, near), 1e-6) == "");

    const std::vector<float> farSides = randomSides(3), nearSides = randomSides(4);
    const Guarded farSweep = rig.upload(farSides), sweep = rig.upload(nearSides), total = rig.upload(nearSides),
                  largest = rig.upload(std::vector<float>(1));
    pass.recordSweeps(rig.executor(), {fine, coarse}, farSweep, sweep, &total, largest);
    rig.device().finish();
    const SweepCells expected = sweepsTwin(farSides, nearSides);
    CHECK(disagreement(rig.download<float>(sweep), expected.cells, 1e-6) == "");
    CHECK(bitDifference(rig.download<float>(total), rig.download<float>(sweep)) == "");
    CHECK(double(rig.download<float>(largest)[0]) == Approx(expected.largest).epsilon(1e-6));
}

namespace {

struct NestRig : KernelRig {
    explicit NestRig(std::uint32_t width) : KernelRig(width), outer(device(), kSize), inner(device(), kSize) {}
    RsmInput rsms;
    LpvGrid outer, inner;
    std::uint32_t count = 0;

    // Corners of both, in cells of their own.
    void place(const LpvPlacement& placement, const std::vector<LWVpl>& vpls = {}) {
        LWFrame frame{};
        frame.structSize = sizeof frame;
        rsms.import(executor(), frame);
        count = std::uint32_t(vpls.size());
        outer.recordPlace(executor(), rsms, vpls.data(), count, placement);
        inner.recordNested(executor(), outer, placement);
        device().finish();
    }
    LwLpvPlace at(const LpvGrid& grid) {
        LwLpvPlace result;
        grid.place().download(0, sizeof result, &result);
        return result;
    }
    std::vector<float> inject(LpvGrid& grid, const LpvGrid* left) {
        grid.recordInject(executor(), rsms, outer.authored(), count, left ? &left->place() : nullptr);
        device().finish();
        return LpvCells::of(grid.injected(), kSize).values;
    }
};

LpvPlacement aroundFocus(double x, double y, double z, double extent) {
    LpvPlacement placement;
    placement.extent = float(extent);
    placement.hasFocus = true;
    placement.focus[0] = float(x);
    placement.focus[1] = float(y);
    placement.focus[2] = float(z);
    return placement;
}

// Inside of the inner grid, outside of it, and about its border, which is at +-2 with an extent of 8; with normals each way.
std::vector<LWVpl> lightsAbout(std::size_t number) {
    std::mt19937 random(9);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    std::vector<LWVpl> vpls(number);
    for (std::size_t i = 0; i < number; ++i) {
        LWVpl& vpl = vpls[i];
        for (int a = 0; a < 3; ++a) {
            vpl.position[a] = (i % 3 == 0 ? 3.5f : 1.9f) * unit(random);
            vpl.flux[a] = 1.0f + unit(random);
        }
        if (i % 3 == 2) vpl.position[i / 3 % 3] = (i % 2 ? 2.0f : -2.0f) + 0.1f * unit(random);
        vpl.normal[i % 3] = i % 2 ? 1.0f : -1.0f;
    }
    return vpls;
}

bool isInside(const LWVpl& vpl, double corner, double cell) {
    for (int a = 0; a < 3; ++a) {
        const double g = (double(vpl.position[a]) - corner) / cell + 0.5 * double(vpl.normal[a]);
        if (g < 0.0 || g >= kSize) return false;
    }
    return true;
}

}  // namespace

TEST_CASE("grids around a focus begin at whole cells of their own, and move by those alone", "[lpv_cascades]") {
    NestRig rig(GENERATE(1u, 16u));
    // Cells of 1/2 and 1/4.
    rig.place(aroundFocus(0.3, -7.9, 100.26, 8));
    const LwLpvPlace outer = rig.at(rig.outer), inner = rig.at(rig.inner);
    CHECK(outer.cell.s[0] == 0.5f);
    CHECK(inner.cell.s[0] == 0.25f);
    CHECK(inner.origin.s[3] == 4.0f);
    const float outerAt[3] = {-4.0f, -12.0f, 96.0f}, innerAt[3] = {-1.75f, -10.0f, 98.25f};
    for (int a = 0; a < 3; ++a) {
        CHECK(outer.origin.s[a] == outerAt[a]);
        CHECK(inner.origin.s[a] == innerAt[a]);
    }
    rig.place(aroundFocus(0.49, -7.76, 100.49, 8));  // within the same cells
    CHECK(rig.at(rig.outer).origin.s[0] == outer.origin.s[0]);
    for (int a = 0; a < 3; ++a) CHECK(rig.at(rig.inner).origin.s[a] == inner.origin.s[a]);
    rig.place(aroundFocus(0.51, -7.76, 100.49, 8));  // one further
    CHECK(rig.at(rig.outer).origin.s[0] == outer.origin.s[0] + 0.5f);
    CHECK(rig.at(rig.inner).origin.s[0] == inner.origin.s[0] + 0.25f);
    CHECK(rig.at(rig.inner).origin.s[1] == inner.origin.s[1]);
}

TEST_CASE("a finer grid stays within a fitted one wherever the focus is", "[lpv_cascades]") {
    NestRig rig(16);
    LWVpl vpls[2] = {};
    for (int a = 0; a < 3; ++a) {
        vpls[0].position[a] = -1.0f;
        vpls[1].position[a] = 2.0f;
        vpls[0].normal[a] = vpls[1].normal[a] = 0.577f;
        vpls[0].flux[a] = vpls[1].flux[a] = 1.0f;
    }
    const std::vector<LWVpl> lights(vpls, vpls + 2);
    for (const double away : {0.0, 1.9, -1e6, 3e38}) {
        LpvPlacement placement = aroundFocus(away, away, -away, 0);
        if (away == 0.0) placement.hasFocus = false;
        rig.place(placement, lights);
        const LwLpvPlace outer = rig.at(rig.outer), inner = rig.at(rig.inner);
        INFO("focus " << away);
        CHECK(inner.cell.s[0] == 0.5f * outer.cell.s[0]);
        for (int a = 0; a < 3; ++a) {
            const float cells = inner.origin.s[a] / inner.cell.s[0];
            CHECK(cells == Approx(std::round(cells)).epsilon(1e-6));
            // A cell of the outer grid on either side.
            CHECK(inner.origin.s[a] >= outer.origin.s[a] + 0.999f * outer.cell.s[0]);
            CHECK(inner.origin.s[a] + kSize * inner.cell.s[0] <= outer.origin.s[a] + (kSize - 0.999f) * outer.cell.s[0]);
            if (away == 0.0) CHECK(inner.origin.s[a] + 8.0f * inner.cell.s[0] == Approx(0.5).margin(double(inner.cell.s[0])));
        }
    }
    rig.place(LpvPlacement{});  // nothing to fit to: where it was
    LpvPlacement anew;
    anew.refit = true;
    rig.place(anew);
    CHECK(rig.at(rig.outer).origin.s[3] == 0.0f);
    CHECK(rig.at(rig.inner).origin.s[3] == 0.0f);
}

TEST_CASE("each light is the inner grid's or the outer one's alone, also on the border", "[lpv_cascades]") {
    NestRig rig(GENERATE(1u, 16u));
    const std::vector<LWVpl> lights = lightsAbout(3000);
    rig.place(aroundFocus(0.01, 0.01, 0.01, 8), lights);
    REQUIRE(rig.at(rig.inner).origin.s[0] == -2.0f);
    const std::vector<float> all = rig.inject(rig.outer, nullptr), outside = rig.inject(rig.outer, &rig.inner),
                             within = rig.inject(rig.inner, nullptr);
    double flux[3] = {};
    std::size_t insides = 0;
    const auto first = [](const std::vector<float>& cells) {
        double sum = 0.0;
        for (std::size_t i = 0; i < kCells; ++i) sum += double(cells[i]);
        return sum * 2.0 * std::sqrt(3.14159265358979323846);
    };
    for (const LWVpl& light : lights) {
        const bool inside = isInside(light, -2.0, 0.25);
        insides += inside ? 1 : 0;
        flux[0] += double(light.flux[0]);
        flux[inside ? 2 : 1] += double(light.flux[0]);
    }
    CHECK(insides > 500);
    CHECK(insides < 2500);
    CHECK(first(all) == Approx(flux[0]).epsilon(1e-6));
    CHECK(first(outside) == Approx(flux[1]).epsilon(1e-6));
    CHECK(first(within) == Approx(flux[2]).epsilon(1e-6));
    cl_uint missed = 0;
    rig.outer.state().download(LW_LPV_OUTSIDE * sizeof missed, sizeof missed, &missed);
    CHECK(missed == 0);
}
