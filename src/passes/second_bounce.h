// VPLs of the second bounce, drawn from the clusters' paraboloid maps (Aranha et al. 2020).
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"

namespace lightwell {

struct SecondBounceOptions {
    std::uint32_t perCluster = 32;
    // LWDirections: cosine, uniform on the map's disc, uniform on the square about it.
    std::uint32_t directions = 0;
    std::uint32_t seed = 0;
};

class SecondBounce {
public:
    SecondBounce(Device& device, const SecondBounceOptions& options);

    // Makes room for the VPLs of so many clusters; allocates only where they have grown.
    void reserve(std::uint32_t clusterCount);
    // Pass "second_bounce.draw": perCluster VPLs of each cluster; a sample that met nothing carries no flux. albedo: of the
    // maps' texels, packed.
    void record(Executor& executor, const Buffer& clusters, std::uint32_t clusterCount, const Buffer& frames,
                const Buffer& records, const Buffer& albedo, std::uint32_t mapSize);

    const Buffer& vpls() const { return vpls_; }  // lw_vpl by cluster
    std::uint32_t vplCount() const { return count_; }
    std::uint32_t perCluster() const { return options_.perCluster; }
    std::uint64_t bytes() const { return vpls_.bytes(); }
    static std::uint64_t estimateBytes(const SecondBounceOptions& options, std::uint32_t clusterCount);

private:
    Device& device_;
    SecondBounceOptions options_;
    Kernel& draw_;
    Buffer vpls_;
    std::uint32_t count_ = 0;
};

}  // namespace lightwell
