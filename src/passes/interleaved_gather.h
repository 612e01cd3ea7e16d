// Irradiance of VPLs at G-buffer pixels, all VPLs per pixel or interleaved n x n with the edge-aware
// filter (Segovia et al. 2006).
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "passes/harmonics.h"
#include "shared/subset_order.h"
#include "shared/vpl_tiles.h"

namespace lightwell {

// For each tile of one image the VPLs that can light it: memory of InterleavedGather::recordCull.
class VplTiles {
public:
    // Lists longer than this are left whole: their bits would take more memory than their time is worth.
    static constexpr std::int64_t kMostSlots = 16384;

    static bool skips(lw_subset_order order) { return std::int64_t(order.subsets) * order.capacity <= kMostSlots; }

    // Makes room for images up to this size; allocates only where the list has grown.
    void reserve(Device& device, std::uint32_t width, std::uint32_t height, lw_subset_order order,
                 std::uint32_t interleave);
    static lw_vpl_tiles layout(std::uint32_t width, std::uint32_t height, lw_subset_order order, std::uint32_t interleave);
    // What reserve takes.
    static std::uint64_t estimateBytes(std::uint32_t width, std::uint32_t height, lw_subset_order order,
                                       std::uint32_t interleave);

    const Buffer& bounds() const { return bounds_; }  // 12 planes of tiles
    const Buffer& masks() const { return masks_; }    // bits of slots by tile, as in shared/vpl_tiles.h
    std::uint64_t bytes() const { return bounds_.bytes() + masks_.bytes(); }

private:
    Buffer bounds_, masks_;
};

class InterleavedGather {
public:
    // interleave: 1, 2, 4 or 8.
    // doubtful: the filter takes what a strict ClusteredGather left in a fourth plane, and keeps of it what the rest of the light bears out.
    InterleavedGather(Device& device, std::uint32_t interleave, bool doubtful = false);

    // Passes "interleaved_gather.bounds" and ".cull": finds the VPLs (lw_vpl by slot) that tiles of the
    // image can skip. `tiles` has room for them.
    void recordCull(Executor& executor, const Planes& position, const Planes& normal, const Buffer& vpls,
                    lw_subset_order order, const VplTiles& tiles);
    // Pass "interleaved_gather.gather": irradiance (3 planes) from one subset of the VPLs per pixel, times
    // the number of subsets; `masks` as recordCull left them for this image and list. counts[0] grows by
    // the pixels with neither a surface nor a zero normal, counts[2] by those brought down to LW_LARGEST_IRRADIANCE.
    void recordGather(Executor& executor, const Planes& position, const Planes& normal, const Buffer& vpls,
                      lw_subset_order order, const Buffer& masks, const Planes& irradiance, const Buffer& counts);
    // Pass "interleaved_gather.filter"; irradiance and filtered are different images. interleave > 1 only. `validity`,
    // where wanted, becomes what recordValidity makes it.
    void recordFilter(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                      const Planes& filtered, const Planes& validity = {});
    // Pass "interleaved_gather.validity": 1 on surfaces, 0 elsewhere.
    void recordValidity(Executor& executor, const Planes& position, const Planes& normal, const Planes& validity);

    std::uint32_t interleave() const { return interleave_; }

private:
    std::uint32_t interleave_;
    Kernel &gather_, &validity_, &bounds_, &cull_;
    Kernel* filter_ = nullptr;
};

// The same VPLs' light at points, in two bands of spherical harmonics.
class VplHarmonics {
public:
    explicit VplHarmonics(Device& device);

    // Pass "interleaved_gather.harmonics": of all slots of the list. `normal` may be empty. counts[2] grows by the points whose
    // light is brought down.
    void record(Executor& executor, const Planes& position, const Planes& normal, const Buffer& vpls, lw_subset_order order,
                const Harmonics& harmonics, const Buffer& counts);

private:
    Kernel& harmonics_;
};

// A list that was dealt out to subsets, as one subset.
lw_subset_order wholeOrder(lw_subset_order order);

}  // namespace lightwell
