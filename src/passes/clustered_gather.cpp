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

std::uint64_t sortedBytes(std::uint32_t firstCount) { return (std::uint64_t(firstCount) + 1) * sizeof(cl_int); }

}  // namespace

ClusteredGather::ClusteredGather(Device& device, std::uint32_t interleave, std::uint32_t groups, ClusterVisibility visibility)
    : device_(device),
      interleave_(interleave),
      groups_(groups),
      sort_(device.programs().kernel("clustered_gather/clustered_order", "clustered_gather_sort")),
      orderList_(device.programs().kernel("clustered_gather/clustered_order", "clustered_gather_order")),
      gather_(device.programs().kernel("clustered_gather/clustered_gather", "clustered_gather_gather",
                                       definesOf(interleave, visibility))),
      visibility_(device.programs().kernel("clustered_gather/clustered_gather", "clustered_gather_visibility",
                                           definesOf(interleave, visibility))),
      clusters_(device.programs().kernel("clustered_gather/clustered_order", "clustered_gather_clusters")) {}

// Slots for both lists side by side.
lw_subset_order ClusteredGather::orderOf(std::uint32_t firstCount, std::uint32_t secondCount, std::uint32_t interleave) {
    lw_subset_order order = subsetOrder(firstCount, interleave * interleave);
    order.capacity += subsetOrder(secondCount, interleave * interleave).capacity;
    order.count = cl_int(firstCount + secondCount);
    return order;
}

void ClusteredGather::reserve(std::uint32_t firstCount, std::uint32_t secondCount) {
    const lw_subset_order order = orderOf(firstCount, secondCount, interleave_);
    vpls_.reserve(device_, std::size_t(listBytes(order)), "VPLs by cluster");
    sorted_.reserve(device_, std::size_t(sortedBytes(firstCount)), "order of VPLs by cluster");
    order_ = order;
}

std::uint64_t ClusteredGather::estimateBytes(std::uint32_t firstCount, std::uint32_t secondCount,
                                             std::uint32_t interleave) {
    return listBytes(orderOf(firstCount, secondCount, interleave)) + sortedBytes(firstCount);
}

void ClusteredGather::recordOrder(Executor& executor, const VplList& firsts, const Buffer& assignment,
                                  std::uint32_t clusterCount, const VplList& seconds) {
    const std::uint32_t subsets = interleave_ * interleave_;
    executor.run("clustered_gather.sort", sort_, {std::clamp<std::uint32_t>(clusterCount, 1, LW_MOST_SORTED), 1}, {1, 1}, assignment,
                 cl_int(firsts.count), cl_int(clusterCount), sorted_);
    executor.run("clustered_gather.order", orderList_, {subsets, 1}, {1, 1}, firsts.vpls, assignment, sorted_,
                 cl_int(firsts.count), seconds.vpls, subsetOrder(seconds.count, subsets), cl_int(interleave_),
                 cl_int(groups_), order_, vpls_);
}

void ClusteredGather::recordGather(Executor& executor, const Planes& position, const Planes& normal,
                                   const Buffer& masks, const lw_vpl_tiles& tiles, const ClusterMaps& maps,
                                   const Planes& irradiance, const Buffer& counts) {
    const std::uint32_t pixels = gather_.width() * interleave_;
    executor.run("clustered_gather.gather", gather_, {(position.width + pixels - 1) / pixels, position.height},
                 groupOf(gather_), position, normal, cl_int(position.width), cl_int(position.height), vpls_, order_, masks,
                 tiles, maps.frames, maps.records, cl_int(maps.size), irradiance, counts);
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
    executor.run("clustered_gather.visibility", visibility_,
                 {(position.width + visibility_.width() - 1) / visibility_.width(), planes.height}, groupOf(visibility_),
                 position, normal, cl_int(position.width), cl_int(position.height), cl_int(clusterCount), maps.frames,
                 maps.records, cl_int(maps.size), planes.memory, cl_int(planes.rowStride));
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

}  // namespace lightwell
