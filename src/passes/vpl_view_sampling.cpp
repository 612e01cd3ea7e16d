#include "passes/vpl_view_sampling.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/image_access.h"
#include "inputs/view.h"
#include "passes/vpl_list.h"
#include "shared/vpl_types.h"
#include "shared/vpl_view_types.h"

namespace lightwell {
namespace {

constexpr char kProgram[] = "vpl_view_sampling/vpl_view_sampling";
constexpr Range kGroup{64, 1};
constexpr std::uint32_t kMaxSide = 16384;
constexpr std::size_t kPlanes = 8;

std::string nameOf(std::uint32_t i) { return "frame.sourceViews[" + std::to_string(i) + "].gbuffer"; }

View viewOf(const LWGBuffer& gbuffer, const std::string& name) {
    const LWImage& image = gbuffer.normal;
    if (imageAbsent(image) || image.width == 0 || image.height == 0 || image.width > kMaxSide || image.height > kMaxSide)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".normal: expected an image of 1 .. ", kMaxSide, " pixels a side, got ",
             image.width, " x ", image.height);
    return View(image.width, image.height);
}

}  // namespace

VplViewSampling::VplViewSampling(Device& device)
    : device_(device),
      points_(device.programs().kernel(kProgram, "vpl_view_sampling_points")),
      frameOf_(device.programs().kernel(kProgram, "vpl_view_sampling_frame")),
      place_(device.programs().kernel(kProgram, "vpl_view_sampling_place")),
      light_(device.programs().kernel(kProgram, "vpl_view_sampling_light")),
      gain_(device.programs().kernel(kProgram, "vpl_view_sampling_gain")),
      weigh_(device.programs().kernel(kProgram, "vpl_view_sampling_weigh")),
      total_(device.programs().kernel(kProgram, "vpl_view_sampling_total")),
      pick_(device.programs().kernel(kProgram, "vpl_view_sampling_pick")),
      candidates_(device.programs().kernel(kProgram, "vpl_view_sampling_candidates")) {}

void VplViewSampling::check(Device& device, const LWFrame& frame) {
    // Without texels nothing is drawn.
    const bool draws = std::any_of(frame.lights, frame.lights + frame.lightCount, [](const LWLight& l) { return l.rsmCount > 0; });
    if (draws && frame.sourceViewCount == 0)
        fail(LW_ERROR_INVALID_ARGUMENT, "frame.sourceViews: expected the views that VPLs are to light, as the technique's parameter "
             "sampling=view asks for them, got none");
    for (std::uint32_t i = 0; i < frame.sourceViewCount; ++i) {
        const LWGBuffer& gbuffer = *frame.sourceViews[i].gbuffer;
        GBufferInput::check(device, viewOf(gbuffer, nameOf(i)), gbuffer, 0, nameOf(i).c_str());
    }
}

void VplViewSampling::import(Executor& executor, const LWFrame& frame) {
    check(device_, frame);
    seen_.reserve(device_, kPlanes * LW_VIEW_POINTS * 4, "view points");
    placed_.reserve(device_, kPlanes * LW_VIEW_POINTS * 4, "view points");
    list_.reserve(device_, sizeof(lw_vpl) * LW_VIEW_POINTS, "view points");
    frame_.reserve(device_, 4 * 4, "frame of view points");
    views_.resize(frame.sourceViewCount);
    if (frame.sourceViewCount == 0) return;
    const std::uint32_t share = LW_VIEW_POINTS / frame.sourceViewCount;
    std::uint32_t first = 0;
    for (std::uint32_t i = 0; i < frame.sourceViewCount; ++i) {
        const LWGBuffer& gbuffer = *frame.sourceViews[i].gbuffer;
        views_[i].import(executor, viewOf(gbuffer, nameOf(i)), gbuffer, 0, nameOf(i).c_str());
        const Planes &position = views_[i].position, &normal = views_[i].normal;
        std::uint32_t columns = std::uint32_t(std::sqrt(double(share) * normal.width / normal.height) + 0.5);
        columns = std::clamp(columns, 1u, share);
        const std::uint32_t rows = share / columns;
        executor.run("vpl_view_sampling.points", points_, {columns * rows, 1}, kGroup, position, normal, cl_int(normal.width),
                     cl_int(normal.height), cl_int(columns), cl_int(rows), cl_int(first), seen_);
        first += columns * rows;
    }
    executor.run("vpl_view_sampling.points", frameOf_, {1, 1}, {1, 1}, seen_, cl_int(first), frame_);
    executor.run("vpl_view_sampling.points", place_, {LW_VIEW_POINTS, 1}, kGroup, seen_, cl_int(first), frame_, placed_, list_);
}

