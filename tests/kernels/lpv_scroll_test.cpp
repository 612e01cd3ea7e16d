// Grids that move on by whole cells keep what stays in them: after any walk they hold, to the bit, what a grid made there does.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "inputs/geometry_input.h"
#include "passes/lpv_blocking.h"
#include "passes/lpv_sweep.h"
#include "support/lpv_rig.h"
#include "support/sweep_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr int kSize = 16;
constexpr double kCell = 0.37;  // no power of two: grids' corners are rounded

using Cells = std::array<int, 3>;

LwLpvPlace placeAt(const Cells& corner, float off = 0.0f) {
    LwLpvPlace place{};
    const float cell = float(kCell);
    for (std::size_t a = 0; a < 3; ++a) place.origin.s[a] = cell * (float(corner[a]) + off);
    place.origin.s[3] = 1.0f / cell;
    place.cell = {{cell, std::ldexp(1.0f, 20), std::ldexp(1.0f, 20), 0.0f}};
    return place;
}

// Triangles of all sizes about a cell, a plane that reaches far beyond any grid, and one whose vertices are too far for whole numbers.
struct Scene {
    std::vector<float> vertices;
    LWGeometry geometry{};
    GeometryInput input;

    Scene(const Cells& middle, int count, unsigned seed) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        for (int t = 0; t < count; ++t) {
            const double side = std::pow(2.0, 3.0 * unit(random)), spread = 1.5 * kSize;
            double centre[3];
            for (double& c : centre) c = spread * unit(random);
            for (int k = 0; k < 3; ++k)
                for (std::size_t a = 0; a < 3; ++a) add(middle[a] + centre[a] + side * unit(random));
        }
        for (const double side : {300.0, 4e6})
            for (int k = 0; k < 3; ++k) {
                add(middle[0] + side * (k == 0 ? -1.0 : 1.0));
                add(middle[1] + 0.13 * side / 300.0 * k - 3.3);
                add(middle[2] + side * (k == 1 ? -1.0 : 1.0));
            }
    }
    Scene(const Scene&) = delete;
    void add(double cells) { vertices.push_back(float(kCell * cells)); }
    void import(Executor& executor) {
        geometry.structSize = sizeof geometry;
        geometry.vertices = vertices.data();
        geometry.vertexCount = std::uint32_t(vertices.size() / 3);
        geometry.triangleCount = geometry.vertexCount / 3;
        ++geometry.version;
        input.import(executor, &geometry);
    }
};

struct Stop {
    Cells corner;
    float off;       // of a cell: a corner that is none of the world's
    bool isChanged;  // triangles are
};

// Steps along an axis, along all, jumps within and beyond the grid's side, places between cells; now and then triangles change.
std::vector<Stop> walk(const Cells& middle, int steps, unsigned seed) {
    std::mt19937 random(seed);
    const auto upTo = [&](int n) { return int(random() % unsigned(2 * n + 1)) - n; };
    Cells at = middle;
    for (int& c : at) c -= kSize / 2;
    std::vector<Stop> stops = {{at, 0.0f, false}};
    for (int i = 0; i < steps; ++i) {
        const int kind = int(random() % 8u);
        if (kind < 3)
            at[std::size_t(random() % 3u)] += random() % 2u ? 1 : -1;
        else
            for (int& c : at) c += upTo(kind < 6 ? 2 : kind == 6 ? kSize - 1 : 2 * kSize);
        for (std::size_t a = 0; a < 3; ++a) at[a] = std::min(std::max(at[a], middle[a] - 2 * kSize), middle[a] + kSize);
        stops.push_back({at, random() % 9u == 0u ? 0.3f : 0.0f, random() % 6u == 0u});
    }
    return stops;
}

template <class T>
std::vector<T> contents(const Buffer& buffer) {
    std::vector<T> values(buffer.bytes() / sizeof(T));
    buffer.download(0, buffer.bytes(), values.data());
    return values;
}

bool blocksAlike(const LpvBlocking& a, const LpvBlocking& b) {
    return contents<cl_uint>(a.blockers().faces) == contents<cl_uint>(b.blockers().faces) &&
           contents<cl_int>(a.blockers().runs) == contents<cl_int>(b.blockers().runs);
}

