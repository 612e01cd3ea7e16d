#include "passes/temporal_history.h"

#include <cstring>
#include <limits>
#include <string>

#include "compute/device.h"
#include "compute/error.h"
#include "passes/reprojection.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "temporal_history/temporal_history";
constexpr std::size_t kCountBytes = sizeof(cl_int);

Range groupOf(const Kernel& kernel) { return kernel.width() == 1 ? Range{64, 1} : Range{8, 1}; }

Range itemsOver(const Planes& image, const Kernel& kernel) {
    return {(image.width + kernel.width() - 1) / kernel.width(), image.height};
}

// Irradiance with its recent mean, noise and trend, each scalar with its own, position, a word of normal and age.
std::uint32_t planesOf(const TemporalHistoryOptions& options) { return 6 + 4 * options.scalars + 4; }

std::uint64_t imageFloats(const TemporalHistoryOptions& options, std::uint32_t maxWidth, std::uint32_t maxHeight) {
    const std::uint64_t floats = historyPlaneStride(maxWidth) * maxHeight * planesOf(options);
    if (floats > std::uint64_t(std::numeric_limits<std::int32_t>::max()))
        fail(LW_ERROR_UNSUPPORTED, "history: a view of ", maxWidth, " x ", maxHeight,
             " pixels exceeds the 32-bit indices of the kernels; expected history=0 or a smaller view");
    return floats;
}

}  // namespace

ViewHistory::ViewHistory(Device& device, const TemporalHistoryOptions& options, std::uint32_t maxWidth, std::uint32_t maxHeight)
    : planes_(planesOf(options)), counts_(device, kCountBytes, "counts of a history") {
    const std::size_t bytes = sizeof(float) * std::size_t(imageFloats(options, maxWidth, maxHeight));
    for (Buffer& image : images_) image = Buffer(device, bytes, "temporal history");
}

Planes ViewHistory::planes(std::size_t which, std::uint32_t width, std::uint32_t height) const {
    return historyPlanes(images_[which], width, height, planes_);
}

bool ViewHistory::Drawn::isOf(const LWCamera& from, std::uint32_t w, std::uint32_t h) const {
    return camera && width == w && height == h && std::memcmp(&matrices, &from, sizeof from) == 0;
}

void ViewHistory::startFrame(bool forget) {
    if (forget) this->forget();
    isDrawn_ = false;
    if (updates_ < std::numeric_limits<std::uint32_t>::max()) ++updates_;
}

void ViewHistory::forget() {
    for (Drawn& drawn : drawn_) drawn.camera.reset();
}

void ViewHistory::report(Device& device, Report& report) const {
    if (drawn_[last_].width) report.read(device, "history_new", counts_, 0);
}

std::uint64_t ViewHistory::estimateBytes(const TemporalHistoryOptions& options, std::uint32_t maxWidth, std::uint32_t maxHeight) {
    return 2 * sizeof(float) * imageFloats(options, maxWidth, maxHeight) + kCountBytes;
}

TemporalHistory::TemporalHistory(Device& device, const TemporalHistoryOptions& options)
    : options_(options),
      blend_(device.programs().kernel(kProgram, "temporal_history_blend", {{"LW_SCALARS", std::to_string(options.scalars)}})),
      age_(device.programs().kernel(kProgram, "temporal_history_age", {{"LW_SCALARS", std::to_string(options.scalars)}})) {}

void TemporalHistory::checkCamera(const LWGBuffer& gbuffer, std::uint32_t width, std::uint32_t height) {
    Camera(gbuffer.camera, width, height, "gbuffer.camera");
}

void TemporalHistory::record(Executor& executor, const HistoryFrame& frame, const LWCamera& camera, ViewHistory& view) {
    const Planes& now = frame.position;
    const WorldOrigin& origin = executor.worldOrigin();
    Camera own(camera, now.width, now.height, "gbuffer.camera");
    // The same picture once more in an update, such as after an lwRender that failed late, takes the place of the first: counted
    // twice, its samples would outweigh those of other frames.
    const bool again = view.isDrawn_ && view.drawn_[view.last_].isOf(camera, now.width, now.height);
    const std::size_t next = again ? view.last_ : 1 - view.last_;
    const std::uint32_t lead = again ? view.lead_ : view.updates_;
    const ViewHistory::Drawn& drawn = view.drawn_[1 - next];
    cl_int mode = LW_HISTORY_NONE;
    LwReprojection where = reprojection(own, now.width, now.height, now);
    if (drawn.camera) {
        // Motion vectors lead one frame back: across more, and within one, a view goes by its cameras.
        const bool moves = frame.motion && lead == 1;
        mode = moves ? LW_HISTORY_MOTION : drawn.origin == origin && drawn.isOf(camera, now.width, now.height) ? LW_HISTORY_STILL : LW_HISTORY_REPROJECT;
        where = reprojection(*drawn.camera, drawn.width, drawn.height, now, drawn.origin, origin);
    }
    const Planes before = view.planes(1 - next, std::uint32_t(where.width), std::uint32_t(where.height));
    const Planes after = view.planes(next, now.width, now.height);
    // A kernel's argument must be some memory, also where none is read or written.
    const Planes& motion = frame.motion ? frame.motion : now;
    const Planes& first = options_.scalars > 0 ? frame.first : after;
    const Planes& second = options_.scalars > 1 ? frame.second : after;
    executor.fill("temporal_history.counts", view.counts_, 0, 0, kCountBytes);
    executor.run("temporal_history.blend", blend_, itemsOver(now, blend_), groupOf(blend_), now, frame.normal, cl_int(now.width),
                 cl_int(now.height), frame.current, motion, mode, where, cl_float(options_.frames), cl_float(options_.clamp),
                 before, after, frame.irradiance, first, second, view.counts_);
    view.drawn_[next] = {now.width, now.height, camera, std::move(own), origin};
    view.last_ = next;
    view.isDrawn_ = true;
    view.lead_ = lead;
    view.updates_ = 0;
}

Planes TemporalHistory::ageShape(const ViewHistory& view) const {
    Planes planes;
    const ViewHistory::Drawn& drawn = view.drawn_[view.last_];
    if (!drawn.camera) return planes;
    planes.width = drawn.width;
    planes.height = drawn.height;
    planes.rowStride = paddedWidth(planes.width);
    planes.planeStride = planes.rowStride * planes.height;
    planes.count = 1;
    return planes;
}

void TemporalHistory::recordAge(Executor& executor, const ViewHistory& view, const Planes& planes) {
    executor.run("temporal_history.age", age_, itemsOver(planes, age_), groupOf(age_),
                 view.planes(view.last_, planes.width, planes.height), cl_int(planes.width), cl_int(planes.height), planes);
}

}  // namespace lightwell
