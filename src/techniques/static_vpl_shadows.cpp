#include "techniques/static_vpl_shadows.h"

#include <algorithm>

#include "compute/device.h"
#include "shared/vpl_types.h"

namespace lightwell {
namespace {

// Of which a pixel takes one, as ssvp's cluster_groups: look-ups fall in proportion.
constexpr std::uint32_t kGroups = 4;

KMeansOptions clusterOptions(std::uint32_t clusters) {
    KMeansOptions options;
    options.clusters = clusters;
    return options;
}

bool isThroughVoxels(const LWStaticVplDesc& desc) {
    return desc.visibility == LW_VISIBILITY_VOXEL;
}

OccluderOptions occluderOptions(const LWStaticVplDesc& desc) {
    OccluderOptions options;
    options.occluders = desc.occluders;
    options.mapSize = desc.mapSize;
    options.isStrict = desc.visibility == LW_VISIBILITY_STRICT;
    options.throughVoxels = isThroughVoxels(desc);
    options.drawn = options.throughVoxels ? 0 : 1;
    options.takesScreen = false;  // neither RSMs nor views are asked for
    return options;
}

std::uint32_t groupsOf(const LWStaticVplDesc& desc) {
    return std::min(kGroups, desc.interleave * desc.interleave);
}

// VPLs that are shadowed, of so many; the others follow them.
std::uint32_t shadowedOf(const LWStaticVplDesc& desc, std::uint32_t count, std::uint32_t opposite) {
    return desc.shadowedBounces > 1 ? count : count - opposite;
}

bool sharesOf(const LWStaticVplDesc& desc, std::uint32_t shadowed) {
    return desc.clusters > 0 && shadowed > desc.clusters;
}

std::vector<std::uint32_t> countsOf(std::uint32_t count, std::uint32_t shadowed) {
    std::vector<std::uint32_t> counts{shadowed};
    if (count > shadowed) counts.push_back(count - shadowed);
    return counts;
}

ClusteredGather gatherOf(Device& device, const LWStaticVplDesc& desc) {
    return ClusteredGather(device, desc.interleave, groupsOf(desc), visibilityOf(desc.visibility));
}

}  // namespace

StaticVplShadows::StaticVplShadows(Device& device, const LWStaticVplDesc& desc)
    : device_(device),
      desc_(desc),
      maps_(device, occluderOptions(desc), 1),
      own_(device, clusterOptions(0)),
      shared_(device, clusterOptions(std::max(desc.clusters, 1u))),
      gathers_{gatherOf(device, desc), gatherOf(device, desc)} {
    if (isThroughVoxels(desc)) voxels_.emplace(device, desc.voxels);
}

void StaticVplShadows::check(const LWFrame& frame) {
    maps_.check(frame);
    if (voxels_) voxels_->check(frame);
}

// VPLs behind the shadowed ones, as a list that nothing shadows.
std::vector<GatheredList> StaticVplShadows::recordRest(Executor& executor, int list, const Buffer& vpls,
                                                       std::uint32_t rest) {
    Buffer& own = rests_[std::size_t(list)];
    std::vector<GatheredList> lists{
        {{vpls, shadowed_}, &clusters().assignment(), clusters().clusterCount()}};
    if (rest == 0) return lists;
    own.reserve(device_, rest * sizeof(lw_vpl), "VPLs without shadows");
    executor.copy("light_list.rest", vpls.get(), own.get(), shadowed_ * sizeof(lw_vpl), 0,
                  rest * sizeof(lw_vpl));
    lists.push_back({{own, rest}});
    return lists;
}

void StaticVplShadows::recordVoxels(Executor& executor, const LWFrame& frame, bool restart) {
    const VoxelSurfaces surfaces = maps_.surfaces();
    // The grid is fitted to the triangles; where surfaces are surfels, which the device alone may know,
    // to the places.
    std::vector<LWVpl> places(surfaces.triangles ? 0 : frame.staticVplCount);
    for (std::size_t i = 0; i < places.size(); ++i) {
        std::copy_n(frame.staticVpls[i].position, 3, places[i].position);
        places[i].flux[0] = 1.0f;  // some
    }
    LWFrame own = frame;  // of which other lights are none of this technique's
    own.vpls = places.data();
    own.vplCount = std::uint32_t(places.size());
    voxels_->recordVoxels(executor, own, noRsms_, surfaces, restart);
    voxels_->recordSights(executor, {{clusters().clusters(), clusters().clusterCount()}});
}

void StaticVplShadows::update(Executor& executor, const LWFrame& frame, LightList& list,
                              std::uint32_t opposite, bool restart, bool lost) {
    if (lost) maps_.forget();
    maps_.import(executor, frame, noRsms_);
    const std::uint32_t count = std::uint32_t(list.order().count);
    shadowed_ = shadowedOf(desc_, count, opposite);
    const bool shared = shares_;
    shares_ = sharesOf(desc_, shadowed_);
    sites_.reserve(device_, std::max(shadowed_, 1u) * sizeof(lw_vpl), "places that VPLs look from");
    list.recordSites(executor, shadowed_, desc_.lift, sites_);
    KMeans& clusters = this->clusters();
    clusters.record(executor, sites_, shadowed_, restart || shares_ != shared);
    maps_.record(executor, 0, clusters.clusters(), clusters.clusterCount());
    if (voxels_) recordVoxels(executor, frame, restart);
    for (int i = 0; i < int(list.lists()); ++i) {
        lists_[std::size_t(i)] =
            recordRest(executor, i, i ? list.baked() : list.vpls(), count - shadowed_);
        gathers_[std::size_t(i)].recordOrder(executor, lists_[std::size_t(i)]);
    }
    for (auto& points : points_)
        if (points) points->startFrame();
}

ClusterMaps StaticVplShadows::mapsRead(const VoxelSights* sights) const {
    const ParaboloidMap& maps = maps_.maps(0);
    return {{{&maps.frames(), &maps.records(), clusters().clusterCount()}}, maps.size(), sights};
}

void StaticVplShadows::recordGather(Executor& executor, int list, const Planes& position,
                                    const Planes& normal, const Buffer& masks, const Planes& irradiance,
                                    const Buffer& counts) {
    const std::optional<VoxelSights> sights = voxels_ ? std::optional(voxels_->sights()) : std::nullopt;
    ClusteredGather& gather = gathers_[std::size_t(list)];
    gather.recordGather(
        executor, position, normal, masks,
        VplTiles::layout(position.width, position.height, gather.order(), desc_.interleave),
        mapsRead(sights ? &*sights : nullptr), irradiance, counts);
}

void StaticVplShadows::renderPoints(Executor& executor, int list, const Points& points) {
    const std::optional<VoxelSights> sights = voxels_ ? std::optional(voxels_->sights()) : std::nullopt;
    auto& light = points_[std::size_t(list)];
    if (!light) light.emplace(device_, visibilityOf(desc_.visibility));
    light->render(executor, points, lists_[std::size_t(list)], mapsRead(sights ? &*sights : nullptr));
}

std::vector<LWChoice> StaticVplShadows::choices(const LWFrame& frame) const {
    std::vector<LWChoice> choices = maps_.choices(frame);
    choices.push_back(
        {"clusters", shares_
                         ? "more VPLs than clusters: those of a cluster share what its middle one sees"
                         : "every VPL sees for itself"});
    if (desc_.bounces > 1 && desc_.shadowedBounces == 1)
        choices.push_back({"shadowed_bounces", "VPLs opposite others are not shadowed"});
    return choices;
}

void StaticVplShadows::report(Report& report) const {
    maps_.report(report);
    if (voxels_) voxels_->report(report);
    report.counts.push_back({"clusters", clusters().clusterCount()});
    report.counts.push_back({"shadowed_vpls", shadowed_});
    for (const auto& points : points_)
        if (points) points->report(report);
}

void StaticVplShadows::addDebugViews(std::vector<DebugView>& views) {
    KMeans& clusters = this->clusters();
    ParaboloidMap& maps = maps_.maps(0);
    views.push_back({"clusters", clusters.debugDescription(), clusters.debugShape(),
                     [&clusters](Executor& executor, const Planes& planes) {
                         clusters.recordPlanes(executor, planes);
                     }});
    views.push_back({"maps", "maps one below the other: distance (m), world normal xyz, albedo rgb",
                     maps.debugShape(), [&maps](Executor& executor, const Planes& planes) {
                         maps.recordPlanes(executor, planes);
                     }});
}

std::uint64_t StaticVplShadows::bytes() const {
    std::uint64_t total = maps_.bytes() + own_.bytes() + shared_.bytes() + sites_.bytes() +
                          (voxels_ ? voxels_->bytes() : 0);
    for (std::size_t i = 0; i < 2; ++i)
        total += rests_[i].bytes() + gathers_[i].bytes() + (points_[i] ? points_[i]->bytes() : 0);
    return total;
}

lw_subset_order StaticVplShadows::orderOf(const LWStaticVplDesc& desc, std::uint32_t count,
                                          std::uint32_t opposite) {
    return ClusteredGather::orderOf(countsOf(count, shadowedOf(desc, count, opposite)), desc.interleave);
}

std::uint64_t StaticVplShadows::estimateBytes(const LWStaticVplDesc& desc, std::uint32_t others,
                                              std::uint32_t opposite, const FrameShape& shape) {
    const std::uint32_t count = shape.staticVplCount + others,
                        shadowed = shadowedOf(desc, count, opposite),
                        lists = shape.bakedReceivers ? 2 : 1;
    const bool shares = sharesOf(desc, shadowed);
    const KMeansOptions options = clusterOptions(shares ? desc.clusters : 0);
    const std::uint32_t clusters = shares ? desc.clusters : shadowed;
    const OccluderOptions occluders = occluderOptions(desc);
    const std::uint64_t eachList =
        ClusteredGather::estimateBytes(countsOf(count, shadowed), 1, desc.interleave) +
        (count - shadowed) * sizeof(lw_vpl);
    const std::uint64_t surfels = OccluderMaps::voxelSurfels(occluders, shape);
    FrameShape fitted = shape;
    fitted.vplCount = surfels ? shape.staticVplCount : 0;
    const std::uint64_t voxels =
        isThroughVoxels(desc) ? VoxelShadows::estimateBytes(desc.voxels, clusters, surfels, fitted) : 0;
    return OccluderMaps::estimateBytes(occluders, {clusters}, shape) +
           KMeans::estimateBytes(options, shadowed) + std::max(shadowed, 1u) * sizeof(lw_vpl) +
           lists * eachList + voxels;
}

}  // namespace lightwell
