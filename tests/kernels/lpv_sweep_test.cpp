// Sweeps: against light by light in double, conservation, walls, and planes that must not light themselves.
#include "passes/lpv_sweep.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "reference/sweep_twin.h"
#include "support/lit_room.h"
#include "support/sweep_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::SweepTwin;
using reference::Vec;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kSize = 16;

LpvSweepOptions optionsOf(std::uint32_t directions, std::uint32_t size = kSize, std::uint32_t bounces = 1,
                          std::uint32_t frames = 1) {
    LpvSweepOptions options;
    options.size = size;
    options.directions = directions;
    options.bounces = bounces;
    options.frames = frames;
    return options;
}

// A normal of the set that the kernels know exactly.
std::array<double, 3> someNormal(std::mt19937& random) {
    std::uniform_int_distribution<int> three(-1, 1);
    for (;;) {
        const std::array<double, 3> n = {double(three(random)), double(three(random)), double(three(random))};
        const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        if (length > 0) return {n[0] / length, n[1] / length, n[2] / length};
    }
}

struct Scattered {
    std::vector<lw_vpl> lights;
    std::vector<Disc> discs;
    SweepTwin twin{kSize};

    Scattered(int lightCount, int discCount) {
        std::mt19937 random(3);
        std::uniform_int_distribution<int> cell(0, kSize - 1);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        for (int i = 0; i < lightCount + discCount; ++i) {
            const std::array<int, 3> c = {cell(random), cell(random), cell(random)};
            const auto n = someNormal(random);
            const Vec normal{n[0], n[1], n[2]}, centre{c[0] + 0.5, c[1] + 0.5, c[2] + 0.5};
            if (i < lightCount) {
                const double flux = double(float(std::exp(4.0 * unit(random))));
                lights.push_back(sweepLight(centre - normal * 0.5, normal, {flux, 2.0 * flux, 0.5 * flux}));
                twin.lights.push_back({c, n, flux});
            } else {
                const double area = 0.7 * unit(random);
                discs.push_back({centre + normal * 0.5, normal, area, 0});
                twin.blockers.push_back({c, n, area});
            }
        }
    }
};

void checkAgainst(const SweepTwin& twin, const SweepRig::Parts& parts) {
    double worst = 0.0, most = 0.0;
    for (int axis = 0; axis < 3; ++axis)
        for (int up = 0; up < 2; ++up)
            for (int z = 0; z < kSize; ++z)
                for (int y = 0; y < kSize; ++y)
                    for (int x = 0; x < kSize; ++x) {
                        const double expected = twin.arrived[2 * axis + up][twin.index({x, y, z})];
                        most = std::max(most, expected);
                        worst = std::max(worst, std::abs(parts.arriving(axis, up, 0, x, y, z) - expected));
                        worst = std::max(worst, std::abs(parts.arriving(axis, up, 1, x, y, z) - 2.0 * expected));
                    }
    CHECK(most > 1.0);
    // Shares of light are floats, and multiply along 16 planes.
    CHECK(worst < 1e-5 * most);
}

}  // namespace

TEST_CASE("directions stand for the whole sphere", "[lpv_sweep]") {
    for (const std::uint32_t count : {24u, 48u, 96u, 216u, 384u, 864u, 1536u}) {
        CAPTURE(count);
        const auto set = sweepDirections(count);
        REQUIRE(set.size() == count);
        double total = 0.0;
        std::array<double, 3> mean{}, facing{};
        for (const SweepDirection& s : set) {
            total += s.weight;
            CHECK(s.d[0] * s.d[0] + s.d[1] * s.d[1] + s.d[2] * s.d[2] == Approx(1.0).epsilon(1e-12));
            for (std::size_t a = 0; a < 3; ++a) {
                mean[a] += s.weight * s.d[a];
                facing[a] += s.weight * std::max(0.0, s.d[a]);
            }
        }
        CHECK(total == Approx(4.0 * kPi).epsilon(1e-12));
        // Even light of radiance 1 on an axis: pi.
        const double tolerance = count < 96 ? 1e-5 : count == 96 ? 0.0125 : count == 216 ? 0.0055 : 0.0035;
        for (std::size_t a = 0; a < 3; ++a) {
            CHECK(mean[a] == Approx(0.0).margin(1e-12));
            CHECK(facing[a] == Approx(kPi).epsilon(tolerance));
        }
    }
}

TEST_CASE("what arrives is what sums in double say", "[lpv_sweep]") {
    Scattered scene(300, 300);
    for (const SweepDirection& s : sweepDirections(24)) scene.twin.sweep(s.d, s.weight);
    SweepRig rig(16, optionsOf(24));
    rig.sweep(scene.lights, scene.discs);
    CHECK(rig.pass.bytes() == LpvSweep::estimateBytes(optionsOf(24)));
    checkAgainst(scene.twin, rig.parts());
}

