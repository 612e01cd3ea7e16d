// Frame part, report and registration; the table of parameters is ssvp_parameters.cpp's. Some lines over 300: `update` and `render` and
// what they record are one algorithm, which is to be read in one place.
#include "techniques/ssvp.h"

#include <algorithm>
#include <deque>
#include <optional>
#include <vector>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/rsm_input.h"
#include "passes/clustered_gather.h"
#include "passes/kmeans.h"
#include "passes/second_bounce.h"
#include "passes/ssvp_plan.h"
#include "passes/vpl_sampling.h"
#include "techniques/clustered_points.h"
#include "techniques/interleaved_view.h"
#include "techniques/occluder_maps.h"
#include "techniques/prewarm.h"
#include "techniques/ssvp_options.h"
#include "techniques/ssvp_parameters.h"
#include "techniques/still_frames.h"
#include "techniques/technique_entry.h"

namespace lightwell {
namespace {

// A bounce whose VPLs have clusters, and the VPLs of the next one.
struct Stage {
    Stage(Device& device, const LWSsvpDesc& desc, std::size_t index)
        : clusters(device, clusterOptions(desc, index)), next(device, nextOptions(desc, index)) {}
    KMeans clusters;
    SecondBounce next;
};

// What the host gave and this technique does not read, or lacks: said in the stats.
std::vector<LWChoice> inputChoices(const OccluderMaps& maps, const LWSsvpDesc& desc, const LWFrame& frame) {
    constexpr const char* kReason = "not used: technique ssvp takes light from RSMs and authored VPLs only";
    std::vector<LWChoice> choices = maps.choices(frame);
    if (frame.sourceViewCount && !maps.usesViews() && desc.sampling != LW_SAMPLING_VIEW)
        choices.push_back({"frame.sourceViews", "not used: they are no occluders, and technique ssvp takes light from RSMs and "
                                                "authored VPLs only"});
    if (frame.blockerCount) choices.push_back({"frame.blockers", kReason});
    if (frame.environment[0] > 0.0f || frame.environment[1] > 0.0f || frame.environment[2] > 0.0f)
        choices.push_back({"frame.environment", kReason});
    if (std::any_of(frame.lights, frame.lights + frame.lightCount, [](const LWLight& light) { return light.rsmCount == 0; }))
        choices.push_back({"frame.lights", "some have no RSM: technique ssvp makes no indirect light of those"});
    if (desc.visibility == LW_VISIBILITY_CAREFUL && !bearsOut(desc))
        choices.push_back({"ssvp.visibility", "as strict: careful is for bounces without shadows after two or more with"});
    if (groupsOf(desc) < desc.clusterGroups)
        choices.push_back({"ssvp.clusterGroups", "as many as the interleave's window has pixels, which are fewer"});
    return choices;
}

class SsvpTechnique final : public Technique {
public:
    SsvpTechnique(Device& device, const LWSsvpDesc& desc)
        : device_(device),
          desc_(desc),
          sampling_(device, samplingOptions(desc)),
          maps_(device, occluderOptions(desc), stagesOf(desc)),
          passes_(device, desc.interleave, interleavedOptions(desc).doubtful),
          gather_(device, desc.interleave, groupsOf(desc), visibilityOf(desc.visibility)) {
        for (std::size_t i = 0; i < stagesOf(desc); ++i) stages_.emplace_back(device, desc, i);
        if (repairs() && desc.compensation > 0)
            fail(LW_ERROR_INVALID_ARGUMENT, "desc.autoResolution: expected 0 with desc.compensation above 0, got ", desc.autoResolution);
        if (desc.sampling == LW_SAMPLING_VIEW && desc.compensation > 0)
            fail(LW_ERROR_INVALID_ARGUMENT, "desc.compensation: expected 0 with desc.sampling LW_SAMPLING_VIEW, of whose VPLs it knows no "
                 "size, got ", desc.compensation);
        if (interleavedOptions(desc).halvings) bilateral_.emplace(device, 3, repairs());
        if (repairs()) {
            repair_.emplace(device);
            cullAll_.emplace(device, 1);
            gatherAll_.emplace(device, 1, 1, visibilityOf(desc.visibility));
        }
        if (desc.history) history_.emplace(device, interleavedOptions(desc).history);
        if (desc.autoError > 0.0f) plan_.emplace(device, planOptions(desc));
        if (desc.visibility == LW_VISIBILITY_VOXEL) shadows_.emplace(device, desc.voxels);
        if (desc.compensation > 0) compensation_.emplace(device, compensationOptions(desc));
    }

