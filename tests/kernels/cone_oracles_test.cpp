// Cones through volumes whose light is known: empty, closed, a medium, a wall; and the same light by
// other ways.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/cone_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

constexpr double kPi = 3.14159265358979323846;

ConeGatherOptions optionsOf(int size, int mode = 0, std::uint32_t cones = 9) {
    ConeGatherOptions options;
    options.size = std::uint32_t(size);
    options.mode = LWVoxelMode(mode);
    options.cones = cones;
    options.distance = 2.0;
    return options;
}

// Voxels of one unit from the origin on; coarser grids about the same middle.
DeviceVoxels deviceVoxels(KernelRig& rig, const std::vector<HostVoxels>& grids) {
    DeviceVoxels d;
    packVoxels(d, grids, 1.0);
    for (std::size_t c = 0; c < grids.size(); ++c) {
        const double voxel = std::ldexp(1.0, int(c)), half = 0.5 * grids[0].size * (voxel - 1.0);
        d.place.push_back(conePlace(voxel, {-half, -half, -half}));
    }
    uploadVoxels(rig, d);
    return d;
}

ConeImage onePoint(Vec p, Vec n) {
    return {1, 1, {{p, n}}};
}

// Everything outside of [low, high) is opaque and sends `light`.
HostVoxels room(int size, int mode, int low, int high, double light, int thick = 1000) {
    return hostVoxels(size, mode, [=](int x, int y, int z) -> Rgba {
        const int least = std::min({x, y, z}), most = std::max({x, y, z});
        const bool isInside = least >= low && most < high,
                   isOutside = least < low - thick || most >= high + thick;
        if (isInside || isOutside) return {0, 0, 0, 0};
        return {light, 0.5 * light, 0.25 * light, 1.0};
    });
}

}  // namespace

TEST_CASE("an empty grid lets all of the environment in, and is open", "[cone_gather]") {
    KernelRig rig(GENERATE(1u, 16u));
    const int mode = 0;
    const DeviceVoxels voxels = deviceVoxels(rig, {hostVoxels(32, mode, [](int, int, int) {
                                                 return Rgba{0, 0, 0, 0};
                                             })});
    const std::uint32_t cones = GENERATE(6u, 9u, 16u, 64u, 256u);
    ConeGather pass(rig.device(), optionsOf(32, mode, cones));
    const ConeImage image = onePoint({16, 16, 16}, {0, 1, 0});
    const ConeLight dark = traceCones(rig, pass, voxels, image);
    CHECK(dark.irradiance == std::vector<float>(3, 0.0f));
    CHECK(double(dark.open[0]) == Approx(1.0));
    CHECK(double(dark.validity[0]) == Approx(1.0));
    const ConeLight lit = traceCones(rig, pass, voxels, image, {2.0f, 1.0f, 0.5f});
    for (std::size_t c = 0; c < 3; ++c)
        CHECK(double(lit.irradiance[c]) == Approx(kPi * std::ldexp(2.0, -int(c))).epsilon(1e-5));
}

TEST_CASE("a closed room of even radiance L lights its walls with pi L", "[cone_gather][large]") {
    KernelRig rig(16);
    const int mode = GENERATE(0, 1);
    // As thick around as it is wide, and more: cones that widen to its own width still end in the walls.
    const DeviceVoxels voxels = deviceVoxels(rig, {room(64, mode, 24, 40, 0.8)});
    const std::uint32_t cones = GENERATE(6u, 9u, 64u);
    ConeGatherOptions options = optionsOf(64, mode, cones);
    options.nudge = 2.0;
    ConeGather pass(rig.device(), options);
    const double e = kPi * 0.8;
    // Cones of even light are exact; what is missing has come out through the walls.
    for (const Vec p : {Vec{32, 24, 32}, Vec{27, 24, 37}, Vec{32, 24, 25}}) {
        const ConeLight light = traceCones(rig, pass, voxels, onePoint(p, {0, 1, 0}));
        CHECK(double(light.irradiance[0]) == Approx(e).epsilon(0.02));
        CHECK(double(light.irradiance[2]) == Approx(0.25 * e).epsilon(0.02));
        CHECK(double(light.validity[0]) == Approx(1.0));
    }
}

