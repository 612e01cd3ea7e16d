#include "techniques/lpv_view.h"

#include "compute/device.h"
#include "passes/lpv_read.h"
#include "techniques/gather_report.h"

namespace lightwell {
namespace {

constexpr std::size_t kCountBytes = LpvRead::kCounts * sizeof(cl_int);
constexpr std::size_t kUpsampleCountBytes = 2 * sizeof(cl_int);

}  // namespace

LpvView::LpvView(Device& device, const View& view, bool half)
    : half_(half), counts_(device, kCountBytes, "counts of a view") {
    if (!half) return;
    const std::uint32_t w = JointBilateral::halved(view.maxWidth), h = JointBilateral::halved(view.maxHeight);
    halfPosition_ = PlanarImage(device, w, h, 3, "half-resolution positions");
    halfNormal_ = PlanarImage(device, w, h, 3, "half-resolution normals");
    halfLight_ = PlanarImage(device, w, h, 3, "half-resolution irradiance");
    upsampleCounts_ = Buffer(device, kUpsampleCountBytes, "counts of a view");
    validityCounts_ = Buffer(device, kCountBytes, "counts of a view");
}

void LpvView::render(Executor& executor, const View& view, const LWGBuffer& gbuffer, const LWOutput& output,
                     JointBilateral* bilateral, LpvVolume& volume, const std::optional<LwSpecularRays>& rays) {
    gbuffer_.import(executor, view, gbuffer, rays ? LpvSpecularView::needs(gbuffer) : 0, "gbuffer");
    lastHalf_ = Planes{};
    executor.fill("lpv_read.counts", counts_, 0, 0, kCountBytes);
    const Planes irradiance = irradiance_.begin(executor, view, output.irradiance, 3, "output.irradiance");
    const Planes validity = validity_.begin(executor, view, output.validity, 1, "output.validity");
    const std::uint32_t w = JointBilateral::halved(view.width), h = JointBilateral::halved(view.height);
    const Planes halfPosition = half_ ? halfPosition_.planes(w, h) : Planes{}, halfNormal = half_ ? halfNormal_.planes(w, h) : Planes{};
    if (half_ && (irradiance || rays))
        bilateral->recordDownsample(executor, gbuffer_.position, gbuffer_.normal, halfPosition, halfNormal);
    const LpvHalfSurfaces halves{halfPosition, halfNormal, bilateral};
    isGathered_ = irradiance || validity;
    if (half_ && irradiance)
        lightHalf(executor, irradiance, validity, halves, volume);
    else if (isGathered_)
        volume.recordGather(executor, gbuffer_.position, gbuffer_.normal, irradiance, validity, counts_);
    irradiance_.end(executor);
    validity_.end(executor);
    if (rays)
        specular_.render(executor, view, output, gbuffer_, *rays, volume, half_ ? &halves : nullptr);
    else
        specular_.skip();
    isRendered_ = true;
}

// Validity is a bound on positions, cheap and sharp: it is made of every pixel, other than light.
void LpvView::lightHalf(Executor& executor, const Planes& irradiance, const Planes& validity, const LpvHalfSurfaces& half,
                        LpvVolume& volume) {
    const Planes &position = gbuffer_.position, &normal = gbuffer_.normal;
    const Planes light = halfLight_.planes(half.position.width, half.position.height);
    executor.fill("lpv_read.counts", upsampleCounts_, 0, 0, kUpsampleCountBytes);
    volume.recordGather(executor, half.position, half.normal, light, {}, counts_);
    half.bilateral->recordUpsample(executor, position, normal, half.position, half.normal, light, irradiance, upsampleCounts_);
    lastHalf_ = light;
    if (!validity) return;
    executor.fill("lpv_read.counts", validityCounts_, 0, 0, kCountBytes);
    volume.recordGather(executor, position, normal, {}, validity, validityCounts_);
}

void LpvView::startReport(Report& report) {
    startGatherReport(report);
    LpvSpecularView::startReport(report);
}

void LpvView::report(Device& device, Report& report) const {
    if (!isRendered_) return;
    gbuffer_.report(report);
    irradiance_.report(report);
    validity_.report(report);
    specular_.report(device, report, !isGathered_);
    if (!isGathered_) return;
    reportGather(device, report, counts_, lastHalf_ ? &upsampleCounts_ : nullptr);
}

void LpvView::addDebugViews(std::vector<DebugView>& views) const {
    if (!isRendered_) return;
    views.push_back({"position", "world position (m)", gbuffer_.position, {}});
    views.push_back({"normal", "world normal as the host gave it", gbuffer_.normal, {}});
    if (lastHalf_) views.push_back({"gathered", "irradiance at half resolution, before it is up-sampled (W/m^2)", lastHalf_, {}});
    specular_.addDebugViews(views);
}

std::uint64_t LpvView::bytes() const {
    return gbuffer_.bytes() + specular_.bytes() + irradiance_.bytes() + validity_.bytes() + halfPosition_.bytes() + halfNormal_.bytes() +
           halfLight_.bytes() + counts_.bytes() + upsampleCounts_.bytes() + validityCounts_.bytes();
}

std::uint64_t LpvView::estimateBytes(const LWViewDesc& view, bool half, bool uploads) {
    const std::uint64_t halves =
        !half ? 0
              : 3 * 3 * sizeof(float) * std::uint64_t(paddedWidth(JointBilateral::halved(view.maxWidth))) *
                        JointBilateral::halved(view.maxHeight) +
                    kUpsampleCountBytes + kCountBytes;
    return GBufferInput::estimateBytes(view, 0, uploads) + OutputTarget::estimateBytes(view, 3, uploads) +
           OutputTarget::estimateBytes(view, 1, uploads) + kCountBytes + halves + LpvSpecularView::estimateBytes(view, half, uploads);
}

}  // namespace lightwell
