#include "passes/interleaved_gather.h"

#include <algorithm>
#include <string>

#include "compute/device.h"
#include "shared/filter_rows.h"

namespace lightwell {
namespace {

// Rows of work-items; small groups keep both cores busy on a CPU, and 64 lanes of a GPU full.
Range groupOf(const Kernel& kernel) { return kernel.width() == 1 ? Range{64, 1} : Range{8, 1}; }

Range itemsOver(const Planes& image, std::uint32_t pixelsPerItem) {
    return {(image.width + pixelsPerItem - 1) / pixelsPerItem, image.height};
}

constexpr const char* kTilesProgram = "interleaved_gather/interleaved_tiles";
// Pixels: narrower tiles would not pay for their bits.
constexpr std::uint32_t kLeastTileWidth = 32;
constexpr std::uint64_t kBoundsPlanes = 12;

// Both at least one word: a kernel's argument must be some memory, also where it is not read.
std::size_t maskBytes(const lw_vpl_tiles& tiles, lw_subset_order order) {
    return std::max<std::size_t>(std::size_t(lw_tile_stride(tiles)) * std::size_t(order.subsets * tiles.words), 1) * 4;
}
std::size_t boundsBytes(const lw_vpl_tiles& tiles) {
    return tiles.words ? std::size_t(lw_tile_stride(tiles)) * kBoundsPlanes * 4 : 4;
}

Defines definesOf(std::uint32_t interleave) { return {{"LW_INTERLEAVE", std::to_string(interleave)}}; }

Defines filterDefines(std::uint32_t interleave, bool doubtful) {
    Defines defines = definesOf(interleave);
    if (doubtful) defines.push_back({"LW_DOUBT", "1"});
    return defines;
}

}  // namespace

InterleavedGather::InterleavedGather(Device& device, std::uint32_t interleave, bool doubtful)
    : interleave_(interleave),
      gather_(device.programs().kernel("interleaved_gather/interleaved_gather", "interleaved_gather_gather",
                                       definesOf(interleave))),
      validity_(device.programs().kernel("interleaved_gather/interleaved_gather", "interleaved_gather_validity",
                                         definesOf(interleave))),
      bounds_(device.programs().kernel(kTilesProgram, "interleaved_gather_bounds")),
      cull_(device.programs().kernel(kTilesProgram, "interleaved_gather_cull")) {
    if (interleave > 1)
        filter_ = &device.programs().kernel("interleaved_gather/interleaved_filter", "interleaved_gather_filter",
                                            filterDefines(interleave, doubtful));
}

lw_vpl_tiles VplTiles::layout(std::uint32_t width, std::uint32_t height, lw_subset_order order,
                              std::uint32_t interleave) {
    // A work-item of the gather lies within one tile at any width of vectors: all are powers of two.
    const std::uint32_t tileWidth = std::max(16 * interleave, kLeastTileWidth);
    lw_vpl_tiles tiles{};
    tiles.tileWidth = cl_int(tileWidth);
    tiles.columns = cl_int((width + tileWidth - 1) / tileWidth);
    tiles.rows = cl_int((height + LW_TILE_ROWS - 1) / LW_TILE_ROWS);
    if (skips(order)) tiles.words = (order.capacity + 31) / 32;
    return tiles;
}

void VplTiles::reserve(Device& device, std::uint32_t width, std::uint32_t height, lw_subset_order order,
                       std::uint32_t interleave) {
    masks_.reserve(device, maskBytes(layout(width, height, order, interleave), order), "bits of VPLs by tile");
    bounds_.reserve(device, boundsBytes(layout(width, height, order, interleave)), "boxes of tiles");
}

std::uint64_t VplTiles::estimateBytes(std::uint32_t width, std::uint32_t height, lw_subset_order order,
                                      std::uint32_t interleave) {
    const lw_vpl_tiles tiles = layout(width, height, order, interleave);
    return maskBytes(tiles, order) + boundsBytes(tiles);
}

void InterleavedGather::recordCull(Executor& executor, const Planes& position, const Planes& normal,
                                   const Buffer& vpls, lw_subset_order order, const VplTiles& memory) {
    const lw_vpl_tiles tiles = VplTiles::layout(position.width, position.height, order, interleave_);
    if (tiles.words == 0) return;
    executor.run("interleaved_gather.bounds", bounds_, {std::size_t(tiles.columns), std::size_t(tiles.rows)},
                 groupOf(bounds_), position, normal, cl_int(position.width), cl_int(position.height), tiles,
                 memory.bounds());
    executor.run("interleaved_gather.cull", cull_,
                 {std::size_t(lw_tile_stride(tiles)) / cull_.width(), std::size_t(order.subsets * tiles.words)}, groupOf(cull_),
                 memory.bounds(), tiles, vpls, order, memory.masks());
}

void InterleavedGather::recordGather(Executor& executor, const Planes& position, const Planes& normal,
                                     const Buffer& vpls, lw_subset_order order, const Buffer& masks,
                                     const Planes& irradiance, const Buffer& counts) {
    const lw_vpl_tiles layout = VplTiles::layout(position.width, position.height, order, interleave_);
    executor.run("interleaved_gather.gather", gather_, itemsOver(position, gather_.width() * interleave_),
                 groupOf(gather_), position, normal, cl_int(position.width), cl_int(position.height), vpls, order,
                 masks, layout, irradiance, counts);
}

void InterleavedGather::recordFilter(Executor& executor, const Planes& position, const Planes& normal,
                                     const Planes& irradiance, const Planes& filtered, const Planes& validity) {
    const std::uint32_t pixels = filter_->width();
    const Range items{(position.width + pixels - 1) / pixels, (position.height + LW_FILTER_ROWS - 1) / LW_FILTER_ROWS};
    // A kernel's argument must be some memory, also where it is not written.
    executor.run("interleaved_gather.filter", *filter_, items, groupOf(*filter_), position, normal, cl_int(position.width),
                 cl_int(position.height), irradiance, filtered, validity ? validity : filtered, cl_int(validity ? 1 : 0));
}

void InterleavedGather::recordValidity(Executor& executor, const Planes& position, const Planes& normal,
                                       const Planes& validity) {
    executor.run("interleaved_gather.validity", validity_, itemsOver(position, validity_.width()),
                 groupOf(validity_), position, normal, cl_int(position.width), cl_int(position.height), validity);
}

VplHarmonics::VplHarmonics(Device& device)
    : harmonics_(device.programs().kernel("interleaved_gather/interleaved_harmonics", "interleaved_gather_harmonics")) {}

void VplHarmonics::record(Executor& executor, const Planes& position, const Planes& normal, const Buffer& vpls,
                          lw_subset_order order, const Harmonics& harmonics, const Buffer& counts) {
    // A kernel's argument must be some memory, also where it is not read.
    executor.run("interleaved_gather.harmonics", harmonics_, itemsOver(position, harmonics_.width()), groupOf(harmonics_),
                 position, normal ? normal : position, cl_int(normal ? 1 : 0), cl_int(position.width), cl_int(position.height),
                 vpls, wholeOrder(order), harmonics.first, harmonics.band, counts);
}

lw_subset_order wholeOrder(lw_subset_order order) {
    order.capacity *= order.subsets;
    order.subsets = 1;
    return order;
}

}  // namespace lightwell
