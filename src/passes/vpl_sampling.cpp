#include "passes/vpl_sampling.h"

#include <algorithm>
#include <limits>

#include "compute/device.h"
#include "compute/error.h"

namespace lightwell {
namespace {

constexpr Range kGroup{64, 1};
constexpr const char* kProgram = "vpl_sampling/vpl_sampling";
// Candidates for each VPL chosen by view. Fewer: the same one is chosen several times where the view is lit from a small part of
// the light; more: time, in proportion.
constexpr std::uint32_t kCandidates = 8;

}  // namespace

VplSampling::VplSampling(Device& device, const VplSamplingOptions& options)
    : device_(device),
      options_(options),
      rowSums_(device.programs().kernel(kProgram, "vpl_sampling_row_sums")),
      total_(device.programs().kernel(kProgram, "vpl_sampling_total")),
      draw_(device.programs().kernel(kProgram, "vpl_sampling_draw")),
      drawLive_(device.programs().kernel(kProgram, "vpl_sampling_draw_live")),
      all_(device.programs().kernel(kProgram, "vpl_sampling_all")),
      planes_(device.programs().kernel(kProgram, "vpl_sampling_planes")) {
    if (options.view) views_.emplace(device);
}

void VplSampling::check(const LWFrame& frame) const {
    if (views_) VplViewSampling::check(device_, frame);
}

void VplSampling::importViews(Executor& executor, const LWFrame& frame) {
    if (views_) views_->import(executor, frame);
}

void VplSampling::reserve(const RsmInput& rsms, std::uint32_t authoredCount) {
    const std::uint32_t drawn = rsms.texelCount == 0 ? 0
                                : options_.count == 0 ? rsms.texels.width
                                                      : options_.count;
    const lw_subset_order order = subsetOrder(drawn + authoredCount, options_.subsets);
    // A kernel's argument must be some memory, also where none is read.
    authored_.reserve(device_, std::max(authoredCount, 1u) * sizeof(lw_vpl), "frame.vpls");
    vpls_.reserve(device_, std::size_t(order.subsets) * std::size_t(order.capacity) * sizeof(lw_vpl), "VPLs");
    if (drawn && options_.count) {
        texelSums_.reserve(device_, std::size_t(rsms.texels.width) * 4, "cumulative flux of texels");
        rowTotals_.reserve(device_, std::size_t(rsms.rowCount) * 4, "flux of RSM rows");
        rowSumsBuffer_.reserve(device_, std::size_t(rsms.rowCount) * 4, "cumulative flux of RSM rows");
        if (views_)
            candidates_.reserve(device_, std::size_t(subsetOrder(kCandidates * drawn, 1).capacity) * sizeof(lw_vpl),
                                "candidates for VPLs");
    }
    order_ = order;
}

void VplSampling::record(Executor& executor, const RsmInput& rsms, const LWVpl* authored,
                         std::uint32_t authoredCount, const VplPlan* plan) {
    reserve(rsms, authoredCount);
    static_assert(sizeof(LWVpl) == sizeof(lw_vpl), "LWVpl is uploaded as it is");
    if (authoredCount)
        executor.writeCopy("vpl_sampling.upload", authored_, 0, authoredCount * sizeof(lw_vpl), authored);
    draw(executor, rsms, vplCount() - authoredCount, plan);
}

// Of texels that are the last frame's, so are their sums.
void VplSampling::sumUp(Executor& executor, const RsmInput& rsms) {
    if (rsms.generation != 0 && summed_ == rsms.generation) return;
    const cl_int rowCount = cl_int(rsms.rowCount);
    executor.run("vpl_sampling.row_sums", rowSums_, gridOver(rsms.rowCount), {4, 1}, rsms.texels, rsms.rows, rowCount,
                 cl_int(options_.uniform ? 1 : 0), texelSums_, rowTotals_);
    executor.run("vpl_sampling.total", total_, {1, 1}, {1, 1}, rowTotals_, rowCount, rowSumsBuffer_);
    summed_ = rsms.generation;
}

void VplSampling::draw(Executor& executor, const RsmInput& rsms, std::uint32_t sampleCount,
                       const VplPlan* plan) {
    const Range slots = gridOver(std::size_t(order_.subsets) * std::size_t(order_.capacity));
    if (options_.count == 0 || sampleCount == 0) {
        // Without texels the list holds the host's VPLs alone; the texel planes are then not read.
        Planes texels = rsms.texels;
        if (!texels) texels.memory = authored_.get();
        executor.run("vpl_sampling.draw", all_, slots, kGroup, texels, cl_int(sampleCount), authored_, order_, vpls_);
        return;
    }
    const cl_int rowCount = cl_int(rsms.rowCount), uniform = options_.uniform ? 1 : 0;
    sumUp(executor, rsms);
    if (views_) return choose(executor, rsms, sampleCount);
    if (plan) {
        plan->choose(texelSums_, rowTotals_);
        executor.run("vpl_sampling.draw", drawLive_, slots, kGroup, rsms.texels, rsms.rows, rowCount,
                     texelSums_, rowSumsBuffer_, uniform, cl_int(sampleCount),
                     sampleRotation(options_.seed, turns_), authored_, order_, plan->live, vpls_);
        return;
    }
    executor.run("vpl_sampling.draw", draw_, slots, kGroup, rsms.texels, rsms.rows, rowCount, texelSums_,
                 rowSumsBuffer_, uniform, cl_int(sampleCount), sampleRotation(options_.seed, turns_), authored_, order_, vpls_);
}

void VplSampling::choose(Executor& executor, const RsmInput& rsms, std::uint32_t sampleCount) {
    const std::uint32_t count = kCandidates * sampleCount;
    const lw_subset_order order = subsetOrder(count, 1);
    executor.run("vpl_sampling.draw", draw_, gridOver(std::size_t(order.capacity)), kGroup, rsms.texels, rsms.rows,
                 cl_int(rsms.rowCount), texelSums_, rowSumsBuffer_, cl_int(0), cl_int(count),
                 sampleRotation(options_.seed, turns_), authored_, order, candidates_);
    // The choice's offset moves with the set's rotation, by numbers of its own.
    const float offset = options_.seed || turns_ ? sampleRotation(options_.seed ^ 0x5bd1e995u, turns_).s[0] : 0.5f;
    views_->record(executor, candidates_, count, sampleCount, offset, authored_, order_, vpls_);
}

Planes VplSampling::debugShape(lw_subset_order order) {
    Planes planes;
    planes.width = std::uint32_t(order.subsets * order.capacity);
    planes.height = 1;
    planes.rowStride = planes.planeStride = paddedWidth(planes.width);
    planes.count = 10;
    return planes;
}

void VplSampling::recordPlanes(Executor& executor, const Buffer& vpls, const Planes& planes) {
    executor.run("vpl_sampling.planes", planes_, gridOver(planes.width), kGroup, vpls, cl_int(planes.width),
                 planes.memory, cl_int(planes.planeStride));
}

std::uint64_t VplSampling::bytes() const {
    return texelSums_.bytes() + rowTotals_.bytes() + rowSumsBuffer_.bytes() + authored_.bytes() + vpls_.bytes() + candidates_.bytes() +
           (views_ ? views_->bytes() : 0);
}

lw_subset_order VplSampling::orderOf(const VplSamplingOptions& options, const FrameShape& shape) {
    const std::uint64_t drawn = shape.texels == 0 ? 0 : options.count ? options.count : shape.paddedTexels;
    if (drawn + shape.vplCount > std::numeric_limits<std::uint32_t>::max())
        fail(LW_ERROR_UNSUPPORTED, "vpls: ", drawn + shape.vplCount, " VPLs exceed the 32-bit indices of the kernels");
    return subsetOrder(std::uint32_t(drawn + shape.vplCount), options.subsets);
}

std::uint64_t VplSampling::estimateBytes(const VplSamplingOptions& options, const FrameShape& shape) {
    const lw_subset_order order = orderOf(options, shape);
    const std::uint64_t list = std::uint64_t(order.subsets) * std::uint64_t(order.capacity) * sizeof(lw_vpl);
    const std::uint64_t sums = shape.texels && options.count ? shape.paddedTexels * 4 + shape.rows * 8 : 0;
    std::uint64_t views = 0;
    if (options.view) {
        const std::uint64_t candidates = shape.texels ? std::uint64_t(kCandidates) * options.count : 0;
        views = (candidates + (candidates & 1)) * sizeof(lw_vpl) + VplViewSampling::estimateBytes(candidates, shape);
    }
    return list + std::max(shape.vplCount, 1u) * sizeof(lw_vpl) + sums + views;
}

}  // namespace lightwell
