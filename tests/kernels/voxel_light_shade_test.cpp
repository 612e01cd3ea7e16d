// How voxels shine: by themselves, to either side, by what they have heard.
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

TEST_CASE("emissive surfaces shine by themselves", "[voxel_light]") {
    VoxelLightRig rig(16, 32, LW_VOXEL_MODE_ISOTROPIC, false);
    std::vector<VoxelTriangle> wall = voxelSheet(13.5, 4.0, 28.0, 1);
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
    rig.aware = aware ? 1 : 0;
    std::vector<VoxelTriangle> lit = voxelSheet(13.5, 0.0, 32.0, 1), wall = lit;
    append(wall, voxelSheet(13.5, 0.0, 32.0, -1));
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

TEST_CASE("a sheet shows its front's light to its front alone, and is opaque from behind where voxels are from both sides", "[voxel_light][large]") {
    const cl_int aware = GENERATE(1, 2);
    VoxelLightRig rig(GENERATE(1u, 16u), 32, LW_VOXEL_MODE_ANISOTROPIC, true);
    rig.aware = aware;
    const std::vector<VoxelTriangle> sheet = voxelSheet(13.5, 0.0, 32.0, 1);
    rig.setTriangles(sheet);
    rig.shine(texelsOn(sheet, 40000, {1.0, 1.0, 1.0}, 3));
    const VoxelLevel level = VoxelLevel::of(rig.volume, 0);
    double front = 0.0, back = 0.0;
    for (int y = 0; y < 32; ++y)
        for (int z = 0; z < 32; ++z) {
            const LwVoxelValue down = level.value(0, 13, y, z, rig.lit().unit), up = level.value(1, 13, y, z, rig.lit().unit);
            CHECK(down.opacity == 1.0f);
            CHECK(up.opacity == (aware == 2 ? 1.0f : 0.0f));
            front += double(down.red) / 1024;
            back += double(up.red) / 1024;
        }
    CHECK(front == Approx(1.0).epsilon(0.005));
    CHECK(back == Approx(0.0).margin(0.0025));
}

TEST_CASE("light on a sheet's back leaves by no other side, nor out of what stands in its voxels",
          "[voxel_light][large]") {
    VoxelLightRig rig(16, 32, LW_VOXEL_MODE_ANISOTROPIC, true);
    rig.aware = 1;
    // A sheet that faces down x, lit from above; in one voxel a sixteenth of it faces up, in another a
    // wall crosses it.
    const std::vector<VoxelTriangle> back = voxelSheet(13.5, 8.0, 24.0, 1);
    std::vector<VoxelTriangle> sheet = voxelSheet(13.5, 8.0, 24.0, -1),
                               wall = voxelSheet(20.5, 13.0, 14.0, 1);
    append(sheet, voxelSheet(13.7, 10.0, 10.25, 1));
    for (VoxelTriangle& t : wall)
        for (auto& corner : t.at) std::swap(corner[0], corner[1]);
    append(sheet, wall);
    rig.setTriangles(sheet);
    rig.shine(texelsOn(back, 40000, {1.0, 1.0, 1.0}, 3));
    const VoxelLevel level = VoxelLevel::of(rig.volume, 0);
    const auto seen = [&](int side, int x, int y, int z) {
        return level.value(side, x, y, z, rig.lit().unit);
    };
    // Some 156 texels fell on it.
    CHECK(double(seen(0, 13, 10, 10).opacity) == Approx(1.0 / 16).margin(1.0 / 255));
    CHECK(double(seen(0, 13, 10, 10).red) == Approx(1.0 / 16).epsilon(0.1));
    CHECK(seen(0, 13, 12, 12).red == 0.0f);
    CHECK(seen(1, 13, 12, 12).opacity == 1.0f);
    CHECK(seen(1, 13, 12, 12).red == 0.0f);
    const bool crosses = seen(2, 13, 20, 13).opacity > 0.5f || seen(3, 13, 20, 13).opacity > 0.5f;
    CHECK(crosses);
    for (int side = 2; side < 6; ++side) CHECK(seen(side, 13, 20, 13).red < 1e-5f);
}

TEST_CASE("SH2 keeps the flux of a wall, and shines to its own side", "[voxel_light][large]") {
    VoxelLightRig rig(16, 32, LW_VOXEL_MODE_SH2, false);
    const std::vector<VoxelTriangle> wall = voxelSheet(13.5, 0.0, 32.0, -1);
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

TEST_CASE("light too weak for the inverse of its brightness stays dark, and comes from nowhere", "[voxel_light][large]") {
    const LWVoxelMode mode = GENERATE(LW_VOXEL_MODE_SH2, LW_VOXEL_MODE_ANISOTROPIC);
    VoxelLightRig rig(GENERATE(1u, 16u), 32, mode, mode == LW_VOXEL_MODE_ANISOTROPIC);
    rig.aware = 1;
    rig.setTriangles(voxelSheet(13.5, 0.0, 32.0, -1));
    // Nearer to each other than the whole numbers in which light is added up reach.
    const double bright = 1e-21, weak = GENERATE(1e-39, 2e-39, 5e-39);
    rig.shine({{{13.5, 4.5, 4.5}, {-1, 0, 0}, {bright, bright, bright}}, {{13.5, 20.5, 20.5}, {-1, 0, 0}, {weak, weak, 0.0}}});
    const VoxelLevel level = VoxelLevel::of(rig.volume, 0);
    const int colours = mode == LW_VOXEL_MODE_ANISOTROPIC ? level.planes : 1;
    for (int plane = 0; plane < colours; ++plane) {
        const LwVoxelValue dark = level.value(plane, 13, 20, 20, rig.lit().unit);
        CAPTURE(weak, plane);
        CHECK(double(dark.red + dark.green + dark.blue) <= 1e-6 * bright);
        for (int c = 1; colours == 1 && c < level.planes; ++c)
            for (int axis = 0; axis < 3 && level.word(c, 13, 20, 20); ++axis)  // 0: of no light
                CHECK(std::abs(voxel_unpack_harmonic(level.word(c, 13, 20, 20), axis, 1.0f)) < 0.01f);
    }
}

TEST_CASE("voxels that hold surfaces hear, and throw back their albedo over pi of it", "[voxel_light]") {
    VoxelLightRig rig(16, 32, LW_VOXEL_MODE_ISOTROPIC, false);
    rig.hears = true;
    std::vector<VoxelTriangle> triangles = voxelRoom(2.3, 29.6);
    for (VoxelTriangle& t : triangles) t.albedo = {0.2f, 0.4f, 0.8f};
    append(triangles, voxelSheet(13.5, 8.0, 16.0, 1));
    append(triangles, voxelSheet(13.5, 8.0, 16.0, -1));  // both sides: it faces up x, with the first
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
    append(triangles, voxelSheet(13.5, 8.0, 16.0, 1));
    rig.setTriangles(triangles);
    rig.shine({});
    CHECK(rig.value(0, 13, 10, 10).opacity == 1.0f);
    CHECK(rig.value(0, 13, 10, 10).red == 0.0f);
    CHECK(rig.value(0, 10, 2, 20).red == wall.red);
}
