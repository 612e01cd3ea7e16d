// The gather of a level, its filter and the way back to the host's image, against serial twins; sample patterns against
// what they must cover.
#include "passes/screen_gather.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <map>

#include "inputs/camera.h"
#include "passes/screen_combine.h"
#include "passes/screen_pattern.h"
#include "reference/pyramid_twin.h"
#include "reference/screen_twin.h"
#include "support/kernel_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Image;
using reference::Light;
using reference::PinholeCamera;
using reference::ScreenLevel;
using reference::Vec;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
// Sums of some thirty terms of one sign, each a dozen roundings of differences of positions.
constexpr double kTwinTolerance = 2e-5;
// Texels at the border of an edge test or of the horizon, where rounding decides.
constexpr double kTwinShare = 2e-3;
constexpr double kPi = 3.14159265358979323846;

// A corner with a slab before it, lit at random, as levels 0 .. 2 of a view.
struct Corner {
    KernelRig& rig;
    std::uint32_t w, h;
    PinholeCamera camera;
    Image position, normal, radiance;
    Guarded p, n, l, counts;
    PyramidLevels pyramid;
    ScreenLevels levels;

    Corner(KernelRig& r, std::uint32_t width, std::uint32_t height, std::uint32_t interleave)
        : rig(r), w(width), h(height), camera{{0.1, 0.2, 0.5}, 0.4, w, h}, position(w, h), normal(w, h),
          radiance(reference::randomImage(w, h, 3)), p(r.make<float>(1)), n(r.make<float>(1)), l(r.make<float>(1)),
          counts(r.upload(std::vector<cl_int>(LW_SCREEN_COUNTERS))),
          pyramid(r.device(), w, h, {ScreenGather::kExtras, 0, 2}), levels(r.device(), w, h, {0, 2}, interleave) {
        for (std::uint32_t y = 0; y < h; ++y)
            for (std::uint32_t x = 0; x < w; ++x) {
                const double u = (x + 0.5) / w, v = (y + 0.5) / h;
                if (v < 0.1) continue;
                Vec point{0, 0, -2}, facing{0, 0, 1};
                if (u > 0.3 && u < 0.5 && v > 0.3 && v < 0.8) point.z = -1.5;
                else if (v > 0.6) { point = {0, -0.1, 0}; facing = {0, 1, 0}; }
                position.set(x, y, camera.onPlane(x + 0.5, y + 0.5, point, facing));
                normal.set(x, y, facing * 0.9);
            }
        p = rig.uploadPlanes(position.planes, w, h, 3, kNaN);
        n = rig.uploadPlanes(normal.planes, w, h, 3, 1.0f);
        l = rig.uploadPlanes(radiance.planes, w, h, 3, kNaN);
        MipPyramid pass(rig.device(), ScreenGather::kExtras);
        pass.record(rig.executor(), rig.planes(p, w, h, 3), rig.planes(n, w, h, 3), rig.planes(l, w, h, 3), {},
                    Camera(camera.matrices(), w, h, "camera"), pyramid, counts);
        levels.resize(rig.executor(), w, h);
    }
    Image read(const Planes& planes) {
        Image image(planes.width, planes.height, planes.count);
        image.planes = rig.downloadPlanes(planes);
        return image;
    }
    ScreenLevel level(std::uint32_t k) {
        return {read(pyramid.position(k)), read(pyramid.normal(k)), read(pyramid.radiance(k)), read(pyramid.area(k)).planes};
    }
};

// How many texels' worth of samples each texel gets, all patterns and seeds together, by offset.
std::map<std::pair<int, int>, double> coverage(double inner, double outer, std::uint32_t samples, std::uint32_t n, std::uint32_t seeds) {
    std::map<std::pair<int, int>, double> weight;
    for (std::uint32_t seed = 1; seed <= seeds; ++seed)
        for (const LwScreenSample& s : screenPatterns(inner, outer, samples, n, seed))
            weight[{s.step * int(n) + s.phase, s.row}] += double(s.weight) / (n * n * seeds);
    return weight;
}

}  // namespace

