// Irradiance of clustered VPLs at G-buffer pixels, interleaved n x n, with the visibility of each cluster's
// paraboloid map (Dong et al. 2009; Aranha et al. 2020). The filter is interleaved_gather's.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "passes/harmonics.h"
#include "passes/voxel_visibility.h"
#include "shared/subset_order.h"
#include "shared/vpl_tiles.h"

namespace lightwell {

enum class ClusterVisibility { none, hard, soft, voxel, strict };

// A list of VPLs by index.
struct VplList {
    const Buffer& vpls;
    std::uint32_t count;
};

// The VPLs of a bounce; without an assignment (an int each: cluster, or -1: left out) nothing shadows their light. isUnshadowed: that is for
// thrift, so that strict gathers let it count as far as shadowed light bears it out, at least a quarter; otherwise it is beyond doubt.
struct GatheredList {
    VplList vpls;
    const Buffer* assignment = nullptr;
    std::uint32_t clusterCount = 0;
    bool isUnshadowed = false;
};

// Bounces whose VPLs have clusters.
constexpr std::size_t kMostClusteredLists = 4;

// The clusters' maps, as ParaboloidMap leaves them: of each list that has clusters, whose numbers go on from one list to the next.
// Voxels: what all of them see, one list after the other; with visibility through voxels, read instead.
struct ClusterMaps {
    struct List {
        const Buffer* frames;
        const Buffer* records;
        std::uint32_t clusters;
    };
    ClusterMaps(const std::vector<List>& drawn, std::uint32_t size, const VoxelSights* seen = nullptr);

    std::array<List, kMostClusteredLists> lists;  // a kernel's argument must be some memory: the first stands for those that are not there
    cl_int4 layout;  // the first cluster of the second, third and fourth list, and a map's side
    const VoxelSights* voxels;
};

class ClusteredGather {
public:
    // interleave: 1, 2, 4 or 8. groups: a power of two; a pixel gathers from one group of the VPLs sorted by cluster, and so
    // looks up about one groups-th of the clusters. interleave^2 at most.
    ClusteredGather(Device& device, std::uint32_t interleave, std::uint32_t groups, ClusterVisibility visibility);

    // For lists of so many VPLs each.
    static lw_subset_order orderOf(const std::vector<std::uint32_t>& counts, std::uint32_t interleave);
    static std::uint64_t estimateBytes(const std::vector<std::uint32_t>& counts, std::size_t clusteredLists,
                                       std::uint32_t interleave);

    // Passes "clustered_gather.sort" and ".order": deal each subset its share of every list, of those with clusters sorted by
    // cluster. At most kMostClusteredLists of them.
    void recordOrder(Executor& executor, const std::vector<GatheredList>& lists);
    // Pass "clustered_gather.gather"; masks (of `vpls`, by InterleavedGather::recordCull), irradiance and counts as in
    // InterleavedGather::recordGather. Of strict look-ups: a fourth plane of irradiance, if there is one, takes what is doubtful (the sum
    // over its channels), for a filter made with `doubtful`; otherwise what is not borne out is gone already. Of unshadowed light
    // what its pixel's subset of VPLs does not bear out is gone either way, but for a quarter of all.
    void recordGather(Executor& executor, const Planes& position, const Planes& normal, const Buffer& masks,
                      const lw_vpl_tiles& tiles, const ClusterMaps& maps, const Planes& irradiance, const Buffer& counts);

    // Debug views as planes without memory, and what fills them: the visibility that the gather takes surfaces to have from
    // each cluster, the clusters one below the other; and each slot's cluster.
    static Planes visibilityShape(const Planes& position, std::uint32_t clusterCount);
    void recordVisibility(Executor& executor, const Planes& position, const Planes& normal, const ClusterMaps& maps,
                          std::uint32_t clusterCount, const Planes& planes);
    Planes clustersShape() const;
    void recordClusters(Executor& executor, const Planes& planes);

    const Buffer& vpls() const { return vpls_; }       // lw_vpl by slot; flux.w: cluster, or LW_SEEN_EVERYWHERE, LW_UNSHADOWED
    lw_subset_order order() const { return order_; }  // its subsets and capacity
    std::uint64_t bytes() const;

private:
    Device& device_;
    std::uint32_t interleave_, groups_;
    Kernel &sort_, &orderList_, &deal_, &gather_, &visibility_, &clusters_;
    Buffer vpls_;
    std::array<Buffer, kMostClusteredLists> sorted_;
    lw_subset_order order_{};
    cl_uint shadowed_ = 0;  // of a subset's first 32 slots those whose light is shadowed, a bit each
};

// The same light at points, in two bands of spherical harmonics.
class ClusteredHarmonics {
public:
    ClusteredHarmonics(Device& device, ClusterVisibility visibility);

    // Pass "clustered_gather.harmonics": of the list of `gather`, whose interleave is 1. `normal` may be empty. counts[2] grows by
    // the points whose light is brought down.
    void record(Executor& executor, const Planes& position, const Planes& normal, const ClusteredGather& gather,
                const ClusterMaps& maps, const Harmonics& harmonics, const Buffer& counts);

private:
    Kernel& harmonics_;
};

}  // namespace lightwell