    void update(Executor& executor, const LWFrame& frame) override {
        sampling_.check(frame);
        maps_.check(frame);
        if (shadows_) shadows_->check(frame);
        rsms_.import(executor, frame);
        // Of an earlier frame may be lost what it should have left of geometry, maps and clusters.
        const bool lost = continuity_.beginLost(), restart = lost || frame.reset != 0;
        if (lost) maps_.forget();
        maps_.import(executor, frame, rsms_);
        const bool wasKept = isKept_;
        isKept_ = still_.note(lightGeneration(frame), maps_.generation(), restart);
        if (!isKept_) recordLight(executor, frame, restart);
        else if (!wasKept) maps_.recordKept(executor);

        choices_ = inputChoices(maps_, desc_, frame);
        if (isKept_) choices_.push_back({"ssvp.vpls", "kept with their clusters and maps: by the host's versions light and geometry stand still"});
        states_.purge();
        states_.each([&](InterleavedView& state) { state.startFrame(restart); });
        if (points_) points_->startFrame(isKept_);
    }

    void render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer,
                const LWOutput& output) override {
        checkLightOutputs(device_, *view, output, "ssvp");
        InterleavedView& state = states_.get(
            view, [&] { return std::make_unique<InterleavedView>(device_, interleavedOptions(desc_), *view); });
        const std::optional<VoxelSights> sights = sightsRead();
        const ClusterMaps maps = mapsRead(sights);
        state.render(executor, *view, gbuffer, output, {passes_, bilateral_ ? &*bilateral_ : nullptr, history(), repair_ ? &*repair_ : nullptr},
                     [&](const Planes& position, const Planes& normal, const Planes& irradiance) {
                         const Buffer& masks = state.cull(executor, passes_, position, normal, gather_.vpls(), gather_.order());
                         const lw_vpl_tiles tiles =
                             VplTiles::layout(position.width, position.height, gather_.order(), desc_.interleave);
                         gather_.recordGather(executor, position, normal, masks, tiles, maps, irradiance, state.counts());
                         if (compensation_)
                             state.compensate(executor, *compensation_, gbuffer.camera, irradiance);
                     },
                     [&](const Planes& position, const Planes& normal, const Planes& irradiance) {
                         const lw_subset_order order = gatherAll_->order();
                         const Buffer& masks = state.cullAll(executor, *cullAll_, position, normal, gatherAll_->vpls(), order);
                         gatherAll_->recordGather(executor, position, normal, masks, VplTiles::layout(position.width, position.height, order, 1),
                                                  maps, irradiance, state.repairCounts());
                     });
    }

    void renderPoints(Executor& executor, const Points& points) override {
        checkPoints(device_, points);
        if (!points_) points_.emplace(device_, visibilityOf(desc_.visibility));
        const std::optional<VoxelSights> sights = sightsRead();
        points_->render(executor, points, lists_, mapsRead(sights));
    }

    void lose() override { continuity_.lose(); }

