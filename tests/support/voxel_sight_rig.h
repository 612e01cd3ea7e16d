// What clusters see of voxels that a test makes by itself.
#pragma once

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "passes/clustered_gather.h"
#include "passes/voxel_visibility.h"
#include "reference/paraboloid.h"
#include "shared/cluster_types.h"
#include "shared/grid_types.h"
#include "shared/voxel_types.h"
#include "support/kernel_rig.h"

namespace lightwell::test {

// Bits as voxel_grid leaves them.
struct Voxels {
    explicit Voxels(int voxels) : size(voxels), words(std::size_t(voxels) * std::size_t(voxels) * std::size_t(voxels) / 32) {}

    void set(int x, int y, int z) {
        const int bricks = size / LW_VOXEL_BRICK, bit = x % 8 + 8 * (y % 8) + 64 * (z % 8);
        const int brick = x / 8 + bricks * (y / 8 + bricks * (z / 8));
        words[std::size_t(brick * 16 + bit / 32)] |= 1u << (bit % 32);
    }
    bool has(int x, int y, int z) const {
        const int bricks = size / LW_VOXEL_BRICK, bit = x % 8 + 8 * (y % 8) + 64 * (z % 8);
        const int brick = x / 8 + bricks * (y / 8 + bricks * (z / 8));
        return words[std::size_t(brick * 16 + bit / 32)] >> (bit % 32) & 1u;
    }
    // Those that fill(x, y, z) says of their lower corners.
    template <class Fill>
    void fill(const Fill& isFilled) {
        for (int z = 0; z < size; ++z)
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x)
                    if (isFilled(x, y, z)) set(x, y, z);
    }
    // Those that the plane through `point` touches (both in voxels).
    bool touches(reference::Vec point, reference::Vec n, int x, int y, int z) const {
        const double reach = 0.5 * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
        return std::abs(dot(reference::Vec{x + 0.5, y + 0.5, z + 0.5} - point, n)) <= reach;
    }

    int size;
    std::vector<std::uint32_t> words;
};

// Voxels of half a unit, the grid's corner at (-3, 1, 2).
constexpr double kVoxelSide = 0.5;
inline const reference::Vec kGridCorner{-3.0, 1.0, 2.0};
inline reference::Vec inWorld(reference::Vec voxels) { return kGridCorner + voxels * kVoxelSide; }

// A cluster whose medoid lies at a place in voxels.
inline lw_cluster clusterIn(reference::Vec voxels, reference::Vec normal) {
    const reference::Vec p = inWorld(voxels), n = reference::unit(normal);
    lw_cluster c{};
    c.medoidPosition = {{float(p.x), float(p.y), float(p.z), 0.0f}};
    c.position = {{float(p.x), float(p.y), float(p.z), 1.0f}};
    c.normal = c.medoidNormal = {{float(n.x), float(n.y), float(n.z), 0.0f}};
    return c;
}

class VoxelSightRig : public KernelRig {
public:
    VoxelSightRig(std::uint32_t width, int size) : KernelRig(width), pass(device(), std::uint32_t(size)) {}

    void sweep(const Voxels& voxels, const std::vector<lw_cluster>& clusters) {
        LwGridPlace place{};
        place.origin = {{float(kGridCorner.x), float(kGridCorner.y), float(kGridCorner.z), float(1.0 / kVoxelSide)}};
        place.cell.s[0] = float(kVoxelSide);
        const Guarded where = upload(std::vector<LwGridPlace>{place}), bits = upload(voxels.words), list = upload(clusters);
        pass.record(executor(), where, bits, {{list, std::uint32_t(clusters.size())}});
        device().finish();
    }
    // LW_SIGHT_* by cluster and voxel.
    std::vector<unsigned char> sights(std::size_t clusters) {
        const std::size_t voxels = std::size_t(pass.size()) * pass.size() * pass.size();
        std::vector<unsigned char> bytes(voxels * clusters);
        pass.sights().sights.download(LW_SIGHT_PAD, bytes.size(), bytes.data());
        return bytes;
    }
    LwVoxelSight state() {
        LwVoxelSight sight;
        pass.sights().sight.download(0, sizeof sight, &sight);
        return sight;
    }
    // What of each cluster's light surfaces are taken to get: clusters one after the other.
    std::vector<float> seen(const reference::Image& position, const reference::Image& normal, std::uint32_t clusters) {
        const std::uint32_t w = position.width, h = position.height;
        const float nan = std::numeric_limits<float>::quiet_NaN();
        const Guarded p = uploadPlanes(position.planes, w, h, 3, nan), n = uploadPlanes(normal.planes, w, h, 3, 1.0f);
        ClusteredGather gather(device(), 1, 1, ClusterVisibility::voxel);
        const VoxelSights sights = pass.sights();
        const ClusterMaps maps({{&sights.eyes, &sights.eyes, clusters}}, 64, &sights);
        const Planes surfaces = planes(p, w, h, 3);
        const Guarded out = makePlanes(w, h * clusters, 1);
        gather.recordVisibility(executor(), surfaces, planes(n, w, h, 3), maps, clusters, planes(out, w, h * clusters, 1));
        device().finish();
        return downloadPlanes(planes(out, w, h * clusters, 1));
    }

    VoxelVisibility pass;
};

}  // namespace lightwell::test
