// Specular rays: cells, coarser cells and the march against loops in double, at both widths.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "reference/lpv_specular_twin.h"
#include "support/lpv_rig.h"
#include "support/specular_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

constexpr int kSize = 16;
constexpr double kCell = 0.5;
constexpr Vec kOrigin{-3.0, 1.0, 8.0};

// Light in a third of the cells, as texels would put it there: two lobes of positive flux.
LpvCells someLight() {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    LpvCells cells(kSize);
    for (int z = 0; z < kSize; ++z)
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                if (unit(random) > 0.33) continue;
                for (int lobe = 0; lobe < 2; ++lobe) {
                    const Vec n = reference::unit({unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5});
                    for (int c = 0; c < 3; ++c) {
                        const double flux = unit(random) / M_PI;
                        cells.at(4 * c, x, y, z) += float(flux * LW_LPV_LOBE0);
                        cells.at(4 * c + 1, x, y, z) += float(flux * LW_LPV_LOBE1 * n.x);
                        cells.at(4 * c + 2, x, y, z) += float(flux * LW_LPV_LOBE1 * n.y);
                        cells.at(4 * c + 3, x, y, z) += float(flux * LW_LPV_LOBE1 * n.z);
                    }
                }
            }
    return cells;
}

// What blocks about corners: a tenth of a side on the mean.
std::vector<float> someCorners() {
    std::mt19937 random(6);
    std::uniform_real_distribution<float> unit(-0.3f, 0.3f);
    std::vector<float> corners(std::size_t(4 * (kSize + 1) * (kSize + 1) * (kSize + 1)));
    for (float& x : corners) x = unit(random);
    return corners;
}

std::vector<float> expectedCells(const LpvCells& light, const std::vector<float>& corners, bool blocks) {
    std::vector<float> cells;
    for (int z = 0; z < kSize; ++z)
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x)
                for (int band = 0; band < 4; ++band) {
                    for (int c = 0; c < 3; ++c)
                        cells.push_back(float(double(light.at(4 * c + band, x, y, z)) /
                                              (band == 0 ? LW_LPV_LOBE0 : LW_LPV_LOBE1) / (kCell * kCell)));
                    double sum = 0.0;
                    for (int k = 0; k < 4 && band < 3; ++k) {
                        int i[3] = {x, y, z};
                        i[(band + 1) % 3] += k & 1;
                        i[(band + 2) % 3] += k >> 1;
                        const int n = kSize + 1, at = (i[2] * n + i[1]) * n + i[0];
                        sum += std::abs(double(corners[std::size_t(4 * at + band + 1)])) / LW_LPV_LOBE1;
                    }
                    cells.push_back(blocks ? float(std::min(1.0, 1.25 * sum / 4.0)) : 0.0f);
                }
    return cells;
}

// A level of eight cells each of the one before.
std::vector<float> halved(const std::vector<float>& cells, int n) {
    const int half = n / 2;
    std::vector<float> result;
    const auto value = [&](int x, int y, int z, int f) { return double(cells[std::size_t(16 * ((z * n + y) * n + x) + f)]); };
    for (int z = 0; z < half; ++z)
        for (int y = 0; y < half; ++y)
            for (int x = 0; x < half; ++x)
                for (int f = 0; f < 16; ++f) {
                    double sum = 0.0;
                    if (f % 4 < 3 || f == 15) {
                        for (int k = 0; k < 8; ++k) sum += value(2 * x + (k & 1), 2 * y + (k >> 1 & 1), 2 * z + (k >> 2), f) / 8.0;
                    } else {
                        const int axis = f / 4;
                        for (int k = 0; k < 4; ++k) {
                            int i[3] = {2 * x, 2 * y, 2 * z};
                            i[(axis + 1) % 3] += k & 1;
                            i[(axis + 2) % 3] += k >> 1;
                            const double first = value(i[0], i[1], i[2], f);
                            ++i[axis];
                            sum += (1.0 - (1.0 - first) * (1.0 - value(i[0], i[1], i[2], f))) / 4.0;
                        }
                    }
                    result.push_back(float(sum));
                }
    return result;
}

std::vector<float> downloadCells(const Buffer& buffer) {
    std::vector<float> cells(std::size_t(specular_first(kSize, specular_levels(kSize))) * 16);
    buffer.download(0, cells.size() * sizeof(float), cells.data());
    return cells;
}

std::vector<SpecularPoint> somePoints(std::size_t count) {
    std::mt19937 random(8);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<SpecularPoint> points;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec centre = kOrigin + Vec{1, 1, 1} * (0.5 * kSize * kCell);
        const Vec p = centre + Vec{unit(random), unit(random), unit(random)} * (0.55 * kSize * kCell);
        const Vec n = reference::unit({unit(random), unit(random), unit(random)});
        points.push_back({p, i % 17 == 5 ? Vec{} : n, i % 3 == 0 ? 0.0 : 0.5 + 0.5 * unit(random)});
    }
    return points;
}

}  // namespace

