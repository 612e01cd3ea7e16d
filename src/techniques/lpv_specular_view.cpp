#include "techniques/lpv_specular_view.h"

#include "compute/device.h"
#include "compute/raw_enum.h"

namespace lightwell {
namespace {

constexpr std::size_t kCountBytes = LpvSpecular::kCounts * sizeof(cl_int);
constexpr std::size_t kUpsampleCountBytes = 2 * sizeof(cl_int);

bool isGiven(const LWImage& image) { return rawEnum(image.format) != LW_FORMAT_NONE; }

}  // namespace

// By the first frame that asks for it.
void LpvSpecularView::reserve(Device& device, const View& view, bool half) {
    if (counts_) return;
    half_ = half;
    if (half) {
        const std::uint32_t w = JointBilateral::halved(view.maxWidth), h = JointBilateral::halved(view.maxHeight);
        halfRadiance_ = PlanarImage(device, w, h, 3, "half-resolution specular radiance");
        halfRoughness_ = PlanarImage(device, w, h, 1, "half-resolution roughness");
        upsampleCounts_ = Buffer(device, kUpsampleCountBytes, "counts of specular rays");
    }
    counts_ = Buffer(device, kCountBytes, "counts of specular rays");
}

std::optional<LwSpecularRays> LpvSpecularView::rays(const View& view, const LWGBuffer& gbuffer, const LWOutput& output,
                                                    const float* environment) {
    if (!isGiven(output.specularRadiance)) return std::nullopt;
    return specularRays(Camera(gbuffer.camera, view.width, view.height, "gbuffer.camera"), environment, kRoughness);
}

std::uint32_t LpvSpecularView::needs(const LWGBuffer& gbuffer) { return isGiven(gbuffer.roughness) ? std::uint32_t(kNeedsRoughness) : 0u; }

void LpvSpecularView::render(Executor& executor, const View& view, const LWOutput& output, const GBufferInput& gbuffer,
                             const LwSpecularRays& rays, LpvVolume& volume, const LpvHalfSurfaces* half) {
    reserve(executor.device(), view, half != nullptr);
    const Planes radiance = output_.begin(executor, view, output.specularRadiance, 3, "output.specularRadiance");
    const LpvSpecularGrid grid = volume.specular(executor);
    executor.fill("lpv_specular.counts", counts_, 0, 0, kCountBytes);
    if (half) {
        marched_ = halfRadiance_.planes(half->position.width, half->position.height);
        Planes roughness;
        if (gbuffer.roughness) {
            roughness = halfRoughness_.planes(half->position.width, half->position.height);
            grid.pass.recordPick(executor, gbuffer.position, gbuffer.roughness, half->position, roughness);
        }
        grid.pass.recordMarch(executor, half->position, half->normal, roughness, rays, grid.place, marched_, counts_);
        executor.fill("lpv_specular.counts", upsampleCounts_, 0, 0, kUpsampleCountBytes);
        half->bilateral->recordUpsample(executor, gbuffer.position, gbuffer.normal, half->position, half->normal, marched_, radiance,
                                       upsampleCounts_);
    } else {
        grid.pass.recordMarch(executor, gbuffer.position, gbuffer.normal, gbuffer.roughness, rays, grid.place, radiance, counts_);
        marched_ = radiance;
    }
    output_.end(executor);
    isRendered_ = true;
}

void LpvSpecularView::startReport(Report& report) {
    for (const char* name : {"specular_pixels", "saturated_specular_pixels"}) report.counts.push_back({name, 0});
}

void LpvSpecularView::report(Device& device, Report& report, bool isAlone) const {
    if (!isRendered_) return;
    output_.report(report);
    report.read(device, "specular_pixels", counts_, 3 * sizeof(cl_int));
    report.read(device, "saturated_specular_pixels", counts_, sizeof(cl_int));
    if (!isAlone) return;
    report.read(device, "rejected_pixels", half_ ? upsampleCounts_ : counts_, 0);
    report.read(device, "pixels_outside", counts_, 2 * sizeof(cl_int));
    if (half_) report.read(device, "upsample_fallbacks", upsampleCounts_, sizeof(cl_int));
}

void LpvSpecularView::addDebugViews(std::vector<DebugView>& views) const {
    if (isRendered_)
        views.push_back({"specular", "radiance along the lobes (W/(sr m^2)); at half resolution before it is up-sampled", marched_, {}});
}

std::uint64_t LpvSpecularView::bytes() const {
    return output_.bytes() + halfRadiance_.bytes() + halfRoughness_.bytes() + counts_.bytes() + upsampleCounts_.bytes();
}

std::uint64_t LpvSpecularView::estimateBytes(const LWViewDesc& view, bool half, bool uploads) {
    const std::uint64_t halves = !half ? 0
                                       : 4 * sizeof(float) * std::uint64_t(paddedWidth(JointBilateral::halved(view.maxWidth))) *
                                                 JointBilateral::halved(view.maxHeight) +
                                             kUpsampleCountBytes;
    return GBufferInput::estimateBytes(view, kNeedsRoughness, uploads) - GBufferInput::estimateBytes(view, 0, uploads) +
           OutputTarget::estimateBytes(view, 3, uploads) + kCountBytes + halves;
}

}  // namespace lightwell
