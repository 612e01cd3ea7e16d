#include "techniques/clustered_points.h"

#include "compute/device.h"

namespace lightwell {

ClusterVisibility visibilityOf(LWVisibility visibility) {
    switch (visibility) {
        case LW_VISIBILITY_NONE:
            return ClusterVisibility::none;
        case LW_VISIBILITY_SOFT:
            return ClusterVisibility::soft;
        case LW_VISIBILITY_STRICT:
        case LW_VISIBILITY_CAREFUL:  // what else it asks, the lists say
            return ClusterVisibility::strict;
        case LW_VISIBILITY_VOXEL:
            return ClusterVisibility::voxel;
        default:
            return ClusterVisibility::hard;
    }
}

ClusteredPoints::ClusteredPoints(Device& device, ClusterVisibility visibility)
    : device_(device), light_(device), cull_(device, 1), gather_(device, 1, 1, visibility), harmonics_(device, visibility) {}

void ClusteredPoints::startFrame(bool isLightKept) {
    light_.startFrame();
    if (!isLightKept) isOrdered_ = false;
}

void ClusteredPoints::render(Executor& executor, const Points& points, const std::vector<GatheredList>& lists, const ClusterMaps& maps) {
    checkPoints(device_, points);
    // The view's list is dealt out to subsets of pixels: walked whole, each cluster would be looked up once for every subset.
    if (!isOrdered_) gather_.recordOrder(executor, lists);
    isOrdered_ = true;
    maps_ = &maps;
    light_.render(executor, points, *this);
}

void ClusteredPoints::recordIrradiance(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                                  const Planes&, const Buffer& counts) {
    if (!irradiance) return;
    tiles_.reserve(device_, position.width, position.height, gather_.order(), 1);
    cull_.recordCull(executor, position, normal, gather_.vpls(), gather_.order(), tiles_);
    gather_.recordGather(executor, position, normal, tiles_.masks(),
                         VplTiles::layout(position.width, position.height, gather_.order(), 1), *maps_, irradiance, counts);
}

void ClusteredPoints::recordHarmonics(Executor& executor, const Planes& position, const Planes& normal, const Harmonics& harmonics,
                                 const Planes&, const Buffer& counts) {
    if (harmonics) harmonics_.record(executor, position, normal, gather_, *maps_, harmonics, counts);
}

}  // namespace lightwell
