// Light that strict look-ups doubt: what the gather leaves of it for the filter, and how much of it counts in the end. Some lines over 300: one
// scene serves all.
#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <random>

#include "passes/clustered_gather.h"
#include "passes/interleaved_gather.h"
#include "passes/vpl_list.h"
#include "support/gather_rig.h"
#include "support/paraboloid_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Image;
using reference::Vec;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr double kTwinTolerance = 2e-5;

double channelSum(Vec v) { return v.x + v.y + v.z; }

// docs/techniques/ssvp_visibility.md: S + D / (1 + (D / 2S)^2), over S + D.
double shareBorneOut(double light, double doubt) {
    const double sure = light - doubt, far = doubt / (2.0 * sure);
    if (light <= 0.0) return 1.0;
    return sure > 0.0 ? (sure + doubt / (1.0 + far * far)) / light : 0.0;
}
// docs/techniques/ssvp_visibility.md: of light U that nobody looked after shadowed light S bears 1 / (1 + (U / 16S)^2) out; a quarter counts anyway.
constexpr double kLeast = 0.25;
double shareOfUnshadowed(double shadowed, double unshadowed) {
    const double far = unshadowed / (16.0 * shadowed);
    return shadowed > 0.0 ? std::max(1.0 / (1.0 + far * far), kLeast) : kLeast;
}

// A floor under leaves, lit by clusters of VPLs around it.
struct Leaves {
    static constexpr int kClusters = 5, kEach = 6;
    Mesh mesh;
    std::vector<lw_cluster> clusters;
    std::vector<lw_vpl> vpls;
    std::vector<cl_int> assignment;
    Image position, normal;

    Leaves(std::uint32_t w, std::uint32_t h) : position(w, h), normal(w, h) {
        mesh.addQuad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 2, 2);
        for (int i = 0; i < 6; ++i) mesh.addQuad({-0.8 + 0.25 * i, -0.5 + 0.1 * i, 0.15 + 0.03 * i}, {0.2, 0.05, 0}, {0, 0.5, 0.1});
        for (int c = 0; c < kClusters; ++c) {
            const Vec place{-0.9 + 0.45 * c, 0.9 - 0.4 * c, 0.7};
            clusters.push_back(clusterAt(place, {0.2 - 0.1 * c, 0.1, -1}));
            for (int k = 0; k < kEach; ++k) {
                vpls.push_back(reference::makeVpl(place + Vec{0.01 * k, 0, 0}, reference::vecOf(clusters.back().normal), {1.0 + c, 2.0, 0.3 * k}, 0.01));
                assignment.push_back(c);
            }
        }
        for (std::uint32_t y = 0; y < h; ++y)
            for (std::uint32_t x = 0; x < w; ++x) {
                position.set(x, y, {-1.0 + 2.0 * (x + 0.5) / w, -1.0 + 2.0 * (y + 0.5) / h, 0.0});
                normal.set(x, y, {0, 0, 1});
            }
        for (const std::uint32_t hole : {3u, 8u}) normal.set(hole, 2, {0, 0, 0});
    }
};

// Of the leaves' floor: so many planes of the gather, or what each cluster is taken to see.
struct Asked {
    ParaboloidRig& rig;
    const Leaves& leaves;
    ClusteredGather pass;

    // later: VPLs of a further bounce, without clusters.
    Asked(ParaboloidRig& r, const Leaves& l, ClusterVisibility visibility, const std::vector<lw_vpl>& later = {}, bool isUnshadowed = true)
        : rig(r), leaves(l), pass(r.device(), 1, 1, visibility) {
        const Guarded list = rig.upload(leaves.vpls), assignment = rig.upload(leaves.assignment);
        const Guarded further = rig.upload(later.empty() ? leaves.vpls : later);  // no buffer is empty
        std::vector<GatheredList> lists{{{list, std::uint32_t(leaves.vpls.size())}, &assignment, std::uint32_t(Leaves::kClusters)}};
        if (!later.empty()) lists.push_back({{further, std::uint32_t(later.size())}, nullptr, 0, isUnshadowed});
        pass.recordOrder(rig.executor(), lists);
        rig.device().finish();
    }
    ClusterMaps maps() const { return {{{&rig.pass.frames(), &rig.pass.records(), rig.pass.mapCount()}}, rig.pass.size()}; }

