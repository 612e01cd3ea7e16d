// Injection into a grid, against sums in double and in every order; and where the grid comes to lie.
#include "passes/lpv_grid.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/lit_room.h"
#include "support/lpv_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr int kSize = 16;
constexpr double kPi = 3.14159265358979323846;
// Float products of a light's flux, lobe and normal.
constexpr double kRounding = 1e-6;

struct GridRig : KernelRig {
    explicit GridRig(std::uint32_t width) : KernelRig(width), pass(device(), kSize) {}
    RsmInput rsms;
    LpvGrid pass;
    std::uint32_t most = 0;  // VPLs of a frame so far: their memory is kept

    LpvCells inject(const std::vector<LWLight>& lights, const std::vector<LWVpl>& vpls, const LpvPlacement& placement) {
        LWFrame frame{};
        frame.structSize = sizeof frame;
        frame.lights = lights.data();
        frame.lightCount = std::uint32_t(lights.size());
        rsms.import(executor(), frame);
        pass.record(executor(), rsms, vpls.data(), std::uint32_t(vpls.size()), placement);
        device().finish();
        most = std::max(most, std::uint32_t(vpls.size()));
        CHECK(pass.bytes() == LpvGrid::estimateBytes(kSize, most));
        return LpvCells::of(pass.injected(), kSize);
    }
    LwLpvPlace place() {
        LwLpvPlace result;
        pass.place().download(0, sizeof result, &result);
        return result;
    }
    cl_uint outside() {
        cl_uint count = 0;
        pass.state().download(LW_LPV_OUTSIDE * sizeof count, sizeof count, &count);
        return count;
    }
};

LpvPlacement cube(float x, float y, float z, float extent) {
    LpvPlacement placement;
    placement.centre[0] = x;
    placement.centre[1] = y;
    placement.centre[2] = z;
    placement.extent = extent;
    return placement;
}

// In the unit cube about the origin; several to a cell, of fluxes that differ by 10^5.
std::vector<LWVpl> scattered(std::size_t count) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    std::vector<LWVpl> vpls(count);
    for (LWVpl& vpl : vpls) {
        float squared = 0.0f;
        for (int a = 0; a < 3; ++a) {
            vpl.position[a] = 0.45f * unit(random);
            vpl.normal[a] = unit(random);
            squared += vpl.normal[a] * vpl.normal[a];
            vpl.flux[a] = std::exp(6.0f * unit(random));
        }
        for (float& n : vpl.normal) n /= std::sqrt(squared);
    }
    return vpls;
}

// Sums in double, of the cells that double arithmetic finds, in an extent of 1 about the origin.
LpvCells twin(const std::vector<LWVpl>& vpls) {
    std::vector<double> sums(LpvCells(kSize).values.size());
    for (const LWVpl& vpl : vpls) {
        std::size_t cell = 0;
        for (int a = 2; a >= 0; --a)
            cell = cell * kSize + std::size_t((double(vpl.position[a]) + 0.5) * kSize + 0.5 * double(vpl.normal[a]));
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t b = 0; b < 4; ++b)
                sums[(4 * c + b) * kSize * kSize * kSize + cell] +=
                    double(vpl.flux[c]) / kPi * (b ? std::sqrt(kPi / 3) * double(vpl.normal[b - 1]) : std::sqrt(kPi) / 2);
    }
    LpvCells cells(kSize);
    for (std::size_t i = 0; i < sums.size(); ++i) cells.values[i] = float(sums[i]);
    return cells;
}

double floorProfile(double x, double z) { return 1.0 + x + 2.0 * z * z; }

}  // namespace

TEST_CASE("VPLs are injected as sums in double say, in any order, at any width, to the bit", "[lpv_grid]") {
    const LpvPlacement placement = cube(0, 0, 0, 1);
    std::vector<LWVpl> vpls = scattered(3001);
    GridRig wide(16), narrow(1);
    const LpvCells cells = wide.inject({}, vpls, placement);
    CHECK(wide.outside() == 0);
    CHECK(disagreement(cells.values, twin(vpls).values, kRounding) == "");
    for (int c = 0; c < 3; ++c) {
        double flux = 0.0;
        for (const LWVpl& vpl : vpls) flux += double(vpl.flux[c]);
        // A lobe's flux is 4 pi Y0 times its first coefficient.
        CHECK(cells.sum(4 * c) * 2.0 * std::sqrt(kPi) == Approx(flux).epsilon(1e-7));
    }
    CHECK(bitDifference(narrow.inject({}, vpls, placement).values, cells.values) == "");
    std::reverse(vpls.begin(), vpls.end());
    CHECK(bitDifference(wide.inject({}, vpls, placement).values, cells.values) == "");
    std::shuffle(vpls.begin(), vpls.end(), std::mt19937(5));
    for (int run = 0; run < 3; ++run) CHECK(bitDifference(wide.inject({}, vpls, placement).values, cells.values) == "");
}

