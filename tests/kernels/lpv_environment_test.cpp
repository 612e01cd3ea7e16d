// Light from outside of the grid: sweeps against closed forms of what a sky lights through openings, steps against face by face.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "passes/lpv_grid.h"
#include "reference/lpv_twin.h"
#include "support/lit_room.h"
#include "support/lpv_rig.h"
#include "support/sweep_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::LpvTwin;
using reference::Vec;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::uint32_t kSize = 16;
// Of light that 16 planes have interpolated, and of sums over the directions.
constexpr double kRounding = 3e-6;

LpvSweepOptions optionsOf(std::uint32_t directions, std::uint32_t bounces = 1, std::uint32_t frames = 1) {
    LpvSweepOptions options;
    options.size = kSize;
    options.directions = directions;
    options.bounces = bounces;
    options.frames = frames;
    return options;
}

void setSky(SweepRig& rig, float red) {
    rig.environment[0] = red;
    rig.environment[1] = 2.0f * red;
    rig.environment[2] = 0.5f * red;
}

// A box from 2 to 14 on all sides, whose ceiling leaves a square open in its middle. Walls reach `beyond` the edges that they meet
// in, as those of a house do by their thickness.
std::vector<Disc> boxOpenBy(double opening, double beyond = 1.0) {
    const double low = 2.0 - beyond, high = 14.0 + beyond, side = high - low;
    std::vector<Disc> discs;
    addDiscs(discs, {low, low, 2}, {side, 0, 0}, {0, side, 0}, 0.25);
    addDiscs(discs, {2, low, low}, {0, side, 0}, {0, 0, side}, 0.25);
    addDiscs(discs, {14, low, low}, {0, 0, side}, {0, side, 0}, 0.25);
    addDiscs(discs, {low, 2, low}, {0, 0, side}, {side, 0, 0}, 0.25);
    addDiscs(discs, {low, 14, low}, {side, 0, 0}, {0, 0, side}, 0.25);
    const double begin = 8.0 - opening / 2.0, end = 8.0 + opening / 2.0;
    addDiscs(discs, {low, low, 14}, {0, side, 0}, {begin - low, 0, 0}, 0.25);
    addDiscs(discs, {end, low, 14}, {0, side, 0}, {high - end, 0, 0}, 0.25);
    if (opening > 0.0) {
        addDiscs(discs, {begin, low, 14}, {0, begin - low, 0}, {opening, 0, 0}, 0.25);
        addDiscs(discs, {begin, end, 14}, {0, high - end, 0}, {opening, 0, 0}, 0.25);
    }
    return discs;
}

std::vector<Vec> floorPoints() {
    std::vector<Vec> points;
    for (int j = 0; j < 10; ++j)
        for (int i = 0; i < 10; ++i) points.push_back({3.5 + i, 3.5 + j, 2.0});
    return points;
}

}  // namespace

TEST_CASE("an even sky lights everything in an empty grid by pi L", "[lpv_sweep]") {
    const std::uint32_t count = GENERATE(24u, 48u, 96u, 216u, 384u);
    // Of even light on an axis' normal, by the set's own sum in double, which is near pi, or pi itself (docs: 1.2, 0.5, 0.3 %).
    double set = 0.0;
    for (const SweepDirection& d : sweepDirections(count)) set += d.weight * std::max(0.0, d.d[2]);
    CHECK(set == Approx(kPi).epsilon(count == 24 ? 1e-12 : count == 48 ? 1e-5 : count == 96 ? 0.0125 : count == 216 ? 0.0055 : 0.0031));
    SweepRig rig(16, optionsOf(count));
    setSky(rig, 0.7f);
    rig.sweep({}, {});
    CAPTURE(count);
    const std::vector<Vec> points = {{8, 8, 8}, {0.6, 7, 3}, {15.4, 15.4, 0.6}};
    for (const Vec normal : {Vec{0, 0, 1}, Vec{-1, 0, 0}, Vec{0.6, 0.0, -0.8}, Vec{2.0 / 3, -1.0 / 3, 2.0 / 3}})
        for (const double e : rig.read(points, normal)) CHECK(e == Approx(set * 0.7).epsilon(kRounding));
    const auto parts = rig.parts();
    for (int axis = 0; axis < 3; ++axis)
        for (int colour = 0; colour < 3; ++colour)
            CHECK(parts.arriving(axis, 1, colour, 15, 3, 0) ==
                  Approx(set * double(rig.environment[colour])).epsilon(kRounding));
}

