// Irradiance of clustered VPLs at G-buffer pixels from a few of them: a pixel draws candidates, keeps some of them in
// proportion to the light that they would bring, and looks up the visibility of those only (resampled importance sampling:
// Talbot et al. 2005; Bitterli et al. 2020). In place of ClusteredGather's gather; the filter is interleaved_gather's.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "passes/clustered_gather.h"
#include "shared/subset_order.h"
#include "shared/vpl_resampling_types.h"

namespace lightwell {

struct VplResamplingOptions {
    std::uint32_t interleave = 4;    // 1, 2, 4 or 8: pixels of such a window draw different candidates
    std::uint32_t groups = 4;        // a power of two, interleave^2 at most: a pixel draws from one group of the list
    std::uint32_t candidates = 16;   // 1 .. LW_MOST_CANDIDATES
    std::uint32_t survivors = 4;     // 1 .. candidates, LW_MOST_SURVIVORS
    ClusterVisibility visibility = ClusterVisibility::hard;
};

// What the tiles of one image draw: memory of VplResampling::recordDraw.
class VplDraws {
public:
    // Makes room for images up to this size; allocates only where it has grown.
    void reserve(Device& device, const VplResamplingOptions& options, std::uint32_t slots, std::uint32_t width, std::uint32_t height);
    static std::uint64_t estimateBytes(const VplResamplingOptions& options, std::uint32_t slots, std::uint32_t width, std::uint32_t height);

    const Buffer& bounds() const { return bounds_; }    // 12 planes of tiles, as interleaved_gather_bounds leaves them
    const Buffer& sums() const { return sums_; }      // of the weights of the list's slots, by tile
    const Buffer& list() const { return list_; }        // lw_vpl_draw by tile, subset and candidate
    std::uint64_t bytes() const { return bounds_.bytes() + sums_.bytes() + list_.bytes(); }

private:
    Buffer bounds_, sums_, list_;
};

class VplResampling {
public:
    VplResampling(Device& device, const VplResamplingOptions& options);

    // Pass "vpl_resampling.blocks", once for a list (lw_vpl by slot, flux.w its cluster or -1, in the order of clusters) that
    // stays as it is until the last gather. Other numbers are drawn for another seed or turn.
    void recordBlocks(Executor& executor, const Buffer& vpls, std::uint32_t slots, std::uint32_t seed, std::uint32_t turn);
    // Passes "vpl_resampling.bounds", ".weigh" and ".draw": candidates for the pixels of this image. `memory` has room.
    void recordDraw(Executor& executor, const Planes& position, const Planes& normal, const Buffer& vpls, const VplDraws& memory);
    // Pass "vpl_resampling.gather", of candidates as recordDraw left them for this image. irradiance, counts: as
    // ClusteredGather::recordGather.
    void recordGather(Executor& executor, const Planes& position, const Planes& normal, const Buffer& vpls,
                      const VplDraws& memory, const ClusterMaps& maps, const Planes& irradiance, const Buffer& counts);

    const VplResamplingOptions& options() const { return options_; }
    std::uint32_t key() const { return draws_.key; }  // of the last recordBlocks' random numbers
    std::uint64_t bytes() const { return blocks_.bytes(); }
    static std::uint64_t estimateBytes();

private:
    Device& device_;
    VplResamplingOptions options_;
    Kernel &bounds_, &cut_, &weigh_, &draw_, &gather_;
    lw_vpl_draws draws_{};
    Buffer blocks_;
};

}  // namespace lightwell
