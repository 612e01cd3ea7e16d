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
    ScreenCombine pass(rig.device(), {n, 1u << start, true, false});
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
