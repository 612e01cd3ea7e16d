// Single cones: along the lobe, refracted, towards a light.
#include <catch2/catch.hpp>
#include <cmath>

#include "passes/cone_rays.h"
#include "support/cone_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

DeviceVoxels deviceVoxels(KernelRig& rig, const HostVoxels& host) {
    DeviceVoxels d;
    packVoxels(d, {host}, 1.0);
    d.place.push_back(conePlace(1.0, {0, 0, 0}));
    uploadVoxels(rig, d);
    return d;
}

ConeGatherOptions optionsOf(int size, int mode = 0) {
    ConeGatherOptions options;
    options.size = std::uint32_t(size);
    options.mode = LWVoxelMode(mode);
    options.distance = 2.0;
    return options;
}

double shadowOf(KernelRig& rig, ConeRays& rays, const DeviceVoxels& voxels, Vec p, Vec n,
                const ConeLightSource& light) {
    const std::vector<ConePoint> points{{p, n}};
    const Guarded at = rig.uploadPlanes(conePlanes(points, false), 1, 1, 3, 0.0f),
                  facing = rig.uploadPlanes(conePlanes(points, true), 1, 1, 3, 0.0f),
                  out = rig.makePlanes(1, 1, 1);
    const float none[3] = {0, 0, 0};
    const Planes shadow = rig.planes(out, 1, 1, 1);
    rays.recordShadow(rig.executor(), rig.planes(at, 1, 1, 3), rig.planes(facing, 1, 1, 3), light,
                      {voxels.volume, voxels.places, none}, shadow);
    rig.device().finish();
    return double(rig.downloadPlanes(shadow)[0]);
}

ConeLightSource directional(float x, float y, float z, double angle) {
    ConeLightSource light;
    light.at[0] = x;
    light.at[1] = y;
    light.at[2] = z;
    light.isDirectional = true;
    light.fullAngle = angle;
    return light;
}

}  // namespace

TEST_CASE("a homogeneous medium is the same whatever it is cut into", "[cone_rays]") {
    KernelRig rig(GENERATE(1u, 16u));
    // 64 / 255 is a word's opacity, without rounding.
    const double a = 64.0 / 255.0;
    const DeviceVoxels voxels = deviceVoxels(rig, hostVoxels(32, 0, [a](int, int, int) {
                                                 return Rgba{0, 0, 0, a};
                                             }));
    for (const double step : {1.0, 0.5, 0.25}) {
        ConeGatherOptions options = optionsOf(32);
        options.step = step;
        options.distance = 15.9 / 32;
        ConeRays rays(rig.device(), options);
        // A cone of 60 degrees: two voxels' steps, then three in which the distance doubles.
        const double seen = shadowOf(rig, rays, voxels, {2, 16, 16}, {1, 0, 0},
                                     directional(1, 0, 0, 3.14159265358979 / 3));
        CHECK(seen == Approx(std::pow(1 - a, 5)).epsilon(1e-4));
    }
}

TEST_CASE("a full wall one voxel thick blocks a cone of matching width", "[cone_rays][large]") {
    KernelRig rig(16);
    const int level = GENERATE(0, 1, 2, 3);
    // The wall's voxel is the first of its cell; a sample of the cone lies in the middle of the cell.
    const int wall = 24;
    const double middle = wall + 0.5 * (1 << level);
    // Cones of 60 degrees that begin one voxel off: samples at 1 + 0.5, 1.5, 3, 6, 12 of levels 0, 0, 1,
    // 2, 3.
    const double distance = 1.0 + 1.5 * (1 << level);
    double seen[2];
    for (int mode = 0; mode < 2; ++mode) {
        const DeviceVoxels voxels =
            deviceVoxels(rig, hostVoxels(64, mode, [=](int x, int, int) {
                             return x == wall ? Rgba{0.5, 0.5, 0.5, 1} : Rgba{0, 0, 0, 0};
                         }));
        ConeRays rays(rig.device(), optionsOf(64, mode));
        seen[mode] = shadowOf(rig, rays, voxels, {middle - distance, 32, 32}, {1, 0, 0},
                              directional(1, 0, 0, 3.14159265358979 / 3));
    }
    CAPTURE(level, seen[0], seen[1]);
    CHECK(seen[1] == Approx(0.0).margin(1e-3));
    // Isotropic means leave 1 - 2^-level of what comes to that sample; others, before and after, take
    // their part.
    if (level == 3) CHECK(seen[0] > 0.5);
}

