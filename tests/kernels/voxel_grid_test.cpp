// Which voxels triangles touch, and how much of each lies in them: against clipping in double.
#include "passes/voxel_grid.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/voxel_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::VoxelPoint;
using reference::VoxelPolygon;

namespace {

constexpr int kSize = 32;

using Random = std::mt19937;
double within(Random& random, double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
std::array<double, 3> anywhere(Random& random, double low, double high) {
    return {within(random, low, high), within(random, low, high), within(random, low, high)};
}
std::array<double, 3> near(Random& random, const std::array<double, 3>& p, double reach) {
    const std::array<double, 3> d = anywhere(random, -reach, reach);
    return {p[0] + d[0], p[1] + d[1], p[2] + d[2]};
}

// Triangles of one kind that reach `reach` voxels.
std::vector<VoxelTriangle> scattered(Random& random, int count, double reach) {
    std::vector<VoxelTriangle> result;
    for (int i = 0; i < count; ++i) {
        const std::array<double, 3> a = anywhere(random, 0.0, kSize);
        result.push_back({{{a, near(random, a, reach), near(random, a, reach)}}});
    }
    return result;
}
std::vector<VoxelTriangle> slivers(Random& random, int count) {
    std::vector<VoxelTriangle> result;
    for (int i = 0; i < count; ++i) {
        const std::array<double, 3> a = anywhere(random, 0.0, kSize), b = near(random, a, 12.0);
        result.push_back({{{a, b, near(random, i % 2 ? a : b, 1e-3)}}});
    }
    return result;
}
// In planes across an axis, every third one between voxels.
std::vector<VoxelTriangle> aligned(Random& random, int count) {
    std::vector<VoxelTriangle> result;
    for (int i = 0; i < count; ++i) {
        VoxelTriangle t = scattered(random, 1, 6.0)[0];
        const auto axis = std::size_t(i % 3);
        const double at = i % 2 ? std::floor(t.at[0][axis]) : t.at[0][axis];
        for (auto& p : t.at) p[axis] = at;
        result.push_back(t);
    }
    return result;
}

// Voxels that clipping leaves something in, of boxes larger by `wider` on all sides; areas beside.
struct Clipped {
    std::vector<bool> touched;
    std::vector<double> area;
};
Clipped clip(const VoxelRig& rig, std::size_t count, double wider) {
    const auto voxels = std::size_t(kSize) * kSize * kSize;
    Clipped result{std::vector<bool>(voxels), std::vector<double>(voxels)};
    for (std::size_t t = 0; t < count; ++t) {
        const VoxelPolygon polygon = rig.seen(t);
        int from[3], to[3];
        for (std::size_t a = 0; a < 3; ++a) {
            const auto [low, high] = std::minmax({polygon[0][a], polygon[1][a], polygon[2][a]});
            from[a] = int(std::clamp(std::floor(low) - 1.0, 0.0, double(kSize)));
            to[a] = int(std::clamp(std::floor(high) + 1.0, -1.0, kSize - 1.0));
        }
        for (int z = from[2]; z <= to[2]; ++z)
            for (int y = from[1]; y <= to[1]; ++y)
                for (int x = from[0]; x <= to[0]; ++x) {
                    const VoxelPoint low{x - wider, y - wider, z - wider}, high{x + 1 + wider, y + 1 + wider, z + 1 + wider};
                    const VoxelPolygon part = reference::clipToBox(polygon, low, high);
                    if (part.empty()) continue;
                    const std::size_t i = rig.indexOf(x, y, z);
                    result.touched[i] = true;
                    result.area[i] += reference::polygonArea(part);
                }
    }
    return result;
}

// Voxels that are missing of what is touched, or beyond what a box wider by `slack` touches.
std::string occupancyFaults(const VoxelRig& rig, std::size_t count, double slack) {
    const Clipped exact = clip(rig, count, 0.0), wider = clip(rig, count, slack);
    const std::vector<cl_uint> words = rig.occupied();
    int missing = 0, extra = 0;
    for (std::size_t i = 0; i < exact.touched.size(); ++i) {
        missing += exact.touched[i] && !bitOf(words, i);
        extra += bitOf(words, i) && !wider.touched[i];
    }
    return missing || extra ? std::to_string(missing) + " missing, " + std::to_string(extra) + " too many" : "";
}

std::string areaFaults(const VoxelRig& rig, std::size_t count, double tolerance, double sumTolerance) {
    const Clipped exact = clip(rig, count, 0.0);
    const std::vector<float> area = rig.floats(LW_SURFACE_AREA);
    double worst = 0.0, sum = 0.0, expected = 0.0;
    for (std::size_t i = 0; i < area.size(); ++i) {
        worst = std::max(worst, std::abs(double(area[i]) - exact.area[i]));
        sum += double(area[i]);
        expected += exact.area[i];
    }
    if (worst <= tolerance && std::abs(sum - expected) <= sumTolerance * expected) return "";
    return "worst " + std::to_string(worst) + ", sum " + std::to_string(sum) + " for " + std::to_string(expected);
}

}  // namespace

TEST_CASE("voxels are occupied where triangles touch them, and nowhere else, and hold their area", "[voxel_grid][large]") {
    VoxelRig rig(GENERATE(1u, 16u), kSize);
    Random random(7);
    // How much wider a voxel may be taken for: rounding, which grows with what the triangle reaches.
    const auto check = [&](const char* kind, const std::vector<VoxelTriangle>& triangles, double slack, double tolerance,
                           double sumTolerance = 1e-5) {
        INFO(kind);
        rig.voxelise(triangles);
        CHECK(occupancyFaults(rig, triangles.size(), slack) == "");
        CHECK(areaFaults(rig, triangles.size(), tolerance, sumTolerance) == "");
    };
    check("small", scattered(random, 2000, 0.2), 2e-4, 2e-5);
    check("medium", scattered(random, 200, 4.0), 2e-4, 2e-5);
    check("large", scattered(random, 20, 60.0), 5e-4, 2e-4);
    // Of slivers 12 long and 0.001 wide, cut places round by a share of the width.
    check("slivers", slivers(random, 100), 2e-3, 2e-5, 1e-4);
    // (Whether one that lies between two voxels has its area in one or in the other is rounding.)
    check("across an axis", aligned(random, 60), 2e-4, 1.5);
    check("huge", scattered(random, 4, 1e5), 0.5, 0.01, 1e-4);
}
