// The order of the checks, and the overlay. A buffer that fails against itself is not held against
// others, so that one mistake gives one finding.
#include "inputs/input_check.h"

#include <algorithm>
#include <cmath>

#include "compute/device.h"
#include "inputs/gbuffer_input.h"
#include "inputs/input_check_parts.h"
#include "inputs/output_target.h"
#include "inputs/rsm_input.h"

namespace lightwell {
namespace {

void refuseBadImages(Device& device, const LWFrame* frame, const std::vector<CheckedView>& views,
                     const LWImage* overlay) {
    if (frame) RsmInput::check(device, *frame);
    for (const CheckedView& view : views) {
        const LWGBuffer& g = *view.gbuffer;
        std::uint32_t needs = 0;
        if (!imageAbsent(g.albedo)) needs |= kNeedsAlbedo;
        if (!imageAbsent(g.directRadiance)) needs |= kNeedsDirectRadiance;
        if (!imageAbsent(g.roughness)) needs |= kNeedsRoughness;
        if (!imageAbsent(g.motion)) needs |= kNeedsMotion;
        if (!imageAbsent(g.receiveMask)) needs |= kNeedsReceiveMask;
        GBufferInput::check(device, *view.view, g, needs, view.name);
    }
    if (overlay) OutputTarget::check(device, *views[0].view, *overlay, 3, "overlay");
}

std::vector<LightMaps> readLights(Executor& executor, const LWFrame* frame) {
    std::vector<LightMaps> lights;
    for (std::uint32_t l = 0; frame && l < frame->lightCount; ++l) {
        const LWLight& light = frame->lights[l];
        LightMaps maps{&light, "frame.lights[" + std::to_string(l) + "]", {}};
        for (std::uint32_t r = 0; r < light.rsmCount; ++r)
            maps.maps.push_back(
                readRsm(executor, light, light.rsms[r], maps.name + ".rsms[" + std::to_string(r) + "]"));
        lights.push_back(std::move(maps));
    }
    return lights;
}

// Grey by the angle to the viewer, or to the vertical without a camera.
float shadeOf(const Surfaces& g, std::uint32_t x, std::uint32_t y) {
    if (!g.surface(x, y)) return 0.02f;
    const glm::dvec3 towards = g.towardsEye(g.position.triple(x, y));
    const double cosine =
        glm::dot(g.unitNormal(x, y), towards == glm::dvec3(0.0) ? glm::dvec3(0, 1, 0) : towards);
    return float(0.08 + 0.25 * std::abs(cosine));
}

void drawOverlay(Executor& executor, const View& view, const Surfaces& g,
                 const std::vector<Found>& found, const LWImage& image) {
    HostPlanes colours(g.width, g.height, 3);
    for (std::uint32_t y = 0; y < g.height; ++y)
        for (std::uint32_t x = 0; x < g.width; ++x)
            for (std::uint32_t c = 0; c < 3; ++c) colours.at(x, y, c) = shadeOf(g, x, y);
    // The most severe last, on top.
    for (auto f = found.rbegin(); f != found.rend(); ++f)
        for (const std::uint32_t pixel : f->pixels) {
            const std::uint32_t left = pixel % g.width / f->step * f->step,
                                top = pixel / g.width / f->step * f->step;
            for (std::uint32_t y = top; y < std::min(g.height, top + f->step); ++y)
                for (std::uint32_t x = left; x < std::min(g.width, left + f->step); ++x)
                    for (std::uint32_t c = 0; c < 3; ++c)
                        colours.at(x, y, c) = 0.25f * shadeOf(g, x, y) + 0.75f * f->finding.colour[c];
        }
    const Buffer source(executor.device(), colours.bytes(), "the overlay");
    executor.writeCopy("input_check.overlay", source, 0, colours.bytes(), colours.values().data());
    OutputTarget target;
    const Planes to = target.begin(executor, view, image, 3, "overlay");
    const std::size_t rowBytes = g.width * sizeof(float), stride = paddedWidth(g.width);
    for (std::uint32_t plane = 0; plane < 3; ++plane)
        for (std::uint32_t y = 0; y < g.height; ++y) {
            const std::size_t from = (std::size_t(plane) * g.height + y) * stride;
            const std::int64_t at =
                to.offset + std::int64_t(plane) * to.planeStride + std::int64_t(y) * to.rowStride;
            executor.copy("input_check.overlay", source.get(), to.memory, from * sizeof(float),
                          std::size_t(at) * sizeof(float), rowBytes);
        }
    target.end(executor);
    executor.device().finish();
}

}  // namespace

std::vector<LWInputFinding> checkInputs(Executor& executor, const LWFrame* frame,
                                        const std::vector<CheckedView>& views, const LWImage* overlay) {
    refuseBadImages(executor.device(), frame, views, overlay);
    Findings findings;
    std::vector<Surfaces> buffers;
    buffers.reserve(views.size());
    for (const CheckedView& view : views)
        buffers.push_back(
            readGBuffer(executor, *view.gbuffer, view.view->width, view.view->height, view.name));
    std::vector<LightMaps> lights = readLights(executor, frame);

    std::vector<NamedCamera> cameras;
    for (Surfaces& g : buffers) {
        checkValues(g, findings);
        checkPlaces(g, {}, findings);
        checkNormals(g, {}, findings);
        checkMotion(g, findings);
        if (g.camera) cameras.push_back({g.name + ".camera", &*g.camera});
    }
    for (LightMaps& light : lights) {
        for (Surfaces& map : light.maps) {
            checkValues(map, findings);
            checkPlaces(map, cameras, findings);
            checkNormals(map, cameras, findings);
        }
        for (const Surfaces& g : buffers) checkSpaces(g, light, findings);
        checkFlux(buffers.empty() ? nullptr : &buffers[0], light, findings);
    }
    for (const Surfaces& g : buffers) checkDirect(g, lights, findings);

    std::vector<Found> found = findings.takeSorted();
    if (overlay) drawOverlay(executor, *views[0].view, buffers[0], found, *overlay);
    std::vector<LWInputFinding> result;
    for (const Found& f : found) result.push_back(f.finding);
    return result;
}

}  // namespace lightwell
