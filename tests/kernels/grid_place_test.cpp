// Grids that begin at multiples of several cells of their own. Those of whole cells are lpv_cascades_test.cpp's and lpv_grid_test.cpp's.
#include "passes/grid_place.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/kernel_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr std::uint32_t kSize = 32, kUnit = 4, kLevels = 3;

struct PlacesRig : KernelRig {
    explicit PlacesRig(std::uint32_t width) : KernelRig(width), places(device(), kSize, kUnit, kLevels) {}
    RsmInput rsms;
    GridPlaces places;

    void place(const GridPlacement& placement, const std::vector<LWVpl>& vpls = {}) {
        LWFrame frame{};
        frame.structSize = sizeof frame;
        rsms.import(executor(), frame);
        places.record(executor(), rsms, vpls.data(), std::uint32_t(vpls.size()), placement);
        places.recordTable(executor());
        device().finish();
    }
    std::vector<LwGridPlace> table() {
        std::vector<LwGridPlace> result(kLevels);
        places.table().download(0, kLevels * sizeof(LwGridPlace), result.data());
        return result;
    }
};

GridPlacement around(double x, double y, double z, double extent) {
    GridPlacement placement;
    placement.extent = float(extent);
    placement.hasFocus = true;
    placement.focus[0] = float(x);
    placement.focus[1] = float(y);
    placement.focus[2] = float(z);
    return placement;
}

bool same(const LwGridPlace& a, const LwGridPlace& b) {
    for (int i = 0; i < 4; ++i)
        if (a.origin.s[i] != b.origin.s[i]) return false;
    return a.cell.s[0] == b.cell.s[0];
}

std::vector<LWVpl> corners(float low, float high) {
    std::vector<LWVpl> vpls(2);
    for (int a = 0; a < 3; ++a) {
        vpls[0].position[a] = low;
        vpls[1].position[a] = high;
        vpls[0].flux[a] = vpls[1].flux[a] = 1.0f;
    }
    return vpls;
}

}  // namespace

TEST_CASE("grids around a focus begin at multiples of the unit, each of its own cells", "[grid_place]") {
    PlacesRig rig(GENERATE(1u, 16u));
    // Cells of 1, 1/2 and 1/4: units of 4, 2 and 1.
    rig.place(around(0.3, -7.9, 100.4, 32));
    const std::vector<LwGridPlace> at = rig.table();
    const double focus[3] = {0.3, -7.9, 100.4};
    for (std::size_t l = 0; l < kLevels; ++l) {
        const double unit = std::ldexp(1.0, int(l)), side = unit * kSize / kUnit;
        CHECK(double(at[l].cell.s[0]) == unit / kUnit);
        for (std::size_t a = 0; a < 3; ++a) {
            INFO("level " << l << ", axis " << a);
            const double middle = double(at[l].origin.s[a]) + 0.5 * side;
            CHECK(middle == unit * std::floor(focus[a] / unit + 0.5));  // the nearest multiple
        }
    }
    rig.place(around(0.45, -7.6, 100.49, 32));  // within the same units of all three
    for (std::size_t l = 0; l < kLevels; ++l) CHECK(same(rig.table()[l], at[l]));
    rig.place(around(0.55, -7.6, 100.49, 32));  // one further of the finest
    CHECK(rig.table()[0].origin.s[0] == at[0].origin.s[0] + 1.0f);
    CHECK(same(rig.table()[1], at[1]));
    CHECK(same(rig.table()[2], at[2]));
}