TEST_CASE("walls one voxel thick keep more of a room's light where they are opaque from each side",
          "[cone_gather][large]") {
    KernelRig rig(16);
    double kept[2];
    for (int mode = 0; mode < 2; ++mode) {
        const DeviceVoxels voxels = deviceVoxels(rig, {room(64, mode, 8, 56, 0.8, 1)});
        ConeGatherOptions options = optionsOf(64, mode, 9);
        options.nudge = 2.0;
        options.step = 0.5;
        ConeGather pass(rig.device(), options);
        kept[mode] =
            double(traceCones(rig, pass, voxels, onePoint({32, 8, 32}, {0, 1, 0})).irradiance[0]) /
            (kPi * 0.8);
    }
    CAPTURE(kept[0], kept[1]);
    CHECK(kept[0] < 0.8);
    CHECK(kept[1] > 0.95);
    CHECK(kept[1] < 1.0001);
}

// Most of them meet the walls aslant, where the squares of a direction's components take a wall for half open.
TEST_CASE("many cones keep a room's light between walls one voxel thick", "[cone_gather]") {
    KernelRig rig(16);
    const DeviceVoxels voxels = deviceVoxels(rig, {room(32, 1, 4, 28, 0.8, 1)});
    ConeGatherOptions options = optionsOf(32, 1, 64);
    options.nudge = 2.0;
    options.step = 0.5;
    ConeGather pass(rig.device(), options);
    const double kept =
        double(traceCones(rig, pass, voxels, onePoint({16, 4, 16}, {0, 1, 0})).irradiance[0]) / (kPi * 0.8);
    CAPTURE(kept);
    CHECK(kept > 0.97);
    CHECK(kept < 1.0001);
}

TEST_CASE("grids nested in each other and filled alike give what one grid gives",
          "[cone_gather][large]") {
    KernelRig rig(16);  // cone_gather_test has nested grids at both
    const auto even = [](int, int, int) { return Rgba{0.0625, 0.03125, 0.015625, 31.0 / 255.0}; };  // words without rounding
    const std::uint32_t cascades = GENERATE(2u, 3u);
    const DeviceVoxels one = deviceVoxels(rig, {hostVoxels(16 << (cascades - 1), 0, even)});
    const DeviceVoxels nested =
        deviceVoxels(rig, std::vector<HostVoxels>(cascades, hostVoxels(16, 0, even)));
    ConeGatherOptions options = optionsOf(16 << (cascades - 1));
    ConeGather single(rig.device(), options);
    options.size = 16;
    options.cascades = cascades;
    ConeGather pass(rig.device(), options);
    const double middle = 8.0, shift = 8.0 * ((1 << (cascades - 1)) - 1);
    const Vec n = reference::unit({0.2, 1, -0.3});
    const ConeLight a =
        traceCones(rig, single, one, onePoint({middle + shift, middle + shift, middle + shift}, n),
                   {1.0f, 1.0f, 1.0f});
    const ConeLight b =
        traceCones(rig, pass, nested, onePoint({middle, middle, middle}, n), {1.0f, 1.0f, 1.0f});
    // Words are dithered by their place, 0.8 % of opacity at most each, less of the mean over some
    // hundred.
    for (std::size_t c = 0; c < 3; ++c)
        CHECK(double(b.irradiance[c]) == Approx(double(a.irradiance[c])).epsilon(0.005));
    CHECK(b.validity == a.validity);
    // Outside of the fine grid cones begin in the coarse one, twice as far off.
    const ConeLight outside =
        traceCones(rig, pass, nested, onePoint({-2, 8, 8}, {1, 0, 0}), {1.0f, 1.0f, 1.0f});
    CHECK(double(outside.validity[0]) == Approx(1.0));
    CHECK(double(outside.irradiance[0]) == Approx(double(a.irradiance[0])).epsilon(0.25));
}

