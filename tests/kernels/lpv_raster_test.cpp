// Triangles as samples on a grid's lattice: each of a sheet's once.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "inputs/geometry_input.h"
#include "passes/vpl_list.h"
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

// All of a grid's cells or corners are to be made.
LwLpvParts allOf(int side) {
    LwLpvParts parts{};
    parts.high[0] = {{side, side, side, 0}};
    parts.count = 1;
    return parts;
}

// Cells of 1/2.
const LwLpvPlace kGrid = placeOf(-1.0, 2.0, 0.5, 0.5);

// Triangles, three vertices each, as kernels get them.
struct Triangles {
    std::vector<float> vertices;
    GeometryInput input;
    void add(const std::array<double, 3>& p) {
        for (const double x : p) vertices.push_back(float(x));
    }
    void import(KernelRig& rig) {
        LWGeometry geometry{};
        geometry.structSize = sizeof geometry;
        geometry.vertices = vertices.data();
        geometry.vertexCount = std::uint32_t(vertices.size() / 3);
        geometry.triangleCount = geometry.vertexCount / 3;
        input.import(rig.executor(), &geometry);
    }

    // Sums of all of a grid's cells, and of all of its corners.
    std::vector<cl_uint> cover(KernelRig& rig, const LwLpvPlace& place) const {
        LwSweepCover stale{};
        stale.stale = 1;
        stale.parts = allOf(kSize);
        const Guarded placed = rig.upload(std::vector<LwLpvPlace>{place}), state = rig.upload(std::vector<LwSweepCover>{stale}),
                      sums = rig.upload(std::vector<cl_uint>((2 * LW_SWEEP_BLOCKS + 1) * kCells));
        rig.run("cover", rig.kernel("lpv_sweep/lpv_sweep_cover", "lpv_sweep_cover_triangles"), gridOver(input.nodeCount), {16, 1}, input.nodes,
                cl_int(input.nodeCount), input.triangles.memory, cl_int(input.triangles.planeStride), placed, cl_int(kSize), state, sums);
        return rig.download<cl_uint>(sums);
    }
    std::vector<cl_uint> block(KernelRig& rig, const LwLpvPlace& place) const {
        LwLpvBlockers stale{};
        stale.stale = 1;
        stale.parts = allOf(kSize + 1);
        const Guarded placed = rig.upload(std::vector<LwLpvPlace>{place}), state = rig.upload(std::vector<LwLpvBlockers>{stale}),
                      sums = rig.upload(std::vector<cl_uint>(2 * LW_LPV_BANDS * std::size_t(lpv_corners(kSize))));
        rig.run("block", rig.kernel("lpv_blocking/lpv_blocking", "lpv_blocking_triangles"), gridOver(input.nodeCount), {16, 1}, input.nodes,
                cl_int(input.nodeCount), input.triangles.memory, cl_int(input.triangles.planeStride), placed, cl_int(kSize), sums, state);
        return rig.download<cl_uint>(sums);
    }
};

// A height over (x, y) of the grid of cells of 1/2 from (-1, 2, 0.5) on, as triangles over a square mesh; no steeper than 1.
// Vertices that are not moved lie on samples of the lattice.
struct Sheet : Triangles {
    Sheet(int mesh, bool moved) {
        std::mt19937 random(31);
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        std::vector<std::array<double, 3>> corners;
        for (int j = 0; j <= mesh; ++j)
            for (int i = 0; i <= mesh; ++i) {
                const bool isEdge = i == 0 || j == 0 || i == mesh || j == mesh;
                const double shift = moved && !isEdge ? 0.2 : 0.0;
                // 66 samples to a side: one more than the grid's 64 all around.
                const double u = -0.5 + 66.0 * (i + shift * unit(random)) / mesh, v = -0.5 + 66.0 * (j + shift * unit(random)) / mesh;
                corners.push_back({-1.0 + u / 8.0, 2.0 + v / 8.0, 0.5 + 4.0 + 0.8 * std::sin(0.5 * u / 8.0) + 0.4 * std::cos(v / 8.0)});
            }
        for (int j = 0; j < mesh; ++j)
            for (int i = 0; i < mesh; ++i) {
                const auto put = [&](int di, int dj) { add(corners[std::size_t((j + dj) * (mesh + 1) + i + di)]); };
                put(0, 0), put(1, 0), put(1, 1);
                // Some turned round: of either winding an edge's samples are one triangle's.
                if ((i + j) % 2) put(0, 0), put(0, 1), put(1, 1);
                else put(0, 0), put(1, 1), put(0, 1);
            }
    }
};

}  // namespace

