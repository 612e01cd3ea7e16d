// Light in voxels comes out the same whatever the order of work and whatever is not made anew.
#include "passes/voxel_light.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/voxel_light_rig.h"

using namespace lightwell;
using namespace lightwell::test;

TEST_CASE("the same words in any order of texels and at any width", "[voxel_light][large]") {
    const auto mode = GENERATE(LW_VOXEL_MODE_ISOTROPIC, LW_VOXEL_MODE_ANISOTROPIC, LW_VOXEL_MODE_SH2);
    const bool sides = mode == LW_VOXEL_MODE_ANISOTROPIC;
    VoxelLightRig wide(16, 32, mode, sides), narrow(1, 32, mode, sides);
    LitRoom scene(90);
    for (VoxelLightRig* rig : {&wide, &narrow}) {
        rig->aware = sides ? 1 : 0;
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

TEST_CASE("bricks whose light and surfaces stay are not made again, and come out as if they were",
          "[voxel_light][large]") {
    const auto mode = GENERATE(LW_VOXEL_MODE_ISOTROPIC, LW_VOXEL_MODE_ANISOTROPIC);
    VoxelLightRig rig(16, 32, mode, false), anew(16, 32, mode, false);
    LitRoom scene(90);
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
    // Texels that come, leave and change places, in their own bricks and others.
    std::reverse(scene.texels.begin(), scene.texels.begin() + 200);
    std::swap_ranges(scene.texels.begin(), scene.texels.begin() + 50, scene.texels.begin() + 700);
    for (std::size_t i = 300; i < 340; ++i) scene.texels[i].flux = {0.0, 0.0, 0.0};
    rig.shine(scene.texels);
    anew.light.forget();
    anew.shine(scene.texels);
    CHECK(isSame(rig.words(), anew.words()));
    // Brighter, so that sums are in other units.
    for (double& flux : scene.texels[900].flux) flux *= 3e4;
    rig.shine(scene.texels);
    anew.light.forget();
    anew.shine(scene.texels);
    CHECK(isSame(rig.words(), anew.words()));
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
