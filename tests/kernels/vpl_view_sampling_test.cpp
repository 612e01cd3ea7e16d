// VPLs chosen by what they bring the surfaces of source views: what is chosen, what it carries, and what it adds up to.
#include "passes/vpl_view_sampling.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "passes/vpl_list.h"
#include "reference/surfaces.h"
#include "shared/vpl_types.h"
#include "support/errors.h"
#include "support/host_image.h"
#include "support/kernel_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

// Some hundreds of candidates' weights of 256 terms each, cumulated in float: what a candidate is chosen by is the difference of two
// sums, each off by 2^-24 of a total that is hundreds of times as large.
constexpr double kTwinRounding = 1e-3;
// The means of 128 evenly spaced offsets: a candidate that is chosen n times on average is counted 128 n times, off by one at most.
constexpr int kOffsets = 128;
constexpr double kTotal = 2e-3;
constexpr std::uint32_t kWidth = 37, kHeight = 23;

// A view of a G-buffer whose pixels a test describes; 0 normals are background.
struct Seen {
    HostImage position{LW_FORMAT_FLOAT3, kWidth, kHeight}, normal{LW_FORMAT_FLOAT3, kWidth, kHeight};
    LWGBuffer gbuffer{};
    LWSourceView source{nullptr, &gbuffer};

    template <class Pixel>  // pair of position and normal of (x, y)
    explicit Seen(Pixel pixel) {
        for (std::uint32_t y = 0; y < kHeight; ++y)
            for (std::uint32_t x = 0; x < kWidth; ++x) {
                const std::pair<Vec, Vec> p = pixel(x, y);
                position.set(x, y, p.first.x, p.first.y, p.first.z);
                normal.set(x, y, p.second.x, p.second.y, p.second.z);
            }
        gbuffer.structSize = sizeof gbuffer;
        gbuffer.position = position.image();
        gbuffer.normal = normal.image();
    }
    LWFrame frame(std::uint32_t views = 1) const {
        LWFrame f{};
        f.structSize = sizeof f;
        f.sourceViews = views ? &source : nullptr;
        f.sourceViewCount = views;
        return f;
    }
};

lw_vpl vplAt(Vec position, Vec normal, double flux) {
    lw_vpl v{};
    v.positionArea = {{float(position.x), float(position.y), float(position.z), 0.01f}};
    v.normal = {{float(normal.x), float(normal.y), float(normal.z), 0.0f}};
    v.flux = {{float(flux), float(flux), float(2.0 * flux), 0.0f}};
    return v;
}

// What the pass chooses of candidates, by slot.
std::vector<lw_vpl> choose(KernelRig& rig, const LWFrame& frame, const std::vector<lw_vpl>& candidates, std::uint32_t count,
                           float offset, std::uint32_t subsets = 1, const std::vector<lw_vpl>& authored = {}) {
    VplViewSampling pass(rig.device());
    pass.import(rig.executor(), frame);
    const lw_subset_order order = subsetOrder(count + std::uint32_t(authored.size()), subsets);
    const Guarded list = rig.upload(candidates), own = rig.upload(authored.empty() ? candidates : authored),
                  chosen = rig.make<lw_vpl>(std::size_t(order.subsets * order.capacity));
    pass.record(rig.executor(), list, std::uint32_t(candidates.size()), count, offset, own, order, chosen);
    rig.device().finish();
    return rig.download<lw_vpl>(chosen);
}

struct Place {
    Vec position, normal;
};

// Where a view is asked: an even grid of about as many pixels as there are points, of the picture's shape.
std::vector<Place> placesOf(const Seen& seen, std::uint32_t points) {
    const auto columns = std::uint32_t(std::sqrt(double(points) * kWidth / kHeight) + 0.5), rows = points / columns;
    std::vector<Place> places;
    for (std::uint32_t k = 0; k < columns * rows; ++k) {
        const auto x = std::uint32_t((k % columns + 0.5) * kWidth / columns), y = std::uint32_t((k / columns + 0.5) * kHeight / rows);
        const auto at = [&](const HostImage& image) { return Vec{image.value(x, y, 0), image.value(x, y, 1), image.value(x, y, 2)}; };
        const Vec n = at(seen.normal);
        if (dot(n, n) > 0.25) places.push_back({at(seen.position), n * (1.0 / std::sqrt(dot(n, n)))});
    }
    return places;
}

