// Voxel volumes that tests fill voxel by voxel, and traces through them.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "inputs/camera.h"
#include "passes/cone_gather.h"
#include "reference/surfaces.h"
#include "shared/grid_types.h"
#include "support/kernel_rig.h"

namespace lightwell::test {

using Rgba = std::array<double, 4>;  // premultiplied

// All levels of one grid, each plane of voxels x, y, z.
struct HostVoxels {
    int size, mode;
    bool sides;
    std::vector<std::vector<std::vector<Rgba>>> levels;  // [level][plane][voxel]

    int planesOf(int level) const {
        return level == 0 ? voxel_base_planes(mode, sides ? 1 : 0) : voxel_mip_planes(mode);
    }
    int sideOf(int level) const { return size >> level; }
    std::size_t index(int level, int x, int y, int z) const {
        const int n = sideOf(level);
        return std::size_t((z * n + y) * n + x);
    }
};

// Isotropic ones of a function of a voxel's place (finest level), each level the mean of the one before;
// or anisotropic: the two voxels behind each other composited, then the mean of four.
inline HostVoxels hostVoxels(int size, int mode, const std::function<Rgba(int, int, int)>& voxel) {
    HostVoxels v{size, mode, false, {}};
    for (int level = 0; level < voxel_levels(size); ++level) {
        const int n = v.sideOf(level);
        std::vector<std::vector<Rgba>> planes(std::size_t(v.planesOf(level)),
                                              std::vector<Rgba>(std::size_t(n * n * n)));
        for (int p = 0; p < v.planesOf(level); ++p)
            for (int z = 0; z < n; ++z)
                for (int y = 0; y < n; ++y)
                    for (int x = 0; x < n; ++x) {
                        Rgba& value = planes[std::size_t(p)][v.index(level, x, y, z)];
                        if (level == 0) {
                            value = voxel(x, y, z);
                            continue;
                        }
                        const auto& from =
                            v.levels[std::size_t(level - 1)][std::size_t(level == 1 ? 0 : p)];
                        const auto child = [&](int k) {
                            return from[v.index(level - 1, 2 * x + (k & 1), 2 * y + (k >> 1 & 1),
                                                2 * z + (k >> 2))];
                        };
                        for (int c = 0; c < 4; ++c)
                            for (int k = 0; k < 8; ++k) {
                                double part = child(k)[std::size_t(c)];
                                if (mode == 1) {
                                    // Seen by a ray that goes up the axis (odd planes), the lower one
                                    // comes first.
                                    const int bit = 1 << (p / 2);
                                    const bool isBehind = bool(k & bit) == bool(p & 1);
                                    part *= 2.0 * (isBehind ? 1.0 - child(k ^ bit)[3] : 1.0);
                                }
                                value[std::size_t(c)] += part / 8.0;
                            }
                    }
        v.levels.push_back(planes);
    }
    return v;
}

// On the device, as voxel_volume.h has it, of one or more grids.
struct DeviceVoxels {
    VoxelVolume volume;
    Buffer places;
    int unit = 0;
    std::vector<cl_int> table;
    std::vector<cl_uint> base, mips;
    std::vector<LwGridPlace> place;
};

inline LwGridPlace conePlace(double voxel, reference::Vec origin) {
    LwGridPlace place{};
    place.origin = float4(origin.x, origin.y, origin.z, 1.0 / voxel);
    place.cell = float4(voxel, 1.0, 1.0, 0.0);
    return place;
}

// Packed words, with an apron; only bricks that hold something.
inline void packVoxels(DeviceVoxels& d, const std::vector<HostVoxels>& grids, double scale) {
    const HostVoxels& first = grids[0];
    const float perUnit = voxel_per_unit(voxel_unit_exponent(float(scale)));
    d.unit = voxel_unit(voxel_unit_exponent(float(scale)));
    std::vector<std::vector<cl_uint>> planes[2];
    planes[0].resize(std::size_t(first.planesOf(0)));
    planes[1].resize(std::size_t(voxel_mip_planes(first.mode)));
    cl_int slots[2] = {0, 0};
    for (const HostVoxels& v : grids)
        for (int level = 0; level < int(v.levels.size()); ++level) {
            const int n = v.sideOf(level), bricks = voxel_bricks(v.size, level), which = level > 0;
            for (int brick = 0; brick < bricks * bricks * bricks; ++brick) {
                std::vector<std::vector<cl_uint>> words(planes[which].size(),
                                                        std::vector<cl_uint>(LW_VOXEL_STRIDE));
                bool holds = false;
                for (std::size_t p = 0; p < words.size(); ++p)
                    for (int i = 0; i < LW_VOXEL_STORED_VOXELS; ++i) {
                        const int x = 8 * (brick % bricks) + i % 9,
                                  y = 8 * (brick / bricks % bricks) + i / 9 % 9,
                                  z = 8 * (brick / (bricks * bricks)) + i / 81;
                        if (x >= n || y >= n || z >= n) continue;
                        const auto& plane = v.levels[std::size_t(level)][p];
                        const Rgba c = plane[v.index(level, x, y, z)];
                        holds |= c[3] > 0.0;
                        if (v.mode == 2 && p > 0) {
                            const double c0 =
                                v.levels[std::size_t(level)][0][v.index(level, x, y, z)][p - 1];
                            words[p][std::size_t(i)] = voxel_pack_harmonics(
                                float(c0), float(c[0]), float(c[1]), float(c[2]), 1u << 31);
                        } else {
                            words[p][std::size_t(i)] =
                                voxel_pack(float(c[0]), float(c[1]), float(c[2]), float(c[3]), perUnit,
                                           voxel_dither(x, y, z, level, int(p)));
                        }
                    }
                d.table.push_back(holds ? slots[which]++ : LW_VOXEL_EMPTY);
                if (!holds) continue;
                for (std::size_t p = 0; p < words.size(); ++p)
                    planes[which][p].insert(planes[which][p].end(), words[p].begin(), words[p].end());
            }
        }
    for (int which = 0; which < 2; ++which)
        for (const auto& plane : planes[which]) {
            auto& to = which ? d.mips : d.base;
            to.insert(to.end(), plane.begin(), plane.end());
        }
    d.volume.size = std::uint32_t(first.size);
    d.volume.cascades = std::uint32_t(grids.size());
    d.volume.mode = LWVoxelMode(first.mode);
    d.volume.sides = first.sides;
    d.volume.baseSlots = std::uint32_t(slots[0]);
    d.volume.mipSlots = std::uint32_t(slots[1]);
}

inline void uploadVoxels(KernelRig& rig, DeviceVoxels& d) {
    if (d.base.empty()) d.base.push_back(0);
    if (d.mips.empty()) d.mips.push_back(0);
    LwVoxelState state{};
    state.unit = d.unit;
    d.volume.table = rig.upload(d.table);
    d.volume.base = rig.upload(d.base);
    d.volume.mips = rig.upload(d.mips);
    d.volume.state = rig.upload(std::vector<LwVoxelState>(d.volume.cascades, state));
    d.places = rig.upload(d.place);
}

struct ConePoint {
    reference::Vec position, normal;
};

struct ConeLight {
    std::vector<float> irradiance, validity, open;  // planes of three colours, packed
    std::vector<cl_int> counts;
};

struct ConeImage {
    std::uint32_t width, height;
    std::vector<ConePoint> points;  // row by row
};

inline std::vector<float> conePlanes(const std::vector<ConePoint>& points, bool normals) {
    const std::size_t count = points.size();
    std::vector<float> planes(3 * count);
    for (std::size_t i = 0; i < count; ++i) {
        const reference::Vec& v = normals ? points[i].normal : points[i].position;
        planes[i] = float(v.x);
        planes[count + i] = float(v.y);
        planes[2 * count + i] = float(v.z);
    }
    return planes;
}

inline ConeLight traceCones(KernelRig& rig, ConeGather& pass, const DeviceVoxels& voxels,
                            const ConeImage& image,
                            std::array<float, 3> environment = {0.0f, 0.0f, 0.0f}) {
    const std::uint32_t w = image.width, h = image.height;
    const Guarded at = rig.uploadPlanes(conePlanes(image.points, false), w, h, 3, std::nanf("")),
                  facing = rig.uploadPlanes(conePlanes(image.points, true), w, h, 3, std::nanf(""));
    const Guarded light = rig.makePlanes(w, h, 3), valid = rig.makePlanes(w, h, 1),
                  open = rig.makePlanes(w, h, 1), gathered = rig.makePlanes(w, h, ConeGather::kGathered);
    const Guarded counts = rig.upload(std::vector<cl_int>(ConeGather::kCounts));
    const Planes position = rig.planes(at, w, h, 3), normal = rig.planes(facing, w, h, 3),
                 e = rig.planes(light, w, h, 3), v = rig.planes(valid, w, h, 1),
                 o = rig.planes(open, w, h, 1);
    const ConeWorld world{voxels.volume, voxels.places, environment.data()};
    if (pass.options().interleaved) {
        const Planes g = rig.planes(gathered, w, h, ConeGather::kGathered);
        pass.recordTrace(rig.executor(), position, normal, world, g, {}, {}, counts, true);
        pass.recordFilter(rig.executor(), position, normal, g, e, v, o);
    } else {
        pass.recordTrace(rig.executor(), position, normal, world, e, v, o, counts);
    }
    rig.device().finish();
    return {rig.downloadPlanes(e), rig.downloadPlanes(v), rig.downloadPlanes(o),
            rig.download<cl_int>(counts)};
}

}  // namespace lightwell::test