TEST_CASE("grids within a fitted one begin at multiples of the unit wherever the focus is, and stay within it", "[grid_place]") {
    PlacesRig rig(16);
    for (const double away : {0.0, 1.9, -1e6, 3e38}) {
        rig.place(around(away, away, -away, 0), corners(-1.0f, 2.0f));
        const std::vector<LwGridPlace> at = rig.table();
        INFO("focus " << away);
        for (std::size_t l = 0; l + 1 < kLevels; ++l)
            for (int a = 0; a < 3; ++a) {
                const float cell = at[l].cell.s[0], outer = at[l + 1].cell.s[0];
                CHECK(cell == 0.5f * outer);
                const float units = at[l].origin.s[a] / cell / kUnit;
                CHECK(units == Approx(std::round(units)).margin(1e-4));
                CHECK(at[l].origin.s[a] >= at[l + 1].origin.s[a] + 0.999f * outer);
                CHECK(at[l].origin.s[a] + kSize * cell <= at[l + 1].origin.s[a] + (kSize - 0.999f) * outer);
            }
    }
}

TEST_CASE("grids stay on the cells of the world where the origin of positions moves", "[grid_place]") {
    PlacesRig rig(GENERATE(1u, 16u));
    const bool isFitted = GENERATE(false, true);
    const double focus[3] = {0.3, -7.9, 2.4};
    const WorldOrigin first{1e7, -3e5, 0.0}, moves[] = {{1e7 + 12.37, -3e5 - 4.71, 8.93}, {1e7 - 700.0, -3e5 + 0.1, 1e3}, {1e7, -3e5, 0.0}};
    const auto placed = [&](const WorldOrigin& origin) {
        rig.executor().setWorldOrigin(origin);
        std::vector<LWVpl> vpls = corners(-9.0f, 11.0f);
        double at[3];
        for (std::size_t a = 0; a < 3; ++a) {
            const double by = first[a] - origin[a];
            at[a] = focus[a] + by;
            for (LWVpl& vpl : vpls) vpl.position[a] = float(double(vpl.position[a]) + by);
        }
        rig.place(around(at[0], at[1], at[2], isFitted ? 0 : 13.3), vpls);
        return rig.table();
    };
    const std::vector<LwGridPlace> before = placed(first);
    for (const WorldOrigin& origin : moves) {
        const std::vector<LwGridPlace> now = placed(origin);
        for (std::size_t l = 0; l < kLevels; ++l)
            for (std::size_t a = 0; a < 3; ++a) {
                INFO("level " << l << ", axis " << a);
                // Rounding of coordinates up to 1000; a cell is 0.1 and more.
                CHECK(double(now[l].origin.s[a]) + origin[a] - first[a] == Approx(double(before[l].origin.s[a])).margin(3e-4));
                CHECK(now[l].cell.s[0] == before[l].cell.s[0]);
            }
    }
}

TEST_CASE("a fitted grid holds what it is fitted to, from however far it comes", "[grid_place]") {
    PlacesRig rig(16u);
    const std::vector<LWVpl> vpls = corners(-9.0f, 11.0f);
    rig.place(around(0, 0, 0, 0), vpls);
    // What is lit is there as well, as after a jump that nobody announces.
    const WorldOrigin jumps[] = {{1e12, -1e9, 3e7}, {3e7, -1e12, 1e9}, {0, 0, 0}};
    for (const WorldOrigin& origin : jumps) {
        rig.executor().setWorldOrigin(origin);
        rig.place(around(0, 0, 0, 0), vpls);
        const LwGridPlace outer = rig.table()[kLevels - 1];
        const double cell = double(outer.cell.s[0]);
        for (std::size_t a = 0; a < 3; ++a) {
            INFO("axis " << a << ", origin " << origin[a]);
            // The middle of the grid is that of the box, to a cell.
            CHECK(std::abs(double(outer.origin.s[a]) + 0.5 * double(kSize) * cell - 1.0) <= 1.01 * cell);
        }
    }
}

TEST_CASE("what places take is what is estimated", "[grid_place]") {
    PlacesRig rig(16);
    rig.place(around(0, 0, 0, 8), corners(-1.0f, 1.0f));
    CHECK(rig.places.bytes() == GridPlaces::estimateBytes(kLevels, 2));
}