// The weights by which candidates are chosen, as the method's page has them.
std::vector<double> weightsOf(const std::vector<Place>& places, const std::vector<lw_vpl>& candidates) {
    Vec mean{};
    double spread = 0.0, all = 0.0, lit = 0.0;
    for (const Place& p : places) mean = mean + p.position * (1.0 / double(places.size()));
    for (const Place& p : places) spread += dot(p.position - mean, p.position - mean) / double(places.size());
    std::vector<double> weights;
    for (const lw_vpl& v : candidates) {
        const Vec at{v.positionArea.s[0], v.positionArea.s[1], v.positionArea.s[2]}, n{v.normal.s[0], v.normal.s[1], v.normal.s[2]};
        double sum = 0.0;
        for (const Place& p : places) {
            const Vec d = p.position - at;
            const double d2 = dot(d, d);
            sum += std::max(0.0, dot(n, d)) * std::max(0.0, -dot(p.normal, d)) / (d2 * std::max(d2, spread / 16.0));
        }
        weights.push_back(v.flux.s[0] > 0.0f ? sum : 0.0);
        all += weights.back();
        lit += v.flux.s[0] > 0.0f ? 1.0 : 0.0;
    }
    for (std::size_t i = 0; i < weights.size(); ++i)
        if (candidates[i].flux.s[0] > 0.0f) weights[i] += all > 0.0 ? all / lit : 1.0;
    return weights;
}

// A floor with a step, sky above a slanted line; seen from nowhere in particular.
std::pair<Vec, Vec> stair(std::uint32_t x, std::uint32_t y) {
    if (y > 18 + x / 12) return {Vec{}, Vec{}};
    const bool isUp = x > 15;
    return {Vec{0.3 * x, isUp ? 1.0 : 0.0, 0.4 * y}, x == 16 ? Vec{-1.2, 0, 0} : Vec{0.0, 0.9, 0.3}};
}

std::vector<lw_vpl> scattered(std::size_t count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<lw_vpl> list;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec position{6.0 + 8.0 * unit(random), 2.0 + 2.0 * unit(random), 4.0 + 8.0 * unit(random)};
        const Vec n{unit(random), unit(random), unit(random)};
        list.push_back(i % 11 == 5 ? lw_vpl{} : vplAt(position, n * (1.0 / std::sqrt(dot(n, n))), 3.0));
    }
    return list;
}

}  // namespace

TEST_CASE("VPLs chosen for a view: as a serial twin chooses them, and authored ones behind", "[vpl_view_sampling]") {
    const Seen seen(stair);
    const std::vector<lw_vpl> candidates = scattered(333), authored{vplAt({9, 9, 9}, {0, 1, 0}, 5.0)};
    const std::vector<double> weights = weightsOf(placesOf(seen, 256), candidates);
    double total = 0.0;
    for (const double w : weights) total += w;
    const auto subsets = GENERATE(1u, 4u);
    std::vector<lw_vpl> first;
    for (const std::uint32_t width : {1u, 16u}) {
        KernelRig rig(width);
        const std::vector<lw_vpl> got = choose(rig, seen.frame(), candidates, 40, 0.3f, subsets, authored);
        const lw_subset_order order = subsetOrder(41, subsets);
        REQUIRE(got.size() == std::size_t(order.subsets * order.capacity));
        double sum = 0.0, worst = 0.0;
        std::size_t c = 0;
        for (int k = 0; k < 40; ++k) {
            while (sum + weights[c] <= (k + 0.3) / 40.0 * total) sum += weights[c++];
            CAPTURE(width, k, c);
            const lw_vpl& v = got[std::size_t(lw_subset_slot(order, k))];
            REQUIRE(std::memcmp(&v.positionArea, &candidates[c].positionArea, 12) == 0);
            const double factor = total / (40.0 * weights[c]);
            worst = std::max(worst, std::abs(double(v.flux.s[2]) / (6.0 * factor) - 1.0));
            worst = std::max(worst, std::abs(double(v.positionArea.s[3]) / (0.01 * factor) - 1.0));
            CHECK(double(v.normal.s[3]) == Approx(double(v.positionArea.s[3]) / (4.0 * 3.14159265358979)));
        }
        CHECK(worst < kTwinRounding);
        const lw_vpl& own = got[std::size_t(lw_subset_slot(order, 40))];
        CHECK((own.flux.s[0] == 5.0f && own.positionArea.s[0] == 9.0f));
        if (first.empty()) first = got;
        CHECK(std::memcmp(first.data(), got.data(), got.size() * sizeof(lw_vpl)) == 0);
    }
}