    std::vector<float> planes(std::uint32_t count) {
        const std::uint32_t w = leaves.position.width, h = leaves.position.height;
        const Guarded p = rig.uploadPlanes(leaves.position.planes, w, h, 3, kNaN), n = rig.uploadPlanes(leaves.normal.planes, w, h, 3, kNaN);
        const Guarded out = rig.makePlanes(w, h, count), counts = rig.upload(std::vector<cl_int>{0, 0, 0});
        const lw_vpl_tiles layout = VplTiles::layout(w, h, pass.order(), 1);
        const Guarded all = rig.upload(allSlots(layout, pass.order()));
        pass.recordGather(rig.executor(), rig.planes(p, w, h, 3), rig.planes(n, w, h, 3), all, layout, maps(), rig.planes(out, w, h, count), counts);
        rig.device().finish();
        return rig.downloadPlanes(rig.planes(out, w, h, count));
    }
    std::vector<float> seen() {
        const std::uint32_t w = leaves.position.width, h = leaves.position.height;
        const Guarded p = rig.uploadPlanes(leaves.position.planes, w, h, 3, kNaN), n = rig.uploadPlanes(leaves.normal.planes, w, h, 3, kNaN);
        const std::uint32_t rows = h * Leaves::kClusters;
        const Guarded out = rig.makePlanes(w, rows, 1);
        pass.recordVisibility(rig.executor(), rig.planes(p, w, h, 3), rig.planes(n, w, h, 3), maps(), Leaves::kClusters, rig.planes(out, w, rows, 1));
        rig.device().finish();
        return rig.downloadPlanes(rig.planes(out, w, rows, 1));
    }
    // Two bands: c0, c1.x, c1.y, c1.z one below the other, three planes.
    std::vector<float> harmonics(ClusterVisibility visibility, bool hasNormals = true) {
        const std::uint32_t w = leaves.position.width, h = leaves.position.height;
        const Guarded p = rig.uploadPlanes(leaves.position.planes, w, h, 3, kNaN), n = rig.uploadPlanes(leaves.normal.planes, w, h, 3, kNaN);
        const Guarded out = rig.makePlanes(w, 4 * h, 3), counts = rig.upload(std::vector<cl_int>{0, 0, 0});
        const Planes all = rig.planes(out, w, 4 * h, 3);
        ClusteredHarmonics bands(rig.device(), visibility);
        bands.record(rig.executor(), rig.planes(p, w, h, 3), hasNormals ? rig.planes(n, w, h, 3) : Planes{}, pass, maps(), {all, cl_int(all.rowStride * h)}, counts);
        rig.device().finish();
        return rig.downloadPlanes(all);
    }
};

Image filtered(KernelRig& rig, const Image& position, const Image& normal, const std::vector<float>& light, std::uint32_t count) {
    const std::uint32_t w = position.width, h = position.height;
    const Guarded p = rig.uploadPlanes(position.planes, w, h, 3, kNaN), n = rig.uploadPlanes(normal.planes, w, h, 3, kNaN);
    const Guarded e = rig.uploadPlanes(light, w, h, count, kNaN), out = rig.makePlanes(w, h, 3);
    InterleavedGather pass(rig.device(), 4, count == 4);
    pass.recordFilter(rig.executor(), rig.planes(p, w, h, 3), rig.planes(n, w, h, 3), rig.planes(e, w, h, count), rig.planes(out, w, h, 3));
    rig.device().finish();
    Image result(w, h);
    result.planes = rig.downloadPlanes(rig.planes(out, w, h, 3));
    return result;
}

}  // namespace

