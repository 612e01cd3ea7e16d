#include "techniques/static_vpl_view.h"

#include "compute/device.h"
#include "inputs/image_check.h"

namespace lightwell {
namespace {

// Planes of ours as a host would hand them over, to be used in place.
LWImage imageOf(const Planes& planes) {
    LWImage image{};
    image.clMem = planes.memory;
    image.format = planes.count == 1 ? LW_FORMAT_FLOAT1 : LW_FORMAT_PLANAR_FLOAT3;
    image.width = planes.width;
    image.height = planes.height;
    image.byteOffset = std::uint64_t(planes.offset) * sizeof(float);
    image.byteRowStride = planes.rowStride * std::int64_t(sizeof(float));
    image.bytePlaneStride = planes.planeStride * std::int64_t(sizeof(float));
    return image;
}

}  // namespace

StaticVplView::Baked::Baked(Device& device, const InterleavedOptions& options, const View& owner)
    : split(device), view(device, options, owner) {
    for (int i = 0; i < 2; ++i) {
        normals[i] = PlanarImage(device, owner.maxWidth, owner.maxHeight, 3, "normals by receivers");
        irradiance[i] =
            PlanarImage(device, owner.maxWidth, owner.maxHeight, 3, "irradiance by receivers");
        validity[i] = PlanarImage(device, owner.maxWidth, owner.maxHeight, 1, "validity by receivers");
    }
}

StaticVplView::StaticVplView(Device& device, const InterleavedOptions& options, const View& view)
    : device_(device), options_(options), whole_(device, options, view) {}

void StaticVplView::gatherOf(Executor& executor, InterleavedView& state, const View& view,
                             const LWGBuffer& gbuffer, const LWOutput& output,
                             const StaticVplPasses& passes, int list) {
    const Buffer& vpls = passes.vpls(list);
    const lw_subset_order order = passes.order();
    state.render(executor, view, gbuffer, output, {passes.gather, passes.bilateral, nullptr},
                 [&](const Planes& position, const Planes& normal, const Planes& irradiance) {
                     const Buffer& masks =
                         state.cull(executor, passes.gather, position, normal, vpls, order);
                     if (passes.shadows)
                         return passes.shadows->recordGather(executor, list, position, normal, masks,
                                                             irradiance, state.counts());
                     passes.gather.recordGather(executor, position, normal, vpls, order, masks,
                                                irradiance, state.counts());
                 });
}

void StaticVplView::render(Executor& executor, const View& view, const LWGBuffer& gbuffer,
                           const LWOutput& output, const StaticVplPasses& passes) {
    if (passes.list.lists() == 1 || imageAbsent(gbuffer.bakedMask)) {
        gatherOf(executor, whole_, view, gbuffer, output, passes, 0);
        return;
    }
    GBufferInput::check(device_, view, gbuffer, kNeedsBakedMask, "gbuffer");
    if (!baked_) baked_.emplace(device_, options_, view);
    Baked& both = *baked_;
    both.gbuffer.import(executor, view, gbuffer, kNeedsBakedMask, "gbuffer");
    const Planes mask = both.gbuffer.bakedMask;
    const auto planes = [&](PlanarImage(&images)[2], int i) {
        return images[i].planes(view.width, view.height);
    };
    both.split.recordNormals(executor, both.gbuffer.normal, mask, planes(both.normals, 0),
                             planes(both.normals, 1));
    const Planes irradiance =
        both.irradianceOut.begin(executor, view, output.irradiance, 3, "output.irradiance");
    const Planes validity =
        both.validityOut.begin(executor, view, output.validity, 1, "output.validity");
    for (int i = 0; i < 2; ++i) {
        LWGBuffer part = gbuffer;
        part.depth = LWImage{};
        part.position = imageOf(both.gbuffer.position);
        part.normal = imageOf(planes(both.normals, i));
        LWOutput light = output;
        if (irradiance) light.irradiance = imageOf(planes(both.irradiance, i));
        if (validity) light.validity = imageOf(planes(both.validity, i));
        gatherOf(executor, i ? both.view : whole_, view, part, light, passes, i);
    }
    if (irradiance)
        both.split.recordJoin(executor, mask, planes(both.irradiance, 0), planes(both.irradiance, 1),
                              irradiance);
    if (validity)
        both.split.recordJoin(executor, mask, planes(both.validity, 0), planes(both.validity, 1),
                              validity);
    both.irradianceOut.end(executor);
    both.validityOut.end(executor);
}

void StaticVplView::startFrame(bool forget) {
    whole_.startFrame(forget);
    if (baked_) baked_->view.startFrame(forget);
}

void StaticVplView::report(Report& report, lw_subset_order order) const {
    whole_.report(device_, report, order);
    if (!baked_) return;
    baked_->view.report(device_, report, order);
    baked_->gbuffer.report(report);
    baked_->irradianceOut.report(report);
}

std::uint64_t StaticVplView::bytes() const {
    std::uint64_t total = whole_.bytes();
    if (!baked_) return total;
    total += baked_->gbuffer.bytes() + baked_->view.bytes() + baked_->irradianceOut.bytes() +
             baked_->validityOut.bytes();
    for (int i = 0; i < 2; ++i)
        total +=
            baked_->normals[i].bytes() + baked_->irradiance[i].bytes() + baked_->validity[i].bytes();
    return total;
}

std::uint64_t StaticVplView::estimateBytes(const InterleavedOptions& options, const LWViewDesc& view,
                                           const FrameShape& shape, lw_subset_order order) {
    const std::uint64_t one = InterleavedView::estimateBytes(options, view, shape.uploads, order);
    if (!shape.bakedReceivers) return one;
    const std::uint64_t images =
        std::uint64_t(2 * (3 + 3 + 1)) * paddedWidth(view.maxWidth) * view.maxHeight * sizeof(float);
    return 2 * one + images + GBufferInput::estimateBytes(view, kNeedsBakedMask, shape.uploads) +
           OutputTarget::estimateBytes(view, 3, shape.uploads) +
           OutputTarget::estimateBytes(view, 1, shape.uploads);
}

}  // namespace lightwell
