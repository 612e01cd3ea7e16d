// Irradiance from cones through voxels: against loops in double, closed forms, and itself.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "reference/cone_twin.h"
#include "support/cone_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::ConeTwin;
using reference::Vec;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kVoxel = 0.25;
constexpr Vec kOrigin{-3.0, 1.0, 8.0};

ConeGatherOptions optionsOf(const HostVoxels& voxels) {
    ConeGatherOptions options;
    options.size = std::uint32_t(voxels.size);
    options.mode = LWVoxelMode(voxels.mode);
    options.sides = voxels.sides;
    return options;
}

DeviceVoxels deviceVoxels(KernelRig& rig, const std::vector<HostVoxels>& grids, double scale = 1.0) {
    DeviceVoxels d;
    packVoxels(d, grids, scale);
    for (std::size_t c = 0; c < grids.size(); ++c) {
        // Nested about the same middle.
        const double voxel = kVoxel * std::ldexp(1.0, int(c)),
                     half = 0.5 * grids[0].size * (voxel - kVoxel);
        d.place.push_back(conePlace(voxel, kOrigin - Vec{half, half, half}));
    }
    uploadVoxels(rig, d);
    return d;
}

// Blobs of light and opacity in a third of the bricks.
HostVoxels someVoxels(int size, int mode, bool sides, unsigned seed = 5) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    HostVoxels v{size, mode, sides, {}};
    for (int level = 0; level < voxel_levels(size); ++level) {
        const int n = v.sideOf(level);
        std::vector<std::vector<Rgba>> planes(std::size_t(v.planesOf(level)),
                                              std::vector<Rgba>(std::size_t(n * n * n)));
        for (int z = 0; z < n; ++z)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x) {
                    const int brick = x / 8 + 3 * (y / 8) + 5 * (z / 8);
                    const bool filled = level > 2 || brick % 3 == 0;
                    for (auto& plane : planes) {
                        const double opacity = filled ? std::pow(unit(random), 3.0) : 0.0;
                        Rgba c{opacity * unit(random), opacity * unit(random), opacity * unit(random),
                               opacity};
                        const bool isBands = mode == 2 && &plane != &planes[0] &&
                                             !(level == 0 && sides && &plane < &planes[6]);
                        if (isBands)
                            for (std::size_t a = 0; a < 3; ++a) c[a] = unit(random) - 0.5;
                        plane[v.index(level, x, y, z)] = c;
                    }
                }
        v.levels.push_back(planes);
    }
    return v;
}

ConeImage somePoints(std::uint32_t width, std::uint32_t height, double side) {
    std::mt19937 random(8);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    ConeImage image{width, height, {}};
    for (std::uint32_t i = 0; i < width * height; ++i) {
        const Vec centre = kOrigin + Vec{1, 1, 1} * (0.5 * side);
        const Vec p = centre + Vec{unit(random), unit(random), unit(random)} * (0.55 * side);
        image.points.push_back(
            {p, i % 17 == 5 ? Vec{} : reference::unit({unit(random), unit(random), unit(random)})});
    }
    return image;
}

void checkTwin(KernelRig& rig, const ConeGatherOptions& options, const DeviceVoxels& voxels,
               const ConeImage& image) {
    ConeGather pass(rig.device(), options);
    const std::array<float, 3> environment{0.5f, 0.25f, 0.125f};
    const ConeLight light = traceCones(rig, pass, voxels, image, environment);
    const ConeTwin twin{voxels, options, {0.5, 0.25, 0.125}};
    const auto set = coneHemisphere(options.cones);
    const std::size_t count = image.points.size();
    std::vector<float> irradiance(3 * count), validity(count), open(count);
    for (std::size_t i = 0; i < count; ++i) {
        const ConePoint& point = image.points[i];
        if (!(reference::dot(point.normal, point.normal) > 0.25)) continue;
        const ConeTwin::Gathered g = twin.gather(point.position, point.normal, set);
        for (std::size_t c = 0; c < 3; ++c) irradiance[c * count + i] = float(g.irradiance[c]);
        validity[i] = float(g.validity);
        open[i] = float(g.open);
    }
    // Places are known to 1e-6 of the grid, which moves samples by that times what changes between
    // voxels. A cone that ends at the border may take one sample more or less.
    CHECK(disagreement(light.irradiance, irradiance, 1e-4, 2e-3) == "");
    CHECK(disagreement(light.validity, validity, 1e-5, 2e-3) == "");
    CHECK(disagreement(light.open, open, 1e-4, 2e-3) == "");
}

}  // namespace

TEST_CASE("cones are what a loop over their samples makes of the same words", "[cone_gather]") {
    // Width, mode and sides, cascades: each mode with and without sides, each at both widths.
    struct Case {
        std::uint32_t width;
        int mode;
        bool sides;
        std::uint32_t cascades;
        bool tetrahedral = false, plane = false;
    };
    const Case c = GENERATE(Case{1, 0, false, 1}, Case{16, 0, false, 1}, Case{16, 0, true, 1},
                            Case{1, 1, true, 1}, Case{16, 1, false, 1}, Case{1, 2, false, 1},
                            Case{16, 2, true, 1, false, true}, Case{1, 0, false, 3}, Case{16, 0, false, 3, false, true},
                            Case{16, 0, false, 1, true}, Case{16, 1, true, 1, true, true}, Case{1, 2, true, 1, true},
                            Case{16, 1, true, 1, false, true});
    KernelRig rig(c.width);
    std::vector<HostVoxels> grids;
    for (std::uint32_t k = 0; k < c.cascades; ++k)
        grids.push_back(someVoxels(c.cascades > 1 ? 16 : 32, c.mode, c.sides, 5 + k));
    const DeviceVoxels voxels = deviceVoxels(rig, grids);
    ConeGatherOptions options = optionsOf(grids[0]);
    options.cascades = c.cascades;
    options.tetrahedral = c.tetrahedral;
    options.startPlane = c.plane;
    options.step = c.sides ? 0.5 : 1.0;
    options.near = c.sides;
    options.nudge = 2.0;
    options.occlusionDistance = 0.5;
    options.apertureOffset = c.mode == 1;
    options.opacityCorrection = c.mode != 2;
    const auto [width, height] = testSize({61, 5});
    checkTwin(rig, options, voxels, somePoints(width, height, 32 * kVoxel));
}