TEST_CASE("a strict gather is the hard one, and the light that it doubts is that of marked texels", "[clustered_gather]") {
    const auto width = GENERATE(1u, 16u);
    const auto size = testSize({75, 33});
    const Leaves leaves(size.first, size.second);
    ParaboloidRig rig(width, 64, true);
    rig.draw(leaves.mesh, leaves.clusters);
    Asked hard(rig, leaves, ClusterVisibility::hard), strict(rig, leaves, ClusterVisibility::strict);
    const std::vector<float> light = hard.planes(3), kept = strict.planes(4), settled = strict.planes(3);
    const std::vector<float> seen = hard.seen(), sure = strict.seen();
    const std::size_t pixels = std::size_t(size.first) * size.second;
    CHECK(bitDifference(std::vector<float>(kept.begin(), kept.begin() + std::ptrdiff_t(3 * pixels)), light) == "");
    int doubtful = 0, wrong = 0, unsettled = 0;
    for (std::uint32_t y = 0; y < size.second; ++y)
        for (std::uint32_t x = 0; x < size.first; ++x) {
            const std::size_t i = std::size_t(y) * size.first + x;
            const reference::Surface s = reference::surfaceAt(leaves.position, leaves.normal, x, y);
            double doubt = 0.0, all = 0.0;
            for (std::size_t k = 0; s.valid && k < leaves.vpls.size(); ++k) {
                const std::size_t at = std::size_t(leaves.assignment[k]) * pixels + i;
                const double sum = channelSum(reference::vplIrradiance(leaves.vpls[k], s));
                REQUIRE(sure[at] <= seen[at]);
                doubt += sum * double(seen[at] - sure[at]);
                all += sum * double(seen[at]);
            }
            doubtful += doubt > 0.0;
            wrong += !(std::abs(double(kept[3 * pixels + i]) - doubt) <= kTwinTolerance * all + 1e-9);
            for (std::size_t c = 0; c < 3; ++c) {
                const double expected = double(light[c * pixels + i]) * shareBorneOut(all, doubt);
                unsettled += !(std::abs(double(settled[c * pixels + i]) - expected) <= 10.0 * kTwinTolerance * all + 1e-9);
            }
        }
    CAPTURE(doubtful);
    CHECK(wrong == 0);
    CHECK(unsettled == 0);
    if (pixels > 2000) CHECK(doubtful > 100);
}

TEST_CASE("doubtful light in two bands counts as far as light from all sides bears it out", "[clustered_gather]") {
    const auto width = GENERATE(1u, 16u);
    const auto size = testSize({75, 33});
    const Leaves leaves(size.first, size.second);
    ParaboloidRig rig(width, 64, true);
    rig.draw(leaves.mesh, leaves.clusters);
    Asked hard(rig, leaves, ClusterVisibility::hard), strict(rig, leaves, ClusterVisibility::strict);
    const std::vector<float> light = hard.harmonics(ClusterVisibility::hard), kept = strict.harmonics(ClusterVisibility::strict);
    const std::vector<float> seen = hard.seen(), sure = strict.seen();
    const std::size_t pixels = std::size_t(size.first) * size.second;
    int wrong = 0;
    for (std::uint32_t y = 0; y < size.second; ++y)
        for (std::uint32_t x = 0; x < size.first; ++x) {
            const std::size_t i = std::size_t(y) * size.first + x;
            const reference::Surface s = reference::surfaceAt(leaves.position, leaves.normal, x, y);
            double doubt = 0.0, all = 0.0;
            for (std::size_t k = 0; s.valid && k < leaves.vpls.size(); ++k) {
                const std::size_t at = std::size_t(leaves.assignment[k]) * pixels + i;
                const lw_vpl& vpl = leaves.vpls[k];
                const Vec to = Vec{vpl.positionArea.s[0], vpl.positionArea.s[1], vpl.positionArea.s[2]} - s.position;
                const double facing = channelSum(reference::vplIrradiance(vpl, {s.position, reference::unit(to), true}));
                doubt += facing * double(seen[at] - sure[at]);
                all += facing * double(seen[at]);
            }
            for (std::size_t value = i; value < light.size(); value += pixels)
                wrong += !(std::abs(double(kept[value]) - double(light[value]) * shareBorneOut(all, doubt)) <= 10.0 * kTwinTolerance * all + 1e-9);
        }
    CHECK(wrong == 0);
    if (pixels > 2000) CHECK(bitDifference(light, kept) != "");
}

// The floor under leaves, and VPLs of a bounce that nothing shadows, from a hundredth to a thousand times as bright as what else lights it.
struct LaterBounce {
    Leaves leaves;
    ParaboloidRig rig;
    std::vector<lw_vpl> later;
    std::size_t pixels;

    LaterBounce(std::uint32_t width, std::pair<std::uint32_t, std::uint32_t> size)
        : leaves(size.first, size.second), rig(width, 64, true), pixels(std::size_t(size.first) * size.second) {
        rig.draw(leaves.mesh, leaves.clusters);
        for (int k = 0; k < 7; ++k) later.push_back(reference::makeVpl({-0.9 + 0.3 * k, -0.6, 0.25}, {0, 0, -1}, {0.02 * std::pow(8.0, k), 0.1, 0.1}, 0.02));
    }
    Asked shadowed(ClusterVisibility visibility) { return {rig, leaves, visibility}; }
    Asked all(ClusterVisibility visibility, bool isUnshadowed) { return {rig, leaves, visibility, later, isUnshadowed}; }
    reference::Surface surface(std::size_t i) const {
        const std::uint32_t w = leaves.position.width;
        return reference::surfaceAt(leaves.position, leaves.normal, std::uint32_t(i % w), std::uint32_t(i / w));
    }
};

