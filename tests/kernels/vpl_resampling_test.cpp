// VPLs that tiles draw and pixels resample: each draw's weight against what it stands for, one pixel's choice against a serial
// twin in double, and means over many frames against the light of all VPLs.
#include "passes/vpl_resampling.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "passes/interleaved_gather.h"
#include "passes/vpl_list.h"
#include "support/paraboloid_rig.h"
#include "support/vpl_slots.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Image;
using reference::Vec;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// VPLs around a corner, two bounces' with clusters; one in seven carries no flux, as the slots that pad a list.
std::vector<lw_vpl> randomList(std::uint32_t count, bool grey) {
    std::vector<lw_vpl> list = reference::randomVpls(count, 7);
    for (std::uint32_t k = 0; k < count; ++k) {
        lw_vpl& v = list[k];
        if (grey) v.flux.s[1] = v.flux.s[2] = v.flux.s[0];
        if (k % 7 == 3) v.flux = {};
        v.flux.s[3] = float(k * 8 / count);
    }
    return list;
}

struct Frame {
    std::vector<float> light;
    std::vector<lw_vpl_draw> draws;
};

// An image, its list, and what the pass makes of them in a frame.
struct Drawn {
    KernelRig& rig;
    VplResampling pass;
    Image position, normal;
    Guarded p, n, list, out, none;
    std::uint32_t slots;
    VplDraws memory;

    Drawn(KernelRig& on, const VplResamplingOptions& options, const Image& places, const Image& normals, const std::vector<lw_vpl>& vpls)
        : rig(on),
          pass(on.device(), options),
          position(places),
          normal(normals),
          p(on.uploadPlanes(places.planes, places.width, places.height, 3, kNaN)),
          n(on.uploadPlanes(normals.planes, places.width, places.height, 3, 1.0f)),
          list(on.upload(vpls)),
          out(on.makePlanes(places.width, places.height, 3)),
          none(on.upload(std::vector<float>(64, 0.0f))),
          slots(std::uint32_t(vpls.size())) {
        memory.reserve(on.device(), options, slots, places.width, places.height);
    }
    Frame frame(std::uint32_t turn, const ClusterMaps* maps = nullptr) {
        const std::uint32_t w = position.width, h = position.height;
        const Planes surfaces[2] = {rig.planes(p, w, h, 3), rig.planes(n, w, h, 3)}, light = rig.planes(out, w, h, 3);
        const ClusterMaps unread{none, none, none, none, 8, 64};
        const Guarded counts = rig.upload(std::vector<cl_int>{0, 0, 0});
        pass.recordBlocks(rig.executor(), list, slots, 3, turn);
        pass.recordDraw(rig.executor(), surfaces[0], surfaces[1], list, memory);
        pass.recordGather(rig.executor(), surfaces[0], surfaces[1], list, memory, maps ? *maps : unread, light, counts);
        rig.device().finish();
        Frame result;
        result.light = rig.downloadPlanes(light);
        result.draws.resize(memory.list().bytes() / sizeof(lw_vpl_draw));
        memory.list().download(0, memory.list().bytes(), result.draws.data());
        return result;
    }
};

VplResamplingOptions optionsOf(std::uint32_t n, std::uint32_t candidates, std::uint32_t survivors,
                               ClusterVisibility visibility = ClusterVisibility::none) {
    return {n, n == 1 ? 1u : 4u, candidates, survivors, visibility};
}

std::vector<float> lightOfAll(const Image& position, const Image& normal, const std::vector<lw_vpl>& list) {
    return reference::gather(position, normal, list, orderOf(list.size(), 1), 1).planes;
}

// Mean over frames and its standard error, value by value.
struct Means {
    std::vector<double> sum, squares;
    int count = 0;
    void add(const std::vector<float>& values) {
        sum.resize(values.size());
        squares.resize(values.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            sum[i] += values[i];
            squares[i] += double(values[i]) * values[i];
        }
        ++count;
    }
    // The mean of (mean - expected)^2 over the mean's variance, 1 if nothing is biased; and of the sums over all values.
    std::array<double, 2> deviations(const std::vector<float>& expected) const {
        double chi = 0.0, all = 0.0, expectedAll = 0.0;
        int used = 0;
        for (std::size_t i = 0; i < sum.size(); ++i) {
            const double mean = sum[i] / count, variance = (squares[i] / count - mean * mean) / (count - 1);
            all += mean;
            expectedAll += expected[i];
            // What every frame has alike is compared as such.
            if (variance <= 1e-10 * expected[i] * expected[i]) continue;
            chi += (mean - expected[i]) * (mean - expected[i]) / variance;
            ++used;
        }
        return {chi / used, all / expectedAll};
    }
};

