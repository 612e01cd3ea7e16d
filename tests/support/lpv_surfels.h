// Made-up surfels and what blocks of them in a grid of light propagation, on the device and in double.
#pragma once

#include <array>
#include <random>
#include <vector>

#include "passes/lpv_blocking.h"
#include "reference/lpv_twin.h"
#include "support/lpv_rig.h"

namespace lightwell::test {

// In cells of the grid: its lower corner is 0.
struct LpvSurfel {
    double place[3], normal[3], area;
};

// Squares of one cell's side, `perSide` surfels each way, that fill the plane across `axis` at `at`.
inline void addLpvWall(std::vector<LpvSurfel>& surfels, int size, int axis, double at, double sign = 1.0, int perSide = 2) {
    const double spacing = 1.0 / perSide;
    for (int j = 0; j < perSide * (size + 1); ++j)
        for (int i = 0; i < perSide * (size + 1); ++i) {
            LpvSurfel s{{0, 0, 0}, {0, 0, 0}, spacing * spacing};
            s.place[axis] = at;
            s.place[(axis + 1) % 3] = (i + 0.5) * spacing - 0.5;
            s.place[(axis + 2) % 3] = (j + 0.5) * spacing - 0.5;
            s.normal[axis] = sign;
            surfels.push_back(s);
        }
}

inline std::vector<LpvSurfel> randomLpvSurfels(int size, int count, double largest) {
    std::mt19937 random(17);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<LpvSurfel> surfels;
    for (int i = 0; i < count; ++i) {
        LpvSurfel s{};
        double length = 0.0;
        for (int a = 0; a < 3; ++a) {
            s.place[a] = size * unit(random);
            s.normal[a] = unit(random) - 0.5;
            length += s.normal[a] * s.normal[a];
        }
        for (double& x : s.normal) x /= std::sqrt(length);
        s.area = largest * unit(random);
        surfels.push_back(s);
    }
    return surfels;
}

struct LpvSurfelRig : KernelRig {
    static constexpr double kCell = 0.5, kOrigin[3] = {-3.0, 1.0, 8.0};
    int size;
    LpvBlocking pass;
    LpvSurfelRig(std::uint32_t width, int n) : KernelRig(width), size(n), pass(device(), std::uint32_t(n)) {}

    LpvBlockers block(const std::vector<LpvSurfel>& surfels, std::vector<SurfelRange> views = {}, std::uint64_t revision = 1,
                      double moved = 0.0) {
        const std::size_t stride = (surfels.size() + 31) / 32 * 32;
        std::vector<float> planes(std::max<std::size_t>(stride, 32) * LW_SURFEL_PLANES);
        for (std::size_t i = 0; i < surfels.size(); ++i) {
            for (std::size_t a = 0; a < 3; ++a) {
                planes[a * stride + i] = float(kOrigin[a] + kCell * surfels[i].place[a]);
                planes[(LW_SURFEL_NORMAL + a) * stride + i] = float(surfels[i].normal[a]);
            }
            planes[LW_SURFEL_RADIUS * stride + i] = float(kCell * std::sqrt(surfels[i].area / 3.14159265358979323846));
        }
        SurfelSet set;
        set.count = std::uint32_t(surfels.size());
        set.revision = revision;
        const Guarded memory = upload(planes);
        if (set.count) {
            set.planes.memory = memory.get();
            set.planes.planeStride = std::int64_t(stride);
            set.planes.width = std::uint32_t(stride);
        }
        LwLpvPlace place{};
        place.origin = {{float(kOrigin[0] + moved), float(kOrigin[1]), float(kOrigin[2]), float(1.0 / kCell)}};
        place.cell = {{float(kCell), 1.0f, 1.0f, 0.0f}};
        const Guarded placed = upload(std::vector<LwLpvPlace>{place});
        if (views.empty()) views.push_back({0, set.count});
        pass.record(executor(), set, views, placed);
        device().finish();
        CHECK(pass.bytes() == LpvBlocking::estimateBytes(std::uint32_t(size)));
        return pass.blockers();
    }
    // Plane by plane, z, y, x.
    std::vector<float> faces() {
        const std::size_t plane = std::size_t(lpv_plane(size));
        std::vector<float> all(plane * LW_LPV_FACE_PLANES), result;
        pass.blockers().faces.download(0, all.size() * sizeof(float), all.data());
        for (std::size_t p = 0; p < LW_LPV_FACE_PLANES; ++p)
            for (int z = 0; z < size; ++z)
                for (int y = 0; y < size; ++y)
                    for (int x = 0; x < size; ++x) result.push_back(all[p * plane + std::size_t(lpv_cell(size, x, y, z))]);
        return result;
    }
    std::vector<cl_int> runs() {
        std::vector<cl_int> result(std::size_t(size * size * (size / LW_LPV_BLOCK_RUN)));
        pass.blockers().runs.download(0, result.size() * sizeof(cl_int), result.data());
        return result;
    }
};

inline reference::LpvWalls wallsOf(int size, const std::vector<LpvSurfel>& surfels) {
    reference::LpvWalls walls(size);
    for (const LpvSurfel& s : surfels) walls.add(s.place, s.normal, s.area);
    return walls;
}

}  // namespace lightwell::test
