// What technique ssvp's descriptor asks of each pass, and the memory that all of them take.
#include "techniques/ssvp_options.h"

#include <algorithm>
#include <vector>

#include "inputs/rsm_input.h"

namespace lightwell {

VplSamplingOptions samplingOptions(const LWSsvpDesc& desc) {
    VplSamplingOptions options;
    options.count = desc.vpls;
    options.uniform = desc.sampling == LW_SAMPLING_UNIFORM;
    options.view = desc.sampling == LW_SAMPLING_VIEW;
    options.subsets = 1;  // in their own order: clusters are dealt out, not this list
    options.seed = desc.seed;
    return options;
}

// Lloyd's iterations that 64 clusters of some thousand VPLs settle in; a tenth of a millisecond each, in first frames only.
constexpr std::uint32_t kFirstIterations = 24;

// Of bounce `stage` + 1. The first bounce's VPLs may have a cluster each; those of later ones would be
// too many.
KMeansOptions clusterOptions(const LWSsvpDesc& desc, std::size_t stage) {
    KMeansOptions options;
    options.clusters = stage > 0 && desc.clusters == 0 ? LW_MOST_SORTED : desc.clusters;
    options.warmStart = desc.warmStart != 0;
    if (options.warmStart) options.firstIterations = kFirstIterations;
    return options;
}

// Three of Lloyd's iterations each. 64 clusters of 1,024 VPLs took 42 iterations from a first frame on in the slowest of six scenes, and of 2,048
// four updates after light that had moved; of 4,096 to 16,384 up to 26. Fewer: clusters of light that came to rest stay where they were half-way.
// A bounce's clusters come to rest after those that its VPLs are drawn from. VPLs that have a cluster each rest at once.
std::uint32_t settlingOf(const LWSsvpDesc& desc) {
    constexpr std::uint32_t kMany = 2048, kFew = 16, kMore = 48;
    std::uint32_t vpls = desc.vpls, updates = 0;
    for (std::size_t stage = 0; stage < stagesOf(desc); ++stage) {
        const std::uint32_t clusters = clusterOptions(desc, stage).clusters;
        if (clusters > 0) updates += vpls > kMany ? kMore : kFew;
        vpls = (clusters > 0 ? clusters : vpls) * desc.secondVpls;
    }
    return std::max(updates, kFew);
}

SecondBounceOptions nextOptions(const LWSsvpDesc& desc, std::size_t stage) {
    SecondBounceOptions options;
    options.perCluster = desc.secondVpls;
    options.directions = std::uint32_t(desc.directions);
    options.seed = desc.seed + std::uint32_t(stage);
    return options;
}

bool looksStrictly(const LWSsvpDesc& desc) { return desc.visibility == LW_VISIBILITY_STRICT || desc.visibility == LW_VISIBILITY_CAREFUL; }

// The first bounce's light alone does not tell where the second's gets: most of what lights a closed room would go.
bool bearsOut(const LWSsvpDesc& desc) {
    return desc.visibility == LW_VISIBILITY_CAREFUL && shadowedOf(desc) > 1 && desc.bounces > shadowedOf(desc);
}

InterleavedOptions interleavedOptions(const LWSsvpDesc& desc) {
    InterleavedOptions options;
    options.interleave = desc.interleave;
    options.filter = desc.filter != 0;
    options.halvings = desc.autoResolution > 0.0f ? 1 : std::uint32_t(desc.resolution);
    options.history = {desc.history, desc.historyClamp, 0};
    options.compensated = desc.compensation > 0;
    options.doubtful = looksStrictly(desc);
    options.repairs = desc.autoResolution;
    return options;
}

CompensationOptions compensationOptions(const LWSsvpDesc& desc) {
    return {desc.interleave, desc.compensation, desc.sampling == LW_SAMPLING_UNIFORM};
}

// Occluders serve the visibility and further bounces; maps of a stage's clusters the visibility, but that through voxels,
// and the bounce after it.
OccluderOptions occluderOptions(const LWSsvpDesc& desc) {
    OccluderOptions options;
    options.occluders = desc.occluders;
    options.mapSize = desc.mapSize;
    options.isWanted = desc.visibility != LW_VISIBILITY_NONE || desc.bounces > 1;
    options.isStrict = looksStrictly(desc);
    options.throughVoxels = desc.visibility == LW_VISIBILITY_VOXEL;
    const bool looks = desc.visibility != LW_VISIBILITY_NONE && !options.throughVoxels;
    options.drawn = looks ? stagesOf(desc) : desc.bounces - 1;
    return options;
}

// As many groups as the interleave's window has pixels, at most.
std::uint32_t groupsOf(const LWSsvpDesc& desc) {
    return std::min(desc.clusterGroups, desc.interleave * desc.interleave);
}

// Bounces whose VPLs are shadowed, and those whose VPLs have clusters: these and all that another bounce
// follows.
std::size_t shadowedOf(const LWSsvpDesc& desc) {
    return desc.visibility == LW_VISIBILITY_NONE ? 0 : std::min(desc.shadowedBounces, desc.bounces);
}
std::size_t stagesOf(const LWSsvpDesc& desc) {
    return std::max<std::size_t>({1, shadowedOf(desc), desc.bounces - 1});
}

SsvpPlanOptions planOptions(const LWSsvpDesc& desc) {
    SsvpPlanOptions options;
    options.error = desc.autoError;
    options.vpls = desc.vpls;
    options.clusters = desc.clusters;
    options.bounces = desc.bounces;
    options.plansVpls = desc.sampling == LW_SAMPLING_FLUX;
    // Without a warm start every frame seeds anew, and a count of one frame says nothing of the next's.
    options.plansClusters = desc.clusters > 0 && desc.warmStart != 0;
    options.stages = stagesOf(desc);
    return options;
}

std::uint64_t estimateSsvpBytes(const void* desc, const LWViewDesc& view, const FrameShape& shape) {
    const LWSsvpDesc& ssvp = *static_cast<const LWSsvpDesc*>(desc);
    std::vector<std::uint32_t> counts{
        std::uint32_t(VplSampling::orderOf(samplingOptions(ssvp), shape).count)},
        clusterCounts;
    std::uint64_t total = 0;
    std::uint32_t shadowing = 0;  // clusters
    for (std::size_t i = 0; i < stagesOf(ssvp); ++i) {
        const KMeansOptions options = clusterOptions(ssvp, i);
        clusterCounts.push_back(options.clusters ? options.clusters : counts[i]);
        total += KMeans::estimateBytes(options, counts[i]);
        if (i < shadowedOf(ssvp)) shadowing += clusterCounts[i];
        if (i + 1 >= ssvp.bounces) break;
        counts.push_back(clusterCounts[i] * ssvp.secondVpls);
        total += SecondBounce::estimateBytes(nextOptions(ssvp, i), clusterCounts[i]);
    }
    if (ssvp.autoError > 0.0f)
        total += SsvpPlan::estimateBytes(planOptions(ssvp), shape.texels ? shape.rows : 0);
    if (ssvp.visibility == LW_VISIBILITY_VOXEL) total += VoxelShadows::estimateBytes(ssvp.voxels, shadowing, OccluderMaps::voxelSurfels(occluderOptions(ssvp), shape), shape);
    if (ssvp.compensation > 0) total += BoundingCompensation::estimateBytes(compensationOptions(ssvp));
    const bool repairs = ssvp.autoResolution > 0.0f;
    const std::size_t shadowedLists = std::max<std::size_t>(shadowedOf(ssvp), 1);
    if (repairs) total += ClusteredGather::estimateBytes(counts, shadowedLists, 1);
    return total + RsmInput::estimateBytes(shape) +
           VplSampling::estimateBytes(samplingOptions(ssvp), shape) +
           OccluderMaps::estimateBytes(occluderOptions(ssvp), clusterCounts, shape) +
           ClusteredGather::estimateBytes(counts, shadowedLists, ssvp.interleave) +
           InterleavedView::estimateBytes(interleavedOptions(ssvp), view, shape.uploads,
                                          ClusteredGather::orderOf(counts, ssvp.interleave),
                                          repairs ? ClusteredGather::orderOf(counts, 1) : lw_subset_order{});
}

}  // namespace lightwell
