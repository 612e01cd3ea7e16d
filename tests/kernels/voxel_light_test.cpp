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

// Two triangles across all of a box along axis 0 of which `facing` says the way: a sheet.
std::vector<VoxelTriangle> sheet(double at, double lo, double hi, int facing) {
    const std::array<double, 3> a = {at, lo, lo}, b = {at, hi, lo}, c = {at, hi, hi}, d = {at, lo, hi};
    if (facing > 0) return {{{a, b, c}}, {{a, c, d}}};
    return {{{a, c, b}}, {{a, d, c}}};
}
void append(std::vector<VoxelTriangle>& to, const std::vector<VoxelTriangle>& more) {
    to.insert(to.end(), more.begin(), more.end());
}
void append(std::vector<VoxelTexel>& to, const std::vector<VoxelTexel>& more) {
    to.insert(to.end(), more.begin(), more.end());
}

// The room, a slanted sheet in it, and light of 10^4 : 1 from wall to wall, coloured.
struct Lit {
    std::vector<VoxelTriangle> triangles = voxelRoom(2.3, 29.6);
    std::vector<VoxelTexel> texels;
    explicit Lit(std::size_t each) {
        triangles.push_back(
            {{std::array<double, 3>{8.0, 5.0, 9.0}, {20.0, 9.0, 11.0}, {14.0, 21.0, 17.0}}});
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            const double bright = std::pow(10.0, -4.0 * double(t) / double(triangles.size() - 1));
            append(texels,
                   texelsOn({triangles[t]}, each, {bright, 0.5 * bright, 0.2 * bright}, unsigned(t)));
        }
    }
};

// Not for Catch to print.
bool isSame(const std::vector<cl_uint>& a, const std::vector<cl_uint>& b) {
    return !a.empty() && a == b;
}

std::array<double, 3> totalOf(const std::vector<VoxelTexel>& texels) {
    std::array<double, 3> sum{};
    for (const VoxelTexel& t : texels)
        for (std::size_t c = 0; c < 3; ++c) sum[c] += t.flux[c];
    return sum;
}

}  // namespace

