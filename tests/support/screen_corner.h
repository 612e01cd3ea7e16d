// What tests of the passes `screen_gather` and `screen_combine` share: a view with its pyramid and levels, and how near a
// serial twin they must come.
#pragma once

#include <limits>
#include <vector>

#include "inputs/camera.h"
#include "passes/screen_gather.h"
#include "reference/pyramid_twin.h"
#include "reference/screen_twin.h"
#include "support/kernel_rig.h"

namespace lightwell::test {

constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();
// Sums of some thirty terms of one sign, each a dozen roundings of differences of positions.
constexpr double kTwinTolerance = 2e-5;
// Texels at the border of an edge test or of the horizon, where rounding decides.
constexpr double kTwinShare = 2e-3;

// A corner with a slab before it, lit at random, as levels 0 .. 2 of a view.
struct ScreenCorner {
    KernelRig& rig;
    std::uint32_t w, h;
    reference::PinholeCamera camera;
    reference::Image position, normal, radiance;
    Guarded p, n, l, counts;
    PyramidLevels pyramid;
    ScreenLevels levels;

    ScreenCorner(KernelRig& r, std::uint32_t width, std::uint32_t height, std::uint32_t interleave)
        : rig(r), w(width), h(height), camera{{0.1, 0.2, 0.5}, 0.4, w, h}, position(w, h), normal(w, h),
          radiance(reference::randomImage(w, h, 3)), p(r.make<float>(1)), n(r.make<float>(1)), l(r.make<float>(1)),
          counts(r.upload(std::vector<cl_int>(LW_SCREEN_COUNTERS))),
          pyramid(r.device(), w, h, {ScreenGather::kExtras, 0, 2}), levels(r.device(), w, h, {0, 2}, interleave) {
        for (std::uint32_t y = 0; y < h; ++y)
            for (std::uint32_t x = 0; x < w; ++x) {
                const double u = (x + 0.5) / w, v = (y + 0.5) / h;
                if (v < 0.1) continue;
                reference::Vec point{0, 0, -2}, facing{0, 0, 1};
                if (u > 0.3 && u < 0.5 && v > 0.3 && v < 0.8) point.z = -1.5;
                else if (v > 0.6) { point = {0, -0.1, 0}; facing = {0, 1, 0}; }
                position.set(x, y, camera.onPlane(x + 0.5, y + 0.5, point, facing));
                normal.set(x, y, facing * 0.9);
            }
        p = rig.uploadPlanes(position.planes, w, h, 3, kNoNumber);
        n = rig.uploadPlanes(normal.planes, w, h, 3, 1.0f);
        l = rig.uploadPlanes(radiance.planes, w, h, 3, kNoNumber);
        MipPyramid pass(rig.device(), ScreenGather::kExtras);
        pass.record(rig.executor(), rig.planes(p, w, h, 3), rig.planes(n, w, h, 3), rig.planes(l, w, h, 3), {},
                    Camera(camera.matrices(), w, h, "camera"), pyramid, counts);
        levels.resize(rig.executor(), w, h);
    }
    reference::Image read(const Planes& planes) {
        reference::Image image(planes.width, planes.height, planes.count);
        image.planes = rig.downloadPlanes(planes);
        return image;
    }
    reference::ScreenLevel level(std::uint32_t k) {
        return {read(pyramid.position(k)), read(pyramid.normal(k)), read(pyramid.radiance(k)), read(pyramid.area(k)).planes};
    }
};

}  // namespace lightwell::test