void checkBlockers(const Cells& middle, int triangles, int steps) {
    KernelRig rig(GENERATE(1u, 16u));
    Scene scene(middle, triangles, 3);
    scene.import(rig.executor());
    LpvBlocking kept(rig.device(), kSize);
    int blocked = 0, i = 0;
    for (const Stop& stop : walk(middle, steps, 11)) {
        if (stop.isChanged) {
            scene.vertices[std::size_t(9 * (i % triangles))] += 1.0f;
            scene.import(rig.executor());
        }
        const Guarded place = rig.upload(std::vector<LwLpvPlace>{placeAt(stop.corner, stop.off)});
        LpvBlocking fresh(rig.device(), kSize);
        kept.record(rig.executor(), scene.input, place);
        fresh.record(rig.executor(), scene.input, place);
        rig.device().finish();
        INFO("stop " << i << " at " << stop.corner[0] << " " << stop.corner[1] << " " << stop.corner[2] << " off " << stop.off);
        REQUIRE(blocksAlike(kept, fresh));
        for (const cl_int run : contents<cl_int>(fresh.blockers().runs)) blocked += run;
        ++i;
    }
    CHECK(blocked > 10 * steps);
}

// A light in the middle of the grid.
lw_vpl lightIn(const Cells& corner) {
    const auto at = [&](std::size_t a) { return kCell * (corner[a] + kSize / 2 + 0.3); };
    return sweepLight({at(0), at(1), at(2)}, {0.6, 0.0, 0.8}, {3.0, 2.0, 1.0});
}

struct Sweeper {
    RsmInput rsms;
    LpvSweep pass;
    explicit Sweeper(Device& device) : pass(device, optionsOf()) {}
    static LpvSweepOptions optionsOf() {
        LpvSweepOptions options;
        options.size = kSize;
        options.directions = 96;
        return options;
    }
    void record(Executor& executor, const GeometryInput& triangles, const Buffer& place, const Buffer& lights, std::uint32_t count) {
        pass.record(executor, {rsms, lights, count, place, SurfelSet{}, 1.0f, false, nullptr, &triangles, nullptr});
    }
    std::vector<cl_uint> parts() const { return contents<cl_uint>(pass.parts()); }
};

void checkSweeps(const Cells& middle, int triangles, int steps) {
    KernelRig rig(GENERATE(1u, 16u));
    Scene scene(middle, triangles, 5);
    scene.import(rig.executor());
    Sweeper kept(rig.device());
    int i = 0;
    for (const Stop& stop : walk(middle, steps, 23)) {
        if (stop.isChanged) {
            scene.vertices[std::size_t(9 * (i % triangles))] += 1.0f;
            scene.import(rig.executor());
        }
        const Guarded place = rig.upload(std::vector<LwLpvPlace>{placeAt(stop.corner, stop.off)}),
                      lights = rig.upload(std::vector<lw_vpl>{lightIn(stop.corner)});
        Sweeper fresh(rig.device());
        kept.record(rig.executor(), scene.input, place, lights, 1);
        fresh.record(rig.executor(), scene.input, place, lights, 1);
        rig.device().finish();
        INFO("stop " << i << " at " << stop.corner[0] << " " << stop.corner[1] << " " << stop.corner[2] << " off " << stop.off);
        REQUIRE(kept.parts() == fresh.parts());
        ++i;
    }
}

// Walls along the axes, five cells off their middle, that face outwards: what they cover, half a cell behind them, has no gaps at edges.
struct Box : Scene {
    explicit Box(const Cells& middle) : Scene(middle, 0, 0) {
        vertices.clear();
        constexpr double kHalf = 4.9;
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const double side : {-kHalf, kHalf})
                for (int i = 0; i < 6; ++i) {
                    constexpr int kCorners[] = {0, 1, 3, 0, 3, 2};
                    const int k = kCorners[side > 0.0 ? i : 5 - i];
                    double p[3];
                    p[axis] = side;
                    p[(axis + 1) % 3] = k % 2 ? kHalf : -kHalf;
                    p[(axis + 2) % 3] = k / 2 ? kHalf : -kHalf;
                    for (std::size_t a = 0; a < 3; ++a) add(middle[a] + p[a]);
                }
    }
};

const Cells kNear = {3, -7, 2}, kFar = {100000, -90000, 70000};

}  // namespace

TEST_CASE("blockers of a grid that moved by whole cells are those of a grid made there, to the bit", "[lpv_scroll]") {
    checkBlockers(kNear, 12, 2);
}

