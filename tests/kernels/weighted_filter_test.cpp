// The filter of weighted sums: a constant stays one within a surface, a ramp stays where it is.
#include "passes/weighted_filter.h"

#include <catch2/catch.hpp>
#include <limits>
#include <vector>

#include "support/kernel_rig.h"
#include "support/sphere_corner.h"

using namespace lightwell;
using namespace lightwell::test;

TEST_CASE("the filter makes means of its own surface", "[weighted_filter]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    const auto [w, h] = testSize({37, 29});
    DrawnView drawn(sphereCorner(), cornerCamera(false), w, h);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Guarded p = rig.uploadPlanes(drawn.position.packed(), w, h, 3, nan), n = rig.uploadPlanes(drawn.normal.packed(), w, h, 3, nan);
    // Sums of a constant under any weights are that constant.
    std::vector<float> sums(std::size_t(w) * h * 6);
    const std::size_t plane = std::size_t(w) * h;
    for (std::size_t i = 0; i < plane; ++i) {
        const float weight = 0.5f + float(i % 7);
        const float values[6] = {2.0f, 1.0f, 0.5f, 0.25f, 0.75f, 1.0f};
        for (std::size_t a = 0; a < 6; ++a) sums[a * plane + i] = weight * values[a];
    }
    const Guarded s = rig.uploadPlanes(sums, w, h, 6, nan);
    const Guarded between = rig.makePlanes(w, h, 6), e = rig.makePlanes(w, h, 3), v = rig.makePlanes(w, h, 1), o = rig.makePlanes(w, h, 1);
    for (const std::uint32_t columns : {1u, 4u, 8u}) {
        WeightedFilter(rig.device(), true)
            .record(rig.executor(), rig.planes(p, w, h, 3), rig.planes(n, w, h, 3), columns, 4, rig.planes(s, w, h, 6),
                    rig.planes(between, w, h, 6), rig.planes(e, w, h, 3), rig.planes(v, w, h, 1), rig.planes(o, w, h, 1));
        rig.device().finish();
        const auto irradiance = rig.downloadPlanes(rig.planes(e, w, h, 3)), validity = rig.downloadPlanes(rig.planes(v, w, h, 1)),
                   open = rig.downloadPlanes(rig.planes(o, w, h, 1));
        for (std::uint32_t y = 0; y < h; ++y)
            for (std::uint32_t x = 0; x < w; ++x) {
                const auto normal = drawn.normal.get(x, y);
                const double on = reference::dot(normal, normal) > 0.5 ? 1.0 : 0.0;
                const std::size_t i = std::size_t(y) * w + x;
                REQUIRE(double(irradiance[i]) == Approx(on * 2.0 * 3.14159265).margin(1e-5));
                REQUIRE(double(validity[i]) == Approx(on * 0.25).margin(1e-6));
                REQUIRE(double(open[i]) == Approx(on * 0.75).margin(1e-6));
            }
    }
}

TEST_CASE("the filter's window is centred: a ramp stays where it is", "[weighted_filter]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    const auto [w, h] = testSize({37, 29});
    ViewScene wall;
    wall.quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, 1.0);
    DrawnView drawn(wall, lookAt({0, 0, 2}, {0, 0, 0}, 0.5), w, h);
    const Guarded p = rig.uploadPlanes(drawn.position.packed(), w, h, 3, 0.0f);
    const Guarded n = rig.uploadPlanes(drawn.normal.packed(), w, h, 3, 0.0f);
    std::vector<float> sums(std::size_t(w) * h * 2, 1.0f);
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x) sums[std::size_t(y) * w + x] = 0.01f * float(x) + 0.015f * float(y);
    const Guarded s = rig.uploadPlanes(sums, w, h, 2, 0.0f), o = rig.makePlanes(w, h, 1), between = rig.makePlanes(w, h, 2);
    for (const std::uint32_t rows : {1u, 2u, 4u, 8u}) {
        WeightedFilter(rig.device(), false)
            .record(rig.executor(), rig.planes(p, w, h, 3), rig.planes(n, w, h, 3), 8, rows, rig.planes(s, w, h, 2),
                    rig.planes(between, w, h, 2), {}, {}, rig.planes(o, w, h, 1));
        rig.device().finish();
        const auto open = rig.downloadPlanes(rig.planes(o, w, h, 1));
        for (std::uint32_t y = 4; y + 4 < h; ++y)
            for (std::uint32_t x = 4; x + 4 < w; ++x)
                REQUIRE(double(open[std::size_t(y) * w + x]) == Approx(double(sums[std::size_t(y) * w + x])).margin(1e-5));
    }
}