TEST_CASE("a gathered level equals its serial twin", "[screen_gather]") {
    const auto width = GENERATE(1u, 16u);
    const std::uint32_t n = GENERATE(1u, 2u, 4u);
    const auto size = testSize(GENERATE(std::make_pair(1u, 1u), std::make_pair(33u, 8u), std::make_pair(131u, 57u)));
    const bool bounded = GENERATE(true, false);
    CAPTURE(width, n, size.first, size.second, bounded);
    KernelRig rig(width);
    Corner corner(rig, size.first, size.second, n);
    ScreenGather pass(rig.device(), n);
    const std::uint32_t count = 16;
    for (const std::uint32_t k : {0u, 1u}) {
        const auto samples = screenPatterns(k == 0 ? 0.0 : 3.0, 6.0, count, n, 5);
        const Guarded table = rig.upload(samples);
        pass.recordDeal(rig.executor(), corner.pyramid, corner.levels, k);
        pass.recordGather(rig.executor(), corner.levels, k, table, count, bounded, corner.levels.own(k));
        rig.device().finish();
        const Light twin = reference::screenGather(corner.level(k), samples, count, n, bounded);
        CAPTURE(k);
        CHECK(disagreement(corner.read(corner.levels.own(k)).planes, twin.planes, kTwinTolerance, kTwinShare) == "");
    }
}

