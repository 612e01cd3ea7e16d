#include "passes/temporal_history.h"

#include <cstring>
#include <limits>
#include <string>

#include "compute/device.h"
#include "compute/error.h"

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

// All planes of a row lie side by side, a cache line apart: planes of a whole picture often lie a multiple of 4096 bytes apart
// (1280 x 720 does), and thirty of them then contend for the same few places of the first-level cache.
std::uint64_t planeStride(std::uint32_t width) { return paddedWidth(width) + 16u; }

std::uint64_t imageFloats(const TemporalHistoryOptions& options, std::uint32_t maxWidth, std::uint32_t maxHeight) {
    const std::uint64_t floats = planeStride(maxWidth) * maxHeight * planesOf(options);
    if (floats > std::uint64_t(std::numeric_limits<std::int32_t>::max()))
        fail(LW_ERROR_UNSUPPORTED, "history: a view of ", maxWidth, " x ", maxHeight,
             " pixels exceeds the 32-bit indices of the kernels; expected history=0 or a smaller view");
    return floats;
}

// `row` of a matrix over X, as one over X - origin.
glm::dvec4 relativeTo(const glm::dvec3& origin, const glm::dvec4& row) {
    return {glm::dvec3(row), glm::dot(glm::dvec3(row), origin) + row.w};
}

lw_float4 rounded(const glm::dvec4& v) { return float4(v.x, v.y, v.z, v.w); }
lw_float4 rounded(const glm::dvec3& v) { return float4(v.x, v.y, v.z, 0.0); }

// From this frame's pixels to the places of their surfaces in a history of width x height that `camera` drew.
LwReprojection reprojection(const Camera& camera, std::uint32_t width, std::uint32_t height, const Planes& now) {
    const glm::dmat4 m = glm::transpose(camera.worldToClip());  // its columns are the rows
    const glm::dvec4 x = (m[0] + m[3]) * (0.5 * width), y = (m[3] - m[1]) * (0.5 * height);
    // As the kernel takes it off: far from the world's origin the eye would be off by parts of a pixel, all of one picture alike.
    const glm::dvec3 origin(glm::vec3(camera.eye()));
    LwReprojection result{};
    result.x = rounded(relativeTo(origin, x));
    result.y = rounded(relativeTo(origin, y));
    result.w = rounded(relativeTo(origin, m[3]));
    result.depth = camera.perspective() ? rounded(camera.axis()) : float4(0.0, 0.0, 0.0, 1.0);
    result.acrossX = rounded(camera.rays().perI);
    result.acrossY = rounded(camera.rays().perJ);
    result.origin = rounded(glm::dvec4(origin, camera.footprint(1.0)));
    result.scaleX = float(double(width) / now.width);
    result.scaleY = float(double(height) / now.height);
    result.width = cl_int(width);
    result.height = cl_int(height);
    return result;
}

}  // namespace

ViewHistory::ViewHistory(Device& device, const TemporalHistoryOptions& options, std::uint32_t maxWidth, std::uint32_t maxHeight)
    : planes_(planesOf(options)), counts_(device, kCountBytes, "counts of a history") {
    const std::size_t bytes = sizeof(float) * std::size_t(imageFloats(options, maxWidth, maxHeight));
    for (Buffer& image : images_) image = Buffer(device, bytes, "temporal history");
}

Planes ViewHistory::planes(std::size_t which, std::uint32_t width, std::uint32_t height) const {
    Planes planes;
    planes.memory = images_[which].get();
    planes.planeStride = std::int64_t(planeStride(width));
    planes.rowStride = planes.planeStride * planes_;
    planes.width = width;
    planes.height = height;
    planes.count = planes_;
    return planes;
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
        mode = moves ? LW_HISTORY_MOTION : drawn.isOf(camera, now.width, now.height) ? LW_HISTORY_STILL : LW_HISTORY_REPROJECT;
        where = reprojection(*drawn.camera, drawn.width, drawn.height, now);
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
    view.drawn_[next] = {now.width, now.height, camera, std::move(own)};
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
