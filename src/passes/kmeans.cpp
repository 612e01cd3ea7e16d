#include "passes/kmeans.h"

#include <algorithm>
#include <cstddef>

#include "compute/device.h"
#include "compute/error.h"
#include "passes/vpl_list.h"

namespace lightwell {
namespace {

constexpr Range kGroup{64, 1};  // of kernels without lanes
constexpr std::uint32_t kMostSlots = 1u << 24;  // a medoid's index is exact in float up to there
constexpr float kMostWeight = 1e6f;             // distances stay below LW_KMEANS_FAR
constexpr std::uint32_t kDebugPlanes = 16;

constexpr std::size_t kMeanBytes = std::size_t(LW_MEAN_PLANES) * LW_KMEANS_MOST * sizeof(float);
constexpr std::size_t kFrameBytes = LW_KMEANS_FRAME * sizeof(float);

// Groups of as many lanes at every width: few work-items on CPUs, where even short lists shall occupy all cores.
Range groupOf(const Kernel& kernel) { return {LW_KMEANS_GROUP / kernel.width(), 1}; }

std::size_t wideItems(std::size_t lanes, const Kernel& kernel) {
    return (lanes + kernel.width() - 1) / kernel.width();
}

// Slots in the planes, padded to the widest work-item. Never none: an empty list has empty clusters, too.
std::uint32_t strideOf(std::uint32_t count) { return paddedWidth(std::max(count, 1u)); }

std::size_t chunksOf(std::uint32_t stride) { return (stride + LW_KMEANS_CHUNK - 1) / LW_KMEANS_CHUNK; }

std::size_t siteBytes(std::uint32_t count) { return std::size_t(strideOf(count)) * LW_SITE_PLANES * sizeof(float); }

std::size_t partialBytes(std::uint32_t count) {
    return chunksOf(strideOf(count)) * LW_PARTIAL_PLANES * LW_KMEANS_MOST * sizeof(float);
}

std::size_t clusterBytes(const KMeansOptions& options, std::uint32_t count) {
    return std::size_t(options.clusters ? options.clusters : std::max(count, 1u)) * sizeof(lw_cluster);
}

std::size_t assignmentBytes(std::uint32_t count) { return std::size_t(strideOf(count)) * sizeof(cl_int); }

void checkSlots(std::uint32_t count) {
    if (count > kMostSlots)
        fail(LW_ERROR_UNSUPPORTED, "vpls: ", count, " slots, clusters take at most ", kMostSlots);
}

const KMeansOptions& checked(const KMeansOptions& options) {
    if (options.clusters > LW_KMEANS_MOST)
        fail(LW_ERROR_INVALID_ARGUMENT, "clusters: expected 0 to ", LW_KMEANS_MOST, ", got ", options.clusters);
    if (options.iterations == 0) fail(LW_ERROR_INVALID_ARGUMENT, "iterations: expected 1 or more, got 0");
    for (const float weight : {options.positionWeight, options.normalWeight})
        if (!(weight >= 0.0f && weight <= kMostWeight))
            fail(LW_ERROR_INVALID_ARGUMENT, "positionWeight, normalWeight: expected 0 to ", kMostWeight, ", got ", weight);
    return options;
}

}  // namespace

void moveClusters(Executor& executor, const Buffer& clusters, std::uint32_t count, const KeptPlaces& kept) {
    for (const std::size_t at : {offsetof(lw_cluster, position), offsetof(lw_cluster, medoidPosition)})
        kept.move(executor, clusters, {count, std::uint32_t(at / sizeof(float)), LW_CLUSTER_FLOATS});
}

KMeans::KMeans(Device& device, const KMeansOptions& options)
    : device_(device),
      options_(checked(options)),
      unpack_(device.programs().kernel("kmeans/kmeans", "kmeans_unpack")),
      frame_(device.programs().kernel("kmeans/kmeans", "kmeans_frame")),
      assign_(device.programs().kernel("kmeans/kmeans", "kmeans_assign")),
      seed_(device.programs().kernel("kmeans/kmeans_seed", "kmeans_seed")),
      sums_(device.programs().kernel("kmeans/kmeans", "kmeans_sums")),
      update_(device.programs().kernel("kmeans/kmeans", "kmeans_update")),
      members_(device.programs().kernel("kmeans/kmeans_clusters", "kmeans_members")),
      finish_(device.programs().kernel("kmeans/kmeans_clusters", "kmeans_finish")),
      identity_(device.programs().kernel("kmeans/kmeans_clusters", "kmeans_identity")),
      planes_(device.programs().kernel("kmeans/kmeans_clusters", "kmeans_planes")) {}

void KMeans::reserve(std::uint32_t count) {
    checkSlots(count);
    // A list without slots has memory nevertheless: a kernel's argument must be some.
    assignment_.reserve(device_, assignmentBytes(count), "clusters of VPLs");
    clusters_.reserve(device_, clusterBytes(options_, count), "clusters");
    if (options_.clusters) {
        sites_.reserve(device_, siteBytes(count), "VPLs to be clustered");
        partials_.reserve(device_, partialBytes(count), "sums of clusters");
        means_.reserve(device_, kMeanBytes, "means of clusters");
        frameBuffer_.reserve(device_, kFrameBytes, "frame of clusters");
    }
    clusterCount_ = options_.clusters ? options_.clusters : count;
}

void KMeans::record(Executor& executor, const Buffer& vpls, std::uint32_t count, bool restart,
                    const ClusterSeeds* seeds) {
    reserve(count);
    if (options_.clusters == 0) {
        if (count)
            executor.run("kmeans.identity", identity_, gridOver(count), kGroup, vpls, cl_int(count), assignment_,
                         clusters_);
        return;
    }
    if (warm_ && kept_.moves(executor)) moveClusters(executor, clusters_, clusterCount_, kept_);
    kept_.arrive(executor);
    const std::uint32_t stride = strideOf(count);
    const cl_int clusters = cl_int(clusterCount_), keep = warm_ && options_.warmStart && !restart ? 1 : 0;
    const cl_float2 weights = this->weights();
    executor.run("kmeans.unpack", unpack_, gridOver(stride), kGroup, vpls, cl_int(count), cl_int(stride), sites_,
                 assignment_);
    executor.run("kmeans.frame", frame_, groupOf(frame_), groupOf(frame_), sites_, cl_int(stride),
                 seeds ? seeds->clusters : clusters_, clusters, keep, frameBuffer_, means_);
    iterate(executor, stride, keep == 0, keep ? seeds : nullptr);
    executor.run("kmeans.members", members_, gridOver(chunksOf(stride) * wideItems(clusterCount_, members_)),
                 groupOf(members_), vpls, cl_int(count), sites_, cl_int(stride), assignment_, means_,
                 seeds ? seeds->clusters : clusters_, clusters, keep, weights, partials_);
    executor.run("kmeans.finish", finish_, {clusterCount_, 1}, kGroup, vpls, cl_int(stride), partials_, means_,
                 frameBuffer_, clusters, clusters_);
    warm_ = true;
}

// `seeding`: there are no means yet; seeds give the first assignment.
void KMeans::iterate(Executor& executor, std::uint32_t stride, bool seeding, const ClusterSeeds* seeds) {
    const cl_int slots = cl_int(stride), clusters = cl_int(clusterCount_);
    const cl_float2 weights = this->weights();
    const Range chunks = gridOver(chunksOf(stride) * wideItems(clusterCount_, sums_));
    const std::uint32_t iterations = seeding && options_.firstIterations ? options_.firstIterations : options_.iterations;
    for (std::uint32_t i = 0; i < iterations; ++i) {
        if (i || !seeding)
            executor.run("kmeans.assign", assign_, gridOver(wideItems(stride, assign_)), groupOf(assign_), sites_, slots,
                         means_, clusters, weights, assignment_);
        executor.run("kmeans.seed", seed_, groupOf(seed_), groupOf(seed_), sites_, slots, assignment_,
                     clusters, weights, cl_int(seeds ? 1 : 0), seeds ? seeds->dead : assignment_,
                     means_);
        executor.run("kmeans.sums", sums_, chunks, groupOf(sums_), sites_, slots, assignment_, clusters, partials_);
        executor.run("kmeans.update", update_, {wideItems(clusterCount_, update_), 1}, groupOf(update_), sites_, slots,
                     assignment_, clusters, partials_, means_);
    }
}

Planes KMeans::debugShape() const {
    Planes planes;
    planes.width = clusterCount_;
    planes.height = 1;
    planes.rowStride = planes.planeStride = paddedWidth(planes.width);
    planes.count = kDebugPlanes;
    return planes;
}

const char* KMeans::debugDescription() {
    return "clusters: mean position, normal, flux (W), members, medoid's position and normal";
}

void KMeans::recordPlanes(Executor& executor, const Planes& planes) {
    executor.run("kmeans.planes", planes_, gridOver(planes.width), kGroup, clusters_, cl_int(planes.width), planes.memory,
                 cl_int(planes.planeStride));
}

std::uint64_t KMeans::bytes() const {
    return sites_.bytes() + partials_.bytes() + means_.bytes() + frameBuffer_.bytes() + clusters_.bytes() +
           assignment_.bytes();
}

std::uint64_t KMeans::estimateBytes(const KMeansOptions& options, std::uint32_t count) {
    checkSlots(count);
    const std::uint64_t list = assignmentBytes(count) + clusterBytes(options, count);
    return options.clusters ? list + siteBytes(count) + partialBytes(count) + kMeanBytes + kFrameBytes : list;
}

}  // namespace lightwell
