// Whole scenes as voxels: their area is all there; and, hidden ([.times]), what it takes: the figures of docs/techniques/voxel_grid.md.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "passes/surfel_sampling.h"
#include "passes/voxel_grid.h"
#include "ray_scene.h"
#include "scene.h"
#include "scene_triangles.h"
#include "support/kernel_rig.h"
#include "support/voxel_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

struct SceneGrid : KernelRig {
    studio::SceneTriangles triangles;
    GeometryInput input;
    VoxelGrid pass;
    LwLpvPlace place{};
    int size;
    std::uint32_t surfels = 0;  // drawn from the triangles instead
    std::unique_ptr<SurfelSampling> drawn;

    SceneGrid(std::uint32_t width, const std::string& name, int n, bool sparse)
        : KernelRig(width), pass(device(), std::uint32_t(n), sparse), size(n) {
        if (name == "room") {
            addRoom();
        } else {
            const studio::RayScene rays(std::make_shared<const studio::Scene>(studio::loadScene(name)), 0.0f);
            triangles = studio::sceneTriangles(rays);
        }
        float low[3] = {1e30f, 1e30f, 1e30f}, high[3] = {-1e30f, -1e30f, -1e30f};
        for (std::size_t i = 0; i < triangles.vertices.size(); ++i) {
            low[i % 3] = std::min(low[i % 3], triangles.vertices[i]);
            high[i % 3] = std::max(high[i % 3], triangles.vertices[i]);
        }
        // Two voxels wider than the longest side.
        const float side = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]}), cell = side / float(n - 2);
        for (int a = 0; a < 3; ++a) place.origin.s[a] = 0.5f * (low[a] + high[a]) - 0.5f * cell * float(n);
        place.origin.s[3] = 1.0f / cell;
        place.cell.s[0] = cell;
    }
    void record() {
        LWGeometry g{};
        g.structSize = sizeof g;
        g.vertices = triangles.vertices.data();
        g.triangleAlbedo = triangles.albedo.data();
        g.vertexCount = 3 * triangles.count();
        g.triangleCount = triangles.count();
        g.version = 1;
        input.import(executor(), &g);
        const Guarded placed = upload(std::vector<LwLpvPlace>{place});
        profile().clear();
        if (surfels) {
            if (!drawn) drawn = std::make_unique<SurfelSampling>(device());
            drawn->record(executor(), input, surfels);
            profile().clear();
            pass.record(executor(), drawn->surfels(), placed);
        } else {
            pass.record(executor(), input, placed);
        }
        device().finish();
    }
    // A unit cube of 12 triangles.
    void addRoom() {
        for (int axis = 0; axis < 3; ++axis)
            for (int side = 0; side < 2; ++side)
                for (int half = 0; half < 2; ++half) {
                    const float corners[3][2] = {{0.0f, 0.0f}, {1.0f, float(half)}, {float(1 - half), 1.0f}};
                    for (const auto& corner : corners)
                        for (int a = 0; a < 3; ++a)
                            triangles.vertices.push_back(a == axis ? float(side) : corner[(a - axis + 3) % 3 - 1]);
                    triangles.albedo.insert(triangles.albedo.end(), {0.5f, 0.5f, 0.5f});
                }
    }
    LwVoxelGrid state() const { return VoxelRig::read<LwVoxelGrid>(pass.state(), 1)[0]; }
    double areaInVoxels() {
        const std::size_t plane = std::size_t(pass.slots()) * LW_VOXEL_BRICK_VOXELS;
        std::vector<float> area(plane);
        pass.surfaces().download(LW_SURFACE_AREA * plane * sizeof(float), plane * sizeof(float), area.data());
        double sum = 0.0;
        for (const cl_int slot : VoxelRig::read<cl_int>(pass.bricks(), std::size_t(size / 8) * std::size_t(size / 8) * std::size_t(size / 8)))
            for (std::size_t i = 0; slot >= 0 && i < LW_VOXEL_BRICK_VOXELS; ++i) sum += double(area[std::size_t(slot) * LW_VOXEL_BRICK_VOXELS + i]);
        return sum * double(place.cell.s[0]) * double(place.cell.s[0]);
    }
};

double passTime(KernelRig& rig, const char* name) {
    for (const LWPassTime& pass : rig.profile().passes())
        if (std::string(pass.name) == name) return pass.milliseconds;
    return 0.0;
}

}  // namespace

TEST_CASE("a scene's area is all in its voxels, stored sparsely or not", "[voxel_grid]") {
    const bool sparse = GENERATE(true, false);
    SceneGrid grid(16, "cornell", 64, sparse);
    grid.record();
    CHECK(grid.areaInVoxels() == Approx(grid.input.area).epsilon(1e-5));
    CHECK(grid.state().dropped == 0);
    CHECK(grid.state().outside == 0);
}

TEST_CASE("times of scenes as voxels", "[.times]") {
    const char* wanted = std::getenv("LIGHTWELL_TIMES");
    const std::string names = wanted ? wanted : "cornell sponza_crytek room";
    const char* kind = std::getenv("LIGHTWELL_VOXELS");  // "dense", or a number of surfels drawn from the triangles
    const bool dense = kind && std::string(kind) == "dense";
    std::printf("%-16s %5s %7s %9s %9s %9s %9s %9s %9s %9s\n", "scene", "size", "bricks", "voxels", "MiB", "occupy", "slots", "fill", "all ms", "kept ms");
    for (std::size_t at = 0; at < names.size();) {
        const std::size_t end = std::min(names.find(' ', at), names.size());
        const std::string name = names.substr(at, end - at);
        at = end + 1;
        for (const int size : {32, 64, 128, 256}) {
            SceneGrid grid(16, name, size, !dense);
            if (kind && !dense) grid.surfels = std::uint32_t(std::atoi(kind));
            std::vector<double> occupy, slots, fill, all, kept;
            grid.record();
            grid.record();  // with room for all
            for (int i = 0; i < 5; ++i) {
                grid.pass.forget();
                grid.record();
                occupy.push_back(passTime(grid, "voxel_grid.occupy"));
                slots.push_back(passTime(grid, "voxel_grid.slots"));
                fill.push_back(passTime(grid, "voxel_grid.fill"));
                all.push_back(grid.profile().totalMilliseconds());
                grid.record();
                kept.push_back(grid.profile().totalMilliseconds());
            }
            const auto median = [](std::vector<double> v) {
                std::sort(v.begin(), v.end());
                return v[v.size() / 2];
            };
            const LwVoxelGrid state = grid.state();
            std::printf("%-16s %5d %7d %9d %9.1f %9.2f %9.3f %9.2f %9.2f %9.4f%s\n", name.c_str(), size, state.bricks, state.voxels,
                        double(grid.pass.bytes()) / 1048576.0, median(occupy), median(slots), median(fill), median(all), median(kept),
                        state.dropped ? " dropped" : "");
            // (Surfels near the scene's bounds reach beyond the grid.)
            CHECK(grid.areaInVoxels() == Approx(grid.input.area).epsilon(grid.surfels ? 1e-2 : 1e-4));
        }
    }
}
