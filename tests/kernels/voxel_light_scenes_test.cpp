// Hidden ([.times]): what light in whole scenes' voxels takes, the figures of
// docs/techniques/voxel_light.md.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "passes/voxel_light.h"
#include "ray_scene.h"
#include "scene.h"
#include "scene_triangles.h"
#include "shared/grid_types.h"
#include "support/kernel_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr std::size_t kTexels = 512 * 512;
constexpr int kFrames = 7;
const char* const kPasses[] = {"voxel_mips.tables",   "voxel_light.inject", "voxel_light.settle",
                               "voxel_light.resolve", "voxel_mips.apron",   "voxel_mips.filter"};

// Texels as many as an RSM has, spread over the triangles by area in the order of these: flux that
// differs from texel to texel.
std::vector<float> texelsOver(const std::vector<float>& vertices) {
    std::vector<double> upTo;
    double sum = 0.0;
    const auto edge = [&](std::size_t t, std::size_t k, std::size_t a) {
        return double(vertices[9 * t + 3 * k + a]) - double(vertices[9 * t + a]);
    };
    const auto normal = [&](std::size_t t, double* n) {
        for (std::size_t a = 0; a < 3; ++a)
            n[a] = edge(t, 1, (a + 1) % 3) * edge(t, 2, (a + 2) % 3) -
                   edge(t, 1, (a + 2) % 3) * edge(t, 2, (a + 1) % 3);
        return std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    };
    double n[3];
    for (std::size_t t = 0; t < vertices.size() / 9; ++t) upTo.push_back(sum += normal(t, n));
    std::vector<float> planes(kTexels * LW_RSM_PLANES);
    for (std::size_t i = 0; i < kTexels; ++i) {
        const double wanted = (double(i) + 0.5) / double(kTexels) * sum;
        const auto t = std::size_t(std::lower_bound(upTo.begin(), upTo.end(), wanted) - upTo.begin());
        const double length = normal(t, n);
        double u = std::fmod(double(i) * 0.7548776662466927, 1.0),
               v = std::fmod(double(i) * 0.5698402909980532, 1.0);
        if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
        for (std::size_t a = 0; a < 3; ++a) {
            planes[(LW_RSM_POSITION + a) * kTexels + i] =
                float(double(vertices[9 * t + a]) + u * edge(t, 1, a) + v * edge(t, 2, a));
            planes[(LW_RSM_NORMAL + a) * kTexels + i] = float(n[a] / std::max(length, 1e-30));
            planes[(LW_RSM_FLUX + a) * kTexels + i] = float(1.0 + 0.5 * u);
        }
    }
    return planes;
}

struct Times {
    std::vector<double> of[6];
    void add(const Profile& profile) {
        for (std::size_t p = 0; p < 6; ++p) {
            double sum = 0.0;
            for (const LWPassTime& pass : profile.passes())
                if (std::string(pass.name) == kPasses[p]) sum += pass.milliseconds;
            of[p].push_back(sum);
        }
    }
    double median(std::size_t p) {
        std::sort(of[p].begin(), of[p].end());
        return of[p][of[p].size() / 2];
    }
};

}  // namespace