TEST_CASE("the same bits arrive at both widths", "[lpv_sweep][large]") {
    Scattered scene(300, 300);
    for (const SweepDirection& s : sweepDirections(96)) scene.twin.sweep(s.d, s.weight);
    SweepRig wide(16, optionsOf(96)), narrow(1, optionsOf(96));
    wide.sweep(scene.lights, scene.discs);
    narrow.sweep(scene.lights, scene.discs);
    const auto parts = wide.parts();
    CHECK(bitDifference(narrow.parts().values, parts.values) == "");
    checkAgainst(scene.twin, parts);
}

TEST_CASE("lights may come in any order, and directions over many frames: the same bits", "[lpv_sweep][large]") {
    Scattered scene(500, 200);
    SweepRig rig(16, optionsOf(48));
    rig.sweep(scene.lights, scene.discs);
    const std::vector<float> first = rig.parts().values;
    std::shuffle(scene.lights.begin(), scene.lights.end(), std::mt19937(5));
    std::shuffle(scene.discs.begin(), scene.discs.end(), std::mt19937(6));
    rig.sweep(scene.lights, scene.discs);
    CHECK(bitDifference(rig.parts().values, first) == "");

    const std::vector<Vec> points = {{3.2, 7.0, 5.1}, {11.7, 2.2, 9.4}, {8.0, 8.0, 8.0}};
    const std::uint32_t bounces = GENERATE(1u, 2u), frames = GENERATE(2u, 8u);
    SweepRig at_once(16, optionsOf(48, kSize, bounces)), spread(16, optionsOf(48, kSize, bounces, frames));
    at_once.sweep(scene.lights, scene.discs);
    const auto expected = at_once.read(points, {0, 0.6, 0.8});
    spread.sweep({}, scene.discs);
    CHECK(spread.read(points, {0, 0.6, 0.8}) == std::vector<double>(3));
    for (std::uint32_t i = 0; i < bounces * frames; ++i) {
        CHECK(spread.read(points, {0, 0.6, 0.8}) == std::vector<double>(3));
        spread.sweep(scene.lights, scene.discs, false);
    }
    CHECK(spread.read(points, {0, 0.6, 0.8}) == expected);
    CHECK(spread.pass.bytes() == LpvSweep::estimateBytes(optionsOf(48, kSize, bounces, frames)));
}

TEST_CASE("every plane that light crosses has all of it, until it leaves at a side", "[lpv_sweep][large]") {
    const std::uint32_t count = 384;
    SweepRig rig(16, optionsOf(count));
    const Vec normal = reference::unit({1, 1, 0});
    rig.sweep({sweepLight(Vec{8.5, 8.5, 8.5} - normal * 0.5, normal, {7, 7, 7})}, {});
    const auto parts = rig.parts();
    const auto set = sweepDirections(count);
    for (int group = 0; group < LW_SWEEP_GROUPS; ++group) {
        const int axis = group / 8, up = group >> axis & 1;
        double sent = 0.0;
        for (std::uint32_t i = 0; i < count / LW_SWEEP_GROUPS; ++i) {
            const SweepDirection& s = set[std::size_t(group) * (count / LW_SWEEP_GROUPS) + i];
            sent += 7.0 / kPi * s.weight * std::max(0.0, s.d[0] * normal.x + s.d[1] * normal.y + s.d[2] * normal.z);
        }
        // 7 planes on, light has moved 7 cells aside at most.
        for (int step = 1; step <= 7; ++step) {
            const int plane = up ? 8 + step : 8 - step;
            double sum = 0.0;
            for (int i = 0; i < kSize; ++i)
                for (int j = 0; j < kSize; ++j) {
                    const int at[3] = {axis == 0 ? plane : i, axis == 0 ? i : axis == 1 ? plane : j, axis == 2 ? plane : j};
                    sum += parts.at(group, axis, 2, at[0], at[1], at[2]);
                }
            CAPTURE(group, step);
            CHECK(sum == Approx(sent).epsilon(1e-5).margin(1e-9));
        }
    }
}

