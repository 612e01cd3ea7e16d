#include "inputs/screen_surfels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/glm.hpp>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/camera.h"
#include "inputs/image_access.h"
#include "inputs/input_light.h"
#include "inputs/source_view.h"

namespace lightwell {
namespace {

constexpr char kProgram[] = "surfel_input/surfel_input";

std::uint32_t needsOf(const LWGBuffer& gbuffer) { return imageAbsent(gbuffer.albedo) ? 0u : std::uint32_t(kNeedsAlbedo); }

lw_surfel_light lightOf(const LWLight& light) {
    lw_surfel_light l{};
    const glm::dvec3 sent = emitted(light), axis(light.direction[0], light.direction[1], light.direction[2]);
    l.emitted = float4(sent.x, sent.y, sent.z, 0.0);
    l.coneOffset = 1.0f;
    if (light.kind != LW_LIGHT_SPOT || !(glm::length(axis) > 0.0)) return l;
    const glm::dvec3 unit = axis / glm::length(axis);
    l.axis = float4(unit.x, unit.y, unit.z, 0.0);
    // KHR_lights_punctual, as coneFalloff of input_light.cpp has it.
    const double inner = std::cos(double(light.innerConeAngle)), outer = std::cos(double(light.outerConeAngle));
    const double scale = 1.0 / std::max(1e-3, inner - outer);
    l.coneScale = float(scale);
    l.coneOffset = float(-outer * scale);
    return l;
}

}  // namespace

void ScreenSurfels::check(Device& device, const LWFrame& frame) {
    for (std::uint32_t i = 0; i < frame.sourceViewCount; ++i) {
        const LWGBuffer& gbuffer = *frame.sourceViews[i].gbuffer;
        GBufferInput::check(device, sourceViewOf(frame, i), gbuffer, needsOf(gbuffer), sourceViewName(i).c_str());
    }
}

void ScreenSurfels::import(Executor& executor, const LWFrame& frame, const RsmInput& rsms) {
    Device& device = executor.device();
    check(device, frame);
    std::uint64_t count = rsms.texels.width;
    for (std::uint32_t i = 0; i < frame.sourceViewCount; ++i) {
        const LWImage& image = frame.sourceViews[i].gbuffer->normal;
        count += std::uint64_t(paddedWidth(image.width)) * image.height;
    }
    if (count > std::numeric_limits<std::int32_t>::max())
        fail(LW_ERROR_UNSUPPORTED, "frame: ", count, " texels and pixels exceed the 32-bit indices of the kernels");
    memory_.reset(executor, std::uint32_t(count), LW_SURFEL_PLANES);
    views_.resize(frame.sourceViewCount);
    device_ = &device;
    if (count) {
        // The last block's padding, if any: drivers may refuse to fill nothing. Everything else is written.
        const Planes& planes = memory_.planes();
        if (planes.width > count)
            executor.fill("surfel_input.clear", memory_.memory(), 0,
                          (LW_SURFEL_RADIUS * std::size_t(planes.planeStride) + count) * sizeof(float),
                          (planes.width - std::size_t(count)) * sizeof(float));
        drawTexels(executor, frame, rsms);
        std::uint32_t first = rsms.texels.width;
        for (std::uint32_t i = 0; i < frame.sourceViewCount; ++i) {
            const LWGBuffer& gbuffer = *frame.sourceViews[i].gbuffer;
            views_[i].import(executor, sourceViewOf(frame, i), gbuffer, needsOf(gbuffer), sourceViewName(i).c_str());
            drawPixels(executor, views_[i], needsOf(gbuffer) != 0, first);
            first += paddedWidth(gbuffer.normal.width) * gbuffer.normal.height;
        }
    }
    memory_.measure(executor);
    memory_.noteChange();
}

void ScreenSurfels::drawTexels(Executor& executor, const LWFrame& frame, const RsmInput& rsms) {
    Device& device = executor.device();
    Kernel& kernel = device.programs().kernel(kProgram, "surfel_input_rsm");
    for (std::size_t i = 0; i < rsms.spans.size(); ++i) {
        const RsmSpan& span = rsms.spans[i];
        executor.run("surfel_input.rsm", kernel, rowGrid(device, span.width, span.height), rowGroup(device),
                     rsms.texels.memory, cl_int(rsms.texels.planeStride), rsms.shapes[i], lightOf(frame.lights[span.light]),
                     memory_.planes().memory, cl_int(memory_.planes().planeStride), cl_int(span.firstTexel));
    }
}

void ScreenSurfels::drawPixels(Executor& executor, const GBufferInput& pixels, bool hasAlbedo, std::uint32_t first) {
    Device& device = executor.device();
    Kernel& kernel = device.programs().kernel(kProgram, "surfel_input_view");
    const std::uint32_t width = pixels.normal.width, height = pixels.normal.height;
    executor.run("surfel_input.view", kernel, rowGrid(device, width, height), rowGroup(device), pixels.position,
                 pixels.normal, hasAlbedo ? pixels.albedo : pixels.normal, cl_int(hasAlbedo ? 1 : 0), cl_int(width),
                 cl_int(height), memory_.planes().memory, cl_int(memory_.planes().planeStride), cl_int(first),
                 memory_.counters());
}

void ScreenSurfels::report(Report& report) const {
    report.counts.push_back({"surfels", memory_.set().count});
    report.counts.push_back({"rejected_surfels", 0});
    if (device_) report.read(*device_, "rejected_surfels", memory_.counters(), LW_SURFEL_REJECTED * sizeof(cl_uint));
}

std::uint64_t ScreenSurfels::bytes() const {
    std::uint64_t total = memory_.bytes();
    for (const GBufferInput& view : views_) total += view.bytes();
    return total;
}

std::uint64_t ScreenSurfels::estimateBytes(const FrameShape& shape) {
    std::uint64_t total = SurfelMemory::estimateBytes(shape.paddedTexels + shape.sourcePixels, LW_SURFEL_PLANES);
    // Positions, normals and albedo unpacked, and copied where memory is not shared.
    const std::uint64_t packed =
        largestPixelBytes(kPositionRole) + largestPixelBytes(kNormalRole) + largestPixelBytes(kAlbedoRole);
    total += shape.sourcePixels * (9 * sizeof(float) + (shape.uploads ? packed : 0));
    return total;
}

}  // namespace lightwell
