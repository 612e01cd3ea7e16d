// What surfels block between the cells of a grid: against sums in double, what a wall lets through, and when it is made anew.
#include "passes/lpv_blocking.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/lpv_surfels.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::LpvWalls;

namespace {

constexpr int kSize = 16;
// Areas through radii of floats, and differences from 1.
constexpr double kRounding = 3e-6;

std::vector<float> expectedFaces(const LpvWalls& walls) {
    std::vector<float> result;
    for (int plane = 0; plane < LW_LPV_FACE_PLANES; ++plane) {
        const int axis = plane / LW_LPV_WAYS, way = plane % LW_LPV_WAYS;
        const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
        double d[3] = {0, 0, 0};
        d[axis] = way ? 2.0 / std::sqrt(5.0) : 1.0;
        if (way) d[way < 3 ? u : v] = (way % 2 ? 1.0 : -1.0) / std::sqrt(5.0);
        for (int z = 0; z < kSize; ++z)
            for (int y = 0; y < kSize; ++y)
                for (int x = 0; x < kSize; ++x) {
                    const int cell[3] = {x, y, z};
                    result.push_back(float(walls.through(axis, cell, d)));
                }
    }
    return result;
}

float faceAt(const std::vector<float>& faces, int plane, int x, int y, int z) {
    return faces[std::size_t(((plane * kSize + z) * kSize + y) * kSize + x)];
}

}  // namespace

TEST_CASE("faces let through what sums in double say, in any order, at any width, to the bit", "[lpv_blocking]") {
    std::vector<LpvSurfel> surfels = randomLpvSurfels(kSize, 3001, 0.9);
    LpvSurfelRig wide(16, kSize), narrow(1, kSize);
    wide.block(surfels);
    const std::vector<float> faces = wide.faces();
    const std::vector<float> expected = expectedFaces(wallsOf(kSize, surfels));
    CHECK(disagreement(faces, expected, kRounding) == "");
    CHECK(*std::min_element(faces.begin(), faces.end()) < 0.1f);
    narrow.block(surfels);
    CHECK(bitDifference(narrow.faces(), faces) == "");
    std::shuffle(surfels.begin(), surfels.end(), std::mt19937(5));
    wide.block(surfels, {}, 2);
    CHECK(bitDifference(wide.faces(), faces) == "");
}

TEST_CASE("a full wall lets nothing through; what it leaves open it lets through", "[lpv_blocking][large]") {
    LpvSurfelRig rig(16, kSize);
    const int axis = GENERATE(0, 1, 2);
    const double sign = GENERATE(-1.0, 1.0);
    std::vector<LpvSurfel> surfels;
    const double covered = GENERATE(1.0, 0.4);
    addLpvWall(surfels, kSize, axis, 6.2, sign);
    // A wall thinner than a cell, with surfels on both of its sides, is one wall.
    const bool isTwice = GENERATE(false, true);
    if (isTwice) addLpvWall(surfels, kSize, axis, 5.9, -sign);
    for (LpvSurfel& s : surfels) s.area *= covered;
    rig.block(surfels);
    const std::vector<float> faces = rig.faces();
    const double full = 0.25 + 1.0 / std::sqrt(5.0), sheets = (isTwice ? 2.0 : 1.0) * covered;
    const double straight = std::max(0.0, 1.0 - sheets * 0.75 / full), side = std::max(0.0, 1.0 - sheets);
    for (int way = 0; way < LW_LPV_WAYS; ++way) {
        const auto at = [&](int layer) {
            int cell[3] = {7, 8, 9};
            cell[axis] = layer;
            return double(faceAt(faces, LW_LPV_WAYS * axis + way, cell[0], cell[1], cell[2]));
        };
        CHECK(at(6) == Approx(way ? side : straight).margin(1e-6));
        CHECK(at(5) == 1.0);
        CHECK(at(7) == 1.0);
    }
}