TEST_CASE("a closed wall stops all light, and is dark and lit where it should be", "[lpv_sweep][large]") {
    SweepRig rig(16, optionsOf(384));
    std::vector<lw_vpl> lights;
    std::vector<Disc> wall;
    const double place = GENERATE(8.0, 8.3, 8.5, 8.7);
    const bool facesLight = GENERATE(true, false);
    const Vec x{16, 0, 0}, y{0, 16, 0};
    addEmitter(lights, {0, 0, 0}, x, y, 0.25);
    addDiscs(wall, {0, 0, place}, facesLight ? y : x, facesLight ? x : y, 0.25);
    rig.sweep(lights, wall);
    const std::vector<Vec> below = {{8, 8, place}, {6.2, 9.1, place}}, behind = {{8, 8, 15.0}, {8, 8, 10.5}, {8, 8, 12.0}};
    const auto lit = rig.read(below, {0, 0, -1}), dark = rig.read(behind, {0, 0, -1});
    CAPTURE(place, facesLight);
    for (std::size_t i = 0; i < 2; ++i) {
        const double truth = polygonIrradiance({{0, 0, 0}, {16, 0, 0}, {16, 16, 0}, {0, 16, 0}}, below[i], {0, 0, -1}, 1.0);
        // The wall's cells are closed: what is between them and the last open ones is not interpolated.
        // Where its normal looks away, the closed cell is the one before it, and the first open one a cell further.
        CHECK(lit[i] == Approx(truth).epsilon(facesLight ? 0.08 : 0.18));
    }
    for (const double e : dark) CHECK(e < 5e-6);
}

TEST_CASE("a wall that covers half of its cells lets half of the light through", "[lpv_sweep][large]") {
    SweepRig rig(16, optionsOf(384));
    std::vector<lw_vpl> lights;
    std::vector<Disc> wall;
    addEmitter(lights, {0, 0, 0}, {16, 0, 0}, {0, 16, 0}, 0.25);
    addDiscs(wall, {0, 0, 8}, {0, 16, 0}, {16, 0, 0}, 0.25);
    const std::vector<Vec> behind = {{8, 8, 15.0}, {3, 12, 12.0}, {8, 8, 11.5}};
    rig.sweep(lights, {});
    const auto open = rig.read(behind, {0, 0, -1});
    for (const double share : {0.9, 0.5, 0.1}) {
        std::vector<Disc> screen = wall;
        for (Disc& disc : screen) disc.area *= share;
        rig.sweep(lights, screen);
        const auto found = rig.read(behind, {0, 0, -1});
        CAPTURE(share);
        // Nearer than three cells the second reading is before the wall.
        for (std::size_t i = 0; i < behind.size(); ++i) CHECK(found[i] / open[i] == Approx(1.0 - share).epsilon(0.03));
    }
}

TEST_CASE("a lit plane does not light itself", "[lpv_sweep][large]") {
    SweepRig rig(16, optionsOf(384));
    const double place = GENERATE(4.0, 4.4, 4.8);
    std::vector<lw_vpl> lights;
    std::vector<Disc> discs;
    addEmitter(lights, {0, 0, place}, {16, 0, 0}, {0, 16, 0}, 0.25);
    addDiscs(discs, {0, 0, place}, {16, 0, 0}, {0, 16, 0}, 0.25);
    rig.sweep(lights, discs);
    CHECK(rig.read({{8, 8, place}}, {0, 0, 1})[0] == 0.0);
    const Vec above{8, 8, place + 4};
    const double truth = polygonIrradiance({{0, 0, place}, {16, 0, place}, {16, 16, place}, {0, 16, place}}, above, {0, 0, -1}, 1.0);
    CHECK(rig.read({above}, {0, 0, -1})[0] == Approx(truth).epsilon(0.05));
}

// A closed furnace of exitance 1 and albedo rho: each bounce brings rho times the one before, everywhere.
TEST_CASE("bounces in a closed furnace are a geometric series", "[lpv_sweep][large]") {
    std::vector<lw_vpl> lights;
    std::vector<Disc> discs;
    const double low = 2.0, side = 12.0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (int far = 0; far < 2; ++far) {
            double corner[3] = {low, low, low}, u[3] = {}, v[3] = {};
            corner[axis] = far ? low + side : low;
            u[(axis + 1) % 3] = v[(axis + 2) % 3] = side;
            const Vec p{corner[0], corner[1], corner[2]}, a{u[0], u[1], u[2]}, b{v[0], v[1], v[2]};
            addDiscs(discs, p, far ? b : a, far ? a : b, 0.25);
        }
    const double albedo = 512.0 / 1023.0;
    for (Disc& disc : discs) {
        disc.albedo = 512u | 512u << 10 | 512u << 20;
        lights.push_back(sweepLight(disc.centre, disc.normal, {disc.area, disc.area, disc.area}));
    }
    std::vector<Vec> points;
    for (int j = 0; j < 12; ++j)
        for (int i = 0; i < 12; ++i) points.push_back({low, low + i + 0.5, low + j + 0.5});
    double before = 0.0, last = 1.0 / albedo;
    for (const std::uint32_t bounces : {1u, 2u, 3u}) {
        SweepRig rig(16, optionsOf(384, kSize, bounces));
        rig.sweep(lights, discs);
        double mean = 0.0;
        for (const double e : rig.read(points, {1, 0, 0})) mean += e / double(points.size());
        CAPTURE(bounces, mean, before);
        // What is missing: a cell along each edge is part of the walls.
        CHECK(mean - before == Approx(last * albedo).epsilon(0.06));
        last = mean - before;
        before = mean;
    }
}
