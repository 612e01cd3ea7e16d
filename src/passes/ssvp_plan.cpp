#include "passes/ssvp_plan.h"

#include <cmath>

#include "compute/device.h"
#include "compute/error.h"
#include "passes/vpl_list.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "ssvp_plan/ssvp_plan";
constexpr Range kGroup{64, 1};
constexpr std::uint64_t kPlanBytes = LW_PLAN_WORDS * sizeof(cl_int),
                        kDeadBytes = LW_DEAD_WORDS * sizeof(cl_uint);

// VPLs, clusters and bounces err independently of each other: a third of the squared error each.
float shareOf(float error) {
    return error / std::sqrt(3.0f);
}

// Of the light, an error of `share` takes clusters whose members lie within so much of their middle
// (k-means' distance, root mean square): docs/techniques/ssvp.md, "No more than the scene needs", has
// the measurements.
constexpr float kSpreadOfError = 0.7f;
float spreadOf(float error) {
    const float spread = kSpreadOfError * shareOf(error);
    return spread * spread;
}

// By LW_WHY_*.
constexpr const char* kVplReasons[] = {"the most: a first frame",
                                       "the most: the error target would take as many or more",
                                       "fewer than the most: they meet the error target",
                                       "fewer than the most: so few texels carry the light",
                                       "the most: only VPLs drawn by flux are chosen"};
constexpr const char* kClusterReasons[] = {
    "the most: a first frame", "the most: the error target would take as many or more",
    "fewer than the most: their spread is within the error target",
    "fewer than the most: so few places are lit",
    "the most: chosen only with warm_start and a number of clusters"};
constexpr const char* kBounceReasons[] = {
    "the most: a first frame", "the most: the last adds more than the error target",
    "fewer than the most: the next would add less than the error target", "", ""};

}  // namespace

SsvpPlan::SsvpPlan(Device& device, const SsvpPlanOptions& options)
    : device_(device),
      options_(options),
      rows_(device.programs().kernel(kProgram, "ssvp_plan_rows")),
      vpls_(device.programs().kernel(kProgram, "ssvp_plan_vpls")),
      clusters_(device.programs().kernel(kProgram, "ssvp_plan_clusters")),
      bounce_(device.programs().kernel(kProgram, "ssvp_plan_bounce")),
      plan_(device, std::size_t(kPlanBytes), "plan of the frame"),
      stages_(options.plansClusters ? options.stages : 0) {
    if (!(options.error > 0.0f && std::isfinite(options.error)))
        fail(LW_ERROR_INVALID_ARGUMENT, "error: expected more than 0, got ", options.error);
    for (Stage& stage : stages_) {
        stage.dead.reserve(device, std::size_t(kDeadBytes), "clusters not used");
        stage.clusters.reserve(device, options.clusters * sizeof(lw_cluster), "starts of clusters");
    }
}

void SsvpPlan::begin(Executor& executor, bool restart) {
    restart_ = restart || !isBegun_;
    isBegun_ = true;
    if (restart_) {
        hasTexels_ = false;
        executor.fill("ssvp_plan.begin", plan_, 1, 0, std::size_t(kPlanBytes));  // every bounce is used
    }
    for (Stage& stage : stages_) stage.isKnown = stage.isKnown && !restart_;
    if (kept_.moves(executor))
        for (const Stage& stage : stages_)
            if (stage.isKnown) moveClusters(executor, stage.clusters, options_.clusters, kept_);
    kept_.arrive(executor);
}

void SsvpPlan::recordVpls(Executor& executor, const RsmInput& rsms, const Buffer& texelSums,
                          const Buffer& rowTotals) {
    const cl_int rowCount = cl_int(rsms.rowCount);
    rowSquares_.reserve(device_, std::size_t(rsms.rowCount) * sizeof(cl_float),
                        "squared flux of RSM rows");
    executor.run("ssvp_plan.vpls", rows_, gridOver(rsms.rowCount), {4, 1}, texelSums, rsms.rows,
                 rowCount, rowTotals, rowSquares_);
    executor.run("ssvp_plan.vpls", vpls_, {1, 1}, {1, 1}, rowTotals, rowSquares_, rowCount,
                 cl_int(options_.vpls), shareOf(options_.error), cl_int(hasTexels_ ? 0 : 1), plan_);
    hasTexels_ = true;
}

void SsvpPlan::recordClusters(Executor& executor, std::size_t stage, const KMeans& clusters) {
    if (stage >= stages_.size()) return;
    Stage& own = stages_[stage];
    executor.run("ssvp_plan.clusters", clusters_, kGroup, kGroup, clusters.clusters(),
                 cl_int(clusters.clusterCount()), clusters.frame(), clusters.weights(),
                 spreadOf(options_.error), cl_int(own.isKnown ? 0 : 1), cl_int(stage == 0 ? 1 : 0),
                 own.dead, own.clusters, plan_);
    own.isKnown = true;
}

const ClusterSeeds* SsvpPlan::seeds(std::size_t stage) const {
    return stage < stages_.size() && stages_[stage].isKnown ? &stages_[stage].seeds : nullptr;
}

void SsvpPlan::recordBounce(Executor& executor, std::size_t stage, const KMeans& clusters,
                            const SecondBounce& next) {
    executor.run("ssvp_plan.bounce", bounce_, kGroup, kGroup, clusters.clusters(),
                 cl_int(next.perCluster()), next.vpls(), cl_int(next.vplCount()), cl_int(stage),
                 cl_int(options_.bounces - stage - 1), shareOf(options_.error), cl_int(restart_ ? 1 : 0),
                 plan_);
}

void SsvpPlan::report(Report& report) const {
    if (!isBegun_) return;
    const auto read = [&](const char* name, int count, int why, const char* const* reasons) {
        report.read(device_, name, plan_, std::size_t(count) * sizeof(cl_int));
        report.readChoice(device_, name, plan_, std::size_t(why) * sizeof(cl_int), reasons,
                          LW_WHY_FIXED + 1);
    };
    if (options_.plansVpls && hasTexels_) read("vpls_used", LW_PLAN_VPLS, LW_PLAN_WHY_VPLS, kVplReasons);
    if (!options_.plansVpls) report.choose("vpls_used", kVplReasons[LW_WHY_FIXED]);
    if (stages_.empty())
        report.choose("clusters_used", kClusterReasons[LW_WHY_FIXED]);
    else
        read("clusters_used", LW_PLAN_CLUSTERS, LW_PLAN_WHY_CLUSTERS, kClusterReasons);
    if (options_.bounces > 1) read("bounces_used", LW_PLAN_BOUNCES, LW_PLAN_WHY_BOUNCES, kBounceReasons);
}

std::uint64_t SsvpPlan::bytes() const {
    std::uint64_t total = plan_.bytes() + rowSquares_.bytes();
    for (const Stage& stage : stages_) total += stage.dead.bytes() + stage.clusters.bytes();
    return total;
}

std::uint64_t SsvpPlan::estimateBytes(const SsvpPlanOptions& options, std::uint64_t rows) {
    const std::uint64_t stages = options.plansClusters ? options.stages : 0;
    return kPlanBytes + (options.plansVpls ? rows * sizeof(cl_float) : 0) +
           stages * (kDeadBytes + options.clusters * sizeof(lw_cluster));
}

}  // namespace lightwell
