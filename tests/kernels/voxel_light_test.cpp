// Light in voxels, against sums in double, conservation, and a gather over voxels whose light was never
// made words.
#include "passes/voxel_light.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/voxel_light_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr double kPi = 3.14159265358979323846;

}  // namespace

TEST_CASE("a voxel's light is its texels' flux over pi and its surfaces' area, and all flux arrives",
          "[voxel_light][large]") {
    VoxelLightRig rig(16, 32, LW_VOXEL_MODE_ISOTROPIC, false);
    LitRoom scene(700);
    // Those on a voxel's very border may lie on its other side for floats.
    const auto isOnBorder = [](const VoxelTexel& t) {
        return std::any_of(t.at.begin(), t.at.end(),
                           [](double x) { return std::fabs(x - std::round(x)) < 1e-4; });
    };
    scene.texels.erase(std::remove_if(scene.texels.begin(), scene.texels.end(), isOnBorder),
                       scene.texels.end());
    rig.setTriangles(scene.triangles);
    rig.shine(scene.texels);
    CHECK(rig.texels().outside == 0);
    CHECK(rig.texels().lost == 0);
    const std::array<double, 3> total = totalOf(scene.texels);
    // Each texel in the voxel that double arithmetic finds.
    std::vector<double> twin(rig.brickCount() * LW_VOXEL_BRICK_VOXELS);
    for (const VoxelTexel& t : scene.texels)
        twin[rig.indexOf(int(t.at[0]), int(t.at[1]), int(t.at[2]))] += t.flux[0];
    const std::vector<double> red = rig.held(0);
    double differ = 0.0;
    for (std::size_t i = 0; i < twin.size(); ++i) differ += std::fabs(twin[i] - red[i]);
    CHECK(differ < 1e-5 * total[0]);
    const std::vector<float> area = rig.floats(LW_SURFACE_AREA);
    const VoxelLevel level = VoxelLevel::of(rig.volume, 0);
    for (int c = 0; c < 3; ++c) {
        double flux = 0.0, packed = 0.0;
        for (const double held : rig.held(c)) flux += held;
        CHECK(flux == Approx(total[std::size_t(c)]).epsilon(1e-5));
        // sum of L pi A of the words: L = colour / opacity.
        eachVoxel(32, [&](int x, int y, int z) {
            const LwVoxelValue v = level.value(0, x, y, z, rig.lit().unit);
            const float colour = c == 0 ? v.red : c == 1 ? v.green : v.blue;
            if (v.opacity > 0.0f)
                packed +=
                    double(colour / v.opacity) * kPi * double(area[rig.indexOf(x, y, z)]) * rig.area;
        });
        CHECK(packed == Approx(total[std::size_t(c)]).epsilon(0.005));
    }
}

TEST_CASE("texels off their wall by less than two voxels find it, others are counted", "[voxel_light]") {
    VoxelLightRig rig(16, 32, LW_VOXEL_MODE_ISOTROPIC, false);
    const std::vector<VoxelTriangle> wall = voxelSheet(16.0, 2.0, 30.0, 1);
    std::vector<VoxelTexel> texels = texelsOn(wall, 4000, {1.0, 1.0, 1.0}, 7);
    SECTION("on the very border of voxels, by what depth maps are off") {
        for (std::size_t i = 0; i < texels.size(); ++i) texels[i].at[0] += (int(i % 3) - 1) * 1e-3;
    }
    SECTION("by more than half a voxel, and with normals that lead elsewhere") {
        for (std::size_t i = 0; i < texels.size(); ++i) {
            texels[i].at[0] += (double(i % 19) - 9.0) / 10.0;
            if (i % 2) texels[i].normal = {0.0, 0.6, 0.8};
        }
    }
    const double total = totalOf(texels)[1];
    append(texels, {{{5.0, 5.0, 5.0}, {1.0, 0.0, 0.0}, {1.0, 1.0, 1.0}},
                    {{33.0, 5.0, 5.0}, {1.0, 0.0, 0.0}, {1.0, 1.0, 1.0}}});
    rig.setTriangles(wall);
    rig.shine(texels);
    CHECK(rig.texels().lost == 1);
    CHECK(rig.texels().outside == 1);
    double held = 0.0;
    for (const double v : rig.held(1)) held += v;
    CHECK(held == Approx(total).epsilon(1e-5));
}

