// What the tests of technique rsm light and render.
#pragma once

#include <cmath>
#include <vector>

#include "support/lit_room.h"
#include "support/scoped_api.h"

namespace lightwell::test {

// A spot's pool of light with a hard rim on a floor of light and dark tiles. Off the middle of the map: a
// symmetric one puts sample points exactly on the borders between texels, where rounding decides.
inline double spotProfile(double x, double z) {
    const double dx = x - 0.037, dz = z - 0.521, r2 = dx * dx + dz * dz;
    const bool isDark = (int(std::floor(x * 9.1)) + int(std::floor(z * 9.1))) % 2 != 0;
    return r2 > 0.06 ? 0.0 : (isDark ? 0.15 : 0.8) * (1.0 - 6.0 * r2);
}

inline LWRsmDesc descOf(std::uint32_t vpls, std::uint32_t interleave) {
    LWRsmDesc desc;
    lwDefaultRsm(&desc);
    desc.vpls = vpls;
    desc.interleave = interleave;
    return desc;
}

// One frame on a fresh technique.
inline std::vector<float> render(LWDevice device, const LWRsmDesc& desc, const std::vector<LWLight>& lights,
                                 const WallAndCeiling& scene, std::uint32_t width, std::uint32_t height) {
    TestTechnique technique(device, desc);
    TestView view(device, width, height);
    technique.update(lights);
    return technique.render(view, scene.gbuffer);
}

}  // namespace lightwell::test