TEST_CASE("blockers after a long walk are those of a grid made there, to the bit, also far from the world's origin", "[lpv_scroll][large]") {
    checkBlockers(GENERATE(kNear, kFar), 400, 60);
}

TEST_CASE("what covers a sweep's cells after a walk is what a sweep made there has, to the bit", "[lpv_scroll][large]") {
    checkSweeps(GENERATE(kNear, kFar), 400, 40);
}

// Triangles that are gone behind the pass's back show what it looks at.
TEST_CASE("a grid that moves by a cell looks at no triangle for the cells that stay", "[lpv_scroll][large]") {
    KernelRig rig(16);
    Scene scene(kNear, 400, 3);
    scene.import(rig.executor());
    const Cells corner = {kNear[0] - 8, kNear[1] - 8, kNear[2] - 8}, next = {corner[0] + 1, corner[1], corner[2]};
    const Guarded here = rig.upload(std::vector<LwLpvPlace>{placeAt(corner)}), there = rig.upload(std::vector<LwLpvPlace>{placeAt(next)});
    LpvBlocking pass(rig.device(), kSize);
    pass.record(rig.executor(), scene.input, here);
    rig.device().finish();
    const std::vector<float> before = contents<float>(pass.blockers().faces);
    scene.input.triangleCount = 0;
    pass.record(rig.executor(), scene.input, there);
    rig.device().finish();
    const std::vector<float> after = contents<float>(pass.blockers().faces);
    int others = 0, open = 0;
    for (int plane = 0; plane < LW_LPV_FACE_PLANES; ++plane)
        for (int z = 0; z < kSize; ++z)
            for (int y = 0; y < kSize; ++y) {
                const auto at = [&](int x) { return std::size_t(plane * lpv_plane(kSize) + lpv_cell(kSize, x, y, z)); };
                for (int x = 0; x + 1 < kSize; ++x) others += after[at(x)] != before[at(x + 1)];
                if (plane < LW_LPV_WAYS) open += after[at(kSize - 1)] == before[at(kSize - 1)];
            }
    // A face across x of the last cell has corners that stayed, as has one of the last but one; those across y and z lean on new ones.
    CHECK(others == 0);
    CHECK(open < 16 * 16 * LW_LPV_WAYS);
}

TEST_CASE("a closed box lets no light out after any walk", "[lpv_scroll][large]") {
    KernelRig rig(16);
    const Cells middle = GENERATE(kNear, kFar);
    Box box(middle);
    box.import(rig.executor());
    Sweeper kept(rig.device());
    const Cells light = {middle[0] - kSize / 2, middle[1] - kSize / 2, middle[2] - kSize / 2};
    const Guarded lights = rig.upload(std::vector<lw_vpl>{lightIn(light)});
    int outside = 0;
    for (const Cells& off : {Cells{0, 0, 0}, Cells{1, 0, 0}, Cells{2, 1, -1}, Cells{2, 1, -2}, Cells{-1, -1, 1}, Cells{-2, -2, -2}}) {
        const Cells corner = {light[0] + off[0], light[1] + off[1], light[2] + off[2]};
        const Guarded place = rig.upload(std::vector<LwLpvPlace>{placeAt(corner)});
        kept.record(rig.executor(), box.input, place, lights, 1);
        rig.device().finish();
        const SweepRig::Parts parts{kSize, contents<float>(kept.pass.parts())};
        double inside = 0.0, leaked = 0.0;
        for (int z = 0; z < kSize; ++z)
            for (int y = 0; y < kSize; ++y)
                for (int x = 0; x < kSize; ++x) {
                    const int local[3] = {x, y, z};
                    int farthest = 0;
                    for (std::size_t a = 0; a < 3; ++a) farthest = std::max(farthest, std::abs(2 * (corner[a] + local[a] - middle[a]) + 1));
                    double sum = 0.0;
                    for (int group = 0; group < LW_SWEEP_GROUPS; ++group) sum += parts.at(group, 0, 0, x, y, z);
                    // Beyond the layer of cells that the walls' area lies in, and the one that it lies behind.
                    if (farthest > 13) leaked += sum, ++outside;
                    else inside += sum;
                }
        INFO("at " << off[0] << " " << off[1] << " " << off[2]);
        CHECK(inside > 0.0);
        CHECK(leaked == 0.0);
    }
    CHECK(outside > 1000);
}