TEST_CASE("light of bounces without shadows counts as far as shadowed light bears it out", "[clustered_gather]") {
    LaterBounce scene(GENERATE(1u, 16u), testSize({75, 33}));
    const std::size_t pixels = scene.pixels;
    Asked strict = scene.all(ClusterVisibility::strict, true);
    const std::vector<float> before = scene.shadowed(ClusterVisibility::hard).planes(3), all = scene.all(ClusterVisibility::hard, false).planes(3),
                             doubt = scene.shadowed(ClusterVisibility::strict).planes(4), kept = strict.planes(4), settled = strict.planes(3);
    int little = 0, much = 0, wrong = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        const reference::Surface s = scene.surface(i);
        double unshadowed = 0.0, lit = 0.0;
        for (std::size_t k = 0; s.valid && k < scene.later.size(); ++k) unshadowed += channelSum(reference::vplIrradiance(scene.later[k], s));
        for (std::size_t c = i; c < 3 * pixels; c += pixels) lit += double(before[c]);
        const double share = shareOfUnshadowed(lit, unshadowed), counts = lit + share * unshadowed, tolerance = 20.0 * kTwinTolerance * counts + 1e-9;
        const double after = shareBorneOut(counts, double(doubt[3 * pixels + i]));
        little += s.valid && share == kLeast;
        much += s.valid && share > 0.99;
        wrong += !(std::abs(double(kept[3 * pixels + i]) - double(doubt[3 * pixels + i])) <= tolerance);
        for (std::size_t c = i; c < 3 * pixels; c += pixels) {
            // Each channel keeps its own shadowed light, whatever the colour of the leak.
            const double expected = double(before[c]) + share * (double(all[c]) - double(before[c]));
            wrong += !(std::abs(double(kept[c]) - expected) <= tolerance);
            wrong += !(std::abs(double(settled[c]) - after * expected) <= tolerance);
        }
    }
    CAPTURE(little, much);
    CHECK(wrong == 0);
    if (pixels > 2000) CHECK((little > 100 && much > 100));
}

TEST_CASE("light of bounces without shadows counts in two bands, by light from all sides", "[clustered_gather][large]") {
    LaterBounce scene(GENERATE(1u, 16u), testSize({75, 33}));
    const auto bands = [](Asked asked, ClusterVisibility visibility) { return asked.harmonics(visibility); };
    const std::vector<float> before = bands(scene.shadowed(ClusterVisibility::hard), ClusterVisibility::hard),
                             all = bands(scene.all(ClusterVisibility::hard, false), ClusterVisibility::hard),
                             kept = bands(scene.all(ClusterVisibility::strict, true), ClusterVisibility::strict);
    const std::vector<float> seen = scene.shadowed(ClusterVisibility::hard).seen(), sure = scene.shadowed(ClusterVisibility::strict).seen();
    int wrong = 0;
    for (std::size_t i = 0; i < scene.pixels; ++i) {
        const reference::Surface s = scene.surface(i);
        const auto facing = [&](const lw_vpl& vpl) {
            const Vec to = Vec{vpl.positionArea.s[0], vpl.positionArea.s[1], vpl.positionArea.s[2]} - s.position;
            return channelSum(reference::vplIrradiance(vpl, {s.position, reference::unit(to), true}));
        };
        double lit = 0.0, doubt = 0.0, unshadowed = 0.0;
        for (std::size_t k = 0; s.valid && k < scene.leaves.vpls.size(); ++k) {
            const std::size_t at = std::size_t(scene.leaves.assignment[k]) * scene.pixels + i;
            lit += facing(scene.leaves.vpls[k]) * double(seen[at]);
            doubt += facing(scene.leaves.vpls[k]) * double(seen[at] - sure[at]);
        }
        for (std::size_t k = 0; s.valid && k < scene.later.size(); ++k) unshadowed += facing(scene.later[k]);
        const double share = shareOfUnshadowed(lit, unshadowed), counts = lit + share * unshadowed, after = shareBorneOut(counts, doubt);
        for (std::size_t value = i; value < all.size(); value += scene.pixels) {
            const double expected = double(before[value]) + share * (double(all[value]) - double(before[value]));
            wrong += !(std::abs(double(kept[value]) - after * expected) <= 20.0 * kTwinTolerance * counts + 1e-9);
        }
    }
    CHECK(wrong == 0);
}

