#include "planner/frame_probing.h"

#include "compute/device.h"
#include "inputs/camera.h"
#include "inputs/image_check.h"
#include "planner/planner.h"

namespace lightwell {
namespace {

std::uint32_t needsOf(const LWGBuffer& gbuffer) {
    return (imageAbsent(gbuffer.albedo) ? 0u : std::uint32_t(kNeedsAlbedo)) |
           (imageAbsent(gbuffer.directRadiance) ? 0u : std::uint32_t(kNeedsDirectRadiance));
}

}  // namespace

void FrameProbing::check(Device& device, const View& view, const LWFrame& frame, const LWGBuffer& gbuffer) {
    GBufferInput::check(device, view, gbuffer, needsOf(gbuffer), "gbuffer");
    if (hasCamera(gbuffer)) Camera(gbuffer.camera, view.width, view.height, "gbuffer.camera");
    RsmInput::check(device, frame);
}

void FrameProbing::record(Executor& executor, const View& view, const LWFrame& frame, const LWGBuffer& gbuffer) {
    if (probes_.isReading()) return;
    check(device_, view, frame, gbuffer);
    gbuffer_.import(executor, view, gbuffer, needsOf(gbuffer), "gbuffer");
    rsms_.import(executor, frame);
    ProbedView probed;
    probed.position = gbuffer_.position;
    probed.normal = gbuffer_.normal;
    probed.albedo = gbuffer_.albedo;
    probed.directRadiance = gbuffer_.directRadiance;
    probed.width = view.width;
    probed.height = view.height;
    probed.hasCamera = hasCamera(gbuffer);
    if (probed.hasCamera) probed.camera = Camera(gbuffer.camera, view.width, view.height, "gbuffer.camera").texelsOf(1);
    probes_.record(executor, probed, rsms_, frame.vpls, frame.vplCount);
    probes_.readLate(executor);
}

}  // namespace lightwell