TEST_CASE("times of light in scenes' voxels", "[.times]") {
    const char* wanted = std::getenv("LIGHTWELL_TIMES");
    const std::string name = wanted ? wanted : "cornell";
    const studio::RayScene rays(std::make_shared<const studio::Scene>(studio::loadScene(name)), 0.0f);
    const studio::SceneTriangles triangles = studio::sceneTriangles(rays);
    KernelRig rig(16);
    LWGeometry g{};
    g.structSize = sizeof g;
    g.vertices = triangles.vertices.data();
    g.triangleAlbedo = triangles.albedo.data();
    g.vertexCount = 3 * triangles.count();
    g.triangleCount = triangles.count();
    g.version = 1;
    GeometryInput input;
    input.import(rig.executor(), &g);
    float low[3] = {1e30f, 1e30f, 1e30f}, high[3] = {-1e30f, -1e30f, -1e30f};
    for (std::size_t i = 0; i < triangles.vertices.size(); ++i) {
        low[i % 3] = std::min(low[i % 3], triangles.vertices[i]);
        high[i % 3] = std::max(high[i % 3], triangles.vertices[i]);
    }
    const std::vector<float> planes = texelsOver(triangles.vertices);
    std::vector<float> dim = planes;
    for (std::size_t i = LW_RSM_FLUX * kTexels; i < LW_RSM_AREA * kTexels; ++i) dim[i] *= 0.7f;
    const Guarded bright = rig.upload(planes), dimmed = rig.upload(dim);
    std::printf(
        "%-14s %4s %-11s %6s %7s %8s | tables inject settle resolve apron filter ms | unchanged: inject "
        "settle others\n",
        "scene", "size", "mode", "bricks", "mips", "MiB");
    for (const LWVoxelMode mode : {LW_VOXEL_MODE_ISOTROPIC, LW_VOXEL_MODE_ANISOTROPIC})
        for (const std::uint32_t size : {32u, 64u, 128u, 256u}) {
            const float side = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]}),
                        cell = side / float(size - 2);
            LwGridPlace place{};
            for (int a = 0; a < 3; ++a)
                place.origin.s[a] = 0.5f * (low[a] + high[a]) - 0.5f * cell * float(size);
            place.origin.s[3] = 1.0f / cell;
            place.cell = {
                {cell, std::ldexp(1.0f, 20), std::ldexp(1.0f, 20), 0.0f}};  // flux below 4, 2^18 texels
            const Guarded placed = rig.upload(std::vector<LwGridPlace>{place});
            VoxelGrid grid(rig.device(), size, true);
            VoxelMips mips(rig.device(), size, 0);
            VoxelLight light(rig.device(), size, 0);
            VoxelVolume volume;
            volume.size = size;
            volume.mode = mode;
            std::uint32_t base = 64, coarse = 64;
            Times changing, still;
            for (int frame = 0; frame < 4 + 2 * kFrames; ++frame) {
                rig.profile().clear();
                const bool isStill = frame >= 4 + kFrames;
                RsmInput rsms;
                rsms.texels.memory = (frame % 2 && !isStill ? dimmed : bright).get();
                rsms.texels.rowStride = rsms.texels.planeStride = std::int64_t(kTexels);
                rsms.texels.width = std::uint32_t(kTexels);
                rsms.texels.height = 1;
                rsms.texels.count = LW_RSM_PLANES;
                grid.record(rig.executor(), input, placed);
                const bool isNew = volume.reserve(rig.executor(), base, coarse);
                mips.recordTables(rig.executor(), grid.occupied(), grid.changed(), isNew, volume);
                if (isNew) light.forget();
                light.record(rig.executor(), rsms, VoxelSurfaces::of(grid), placed, mips, volume, false);
                mips.recordFilter(rig.executor(), volume);
                rig.device().finish();
                LwVoxelWork work;
                mips.work().download(0, sizeof work, &work);
                if (work.stale)
                    base = std::uint32_t(work.baseWanted), coarse = std::uint32_t(work.mipsWanted);
                if (frame >= 4 && frame < 4 + kFrames) changing.add(rig.profile());
                if (frame > 4 + kFrames) still.add(rig.profile());
            }
            LwVoxelState state;
            volume.state.download(0, sizeof state, &state);
            CHECK(state.droppedBricks == 0);
            CHECK(state.changedBricks == 0);
            std::printf(
                "%-14s %4u %-11s %6d %7d %8.1f | %6.2f %6.2f %6.2f %6.2f %6.2f %6.2f | %6.2f %6.2f "
                "%6.2f\n",
                name.c_str(), size, mode == LW_VOXEL_MODE_ISOTROPIC ? "isotropic" : "anisotropic",
                state.baseBricks, state.mipBricks, double(volume.bytes()) / 1048576.0,
                changing.median(0), changing.median(1), changing.median(2), changing.median(3),
                changing.median(4), changing.median(5), still.median(1), still.median(2),
                still.median(0) + still.median(3) + still.median(4) + still.median(5));
        }
}
