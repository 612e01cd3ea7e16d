#include "passes/voxel_mips.h"

#include <cstddef>

#include "compute/device.h"
#include "passes/vpl_list.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "voxel_mips/voxel_mips";
constexpr const char* kTables = "voxel_mips/voxel_tables";
constexpr Range kGroup{4, 1};

std::size_t bricksOf(std::uint32_t size, std::uint32_t level) {
    const auto side = std::size_t(voxel_bricks(cl_int(size), cl_int(level)));
    return side * side * side;
}
std::size_t runsOf(std::uint32_t size, std::uint32_t level) {
    return (bricksOf(size, level) + LW_VOXEL_RUN - 1) / LW_VOXEL_RUN;
}
std::uint32_t levelsOf(std::uint32_t size) {
    return std::uint32_t(voxel_levels(cl_int(size)));
}
cl_int sideOf(std::uint32_t size, std::uint32_t level) {
    return voxel_bricks(cl_int(size), cl_int(level));
}
cl_int tableOf(std::uint32_t size, std::uint32_t level) {
    return voxel_table(cl_int(size), cl_int(level));
}

std::size_t allRuns(std::uint32_t size) {
    std::size_t runs = 0;
    for (std::uint32_t level = 0; level < levelsOf(size); ++level) runs += runsOf(size, level);
    return runs;
}
std::size_t bitBytes(std::uint32_t size) {
    return std::size_t(voxel_table_size(cl_int(size)) - tableOf(size, 1)) * LW_VOXEL_BRICK_WORDS *
           sizeof(cl_uint);
}

}  // namespace

VoxelMips::VoxelMips(Device& device, std::uint32_t size, std::uint32_t cascade)
    : device_(device),
      size_(size),
      cascade_(cascade),
      look_(device.programs().kernel(kTables, "voxel_tables_look")),
      occupy_(device.programs().kernel(kTables, "voxel_tables_occupy")),
      count_(device.programs().kernel(kTables, "voxel_tables_count")),
      scan_(device.programs().kernel(kTables, "voxel_tables_scan")),
      assign_(device.programs().kernel(kTables, "voxel_tables_assign")),
      apron_(device.programs().kernel(kProgram, "voxel_mips_apron")),
      isotropic_(device.programs().kernel(kProgram, "voxel_mips_isotropic")),
      sides_(device.programs().kernel(kProgram, "voxel_mips_sides")),
      harmonics_(device.programs().kernel(kProgram, "voxel_mips_harmonics")) {}

void VoxelMips::reserve(Executor& executor) {
    const auto entries = std::size_t(voxel_table_size(cl_int(size_)));
    bits_.reserve(device_, bitBytes(size_), "bits of coarser voxels");
    wanted_.reserve(device_, entries, "bricks that want memory");
    counts_.reserve(device_, allRuns(size_) * sizeof(cl_int), "counts of bricks");
    if (!work_) {
        work_ = Buffer(device_, sizeof(LwVoxelWork), "changes of voxels");
        executor.fill("voxel_mips.clear", work_, 0, 0, work_.bytes());
    }
    if (!marks_) {
        marks_ = Buffer(device_, entries * sizeof(cl_int), "bricks that have changed");
        executor.fill("voxel_mips.clear", marks_, 0, 0, marks_.bytes());
    }
}

void VoxelMips::recordTables(Executor& executor, const Buffer& occupied, const Buffer& changed, bool all,
                             const VoxelVolume& volume) {
    reserve(executor);
    // What is wanted stays until tables are made anew: who reads it late may have missed the frame that found it out.
    executor.fill("voxel_mips.clear", work_, 0, 0, offsetof(LwVoxelWork, baseWanted));
    executor.run("voxel_mips.tables", look_, gridOver(runsOf(size_, 0)), kGroup, changed,
                 cl_int(bricksOf(size_, 0)), cl_int(all ? 1 : 0), work_);
    for (std::uint32_t level = 1; level < levelsOf(size_); ++level) {
        const bool isFirst = level == 1;
        executor.run("voxel_mips.tables", occupy_, gridOver(bricksOf(size_, level)), kGroup,
                     isFirst ? occupied : bits_,
                     isFirst ? 0 : tableOf(size_, level - 1) - tableOf(size_, 1),
                     sideOf(size_, level - 1), sideOf(size_, level),
                     tableOf(size_, level) - tableOf(size_, 1), work_, bits_);
    }
    const cl_int isDense = volume.sparse ? 0 : 1;
    std::size_t firstRun = 0;
    for (std::uint32_t level = 0; level < levelsOf(size_); ++level) {
        executor.run("voxel_mips.tables", count_, gridOver(runsOf(size_, level)), kGroup,
                     level == 0 ? occupied : bits_,
                     level == 0 ? 0 : tableOf(size_, level) - tableOf(size_, 1), sideOf(size_, level),
                     isDense, tableOf(size_, level), cl_int(firstRun), work_, wanted_, counts_);
        firstRun += runsOf(size_, level);
    }
    const cl_int baseRoom = cl_int(volume.baseSlots / volume.cascades),
                 mipRoom = cl_int(volume.mipSlots / volume.cascades);
    executor.run("voxel_mips.tables", scan_, {1, 1}, {1, 1}, counts_, cl_int(runsOf(size_, 0)),
                 cl_int(allRuns(size_)), baseRoom, mipRoom, work_, volume.state, cl_int(cascade_));
    firstRun = 0;
    const cl_int grid = cl_int(cascade_ * volume.tableSize());
    for (std::uint32_t level = 0; level < levelsOf(size_); ++level) {
        const cl_int room = level == 0 ? baseRoom : mipRoom;
        executor.run("voxel_mips.tables", assign_, gridOver(runsOf(size_, level)), kGroup, wanted_,
                     tableOf(size_, level), cl_int(bricksOf(size_, level)), counts_, cl_int(firstRun),
                     cl_int(cascade_) * room, room, work_, grid + tableOf(size_, level), volume.table);
        firstRun += runsOf(size_, level);
    }
}

