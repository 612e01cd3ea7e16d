// Pixels between nested grids: even light, and a recursion in double.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "passes/lpv_read.h"
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