double relativeError(const std::vector<float>& light, const std::vector<float>& expected) {
    double error = 0.0, whole = 0.0;
    for (std::size_t i = 0; i < light.size(); ++i) {
        error += (double(light[i]) - expected[i]) * (double(light[i]) - expected[i]);
        whole += double(expected[i]) * expected[i];
    }
    return std::sqrt(error / whole);
}

// The random number of a pixel's run, as the kernel's head defines it.
double numberOf(std::uint32_t x, std::uint32_t y, std::uint32_t n, std::uint32_t number, int run, std::uint32_t key) {
    std::uint32_t h = (x / n + (y / n) * 0x10001u) * 0x9e3779b1u + (key ^ (std::uint32_t(run + 1) * 0x9e3779b9u));
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    h ^= h >> 16;
    return ((h + number * (0xffffffffu / (n * n) + 1u)) >> 8) / 16777216.0;
}

std::uint32_t numberOfPixel(std::uint32_t x, std::uint32_t y, std::uint32_t n) {
    const std::uint32_t row = y % n, column = x % n;
    std::uint32_t number = 0;
    for (std::uint32_t bit = 0; (1u << bit) < n; ++bit)
        number |= (((row ^ column) >> bit & 1u) << (2 * bit)) | ((row >> bit & 1u) << (2 * bit + 1));
    return number;
}

// A pixel's light without visibility, from the draws that the kernel has read.
Vec twin(const Drawn& drawn, const Frame& frame, const std::vector<lw_vpl>& list, std::uint32_t x, std::uint32_t y) {
    const VplResamplingOptions& o = drawn.pass.options();
    const std::uint32_t n = o.interleave, number = numberOfPixel(x, y, n);
    const lw_vpl_tiles tiles = VplTiles::layout(drawn.position.width, drawn.position.height, orderOf(1, 1), n);
    const std::size_t tile = y / LW_TILE_ROWS * std::uint32_t(tiles.columns) + x / std::uint32_t(tiles.tileWidth);
    const lw_vpl_draw* own = frame.draws.data() + (tile * n * n + number) * o.candidates;
    const reference::Surface s = reference::surfaceAt(drawn.position, drawn.normal, x, y);
    Vec light;
    for (std::uint32_t k = 0; s.valid && k < o.survivors; ++k) {
        const std::uint32_t from = o.candidates * k / o.survivors, to = o.candidates * (k + 1) / o.survivors;
        const auto brings = [&](std::uint32_t i) {
            return reference::vplIrradiance(list[std::size_t(own[i].slot)], s) * (double(own[i].weight) * n * n);
        };
        const auto luminance = [](Vec v) { return 0.2126 * v.x + 0.7152 * v.y + 0.0722 * v.z; };
        double whole = 0.0, passed = 0.0;
        for (std::uint32_t i = from; i < to; ++i) whole += luminance(brings(i));
        const double target = whole * numberOf(x, y, n, number, int(k), drawn.pass.key());
        for (std::uint32_t i = from; i < to; ++i) {
            const double here = luminance(brings(i));
            if (here > 0.0 && passed <= target && target < passed + here) light = light + brings(i) * (whole / here);
            passed += here;
        }
    }
    return light;
}

}  // namespace

TEST_CASE("draws of a tile stand for all VPLs that light it", "[vpl_resampling]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    Image position(70, 9), normal(70, 9);
    reference::fillCorner(position, normal);
    const std::vector<lw_vpl> list = randomList(600, false);  // blocks of three
    Drawn drawn(rig, optionsOf(2, 8, 2), position, normal, list);
    const std::size_t perTile = 32, tiles = 6;
    std::vector<double> stands(tiles * list.size());
    constexpr int kFrames = 64;
    for (int f = 0; f < kFrames; ++f) {
        const Frame frame = drawn.frame(std::uint32_t(f));
        REQUIRE(frame.draws.size() == tiles * perTile);
        for (std::size_t i = 0; i < frame.draws.size(); ++i)
            stands[i / perTile * list.size() + std::size_t(frame.draws[i].slot)] += frame.draws[i].weight;
    }
    // Of the VPLs together; each for itself is drawn too seldom to say.
    for (std::size_t t = 0; t < tiles; ++t) {
        double sum = 0.0, lit = 0.0;
        for (std::size_t k = 0; k < list.size(); ++k) {
            const bool dark = list[k].flux.s[0] == 0.0f;
            if (dark) CHECK(stands[t * list.size() + k] == 0.0);
            sum += stands[t * list.size() + k] / kFrames;
            lit += dark ? 0 : 1;
        }
        CAPTURE(t, sum, lit);
        // No more than all, and half of the directions are behind a surface at most for flat tiles.
        CHECK(sum < 1.1 * lit);
        CHECK(sum > 0.2 * lit);
    }
}

