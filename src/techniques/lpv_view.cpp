#include "techniques/lpv_view.h"

#include "compute/device.h"
#include "passes/lpv_read.h"

namespace lightwell {
namespace {

constexpr std::size_t kCountBytes = LpvRead::kCounts * sizeof(cl_int);
constexpr std::size_t kUpsampleCountBytes = 2 * sizeof(cl_int);

}  // namespace

LpvView::LpvView(Device& device, const View& view, bool half) : half_(half), counts_(device, kCountBytes, "counts of a view") {
    if (!half) return;
    const std::uint32_t w = JointBilateral::halved(view.maxWidth), h = JointBilateral::halved(view.maxHeight);
    halfPosition_ = PlanarImage(device, w, h, 3, "half-resolution positions");
    halfNormal_ = PlanarImage(device, w, h, 3, "half-resolution normals");
    halfLight_ = PlanarImage(device, w, h, 3, "half-resolution irradiance");
    upsampleCounts_ = Buffer(device, kUpsampleCountBytes, "counts of a view");
    validityCounts_ = Buffer(device, kCountBytes, "counts of a view");
}

void LpvView::render(Executor& executor, const View& view, const LWGBuffer& gbuffer, const LWOutput& output,
                     JointBilateral* bilateral, LpvVolume& volume) {
    gbuffer_.import(executor, view, gbuffer, 0, "gbuffer");
    lastHalf_ = Planes{};
    executor.fill("lpv_read.counts", counts_, 0, 0, kCountBytes);
    const Planes irradiance = irradiance_.begin(executor, view, output.irradiance, 3, "output.irradiance");
    const Planes validity = validity_.begin(executor, view, output.validity, 1, "output.validity");
    if (half_ && irradiance)
        lightHalf(executor, irradiance, validity, *bilateral, volume);
    else
        volume.recordGather(executor, gbuffer_.position, gbuffer_.normal, irradiance, validity, counts_);
    irradiance_.end(executor);
    validity_.end(executor);
    isRendered_ = true;
}

// Validity is a bound on positions, cheap and sharp: it is made of every pixel, other than light.
void LpvView::lightHalf(Executor& executor, const Planes& irradiance, const Planes& validity, JointBilateral& bilateral,
                        LpvVolume& volume) {
    const Planes &position = gbuffer_.position, &normal = gbuffer_.normal;
    const std::uint32_t w = JointBilateral::halved(position.width), h = JointBilateral::halved(position.height);
    const Planes halfPosition = halfPosition_.planes(w, h), halfNormal = halfNormal_.planes(w, h), light = halfLight_.planes(w, h);
    executor.fill("lpv_read.counts", upsampleCounts_, 0, 0, kUpsampleCountBytes);
    bilateral.recordDownsample(executor, position, normal, halfPosition, halfNormal);
    volume.recordGather(executor, halfPosition, halfNormal, light, {}, counts_);
    bilateral.recordUpsample(executor, position, normal, halfPosition, halfNormal, light, irradiance, upsampleCounts_);
    lastHalf_ = light;
    if (!validity) return;
    executor.fill("lpv_read.counts", validityCounts_, 0, 0, kCountBytes);
    volume.recordGather(executor, position, normal, {}, validity, validityCounts_);
}

void LpvView::startReport(Report& report) {
    for (const char* name : {"rejected_pixels", "saturated_pixels", "pixels_outside", "upsample_fallbacks"})
        report.counts.push_back({name, 0});
}

void LpvView::report(Device& device, Report& report) const {
    if (!isRendered_) return;
    gbuffer_.report(report);
    irradiance_.report(report);
    validity_.report(report);
    // Down-sampling turns what is neither surface nor background into background; up-sampling counts it.
    report.read(device, "rejected_pixels", lastHalf_ ? upsampleCounts_ : counts_, 0);
    report.read(device, "saturated_pixels", counts_, sizeof(cl_int));
    report.read(device, "pixels_outside", counts_, 2 * sizeof(cl_int));
    if (lastHalf_) report.read(device, "upsample_fallbacks", upsampleCounts_, sizeof(cl_int));
}

void LpvView::addDebugViews(std::vector<DebugView>& views) const {
    if (!isRendered_) return;
    views.push_back({"position", "world position (m)", gbuffer_.position, {}});
    views.push_back({"normal", "world normal as the host gave it", gbuffer_.normal, {}});
    if (lastHalf_) views.push_back({"gathered", "irradiance at half resolution, before it is up-sampled (W/m^2)", lastHalf_, {}});
}

std::uint64_t LpvView::bytes() const {
    return gbuffer_.bytes() + irradiance_.bytes() + validity_.bytes() + halfPosition_.bytes() + halfNormal_.bytes() +
           halfLight_.bytes() + counts_.bytes() + upsampleCounts_.bytes() + validityCounts_.bytes();
}

std::uint64_t LpvView::estimateBytes(const LWViewDesc& view, bool half, bool uploads) {
    const std::uint64_t halves =
        !half ? 0
              : 3 * 3 * sizeof(float) * std::uint64_t(paddedWidth(JointBilateral::halved(view.maxWidth))) *
                        JointBilateral::halved(view.maxHeight) +
                    kUpsampleCountBytes + kCountBytes;
    return GBufferInput::estimateBytes(view, 0, uploads) + OutputTarget::estimateBytes(view, 3, uploads) +
           OutputTarget::estimateBytes(view, 1, uploads) + kCountBytes + halves;
}

}  // namespace lightwell
