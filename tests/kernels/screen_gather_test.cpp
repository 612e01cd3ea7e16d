// The gather of a level against its serial twin; sample patterns against what they must cover.
#include "passes/screen_gather.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <map>

#include "inputs/camera.h"
#include "passes/screen_combine.h"
#include "passes/screen_pattern.h"
#include "reference/screen_twin.h"
#include "support/screen_corner.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Light;

namespace {

constexpr double kPi = 3.14159265358979323846;

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
    ScreenCorner corner(rig, size.first, size.second, n);
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

TEST_CASE("the same bits at every width", "[screen_gather][large]") {
    std::vector<float> first;
    for (const std::uint32_t width : {1u, 4u, 8u, 16u}) {
        KernelRig rig(width);
        ScreenCorner corner(rig, 131, 57, 4);
        ScreenGather gather(rig.device(), 4);
        ScreenCombine combine(rig.device(), {4, 2, true, false, false});
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

TEST_CASE("turns of a set fill each other's gaps", "[screen_pattern]") {
    // What a pattern makes of the share of a ring where area and angle lie in an ellipse, in the mean over 16 turns: its error
    // over many seeds, next to that of as many patterns whose seeds have nothing to do with each other.
    const std::uint32_t turns = 16, samples = 64, trials = 48;
    const double truth = kPi * 0.2 * 0.3;
    const auto share = [&](std::uint32_t seed, std::uint32_t turn) {
        // A ring so wide that texels are points. Of 16 patterns the sixth.
        const auto set = screenPatterns(10000.0, 20000.0, samples, 4, seed, turn);
        double inside = 0.0;
        for (std::uint32_t s = 5 * samples; s < 6 * samples; ++s) {
            const double x = set[s].step * 4 + set[s].phase, y = set[s].row;
            const double u = (x * x + y * y - 1e8) / 3e8, v = std::atan2(y, x) / (2.0 * kPi) + 0.5;
            if (std::hypot((u - 0.4) / 0.2, (v - 0.6) / 0.3) < 1.0) inside += 1.0 / samples;
        }
        return inside;
    };
    double turned = 0.0, seeded = 0.0;
    for (std::uint32_t trial = 0; trial < trials; ++trial) {
        double a = 0.0, b = 0.0;
        for (std::uint32_t turn = 0; turn < turns; ++turn) {
            a += share(trial + 1, turn) / turns;
            b += share(1000 + trial * turns + turn, 0) / turns;
        }
        turned += std::pow(a - truth, 2.0) / trials;
        seeded += std::pow(b - truth, 2.0) / trials;
    }
    CAPTURE(std::sqrt(turned) / truth, std::sqrt(seeded) / truth);
    CHECK(turned < seeded);
    CHECK(std::sqrt(turned) < 0.03 * truth);
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
