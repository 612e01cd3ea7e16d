// What a coarser grid brings into a finer one, against sums in double; where nested grids lie; which lights are whose; the blend.
#include "passes/lpv_cascades.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "passes/lpv_grid.h"
#include "passes/lpv_read.h"
#include "shared/geometry_types.h"
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

namespace {

// Three grids about the origin, of cells of 1/4, 1/2 and 1.
const LwLpvPlace kLayers[3] = {placeOf(-2, -2, -2, 0.25), placeOf(-4.25, -4, -3.75, 0.5), placeOf(-8, -8, -8, 1)};

double weightOfCoarser(const LwLpvPlace& place, const double* p) {
    const double half = kSize / 2.0, w = kSize / 10.0;
    double most = 0.0;
    for (int a = 0; a < 3; ++a)
        most = std::max(most, std::abs((p[a] - double(place.origin.s[a])) * double(place.origin.s[3]) - half));
    return std::min(1.0, std::max(0.0, (most - (half - w)) / w));
}

struct LayerRig : KernelRig {
    explicit LayerRig(std::uint32_t width) : KernelRig(width) {}
    // Of red; light: of each grid.
    std::vector<float> read(const std::vector<LpvCells>& light, const std::vector<float>& positions, std::vector<cl_int>* found = nullptr) {
        const auto count = std::uint32_t(positions.size() / 3);
        std::vector<float> normals(positions.size());
        std::fill(normals.begin() + count, normals.begin() + 2 * count, 1.0f);
        const Guarded position = uploadPlanes(positions, count, 1, 3, NAN), normal = uploadPlanes(normals, count, 1, 3, NAN),
                      irradiance = makePlanes(count, 1, 3), validity = makePlanes(count, 1, 1),
                      places = upload(std::vector<LwLpvPlace>(kLayers, kLayers + 3)), counts = upload(std::vector<cl_int>(LpvRead::kCounts));
        const Planes e = planes(irradiance, count, 1, 3);
        std::vector<std::unique_ptr<LpvRead>> passes;
        for (std::uint32_t c = 3; c-- > 0;) {
            passes.push_back(std::make_unique<LpvRead>(device(), kSize));
            const Guarded grid = upload(light[c].laidOut());
            passes.back()->recordPack(executor(), grid);
            passes.back()->recordGather(executor(), planes(position, count, 1, 3), planes(normal, count, 1, 3), places, 0.7, false, e,
                                        planes(validity, count, 1, 1), counts, {c, 3});
        }
        device().finish();
        if (found) *found = download<cl_int>(counts);
        return downloadPlanes(e);
    }
};

std::vector<float> placesAbout(std::size_t count) {
    std::mt19937 random(21);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    std::vector<float> positions(3 * count);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t a = 0; a < 3; ++a) positions[a * count + i] = (i % 3 ? 2.2f : i % 2 ? 4.4f : 8.8f) * unit(random);
    return positions;
}

// Only the first coefficient, which no normal changes.
LpvCells evenLight(double value) {
    LpvCells cells(kSize);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < int(kCells); ++i) cells.at(4 * c, i % kSize, i / kSize % kSize, i / kSize / kSize) = float(value);
    return cells;
}

}  // namespace

TEST_CASE("even light reads the same through every blend of grids", "[lpv_cascades]") {
    LayerRig rig(GENERATE(1u, 16u));
    const std::vector<float> positions = placesAbout(1501);
    const std::vector<float> got = rig.read({evenLight(0.0625), evenLight(0.25), evenLight(1.0)}, positions);
    const double even = 0.7 * std::sqrt(3.14159265358979323846) / 2.0;
    std::size_t within = 0;
    for (std::size_t i = 0; i < 1501; ++i) {
        const double p[3] = {double(positions[i]), double(positions[1501 + i]), double(positions[3002 + i])};
        if (std::abs(p[0]) > 8.0 || p[1] + 0.5 > 8.0 || p[1] + 0.5 < -8.0 || std::abs(p[2]) > 8.0) continue;
        ++within;
        CHECK(double(got[i]) == Approx(even).epsilon(5e-7));  // the eight shares' own rounding
    }
    CHECK(within > 1300);
}

TEST_CASE("pixels blend grids as a recursion in double does", "[lpv_cascades]") {
    LayerRig rig(GENERATE(1u, 16u));
    const std::size_t count = 1501;
    const std::vector<float> positions = placesAbout(count);
    const std::vector<LpvCells> light = {randomLight(kSize, 0), randomLight(kSize, 1), randomLight(kSize, 2)};
    std::vector<cl_int> counts;
    const std::vector<float> got = rig.read(light, positions, &counts);
    std::vector<float> expected(count), own(count);
    cl_int missing = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const double p[3] = {double(positions[i]), double(positions[count + i]), double(positions[2 * count + i])};
        double e = 0.0;
        for (std::size_t c = 3; c-- > 0;) {
            const double a = c == 2 ? 0.0 : weightOfCoarser(kLayers[c], p);
            double g[3], sum = 0.0;
            bool inside = true;
            for (int k = 0; k < 3; ++k) {
                const double corner = (p[k] - double(kLayers[c].origin.s[k])) * double(kLayers[c].origin.s[3]) + (k == 1 ? 0.5 : 0.0);
                inside = inside && corner >= 0.0 && corner <= kSize;
                g[k] = std::min(std::max(corner - 0.5, 0.0), kSize - 1.0);
            }
            if (c == 2 && !inside) {
                ++missing;
                continue;
            }
            for (int k = 0; k < 8; ++k) {
                double share = 1.0;
                int at[3];
                for (int axis = 0; axis < 3; ++axis) {
                    const int low = std::min(int(g[axis]), kSize - 2);
                    at[axis] = low + (k >> axis & 1);
                    share *= k >> axis & 1 ? g[axis] - low : 1.0 - (g[axis] - low);
                }
                const double pi = 3.14159265358979323846;
                sum += share * (std::sqrt(pi) / 2 * double(light[c].at(0, at[0], at[1], at[2])) -
                                std::sqrt(pi / 3) * double(light[c].at(2, at[0], at[1], at[2])));
            }
            const double cell = double(kLayers[c].cell.s[0]);
            e = a * e + (1.0 - a) * 0.7 / (cell * cell) * std::max(0.0, sum);
        }
        expected[i] = float(e);
        own[i] = got[i];
    }
    CHECK(disagreement(own, expected) == "");
    CHECK(counts == std::vector<cl_int>{0, 0, missing});
}