TEST_CASE("a voxel's light is its texels' flux over pi and its surfaces' area, and all flux arrives",
          "[voxel_light][large]") {
    VoxelLightRig rig(16, 32, LW_VOXEL_MODE_ISOTROPIC, false);
    Lit scene(700);
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

TEST_CASE("the same words in any order of texels and at any width", "[voxel_light][large]") {
    const auto mode = GENERATE(LW_VOXEL_MODE_ISOTROPIC, LW_VOXEL_MODE_ANISOTROPIC, LW_VOXEL_MODE_SH2);
    const bool sides = mode == LW_VOXEL_MODE_ANISOTROPIC;
    VoxelLightRig wide(16, 32, mode, sides), narrow(1, 32, mode, sides);
    Lit scene(90);
    for (VoxelLightRig* rig : {&wide, &narrow}) {
        rig->aware = sides;
        rig->setTriangles(scene.triangles);
        rig->shine(scene.texels);
    }
    const std::vector<cl_uint> words = wide.words();
    CHECK(isSame(narrow.words(), words));
    std::reverse(scene.texels.begin(), scene.texels.end());
    for (int run = 0; run < 3; ++run) {
        wide.light.forget();
        wide.shine(scene.texels);
        CHECK(isSame(wide.words(), words));
        std::shuffle(scene.texels.begin(), scene.texels.end(), std::mt19937(unsigned(run)));
    }
}

TEST_CASE("words lose less than half a percent of the mean irradiance, at contrasts of ten thousand",
          "[voxel_light][large]") {
    const bool isEven = GENERATE(false, true);
    VoxelLightRig rig(16, 32, LW_VOXEL_MODE_ISOTROPIC, false);
    const std::vector<VoxelTriangle> room = voxelRoom(2.3, 29.6);
    const Lit scene(700);
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

TEST_CASE("bricks whose light and surfaces stay are not made again, and come out as if they were",
          "[voxel_light][large]") {
    const auto mode = GENERATE(LW_VOXEL_MODE_ISOTROPIC, LW_VOXEL_MODE_ANISOTROPIC);
    VoxelLightRig rig(16, 32, mode, false), anew(16, 32, mode, false);
    Lit scene(90);
    rig.setTriangles(scene.triangles);
    rig.shine(scene.texels);
    const std::vector<cl_uint> first = rig.words();
    CHECK(rig.lit().changedBricks > 8);
    rig.shine(scene.texels);
    CHECK(rig.lit().changedBricks == 0);
    CHECK(rig.lit().filteredBricks == 0);
    CHECK(isSame(rig.words(), first));
    // One texel's light halves; then its triangle moves as well; then all goes out.
    for (double& flux : scene.texels[17].flux) flux *= 0.5;
    rig.shine(scene.texels);
    CHECK(rig.lit().changedBricks == 1);
    CHECK(rig.lit().filteredBricks == voxel_levels(32) - 1);
    anew.setTriangles(scene.triangles);
    anew.shine(scene.texels);
    CHECK(isSame(rig.words(), anew.words()));
    CHECK(!isSame(rig.words(), first));
    scene.triangles.back().at[0][2] += 6.0;
    rig.setTriangles(scene.triangles);
    rig.shine(scene.texels);
    anew.setTriangles(scene.triangles);
    anew.light.forget();
    anew.shine(scene.texels);
    CHECK(isSame(rig.words(), anew.words()));
    rig.shine({});
    anew.light.forget();
    anew.shine({});
    CHECK(isSame(rig.words(), anew.words()));
    CHECK(totalOf(scene.texels)[0] > 0.0);
    for (const double held : rig.held(0)) REQUIRE(held == 0.0);
}

TEST_CASE("light of any brightness makes the same words in other units", "[voxel_light]") {
    VoxelLightRig rig(16, 32, LW_VOXEL_MODE_ISOTROPIC, false);
    Lit scene(90);
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

TEST_CASE("emissive surfaces shine by themselves", "[voxel_light]") {
    VoxelLightRig rig(16, 32, LW_VOXEL_MODE_ISOTROPIC, false);
    std::vector<VoxelTriangle> wall = sheet(13.5, 4.0, 28.0, 1);
    for (VoxelTriangle& t : wall) t.emission = {8.0f, 4.0f, 2.0f};
    rig.setTriangles(wall);
    rig.shine({}, true);
    const LwVoxelValue v = rig.value(0, 13, 10, 10);
    CHECK(v.opacity == 1.0f);
    CHECK(double(v.red) == Approx(8.0).epsilon(1.0 / 32));
    CHECK(double(v.green) == Approx(4.0).epsilon(1.0 / 32));
    CHECK(double(v.blue) == Approx(2.0).epsilon(1.0 / 16));
}

TEST_CASE("a thin wall shows each side its own light where voxels know what faces them",
          "[voxel_light][large]") {
    const bool aware = GENERATE(false, true);
    VoxelLightRig rig(16, 32, LW_VOXEL_MODE_ANISOTROPIC, true);
    rig.aware = aware;
    std::vector<VoxelTriangle> lit = sheet(13.5, 0.0, 32.0, 1), wall = lit;
    append(wall, sheet(13.5, 0.0, 32.0, -1));
    rig.setTriangles(wall);
    rig.shine(texelsOn(lit, 40000, {1.0, 1.0, 1.0}, 3));
    double down = 0.0, up = 0.0, across = 0.0;
    const VoxelLevel level = VoxelLevel::of(rig.volume, 0);
    eachVoxel(32, [&](int x, int y, int z) {
        if (x != 13) return;
        const LwVoxelValue from[3] = {level.value(0, x, y, z, rig.lit().unit),
                                      level.value(1, x, y, z, rig.lit().unit),
                                      level.value(2, x, y, z, rig.lit().unit)};
        CHECK(from[0].opacity == 1.0f);
        CHECK(from[1].opacity == 1.0f);
        CHECK(from[2].opacity == 0.0f);
        down += double(from[0].red) / 1024;
        up += double(from[1].red) / 1024;
        across += double(from[2].red) / 1024;
    });
    // Rays that go down x see what faces up. Both together have the light of one side.
    CHECK(down == Approx(aware ? 1.0 : 0.5).epsilon(0.005));
    CHECK(up == Approx(aware ? 0.0 : 0.5).margin(0.0025));
    CHECK(across == 0.0);
}

TEST_CASE("SH2 keeps the flux of a wall, and shines to its own side", "[voxel_light][large]") {
    VoxelLightRig rig(16, 32, LW_VOXEL_MODE_SH2, false);
    const std::vector<VoxelTriangle> wall = sheet(13.5, 0.0, 32.0, -1);
    rig.setTriangles(wall);
    rig.shine(texelsOn(wall, 40000, {1.0, 1.0, 1.0}, 3));
    const VoxelLevel level = VoxelLevel::of(rig.volume, 0);
    double c0 = 0.0, c1[3] = {0.0, 0.0, 0.0};
    eachVoxel(32, [&](int x, int y, int z) {
        if (x != 13) return;
        const float first = level.value(0, x, y, z, rig.lit().unit).red;
        c0 += double(first) / 1024;
        for (int a = 0; a < 3; ++a)
            c1[a] += double(voxel_unpack_harmonic(level.word(1, x, y, z), a, first)) / 1024;
    });
    const double y0 = 0.5 / std::sqrt(kPi), y1 = std::sqrt(3.0 / (4.0 * kPi));
    // Flux through the wall to its side: the integral of L times the cosine, pi L0 + 2 pi / 3 L1 with L
    // = L0 + L1 cos.
    CHECK(kPi * y0 * c0 + 2.0 * kPi / 3.0 * y1 * -c1[0] == Approx(kPi).epsilon(0.005));
    CHECK(y0 * c0 - y1 * c1[0] == Approx(1.25).epsilon(0.005));
    CHECK(c1[1] == Approx(0.0).margin(0.005));
}

TEST_CASE("texels beside their wall's voxel find it, those without a surface are counted",
          "[voxel_light]") {
    VoxelLightRig rig(16, 32, LW_VOXEL_MODE_ISOTROPIC, false);
    // On the very border of voxels, texels off by what depth maps are.
    const std::vector<VoxelTriangle> wall = sheet(16.0, 2.0, 30.0, 1);
    std::vector<VoxelTexel> texels = texelsOn(wall, 4000, {1.0, 1.0, 1.0}, 7);
    for (std::size_t i = 0; i < texels.size(); ++i) texels[i].at[0] += (int(i % 3) - 1) * 1e-3;
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

TEST_CASE("voxels that hold surfaces hear, and throw back their albedo over pi of it", "[voxel_light]") {
    VoxelLightRig rig(16, 32, LW_VOXEL_MODE_ISOTROPIC, false);
    rig.hears = true;
    std::vector<VoxelTriangle> triangles = voxelRoom(2.3, 29.6);
    for (VoxelTriangle& t : triangles) t.albedo = {0.2f, 0.4f, 0.8f};
    append(triangles, sheet(13.5, 8.0, 16.0, 1));
    append(triangles, sheet(13.5, 8.0, 16.0, -1));  // both sides: it faces up x, with the first
    rig.setTriangles(triangles);
    rig.shine({});
    const Planes list = rig.receivers.position();
    const auto count =
        std::size_t(VoxelLightRig::read<LwVoxelReceivers>(rig.receivers.state(), 1)[0].receivers);
    CHECK(VoxelLightRig::read<LwVoxelReceivers>(rig.receivers.state(), 1)[0].missing == 0);
    std::vector<float> points[6];
    for (std::size_t p = 0; p < 6; ++p) {
        const Planes planes = p < 3 ? list : rig.receivers.normal();
        points[p].resize(std::size_t(planes.planeStride));
        rig.executor().read("test.read", planes.memory,
                            (std::size_t(planes.offset) + p % 3 * points[p].size()) * sizeof(float),
                            points[p].size() * sizeof(float), points[p].data());
    }
    rig.device().finish();
    // Every voxel with surfaces once, in its middle.
    const std::vector<float> area = rig.floats(LW_SURFACE_AREA);
    std::size_t with = 0, wrong = 0;
    for (const float a : area) with += a > 0.0f;
    CHECK(count == with);
    std::vector<float> heard(points[0].size() * 3);
    std::vector<int> times(area.size());
    for (std::size_t i = 0; i < points[0].size(); ++i) {
        if (i >= count) {
            wrong += points[3][i] != 0.0f || points[4][i] != 0.0f || points[5][i] != 0.0f;
            continue;
        }
        int at[3];
        for (std::size_t a = 0; a < 3; ++a) {
            const double place =
                (double(points[a][i]) - double(rig.place.origin.s[a])) / VoxelLightRig::kCell;
            at[a] = int(place);
            wrong += std::fabs(place - at[a] - 0.5) > 1e-4;
        }
        ++times[rig.indexOf(at[0], at[1], at[2])];
        wrong += std::fabs(points[3][i] * points[3][i] + points[4][i] * points[4][i] +
                           points[5][i] * points[5][i] - 1.0f) > 1e-5f;
        if (at[0] == 13 && at[1] > 8 && at[1] < 15 && at[2] > 8 && at[2] < 15)
            wrong += points[3][i] != 1.0f;
        for (std::size_t c = 0; c < 3; ++c)
            heard[c * points[0].size() + i] = float(at[0] + 32 * at[1] + 1024 * at[2]);
    }
    for (std::size_t i = 0; i < area.size(); ++i) wrong += times[i] != (area[i] > 0.0f);
    CHECK(wrong == 0);
    const auto hear = [&] {
        const Planes to = rig.receivers.irradiance();
        const Buffer memory = Buffer::retained(rig.device(), to.memory);
        rig.executor().write("test.write", memory, 0, heard.size() * sizeof(float), heard.data());
        rig.receivers.recordHeard(rig.executor(), rig.light);
        rig.shine({});
    };
    hear();
    const LwVoxelValue wall = rig.value(0, 10, 2, 20);
    const double irradiance = 10 + 32 * 2 + 1024 * 20;
    CHECK(wall.opacity == 1.0f);
    CHECK(double(wall.red) == Approx(0.2 / kPi * irradiance).epsilon(0.1));
    CHECK(double(wall.blue) == Approx(0.8 / kPi * irradiance).epsilon(1.0 / 32));
    // The same again is no news.
    const std::vector<cl_uint> words = rig.words();
    hear();
    CHECK(rig.lit().changedBricks == 0);
    CHECK(isSame(rig.words(), words));
    // What comes to where a surface was is forgotten with it.
    triangles.resize(12);
    rig.setTriangles(triangles);
    rig.shine({});
    rig.setTriangles(triangles);
    append(triangles, sheet(13.5, 8.0, 16.0, 1));
    rig.setTriangles(triangles);
    rig.shine({});
    CHECK(rig.value(0, 13, 10, 10).opacity == 1.0f);
    CHECK(rig.value(0, 13, 10, 10).red == 0.0f);
    CHECK(rig.value(0, 10, 2, 20).red == wall.red);
}