    void prewarm(Executor& executor, const std::shared_ptr<View>&) override {
        // Twins, so that this technique's frame stays as it is; one for each source of maps that a frame may bring.
        for (const LWOccluders occluders : {LW_OCCLUDERS_TRIANGLES, LW_OCCLUDERS_SURFELS, LW_OCCLUDERS_SCREEN}) {
            if (desc_.occluders != LW_OCCLUDERS_AUTO && desc_.occluders != occluders) continue;
            LWSsvpDesc desc = desc_;
            desc.occluders = occluders;
            SsvpTechnique twin(device_, desc);
            exerciseTechnique(executor, twin);
            exercisePoints(executor, twin);
        }
    }

    Report report() override;
    std::vector<DebugView> debugViews(const View* view) override;
    std::uint64_t bytes() const override;

private:
    // VPLs of all bounces with their clusters and maps, and the order that they are gathered in.
    void recordLight(Executor& executor, const LWFrame& frame, bool restart) {
        if (plan_) plan_->begin(executor, restart);
        if (history_) sampling_.turn(restart ? turns_ = 0 : ++turns_);
        sampling_.importViews(executor, frame);
        recordVpls(executor, frame);
        if (compensation_)
            compensation_->recordScale(executor, sampling_.vpls(), sampling_.order(), sampling_.vplCount() - frame.vplCount);

        std::vector<GatheredList> lists{{{sampling_.vpls(), sampling_.vplCount()}}};
        for (std::size_t i = 0; i < stages_.size(); ++i) {
            KMeans& clusters = stages_[i].clusters;
            clusters.record(executor, lists[i].vpls.vpls, lists[i].vpls.count, restart,
                            plan_ ? plan_->seeds(i) : nullptr);
            if (plan_) plan_->recordClusters(executor, i, clusters);
            maps_.record(executor, i, clusters.clusters(), clusters.clusterCount());
            if (i < std::max<std::size_t>(shadowedOf(desc_), 1)) {
                lists[i].assignment = &clusters.assignment();
                lists[i].clusterCount = clusters.clusterCount();
            }
            // All stages, also in the dark: what is left of a lit frame would be shown, counted and warm the next clusters.
            if (i + 1 < desc_.bounces) lists.push_back({recordNext(executor, i)});
        }
        if (bearsOut(desc_))
            for (std::size_t i = shadowedOf(desc_); i < lists.size(); ++i) lists[i].isUnshadowed = true;
        if (shadows_) recordShadows(executor, frame, restart);
        gather_.recordOrder(executor, lists);
        if (gatherAll_) gatherAll_->recordOrder(executor, lists);
        lists_ = std::move(lists);
    }
    // Of all that recordLight() reads but geometry; 0: it changes from frame to frame, or the host does not tell.
    std::uint64_t lightGeneration(const LWFrame& frame) const {
        const bool isFramesOwn = plan_ || history_ || shadows_ || desc_.sampling == LW_SAMPLING_VIEW || frame.vplCount;
        return isFramesOwn ? 0 : rsms_.generation;
    }
    void recordVpls(Executor& executor, const LWFrame& frame) {
        if (!plan_ || !plan_->plansVpls())
            return sampling_.record(executor, rsms_, frame.vpls, frame.vplCount);
        const VplPlan plan{plan_->live(), [&](const Buffer& texelSums, const Buffer& rowTotals) {
                               plan_->recordVpls(executor, rsms_, texelSums, rowTotals);
                           }};
        sampling_.record(executor, rsms_, frame.vpls, frame.vplCount, &plan);
    }
    // The VPLs that the maps of a stage show lit.
    VplList recordNext(Executor& executor, std::size_t index) {
        Stage& stage = stages_[index];
        const ParaboloidMap& maps = maps_.maps(index);
        // A kernel's argument must be some memory, also where none is read.
        if (stage.clusters.clusterCount() == 0) return {sampling_.vpls(), 0};
        stage.next.reserve(stage.clusters.clusterCount());
        stage.next.record(executor, stage.clusters.clusters(), stage.clusters.clusterCount(), maps.frames(), maps.records(),
                          maps.albedo(), maps.size());
        if (plan_) plan_->recordBounce(executor, index, stage.clusters, stage.next);
        return {stage.next.vpls(), stage.next.vplCount()};
    }
    // What the clusters of all shadowed bounces see past voxels.
    void recordShadows(Executor& executor, const LWFrame& frame, bool restart) {
        shadows_->recordVoxels(executor, frame, rsms_, maps_.surfaces(), restart);
        std::vector<VoxelVisibility::Clusters> lists;
        for (std::size_t i = 0; i < shadowedOf(desc_); ++i)
            lists.push_back({stages_[i].clusters.clusters(), stages_[i].clusters.clusterCount()});
        shadows_->recordSights(executor, lists);
    }
    std::optional<VoxelSights> sightsRead() const {
        if (!shadows_) return std::nullopt;
        return shadows_->sights();
    }
    // Of what is shadowed.
    ClusterMaps mapsRead(const std::optional<VoxelSights>& sights) const {
        std::vector<ClusterMaps::List> lists;
        for (std::size_t i = 0; i < std::max<std::size_t>(shadowedOf(desc_), 1); ++i)
            lists.push_back({&maps_.maps(i).frames(), &maps_.maps(i).records(), stages_[i].clusters.clusterCount()});
        return {lists, maps_.maps(0).size(), sights ? &*sights : nullptr};
    }
    std::uint32_t shadowingClusters() const {
        std::uint32_t count = 0;
        for (std::size_t i = 0; i < std::max<std::size_t>(shadowedOf(desc_), 1); ++i) count += stages_[i].clusters.clusterCount();
        return count;
    }