TEST_CASE("shadows of lights before and behind a wall, and from behind the surface", "[cone_rays]") {
    KernelRig rig(GENERATE(1u, 16u));
    const DeviceVoxels voxels =
        deviceVoxels(rig, hostVoxels(32, 0, [](int x, int, int) {
                         return x >= 20 && x < 23 ? Rgba{0, 0, 0, 1} : Rgba{0, 0, 0, 0};
                     }));
    ConeRays rays(rig.device(), optionsOf(32));
    ConeLightSource lamp;
    lamp.at[0] = 28.0f;
    lamp.at[1] = lamp.at[2] = 16.0f;
    CHECK(shadowOf(rig, rays, voxels, {6, 16, 16}, {1, 0, 0}, lamp) == Approx(0.0).margin(1e-3));
    lamp.at[0] = 17.0f;
    CHECK(shadowOf(rig, rays, voxels, {6, 16, 16}, {1, 0, 0}, lamp) == Approx(1.0));
    CHECK(shadowOf(rig, rays, voxels, {6, 16, 16}, {-1, 0, 0}, lamp) == 0.0);
    lamp.at[0] = 19.0f;  // what stands behind a lamp, nearer than cones begin off surfaces, does not shadow it
    CHECK(shadowOf(rig, rays, voxels, {6, 16, 16}, {1, 0, 0}, lamp) == Approx(1.0));
    CHECK(shadowOf(rig, rays, voxels, {6, 16, 16}, {1, 0, 0}, directional(1, 0, 0, 0.05)) ==
          Approx(0.0).margin(1e-3));
    CHECK(shadowOf(rig, rays, voxels, {6, 16, 16}, {1, 0, 0}, directional(0.1f, 1, 0, 0.05)) ==
          Approx(1.0));
    // Beside the edge of half a wall, a wider light is seen in part.
    const DeviceVoxels half =
        deviceVoxels(rig, hostVoxels(32, 0, [](int x, int y, int) {
                         return x >= 20 && x < 24 && y >= 16 ? Rgba{0, 0, 0, 1} : Rgba{0, 0, 0, 0};
                     }));
    const double penumbra = shadowOf(rig, rays, half, {6, 16, 16}, {1, 0, 0}, directional(1, 0, 0, 0.5));
    CHECK(penumbra > 0.2);
    CHECK(penumbra < 0.8);
}