std::uint32_t VplViewSampling::pointCount() { return LW_VIEW_POINTS; }

void VplViewSampling::record(Executor& executor, const Buffer& candidates, std::uint32_t candidateCount, std::uint32_t sampleCount,
                             float offset, const Buffer& authored, lw_subset_order order, const Buffer& vpls, const ViewSights* sights) {
    const cl_int count = cl_int(candidateCount), stride = cl_int(paddedWidth(candidateCount));
    parts_.reserve(device_, std::size_t(LW_VIEW_PARTS) * LW_VIEW_POINTS * 4, "light at view points");
    planes_.reserve(device_, std::size_t(stride) * 6 * 4, "candidates for VPLs");
    weights_.reserve(device_, std::size_t(stride) * 4, "weights of candidates");
    sums_.reserve(device_, std::size_t(candidateCount) * 4, "cumulative weights of candidates");
    const std::uint32_t width = light_.width(), items = std::uint32_t(stride) / width;
    executor.run("vpl_view_sampling.candidates", candidates_, {items, 1}, {4, 1}, candidates, count, stride, frame_, planes_);
    const cl_int hasSights = sights ? 1 : 0;
    if (sights) {
        if (!look_) look_ = &device_.programs().kernel("vpl_view_sampling/vpl_view_sights", "vpl_view_sights_look");
        sights_.reserve(device_, std::size_t(stride) * sights->groups * 4, "what view points see");
        executor.run("vpl_view_sampling.look", *look_, {items, sights->groups}, {4, 1}, candidates, count, stride, sights->frames,
                     sights->records, cl_int(sights->size), cl_int(sights->groups), sights_);
    }
    const Buffer &groups = sights ? sights->assignment : list_, &seen = sights ? sights_ : weights_;
    executor.run("vpl_view_sampling.light", light_, {LW_VIEW_PARTS / width, LW_VIEW_POINTS}, {1, 4}, placed_, planes_, stride, groups,
                 seen, hasSights, parts_);
    executor.run("vpl_view_sampling.light", gain_, {LW_VIEW_POINTS, 1}, kGroup, parts_, placed_);
    executor.run("vpl_view_sampling.weigh", weigh_, {items, 1}, {4, 1}, placed_, planes_, stride, groups, sights ? sights_ : planes_, hasSights,
                 weights_);
    executor.run("vpl_view_sampling.total", total_, {1, 1}, {1, 1}, candidates, count, weights_, sums_);
    executor.run("vpl_view_sampling.pick", pick_, gridOver(std::size_t(order.subsets) * std::size_t(order.capacity)), kGroup, candidates,
                 count, sums_, cl_int(sampleCount), offset, authored, order, vpls);
}

void VplViewSampling::report(Report&) const {}

std::uint64_t VplViewSampling::bytes() const {
    std::uint64_t total = seen_.bytes() + frame_.bytes() + list_.bytes() + planes_.bytes() + sights_.bytes() + placed_.bytes() + parts_.bytes() + weights_.bytes() + sums_.bytes();
    for (const GBufferInput& view : views_) total += view.bytes();
    return total;
}

std::uint64_t VplViewSampling::estimateBytes(std::uint64_t candidateCount, const FrameShape& shape) {
    const std::uint64_t packed = largestPixelBytes(kPositionRole) + largestPixelBytes(kNormalRole);
    return (2 * kPlanes + LW_VIEW_PARTS + 12) * LW_VIEW_POINTS * 4 + 16 + (24 * (candidateCount + 15)) * 4 +
           shape.sourcePixels * (6 * sizeof(float) + (shape.uploads ? packed : 0));
}

}  // namespace lightwell
