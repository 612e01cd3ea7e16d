// Irradiance read from a grid: against a trilinear sum in double, and what lies outside.
#include "passes/lpv_read.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/lpv_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr int kSize = 16;
constexpr double kCell = 0.25, kCalibration = 0.7;
constexpr double kOrigin[3] = {-1.0, 2.0, 0.5};

struct Pixels {
    std::uint32_t width, height;
    std::vector<float> position, normal;  // packed planes
    Pixels(std::uint32_t w, std::uint32_t h) : width(w), height(h), position(3 * w * h), normal(3 * w * h) {
        std::mt19937 random(3);
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        const std::size_t count = std::size_t(w) * h;
        for (std::size_t i = 0; i < count; ++i) {
            double n[3], length = 0.0;
            for (double& x : n) {
                x = unit(random);
                length += x * x;
            }
            for (std::size_t a = 0; a < 3; ++a) {
                // A little more than the grid all around.
                position[a * count + i] = float(kOrigin[a] + kSize * kCell * (0.5 + 0.6 * unit(random)));
                normal[a * count + i] = i % 17 == 5 ? 0.0f : float(n[a] / std::sqrt(length));
            }
        }
    }
};

// Irradiance at `g`, in cells from the first one's centre, on surfaces of normal n; before it is scaled and clamped.
double lightAt(const LpvCells& cells, int colour, const double* g, const double* n) {
    double f[3], light[4] = {};
    int low[3];
    for (int a = 0; a < 3; ++a) {
        const double inside = std::min(std::max(g[a], 0.0), double(kSize - 1));
        low[a] = std::min(int(inside), kSize - 2);
        f[a] = inside - low[a];
    }
    for (int k = 0; k < 8; ++k) {
        const double w = (k & 1 ? f[0] : 1 - f[0]) * (k & 2 ? f[1] : 1 - f[1]) * (k & 4 ? f[2] : 1 - f[2]);
        for (int b = 0; b < 4; ++b)
            light[b] += w * double(cells.at(4 * colour + b, low[0] + (k & 1), low[1] + (k >> 1 & 1), low[2] + (k >> 2)));
    }
    const double pi = 3.14159265358979323846;
    return std::sqrt(pi) / 2 * light[0] - std::sqrt(pi / 3) * (light[1] * n[0] + light[2] * n[1] + light[3] * n[2]);
}

// Irradiance and validity (the fourth), packed.
std::vector<float> expectedOf(const Pixels& pixels, const LpvCells& cells, bool isDamped) {
    const std::size_t count = std::size_t(pixels.width) * pixels.height;
    std::vector<float> result(4 * count);
    for (std::size_t i = 0; i < count; ++i) {
        double n[3], g[3], further[3];
        bool inside = true, surface = false;
        for (std::size_t a = 0; a < 3; ++a) {
            n[a] = double(pixels.normal[a * count + i]);
            surface = surface || n[a] != 0.0;
            const double cornered = (double(pixels.position[a * count + i]) - kOrigin[a]) / kCell + 0.5 * n[a];
            inside = inside && cornered >= 0.0 && cornered <= kSize;
            g[a] = std::min(std::max(cornered - 0.5, 0.0), double(kSize - 1));
            further[a] = g[a] + n[a];
        }
        if (!inside || !surface) continue;
        for (int c = 0; c < 3; ++c) {
            double e = lightAt(cells, c, g, n);
            if (isDamped) e = std::min(e, lightAt(cells, c, further, n));
            result[std::size_t(c) * count + i] = float(kCalibration / (kCell * kCell) * std::max(0.0, e));
        }
        result[3 * count + i] = 1.0f;
    }
    return result;
}

