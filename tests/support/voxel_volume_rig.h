// Volumes of voxels in tests: words from and to device memory, voxel by voxel.
#pragma once

#include <array>
#include <catch2/catch.hpp>
#include <functional>
#include <vector>

#include "passes/voxel_mips.h"
#include "passes/voxel_volume.h"
#include "support/kernel_rig.h"

namespace lightwell::test {

// A level of a grid: the words of one plane at x, y, z, those beside a brick included.
struct VoxelLevel {
    int side, bricks, planes;
    std::vector<cl_int> table;
    std::vector<cl_uint> words;  // [plane][slot][LW_VOXEL_STRIDE], all slots of the memory
    std::size_t slots;

    int slotOf(int bx, int by, int bz) const {
        return table[std::size_t((bz * bricks + by) * bricks + bx)];
    }
    // The word that the brick of (bx, by, bz) stores at (x, y, z) of itself.
    cl_uint stored(int plane, int slot, int x, int y, int z) const {
        return words[(std::size_t(plane) * slots + std::size_t(slot)) * LW_VOXEL_STRIDE +
                     std::size_t(x + 9 * y + 81 * z)];
    }
    cl_uint word(int plane, int x, int y, int z) const {
        const int slot = slotOf(x / 8, y / 8, z / 8);
        return slot < 0 ? 0u : stored(plane, slot, x % 8, y % 8, z % 8);
    }
    LwVoxelValue value(int plane, int x, int y, int z, cl_int unit) const {
        LwVoxelValue result{};
        voxel_unpack(word(plane, x, y, z), unit, &result);
        return result;
    }
    static VoxelLevel of(const VoxelVolume& volume, int level, int cascade = 0) {
        VoxelLevel result;
        const int size = int(volume.size);
        result.side = voxel_side(size, level);
        result.bricks = voxel_bricks(size, level);
        result.planes = int(level ? volume.mipPlanes() : volume.basePlanes());
        result.slots = level ? volume.mipSlots : volume.baseSlots;
        result.table.resize(std::size_t(result.bricks * result.bricks * result.bricks));
        volume.table.download(
            (std::size_t(cascade) * volume.tableSize() + std::size_t(voxel_table(size, level))) *
                sizeof(cl_int),
            result.table.size() * sizeof(cl_int), result.table.data());
        const Buffer& words = level ? volume.mips : volume.base;
        result.words.resize(words.bytes() / sizeof(cl_uint));
        words.download(0, words.bytes(), result.words.data());
        return result;
    }
};

template <class Visit>
void eachVoxel(int side, Visit visit) {
    for (int z = 0; z < side; ++z)
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) visit(x, y, z);
}

// Which voxels of the finest level are occupied, as VoxelGrid says it.
inline std::vector<cl_uint> occupiedBits(int size,
                                         const std::function<bool(int, int, int)>& isOccupied) {
    const int bricks = voxel_bricks(size, 0);
    std::vector<cl_uint> bits(std::size_t(bricks * bricks * bricks) * LW_VOXEL_BRICK_WORDS);
    eachVoxel(size, [&](int x, int y, int z) {
        if (!isOccupied(x, y, z)) return;
        const int brick = (z / 8 * bricks + y / 8) * bricks + x / 8,
                  bit = x % 8 + 8 * (y % 8) + 64 * (z % 8);
        bits[std::size_t(brick) * LW_VOXEL_BRICK_WORDS + std::size_t(bit / 32)] |= 1u << (bit % 32);
    });
    return bits;
}

}  // namespace lightwell::test
