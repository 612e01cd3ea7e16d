// The filter of a level's light, the sum of two levels and the way back to the host's image, against serial twins.
#include "passes/screen_combine.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "passes/screen_pattern.h"
#include "support/screen_corner.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Light;
using reference::ScreenLevel;

TEST_CASE("filter, sum and finish equal their serial twins", "[screen_combine]") {
    const auto width = GENERATE(1u, 16u);
    const std::uint32_t n = GENERATE(2u, 4u), start = GENERATE(0u, 1u, 2u);
    const auto size = testSize(GENERATE(std::make_pair(1u, 1u), std::make_pair(34u, 9u), std::make_pair(131u, 57u)));
    CAPTURE(width, n, start, size.first, size.second);
    KernelRig rig(width);
    ScreenCorner corner(rig, size.first, size.second, n);
    const std::uint32_t w = size.first, h = size.second;
    ScreenCombine pass(rig.device(), {n, 1u << start, true, false, false});
    // Any light will do: what the gather makes of random senders. Level 1 from level 2.
    ScreenGather gather(rig.device(), n);
    const auto samples = screenPatterns(0.0, 6.0, 16, n, 5);
    const Guarded table = rig.upload(samples), e = rig.makePlanes(w, h, 3), v = rig.makePlanes(w, h, 1);
    for (std::uint32_t k = 0; k <= 2; ++k) {
        gather.recordDeal(rig.executor(), corner.pyramid, corner.levels, k);
        gather.recordGather(rig.executor(), corner.levels, k, table, 16, true, corner.levels.other(k));
        pass.recordFilter(rig.executor(), corner.pyramid.level(k), false, corner.levels.other(k), corner.levels.own(k));
    }
    rig.device().finish();
    std::vector<Light> filtered;
    for (std::uint32_t k = 0; k <= 2; ++k) {
        filtered.push_back(corner.read(corner.levels.own(k)));
        const Light twin = reference::screenFilter(corner.level(k), corner.read(corner.levels.other(k)), n);
        CAPTURE(k);
        CHECK(disagreement(filtered[k].planes, twin.planes, kTwinTolerance, kTwinShare) == "");
    }
    pass.recordAdd(rig.executor(), corner.pyramid.level(1), corner.levels.own(1), corner.pyramid.level(2), corner.levels.own(2),
                   corner.levels.other(1));
    pass.recordFinish(rig.executor(), rig.planes(corner.p, w, h, 3), rig.planes(corner.n, w, h, 3), corner.pyramid.level(start),
                      corner.levels.own(start), rig.planes(e, w, h, 3), rig.planes(v, w, h, 1), corner.counts);
    rig.device().finish();
    const ScreenLevel fine = corner.level(1), coarse = corner.level(2);
    Light sum(filtered[1].width, filtered[1].height, LW_LIGHT_PLANES);
    reference::screenUpsample(fine.position, fine.normal, coarse, filtered[2], 2, sum);
    for (std::size_t i = 0; i < sum.planes.size(); ++i) sum.planes[i] += filtered[1].planes[i];
    CHECK(disagreement(corner.read(corner.levels.other(1)).planes, sum.planes, kTwinTolerance, kTwinShare) == "");

    Light out(w, h, LW_LIGHT_PLANES);
    std::uint32_t lost = 0;
    if (start == 0) out = filtered[0];
    else lost = reference::screenUpsample(corner.position, corner.normal, corner.level(start), filtered[start], 1u << start, out);
    const std::size_t pixels = std::size_t(w) * h;
    const auto irradiance = rig.downloadPlanes(rig.planes(e, w, h, 3)), validity = rig.downloadPlanes(rig.planes(v, w, h, 1));
    CHECK(disagreement(irradiance, {out.planes.begin(), out.planes.begin() + std::ptrdiff_t(3 * pixels)}, kTwinTolerance, kTwinShare) == "");
    std::vector<float> share(out.planes.begin() + std::ptrdiff_t(3 * pixels), out.planes.end());
    for (float& s : share) s = std::min(s, 1.0f);
    CHECK(disagreement(validity, share, kTwinTolerance, kTwinShare) == "");
    // Surfaces at an edge test's border may be counted by one and not by the other.
    CHECK(std::abs(rig.download<cl_int>(corner.counts)[LW_SCREEN_FALLBACKS] - int(lost)) <= int(kTwinShare * double(pixels)));
}

TEST_CASE("texels move as the pixel does that they lie nearest to", "[screen_combine]") {
    const auto width = GENERATE(1u, 16u);
    const std::uint32_t factor = GENERATE(2u, 4u);
    const auto size = testSize(GENERATE(std::make_pair(1u, 1u), std::make_pair(34u, 9u), std::make_pair(131u, 57u)));
    const std::uint32_t w = size.first, h = size.second, columns = (w + factor - 1) / factor, rows = (h + factor - 1) / factor;
    CAPTURE(width, factor, w, h);
    KernelRig rig(width);
    ScreenCombine pass(rig.device(), {4, factor, false, false, true});
    const reference::Image position = reference::randomImage(w, h, 3), texels = reference::randomImage(columns, rows, 5);
    const reference::Image motion = reference::randomImage(w, h, 7);
    const Guarded p = rig.uploadPlanes(position.planes, w, h, 3, kNoNumber), m = rig.uploadPlanes(motion.planes, w, h, 3, kNoNumber);
    const Guarded t = rig.uploadPlanes(texels.planes, columns, rows, 3, kNoNumber), out = rig.makePlanes(columns, rows, 2);
    pass.recordMotion(rig.executor(), rig.planes(p, w, h, 3), rig.planes(m, w, h, 3), rig.planes(t, columns, rows, 3),
                      rig.planes(out, columns, rows, 2));
    rig.device().finish();
    const auto moved = rig.downloadPlanes(rig.planes(out, columns, rows, 2));
    for (std::uint32_t y = 0; y < rows; ++y)
        for (std::uint32_t x = 0; x < columns; ++x) {
            double nearest = 1e30;
            reference::Vec expected{};
            for (std::uint32_t j = y * factor; j < std::min(h, (y + 1) * factor); ++j)
                for (std::uint32_t i = x * factor; i < std::min(w, (x + 1) * factor); ++i) {
                    const reference::Vec d = position.get(i, j) - texels.get(x, y);
                    if (dot(d, d) >= nearest) continue;
                    nearest = dot(d, d);
                    expected = motion.get(i, j) * (1.0 / factor);
                }
            CAPTURE(x, y);
            REQUIRE(moved[y * columns + x] == float(expected.x));
            REQUIRE(moved[(rows + y) * columns + x] == float(expected.y));
        }
}