// c0, c1.x, c1.y, c1.z of three colours that arrive at points, one band below the other, with the points' number of rows each.
std::vector<float> expectedBands(const Pixels& pixels, const LpvCells& cells, bool hasNormals) {
    const std::size_t count = std::size_t(pixels.width) * pixels.height;
    std::vector<float> result(12 * count);
    for (std::size_t i = 0; i < count; ++i) {
        double f[3];
        int low[3];
        bool inside = true, has = !hasNormals;
        for (std::size_t a = 0; a < 3; ++a) {
            const double n = hasNormals ? double(pixels.normal[a * count + i]) : 0.0;
            has = has || n != 0.0;
            const double g = (double(pixels.position[a * count + i]) - kOrigin[a]) / kCell + 0.5 * n;
            inside = inside && g >= 0.0 && g <= kSize;
            const double at = std::min(std::max(g - 0.5, 0.0), double(kSize - 1));
            low[a] = std::min(int(at), kSize - 2);
            f[a] = at - low[a];
        }
        if (!inside || !has) continue;
        for (int c = 0; c < 3; ++c)
            for (int b = 0; b < 4; ++b) {
                double sum = 0.0;
                for (int k = 0; k < 8; ++k)
                    sum += (k & 1 ? f[0] : 1 - f[0]) * (k & 2 ? f[1] : 1 - f[1]) * (k & 4 ? f[2] : 1 - f[2]) *
                           double(cells.at(4 * c + b, low[0] + (k & 1), low[1] + (k >> 1 & 1), low[2] + (k >> 2)));
                // Cells know where light goes, points where it comes from.
                result[(std::size_t(c) * 4 + std::size_t(b)) * count + i] = float((b ? -1.0 : 1.0) * kCalibration / (kCell * kCell) * sum);
            }
    }
    return result;
}

}  // namespace

TEST_CASE("points read both bands as a trilinear sum in double gives them, with normals and without", "[lpv_read]") {
    const std::uint32_t width = GENERATE(1u, 16u);
    const bool hasNormals = GENERATE(true, false);
    KernelRig rig(width);
    const LpvCells cells = randomLight(kSize, 0);
    const Pixels pixels(45, 13);
    LpvRead pass(rig.device(), kSize);
    const Guarded grid = rig.upload(cells.laidOut());
    LwLpvPlace place{};
    place.origin = {{float(kOrigin[0]), float(kOrigin[1]), float(kOrigin[2]), float(1.0 / kCell)}};
    place.cell = {{float(kCell), 1.0f, 1.0f, 0.0f}};
    const Guarded placed = rig.upload(std::vector<LwLpvPlace>{place}), counts = rig.upload(std::vector<cl_int>(LpvRead::kCounts));
    const Guarded position = rig.uploadPlanes(pixels.position, 45, 13, 3, NAN), normal = rig.uploadPlanes(pixels.normal, 45, 13, 3, NAN);
    const Guarded light = rig.makePlanes(45, 4 * 13, 3), validity = rig.makePlanes(45, 13, 1), other = rig.makePlanes(45, 13, 1);
    const Planes p = rig.planes(position, 45, 13, 3), n = hasNormals ? rig.planes(normal, 45, 13, 3) : Planes{},
                 all = rig.planes(light, 45, 4 * 13, 3), v = rig.planes(validity, 45, 13, 1);
    pass.recordPack(rig.executor(), grid);
    pass.recordHarmonics(rig.executor(), p, n, placed, kCalibration, {all, cl_int(all.rowStride * 13)}, v, counts);
    pass.recordHarmonics(rig.executor(), p, n, placed, kCalibration, {}, rig.planes(other, 45, 13, 1), counts);
    rig.device().finish();
    const std::vector<float> expected = expectedBands(pixels, cells, hasNormals);
    CHECK(disagreement(rig.downloadPlanes(all), expected) == "");
    std::vector<float> valid(45 * 13);
    cl_int missing = 0;
    for (std::size_t i = 0; i < valid.size(); ++i) {
        valid[i] = expected[i] != 0.0f ? 1.0f : 0.0f;
        missing += valid[i] == 0.0f && (!hasNormals || i % 17 != 5) ? 1 : 0;
    }
    CHECK(rig.downloadPlanes(v) == valid);
    CHECK(rig.downloadPlanes(rig.planes(other, 45, 13, 1)) == valid);
    CHECK(missing > 50);
    CHECK(rig.download<cl_int>(counts) == std::vector<cl_int>{0, 0, 2 * missing});
}