TEST_CASE("where all pixels are one surface, a window of shares of the cones is all of them",
          "[cone_gather][large][long]") {
    KernelRig rig(16);
    const DeviceVoxels voxels = deviceVoxels(rig, {room(32, 0, 6, 27, 0.8, 2)});
    const std::uint32_t cones = GENERATE(6u, 9u, 16u, 64u, 256u);
    ConeGatherOptions options = optionsOf(32, 0, cones);
    const Vec p{11.3, 6.5, 20.1}, n = reference::unit({0.1, 1, 0.2});
    const ConeImage image{53, 11, std::vector<ConePoint>(53 * 11, {p, n})};
    ConeGather whole(rig.device(), options);
    const ConeLight expected = traceCones(rig, whole, voxels, onePoint(p, n), {0.1f, 0.2f, 0.3f});
    options.interleaved = true;
    ConeGather pass(rig.device(), options);
    const ConeLight light = traceCones(rig, pass, voxels, image, {0.1f, 0.2f, 0.3f});
    for (std::size_t i = 0; i < image.points.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            REQUIRE(double(light.irradiance[c * image.points.size() + i]) ==
                    Approx(double(expected.irradiance[c])).epsilon(1e-4));
        REQUIRE(double(light.open[i]) == Approx(double(expected.open[0])).epsilon(1e-4));
        REQUIRE(double(light.validity[i]) == Approx(double(expected.validity[0])).epsilon(1e-4));
    }
}

TEST_CASE("cones give the same bits at any place in a list, and of both widths the same light",
          "[cone_gather][large]") {
    const bool interleaved = GENERATE(false, true);
    std::vector<ConePoint> points;
    for (int i = 0; i < 61 * 7; ++i) {
        const double a = 0.61803 * i, b = 0.75488 * i, c = 0.56984 * i;
        points.push_back(
            {{6 + 20 * (a - std::floor(a)), 6 + 20 * (b - std::floor(b)), 6 + 20 * (c - std::floor(c))},
             reference::unit({std::sin(3.0 * i), std::cos(5.0 * i), std::sin(7.0 * i + 1)})});
    }
    const ConeImage image{61, 7, points}, list{61 * 7, 1, points};
    ConeGatherOptions options = optionsOf(32);
    options.interleaved = interleaved;
    options.step = 0.5;
    std::vector<float> widths[2];
    for (const std::uint32_t width : {1u, 16u}) {
        KernelRig rig(width);
        const DeviceVoxels voxels = deviceVoxels(rig, {room(32, 0, 6, 27, 0.8, 2)});
        ConeGather pass(rig.device(), options);
        const ConeLight light = traceCones(rig, pass, voxels, image, {0.1f, 0.2f, 0.3f});
        for (int run = 0; run < 9; ++run)
            CHECK(bitDifference(traceCones(rig, pass, voxels, image, {0.1f, 0.2f, 0.3f}).irradiance,
                                light.irradiance) == "");
        if (!interleaved)
            CHECK(bitDifference(traceCones(rig, pass, voxels, list, {0.1f, 0.2f, 0.3f}).irradiance,
                                light.irradiance) == "");
        widths[width == 16] = light.irradiance;
    }
    CHECK(disagreement(widths[1], widths[0], 1e-5, 1e-4) == "");
}

