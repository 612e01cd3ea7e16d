// Clusters of virtual point lights that share one look at the scene: k-means by position and normal (Lloyd 1982), warm
// started from the previous frame so that a cluster keeps its place in the list.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "passes/world_shift.h"
#include "shared/cluster_types.h"
#include "shared/kmeans_types.h"
#include "shared/vpl_types.h"

namespace lightwell {

struct KMeansOptions {
    std::uint32_t clusters = 8;    // 1 to 64; 0: every VPL is a cluster of its own
    std::uint32_t iterations = 3;  // a frame
    // In a frame that begins anew; 0: as in any. More: the clusters of still light have settled in the frames after, and maps drawn from
    // them stay. Fewer: they move for tens of frames, and as many maps are drawn again.
    std::uint32_t firstIterations = 0;
    // Squared distance: positionWeight |V - C|^2 / D^2 + normalWeight (1 - n_i . n), D the diagonal of the box around the
    // VPLs; 0 to 1e6 each. Only their ratio decides. More on normals: clusters reach farther along their walls; on
    // positions: one cluster may hold both sides of a thin wall.
    float positionWeight = 0.6f, normalWeight = 0.4f;
    bool warmStart = true;  // seeds are the previous frame's means; otherwise every frame begins with k-means++
};

// Where another pass wants the clusters of this frame to start: lw_cluster each, of which normal, position and its w, and
// the former medoid's slot are read, and a bit each (LW_KMEANS_MOST of them) set where there shall be none.
struct ClusterSeeds {
    const Buffer& clusters;
    const Buffer& dead;
};

// Brings clusters (lw_cluster each) of an earlier frame to this one's origin.
void moveClusters(Executor& executor, const Buffer& clusters, std::uint32_t count, const KeptPlaces& kept);

class KMeans {
public:
    // Throws INVALID_ARGUMENT for options out of range.
    KMeans(Device& device, const KMeansOptions& options);

    // Records passes "kmeans.*". `vpls`: lw_vpl by slot, `count` of them (at most 2^24); a slot without
    // flux belongs to no cluster. `restart`: forgets the previous frame (a cut). `seeds`: of a warm
    // start, instead of the previous frame's clusters; not read by a restart.
    void record(Executor& executor, const Buffer& vpls, std::uint32_t count, bool restart,
                const ClusterSeeds* seeds = nullptr);

    // lw_cluster each, normal.w being the sum of the members' squared distances as above. Empty ones, as there are when
    // fewer places are lit than there are clusters: position.w = 0, flux 0, medoidPosition.w = -1, everything finite.
    const Buffer& clusters() const { return clusters_; }
    const Buffer& assignment() const { return assignment_; }  // int by slot: cluster, or -1
    std::uint32_t clusterCount() const { return clusterCount_; }
    // Centre and diagonal of the box around the VPLs (LW_KMEANS_FRAME floats), and the squared
    // distance's weights.
    const Buffer& frame() const { return frameBuffer_; }
    cl_float2 weights() const { return {{options_.positionWeight, options_.normalWeight}}; }
    // Planes without memory, of the clusters: position, normal, flux, members, the medoid's position and normal.
    Planes debugShape() const;
    static const char* debugDescription();
    void recordPlanes(Executor& executor, const Planes& planes);  // fills them
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(const KMeansOptions& options, std::uint32_t count);

private:
    void reserve(std::uint32_t count);
    void iterate(Executor& executor, std::uint32_t stride, bool seeding, const ClusterSeeds* seeds);

    Device& device_;
    KMeansOptions options_;
    Kernel &unpack_, &frame_, &assign_, &seed_, &sums_, &update_, &members_, &finish_, &identity_, &planes_;
    Buffer sites_, partials_, means_, frameBuffer_, clusters_, assignment_;
    std::uint32_t clusterCount_ = 0;
    bool warm_ = false;
    KeptPlaces kept_;
};

}  // namespace lightwell