TEST_CASE("VPLs chosen for a view: in the mean of choices every candidate keeps its flux", "[vpl_view_sampling][large]") {
    KernelRig rig(16);
    const Seen seen(stair);
    const std::vector<lw_vpl> candidates = scattered(120);
    const std::vector<double> weights = weightsOf(placesOf(seen, 256), candidates);
    double total = 0.0, lit = 0.0, drawn = 0.0, most = 0.0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        total += weights[i];
        lit += double(candidates[i].flux.s[0]);
    }
    std::vector<double> mean(candidates.size());
    for (int o = 0; o < kOffsets; ++o)
        for (const lw_vpl& v : choose(rig, seen.frame(), candidates, 15, (float(o) + 0.5f) / float(kOffsets))) {
            const auto same = [&](const lw_vpl& c) { return std::memcmp(&c.positionArea, &v.positionArea, 12) == 0; };
            const auto at = std::find_if(candidates.begin(), candidates.end(), same);
            REQUIRE(at != candidates.end());
            mean[std::size_t(at - candidates.begin())] += double(v.flux.s[0]) / kOffsets;
            drawn += double(v.flux.s[0]) / kOffsets;
            most = std::max(most, double(v.flux.s[0]));
        }
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        CAPTURE(i);
        const double flux = double(candidates[i].flux.s[0]), step = weights[i] > 0.0 ? total / (15.0 * weights[i] * kOffsets) : 0.0;
        CHECK(std::abs(mean[i] - flux) <= flux * (step + kTwinRounding));
    }
    CHECK(drawn == Approx(lit).epsilon(kTotal));
    // No VPL has more than twice the flux of one of as many by flux alone.
    CHECK(most <= 2.0 * lit / 15.0 * (1.0 + kTwinRounding));
}

TEST_CASE("VPLs chosen for a view: three of four light it where half of them could", "[vpl_view_sampling]") {
    KernelRig rig(GENERATE(1u, 16u));
    // A floor; over it one patch that faces it, behind a wall's back another that doesn't.
    const Seen seen([](std::uint32_t x, std::uint32_t y) { return std::pair<Vec, Vec>{{0.01 * x, 0.0, 0.01 * y}, {0, 1, 0}}; });
    std::vector<lw_vpl> candidates;
    for (int i = 0; i < 400; ++i)
        candidates.push_back(i < 200 ? vplAt({0.2, 5.0, 0.1}, {0, -1, 0}, 1.0) : vplAt({3.0, 5.0, 0.1}, {0, 1, 0}, 1.0));
    int facing = 0;
    for (const lw_vpl& v : choose(rig, seen.frame(), candidates, 100, 0.5f)) facing += v.normal.s[1] < 0.0f ? 1 : 0;
    // w = I + mean I: 1.5 to 0.5.
    CHECK(std::abs(facing - 75) <= 1);
}

TEST_CASE("VPLs chosen for a view: the same in any unit of length and light", "[vpl_view_sampling]") {
    KernelRig rig(16);
    constexpr double kLength = 1024.0, kLight = 1.0 / 256.0;  // powers of two, which float takes as they are
    const Seen seen(stair), large([](std::uint32_t x, std::uint32_t y) {
        const auto p = stair(x, y);
        return std::pair<Vec, Vec>{p.first * kLength, p.second};
    });
    std::vector<lw_vpl> candidates = scattered(200), scaled = candidates;
    for (lw_vpl& v : scaled) {
        for (int a = 0; a < 3; ++a) v.positionArea.s[a] *= float(kLength);
        for (int c = 0; c < 3; ++c) v.flux.s[c] *= float(kLight);
    }
    const std::vector<lw_vpl> a = choose(rig, seen.frame(), candidates, 25, 0.7f), b = choose(rig, large.frame(), scaled, 25, 0.7f);
    for (std::size_t i = 0; i < a.size(); ++i) {
        CHECK(b[i].positionArea.s[0] == a[i].positionArea.s[0] * float(kLength));
        CHECK(b[i].flux.s[2] == a[i].flux.s[2] * float(kLight));
        CHECK(b[i].positionArea.s[3] == a[i].positionArea.s[3]);
    }
}

