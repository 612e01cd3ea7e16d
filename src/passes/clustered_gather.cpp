#include "passes/clustered_gather.h"

#include <algorithm>
#include <limits>
#include <string>

#include "compute/device.h"
#include "compute/error.h"
#include "passes/vpl_list.h"
#include "shared/cluster_types.h"
#include "shared/vpl_types.h"

namespace lightwell {
namespace {

Range groupOf(const Kernel& kernel) { return kernel.width() == 1 ? Range{64, 1} : Range{8, 1}; }

Defines definesOf(std::uint32_t interleave, ClusterVisibility visibility) {
    return {{"LW_INTERLEAVE", std::to_string(interleave)}, {"LW_VISIBILITY", std::to_string(int(visibility))}};
}

std::uint64_t listBytes(const lw_subset_order& order) {
    return std::uint64_t(order.subsets) * std::uint64_t(order.capacity) * sizeof(lw_vpl);
}

// A kernel's argument must be some memory, also where it is not read.
VoxelSights voxelsOf(const ClusterMaps& maps) {
    const Buffer& some = *maps.lists[0].records;
    return maps.voxels ? *maps.voxels : VoxelSights{some, some, some};
}

// Calls `run` with the arguments LW_MAPS_ARGUMENTS.
template <typename Run>
void withMaps(const ClusterMaps& maps, const Run& run) {
    const VoxelSights voxels = voxelsOf(maps);
    const auto& l = maps.lists;
    run(*l[0].frames, *l[0].records, *l[1].frames, *l[1].records, *l[2].frames, *l[2].records, *l[3].frames, *l[3].records, maps.layout,
        voxels.sights, voxels.eyes, voxels.sight);
}

std::uint64_t sortedBytes(std::uint32_t count) { return (std::uint64_t(count) + 1) * sizeof(cl_int); }

}  // namespace

ClusterMaps::ClusterMaps(const std::vector<List>& drawn, std::uint32_t size, const VoxelSights* seen) : voxels(seen) {
    if (drawn.empty() || drawn.size() > kMostClusteredLists) fail(LW_ERROR_INTERNAL, "clustered_gather: maps of ", drawn.size(), " lists");
    lists.fill(drawn[0]);
    std::copy(drawn.begin(), drawn.end(), lists.begin());
    cl_int end = cl_int(drawn[0].clusters);
    for (std::size_t i = 1; i < kMostClusteredLists; ++i) {
        layout.s[i - 1] = i < drawn.size() ? end : std::numeric_limits<cl_int>::max();
        if (i < drawn.size()) end += cl_int(drawn[i].clusters);
    }
    layout.s[kMostClusteredLists - 1] = cl_int(size);
}

ClusteredGather::ClusteredGather(Device& device, std::uint32_t interleave, std::uint32_t groups, ClusterVisibility visibility)
    : device_(device),
      interleave_(interleave),
      groups_(groups),
      sort_(device.programs().kernel("clustered_gather/clustered_order", "clustered_gather_sort")),
      orderList_(device.programs().kernel("clustered_gather/clustered_order", "clustered_gather_order")),
      deal_(device.programs().kernel("clustered_gather/clustered_order", "clustered_gather_deal")),
      gather_(device.programs().kernel("clustered_gather/clustered_gather", "clustered_gather_gather",
                                       definesOf(interleave, visibility))),
      visibility_(device.programs().kernel("clustered_gather/clustered_gather", "clustered_gather_visibility",
                                           definesOf(interleave, visibility))),
      clusters_(device.programs().kernel("clustered_gather/clustered_order", "clustered_gather_clusters")) {}

// Slots for all lists side by side.
lw_subset_order ClusteredGather::orderOf(const std::vector<std::uint32_t>& counts, std::uint32_t interleave) {
    lw_subset_order order = subsetOrder(0, interleave * interleave);
    order.capacity = order.count = 0;
    for (const std::uint32_t count : counts) {
        order.capacity += subsetOrder(count, interleave * interleave).capacity;
        order.count += cl_int(count);
    }
    if (listBytes(order) / sizeof(float) > std::uint64_t(std::numeric_limits<std::int32_t>::max()))
        fail(LW_ERROR_UNSUPPORTED, "vpls: those of ", counts.size(), " bounces together exceed the 32-bit indices of the kernels");
    return order;
}

std::uint64_t ClusteredGather::estimateBytes(const std::vector<std::uint32_t>& counts, std::size_t clusteredLists,
                                             std::uint32_t interleave) {
    std::uint64_t total = listBytes(orderOf(counts, interleave));
    for (std::size_t i = 0; i < std::min(clusteredLists, counts.size()); ++i) total += sortedBytes(counts[i]);
    return total;
}

void ClusteredGather::recordOrder(Executor& executor, const std::vector<GatheredList>& lists) {
    std::vector<std::uint32_t> counts;
    for (const GatheredList& list : lists) counts.push_back(list.vpls.count);
    const lw_subset_order order = orderOf(counts, interleave_);
    vpls_.reserve(device_, std::size_t(listBytes(order)), "VPLs by cluster");
    order_ = order;
    const std::uint32_t subsets = interleave_ * interleave_;
    cl_int2 slots{};
    cl_int firstCluster = 0;
    std::size_t sortedLists = 0;
    shadowed_ = 0;
    for (const GatheredList& list : lists) {
        const lw_subset_order dealt = subsetOrder(list.vpls.count, subsets);
        slots.s[1] = dealt.capacity;
        if (!list.assignment) {
            executor.run("clustered_gather.order", deal_, {subsets, 1}, {1, 1}, list.vpls.vpls, dealt, order_, slots,
                         cl_int(list.isUnshadowed ? LW_UNSHADOWED : LW_SEEN_EVERYWHERE), vpls_);
        } else {
            if (sortedLists == kMostClusteredLists) fail(LW_ERROR_INTERNAL, "clustered_gather: more lists with clusters than maps");
            Buffer& sorted = sorted_[sortedLists++];
            sorted.reserve(device_, std::size_t(sortedBytes(list.vpls.count)), "order of VPLs by cluster");
            executor.run("clustered_gather.sort", sort_, {std::clamp<std::uint32_t>(list.clusterCount, 1, LW_MOST_SORTED), 1},
                         {1, 1}, *list.assignment, cl_int(list.vpls.count), cl_int(list.clusterCount), sorted);
            executor.run("clustered_gather.order", orderList_, {subsets, 1}, {1, 1}, list.vpls.vpls, *list.assignment, sorted,
                         cl_int(list.vpls.count), firstCluster, cl_int(interleave_), cl_int(groups_), order_, slots, vpls_);
            firstCluster += cl_int(list.clusterCount);
        }
        slots.s[0] += slots.s[1];
        if (list.assignment) shadowed_ = slots.s[0] < 32 ? (1u << slots.s[0]) - 1u : 0xffffffffu;
    }
}

std::uint64_t ClusteredGather::bytes() const {
    std::uint64_t total = vpls_.bytes();
    for (const Buffer& sorted : sorted_) total += sorted.bytes();
    return total;
}

void ClusteredGather::recordGather(Executor& executor, const Planes& position, const Planes& normal,
                                   const Buffer& masks, const lw_vpl_tiles& tiles, const ClusterMaps& maps,
                                   const Planes& irradiance, const Buffer& counts) {
    const std::uint32_t pixels = gather_.width() * interleave_;
    withMaps(maps, [&](const auto&... of) {
        executor.run("clustered_gather.gather", gather_, {(position.width + pixels - 1) / pixels, position.height}, groupOf(gather_),
                     position, normal, cl_int(position.width), cl_int(position.height), vpls_, order_, masks, tiles, of..., shadowed_,
                     cl_int(irradiance.count > 3), irradiance, counts);
    });
}

Planes ClusteredGather::visibilityShape(const Planes& position, std::uint32_t clusterCount) {
    Planes planes;
    planes.width = position.width;
    planes.height = position.height * clusterCount;
    planes.rowStride = paddedWidth(planes.width);
    planes.planeStride = planes.rowStride * planes.height;
    planes.count = 1;
    return planes;
}

void ClusteredGather::recordVisibility(Executor& executor, const Planes& position, const Planes& normal,
                                       const ClusterMaps& maps, std::uint32_t clusterCount, const Planes& planes) {
    if (planes.height == 0) return;
    if (planes.planeStride > std::numeric_limits<std::int32_t>::max())
        fail(LW_ERROR_UNSUPPORTED, "debug view visibility: ", clusterCount, " clusters at ", position.width, "x", position.height,
             " pixels exceed the 32-bit indices of the kernels");
    withMaps(maps, [&](const auto&... of) {
        executor.run("clustered_gather.visibility", visibility_,
                     {(position.width + visibility_.width() - 1) / visibility_.width(), planes.height}, groupOf(visibility_), position,
                     normal, cl_int(position.width), cl_int(position.height), cl_int(clusterCount), of..., planes.memory,
                     cl_int(planes.rowStride));
    });
}

Planes ClusteredGather::clustersShape() const {
    Planes planes;
    planes.width = std::uint32_t(order_.subsets * order_.capacity);
    planes.height = 1;
    planes.rowStride = planes.planeStride = paddedWidth(planes.width);
    planes.count = 1;
    return planes;
}

void ClusteredGather::recordClusters(Executor& executor, const Planes& planes) {
    executor.run("clustered_gather.clusters", clusters_, gridOver(planes.width), {64, 1}, vpls_, cl_int(planes.width),
                 planes.memory);
}

ClusteredHarmonics::ClusteredHarmonics(Device& device, ClusterVisibility visibility)
    : harmonics_(device.programs().kernel("clustered_gather/clustered_harmonics", "clustered_gather_harmonics",
                                          {{"LW_VISIBILITY", std::to_string(int(visibility))}})) {}

void ClusteredHarmonics::record(Executor& executor, const Planes& position, const Planes& normal, const ClusteredGather& gather,
                                const ClusterMaps& maps, const Harmonics& harmonics, const Buffer& counts) {
    withMaps(maps, [&](const auto&... of) {
        // A kernel's argument must be some memory, also where it is not read.
        executor.run("clustered_gather.harmonics", harmonics_,
                     {(position.width + harmonics_.width() - 1) / harmonics_.width(), position.height}, groupOf(harmonics_), position,
                     normal ? normal : position, cl_int(normal ? 1 : 0), cl_int(position.width), cl_int(position.height), gather.vpls(),
                     gather.order(), of..., harmonics.first, harmonics.band, counts);
    });
}

}  // namespace lightwell