TEST_CASE("a texel without surface in its voxel lights the nearest that has some", "[voxel_light]") {
    VoxelLightRig rig(16, 32, LW_VOXEL_MODE_ISOTROPIC, false);
    // Two walls; between them, in voxel 14's layer, what is nearer to voxel 13 or to 15. Normals lie in
    // the layer.
    std::vector<VoxelTriangle> walls = voxelSheet(13.5, 2.0, 30.0, 1);
    append(walls, voxelSheet(15.5, 2.0, 30.0, -1));
    rig.setTriangles(walls);
    rig.shine({{{14.2, 10.5, 10.5}, {0.0, 1.0, 0.0}, {1.0, 2.0, 3.0}},
               {{14.7, 20.5, 10.5}, {0.0, 0.0, 1.0}, {4.0, 5.0, 6.0}}});
    CHECK(rig.texels().lost == 0);
    for (int c = 0; c < 3; ++c) {
        const std::vector<double> held = rig.held(c);
        CHECK(held[rig.indexOf(13, 10, 10)] == Approx(1.0 + c).epsilon(1e-6));
        CHECK(held[rig.indexOf(15, 20, 10)] == Approx(4.0 + c).epsilon(1e-6));
    }
}

TEST_CASE("words lose less than half a percent of the mean irradiance, at contrasts of ten thousand",
          "[voxel_light][large]") {
    const bool isEven = GENERATE(false, true);
    VoxelLightRig rig(16, 32, LW_VOXEL_MODE_ISOTROPIC, false);
    const std::vector<VoxelTriangle> room = voxelRoom(2.3, 29.6);
    const LitRoom scene(700);
    const std::vector<VoxelTexel> even = texelsOn(room, 20000, {1.0, 0.73, 0.1}, 1);
    rig.setTriangles(isEven ? room : scene.triangles);
    rig.shine(isEven ? even : scene.texels);
    const std::vector<float> area = rig.floats(LW_SURFACE_AREA);
    std::vector<double> normal[3];
    for (std::size_t a = 0; a < 3; ++a)
        for (const cl_uint word : rig.plane(LW_SURFACE_NORMAL))
            normal[a].push_back((double(word >> (10 * a) & 1023u) - 511.0) / 511.0);
    const std::vector<float> axes[3] = {rig.floats(0), rig.floats(1), rig.floats(2)};
    const std::vector<double> flux[3] = {rig.held(0), rig.held(1), rig.held(2)};
    const VoxelLevel level = VoxelLevel::of(rig.volume, 0);
    const cl_int unit = rig.lit().unit;
    std::mt19937 random(4);
    std::uniform_real_distribution<double> place(5.0, 27.0);
    double squares = 0.0, mean = 0.0, worst = 0.0;
    constexpr int kPoints = 60;
    for (int i = 0; i < kPoints; ++i) {
        const std::array<double, 3> p = {place(random), place(random), place(random)};
        std::array<double, 3> exact{}, words{};
        eachVoxel(32, [&](int x, int y, int z) {
            const std::size_t at = rig.indexOf(x, y, z);
            if (!(area[at] > 0.0f)) return;
            const double d[3] = {x + 0.5 - p[0], y + 0.5 - p[1], z + 0.5 - p[2]};
            const double weight =
                std::max(0.0, d[i % 3]) / std::pow(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], 1.5);
            double covered = 0.0;
            for (std::size_t a = 0; a < 3; ++a)
                covered = std::max(
                    covered, 0.5 * (double(axes[a][at]) + std::fabs(double(area[at]) * normal[a][at])));
            const double opacity = std::min(1.0, covered);
            const LwVoxelValue v = level.value(0, x, y, z, unit);
            const double found[3] = {double(v.red), double(v.green), double(v.blue)};
            for (std::size_t c = 0; c < 3; ++c) {
                exact[c] += weight * opacity * flux[c][at] / (kPi * double(area[at]) * rig.area);
                words[c] += weight * found[c];
            }
        });
        // By the mean of the three colours, as an error of what is seen.
        const double e = (exact[0] + exact[1] + exact[2]) / 3, w = (words[0] + words[1] + words[2]) / 3;
        mean += e / kPoints;
        squares += (w - e) * (w - e) / kPoints;
        worst = std::max(worst, std::fabs(w - e));
    }
    CAPTURE(isEven, std::sqrt(squares) / mean, worst / mean);
    CHECK(std::sqrt(squares) < 0.005 * mean);
    CHECK(worst < 0.005 * mean);
}

TEST_CASE("light of any brightness makes the same words in other units", "[voxel_light][large]") {
    VoxelLightRig rig(16, 32, LW_VOXEL_MODE_ISOTROPIC, false);
    LitRoom scene(90);
    rig.setTriangles(scene.triangles);
    rig.shine(scene.texels);
    const std::vector<cl_uint> words = rig.words();
    const cl_int unit = rig.lit().unit;
    const int power = GENERATE(-72, -24, 8, 64);
    for (VoxelTexel& texel : scene.texels)
        for (double& flux : texel.flux) flux = std::ldexp(flux, power);
    rig.shine(scene.texels);
    CHECK((rig.lit().unit - unit) / (1 << 23) == power);
    CHECK(isSame(rig.words(), words));
}