TEST_CASE("pixels read what a trilinear sum in double gives them; outside there is nothing", "[lpv_read]") {
    const std::uint32_t width = GENERATE(1u, 16u);
    const bool isDamped = GENERATE(false, true);
    KernelRig rig(width);
    const LpvCells cells = randomLight(kSize, 0);
    const Pixels pixels(45, 13);
    LpvRead pass(rig.device(), kSize);
    const Guarded grid = rig.upload(cells.laidOut());
    LwLpvPlace place{};
    place.origin = {{float(kOrigin[0]), float(kOrigin[1]), float(kOrigin[2]), float(1.0 / kCell)}};
    place.cell = {{float(kCell), 1.0f, 1.0f, 0.0f}};
    const Guarded placed = rig.upload(std::vector<LwLpvPlace>{place}), counts = rig.upload(std::vector<cl_int>(LpvRead::kCounts));
    const Guarded position = rig.uploadPlanes(pixels.position, 45, 13, 3, NAN);
    const Guarded normal = rig.uploadPlanes(pixels.normal, 45, 13, 3, NAN);
    const Guarded irradiance = rig.makePlanes(45, 13, 3), validity = rig.makePlanes(45, 13, 1);
    const Planes p = rig.planes(position, 45, 13, 3), n = rig.planes(normal, 45, 13, 3), e = rig.planes(irradiance, 45, 13, 3),
                 v = rig.planes(validity, 45, 13, 1);
    pass.recordPack(rig.executor(), grid);
    pass.recordGather(rig.executor(), p, n, placed, kCalibration, isDamped, e, v, counts);
    rig.device().finish();
    std::vector<float> got = rig.downloadPlanes(e);
    const std::vector<float> valid = rig.downloadPlanes(v);
    got.insert(got.end(), valid.begin(), valid.end());
    const std::vector<float> expected = expectedOf(pixels, cells, isDamped);
    CHECK(disagreement(got, expected) == "");
    cl_int missing = 0, valids = 0;
    for (std::size_t i = 0; i < 45 * 13; ++i) {
        valids += expected[3 * 45 * 13 + i] > 0.0f ? 1 : 0;
        missing += i % 17 != 5 && expected[3 * 45 * 13 + i] == 0.0f ? 1 : 0;
    }
    CHECK(valids > 200);
    CHECK(missing > 50);
    CHECK(rig.download<cl_int>(counts) == std::vector<cl_int>{0, 0, missing});
    CHECK(pass.bytes() == LpvRead::estimateBytes(kSize));

    // One output at a time gives the same; without a grid there is no light.
    const Guarded alone = rig.makePlanes(45, 13, 3), other = rig.makePlanes(45, 13, 1);
    pass.recordGather(rig.executor(), p, n, placed, kCalibration, isDamped, rig.planes(alone, 45, 13, 3), {}, counts);
    pass.recordGather(rig.executor(), p, n, placed, kCalibration, isDamped, {}, rig.planes(other, 45, 13, 1), counts);
    rig.device().finish();
    CHECK(bitDifference(rig.downloadPlanes(rig.planes(alone, 45, 13, 3)), rig.downloadPlanes(e)) == "");
    CHECK(bitDifference(rig.downloadPlanes(rig.planes(other, 45, 13, 1)), valid) == "");
    const Guarded none = rig.upload(std::vector<LwLpvPlace>(1));
    pass.recordGather(rig.executor(), p, n, none, kCalibration, isDamped, e, v, counts);
    rig.device().finish();
    CHECK(rig.downloadPlanes(e) == std::vector<float>(3 * 45 * 13));
    CHECK(rig.downloadPlanes(v) == std::vector<float>(45 * 13));
}