void VoxelMips::recordApron(Executor& executor, const VoxelVolume& volume, std::uint32_t level) {
    const bool isBase = level == 0;
    const std::uint32_t planes = isBase ? volume.basePlanes() : volume.mipPlanes();
    executor.run("voxel_mips.apron", apron_, {bricksOf(size_, level), planes}, kGroup, volume.table,
                 cl_int(cascade_ * volume.tableSize()) + tableOf(size_, level), sideOf(size_, level),
                 work_, marks_, tableOf(size_, level), cl_int(planes),
                 cl_int((isBase ? volume.baseSlots : volume.mipSlots) * LW_VOXEL_STRIDE),
                 isBase ? volume.base : volume.mips);
}

void VoxelMips::recordFilter(Executor& executor, const VoxelVolume& volume) {
    Kernel& kernel = volume.mode == LW_VOXEL_MODE_ANISOTROPIC ? sides_
                     : volume.mode == LW_VOXEL_MODE_SH2       ? harmonics_
                                                              : isotropic_;
    const std::size_t first = std::size_t(tableOf(size_, 1)) * sizeof(cl_int);
    executor.fill("voxel_mips.clear", marks_, 0, first, marks_.bytes() - first);
    recordApron(executor, volume, 0);
    const cl_int grid = cl_int(cascade_ * volume.tableSize()),
                 mipPlane = cl_int(volume.mipSlots * LW_VOXEL_STRIDE);
    const cl_int basePlane = cl_int(volume.baseSlots * LW_VOXEL_STRIDE);
    for (std::uint32_t level = 1; level < levelsOf(size_); ++level) {
        const bool isFirst = level == 1,
                   isOnePlane = isFirst && volume.mode == LW_VOXEL_MODE_ANISOTROPIC && !volume.sides;
        LwVoxelFilter filter{};
        filter.fineMarks = tableOf(size_, level - 1);
        filter.marks = tableOf(size_, level);
        filter.fineTable = grid + filter.fineMarks;
        filter.table = grid + filter.marks;
        filter.fineSide = sideOf(size_, level - 1);
        filter.side = sideOf(size_, level);
        filter.fineFirst = isFirst ? basePlane * voxel_filtered_plane(volume.mode, volume.sides) : 0;
        filter.finePlane = isOnePlane ? 0 : isFirst ? basePlane : mipPlane;
        filter.plane = mipPlane;
        filter.voxels = voxel_side(cl_int(size_), cl_int(level));
        filter.level = cl_int(level);
        executor.run("voxel_mips.filter", kernel, gridOver(bricksOf(size_, level) * 8), kGroup, filter,
                     volume.table, isFirst ? volume.base : volume.mips, work_, marks_, volume.state,
                     cl_int(cascade_), volume.mips);
        recordApron(executor, volume, level);
    }
}

std::uint64_t VoxelMips::bytes() const {
    return work_.bytes() + marks_.bytes() + bits_.bytes() + wanted_.bytes() + counts_.bytes();
}

std::uint64_t VoxelMips::estimateBytes(std::uint32_t size) {
    const auto entries = std::uint64_t(voxel_table_size(cl_int(size)));
    return sizeof(LwVoxelWork) + entries * (sizeof(cl_int) + 1) + bitBytes(size) +
           allRuns(size) * sizeof(cl_int);
}

}  // namespace lightwell
