#include "techniques/cone_tracing_rays.h"

#include "compute/device.h"
#include "compute/error.h"
#include "compute/raw_enum.h"

namespace lightwell {
namespace {

constexpr std::size_t kCountBytes = ConeGather::kCounts * sizeof(cl_int);

bool isAsked(const LWImage& image) { return rawEnum(image.format) != LW_FORMAT_NONE; }

}  // namespace

ConeRaysAsked ConeTracingRays::asked(const View& view, const LWGBuffer& gbuffer, const LWOutput& output, const LWConeTracingDesc& desc,
                                     const ConeLightSource* light) {
    ConeRaysAsked asked;
    asked.specular = isAsked(output.specularRadiance);
    asked.refracted = isAsked(output.refractedRadiance);
    if (asked.hasRays()) asked.eye = coneEye(Camera(gbuffer.camera, view.width, view.height, "gbuffer.camera"));
    if (!isAsked(output.shadow)) return asked;
    if (!light)
        fail(LW_ERROR_INVALID_ARGUMENT, "output.shadow: expected light ", desc.shadowLight,
             " (the technique's parameter shadow_light) among frame.lights of the last lwUpdate, got fewer");
    asked.light = *light;
    return asked;
}

std::uint32_t ConeTracingRays::needs(const ConeRaysAsked& asked, const LWGBuffer& gbuffer) {
    return asked.hasRays() && isAsked(gbuffer.roughness) ? std::uint32_t(kNeedsRoughness) : 0u;
}

void ConeTracingRays::render(Executor& executor, const View& view, const LWOutput& output, const GBufferInput& gbuffer,
                             const ConeRaysAsked& asked, double index, ConeRays& rays, const ConeWorld& world) {
    asked_ = asked;
    const auto clear = [&](Buffer& counts) {
        if (!counts) counts = Buffer(executor.device(), kCountBytes, "counts of single cones");
        executor.fill("cone_gather.counts", counts, 0, 0, kCountBytes);
    };
    if (asked.specular) {
        clear(counts_);
        const Planes radiance = specular_.begin(executor, view, output.specularRadiance, 3, "output.specularRadiance");
        rays.recordSpecular(executor, gbuffer.position, gbuffer.normal, gbuffer.roughness, kRoughness, asked.eye, world, radiance, counts_);
        specular_.end(executor);
    }
    if (asked.refracted) {
        clear(refractedCounts_);
        const Planes radiance = refracted_.begin(executor, view, output.refractedRadiance, 3, "output.refractedRadiance");
        rays.recordRefraction(executor, gbuffer.position, gbuffer.normal, gbuffer.roughness, kRoughness, index, asked.eye, world, radiance,
                              refractedCounts_);
        refracted_.end(executor);
    }
    if (asked.light) {
        const Planes shadow = shadow_.begin(executor, view, output.shadow, 1, "output.shadow");
        rays.recordShadow(executor, gbuffer.position, gbuffer.normal, *asked.light, world, shadow);
        shadow_.end(executor);
    }
}

void ConeTracingRays::startReport(Report& report) {
    for (const char* name : {"saturated_specular_pixels", "saturated_refracted_pixels"}) report.counts.push_back({name, 0});
}

void ConeTracingRays::report(Device& device, Report& report, bool isAlone) const {
    if (asked_.specular) {
        specular_.report(report);
        report.read(device, "saturated_specular_pixels", counts_, sizeof(cl_int));
    }
    if (asked_.refracted) {
        refracted_.report(report);
        report.read(device, "saturated_refracted_pixels", refractedCounts_, sizeof(cl_int));
    }
    if (asked_.light) shadow_.report(report);
    if (!isAlone || !asked_.hasRays()) return;
    const Buffer& counts = asked_.specular ? counts_ : refractedCounts_;
    report.read(device, "rejected_pixels", counts, 0);
    report.read(device, "pixels_outside", counts, 2 * sizeof(cl_int));
}

std::uint64_t ConeTracingRays::estimateBytes(const LWViewDesc& view, bool uploads) {
    return GBufferInput::estimateBytes(view, kNeedsRoughness, uploads) - GBufferInput::estimateBytes(view, 0, uploads) +
           2 * OutputTarget::estimateBytes(view, 3, uploads) + OutputTarget::estimateBytes(view, 1, uploads) + 2 * kCountBytes;
}

}  // namespace lightwell