TEST_CASE("a sky is linear, and adds to the lights", "[lpv_sweep][large]") {
    std::vector<lw_vpl> lights;
    addEmitter(lights, {3, 4, 2.5}, {4, 0, 0}, {0, 5, 0}, 0.5);
    const std::vector<Disc> discs = boxOpenBy(6.0);
    SweepRig rig(16, optionsOf(96));
    const auto partsOf = [&](const std::vector<lw_vpl>& with, float red) {
        setSky(rig, red);
        rig.sweep(with, discs);
        return rig.parts().values;
    };
    const std::vector<float> none = partsOf(lights, 0.0f), sky = partsOf({}, 0.25f), twice = partsOf({}, 0.5f),
                             both = partsOf(lights, 0.25f);
    for (std::size_t i = 0; i < sky.size(); ++i) REQUIRE(twice[i] == 2.0f * sky[i]);
    double most = 0.0, off = 0.0;
    for (std::size_t i = 0; i < sky.size(); ++i) {
        most = std::max(most, double(both[i]));
        off = std::max(off, std::abs(double(both[i]) - double(none[i]) - double(sky[i])));
    }
    CHECK(off < 1e-6 * most);
    rig.sweep({}, discs);
    SweepRig dark(16, optionsOf(96)), scalar(1, optionsOf(96));
    dark.sweep(lights, discs);
    CHECK(bitDifference(dark.parts().values, none) == "");
    setSky(scalar, 0.25f);
    scalar.sweep(lights, discs);
    CHECK(bitDifference(scalar.parts().values, both) == "");
}

// A floor right across the grid: a point above it sees the sky but for the floor's form factor.
TEST_CASE("a floor hides the sky behind it", "[lpv_sweep][large]") {
    SweepRig rig(16, optionsOf(384));
    setSky(rig, 1.0f);
    std::vector<Disc> discs;
    constexpr double height = 6.0;
    addDiscs(discs, {0, 0, height}, {16, 0, 0}, {0, 16, 0}, 0.25);
    rig.sweep({}, discs);
    const std::vector<Vec> corners = {{0, 0, height}, {16, 0, height}, {16, 16, height}, {0, 16, height}};
    CHECK(rig.read({{8, 8, height}}, {0, 0, 1})[0] == Approx(kPi).epsilon(0.005));
    CHECK(rig.read({{4, 11, 12}}, {0, 0, 1})[0] == Approx(kPi).epsilon(0.005));
    for (const Vec point : {Vec{8, 8, 10}, Vec{8, 8, 13}, Vec{5, 9, 12}}) {
        const double truth = kPi - polygonIrradiance(corners, point, {0, 0, -1}, kPi);
        CAPTURE(point.z, truth);
        CHECK(rig.read({point}, {0, 0, -1})[0] == Approx(truth).epsilon(0.1));
    }
    // Upright surfaces see the sky above the horizon of an endless floor, and here what lies beyond its edge as well: the floor's
    // part in front of them.
    for (const Vec point : {Vec{8, 8, 9}, Vec{8, 8, 12}}) {
        const std::vector<Vec> ahead = {{8, 0, height}, {16, 0, height}, {16, 16, height}, {8, 16, height}};
        const double truth = kPi - polygonIrradiance(ahead, point, {1, 0, 0}, kPi);
        CAPTURE(point.z, truth);
        CHECK(rig.read({point}, {1, 0, 0})[0] == Approx(truth).epsilon(0.1));
    }
}