TEST_CASE("views of one wall are merged, not added up; each corner takes the view that blocks more", "[lpv_blocking]") {
    LpvSurfelRig rig(GENERATE(1u, 16u), kSize);
    std::vector<LpvSurfel> first, second;
    addLpvWall(first, kSize, 0, 6.0);
    for (LpvSurfel& s : first) s.area *= 0.4;
    second = first;
    for (LpvSurfel& s : second) s.area *= s.place[1] < 8.0 ? 0.5 : 1.5;
    std::vector<LpvSurfel> both = first;
    both.insert(both.end(), second.begin(), second.end());
    const auto count = std::uint32_t(first.size());
    rig.block(both, {{0, count}, {count, count}});
    LpvWalls merged = wallsOf(kSize, first);
    const LpvWalls other = wallsOf(kSize, second);
    for (std::size_t i = 0; i < merged.corners.size(); ++i)
        if (other.corners[i][0] > merged.corners[i][0]) merged.corners[i] = other.corners[i];
    CHECK(disagreement(rig.faces(), expectedFaces(merged), kRounding) == "");
}

TEST_CASE("runs of cells say whether anything is at their corners", "[lpv_blocking][large]") {
    LpvSurfelRig rig(16, 32);
    rig.block({{{20.3, 9.8, 11.1}, {1, 0, 0}, 1.0}, {{15.8, 3.0, 4.0}, {0, 1, 0}, 1.0}});
    const std::vector<cl_int> runs = rig.runs();
    int marked = 0;
    for (const cl_int run : runs) marked += run;
    const auto at = [&](int run, int y, int z) { return runs[std::size_t((z * 32 + y) * 2 + run)]; };
    // Corner (20, 10, 11), in the second run only; corner (16, 3, 4), in both.
    for (int dz = -1; dz <= 0; ++dz)
        for (int dy = -1; dy <= 0; ++dy) {
            CHECK(at(1, 10 + dy, 11 + dz) == 1);
            CHECK(at(0, 3 + dy, 4 + dz) == 1);
            CHECK(at(1, 3 + dy, 4 + dz) == 1);
        }
    CHECK(marked == 12);
}

TEST_CASE("blockers are kept as long as surfels and grid stay, and made anew when either changes", "[lpv_blocking][large]") {
    LpvSurfelRig rig(16, kSize);
    const std::vector<LpvSurfel> some = randomLpvSurfels(kSize, 500, 2.0);
    std::vector<LpvSurfel> others = some;
    for (LpvSurfel& s : others) s.place[0] = kSize - s.place[0];
    rig.block(some);
    const std::vector<float> faces = rig.faces();
    // The same revision: nobody looks at the surfels.
    rig.block(others);
    CHECK(bitDifference(rig.faces(), faces) == "");
    rig.block(others, {}, 2);
    CHECK(disagreement(rig.faces(), expectedFaces(wallsOf(kSize, others)), kRounding) == "");
    // Two cells on.
    std::vector<LpvSurfel> moved = others;
    for (LpvSurfel& s : moved) s.place[0] -= 2.0;
    rig.block(others, {}, 2, 1.0);
    CHECK(disagreement(rig.faces(), expectedFaces(wallsOf(kSize, moved)), kRounding) == "");
    rig.block({}, {}, 3);
    CHECK(rig.faces() == std::vector<float>(faces.size(), 1.0f));
    rig.block(some, {}, 4);
    CHECK(bitDifference(rig.faces(), faces) == "");
    rig.pass.forget();
    rig.block(others, {}, 4);
    CHECK(disagreement(rig.faces(), expectedFaces(wallsOf(kSize, others)), kRounding) == "");
}

TEST_CASE("surfels beyond the grid are counted, and ones larger than four cells' sides block no more", "[lpv_blocking]") {
    LpvSurfelRig rig(16, kSize);
    std::vector<LpvSurfel> surfels = randomLpvSurfels(kSize, 100, 1.0);
    for (std::size_t i = 0; i < 30; ++i) surfels[i].place[i % 3] = i % 2 ? -0.6 : kSize + 0.6;
    rig.block(surfels);
    LwLpvBlockers state;
    rig.pass.state().download(0, sizeof state, &state);
    CHECK(state.surfelsOutside == 30);
    std::vector<LpvSurfel> large = {{{8.0, 8.0, 8.0}, {0, 0, 1}, 1e9}}, four = large;
    four[0].area = 4.0;
    rig.block(large, {}, 2);
    CHECK(disagreement(rig.faces(), expectedFaces(wallsOf(kSize, four)), kRounding) == "");
}
