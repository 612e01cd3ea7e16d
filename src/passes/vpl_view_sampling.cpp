#include "passes/vpl_view_sampling.h"

#include <algorithm>
#include <cmath>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/image_access.h"
#include "inputs/source_view.h"
#include "passes/vpl_list.h"
#include "shared/vpl_types.h"
#include "shared/vpl_view_types.h"

namespace lightwell {
namespace {

constexpr char kProgram[] = "vpl_view_sampling/vpl_view_sampling";
constexpr Range kGroup{64, 1};
constexpr std::size_t kPlanes = 6;

}  // namespace

VplViewSampling::VplViewSampling(Device& device)
    : device_(device),
      points_(device.programs().kernel(kProgram, "vpl_view_sampling_points")),
      frameOf_(device.programs().kernel(kProgram, "vpl_view_sampling_frame")),
      weigh_(device.programs().kernel(kProgram, "vpl_view_sampling_weigh")),
      total_(device.programs().kernel(kProgram, "vpl_view_sampling_total")),
      pick_(device.programs().kernel(kProgram, "vpl_view_sampling_pick")) {}

void VplViewSampling::check(Device& device, const LWFrame& frame) {
    // Without texels nothing is drawn.
    const bool draws = std::any_of(frame.lights, frame.lights + frame.lightCount, [](const LWLight& l) { return l.rsmCount > 0; });
    if (draws && frame.sourceViewCount == 0)
        fail(LW_ERROR_INVALID_ARGUMENT, "frame.sourceViews: expected the views that VPLs are to light, as the technique's "
             "parameter sampling=view asks for them, got none");
    for (std::uint32_t i = 0; i < frame.sourceViewCount; ++i) {
        const LWGBuffer& gbuffer = *frame.sourceViews[i].gbuffer;
        GBufferInput::check(device, sourceViewOf(frame, i), gbuffer, 0, sourceViewName(i).c_str());
    }
}

void VplViewSampling::import(Executor& executor, const LWFrame& frame) {
    check(device_, frame);
    seen_.reserve(device_, kPlanes * LW_VIEW_POINTS * 4, "view points");
    frame_.reserve(device_, 4 * 4, "frame of view points");
    views_.resize(frame.sourceViewCount);  // of fewer, the last frame's images are let go of
    if (views_.empty()) return;
    const std::uint32_t share = LW_VIEW_POINTS / frame.sourceViewCount;
    std::uint32_t first = 0;
    for (std::uint32_t i = 0; i < frame.sourceViewCount; ++i) {
        const LWGBuffer& gbuffer = *frame.sourceViews[i].gbuffer;
        views_[i].import(executor, sourceViewOf(frame, i), gbuffer, 0, sourceViewName(i).c_str());
        const Planes &position = views_[i].position, &normal = views_[i].normal;
        std::uint32_t columns = std::uint32_t(std::sqrt(double(share) * normal.width / normal.height) + 0.5);
        columns = std::clamp(columns, 1u, share);
        const std::uint32_t rows = share / columns;
        executor.run("vpl_view_sampling.points", points_, {columns * rows, 1}, kGroup, position, normal,
                     cl_int(normal.width), cl_int(normal.height), cl_int(columns), cl_int(rows), cl_int(first), seen_);
        first += columns * rows;
    }
    executor.run("vpl_view_sampling.points", frameOf_, {1, 1}, {1, 1}, seen_, cl_int(first), frame_);
}

void VplViewSampling::record(Executor& executor, const Buffer& candidates, std::uint32_t candidateCount, std::uint32_t sampleCount,
                             float offset, const Buffer& authored, lw_subset_order order, const Buffer& vpls) {
    weights_.reserve(device_, std::size_t(paddedWidth(candidateCount)) * 4, "weights of candidates");
    const cl_int count = cl_int(candidateCount);
    const std::uint32_t items = (candidateCount + weigh_.width() - 1) / weigh_.width();
    executor.run("vpl_view_sampling.weigh", weigh_, gridOver(items), {4, 1}, seen_, frame_, candidates, count, weights_);
    executor.run("vpl_view_sampling.total", total_, {1, 1}, {1, 1}, candidates, count, weights_);
    const Range slots = gridOver(std::size_t(order.subsets) * std::size_t(order.capacity));
    executor.run("vpl_view_sampling.pick", pick_, slots, kGroup, candidates, count, weights_, cl_int(sampleCount), offset, authored, order, vpls);
}

std::uint64_t VplViewSampling::bytes() const {
    std::uint64_t total = seen_.bytes() + frame_.bytes() + weights_.bytes();
    for (const GBufferInput& view : views_) total += view.bytes();
    return total;
}

std::uint64_t VplViewSampling::estimateBytes(std::uint64_t candidateCount, const FrameShape& shape) {
    const std::uint64_t packed = largestPixelBytes(kPositionRole) + largestPixelBytes(kNormalRole);
    return kPlanes * LW_VIEW_POINTS * 4 + 16 + (candidateCount + 15) / 16 * 16 * 4 +
           shape.sourcePixels * (6 * sizeof(float) + (shape.uploads ? packed : 0));
}

}  // namespace lightwell
