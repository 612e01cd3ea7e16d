// Entry points: estimates of memory.
#include <cmath>
#include <string>

#include "api/call.h"
#include "api/frame_arguments.h"
#include "api/parameters.h"
#include "api/structs.h"

using namespace lightwell;

namespace {

constexpr std::uint32_t kMaxSide = 16384;  // of views and RSMs

std::uint64_t estimateWith(const TechniqueEntry& entry, const std::vector<std::uint64_t>& descriptor,
                           const std::vector<std::shared_ptr<TechniqueObject>>& parts, const LWViewDesc& view,
                           const FrameShape& shape) {
    std::uint64_t total = entry.estimateBytes(descriptor.data(), view, shape);
    for (const auto& part : parts) total += estimateWith(*part->entry, part->descriptor, part->parts, view, shape);
    return total;
}

void estimate(Call& call, const char* name, const void* desc, const LWViewDesc* view, FrameShape shape,
              std::uint64_t* bytes) {
    if (!bytes) fail(LW_ERROR_INVALID_ARGUMENT, "bytes: expected an address, got null");
    const TechniqueEntry& entry = findTechniqueEntry(name);
    const auto descriptor = readDescriptor(entry, desc);
    const LWViewDesc own = readStruct(view, "view");
    if (own.maxWidth == 0 || own.maxHeight == 0 || own.maxWidth > kMaxSide || own.maxHeight > kMaxSide)
        fail(LW_ERROR_INVALID_ARGUMENT, "view: expected 1 .. ", kMaxSide, " pixels a side, got ",
             own.maxWidth, " x ", own.maxHeight);
    shape.uploads = !call.owner()->device.unifiedMemory();
    *bytes = estimateWith(entry, descriptor, partsOf(call, entry, descriptor), own, shape);
}

bool forAllReceivers(std::uint32_t receivers) {
    return receivers == LW_RECEIVERS_ALL || receivers == (LW_RECEIVERS_UNBAKED | LW_RECEIVERS_BAKED);
}

}  // namespace

LWStatus lwEstimateMemory(LWDevice device, const char* name, const void* desc, const LWViewDesc* view,
                          std::uint64_t rsmTexels, std::uint64_t* bytes) {
    return enter("lwEstimateMemory", [&](Call& call) {
        call.device(device);
        constexpr std::uint64_t kMaxTexels = std::uint64_t(1) << 40;  // products with it stay in 64 bits
        if (rsmTexels > kMaxTexels)
            fail(LW_ERROR_INVALID_ARGUMENT, "rsmTexels: expected fewer texels than a frame may have, got ",
                 rsmTexels);
        FrameShape shape;
        // A square map, or the next smaller square and the rows for the rest.
        const auto side = std::uint64_t(std::ceil(std::sqrt(double(rsmTexels))));
        if (side) shape.addMap(side, (rsmTexels + side - 1) / side);
        estimate(call, name, desc, view, shape, bytes);
    });
}

LWStatus lwEstimateFrameMemory(LWDevice device, const char* name, const void* desc, const LWViewDesc* view,
                               const LWFrame* frame, std::uint64_t* bytes) {
    return enter("lwEstimateFrameMemory", [&](Call& call) {
        call.device(device);
        const FrameArgument own(call, frame);
        FrameShape shape;
        shape.vplCount = own.get().vplCount;
        shape.staticVplCount = own.get().staticVplCount;
        shape.lightCount = own.get().lightCount;
        for (std::uint32_t l = 0; l < own.get().lightCount; ++l) {
            const LWLight& light = own.get().lights[l];
            const bool spot = light.kind == LW_LIGHT_SPOT;
            shape.aimedSpots += spot && (light.hit || light.rsmCount) ? 1u : 0u;
            shape.aimedBySpotMaps += spot && !light.hit && light.rsmCount ? 1u : 0u;
            shape.profileValues += light.profileCount;
            shape.bakedReceivers |= !forAllReceivers(light.receivers);
        }
        for (std::uint32_t i = 0; i < own.get().staticVplCount; ++i)
            shape.bakedReceivers |= !forAllReceivers(own.get().staticVpls[i].receivers);
        shape.blockerCount = own.get().blockerCount;
        if (own.get().geometry) {
            shape.triangles = own.get().geometry->triangleCount;
            shape.surfels = own.get().geometry->surfelCount;
        }
        for (std::uint32_t i = 0; i < own.get().sourceViewCount; ++i) {
            const LWImage& image = own.get().sourceViews[i].gbuffer->normal;
            if (image.width > kMaxSide || image.height > kMaxSide)
                fail(LW_ERROR_INVALID_ARGUMENT, "frame.sourceViews[", i, "].gbuffer.normal: expected at most ", kMaxSide,
                     " pixels a side, got ", image.width, " x ", image.height);
            shape.sources.emplace_back(image.width, image.height);
            shape.sourcePixels += (std::uint64_t(image.width) + 15) / 16 * 16 * image.height;
        }
        for (std::uint32_t l = 0; l < own.get().lightCount; ++l)
            for (std::uint32_t r = 0; r < own.get().lights[l].rsmCount; ++r) {
                const LWImage& flux = own.get().lights[l].rsms[r].flux;
                if (flux.width == 0 || flux.height == 0 || flux.width > kMaxSide || flux.height > kMaxSide)
                    fail(LW_ERROR_INVALID_ARGUMENT, "frame.lights[", l, "].rsms[", r, "].flux: expected 1 .. ",
                         kMaxSide, " pixels a side, got ", flux.width, " x ", flux.height);
                shape.addMap(flux.width, flux.height);
            }
        estimate(call, name, desc, view, shape, bytes);
    });
}
