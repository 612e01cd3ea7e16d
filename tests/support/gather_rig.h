// The gather of one image, and its filter, on a test's device.
#pragma once

#include <limits>
#include <vector>

#include "passes/interleaved_gather.h"
#include "reference/surfaces.h"
#include "support/kernel_rig.h"
#include "support/vpl_slots.h"

namespace lightwell::test {

// With the tiles' own bits, or with all of them set: nothing is skipped then.
enum class Bits { found, all };

struct Gathered {
    reference::Image irradiance;
    int rejected, saturated;
};

inline Gathered gatherImage(KernelRig& rig, const reference::Image& position, const reference::Image& normal,
                            const std::vector<lw_vpl>& vpls, std::uint32_t n, Bits bits) {
    const std::uint32_t w = position.width, h = position.height;
    constexpr float kPadding = std::numeric_limits<float>::quiet_NaN();
    const Guarded p = rig.uploadPlanes(position.planes, w, h, 3, kPadding),
                  nr = rig.uploadPlanes(normal.planes, w, h, 3, 1.0f);
    const Guarded list = rig.upload(vpls), counts = rig.upload(std::vector<cl_int>{0, 0, 0});
    const Guarded out = rig.makePlanes(w, h, 3);
    const lw_subset_order order = orderOf(vpls.size(), n);
    const Planes surfaces[2] = {rig.planes(p, w, h, 3), rig.planes(nr, w, h, 3)};
    const Guarded all = rig.upload(allSlots(VplTiles::layout(w, h, order, n), order));
    InterleavedGather pass(rig.device(), n);
    VplTiles tiles;
    if (bits == Bits::found) {
        tiles.reserve(rig.device(), w, h, order, n);
        pass.recordCull(rig.executor(), surfaces[0], surfaces[1], list, order, tiles);
    }
    pass.recordGather(rig.executor(), surfaces[0], surfaces[1], list, order, bits == Bits::all ? all : tiles.masks(),
                      rig.planes(out, w, h, 3), counts);
    rig.device().finish();
    const std::vector<cl_int> counted = rig.download<cl_int>(counts);
    Gathered result{reference::Image(w, h), counted[0], counted[2]};
    result.irradiance.planes = rig.downloadPlanes(rig.planes(out, w, h, 3));
    return result;
}

inline reference::Image filterImage(KernelRig& rig, const reference::Image& position, const reference::Image& normal,
                                    const reference::Image& light, std::uint32_t n) {
    const std::uint32_t w = position.width, h = position.height;
    constexpr float kPadding = std::numeric_limits<float>::quiet_NaN();
    const auto up = [&](const reference::Image& image) { return rig.uploadPlanes(image.planes, w, h, 3, kPadding); };
    const auto planes = [&](const Guarded& buffer) { return rig.planes(buffer, w, h, 3); };
    const Guarded p = up(position), nr = up(normal), e = up(light), out = rig.makePlanes(w, h, 3);
    InterleavedGather pass(rig.device(), n);
    pass.recordFilter(rig.executor(), planes(p), planes(nr), planes(e), planes(out));
    rig.device().finish();
    reference::Image result(w, h);
    result.planes = rig.downloadPlanes(planes(out));
    return result;
}

}  // namespace lightwell::test