namespace {

// Triangles between a point and the rim of a square of 66 samples' side in a plane across z, of either winding, all over samples of
// the lattice; how many of them the grid's corners find, and its cells.
std::array<double, 2> samplesOfFan(KernelRig& rig, const LwLpvPlace& place, double u, double v, int spokes, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<double> along = {0.0, 66.0, 132.0, 198.0};  // the rim
    while (int(along.size()) < spokes) along.push_back(264.0 * double(random()) / 4294967296.0);
    std::sort(along.begin(), along.end());
    const auto rim = [](double s) -> std::array<double, 2> {
        const int side = int(s / 66.0) % 4;
        const double t = s - 66.0 * int(s / 66.0);
        const double x[] = {t, 66.0, 66.0 - t, 0.0}, y[] = {0.0, t, 66.0, 66.0 - t};
        return {x[side] - 0.75, y[side] - 0.75};
    };
    const std::size_t count = along.size();
    Triangles fan;
    const double cell = double(place.cell.s[0]), height = double(place.origin.s[2]) + 3.3 * cell;
    for (std::size_t t = 0; t < count; ++t) {
        std::array<std::array<double, 2>, 3> corners = {{{u, v}, rim(along[t]), rim(along[(t + 1) % count])}};
        if (random() % 2u) std::swap(corners[1], corners[2]);
        for (const auto& p : corners)
            fan.add({double(place.origin.s[0]) + cell * p[0] / 4.0, double(place.origin.s[1]) + cell * p[1] / 4.0, height});
    }
    fan.import(rig);
    const std::vector<cl_uint> sums = fan.block(rig, place), cells = fan.cover(rig, place);
    double whole = 0.0;
    for (std::size_t i = 0; i < std::size_t(lpv_corners(kSize)); ++i) {
        const cl_uint* at = &sums[2 * LW_LPV_BANDS * i];
        whole += double(std::int64_t(std::uint64_t(at[1]) << 32 | at[0]));
    }
    double covered = 0.0;
    for (std::size_t i = 0; i < kCells; ++i) {
        const cl_uint* at = &cells[2 * (LW_SWEEP_BLOCKS * i + LW_SWEEP_COVER)];
        covered += double(at[0]) + 4294967296.0 * double(at[1]);
    }
    return {whole / 536870912.0 * 16.0 / (0.5 * std::sqrt(3.14159265358979323846)), covered * 16.0 / double(1 << LW_SWEEP_AREA_BITS)};
}

}  // namespace

// Edges' functions are next to nothing at the point they meet in: rounded, a sample there is in none of the triangles or in two.
TEST_CASE("of triangles that meet in a point, on a sample or beside it, each sample is in one", "[lpv_cascades][large]") {
    KernelRig rig(GENERATE(1u, 16u));
    std::mt19937 random(5);
    for (int i = 0; i < 60; ++i) {
        const bool isFar = i % 2;
        const LwLpvPlace place = isFar ? placeOf(0.5 * 100000, -0.5 * 70000, 0.5 * 40000, 0.5) : kGrid;
        const auto near = [&](int k) {
            const double off = std::pow(0.1, k % 7) * (double(random()) / 4294967296.0 - 0.5);
            return double(random() % 60u) + 2.5 + (k % 3 ? off : 0.0);
        };
        const double u = near(i / 2), v = near(i / 3);
        INFO("fan " << i << " about " << u << " " << v);
        const auto [corners, cells] = samplesOfFan(rig, place, u, v, 5 + 13 * (i % 9), unsigned(i));
        CHECK(corners == Approx(66.0 * 66.0).epsilon(1e-6));
        CHECK(cells == 64.0 * 64.0);
    }
}

// In all of the grid's 64 x 64 columns of samples, whatever the triangles, 16 of which fill a cell's side.
namespace {

// A sheet of mesh x mesh squares of two triangles, on the lattice or a bit off it.
void checkSheet(int mesh) {
    KernelRig rig(GENERATE(1u, 16u));
    const bool moved = GENERATE(false, true);
    Sheet sheet(mesh, moved);
    sheet.import(rig);
    const std::vector<cl_uint> found = sheet.cover(rig, kGrid), blocked = sheet.block(rig, kGrid);
    std::vector<double> columns(std::size_t(kSize) * kSize);
    for (std::size_t i = 0; i < kCells; ++i) {
        const cl_uint* at = &found[2 * (LW_SWEEP_BLOCKS * i + LW_SWEEP_COVER)];
        columns[i % columns.size()] += (double(at[0]) + 4294967296.0 * double(at[1])) / double(1 << LW_SWEEP_AREA_BITS);
    }
    INFO("mesh " << mesh << ", moved " << moved);
    // Area lies half a cell behind its surface, which leans: a column's may be in the next one, the whole in none but its own.
    double sum = 0.0;
    for (const double c : columns) sum += c;
    CHECK(sum > 0.98 * kSize * kSize);
    // As much leans into the border's columns as out of them; fans, below, are flat and tell each sample.
    CHECK(sum < 1.02 * kSize * kSize);

    double straight = 0.0;  // along z, of whole areas: the columns' own
    for (std::size_t i = 0; i < std::size_t(lpv_corners(kSize)); ++i) {
        const cl_uint* at = &blocked[2 * (LW_LPV_BANDS * i + 3)];
        const auto whole = std::int64_t(std::uint64_t(at[1]) << 32 | at[0]);
        straight += double(whole) / 536870912.0 / std::sqrt(3.14159265358979323846 / 3.0);
    }
    // All of the sheet: corners on the grid's border have samples half a cell beyond it.
    CHECK(straight == Approx(66.0 * 66.0 / 16.0).epsilon(1e-5));
}

}  // namespace

TEST_CASE("a sheet of triangles has each sample of a grid's lattice once, also those on edges", "[lpv_cascades]") {
    checkSheet(2);
}

TEST_CASE("a sheet of many triangles has each sample of a grid's lattice once", "[lpv_cascades][large]") {
    checkSheet(GENERATE(11, 66, 150));
}