// Without normals a point is seen from all sides. What faces each VPL gets is c0, but for a factor.
TEST_CASE("light of bounces without shadows is borne out at points without normals, too", "[clustered_gather][large]") {
    LaterBounce scene(GENERATE(1u, 16u), testSize({75, 33}));
    const auto bands = [](Asked asked, ClusterVisibility visibility) { return asked.harmonics(visibility, false); };
    const std::vector<float> before = bands(scene.shadowed(ClusterVisibility::hard), ClusterVisibility::hard),
                             sure = bands(scene.shadowed(ClusterVisibility::strict), ClusterVisibility::strict),
                             all = bands(scene.all(ClusterVisibility::hard, false), ClusterVisibility::hard),
                             kept = bands(scene.all(ClusterVisibility::strict, true), ClusterVisibility::strict);
    const std::size_t plane = 4 * scene.pixels;
    int little = 0, much = 0, wrong = 0;
    for (std::size_t i = 0; i < scene.pixels; ++i) {
        double lit = 0.0, sum = 0.0, certain = 0.0;
        for (std::size_t c = i; c < before.size(); c += plane) {
            lit += double(before[c]);
            certain += double(sure[c]);
            sum += double(all[c]);
        }
        if (certain != lit) continue;  // beside a rim: the other tests'
        const double share = shareOfUnshadowed(lit, sum - lit);
        little += share == kLeast;
        much += share > 0.9;
        for (std::size_t value = i; value < all.size(); value += scene.pixels) {
            const double expected = double(before[value]) + share * (double(all[value]) - double(before[value]));
            wrong += !(std::abs(double(kept[value]) - expected) <= 20.0 * kTwinTolerance * (lit + share * (sum - lit)) + 1e-9);
        }
    }
    CAPTURE(little, much);
    CHECK(wrong == 0);
    if (scene.pixels > 2000) CHECK((little > 100 && much > 100));
}

TEST_CASE("hard gathers trust all light without shadows, and strict ones what somebody vouches for", "[clustered_gather][large]") {
    LaterBounce scene(GENERATE(1u, 16u), testSize({75, 33}));
    const std::vector<float> light = scene.all(ClusterVisibility::hard, false).planes(3), strict = scene.all(ClusterVisibility::strict, false).planes(4);
    CHECK(bitDifference(scene.all(ClusterVisibility::hard, true).planes(3), light) == "");
    CHECK(bitDifference(std::vector<float>(strict.begin(), strict.begin() + std::ptrdiff_t(3 * scene.pixels)), light) == "");
}

TEST_CASE("light without shadows that is beyond all floats leaves the shadowed light as it is", "[clustered_gather][large]") {
    LaterBounce scene(GENERATE(1u, 16u), testSize({75, 33}));
    for (const float flux : {3e38f, 1e36f}) {  // many of the pixels' sums overflow, or none
        for (lw_vpl& vpl : scene.later)
            for (int c = 0; c < 3; ++c) vpl.flux.s[c] = flux;
        Asked strict = scene.all(ClusterVisibility::strict, true), shadowed = scene.shadowed(ClusterVisibility::strict);
        const std::vector<float> before = scene.shadowed(ClusterVisibility::hard).planes(3);
        const std::size_t pixels = scene.pixels;
        const auto same = [](float a, float b) { return std::abs(double(a) - double(b)) <= 1e-6 * std::abs(double(b)); };
        // For a filter that settles doubt (light, then its doubtful part, too), by each pixel, and at points. Where the sum is finite, a quarter
        // of it counts, as far as outputs go.
        const std::vector<float> kept = strict.planes(4), doubtful = shadowed.planes(4), settled = strict.planes(3), sure = shadowed.planes(3);
        constexpr double kMost = std::numeric_limits<float>::max() / 3.14159265358979, kLargest = 1e36;  // of sums, which lack 1 / pi; of outputs
        std::vector<bool> isBeyond(pixels);
        int wrong = 0, beyond = 0, within = 0, uncapped = 0;
        for (std::size_t i = 0; i < pixels; ++i) {
            const reference::Surface s = scene.surface(i);
            Vec unshadowed{};
            for (std::size_t k = 0; s.valid && k < scene.later.size(); ++k) unshadowed = unshadowed + reference::vplIrradiance(scene.later[k], s);
            const double sum = channelSum(unshadowed);
            if (s.valid && sum > 0.25 * kMost && sum < 1.01 * kMost) continue;  // either: a VPL's factors may overflow before
            isBeyond[i] = s.valid && sum > kMost;
            beyond += isBeyond[i];
            within += s.valid && !isBeyond[i];
            wrong += isBeyond[i] && !same(kept[3 * pixels + i], doubtful[3 * pixels + i]);
            const double brings[3] = {unshadowed.x, unshadowed.y, unshadowed.z};
            for (std::size_t c = 0; c < 3; ++c) {
                const std::size_t at = c * pixels + i;
                const double expected = std::min(double(before[at]) + 0.25 * brings[c], kLargest);
                uncapped += s.valid && !isBeyond[i] && expected < kLargest;
                wrong += !(isBeyond[i] ? same(kept[at], before[at]) : std::abs(double(kept[at]) - expected) <= 2e-3 * expected);
                wrong += !(isBeyond[i] ? same(settled[at], sure[at]) : settled[at] >= 0.0f && settled[at] <= float(kLargest));
            }
        }
        CAPTURE(flux, beyond, within, uncapped);
        CHECK(wrong == 0);
        CHECK((beyond > 0) == (flux > 1e38f));
        CHECK(within > 0);
        CHECK(uncapped > (flux > 1e38f ? 0 : 2 * within));
        // Points see light from all sides: more of them are beyond all floats.
        const std::vector<float> bands = strict.harmonics(ClusterVisibility::strict), without = shadowed.harmonics(ClusterVisibility::strict);
        int wrongBands = 0;
        for (std::size_t i = 0; i < bands.size(); ++i) wrongBands += !std::isfinite(bands[i]) || (isBeyond[i % pixels] && !same(bands[i], without[i]));
        CHECK(wrongBands == 0);
    }
}

