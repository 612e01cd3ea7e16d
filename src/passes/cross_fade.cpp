#include "passes/cross_fade.h"

#include <cstring>
#include <iterator>
#include <limits>
#include <utility>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/image_access.h"
#include "passes/reprojection.h"

namespace lightwell {
namespace {

constexpr std::uint32_t kPlanes = 3 + 1 + 3 + 1;  // irradiance, validity, position, a word
constexpr std::size_t kCountBytes = sizeof(cl_int);
// A place between pixels is rounded to one of them, from frame to frame by another of these: a slow pan takes the old light with it in
// the mean, where always the nearest would leave it behind. None is near 0 or 1, so that rounding of places moves nothing at rest.
constexpr float kRoundings[] = {0.5f, 0.25f, 0.75f, 0.125f, 0.625f, 0.375f, 0.875f};

std::uint64_t imageFloats(std::uint32_t maxWidth, std::uint32_t maxHeight) {
    const std::uint64_t floats = historyPlaneStride(maxWidth) * maxHeight * kPlanes;
    if (floats > std::uint64_t(std::numeric_limits<std::int32_t>::max()))
        fail(LW_ERROR_UNSUPPORTED, "fade: a view of ", maxWidth, " x ", maxHeight,
             " pixels exceeds the 32-bit indices of the kernels; expected fade=0 or a smaller view");
    return floats;
}

}  // namespace

FadedView::FadedView(Device& device, std::uint32_t maxWidth, std::uint32_t maxHeight) : counts_(device, kCountBytes, "counts of a fade") {
    const std::size_t bytes = sizeof(float) * std::size_t(imageFloats(maxWidth, maxHeight));
    for (Buffer& image : images_) image = Buffer(device, bytes, "last picture of a view");
}

Planes FadedView::planes(std::size_t which, std::uint32_t width, std::uint32_t height) const {
    return historyPlanes(images_[which], width, height, kPlanes);
}

void FadedView::startFrame(bool forget) {
    if (forget) this->forget();
    isDrawn_ = false;
    if (updates_ < std::numeric_limits<std::uint32_t>::max()) ++updates_;
}

void FadedView::forget() {
    for (Drawn& drawn : drawn_) drawn.camera.reset();
}

void FadedView::report(Device& device, Report& report) const {
    if (drawn_[last_].camera) report.read(device, "fade_new", counts_, 0);
}

std::uint64_t FadedView::estimateBytes(std::uint32_t maxWidth, std::uint32_t maxHeight) {
    return 2 * sizeof(float) * imageFloats(maxWidth, maxHeight) + kCountBytes;
}

CrossFade::CrossFade(Device& device) : mix_(device.programs().kernel("cross_fade/cross_fade", "cross_fade_mix")) {}

void CrossFade::record(Executor& executor, const FadeFrame& frame, const LWCamera& camera, float share, FadedView& view) {
    const Planes& now = frame.position;
    const WorldOrigin& origin = executor.worldOrigin();
    Camera own(camera, now.width, now.height, "gbuffer.camera");
    const bool hasIrradiance = bool(frame.irradiance), hasValidity = bool(frame.validity);
    // A picture that is drawn again in an update takes the place of the first, and begins from the same one.
    const std::size_t next = view.isDrawn_ ? view.last_ : 1 - view.last_;
    const std::uint32_t lead = view.isDrawn_ ? view.lead_ : view.updates_;
    if (!view.isDrawn_) ++view.records_;
    const FadedView::Drawn& drawn = view.drawn_[1 - next];
    cl_int mode = LW_HISTORY_NONE;
    LwReprojection where = reprojection(own, now.width, now.height, now);
    // With nothing of the last picture in it there is no need to look that up.
    if (share < 1.0f && drawn.camera && drawn.hasIrradiance == hasIrradiance && drawn.hasValidity == hasValidity) {
        const bool isStill = drawn.origin == origin && drawn.width == now.width && drawn.height == now.height &&
                             std::memcmp(&drawn.matrices, &camera, sizeof camera) == 0;
        // Motion vectors lead one frame back: across more, and within one, a view goes by its cameras.
        mode = frame.motion && lead == 1 ? LW_HISTORY_MOTION : isStill ? LW_HISTORY_STILL : LW_HISTORY_REPROJECT;
        where = reprojection(*drawn.camera, drawn.width, drawn.height, now, drawn.origin, origin);
    }
    const Planes before = view.planes(1 - next, std::uint32_t(where.width), std::uint32_t(where.height));
    const Planes after = view.planes(next, now.width, now.height);
    // A kernel's argument must be some memory, also where none is read or written.
    const auto given = [&](const Planes& planes) -> const Planes& { return planes ? planes : now; };
    const auto written = [&](const Planes& planes) -> const Planes& { return planes ? planes : after; };
    executor.fill("cross_fade.counts", view.counts_, 0, 0, kCountBytes);
    executor.run("cross_fade.mix", mix_, rowGrid(executor.device(), now.width, now.height), rowGroup(executor.device()), now, frame.normal,
                 cl_int(now.width), cl_int(now.height), given(frame.irradiance), given(frame.validity), cl_int(hasIrradiance ? 1 : 0),
                 cl_int(hasValidity ? 1 : 0), given(frame.motion), mode, where, cl_float(share), cl_float(kRoundings[view.records_ % std::size(kRoundings)]), before, after,
                 written(frame.shownIrradiance), written(frame.shownValidity), view.counts_);
    view.drawn_[next] = {now.width, now.height, hasIrradiance, hasValidity, camera, std::move(own), origin};
    view.last_ = next;
    view.isDrawn_ = true;
    view.lead_ = lead;
    view.updates_ = 0;
}

}  // namespace lightwell
