// Light of clustered VPLs at points: of all bounces' at each, with their clusters' visibility, without interleaving, filter,
// compensation or history.
#pragma once

#include <vector>

#include "passes/clustered_gather.h"
#include "passes/interleaved_gather.h"
#include "techniques/point_light.h"

namespace lightwell {

// What stands between clusters and what they light, as the API names it.
ClusterVisibility visibilityOf(LWVisibility visibility);

class ClusteredPoints final : private PointGather {
public:
    ClusteredPoints(Device& device, ClusterVisibility visibility);

    void startFrame(bool isLightKept = false);
    // The bounces of the last update, and their maps.
    void render(Executor& executor, const Points& points, const std::vector<GatheredList>& lists, const ClusterMaps& maps);

    void report(Report& report) const { light_.report(device_, report, {2, {}}); }
    std::uint64_t bytes() const { return light_.bytes() + gather_.bytes() + tiles_.bytes(); }

private:
    void recordIrradiance(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                          const Planes& validity, const Buffer& counts) override;
    void recordHarmonics(Executor& executor, const Planes& position, const Planes& normal, const Harmonics& harmonics,
                         const Planes& validity, const Buffer& counts) override;

    Device& device_;
    PointLight light_;
    InterleavedGather cull_;
    ClusteredGather gather_;
    ClusteredHarmonics harmonics_;
    VplTiles tiles_;
    const ClusterMaps* maps_ = nullptr;  // of the call
    bool isOrdered_ = false;             // since the last update
};

}  // namespace lightwell
