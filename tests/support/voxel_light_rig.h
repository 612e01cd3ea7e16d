// Triangles as lit voxels: passes voxel_grid, voxel_mips and voxel_light together, from texels that
// tests make.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "inputs/rsm_input.h"
#include "passes/voxel_receivers.h"
#include "support/voxel_rig.h"
#include "support/voxel_volume_rig.h"

namespace lightwell::test {

struct VoxelTexel {
    std::array<double, 3> at, normal, flux;  // at: in voxels of the grid; W
};

struct VoxelLightRig : VoxelRig {
    VoxelVolume volume;
    VoxelMips mips;
    VoxelLight light;
    VoxelReceivers receivers;
    bool hears = false;
    cl_int aware = 0;
    double area = kCell * kCell;  // of a voxel's face

    VoxelLightRig(std::uint32_t width, int n, LWVoxelMode mode, bool sides, bool sparse = true)
        : VoxelRig(width, n, sparse),
          mips(device(), std::uint32_t(n), 0),
          light(device(), std::uint32_t(n), 0),
          receivers(device(), std::uint32_t(n)) {
        volume.size = std::uint32_t(n);
        volume.mode = mode;
        volume.sides = sides;
        volume.sparse = sparse;
    }
    void shine(const std::vector<VoxelTexel>& texels, bool emits = false) {
        record(emits);
        const std::size_t width = (texels.size() + 15) / 16 * 16;
        std::vector<float> planes(width * LW_RSM_PLANES);
        double largest = 0.0;
        for (std::size_t i = 0; i < texels.size(); ++i)
            for (std::size_t a = 0; a < 3; ++a) {
                planes[(LW_RSM_POSITION + a) * width + i] =
                    float(double(kOrigin[a]) + kCell * texels[i].at[a]);
                planes[(LW_RSM_NORMAL + a) * width + i] = float(texels[i].normal[a]);
                planes[(LW_RSM_FLUX + a) * width + i] = float(texels[i].flux[a]);
                largest = std::max(largest, texels[i].flux[a]);
            }
        RsmInput rsms;
        Guarded memory = upload(width ? planes : std::vector<float>(16));
        if (width) {
            rsms.texels.memory = memory.get();
            rsms.texels.rowStride = rsms.texels.planeStride = std::int64_t(width);
            rsms.texels.width = std::uint32_t(width);
            rsms.texels.height = 1;
            rsms.texels.count = LW_RSM_PLANES;
        }
        // As GridPlace chooses it.
        int exponent = 0, bits = 62;
        std::frexp(largest, &exponent);
        for (std::size_t n = 1; n < width; n *= 2) --bits;
        const int shift = largest > 0.0 ? bits - exponent : 0;
        LwLpvPlace lit = place;
        lit.cell.s[1] = std::ldexp(1.0f, shift / 2);
        lit.cell.s[2] = std::ldexp(1.0f, shift - shift / 2);
        const Guarded placed = upload(std::vector<LwLpvPlace>{lit});
        const bool isNew = volume.reserve(executor(), 1u << 20, 1u << 20);
        mips.recordTables(executor(), pass.occupied(), pass.changed(), isNew, volume);
        if (hears) receivers.record(executor(), VoxelSurfaces::of(pass), placed, mips, light);
        light.record(executor(), rsms, VoxelSurfaces::of(pass), placed, mips, volume, aware, hears);
        mips.recordFilter(executor(), volume);
        device().finish();
    }
    LwVoxelState lit() const { return read<LwVoxelState>(volume.state, 1)[0]; }
    LwVoxelTexels texels() const { return read<LwVoxelTexels>(light.state(), 1)[0]; }
    // A plane of light() in the order of the bricks.
    std::vector<double> held(int p) const {
        const std::size_t slots = pass.slots() * std::size_t(LW_VOXEL_BRICK_VOXELS);
        std::vector<float> all(slots);
        light.light().download(std::size_t(p) * slots * sizeof(float), slots * sizeof(float),
                               all.data());
        std::vector<double> result;
        for (const cl_int slot : bricks())
            for (std::size_t i = 0; i < LW_VOXEL_BRICK_VOXELS; ++i)
                result.push_back(slot < 0 ? 0.0
                                          : double(all[std::size_t(slot) * LW_VOXEL_BRICK_VOXELS + i]));
        return result;
    }
    LwVoxelValue value(int plane, int x, int y, int z) const {
        return VoxelLevel::of(volume, 0).value(plane, x, y, z, lit().unit);
    }
    // All that cones can read.
    std::vector<cl_uint> words() const {
        std::vector<cl_uint> result;
        for (int l = 0; l < voxel_levels(size); ++l) {
            const VoxelLevel level = VoxelLevel::of(volume, l);
            for (int p = 0; p < level.planes; ++p)
                for (const cl_int slot : level.table)
                    for (int i = 0; i < LW_VOXEL_STORED_VOXELS && slot >= 0; ++i)
                        result.push_back(level.words[(std::size_t(p) * level.slots + std::size_t(slot)) *
                                                         LW_VOXEL_STRIDE +
                                                     std::size_t(i)]);
        }
        return result;
    }
};

// A box with faces at lo and hi, seen from inside, two triangles each.
inline std::vector<VoxelTriangle> voxelRoom(double lo, double hi) {
    std::vector<VoxelTriangle> triangles;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (int up = 0; up < 2; ++up) {
            std::array<std::array<double, 3>, 4> corner{};
            for (std::size_t k = 0; k < 4; ++k) {
                corner[k][axis] = up ? hi : lo;
                // Counter-clockwise as seen from within.
                const bool u = (k == 1 || k == 2), v = k >= 2;
                corner[k][(axis + 1) % 3] = (up ? v : u) ? hi : lo;
                corner[k][(axis + 2) % 3] = (up ? u : v) ? hi : lo;
            }
            triangles.push_back({{corner[0], corner[1], corner[2]}});
            triangles.push_back({{corner[0], corner[2], corner[3]}});
        }
    return triangles;
}

// Texels spread over triangles as evenly as by chance, `count` on each, of one radiance.
inline std::vector<VoxelTexel> texelsOn(const std::vector<VoxelTriangle>& triangles, std::size_t count,
                                        std::array<double, 3> radiance, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<VoxelTexel> texels;
    for (const VoxelTriangle& t : triangles) {
        std::array<double, 3> e{}, f{}, n{};
        for (std::size_t a = 0; a < 3; ++a) {
            e[a] = t.at[1][a] - t.at[0][a];
            f[a] = t.at[2][a] - t.at[0][a];
        }
        for (std::size_t a = 0; a < 3; ++a)
            n[a] = e[(a + 1) % 3] * f[(a + 2) % 3] - e[(a + 2) % 3] * f[(a + 1) % 3];
        const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        const double power =
            3.14159265358979323846 * 0.5 * length * VoxelRig::kCell * VoxelRig::kCell / double(count);
        for (std::size_t i = 0; i < count; ++i) {
            double u = unit(random), v = unit(random);
            if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
            VoxelTexel texel;
            for (std::size_t a = 0; a < 3; ++a) {
                texel.at[a] = t.at[0][a] + u * e[a] + v * f[a];
                texel.normal[a] = n[a] / length;
                texel.flux[a] = power * radiance[a];
            }
            texels.push_back(texel);
        }
    }
    return texels;
}

// Two triangles across all of a box along axis 0 of which `facing` says the way: a sheet.
inline std::vector<VoxelTriangle> voxelSheet(double at, double lo, double hi, int facing) {
    const std::array<double, 3> a = {at, lo, lo}, b = {at, hi, lo}, c = {at, hi, hi}, d = {at, lo, hi};
    if (facing > 0) return {{{a, b, c}}, {{a, c, d}}};
    return {{{a, c, b}}, {{a, d, c}}};
}
template <class T>
void append(std::vector<T>& to, const std::vector<T>& more) {
    to.insert(to.end(), more.begin(), more.end());
}

// The room, a slanted sheet in it, and light of 10^4 : 1 from wall to wall, coloured.
struct LitRoom {
    std::vector<VoxelTriangle> triangles = voxelRoom(2.3, 29.6);
    std::vector<VoxelTexel> texels;
    explicit LitRoom(std::size_t each) {
        triangles.push_back(
            {{std::array<double, 3>{8.0, 5.0, 9.0}, {20.0, 9.0, 11.0}, {14.0, 21.0, 17.0}}});
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            const double bright = std::pow(10.0, -4.0 * double(t) / double(triangles.size() - 1));
            append(texels,
                   texelsOn({triangles[t]}, each, {bright, 0.5 * bright, 0.2 * bright}, unsigned(t)));
        }
    }
};

// Not for Catch to print.
inline bool isSame(const std::vector<cl_uint>& a, const std::vector<cl_uint>& b) {
    return !a.empty() && a == b;
}

inline std::array<double, 3> totalOf(const std::vector<VoxelTexel>& texels) {
    std::array<double, 3> sum{};
    for (const VoxelTexel& t : texels)
        for (std::size_t c = 0; c < 3; ++c) sum[c] += t.flux[c];
    return sum;
}

}  // namespace lightwell::test