TEST_CASE("a pixel keeps the candidates that its serial twin keeps", "[vpl_resampling]") {
    const auto width = GENERATE(1u, 16u);
    const auto n = GENERATE(1u, 4u);
    KernelRig rig(width);
    Image position(75, 19), normal(75, 19);
    reference::fillCorner(position, normal);
    const std::vector<lw_vpl> list = randomList(500, false);
    Drawn drawn(rig, optionsOf(n, 13, 3), position, normal, list);
    const Frame frame = drawn.frame(5);
    Image expected(position.width, position.height);
    for (std::uint32_t y = 0; y < position.height; ++y)
        for (std::uint32_t x = 0; x < position.width; ++x) expected.set(x, y, twin(drawn, frame, list, x, y));
    // Float against double; a choice between two falls the other way where the number hits its limit.
    CHECK(disagreement(frame.light, expected.planes, 5e-5, 2e-3) == "");
}

TEST_CASE("the mean over frames is the light of all VPLs", "[vpl_resampling]") {
    const auto n = GENERATE(1u, 4u);
    const auto survivors = GENERATE(1u, 4u);
    KernelRig rig(16);
    Image position(61, 13), normal(61, 13);
    reference::fillCorner(position, normal);
    const std::vector<lw_vpl> list = randomList(300, false);
    Drawn drawn(rig, optionsOf(n, 8, survivors), position, normal, list);
    Means means;
    for (std::uint32_t f = 0; f < 400; ++f) means.add(drawn.frame(f).light);
    const auto [chi, energy] = means.deviations(lightOfAll(position, normal, list));
    CAPTURE(n, survivors, chi, energy);
    // 1 but for what the variances' own estimates and neighbours with common draws leave open; a bias of one standard error
    // in every value would make it 2.
    CHECK(chi < 1.3);
    CHECK(std::abs(energy - 1.0) < 0.01);
}

TEST_CASE("more candidates leave less error, in proportion at least", "[vpl_resampling]") {
    KernelRig rig(16);
    Image position(64, 16), normal(64, 16);
    reference::fillCorner(position, normal);
    const std::vector<lw_vpl> list = randomList(300, true);
    const std::vector<float> all = lightOfAll(position, normal, list);
    std::vector<double> errors;
    for (const std::uint32_t candidates : {4u, 16u, 64u}) {
        Drawn drawn(rig, optionsOf(1, candidates, 4), position, normal, list);
        double squares = 0.0;
        for (std::uint32_t f = 0; f < 8; ++f) squares += std::pow(relativeError(drawn.frame(f).light, all), 2);
        errors.push_back(std::sqrt(squares / 8));
    }
    // Without visibility grey light has no error but that of the source: a root of its variance by their number.
    CAPTURE(errors[0], errors[1], errors[2]);
    CHECK(errors[1] < 0.6 * errors[0]);
    CHECK(errors[2] < 0.6 * errors[1]);
    CHECK(errors[2] < 0.15);
}

// Inside a sphere that is lit evenly, every point receives what the sphere sends per area.
TEST_CASE("furnace: a sphere of VPLs lights its inside evenly", "[vpl_resampling]") {
    KernelRig rig(16);
    constexpr std::uint32_t kCount = 4096;
    const double pi = 3.14159265358979323846;
    std::vector<lw_vpl> list;
    for (std::uint32_t k = 0; k < kCount; ++k) {
        const double z = 1.0 - 2.0 * (k + 0.5) / kCount, r = std::sqrt(1.0 - z * z), a = k * 2.399963229728653;
        const Vec on{r * std::cos(a), r * std::sin(a), z};
        list.push_back(reference::makeVpl(on, on * -1.0, Vec{3.0, 2.0, 1.0} * (4.0 * pi / kCount), 4.0 * pi / kCount));
    }
    Image position(64, 16), normal(64, 16);
    for (std::uint32_t y = 0; y < 16; ++y)
        for (std::uint32_t x = 0; x < 64; ++x) {
            position.set(x, y, {-0.4 + 0.8 * x / 63.0, -0.4 + 0.8 * y / 15.0, 0.1});
            normal.set(x, y, {0, 0, 1});
        }
    Drawn drawn(rig, optionsOf(4, 16, 4), position, normal, list);
    Means means;
    for (std::uint32_t f = 0; f < 16; ++f) means.add(drawn.frame(f).light);
    double mean[3] = {};
    for (std::size_t i = 0; i < means.sum.size(); ++i) mean[i / (64 * 16)] += means.sum[i] / 16 / (64 * 16);
    // All VPLs together are within 0.2 % of the sphere here.
    for (int c = 0; c < 3; ++c) CHECK(std::abs(mean[c] / (3.0 - c) - 1.0) < 0.01);
}

