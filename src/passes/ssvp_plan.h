// How many VPLs, clusters and bounces a frame of technique ssvp needs for an error target. Chosen on the
// device and read there: the host neither waits for a count nor learns it before the stats.
#pragma once

#include <cstdint>
#include <deque>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/report.h"
#include "inputs/rsm_input.h"
#include "passes/kmeans.h"
#include "passes/second_bounce.h"
#include "passes/vpl_sampling.h"
#include "shared/ssvp_plan_types.h"

namespace lightwell {

struct SsvpPlanOptions {
    float error = 0.1f;                                   // relative, of the picture: above 0
    std::uint32_t vpls = 256, clusters = 8, bounces = 2;  // the most
    bool plansVpls = true;      // false: the most; only a set drawn by flux knows the light
    bool plansClusters = true;  // false: the most
    std::size_t stages = 1;     // lists that are clustered
};

class SsvpPlan {
public:
    SsvpPlan(Device& device, const SsvpPlanOptions& options);

    // Begins a frame; `restart`: the first after a cut, which takes the most of everything.
    void begin(Executor& executor, bool restart);
    // Pass "ssvp_plan.vpls": how many VPLs to draw, of the texels that are cumulated so far.
    void recordVpls(Executor& executor, const RsmInput& rsms, const Buffer& texelSums,
                    const Buffer& rowTotals);
    bool plansVpls() const { return options_.plansVpls; }
    const Buffer& live() const { return plan_; }  // int: that number
    // Pass "ssvp_plan.clusters", after the k-means of a stage: which clusters that will use in the next
    // frame.
    void recordClusters(Executor& executor, std::size_t stage, const KMeans& clusters);
    // What the k-means of a stage starts with; none where the most are used.
    const ClusterSeeds* seeds(std::size_t stage) const;
    // Pass "ssvp_plan.bounce": whether bounce `stage` + 2, drawn from the clusters of `stage`, is used;
    // if not, its VPLs lose their flux.
    void recordBounce(Executor& executor, std::size_t stage, const KMeans& clusters,
                      const SecondBounce& next);

    // Counts and choices "vpls_used", "clusters_used", "bounces_used".
    void report(Report& report) const;
    std::uint64_t bytes() const;
    // rows: of all RSMs.
    static std::uint64_t estimateBytes(const SsvpPlanOptions& options, std::uint64_t rows);

private:
    struct Stage {
        Buffer dead, clusters;
        ClusterSeeds seeds{clusters, dead};
        bool isKnown = false;  // of the frame before
    };

    Device& device_;
    SsvpPlanOptions options_;
    Kernel &rows_, &vpls_, &clusters_, &bounce_;
    Buffer plan_, rowSquares_;
    std::deque<Stage> stages_;
    bool restart_ = true, hasTexels_ = false, isBegun_ = false;
    KeptPlaces kept_;
};

}  // namespace lightwell