TEST_CASE("a sky lights a room through its opening as a polygon does, and a closed room not at all", "[lpv_sweep][large]") {
    SweepRig rig(16, optionsOf(384));
    setSky(rig, 1.0f);
    rig.sweep({}, boxOpenBy(0.0));
    const std::vector<Vec> points = floorPoints();
    for (const double e : rig.read(points, {0, 0, 1})) CHECK(e < 5e-6);
    // Where walls end in the edges that they share, light slips through between two closed cells that touch in an edge only.
    rig.sweep({}, boxOpenBy(0.0, 0.0));
    double leak = 0.0;
    for (const double e : rig.read(points, {0, 0, 1})) leak += e / kPi / double(points.size());
    CHECK(leak == Approx(0.046).margin(0.002));
    for (const double opening : {8.0, 4.0}) {
        rig.sweep({}, boxOpenBy(opening));
        const std::vector<double> found = rig.read(points, {0, 0, 1});
        // The ceiling's cells stop light at their centres, half a cell above it, and reading twice takes half a cell more off than
        // the reader's shift had added, since this light was not put in half a cell before its surface: a cell too far in all.
        const double low = 8.0 - opening / 2.0, high = 8.0 + opening / 2.0;
        const auto errorAgainst = [&](double height) {
            double difference = 0.0, truths = 0.0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                const double truth = polygonIrradiance(
                    {{low, low, height}, {high, low, height}, {high, high, height}, {low, high, height}}, points[i], {0, 0, 1}, kPi);
                difference += (found[i] - truth) * (found[i] - truth);
                truths += truth * truth;
            }
            return std::sqrt(difference / truths);
        };
        CAPTURE(opening);
        // A light as small as 4 cells is as wrong in the boxes of lpv_sweep_box_test.cpp.
        CHECK(errorAgainst(15.0) < (opening > 4.0 ? 0.06 : 0.14));
        CHECK(errorAgainst(14.0) < 0.16);
    }
}

// Under an even sky a floor of albedo rho sends rho pi L back: what faces it from above gets as much more as its form factor says.
TEST_CASE("a floor that a sky lights sends its light on in the next bounce", "[lpv_sweep][large]") {
    std::vector<Disc> discs;
    addDiscs(discs, {0, 0, 4}, {16, 0, 0}, {0, 16, 0}, 0.25);
    for (Disc& disc : discs) disc.albedo = 512u | 512u << 10 | 512u << 20;
    const Vec point{8, 8, 9};
    SweepRig one(16, optionsOf(384)), two(16, optionsOf(384, 2)), shared(16, optionsOf(384, 2, 4));
    for (SweepRig* rig : {&one, &two, &shared}) setSky(*rig, 1.0f);
    one.sweep({}, discs);
    two.sweep({}, discs);
    const double factor =
        polygonIrradiance({{0, 0, 4}, {16, 0, 4}, {16, 16, 4}, {0, 16, 4}}, point, {0, 0, -1}, 1.0) * 512.0 / 1023.0;
    const double first = one.read({point}, {0, 0, -1})[0], second = two.read({point}, {0, 0, -1})[0];
    CAPTURE(first, second, factor);
    CHECK(second == Approx(kPi - factor * kPi * 1023.0 / 512.0 + factor * kPi).epsilon(0.06));
    // Over frames: the sky that was there when the first part began.
    shared.sweep({}, discs);
    CHECK(shared.read({point}, {0, 0, -1})[0] == second);
    for (int frame = 0; frame < 8; ++frame) {
        setSky(shared, frame == 0 ? 2.0f : 5.0f);
        shared.sweep({}, discs, false);
    }
    setSky(two, 2.0f);
    two.sweep({}, discs);
    CHECK(shared.read({point}, {0, 0, -1})[0] == two.read({point}, {0, 0, -1})[0]);
}