TEST_CASE("specular cells and their coarser ones are what sums in double make of injected light", "[lpv_specular]") {
    KernelRig rig(GENERATE(1u, 16u));
    const bool blocks = GENERATE(false, true);
    const LpvCells light = someLight();
    const std::vector<float> corners = someCorners();
    LpvSpecular pass(rig.device(), kSize);
    const Guarded grid = rig.upload(light.laidOut()), blockers = rig.upload(corners),
                  place = rig.upload(std::vector<LwLpvPlace>{placeOf(kCell, kOrigin)});
    pass.recordPackSteps(rig.executor(), grid, place, blocks ? &blockers : nullptr);
    pass.show(rig.executor());
    rig.device().finish();
    std::vector<float> expected = expectedCells(light, corners, blocks), level = expected;
    for (int n = kSize; n > 4; n /= 2) {
        level = halved(level, n);
        expected.insert(expected.end(), level.begin(), level.end());
    }
    CHECK(disagreement(downloadCells(pass.cells()), expected) == "");
    CHECK(pass.bytes() == LpvSpecular::estimateBytes(kSize, false));
}

// Cells and levels are discrete: one ray in a thousand may take another one by rounding.
TEST_CASE("specular rays find what a march in double finds, and both widths the same bits", "[lpv_specular]") {
    const bool isOrthographic = GENERATE(false, true), hasFaces = GENERATE(false, true);
    const LpvCells light = someLight();
    const std::vector<SpecularPoint> points = somePoints(testSize({601, 1}).first);
    LwSpecularRays view = raysFrom(kOrigin + Vec{5.0, 3.0, -2.0}, 0.25);
    if (isOrthographic) view.eye = float4(0.6, 0.0, 0.8, 0.0);
    std::vector<float> first;
    for (const std::uint32_t width : {1u, 16u}) {
        KernelRig rig(width);
        LpvSpecular pass(rig.device(), kSize);
        const Guarded grid = rig.upload(light.laidOut()), corners = rig.upload(someCorners()),
                      place = rig.upload(std::vector<LwLpvPlace>{placeOf(kCell, kOrigin)});
        pass.recordPackSteps(rig.executor(), grid, place, hasFaces ? &corners : nullptr);
        pass.show(rig.executor());
        const SpecularLight found = marchSpecular(rig, pass, points, view, place);
        if (width == 1) {
            first = found.radiance;
            reference::SpecularTwin twin{kSize, specular_levels(kSize), true, {0.25, 0.25, 0.25}, downloadCells(pass.cells())};
            std::vector<float> expected(3 * points.size());
            cl_int has = 0, missing = 0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                const SpecularPoint& p = points[i];
                if (reference::dot(p.normal, p.normal) == 0.0) continue;
                const Vec g = (p.position - kOrigin) * (1.0 / kCell) + p.normal * 0.5;
                if (g.x < 0 || g.y < 0 || g.z < 0 || g.x > kSize || g.y > kSize || g.z > kSize) {
                    ++missing;
                    continue;
                }
                ++has;
                Vec v = isOrthographic ? Vec{0.6, 0.0, 0.8} : reference::unit(kOrigin + Vec{5.0, 3.0, -2.0} - p.position);
                const double nv = reference::dot(v, p.normal);
                if (nv < 0.0) v = isOrthographic ? v * -1.0 : v - p.normal * (2.0 * nv);
                const auto mean = twin.lobe({g.x, g.y, g.z}, p.normal, v, double(float(p.roughness)));
                for (std::size_t c = 0; c < 3; ++c) expected[c * points.size() + i] = float(mean[c]);
            }
            CHECK(disagreement(found.radiance, expected, 1e-4, 5e-3) == "");
            CHECK(found.counts == std::vector<cl_int>{0, 0, missing, has});
            CHECK(has > cl_int(points.size() / 3));
            CHECK(missing > 0);
        } else {
            CHECK(bitDifference(found.radiance, first) == "");
        }
    }
}

TEST_CASE("specular rays: roughness beyond [0,1] is brought into it, no number is 1, an eye in the surface looks straight on", "[lpv_specular]") {
    KernelRig rig(GENERATE(1u, 16u));
    const LpvCells light = someLight();
    LpvSpecular pass(rig.device(), kSize);
    const Guarded grid = rig.upload(light.laidOut()), place = rig.upload(std::vector<LwLpvPlace>{placeOf(kCell, kOrigin)});
    pass.recordPackSteps(rig.executor(), grid, place, nullptr);
    pass.show(rig.executor());
    const Vec at = kOrigin + Vec{3.3, 4.1, 2.7}, n = reference::unit({1, 2, 3});
    const double nan = std::numeric_limits<double>::quiet_NaN(), most = std::numeric_limits<double>::infinity();
    const std::vector<SpecularPoint> points = {{at, n, 0.0}, {at, n, -3.0}, {at, n, 1.0}, {at, n, 7.0}, {at, n, most}, {at, n, nan}};
    const std::vector<float> found = marchSpecular(rig, pass, points, raysFrom(at), place).radiance;
    const std::vector<float> ahead = marchSpecular(rig, pass, points, raysFrom(at + n * 2.0), place).radiance;
    for (std::size_t c = 0; c < 3; ++c) {
        const float* f = &found[6 * c];
        CHECK(f[0] == f[1]);
        CHECK(f[2] == f[3]);
        CHECK(f[2] == f[4]);
        CHECK(f[2] == f[5]);
        CHECK(f[2] > 0.0f);
        CHECK(double(f[0]) == Approx(double(ahead[6 * c])).epsilon(1e-3));
    }
}