TEST_CASE("VPLs chosen for a view: without surfaces or light to bring, as by flux", "[vpl_view_sampling]") {
    KernelRig rig(GENERATE(1u, 16u));
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    const Seen sky([](std::uint32_t x, std::uint32_t) { return std::pair<Vec, Vec>{{kNan, 1, 2}, {0, x % 2 ? kNan : 1.0, 0}}; });
    const Seen spot([](std::uint32_t, std::uint32_t) { return std::pair<Vec, Vec>{{1, 2, 3}, {0, 1, 0}}; });  // no spread
    const Seen turned([](std::uint32_t x, std::uint32_t y) { return std::pair<Vec, Vec>{{-0.1 * x, 9.0, -0.1 * y}, {0, 1, 0}}; });
    std::vector<lw_vpl> candidates;
    for (int i = 0; i < 64; ++i) candidates.push_back(i % 4 == 3 ? lw_vpl{} : vplAt({1.0 + i, 2.0, 3.0}, {0, -1, 0}, 1.0));
    for (const Seen* seen : {&sky, &spot, &turned}) {
        const std::vector<lw_vpl> got = choose(rig, seen->frame(), candidates, 12, 0.5f);
        for (std::size_t i = 0; i < 12; ++i) {
            CHECK(got[i].flux.s[0] == Approx(48.0 / 12.0));
            CHECK(got[i].positionArea.s[0] == candidates[(4 * i + 2) / 3 * 4 + (4 * i + 2) % 3].positionArea.s[0]);
        }
    }
    // And of nothing, nothing.
    for (const lw_vpl& v : choose(rig, spot.frame(), std::vector<lw_vpl>(16), 4, 0.5f)) CHECK((v.flux.s[0] == 0.0f && v.normal.s[1] == 0.0f));
}

TEST_CASE("VPLs chosen for a view: several views share the points, and what is refused", "[vpl_view_sampling]") {
    KernelRig rig(16);
    const Seen seen(stair);
    const std::vector<lw_vpl> candidates = scattered(100);
    std::vector<LWSourceView> views(64, seen.source);
    LWFrame frame = seen.frame();
    frame.sourceViews = views.data();
    frame.sourceViewCount = 64;
    // 64 times the same view at four pixels each: as one with these four.
    const std::vector<double> weights = weightsOf(placesOf(seen, 4), candidates);
    double total = 0.0;
    for (const double w : weights) total += w;
    for (const lw_vpl& v : choose(rig, frame, candidates, 31, 0.5f)) {  // 31: and an empty slot
        if (v.flux.s[0] == 0.0f) continue;
        const auto same = [&](const lw_vpl& c) { return std::memcmp(&c.positionArea, &v.positionArea, 12) == 0; };
        const auto at = std::size_t(std::find_if(candidates.begin(), candidates.end(), same) - candidates.begin());
        REQUIRE(at < candidates.size());
        CHECK(double(v.flux.s[0]) == Approx(3.0 * total / (31.0 * weights[at])).epsilon(kTwinRounding));
    }
    LWLight light{};
    light.structSize = sizeof light;
    light.rsmCount = 1;
    frame = seen.frame(0);
    VplViewSampling::check(rig.device(), frame);  // nothing to draw, nothing to see
    frame.lights = &light;
    frame.lightCount = 1;
    CHECK(thrown([&] { VplViewSampling::check(rig.device(), frame); }).says("frame.sourceViews: expected"));
    LWGBuffer bare = seen.gbuffer;
    bare.normal = LWImage{};
    const LWSourceView broken{nullptr, &bare};
    frame.sourceViews = &broken;
    frame.sourceViewCount = 1;
    CHECK(thrown([&] { VplViewSampling::check(rig.device(), frame); }).says("frame.sourceViews[0].gbuffer.normal"));
}