// A floor under a wall, lit from both sides: the look-ups of the chosen, on average, are those of all.
TEST_CASE("the mean over frames of what maps shadow is the clustered gather", "[vpl_resampling][large]") {
    ParaboloidRig rig(16, 64);
    Mesh mesh;
    mesh.addQuad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 3, 3);
    mesh.addQuad({0.05, -0.5, 0}, {0, 1, 0}, {0, 0, 0.45}, 2, 1);
    const std::vector<lw_cluster> clusters{clusterAt({-0.9, -0.4, 0.7}, {1, 0.2, 0.1}), clusterAt({0.9, 0.3, 0.5}, {-1, 0.1, 0.2})};
    rig.draw(mesh, clusters);
    std::vector<lw_vpl> list;
    for (int k = 0; k < 40; ++k) {
        const lw_cluster& c = clusters[std::size_t(k / 20)];
        list.push_back(reference::makeVpl(reference::vecOf(c.medoidPosition), reference::vecOf(c.normal), {1.0 + k, 2.0, 3.0}, 0.01));
    }
    const Guarded plain = rig.upload(list), assignment = rig.upload([] {
        std::vector<cl_int> of(40, 0);
        std::fill(of.begin() + 20, of.end(), 1);
        return of;
    }());
    Image position(64, 24), normal(64, 24);
    for (std::uint32_t y = 0; y < 24; ++y)
        for (std::uint32_t x = 0; x < 64; ++x) {
            position.set(x, y, {-1.0 + 2.0 * (x + 0.5) / 64, -1.0 + 2.0 * (y + 0.5) / 24, 0.0});
            normal.set(x, y, {0, 0, 1});
        }
    ClusteredGather all(rig.device(), 1, 1, ClusterVisibility::hard);
    all.recordOrder(rig.executor(), {{{plain, 40}, &assignment, 2}});
    const ClusterMaps maps{rig.pass.frames(), rig.pass.records(), rig.pass.frames(), rig.pass.records(), 2, rig.pass.size()};
    rig.device().finish();
    std::vector<lw_vpl> sorted(std::size_t(all.order().capacity));
    all.vpls().download(0, sorted.size() * sizeof(lw_vpl), sorted.data());
    Drawn drawn(rig, optionsOf(4, 8, 2, ClusterVisibility::hard), position, normal, sorted);
    const Guarded counts = rig.upload(std::vector<cl_int>{0, 0, 0}), out = rig.makePlanes(64, 24, 3);
    const lw_vpl_tiles layout = VplTiles::layout(64, 24, all.order(), 1);
    all.recordGather(rig.executor(), rig.planes(drawn.p, 64, 24, 3), rig.planes(drawn.n, 64, 24, 3),
                     rig.upload(allSlots(layout, all.order())), layout, maps, rig.planes(out, 64, 24, 3), counts);
    rig.device().finish();
    const std::vector<float> expected = rig.downloadPlanes(rig.planes(out, 64, 24, 3));
    Means means;
    for (std::uint32_t f = 0; f < 400; ++f) means.add(drawn.frame(f, &maps).light);
    const auto [chi, energy] = means.deviations(expected);
    CAPTURE(chi, energy);
    CHECK(chi < 1.3);
    CHECK(std::abs(energy - 1.0) < 0.01);
}

TEST_CASE("widths agree on what is drawn and lit, and so do runs", "[vpl_resampling][large]") {
    Image position(61, 13), normal(61, 13);
    reference::fillCorner(position, normal);
    const std::vector<lw_vpl> list = randomList(600, false);
    std::vector<float> first;
    for (const std::uint32_t width : {1u, 4u, 8u, 16u}) {
        KernelRig rig(width);
        Drawn drawn(rig, optionsOf(4, 12, 3), position, normal, list);
        for (int run = 0; run < 3; ++run) {
            const Frame frame = drawn.frame(9);
            if (first.empty()) first = frame.light;
            CHECK(bitDifference(frame.light, first) == "");
        }
    }
}