    bool repairs() const { return desc_.autoResolution > 0.0f; }
    TemporalHistory* history() { return history_ ? &*history_ : nullptr; }

    Device& device_;
    LWSsvpDesc desc_;
    Continuity continuity_{device_};
    StillFrames still_{settlingOf(desc_)};
    bool isKept_ = false;         // of the last update: what the one before recorded
    std::uint32_t turns_ = 0;     // of the sample set, one a frame while there is a history
    RsmInput rsms_;
    VplSampling sampling_;
    std::optional<SsvpPlan> plan_;  // with an error target only
    std::deque<Stage> stages_;
    OccluderMaps maps_;
    std::vector<GatheredList> lists_;  // of each bounce
    InterleavedGather passes_;
    ClusteredGather gather_;
    std::optional<JointBilateral> bilateral_;  // reduced resolution only
    std::optional<PixelRepair> repair_;        // with desc.autoResolution only, as the next two
    std::optional<InterleavedGather> cullAll_;
    std::optional<ClusteredGather> gatherAll_;
    std::optional<TemporalHistory> history_;
    std::optional<VoxelShadows> shadows_;  // with visibility through voxels only
    std::optional<BoundingCompensation> compensation_;
    PerView<InterleavedView> states_;
    std::optional<ClusteredPoints> points_;  // from the first lwRenderPoints on
    std::vector<LWChoice> choices_;  // of the last update
};

Report SsvpTechnique::report() {
    Report report;
    rsms_.report(report);
    maps_.report(report);
    if (shadows_) shadows_->report(report);
    report.counts.push_back({"vpls", sampling_.vplCount()});
    report.counts.push_back({"clusters", stages_[0].clusters.clusterCount()});
    constexpr const char* kLater[] = {"second_vpls", "third_vpls", "fourth_vpls"};
    for (std::size_t i = 1; i < desc_.bounces || i < 2; ++i)
        report.counts.push_back({kLater[i - 1], i < lists_.size() ? lists_[i].vpls.count : 0});
    for (const LWChoice& choice : choices_) report.choose(choice.name, choice.reason);
    if (plan_) plan_->report(report);
    report.counts.push_back({"rejected_pixels", 0});
    report.counts.push_back({"upsample_fallbacks", 0});
    report.counts.push_back({"saturated_pixels", 0});
    if (repairs()) {
        report.counts.push_back({"repaired_pixels", 0});
        report.counts.push_back({"unrepaired_pixels", 0});
    }
    if (history_) report.counts.push_back({"history_new", 0});
    if (compensation_) report.counts.push_back({"compensation_capped", 0});
    states_.each([&](const InterleavedView& state) { state.report(device_, report, gather_.order()); });
    if (points_) points_->report(report);
    return report;
}

std::vector<DebugView> SsvpTechnique::debugViews(const View* view) {
    std::vector<DebugView> views;
    if (gather_.vpls()) {
        views.push_back({"vpls", "one column per slot, of all bounces: position xyz (m), unit normal xyz, flux rgb (W), area (m^2)",
                         VplSampling::debugShape(gather_.order()),
                         [this](Executor& executor, const Planes& planes) {
                             sampling_.recordPlanes(executor, gather_.vpls(), planes);
                         }});
        constexpr const char* kClusters[] = {"clusters", "second_clusters", "third_clusters", "fourth_clusters"};
        constexpr const char* kMaps[] = {"maps", "second_maps", "third_maps", "fourth_maps"};
        for (std::size_t i = 0; i < stages_.size(); ++i) {
            KMeans& clusters = stages_[i].clusters;
            ParaboloidMap& maps = maps_.maps(i);
            views.push_back({kClusters[i], clusters.debugDescription(), clusters.debugShape(),
                             [&clusters](Executor& executor, const Planes& planes) { clusters.recordPlanes(executor, planes); }});
            views.push_back({kMaps[i], "maps one below the other: distance (m), world normal xyz, albedo rgb", maps.debugShape(),
                             [&maps](Executor& executor, const Planes& planes) { maps.recordPlanes(executor, planes); }});
        }
        views.push_back({"vpl_clusters",
                         "one column per slot as in vpls: the VPL's cluster, -1 for none, -2 for one of a bounce without shadows with visibility careful",
                         gather_.clustersShape(),
                         [this](Executor& executor, const Planes& planes) { gather_.recordClusters(executor, planes); }});
    }
    const InterleavedView* state = states_.find(view);
    if (!state) return views;
    state->addDebugViews(views, history(), repair_ ? &*repair_ : nullptr);
    if (compensation_) state->addCompensationView(*compensation_, views);
    if (const Planes position = state->position())
        views.push_back({"visibility", "clusters one below the other: the share of its light that each pixel is taken to see, beyond doubt",
                         ClusteredGather::visibilityShape(position, shadowingClusters()),
                         [this, position, normal = state->normal()](Executor& executor, const Planes& planes) {
                             const std::optional<VoxelSights> sights = sightsRead();
                             gather_.recordVisibility(executor, position, normal, mapsRead(sights), shadowingClusters(), planes);
                         }});
    return views;
}

std::uint64_t SsvpTechnique::bytes() const {
    std::uint64_t total = rsms_.bytes() + sampling_.bytes() + maps_.bytes() + gather_.bytes() +
                          (gatherAll_ ? gatherAll_->bytes() : 0) + (plan_ ? plan_->bytes() : 0) + (shadows_ ? shadows_->bytes() : 0) + (compensation_ ? compensation_->bytes() : 0) +
                          (points_ ? points_->bytes() : 0);
    for (const Stage& stage : stages_) total += stage.clusters.bytes() + stage.next.bytes();
    states_.each([&](const InterleavedView& state) { total += state.bytes(); });
    return total;
}

}  // namespace

const TechniqueEntry& ssvpEntry() {
    static const TechniqueEntry entry = techniqueEntry<SsvpTechnique, LWSsvpDesc, lwDefaultSsvp>(
        "ssvp", "clustered virtual point lights with visibility from paraboloid maps or voxels, and a second bounce", 2, ssvpParameters(),
        ssvpSettings(), estimateSsvpBytes);
    return entry;
}

}  // namespace lightwell