namespace {

struct Ray {
    Vec position, normal;
    double roughness;
};

std::vector<float> radianceOf(KernelRig& rig, const ConeGatherOptions& options,
                              const DeviceVoxels& voxels, const std::vector<Ray>& rays, Vec eye,
                              double index) {
    std::vector<ConePoint> points;
    std::vector<float> roughness;
    for (const Ray& ray : rays) {
        points.push_back({ray.position, ray.normal});
        roughness.push_back(float(ray.roughness));
    }
    const auto count = std::uint32_t(rays.size());
    const Guarded at = rig.uploadPlanes(conePlanes(points, false), count, 1, 3, 0.0f),
                  facing = rig.uploadPlanes(conePlanes(points, true), count, 1, 3, 0.0f),
                  rough = rig.uploadPlanes(roughness, count, 1, 1, 0.0f),
                  out = rig.makePlanes(count, 1, 3), counts = rig.upload(std::vector<cl_int>(3));
    const float environment[3] = {0, 0, 0};
    ConeRays pass(rig.device(), options);
    const Planes light = rig.planes(out, count, 1, 3), position = rig.planes(at, count, 1, 3),
                 normal = rig.planes(facing, count, 1, 3), r = rig.planes(rough, count, 1, 1);
    const ConeWorld world{voxels.volume, voxels.places, environment};
    const lw_float4 from = float4(eye.x, eye.y, eye.z, 1.0);
    if (index > 0.0)
        pass.recordRefraction(rig.executor(), position, normal, r, 0.5, index, from, world, light,
                              counts);
    else
        pass.recordSpecular(rig.executor(), position, normal, r, 0.5, from, world, light, counts);
    rig.device().finish();
    return rig.downloadPlanes(light);
}

// A room whose walls, from 6 voxels to the border, have a light each: -x 0.1, +x 0.2, -y 0.3, +y 0.4, -z
// 0.5, +z 0.6.
HostVoxels sides(int size) {
    return hostVoxels(size, 0, [=](int x, int y, int z) -> Rgba {
        const int p[3] = {x, y, z};
        for (int a = 0; a < 3; ++a)
            for (int up = 0; up < 2; ++up)
                if (up ? p[a] >= size - 6 : p[a] < 6) {
                    const double l = 0.1 * (2 * a + up + 1);
                    return {l, l, l, 1};
                }
        return {0, 0, 0, 0};
    });
}

}  // namespace

TEST_CASE("a mirror shows the wall that it looks at, at both widths", "[cone_rays]") {
    KernelRig rig(GENERATE(1u, 16u));
    const DeviceVoxels voxels = deviceVoxels(rig, sides(64));
    // From the middle of the room onto surfaces that mirror straight back, or around a corner.
    const std::vector<Ray> rays{{{40, 32, 32}, {-1, 0, 0}, 0.0},
                                {{32, 40, 32}, {0, -1, 0}, 0.1},
                                {{40, 32, 32}, reference::unit({-1, 1, 0}), 0.0},
                                {{40, 32, 32}, {-1, 0, 0}, std::nan("")},
                                {{40, 32, 32}, {0, 0, 0}, 0.0}};
    const auto light = radianceOf(rig, optionsOf(64), voxels, rays, {32, 32, 32}, 0.0);
    // What of a wall is missing has come through it, as it is seen by cells of its own width.
    CHECK(double(light[0]) == Approx(0.1).epsilon(0.02));
    CHECK(double(light[1]) == Approx(0.3).epsilon(0.02));
    CHECK(double(light[2]) == Approx(0.4).epsilon(0.02));
    // Rough: of the hemisphere about -x, most of it the wall straight on and its neighbours.
    CHECK(double(light[3]) > 0.1);
    CHECK(double(light[3]) < 0.5);
    CHECK(light[4] == 0.0f);
}

TEST_CASE("refraction goes on, bends, and is mirrored beyond the critical angle", "[cone_rays][large]") {
    KernelRig rig(GENERATE(1u, 16u));
    const DeviceVoxels voxels = deviceVoxels(rig, sides(64));
    const Vec eye{32, 32, 32};
    const std::vector<Ray> front{{{40, 32, 32}, {-1, 0, 0}, 0.0}, {{40, 40, 32}, {-1, 0, 0}, 0.0}};
    // Straight on: +x. At 45 degrees with index 1, which does not bend: the edge of +x and +y; with 4,
    // almost straight into +x.
    CHECK(double(radianceOf(rig, optionsOf(64), voxels, front, eye, 1.0)[0]) ==
          Approx(0.2).epsilon(0.02));
    CHECK(double(radianceOf(rig, optionsOf(64), voxels, front, eye, 4.0)[1]) ==
          Approx(0.2).epsilon(0.02));
    // From inside: beyond asin(1 / 1.5) = 42 degrees all is mirrored: at the plane x = 40, seen from
    // below at 45 degrees, up into +y.
    const std::vector<Ray> back{{{40, 40, 32}, {1, 0, 0}, 0.0}};
    CHECK(double(radianceOf(rig, optionsOf(64), voxels, back, eye, 1.5)[0]) ==
          Approx(0.4).epsilon(0.02));
}
