#include "techniques/cone_tracing_view.h"

#include "compute/device.h"
#include "compute/raw_enum.h"
#include "inputs/image_access.h"
#include "techniques/gather_report.h"

namespace lightwell {
namespace {

constexpr std::size_t kCountBytes = ConeGather::kCounts * sizeof(cl_int);
constexpr std::size_t kUpsampleCountBytes = 2 * sizeof(cl_int);
constexpr std::uint32_t kLightPlanes = 5;  // irradiance, validity, open share

bool isAsked(const LWImage& image) { return rawEnum(image.format) != LW_FORMAT_NONE; }

std::uint32_t halvingsOf(const LWConeTracingDesc& desc) {
    switch (desc.resolution) {
        case LW_CONE_RESOLUTION_HALF:
        case LW_CONE_RESOLUTION_HALF_INTERLEAVED: return 1;
        case LW_CONE_RESOLUTION_QUARTER: return 2;
        default: return 0;
    }
}
bool isInterleaved(const LWConeTracingDesc& desc) {
    return desc.resolution == LW_CONE_RESOLUTION_INTERLEAVED || desc.resolution == LW_CONE_RESOLUTION_HALF_INTERLEAVED;
}
bool dimsLight(const LWConeTracingDesc& desc) { return desc.occlusion == LW_CONE_OCCLUSION_ALL; }

std::uint64_t planeBytes(std::uint32_t width, std::uint32_t height) { return sizeof(float) * std::uint64_t(paddedWidth(width)) * height; }

}  // namespace

ConeGatherOptions coneOptions(const LWConeTracingDesc& desc) {
    ConeGatherOptions options;
    options.size = desc.size;
    options.cascades = desc.cascades;
    options.mode = desc.mode;
    options.sides = coneSides(desc);
    options.startPlane = desc.normalAware == 2;
    options.cones = desc.cones;
    options.interleaved = isInterleaved(desc);
    options.nudge = double(desc.nudge);
    options.step = double(desc.step);
    options.distance = double(desc.distance);
    options.opacityCorrection = desc.opacityCorrection != 0;
    options.apertureOffset = desc.apertureOffset != 0;
    options.near = desc.occlusion == LW_CONE_OCCLUSION_NEAR;
    options.occlusionDistance = double(desc.occlusionDistance);
    options.tetrahedral = desc.interpolation == LW_CONE_INTERPOLATION_TETRAHEDRAL;
    return options;
}

ConeTracingPasses::ConeTracingPasses(Device& device, const LWConeTracingDesc& desc)
    : gather(device, coneOptions(desc)),
      rays(device, coneOptions(desc)),
      index(double(desc.refractiveIndex)),
      halvings(halvingsOf(desc)),
      interleaved(isInterleaved(desc)),
      dims(dimsLight(desc)) {
    if (halvings) bilateral.emplace(device, kLightPlanes);
    if (dims) dim_ = &device.programs().kernel("cone_tracing/cone_tracing", "cone_tracing_dim");
}

std::uint64_t ConeTracingPasses::estimateBytes(const LWConeTracingDesc& desc) {
    return ConeGather::estimateBytes(coneOptions(desc)) + ConeRays::estimateBytes(coneOptions(desc), true, double(desc.shadowAngle));
}

void ConeTracingPasses::recordDim(Executor& executor, const Planes& irradiance, const Planes& open) {
    const std::uint32_t lanes = dim_->width();
    executor.run("cone_tracing.dim", *dim_, {(irradiance.width + lanes - 1) / lanes, irradiance.height}, {8, 1}, irradiance, open,
                 cl_int(irradiance.width), cl_int(irradiance.height));
}

ConeTracingView::ConeTracingView(Device& device, const LWConeTracingDesc& desc)
    : device_(device),
      halvings_(halvingsOf(desc)),
      interleaved_(isInterleaved(desc)),
      dims_(dimsLight(desc)),
      counts_(device, kCountBytes, "counts of a view"),
      upsampleCounts_(device, kUpsampleCountBytes, "counts of a view") {}

// Memory of what this frame needs, for the view's largest size.
void ConeTracingView::reserve(const View& view, bool wantsOpen) {
    if (interleaved_ && !gathered_)
        gathered_ = PlanarImage(device_, JointBilateral::halved(view.maxWidth, halvings_), JointBilateral::halved(view.maxHeight, halvings_), ConeGather::kGathered,
                                "shares of pixels' cones");
    if (!halvings_ && wantsOpen && !ownOpen_) ownOpen_ = PlanarImage(device_, view.maxWidth, view.maxHeight, 1, "ambient occlusion");
    for (std::uint32_t l = std::uint32_t(levels_.size()); l < halvings_; ++l) {
        const std::uint32_t w = JointBilateral::halved(view.maxWidth, l + 1), h = JointBilateral::halved(view.maxHeight, l + 1);
        levels_.push_back({PlanarImage(device_, w, h, 3, "positions of fewer pixels"), PlanarImage(device_, w, h, 3, "normals of fewer pixels"),
                           PlanarImage(device_, w, h, kLightPlanes, "light of fewer pixels")});
    }
}

void ConeTracingView::render(Executor& executor, const View& view, const LWGBuffer& gbuffer, const LWOutput& output,
                             ConeTracingPasses& passes, const ConeWorld& world, const ConeRaysAsked& rays) {
    gbuffer_.import(executor, view, gbuffer, ConeTracingRays::needs(rays, gbuffer), "gbuffer");
    lastTraced_ = Planes{};
    const bool wantsLight = isAsked(output.irradiance), makesOpen = dims_ && wantsLight && !isAsked(output.ambientOcclusion);
    reserve(view, makesOpen);
    executor.fill("cone_gather.counts", counts_, 0, 0, kCountBytes);
    executor.fill("cone_gather.counts", upsampleCounts_, 0, 0, kUpsampleCountBytes);
    Light light;
    light.irradiance = irradiance_.begin(executor, view, output.irradiance, 3, "output.irradiance");
    light.validity = validity_.begin(executor, view, output.validity, 1, "output.validity");
    light.open = open_.begin(executor, view, output.ambientOcclusion, 1, "output.ambientOcclusion");
    isGathered_ = bool(light);
    if (light && halvings_) {
        traceReduced(executor, view, passes, world, light);
    } else if (light) {
        if (makesOpen) light.open = ownOpen_.planes(view.width, view.height);
        trace(executor, passes, gbuffer_.position, gbuffer_.normal, world, light);
    }
    irradiance_.end(executor);
    validity_.end(executor);
    open_.end(executor);
    rays_.render(executor, view, output, gbuffer_, rays, passes.index, passes.rays, world);
    isRendered_ = true;
}

void ConeTracingView::trace(Executor& executor, ConeTracingPasses& passes, const Planes& position, const Planes& normal,
                            const ConeWorld& world, const Light& light) {
    if (interleaved_) {
        const Planes gathered = gathered_.planes(position.width, position.height);
        passes.gather.recordTrace(executor, position, normal, world, gathered, {}, {}, counts_, bool(light.open));
        passes.gather.recordFilter(executor, position, normal, gathered, light.irradiance, light.validity, light.open);
        lastTraced_ = gathered;
    } else {
        passes.gather.recordTrace(executor, position, normal, world, light.irradiance, light.validity, light.open, counts_);
    }
    if (dims_ && light.irradiance) passes.recordDim(executor, light.irradiance, light.open);
}

// Halves of halves: each level's surfaces are some of the one before, which it is up-sampled by.
void ConeTracingView::traceReduced(Executor& executor, const View& view, ConeTracingPasses& passes, const ConeWorld& world,
                                   const Light& light) {
    std::vector<Planes> positions{gbuffer_.position}, normals{gbuffer_.normal}, lights{Planes{}};
    for (std::uint32_t l = 0; l < halvings_; ++l) {
        const std::uint32_t w = JointBilateral::halved(view.width, l + 1), h = JointBilateral::halved(view.height, l + 1);
        positions.push_back(levels_[l].position.planes(w, h));
        normals.push_back(levels_[l].normal.planes(w, h));
        lights.push_back(levels_[l].light.planes(w, h));
        passes.bilateral->recordDownsample(executor, positions[l], normals[l], positions[l + 1], normals[l + 1]);
    }
    const bool dims = dims_ && light.irradiance;
    const Planes& coarsest = lights.back();
    const Light traced{light.irradiance ? subPlanes(coarsest, 0, 3) : Planes{}, light.validity ? subPlanes(coarsest, 3, 1) : Planes{},
                       light.open || dims ? subPlanes(coarsest, 4, 1) : Planes{}};
    trace(executor, passes, positions.back(), normals.back(), world, traced);
    for (std::uint32_t l = halvings_; l > 0; --l) {
        const Planes& to = lights[l - 1];
        const Light result = l == 1 ? light
                                    : Light{light.irradiance ? subPlanes(to, 0, 3) : Planes{}, light.validity ? subPlanes(to, 3, 1) : Planes{},
                                            light.open ? subPlanes(to, 4, 1) : Planes{}};
        if (l == 1) executor.fill("cone_gather.counts", upsampleCounts_, 0, 0, kUpsampleCountBytes);
        passes.bilateral->recordUpsampleAll(executor, positions[l - 1], normals[l - 1], positions[l], normals[l], lights[l],
                                            result.irradiance, result.validity, result.open, upsampleCounts_);
    }
    lastTraced_ = coarsest;
}

void ConeTracingView::startReport(Report& report) {
    startGatherReport(report);
    ConeTracingRays::startReport(report);
}

void ConeTracingView::report(Report& report) const {
    if (!isRendered_) return;
    gbuffer_.report(report);
    irradiance_.report(report);
    validity_.report(report);
    open_.report(report);
    rays_.report(device_, report, !isGathered_);
    if (!isGathered_) return;
    reportGather(device_, report, counts_, halvings_ ? &upsampleCounts_ : nullptr);
}

void ConeTracingView::addDebugViews(std::vector<DebugView>& views) const {
    if (!isRendered_) return;
    views.push_back({"position", "world position (m)", gbuffer_.position, {}});
    views.push_back({"normal", "world normal as the host gave it", gbuffer_.normal, {}});
    if (!lastTraced_) return;
    views.push_back({"gathered",
                     interleaved_ && !halvings_ ? "irradiance of a share of the cones (W/m^2), and what the filter makes of the others"
                                  : "irradiance (W/m^2), validity and open share of fewer pixels, before they are up-sampled",
                     lastTraced_, {}});
}

std::uint64_t ConeTracingView::bytes() const {
    std::uint64_t total = gbuffer_.bytes() + irradiance_.bytes() + validity_.bytes() + open_.bytes() + gathered_.bytes() + ownOpen_.bytes() +
                          counts_.bytes() + upsampleCounts_.bytes() + rays_.bytes();
    for (const Level& level : levels_) total += level.position.bytes() + level.normal.bytes() + level.light.bytes();
    return total;
}

std::uint64_t ConeTracingView::estimateBytes(const LWConeTracingDesc& desc, const LWViewDesc& view, bool uploads) {
    std::uint64_t total = GBufferInput::estimateBytes(view, 0, uploads) + OutputTarget::estimateBytes(view, 3, uploads) +
                          2 * OutputTarget::estimateBytes(view, 1, uploads) + kCountBytes + kUpsampleCountBytes +
                          ConeTracingRays::estimateBytes(view, uploads);
    if (isInterleaved(desc)) total += ConeGather::kGathered * planeBytes(JointBilateral::halved(view.maxWidth, halvingsOf(desc)), JointBilateral::halved(view.maxHeight, halvingsOf(desc)));
    if (dimsLight(desc) && !halvingsOf(desc)) total += planeBytes(view.maxWidth, view.maxHeight);
    for (std::uint32_t l = 1; l <= halvingsOf(desc); ++l)
        total += (3 + 3 + kLightPlanes) * planeBytes(JointBilateral::halved(view.maxWidth, l), JointBilateral::halved(view.maxHeight, l));
    return total;
}

}  // namespace lightwell
