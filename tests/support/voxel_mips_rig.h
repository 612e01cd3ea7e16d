// Levels of voxels in tests: their words by hand, and the double-precision twins that say what coarser
// ones should hold.
#pragma once

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "passes/voxel_mips.h"
#include "support/voxel_volume_rig.h"

namespace lightwell::test {

constexpr int kExponent = -30;
inline const cl_int kUnit = voxel_unit(kExponent);
// A mantissa of 6 bits has 32 steps at least; of green's 7, half as large ones.
constexpr double kStep = 1.0 / 32.0;

using Value = std::array<double, 4>;  // red, green, blue, opacity

struct MipsRig : KernelRig {
    VoxelVolume volume;
    VoxelMips pass;
    MipsRig(std::uint32_t width, std::uint32_t size, LWVoxelMode mode, bool sides, bool sparse = true)
        : KernelRig(width), pass(device(), size, 0) {
        volume.size = size;
        volume.mode = mode;
        volume.sides = sides;
        volume.sparse = sparse;
    }
    void makeTables(const std::vector<cl_uint>& bits, bool all = true) {
        const Guarded occupied = upload(bits);
        const Guarded changed =
            upload(std::vector<cl_int>(bits.size() / LW_VOXEL_BRICK_WORDS, all ? 1 : 0));
        const bool isNew = volume.reserve(executor(), 1u << 20, 1u << 20);
        pass.recordTables(executor(), occupied, changed, isNew, volume);
        device().finish();
    }
    // Words of the finest level's own voxels; `marked`: bricks that are told to have changed.
    void write(const std::function<cl_uint(int plane, int x, int y, int z)>& wordAt,
               const std::function<bool(int brick)>& marked) {
        VoxelLevel base = VoxelLevel::of(volume, 0);
        std::vector<cl_int> marks(base.table.size());
        for (std::size_t b = 0; b < marks.size(); ++b) marks[b] = marked(int(b)) ? 1 : 0;
        eachVoxel(base.side, [&](int x, int y, int z) {
            const int slot = base.slotOf(x / 8, y / 8, z / 8);
            for (int p = 0; p < base.planes && slot >= 0; ++p)
                base.words[(std::size_t(p) * base.slots + std::size_t(slot)) * LW_VOXEL_STRIDE +
                           std::size_t(x % 8 + 9 * (y % 8) + 81 * (z % 8))] = wordAt(p, x, y, z);
        });
        executor().write("test.write", volume.base, 0, base.words.size() * sizeof(cl_uint),
                         base.words.data());
        executor().write("test.write", pass.marks(), 0, marks.size() * sizeof(cl_int), marks.data());
        LwVoxelState state{};
        state.unit = kUnit;
        state.perUnit = voxel_per_unit(kExponent);
        executor().write("test.write", volume.state, 0, sizeof state, &state);
        pass.recordFilter(executor(), volume);
        device().finish();
    }
    LwVoxelWork work() {
        LwVoxelWork result;
        pass.work().download(0, sizeof result, &result);
        return result;
    }
    LwVoxelState state() {
        LwVoxelState result;
        volume.state.download(0, sizeof result, &result);
        return result;
    }
    std::vector<VoxelLevel> levels() {
        std::vector<VoxelLevel> result;
        for (int level = 0; level < voxel_levels(int(volume.size)); ++level)
            result.push_back(VoxelLevel::of(volume, level));
        return result;
    }
};

// A shell, a slab of one layer and a few crumbs: bricks full, grazed and empty.
inline bool isSomething(int size, int x, int y, int z) {
    const double c = 0.5 * size,
                 r = std::sqrt((x - c) * (x - c) + (y - c) * (y - c) + (z - c) * (z - c));
    return std::fabs(r - 0.3 * size) < 0.6 || (z == size - 8 && x < size / 2) ||
           (x * 7 + y * 13 + z * 31) % 4001 == 0;
}

// Of 1e4 : 1 contrast from brick to brick, coloured, of any opacity.
inline Value lightAt(int plane, int x, int y, int z) {
    std::mt19937 random(std::uint32_t(x + 512 * y + 262144 * z) + 77u * std::uint32_t(plane));
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double bright = std::pow(10.0, -4.0 * ((x / 8 + y / 8 + z / 8) % 3) / 2.0),
                 opacity = unit(random);
    return {bright * opacity * unit(random), bright * opacity * unit(random),
            bright * opacity * unit(random), opacity};
}

inline cl_uint packed(const Value& v, int plane, int x, int y, int z) {
    return voxel_pack(float(v[0]), float(v[1]), float(v[2]), float(v[3]), voxel_per_unit(kExponent),
                      voxel_dither(x, y, z, 0, plane));
}

inline Value valueOf(const VoxelLevel& level, int plane, int x, int y, int z) {
    const LwVoxelValue v = level.value(plane, x, y, z, kUnit);
    return {double(v.red), double(v.green), double(v.blue), double(v.opacity)};
}

// What a coarser voxel's word should hold, of the words below it.
inline Value meanOf(const VoxelLevel& fine, int plane, int x, int y, int z) {
    Value mean{};
    for (int c = 0; c < 8; ++c) {
        const Value child =
            valueOf(fine, plane, 2 * x + (c & 1), 2 * y + (c >> 1 & 1), 2 * z + (c >> 2));
        for (std::size_t i = 0; i < 4; ++i) mean[i] += child[i] / 8;
    }
    return mean;
}

inline Value composed(const VoxelLevel& fine, int plane, int side, int x, int y, int z) {
    Value sum{};
    const int axis = side / 2, front = side % 2 ? 0 : 1;
    for (int column = 0; column < 4; ++column) {
        int at[3] = {2 * x, 2 * y, 2 * z};
        at[(axis + 1) % 3] += column & 1;
        at[(axis + 2) % 3] += column >> 1;
        at[axis] += front;
        const Value near = valueOf(fine, plane, at[0], at[1], at[2]);
        at[axis] += 1 - 2 * front;
        const Value far = valueOf(fine, plane, at[0], at[1], at[2]);
        for (std::size_t i = 0; i < 4; ++i) sum[i] += (near[i] + (1 - near[3]) * far[i]) / 4;
    }
    return sum;
}

// A word is within one step of its brightest colour, and 1/255 of opacity.
inline std::string missed(const Value& found, const Value& expected) {
    const double most = std::max({expected[0], expected[1], expected[2]}),
                 step = kStep * most + std::ldexp(1.0, kExponent) * 1.01;
    for (std::size_t i = 0; i < 3; ++i)
        if (std::fabs(found[i] - expected[i]) > step + 1e-6 * most)
            return "colour " + std::to_string(i) + " is " + std::to_string(found[i]) + ", expected " +
                   std::to_string(expected[i]);
    if (std::fabs(found[3] - expected[3]) > 1.0 / 255.0 + 1e-6)
        return "opacity is " + std::to_string(found[3]) + ", expected " + std::to_string(expected[3]);
    return {};
}

inline std::array<double, 4> totals(const VoxelLevel& level, int plane) {
    std::array<double, 4> sums{};
    eachVoxel(level.side, [&](int x, int y, int z) {
        const Value v = valueOf(level, plane, x, y, z);
        for (std::size_t i = 0; i < 4; ++i) sums[i] += v[i] / std::pow(level.side, 3);
    });
    return sums;
}

// What rounding up or down adds to the variance of a level's totals, each word's a step times a share f
// of words rounded up, f (1 - f) on average 1/6. (Spread evenly over neighbours, so that sums are better
// than that.)
inline void addVariance(const VoxelLevel& level, Value& variance) {
    const double share = std::pow(level.side, -3);
    eachVoxel(level.side, [&](int x, int y, int z) {
        const cl_uint word = level.word(0, x, y, z);
        if (!word) return;
        const double step = std::ldexp(1.0, int(word >> 27) + kExponent) * share;
        const Value steps = {step, step / 2, step, share / 255};
        for (std::size_t i = 0; i < 4; ++i) variance[i] += steps[i] * steps[i] / 6;
    });
}

// What lies beyond a brick's own voxels is what its neighbours hold, and 0 beyond the level.
inline void checkAprons(const VoxelLevel& level) {
    int wrong = 0;
    eachVoxel(level.bricks, [&](int bx, int by, int bz) {
        const int slot = level.slotOf(bx, by, bz);
        if (slot < 0) return;
        for (int p = 0; p < level.planes; ++p)
            eachVoxel(9, [&](int x, int y, int z) {
                const int gx = 8 * bx + x, gy = 8 * by + y, gz = 8 * bz + z;
                const bool isInside = gx < level.side && gy < level.side && gz < level.side;
                wrong += level.stored(p, slot, x, y, z) != (isInside ? level.word(p, gx, gy, gz) : 0u);
            });
    });
    CHECK(wrong == 0);
}

inline const auto kAll = [](int) { return true; };

}  // namespace lightwell::test
