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

LightMaps readLight(Executor& executor, const LWLight& light, std::uint32_t index) {
    LightMaps maps{&light, "frame.lights[" + std::to_string(index) + "]", {}};
    for (std::uint32_t r = 0; r < light.rsmCount; ++r)
        maps.maps.push_back(
            readRsm(executor, light, light.rsms[r], maps.name + ".rsms[" + std::to_string(r) + "]"));
    return maps;
}

void checkView(Surfaces& g, bool reset, Findings& findings) {
    checkValues(g, findings);
    if (checkFar(g, &findings)) return;  // what follows would judge roundings
    checkPlaces(g, {}, findings);
    const bool placed = g.trusted;  // wrong normals leave places right
    checkNormals(g, {}, findings);
    if (g.depth ? g.trusted : placed) checkMissingNormals(g, findings);
    if (!reset) checkMotion(g, findings);  // across a cut, motion means nothing
}

void checkLight(std::vector<Surfaces>& views, LightMaps& light, Findings& findings) {
    std::vector<NamedCamera> cameras;
    for (const Surfaces& g : views)
        if (g.camera) cameras.push_back({g.name + ".camera", &*g.camera});
    for (Surfaces& map : light.maps) {
        checkValues(map, findings);
        if (checkFar(map, views.empty() ? &findings : nullptr)) continue;
        checkPlaces(map, cameras, findings);
        checkNormals(map, cameras, findings);
    }
    checkLightCamera(light, findings);
    for (Surfaces& g : views) checkSpaces(g, light, findings);
    checkFlux(views.empty() ? nullptr : &views[0], light, findings);
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
    if (overlay) buffers[0].shown = true;
    for (Surfaces& g : buffers) checkView(g, frame && frame->reset, findings);
    // One light's maps at a time: a frame may have more of them than fit into memory as floats.
    for (std::uint32_t l = 0; frame && l < frame->lightCount; ++l) {
        LightMaps light = readLight(executor, frame->lights[l], l);
        checkLight(buffers, light, findings);
    }
    for (const Surfaces& g : buffers)
        if (frame) checkDirect(g, frame->lights, frame->lightCount, findings);

    std::vector<Found> found = findings.takeSorted();
    if (overlay) drawOverlay(executor, *views[0].view, buffers[0], found, *overlay);
    std::vector<LWInputFinding> result;
    for (const Found& f : found) result.push_back(f.finding);
    return result;
}

}  // namespace lightwell
