#include "techniques/auto_view.h"

#include "inputs/image_check.h"
#include "techniques/fallback_points.h"

namespace lightwell {

AutoView::AutoView(Device& device, const View& view)
    : irradiance_(device, view.maxWidth, view.maxHeight, 3, "irradiance of auto's candidate"),
      validity_(device, view.maxWidth, view.maxHeight, 1, "validity of auto's candidate"),
      fade_(device, view.maxWidth, view.maxHeight) {}

void AutoView::render(Executor& executor, const View& view, const LWGBuffer& gbuffer, const LWOutput& output, CrossFade& fade,
                      float share, const std::function<void(const LWOutput&)>& candidate) {
    gbuffer_.import(executor, view, gbuffer, kNeedsMotion, "gbuffer");
    FadeFrame frame;
    LWOutput part{};
    part.structSize = sizeof part;
    // The images that the host asks for, and no more: what a technique keeps from frame to frame may depend on them.
    if (!imageAbsent(output.irradiance)) {
        frame.irradiance = irradiance_.planes(view.width, view.height);
        part.irradiance = imageOver(frame.irradiance, LW_FORMAT_PLANAR_FLOAT3);
    }
    if (!imageAbsent(output.validity)) {
        frame.validity = validity_.planes(view.width, view.height);
        part.validity = imageOver(frame.validity, LW_FORMAT_FLOAT1);
    }
    candidate(part);
    frame.position = gbuffer_.position;
    frame.normal = gbuffer_.normal;
    frame.motion = gbuffer_.motion;
    frame.shownIrradiance = shownIrradiance_.begin(executor, view, output.irradiance, 3, "output.irradiance");
    frame.shownValidity = shownValidity_.begin(executor, view, output.validity, 1, "output.validity");
    fade.record(executor, frame, gbuffer.camera, share, fade_);
    shownIrradiance_.end(executor);
    shownValidity_.end(executor);
}

void AutoView::report(Device& device, Report& report) const {
    shownIrradiance_.report(report);
    shownValidity_.report(report);
    fade_.report(device, report);
}

std::uint64_t AutoView::bytes() const {
    return irradiance_.bytes() + validity_.bytes() + gbuffer_.bytes() + shownIrradiance_.bytes() + shownValidity_.bytes() + fade_.bytes();
}

std::uint64_t AutoView::estimateBytes(const LWViewDesc& view, bool uploads) {
    const std::uint64_t plane = std::uint64_t(paddedWidth(view.maxWidth)) * view.maxHeight * sizeof(float);
    return 4 * plane + GBufferInput::estimateBytes(view, kNeedsMotion, uploads) + OutputTarget::estimateBytes(view, 3, uploads) +
           OutputTarget::estimateBytes(view, 1, uploads) + FadedView::estimateBytes(view.maxWidth, view.maxHeight);
}

}  // namespace lightwell