TEST_CASE("what is no surface gets nothing from cones", "[cone_gather]") {
    KernelRig rig(GENERATE(1u, 16u));
    const DeviceVoxels voxels = deviceVoxels(rig, {room(32, 0, 6, 27, 0.8, 2)});
    const bool interleaved = GENERATE(false, true);
    ConeGatherOptions options = optionsOf(32);
    options.interleaved = interleaved;
    ConeGather pass(rig.device(), options);
    const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
    const ConeImage image{5,
                          1,
                          {{{nan, 8, 8}, {0, 1, 0}},
                           {{8, 8, 8}, {0, 0, 0}},
                           {{8, 8, 8}, {0, nan, 0}},
                           {{inf, 8, 8}, {0, 1, 0}},
                           {{-50, 8, 8}, {0, 1, 0}}}};
    const ConeLight light = traceCones(rig, pass, voxels, image, {1.0f, 1.0f, 1.0f});
    CHECK(light.irradiance == std::vector<float>(15, 0.0f));
    CHECK(light.validity == std::vector<float>(5, 0.0f));
    CHECK(light.open == std::vector<float>(5, 0.0f));
    CHECK(light.counts == std::vector<cl_int>{3, 0, 1});
}

TEST_CASE("both bands of cones over the sphere", "[cone_gather]") {
    KernelRig rig(GENERATE(1u, 16u));
    const bool hasNormals = GENERATE(false, true);
    // A room in walls that send 0.8 from +x and 0.2 from -x.
    const DeviceVoxels voxels =
        deviceVoxels(rig, {hostVoxels(64, 0, [](int x, int y, int z) {
                         const bool isInside = std::min({x, y, z}) >= 24 && std::max({x, y, z}) < 40;
                         const double l = x >= 32 ? 0.8 : 0.2;
                         return isInside ? Rgba{0, 0, 0, 0} : Rgba{l, 0.5 * l, 0.25 * l, 1.0};
                     })});
    const std::uint32_t cones = GENERATE(9u, 64u);
    ConeGather pass(rig.device(), optionsOf(64, 0, cones));
    const std::vector<ConePoint> points{
        {{32, 32, 32}, {0, 1, 0}}, {{std::nan(""), 0, 0}, {0, 1, 0}}, {{-9, 0, 0}, {0, 1, 0}}};
    const Guarded at = rig.uploadPlanes(conePlanes(points, false), 3, 1, 3, 0.0f),
                  facing = rig.uploadPlanes(conePlanes(points, true), 3, 1, 3, 0.0f),
                  out = rig.makePlanes(3, 1, 12), valid = rig.makePlanes(3, 1, 1),
                  counts = rig.upload(std::vector<cl_int>(3));
    const Planes all = rig.planes(out, 3, 1, 12);
    Harmonics harmonics;
    harmonics.first = all;
    harmonics.first.count = 3;
    harmonics.band = cl_int(3 * all.planeStride);
    const float environment[3] = {0.1f, 0.1f, 0.1f};
    const Planes v = rig.planes(valid, 3, 1, 1);
    pass.recordHarmonics(rig.executor(), rig.planes(at, 3, 1, 3),
                         hasNormals ? rig.planes(facing, 3, 1, 3) : Planes{},
                         {voxels.volume, voxels.places, environment}, harmonics, v, counts);
    rig.device().finish();
    const std::vector<float> bands = rig.downloadPlanes(all), validity = rig.downloadPlanes(v);
    const auto value = [&](std::size_t band, std::size_t colour) {
        return double(bands[3 * (3 * band + colour)]);
    };
    // L = 0.5 + 0.3 sign(x).
    const double y0 = 0.28209479177, y1 = 0.48860251190;
    CHECK(value(0, 0) == Approx(4 * kPi * y0 * 0.5).epsilon(0.02));
    CHECK(value(1, 0) == Approx(2 * kPi * y1 * 0.3).epsilon(0.1));
    CHECK(value(2, 0) == Approx(0.0).margin(0.05));
    CHECK(value(3, 0) == Approx(0.0).margin(0.05));
    CHECK(validity == std::vector<float>{validity[0], 0.0f, 0.0f});
    CHECK(double(validity[0]) == Approx(1.0));
    for (std::size_t k = 0; k < 12; ++k) CHECK((bands[3 * k + 1] == 0.0f && bands[3 * k + 2] == 0.0f));
}