TEST_CASE("filter, sum and finish equal their serial twins", "[screen_combine]") {
    const auto width = GENERATE(1u, 16u);
    const std::uint32_t n = GENERATE(2u, 4u), start = GENERATE(0u, 1u, 2u);
    const auto size = testSize(GENERATE(std::make_pair(1u, 1u), std::make_pair(34u, 9u), std::make_pair(131u, 57u)));
    CAPTURE(width, n, start, size.first, size.second);
    KernelRig rig(width);
    Corner corner(rig, size.first, size.second, n);
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

TEST_CASE("the same bits at every width", "[screen_gather][large]") {
    std::vector<float> first;
    for (const std::uint32_t width : {1u, 4u, 8u, 16u}) {
        KernelRig rig(width);
        Corner corner(rig, 131, 57, 4);
        ScreenGather gather(rig.device(), 4);
        ScreenCombine combine(rig.device(), {4, 2, true, false});
        const auto samples = screenPatterns(0.0, 6.0, 16, 4, 5);
        const Guarded table = rig.upload(samples), e = rig.makePlanes(131, 57, 3), v = rig.makePlanes(131, 57, 1);
        for (std::uint32_t k = 1; k <= 2; ++k) {
            gather.recordDeal(rig.executor(), corner.pyramid, corner.levels, k);
            gather.recordGather(rig.executor(), corner.levels, k, table, 16, true, corner.levels.other(k));
            combine.recordFilter(rig.executor(), corner.pyramid.level(k), false, corner.levels.other(k), corner.levels.own(k));
        }
        combine.recordAdd(rig.executor(), corner.pyramid.level(1), corner.levels.own(1), corner.pyramid.level(2),
                          corner.levels.own(2), corner.levels.other(1));
        combine.recordFinish(rig.executor(), rig.planes(corner.p, 131, 57, 3), rig.planes(corner.n, 131, 57, 3),
                             corner.pyramid.level(1), corner.levels.other(1), rig.planes(e, 131, 57, 3), rig.planes(v, 131, 57, 1),
                             corner.counts);
        rig.device().finish();
        const auto bits = rig.downloadPlanes(rig.planes(e, 131, 57, 3));
        if (first.empty()) first = bits;
        CAPTURE(width);
        CHECK(bitDifference(bits, first) == "");
    }
}

TEST_CASE("disc and rings cover the image without gap or overlap", "[screen_pattern]") {
    // Level k's ring, seen from level 0: each of its texels is 2^k wide, and its receiver may stand anywhere in one. Along
    // any radius the weights of disc and rings must add to 1 per texel out to the last one's edge, and to 0 behind it.
    const double r = 5.0;
    const std::uint32_t seeds = 400;
    const auto disc = coverage(0.0, 2.0 * r, 64, 4, seeds), ring = coverage(r, 2.0 * r, 64, 4, seeds);
    double inside = 0.0, ringArea = 0.0;
    for (const auto& [at, weight] : disc) inside += weight;
    for (const auto& [at, weight] : ring) ringArea += weight;
    CHECK(inside == Approx(kPi * 4.0 * r * r).epsilon(1e-5));
    CHECK(ringArea == Approx(kPi * 3.0 * r * r).epsilon(1e-5));
    for (const auto& [at, weight] : disc) {
        const double d = std::hypot(at.first, at.second);
        CAPTURE(at.first, at.second);
        // Half a texel's diagonal inside or outside the edge there is no doubt. 400 sets of 1,024 points for 314 texels:
        // a texel is hit 1,300 times, stratified.
        if (d < 2.0 * r - 0.71) CHECK(weight == Approx(1.0).margin(0.12));
        CHECK(d < 2.0 * r + 0.71);
    }
    // Radius by radius: the share of level-0 area at distance d that disc and ring of level 1 hold together.
    std::map<int, double> byRadius, area;
    for (const auto& [at, weight] : disc) byRadius[int(std::hypot(at.first, at.second))] += weight;
    for (const auto& [at, weight] : ring)
        for (int j = 0; j < 32; ++j)
            for (int i = 0; i < 32; ++i)  // the texel's area, spread over level 0
                byRadius[int(std::hypot(2.0 * (at.first - 0.5 + (i + 0.5) / 32.0), 2.0 * (at.second - 0.5 + (j + 0.5) / 32.0)))] += 4.0 * weight / 1024.0;
    for (int y = -40; y <= 40; ++y)
        for (int x = -40; x <= 40; ++x) area[int(std::hypot(x, y))] += 1.0;
    const auto share = [&](int from, int to) {
        double covered = 0.0, all = 0.0;
        for (int d = from; d < to; ++d) covered += byRadius[d], all += area[d];
        return covered / all;
    };
    // Lattice points between two circles are not their area. About the common edge, at 10, texels of either hold a part of
    // the other's side, the ring's up to 2.8 away: taken together.
    for (int d : {2, 3, 4, 5, 13, 14, 15, 16}) {
        CAPTURE(d);
        CHECK(share(d, d + 2) == Approx(1.0).margin(0.12));
    }
    CHECK(share(7, 13) == Approx(1.0).margin(0.05));
}

TEST_CASE("few texels are taken whole, each with what lies inside", "[screen_pattern]") {
    const auto all = screenPatterns(0.0, 4.0, 256, 4, 0);
    double sum = 0.0;
    std::map<std::pair<int, int>, int> seen;
    for (std::size_t i = 0; i < 256; ++i) {
        const LwScreenSample& s = all[i];
        sum += double(s.weight);
        if (s.weight == 0.0f) continue;
        const int x = s.step * 4 + s.phase, y = s.row;
        CHECK(++seen[{x, y}] == 1);
        CHECK(s.phase >= 0);
        CHECK(s.phase < 4);
        if (std::hypot(std::abs(x) + 0.5, std::abs(y) + 0.5) < 4.0) CHECK(s.weight == Approx(1.0f).epsilon(1e-3));
        CHECK(std::hypot(std::max(std::abs(x) - 0.5, 0.0), std::max(std::abs(y) - 0.5, 0.0)) < 4.0);
    }
    CHECK(sum == Approx(kPi * 16.0).epsilon(1e-5));
    for (std::size_t i = 256; i < all.size(); ++i) CHECK(all[i].weight == all[i % 256].weight);
}