TEST_CASE("the filter bears doubtful light out by what surrounds it", "[clustered_gather]") {
    const auto width = GENERATE(1u, 16u);
    const auto size = testSize({67, 21});
    const std::size_t pixels = std::size_t(size.first) * size.second;
    KernelRig rig(width);
    Image position(size.first, size.second), normal(size.first, size.second);
    reference::fillCorner(position, normal);
    const Image light = reference::randomImage(size.first, size.second, 4);
    std::vector<float> four = light.planes;
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    Image doubt(size.first, size.second);
    for (std::size_t i = 0; i < pixels; ++i) {
        const float share = unit(random), sum = four[i] + four[pixels + i] + four[2 * pixels + i];
        doubt.planes[i] = sum * (share < 0.3f ? 0.0f : share > 0.7f ? 1.0f : share);
    }
    four.insert(four.end(), doubt.planes.begin(), doubt.planes.begin() + std::ptrdiff_t(pixels));

    SECTION("as much as the mean over the window tells") {
        const Image plain = filtered(rig, position, normal, light.planes, 3), mean = filtered(rig, position, normal, doubt.planes, 3);
        Image expected(size.first, size.second);
        for (std::uint32_t y = 0; y < size.second; ++y)
            for (std::uint32_t x = 0; x < size.first; ++x)
                expected.set(x, y, plain.get(x, y) * shareBorneOut(channelSum(plain.get(x, y)), mean.get(x, y).x));
        CHECK(disagreement(filtered(rig, position, normal, four, 4).planes, expected.planes, kTwinTolerance) == "");
    }
    SECTION("nothing doubtful: the same bits as without; all doubtful: nothing") {
        std::fill(four.begin() + std::ptrdiff_t(3 * pixels), four.end(), 0.0f);
        CHECK(bitDifference(filtered(rig, position, normal, four, 4).planes, filtered(rig, position, normal, light.planes, 3).planes) == "");
        for (std::size_t i = 0; i < pixels; ++i) four[3 * pixels + i] = 1.001f * (four[i] + four[pixels + i] + four[2 * pixels + i]);
        const Image none = filtered(rig, position, normal, four, 4);
        CHECK(std::all_of(none.planes.begin(), none.planes.end(), [](float v) { return std::abs(v) < 1e-6f; }));
    }
    SECTION("nothing depends on the unit of light") {
        const Image once = filtered(rig, position, normal, four, 4);
        for (const float unitOfLight : {0x1p-70f, 0x1p70f}) {
            std::vector<float> scaled = four;
            for (float& v : scaled) v *= unitOfLight;
            Image back = filtered(rig, position, normal, scaled, 4);
            for (float& v : back.planes) v /= unitOfLight;
            CHECK(bitDifference(back.planes, once.planes) == "");
        }
    }
}
