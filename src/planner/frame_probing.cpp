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
    checkView(device, view, gbuffer);
    RsmInput::check(device, frame);
}

void FrameProbing::checkView(Device& device, const View& view, const LWGBuffer& gbuffer) {
    GBufferInput::check(device, view, gbuffer, needsOf(gbuffer), "gbuffer");
    if (hasCamera(gbuffer)) Camera(gbuffer.camera, view.width, view.height, "gbuffer.camera");
}

std::uint64_t FrameProbing::estimateBytes(const LWViewDesc& view, const FrameShape& shape) {
    return GBufferInput::estimateBytes(view, kNeedsAlbedo | kNeedsDirectRadiance, shape.uploads) + RsmInput::estimateBytes(shape) +
           FrameProbes::estimateBytes(shape.rows, shape.vplCount);  // a map has a row at least
}

void FrameProbing::record(Executor& executor, const View& view, const LWFrame& frame, const LWGBuffer& gbuffer) {
    if (probes_.isReading()) return;
    check(device_, view, frame, gbuffer);
    beginFrame(executor, frame);
    recordView(executor, view, gbuffer);
}

void FrameProbing::beginFrame(Executor& executor, const LWFrame& frame) {
    rsms_.import(executor, frame);
    vpls_.assign(frame.vpls, frame.vpls + frame.vplCount);
}

void FrameProbing::recordView(Executor& executor, const View& view, const LWGBuffer& gbuffer) {
    gbuffer_.import(executor, view, gbuffer, needsOf(gbuffer), "gbuffer");
    ProbedView probed;
    probed.position = gbuffer_.position;
    probed.normal = gbuffer_.normal;
    probed.albedo = gbuffer_.albedo;
    probed.directRadiance = gbuffer_.directRadiance;
    probed.width = view.width;
    probed.height = view.height;
    probed.hasCamera = hasCamera(gbuffer);
    if (probed.hasCamera) probed.camera = Camera(gbuffer.camera, view.width, view.height, "gbuffer.camera").texelsOf(1);
    probes_.record(executor, probed, rsms_, vpls_.data(), std::uint32_t(vpls_.size()));
    probes_.readLate(executor);
}

}  // namespace lightwell
