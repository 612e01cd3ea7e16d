#include "passes/vpl_resampling.h"

#include <algorithm>
#include <limits>
#include <string>

#include "compute/device.h"
#include "compute/error.h"
#include "passes/interleaved_gather.h"
#include "shared/vpl_tiles.h"

namespace lightwell {
namespace {

Range groupOf(const Kernel& kernel) { return kernel.width() == 1 ? Range{64, 1} : Range{8, 1}; }

constexpr const char* kDraws = "vpl_resampling/vpl_draws";
constexpr std::uint64_t kBoundsPlanes = 12;

Defines definesOf(const VplResamplingOptions& options) {
    return {{"LW_INTERLEAVE", std::to_string(options.interleave)}, {"LW_VISIBILITY", std::to_string(int(options.visibility))}};
}

// The tiles are interleaved_gather's, whatever the list.
lw_vpl_tiles tilesOf(const VplResamplingOptions& options, std::uint32_t width, std::uint32_t height) {
    lw_subset_order none{};
    none.subsets = 1;
    return VplTiles::layout(width, height, none, options.interleave);
}

// Tiles' planes are padded; their draws are not.
std::uint64_t planeBytes(const lw_vpl_tiles& tiles) { return std::uint64_t(lw_tile_stride(tiles)) * sizeof(float); }
std::uint64_t drawsOf(const VplResamplingOptions& options, const lw_vpl_tiles& tiles) {
    return std::uint64_t(tiles.columns) * std::uint64_t(tiles.rows) * options.interleave * options.interleave * options.candidates;
}

std::uint64_t sumBytes(const lw_vpl_tiles& tiles, std::uint32_t slots) {
    return std::uint64_t(tiles.columns) * std::uint64_t(tiles.rows) * slots * sizeof(float);
}

// A number for the random ones (Murmur's finaliser); neither seed nor turn alone gives another's.
cl_uint keyOf(std::uint32_t seed, std::uint32_t turn) {
    cl_uint x = seed * 0x9e3779b9u + turn * 0x7feb352du + 0x68bc21ebu;
    x = (x ^ (x >> 16)) * 0x85ebca6bu;
    x = (x ^ (x >> 13)) * 0xc2b2ae35u;
    return x ^ (x >> 16);
}

}  // namespace

void VplDraws::reserve(Device& device, const VplResamplingOptions& options, std::uint32_t slots, std::uint32_t width, std::uint32_t height) {
    const lw_vpl_tiles tiles = tilesOf(options, width, height);
    bounds_.reserve(device, std::size_t(planeBytes(tiles) * kBoundsPlanes), "boxes of tiles");
    sums_.reserve(device, std::size_t(sumBytes(tiles, slots)), "tiles' weights of VPLs");
    list_.reserve(device, std::size_t(drawsOf(options, tiles) * sizeof(lw_vpl_draw)), "VPLs drawn by tiles");
}

std::uint64_t VplDraws::estimateBytes(const VplResamplingOptions& options, std::uint32_t slots, std::uint32_t width, std::uint32_t height) {
    const lw_vpl_tiles tiles = tilesOf(options, width, height);
    return planeBytes(tiles) * kBoundsPlanes + sumBytes(tiles, slots) + drawsOf(options, tiles) * sizeof(lw_vpl_draw);
}

VplResampling::VplResampling(Device& device, const VplResamplingOptions& options)
    : device_(device),
      options_(options),
      bounds_(device.programs().kernel("interleaved_gather/interleaved_tiles", "interleaved_gather_bounds")),
      cut_(device.programs().kernel(kDraws, "vpl_resampling_blocks")),
      weigh_(device.programs().kernel(kDraws, "vpl_resampling_weigh")),
      draw_(device.programs().kernel(kDraws, "vpl_resampling_draw")),
      gather_(device.programs().kernel("vpl_resampling/vpl_resampling", "vpl_resampling_gather", definesOf(options))) {}

std::uint64_t VplResampling::estimateBytes() { return LW_VPL_BLOCKS * sizeof(lw_vpl_block); }

void VplResampling::recordBlocks(Executor& executor, const Buffer& vpls, std::uint32_t slots, std::uint32_t seed,
                                 std::uint32_t turn) {
    blocks_.reserve(device_, LW_VPL_BLOCKS * sizeof(lw_vpl_block), "blocks of VPLs");
    draws_.slots = cl_int(slots);
    draws_.length = cl_int((slots + LW_VPL_BLOCKS - 1) / LW_VPL_BLOCKS);
    draws_.blocks = (draws_.slots + draws_.length - 1) / draws_.length;
    draws_.candidates = cl_int(options_.candidates);
    draws_.survivors = cl_int(options_.survivors);
    draws_.groups = cl_int(options_.groups);
    draws_.key = keyOf(seed, turn);
    executor.run("vpl_resampling.blocks", cut_, {LW_VPL_BLOCKS, 1}, {8, 1}, vpls, draws_, blocks_);
}

void VplResampling::recordDraw(Executor& executor, const Planes& position, const Planes& normal, const Buffer& vpls,
                               const VplDraws& memory) {
    const lw_vpl_tiles tiles = tilesOf(options_, position.width, position.height);
    if (std::max(drawsOf(options_, tiles) * 2, sumBytes(tiles, std::uint32_t(draws_.slots)) / sizeof(float)) > std::uint64_t(std::numeric_limits<std::int32_t>::max()))
        fail(LW_ERROR_UNSUPPORTED, "candidates: ", options_.candidates, " of ", draws_.slots, " VPLs for each of ", position.width, "x", position.height,
             " pixels exceed the 32-bit indices of the kernels");
    executor.run("vpl_resampling.bounds", bounds_, {std::size_t(tiles.columns), std::size_t(tiles.rows)}, groupOf(bounds_), position,
                 normal, cl_int(position.width), cl_int(position.height), tiles, memory.bounds());
    executor.run("vpl_resampling.weigh", weigh_, {std::size_t(lw_tile_stride(tiles)) / weigh_.width(), 1}, groupOf(weigh_),
                 position, normal, cl_int(position.width), cl_int(position.height), memory.bounds(), tiles, draws_, blocks_, vpls,
                 memory.sums());
    executor.run("vpl_resampling.draw", draw_, {std::size_t(tiles.columns) * std::size_t(tiles.rows), 1}, groupOf(draw_), tiles, draws_,
                 cl_int(options_.interleave), memory.sums(), memory.list());
}

void VplResampling::recordGather(Executor& executor, const Planes& position, const Planes& normal, const Buffer& vpls,
                                 const VplDraws& memory, const ClusterMaps& maps, const Planes& irradiance, const Buffer& counts) {
    const std::uint32_t pixels = gather_.width() * options_.interleave;
    // A kernel's argument must be some memory, also where it is not read.
    const VoxelSights voxels = maps.voxels ? *maps.voxels : VoxelSights{maps.records, maps.records, maps.records};
    executor.run("vpl_resampling.gather", gather_, {(position.width + pixels - 1) / pixels, position.height}, groupOf(gather_),
                 position, normal, cl_int(position.width), cl_int(position.height), vpls, draws_, memory.list(),
                 tilesOf(options_, position.width, position.height), maps.frames, maps.records, maps.secondFrames,
                 maps.secondRecords, cl_int(maps.seconds), cl_int(maps.size), voxels.sights, voxels.eyes, voxels.sight, irradiance,
                 counts);
}

}  // namespace lightwell
