#include "passes/second_bounce.h"

#include "compute/device.h"
#include "passes/vpl_list.h"
#include "shared/vpl_types.h"

namespace lightwell {

SecondBounce::SecondBounce(Device& device, const SecondBounceOptions& options)
    : device_(device),
      options_(options),
      draw_(device.programs().kernel("second_bounce/second_bounce", "second_bounce_draw")) {}

void SecondBounce::reserve(std::uint32_t clusterCount) {
    if (clusterCount) vpls_.reserve(device_, std::size_t(estimateBytes(options_, clusterCount)), "second-bounce VPLs");
    count_ = clusterCount * options_.perCluster;
}

std::uint64_t SecondBounce::estimateBytes(const SecondBounceOptions& options, std::uint32_t clusterCount) {
    return std::uint64_t(clusterCount) * options.perCluster * sizeof(lw_vpl);
}

void SecondBounce::record(Executor& executor, const Buffer& clusters, std::uint32_t clusterCount, const Buffer& frames,
                          const Buffer& records, const Buffer& albedo, std::uint32_t mapSize) {
    const std::uint32_t lanes = draw_.width();
    executor.run("second_bounce.draw", draw_, gridOver((count_ + lanes - 1) / lanes), {lanes == 1 ? 64u : 4u, 1}, clusters, frames,
                 records, albedo, cl_int(mapSize), cl_int(clusterCount), cl_int(options_.perCluster), cl_int(options_.directions),
                 sampleRotation(options_.seed), vpls_);
}

}  // namespace lightwell