// Steps: pi L s^2 through each outer face, as lobes about the inward normals.
TEST_CASE("a sky enters through the border's cells", "[lpv_grid]") {
    const std::uint32_t width = GENERATE(1u, 16u);
    KernelRig rig(width);
    LpvGrid grid(rig.device(), kSize);
    RsmInput rsms;
    LWFrame frame{};
    frame.structSize = sizeof frame;
    rsms.import(rig.executor(), frame);
    LpvPlacement placement;
    placement.extent = 4.0f;
    const float sky[3] = {0.7f, 0.0f, 40.0f};
    grid.record(rig.executor(), rsms, nullptr, 0, placement, sky);
    rig.device().finish();
    const LpvCells cells = LpvCells::of(grid.injected(), int(kSize));
    const double side = 4.0 / kSize, faces = 6.0 * kSize * kSize;
    LpvCells expected{int(kSize)};
    const int last = int(kSize) - 1;
    for (int c = 0; c < 3; ++c) {
        CHECK(cells.sum(4 * c) * 2.0 * std::sqrt(kPi) == Approx(faces * kPi * double(sky[c]) * side * side).epsilon(1e-6).margin(1e-30));
        for (int z = 0; z <= last; ++z)
            for (int y = 0; y <= last; ++y)
                for (int x = 0; x <= last; ++x) {
                    std::array<double, 4> lobes{};
                    const int at[3] = {x, y, z};
                    for (int a = 0; a < 3; ++a) {
                        double n[3] = {0, 0, 0};
                        n[a] = at[a] == 0 ? 1.0 : -1.0;
                        if (at[a] == 0 || at[a] == last) LpvTwin::addLobe(lobes, double(sky[c]) * side * side, n[0], n[1], n[2]);
                    }
                    for (int b = 0; b < 4; ++b) expected.at(4 * c + b, x, y, z) = float(lobes[std::size_t(b)]);
                }
    }
    CHECK(disagreement(cells.values, expected.values, 1e-6) == "");
}

// What is wrong with it: the lobes are of two bands, and kappa is that of a plane. Steps of the same light in double, face by face.
TEST_CASE("an even sky in an empty grid of steps is not even", "[lpv_propagation][large]") {
    struct Row {
        int size;
        double centre, away, towards;  // E / (pi L): in the middle, in the second layer facing into the grid and out of it
    };
    for (const Row& row : {Row{16, 0.43, 1.57, 1.68}, Row{32, 0.03, 1.28, 1.35}}) {
        const int n = row.size, steps = 2 * n, last = n - 1;
        LpvTwin injected(n, n, n), now(n, n, n);
        for (int z = 0; z < n; ++z)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x) {
                    const int at[3] = {x, y, z};
                    for (int a = 0; a < 3; ++a) {
                        double normal[3] = {0, 0, 0};
                        normal[a] = at[a] == 0 ? 1.0 : -1.0;
                        if (at[a] == 0 || at[a] == last)
                            LpvTwin::addLobe(injected.at(x, y, z), 1.0, normal[0], normal[1], normal[2]);
                    }
                }
        LpvCells cells(n);
        for (int c = 0; c < LW_LPV_COLOURS; ++c)
            for (int z = 0; z < n; ++z)
                for (int y = 0; y < n; ++y)
                    for (int x = 0; x < n; ++x)
                        for (int b = 0; b < 4; ++b) cells.at(4 * c + b, x, y, z) = float(injected.at(x, y, z)[std::size_t(b)]);
        now = injected;
        for (int i = 0; i < steps; ++i) {
            LpvTwin next = injected;
            now.stepInto(next);
            now = next;
        }
        KernelRig rig(16);
        LpvPropagation pass(rig.device(), std::uint32_t(n));
        const Guarded uploaded = rig.upload(cells.laidOut());
        const Buffer& result = pass.record(rig.executor(), uploaded, std::uint32_t(steps));
        rig.device().finish();
        const LpvCells found = LpvCells::of(result, n);
        const double kappa = LpvPropagation::calibration(std::uint32_t(n), std::uint32_t(steps));
        const auto facing = [&](int x) {  // of a surface that faces +x, read at a cell's centre
            CHECK(double(found.at(0, x, n / 2, n / 2)) == Approx(now.at(x, n / 2, n / 2)[0]).epsilon(1e-5));
            return kappa * (std::sqrt(kPi) / 2.0 * now.at(x, n / 2, n / 2)[0] - std::sqrt(kPi / 3.0) * now.at(x, n / 2, n / 2)[1]) / kPi;
        };
        CAPTURE(n);
        CHECK(facing(n / 2) == Approx(row.centre).margin(0.005));
        CHECK(facing(1) == Approx(row.away).margin(0.005));
        CHECK(facing(n - 2) == Approx(row.towards).margin(0.005));
    }
}
