// What visibility by clusters of VPLs gets wrong: every pair of pixel and VPL against a ray between the
// two.
//
// A pair counts where the VPL would light the pixel with nothing between (vplIrradiance above 0). Light
// that a ray does not let through is *false light*, what is kept from a pixel that a ray reaches *false
// shadow*. Clusters and maps are told apart by rays from the clusters' medoids: what those misjudge is
// the price of one look for many VPLs, what the map judges otherwise than those is the map's own error.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gbuffer.h"
#include "image.h"
#include "path_tracer.h"
#include "reference_run.h"

namespace studio {

struct ClusteredVpl {
    VplRecord vpl;
    int cluster = 0;
};

// Where a cluster looks from: its medoid, a member, or the mean of all, with their unit normals.
struct ClusterPlace {
    glm::vec3 medoid{0.0f}, medoidNormal{0.0f}, mean{0.0f}, meanNormal{0.0f};
};

// Ways to tell what a pixel sees: everything; as the technique judges; by a ray to the cluster's medoid,
// to its mean, to the VPL itself.
enum class Sight { none, map, medoid, mean, exact };
constexpr int kSightCount = 5;
constexpr std::array<const char*, kSightCount> kSightNames{"none", "map", "medoid", "mean", "exact"};

// Shares of all pairs, and of their light when nothing is between. Half a pair is misjudged where a soft
// map says half.
struct Misjudged {
    double falseLight = 0.0, falseShadow = 0.0;
    double falseLightWeight = 0.0, falseShadowWeight = 0.0;
};

struct VisibilityVerdict {
    std::uint64_t pairs = 0;
    double lit = 0.0, litWeight = 0.0;           // by rays between the two
    std::array<Misjudged, kSightCount> against;  // each way against these rays
    Misjudged mapAgainstMedoid;                  // the map against rays to the medoid
    std::array<Image, kSightCount> irradiance;   // R, G, B (W/m^2) of all VPLs, by each way
    Image pictures;  // <way>.light, <way>.shadow: misjudged light of each pixel, W/m^2, mean of the
                     // channels
};

class VisibilityJudge {
public:
    // `scene` must live as long. The pixels' surfaces are found by tracing the camera's rays again.
    VisibilityJudge(const RayScene& scene, const GBuffer& pixels);

    // `seen`: the technique's judgement in [0,1], clusters one after the other, each a row-major
    // picture. Rays between pixels and VPLs are traced once for calls with the same VPLs. Throws
    // std::runtime_error where sizes, clusters or values don't fit.
    VisibilityVerdict judge(const std::vector<ClusteredVpl>& vpls,
                            const std::vector<ClusterPlace>& clusters, const std::vector<float>& seen);

private:
    struct Tally;

    void check(const std::vector<ClusteredVpl>& vpls, const std::vector<ClusterPlace>& clusters,
               const std::vector<float>& seen) const;
    void traceExact(const std::vector<ClusteredVpl>& vpls);
    bool isVisible(std::size_t pixel, std::size_t vpl) const;
    Tally judgePixel(std::size_t pixel, const std::vector<ClusteredVpl>& vpls,
                     const std::vector<ClusterPlace>& clusters, const std::vector<float>& seen) const;
    VisibilityVerdict sum(const std::vector<Tally>& tallies) const;

    const RayScene& scene_;
    int width_, height_;
    PixelSurfaces pixels_;
    std::vector<VplRecord> traced_;     // the VPLs that `exact_` is of
    std::vector<std::uint64_t> exact_;  // a bit each, words_ words to a pixel
    std::size_t words_ = 0;
};

}  // namespace studio