TEST_CASE("every texel's flux arrives, half a cell above its surface", "[lpv_grid]") {
    GridRig rig(GENERATE(1u, 16u));
    LitFloor first(40, floorProfile), second(24, floorProfile);
    const LpvPlacement placement = cube(0, 0, 0.5f, 2);
    const LpvCells cells = rig.inject({first.light, second.light}, {}, placement);
    CHECK(rig.outside() == 0);
    double flux = 0.0, layer = 0.0;
    for (LitFloor* floor : {&first, &second})
        for (std::uint32_t j = 0; j < floor->flux.height(); ++j)
            for (std::uint32_t i = 0; i < floor->flux.width(); ++i) flux += floor->flux.get(i, j).x;
    // The floor is y = 0, the border of layers 7 and 8.
    for (int z = 0; z < kSize; ++z)
        for (int x = 0; x < kSize; ++x) layer += double(cells.at(0, x, 8, z));
    for (int c = 0; c < 3; ++c) {
        CHECK(cells.sum(4 * c) * 2.0 * std::sqrt(kPi) == Approx(flux).epsilon(1e-6));
        CHECK(cells.sum(4 * c + 2) == Approx(flux * std::sqrt(kPi / 3) / kPi).epsilon(1e-6));
        CHECK(cells.sum(4 * c + 1) == 0.0);
    }
    CHECK(layer == Approx(cells.sum(0)).epsilon(1e-12));
    // A lamp that goes out leaves nothing behind.
    CHECK(rig.inject({}, {}, placement).sum(0) == 0.0);
}

TEST_CASE("lights beyond the grid are counted, and fluxes of any size arrive", "[lpv_grid]") {
    GridRig rig(16);
    std::vector<LWVpl> vpls = scattered(200);
    for (std::size_t i = 0; i < vpls.size(); ++i)
        if (i % 4 == 0) vpls[i].position[i % 3] += 3.0f;
    rig.inject({}, vpls, cube(0, 0, 0, 1));
    CHECK(rig.outside() == 50);
    const double scale = GENERATE(1e-30, 1e-10, 1.0, 1e10, 1e26);
    CAPTURE(scale);
    vpls = scattered(200);
    const LpvCells one = rig.inject({}, vpls, cube(0, 0, 0, 1));
    for (LWVpl& vpl : vpls)
        for (float& f : vpl.flux) f = float(double(f) * scale);
    LpvCells scaled = rig.inject({}, vpls, cube(0, 0, 0, 1));
    for (float& v : scaled.values) v = float(double(v) / scale);
    CHECK(disagreement(scaled.values, one.values, kRounding) == "");
}

TEST_CASE("a fitted grid holds its box, stays while it can, moves by whole cells", "[lpv_grid]") {
    GridRig rig(GENERATE(1u, 16u));
    const auto boxed = [](double x, double extent) {
        std::vector<LWVpl> vpls = scattered(2);
        for (int a = 0; a < 3; ++a) {
            vpls[0].position[a] = float(a == 0 ? x : 5.0);
            vpls[1].position[a] = vpls[0].position[a] + float(a == 0 ? extent : 0.5 * extent);
        }
        return vpls;
    };
    LpvPlacement placement;
    const auto placed = [&](double x, double extent) {
        rig.inject({}, boxed(x, extent), placement);
        CHECK(rig.outside() == 0);
        return rig.place();
    };
    const LwLpvPlace start = placed(0.0, 14.0);
    // 14 cells, and 5 % between the box and the border.
    CHECK(start.cell.s[0] == Approx(1.05));
    CHECK(start.origin.s[0] == Approx(7.0 - 8.0 * 1.05));
    CHECK(start.origin.s[3] == Approx(1.0 / 1.05));
    CHECK(placed(0.3, 14.0).origin.s[0] == start.origin.s[0]);
    CHECK(placed(0.3, 11.5).cell.s[0] == start.cell.s[0]);
    const LwLpvPlace moved = placed(4.0, 14.0);
    CHECK(moved.cell.s[0] == start.cell.s[0]);
    CHECK(moved.origin.s[1] == start.origin.s[1]);
    const double cells = double(moved.origin.s[0] - start.origin.s[0]) / 1.05;
    CHECK(cells == Approx(4.0).margin(1e-5));
    CHECK(placed(0.0, 7.0).cell.s[0] == Approx(0.525));
    CHECK(placed(0.0, 28.0).cell.s[0] == Approx(2.1));
    CHECK(placed(0.0, 24.0).cell.s[0] == Approx(2.1));
    placement.refit = true;
    CHECK(placed(0.0, 24.0).cell.s[0] == Approx(1.8));
    // A box of the host's joins in; without light or box a refitted grid is none.
    placement.hasBox = true;
    placement.low[0] = -100.0f;
    CHECK(placed(0.0, 12.0).cell.s[0] == Approx(112.0 * 1.05 / 14.0));
    placement.hasBox = false;
    rig.inject({}, {}, placement);
    CHECK(rig.place().origin.s[3] == 0.0f);
}

TEST_CASE("what RSMs see counts whether it is lit or not", "[lpv_grid]") {
    GridRig rig(16);
    LitFloor floor(32, [](double x, double) { return x < 0.0 ? 1.0 : 0.0; });
    rig.inject({floor.light}, {}, {});
    CHECK(rig.outside() == 0);
    // Texel centres, 31/32 apart.
    CHECK(rig.place().cell.s[0] == Approx(31.0 / 32.0 * 1.05 / 14.0));
    CHECK(rig.place().origin.s[0] == Approx(-8.0 * 31.0 / 32.0 * 1.05 / 14.0));
}