namespace {

// A height over (x, y) of the grid of cells of 1/2 from (-1, 2, 0.5) on, as triangles over a square mesh; no steeper than 1.
// Vertices that are not moved lie on samples of the lattice.
struct Sheet {
    std::vector<float> planes;  // of GeometryInput
    int count = 0, stride = 0;

    Sheet(int mesh, bool moved) {
        std::mt19937 random(31);
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        std::vector<std::array<double, 3>> vertices;
        for (int j = 0; j <= mesh; ++j)
            for (int i = 0; i <= mesh; ++i) {
                const bool isEdge = i == 0 || j == 0 || i == mesh || j == mesh;
                const double shift = moved && !isEdge ? 0.2 : 0.0;
                // 66 samples to a side: one more than the grid's 64 all around.
                const double u = -0.5 + 66.0 * (i + shift * unit(random)) / mesh, v = -0.5 + 66.0 * (j + shift * unit(random)) / mesh;
                vertices.push_back({-1.0 + u / 8.0, 2.0 + v / 8.0, 0.5 + 4.0 + 0.8 * std::sin(0.5 * u / 8.0) + 0.4 * std::cos(v / 8.0)});
            }
        std::vector<std::array<std::size_t, 3>> triangles;
        for (int j = 0; j < mesh; ++j)
            for (int i = 0; i < mesh; ++i) {
                const auto at = [&](int di, int dj) { return std::size_t((j + dj) * (mesh + 1) + i + di); };
                triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
                // Some turned round: of either winding an edge's samples are one triangle's.
                if ((i + j) % 2) triangles.push_back({at(0, 0), at(0, 1), at(1, 1)});
                else triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
            }
        count = int(triangles.size());
        stride = (count + 15) / 16 * 16;
        planes.resize(std::size_t(stride) * LW_TRIANGLE_PLANES);
        for (std::size_t t = 0; t < triangles.size(); ++t)
            for (std::size_t k = 0; k < 3; ++k)
                for (std::size_t a = 0; a < 3; ++a) planes[(3 * k + a) * std::size_t(stride) + t] = float(vertices[triangles[t][k]][a]);
    }
};

}  // namespace

// In all of the grid's 64 x 64 columns of samples, whatever the triangles, 16 of which fill a cell's side.
TEST_CASE("a sheet of triangles has each sample of a grid's lattice once, also those on edges", "[lpv_cascades]") {
    KernelRig rig(GENERATE(1u, 16u));
    const bool moved = GENERATE(false, true);
    const int mesh = GENERATE(2, 11, 66, 150);
    const Sheet sheet(mesh, moved);
    const std::size_t words = (2 * LW_SWEEP_BLOCKS + 1) * kCells;
    const Guarded triangles = rig.upload(sheet.planes), place = rig.upload(std::vector<LwLpvPlace>{kCoarse}),
                  sums = rig.upload(std::vector<cl_uint>(words));
    LwSweepCover stale{};
    stale.stale = 1;
    const Guarded state = rig.upload(std::vector<LwSweepCover>{stale});
    const std::size_t padded = std::size_t(sheet.stride);
    rig.run("cover", rig.kernel("lpv_sweep/lpv_sweep_cover", "lpv_sweep_cover_triangles"), {padded, 1}, {16, 1}, triangles,
            cl_int(sheet.stride), cl_int(sheet.count), place, cl_int(kSize), state, sums);
    const std::vector<cl_uint> found = rig.download<cl_uint>(sums);
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
    CHECK(sum < 1.00001 * kSize * kSize);

    const Guarded corners = rig.upload(std::vector<cl_uint>(2 * LW_LPV_BANDS * std::size_t(lpv_corners(kSize))));
    LwLpvBlockers anew{};
    anew.stale = 1;
    const Guarded blockers = rig.upload(std::vector<LwLpvBlockers>{anew});
    rig.run("block", rig.kernel("lpv_blocking/lpv_blocking", "lpv_blocking_triangles"), {padded, 1}, {16, 1}, triangles,
            cl_int(sheet.stride), cl_int(sheet.count), place, cl_int(kSize), corners, blockers);
    const std::vector<cl_uint> blocked = rig.download<cl_uint>(corners);
    double straight = 0.0;  // along z, of whole areas: the columns' own
    for (std::size_t i = 0; i < std::size_t(lpv_corners(kSize)); ++i) {
        const cl_uint* at = &blocked[2 * (LW_LPV_BANDS * i + 3)];
        const auto whole = std::int64_t(std::uint64_t(at[1]) << 32 | at[0]);
        straight += double(whole) / 536870912.0 / std::sqrt(3.14159265358979323846 / 3.0);
    }
    CHECK(straight == Approx(double(kSize) * kSize).epsilon(1e-5));
}
