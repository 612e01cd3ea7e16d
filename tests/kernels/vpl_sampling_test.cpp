// VPL sampling: the order of subsets, what is drawn and how often, and what it adds up to.
#include "passes/vpl_sampling.h"

#include <catch2/catch.hpp>
#include <map>
#include <random>
#include <set>

#include "reference/surfaces.h"
#include "support/kernel_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

// Flux and area of a VPL are a texel's times total / (N * weight): six roundings, and those of the total, which
// is added up in float row by row.
constexpr double kDrawRounding = 1e-6;
// With equal weights the total is a whole number of texels, exact in float: hardly any rounding is left.
constexpr double kUniformRounding = 2e-7;
// 500 points estimate the area of a map whose dimmest texels carry a twentieth of the brightest's flux.
constexpr double kAreaEstimate = 0.05;
// Points of 32,768 by which a texel misses its share: a warped Hammersley set is off by a few per texel,
// where independent ones would be by the square root of some hundreds.
constexpr double kPointsOff = 6.0;
// Discrepancy of the set, on light from a map of 4,096 texels with hard steps.
constexpr double kLightOf1024 = 0.01, kLightOf16384 = 1e-3;

double relative(double got, double expected) { return std::abs(got / expected - 1.0); }

// Two RSMs of different width as RsmInput lays them out: rows padded to 16 texels. Texel i stands at
// x = i, so that a VPL tells where it comes from; `flux(row, column)` in W, grey.
struct Maps {
    std::vector<float> planes;
    std::vector<cl_int4> rows;
    std::uint32_t padded = 0, count = 0;

    template <class Flux>
    Maps(std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes, Flux flux) {
        for (const auto& [w, h] : sizes)
            for (std::uint32_t y = 0; y < h; ++y) {
                rows.push_back({{cl_int(padded), cl_int(w), 0, 0}});
                padded += paddedWidth(w);
                count += w;
            }
        planes.assign(std::size_t(padded) * RsmInput::kPlaneCount, 0.0f);
        for (std::size_t r = 0; r < rows.size(); ++r)
            for (int i = 0; i < rows[r].s[1]; ++i) {
                const std::size_t t = std::size_t(rows[r].s[0] + i);
                plane(RsmInput::kPositionX)[t] = float(t);
                plane(RsmInput::kNormalY)[t] = 1.0f;
                for (int c = 0; c < 3; ++c) plane(RsmInput::kFluxR + c)[t] = float(flux(r, std::size_t(i)));
                plane(RsmInput::kArea)[t] = 0.5f;
            }
    }
    float* plane(int p) { return planes.data() + std::size_t(p) * padded; }
};

struct Drawn {
    std::vector<lw_vpl> vpls;
    lw_subset_order order;
};

Drawn draw(KernelRig& rig, const Maps& maps, const VplSamplingOptions& options, const std::vector<LWVpl>& authored = {}) {
    RsmInput input;
    const Guarded planes = rig.upload(maps.planes), rows = rig.upload(maps.rows);
    input.texels.memory = planes.get();
    input.texels.rowStride = input.texels.planeStride = maps.padded;
    input.texels.width = maps.padded;
    input.texels.height = 1;
    input.texels.count = RsmInput::kPlaneCount;
    input.rows = Buffer::retained(rig.device(), rows.get());
    input.rowCount = std::uint32_t(maps.rows.size());
    input.texelCount = maps.count;
    VplSampling pass(rig.device(), options);
    pass.record(rig.executor(), input, authored.data(), std::uint32_t(authored.size()));
    rig.device().finish();
    Drawn drawn{std::vector<lw_vpl>(std::size_t(pass.order().subsets * pass.order().capacity)), pass.order()};
    pass.vpls().download(0, drawn.vpls.size() * sizeof(lw_vpl), drawn.vpls.data());
    return drawn;
}

double totalFlux(const Maps& maps) {
    double sum = 0.0;
    for (std::size_t i = 0; i < maps.padded; ++i) sum += double(maps.planes[std::size_t(RsmInput::kFluxR) * maps.padded + i]);
    return sum;
}

double spotFlux(std::size_t row, std::size_t column) {  // bright in one corner, black in a third of the map
    if (column % 3 == 0) return 0.0;
    const double d = double(row * row + column * column);
    return 1.0 / (1.0 + 0.02 * d);
}

}  // namespace

TEST_CASE("every VPL has one slot, and every subset is stratified", "[vpl_sampling]") {
    for (const std::uint32_t subsets : {1u, 4u, 16u, 64u})
        for (const std::uint32_t count : {1u, 7u, 64u, 256u, 1000u, 4096u, 4099u}) {
            const lw_subset_order order = subsetOrder(count, subsets);
            std::set<int> seen;
            for (int slot = 0; slot < order.subsets * order.capacity; ++slot) {
                const int k = lw_subset_index(order, slot);
                if (k >= 0) CHECK(seen.insert(k).second);
            }
            CHECK(seen.size() == count);
            CHECK(order.capacity % 2 == 0);
        }
    // 256 VPLs in 16 subsets: each subset's 16 fall into 16 different cells of a 4x4 grid of the unit square.
    const lw_subset_order order = subsetOrder(256, 16);
    auto radicalInverse = [](unsigned k) {
        double v = 0.0, digit = 0.5;
        for (; k; k >>= 1, digit *= 0.5) v += (k & 1) * digit;
        return v;
    };
    for (int s = 0; s < 16; ++s) {
        std::set<int> cells;
        for (int i = 0; i < order.capacity; ++i) {
            const int k = lw_subset_index(order, s * order.capacity + i);
            cells.insert(int((k + 0.5) / 256.0 * 4.0) * 4 + int(radicalInverse(unsigned(k)) * 4.0));
        }
        CHECK(cells.size() == 16);
    }
}

TEST_CASE("flux-warped: equal flux each, the total kept, dark texels never", "[vpl_sampling]") {
    const auto width = GENERATE(1u, 16u);
    const auto interleave = GENERATE(1u, 4u);
    KernelRig rig(width);
    Maps maps({{50, 20}, {33, 9}}, spotFlux);
    VplSamplingOptions options;
    options.count = 500;
    options.subsets = interleave * interleave;
    const Drawn drawn = draw(rig, maps, options);
    const double total = totalFlux(maps);
    double sum = 0.0, area = 0.0, worstFlux = 0.0, worstArea = 0.0;
    int lit = 0;
    for (const lw_vpl& v : drawn.vpls) {
        if (v.flux.s[0] == 0.0f) continue;
        ++lit;
        worstFlux = std::max(worstFlux, relative(double(v.flux.s[0]), total / 500));
        const std::size_t texel = std::size_t(v.positionArea.s[0]);
        const double flux = double(maps.plane(RsmInput::kFluxR)[texel]);
        REQUIRE(flux > 0.0);
        // Area and flux are divided by the same N * P.
        worstArea = std::max(worstArea, relative(double(v.positionArea.s[3]), 0.5 * total / (500 * flux)));
        sum += double(v.flux.s[0]);
        area += double(v.positionArea.s[3]);
    }
    CHECK(lit == 500);
    CHECK(worstFlux < kDrawRounding);
    CHECK(worstArea < kDrawRounding);
    CHECK(relative(sum, total) < kDrawRounding);
    // The areas estimate the lit texels' area: 0.5 each.
    double litArea = 0.0;
    for (std::size_t t = 0; t < maps.padded; ++t) litArea += maps.plane(RsmInput::kFluxR)[t] > 0.0f ? 0.5 : 0.0;
    CHECK(relative(area, litArea) < kAreaEstimate);
}

TEST_CASE("flux-warped: a texel of next to no flux leaves no infinite VPL", "[vpl_sampling]") {
    KernelRig rig(GENERATE(1u, 16u));
    // v = 0 of the first point falls on the first texel, whatever its share: here 1e-42 of all.
    Maps maps({{16, 1}}, [](std::size_t, std::size_t column) { return column ? 1e30 : 1e-11; });
    VplSamplingOptions options;
    options.count = 64;
    options.subsets = 4;
    int lit = 0;
    for (const lw_vpl& v : draw(rig, maps, options).vpls) {
        REQUIRE(std::isfinite(v.positionArea.s[3]));
        for (int c = 0; c < 3; ++c) REQUIRE(std::isfinite(v.flux.s[c]));
        if (v.flux.s[0] > 0.0f) ++lit;
    }
    CHECK(lit == 63);
}

TEST_CASE("flux-warped: texels are drawn in proportion to their flux", "[vpl_sampling]") {
    KernelRig rig(16);
    Maps maps({{16, 8}, {20, 4}}, spotFlux);
    VplSamplingOptions options;
    options.count = 1u << 15;
    options.subsets = 1;
    std::map<std::size_t, int> counts;
    for (const lw_vpl& v : draw(rig, maps, options).vpls) counts[std::size_t(v.positionArea.s[0])]++;
    const double total = totalFlux(maps);
    double worst = 0.0;
    for (std::size_t t = 0; t < maps.padded; ++t) {
        const double expected = double(maps.plane(RsmInput::kFluxR)[t]) / total * options.count;
        if (expected == 0.0)
            CHECK(counts.count(t) == 0);
        else
            worst = std::max(worst, std::abs(counts[t] - expected));
    }
    CHECK(worst <= kPointsOff);
}

TEST_CASE("uniform: flux and area times texels over N", "[vpl_sampling]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    Maps maps({{64, 32}, {32, 16}}, spotFlux);
    VplSamplingOptions options;
    options.count = 640;
    options.uniform = true;
    options.subsets = 1;
    const double factor = (64.0 * 32 + 32 * 16) / 640;
    std::set<std::size_t> texels;
    double worst = 0.0;
    for (const lw_vpl& v : draw(rig, maps, options).vpls) {
        const std::size_t t = std::size_t(v.positionArea.s[0]);
        const double flux = double(maps.plane(RsmInput::kFluxR)[t]) * factor;
        if (flux == 0.0)
            CHECK(v.flux.s[0] == 0.0f);
        else
            worst = std::max(worst, relative(double(v.flux.s[0]), flux));
        worst = std::max(worst, relative(double(v.positionArea.s[3]), 0.5 * factor));
        texels.insert(t);
    }
    CHECK(worst < kUniformRounding);
    CHECK(texels.size() == 640);  // stratified: no texel twice when N is below their number
}

TEST_CASE("all texels, and the host's own VPLs beside them", "[vpl_sampling]") {
    const auto width = GENERATE(1u, 16u);
    const auto interleave = GENERATE(1u, 2u);
    KernelRig rig(width);
    Maps maps({{19, 5}}, spotFlux);
    LWVpl own{};
    own.position[0] = -7.0f;
    own.normal[2] = 1.0f;
    own.flux[1] = 3.0f;
    own.area = 0.25f;
    VplSamplingOptions options;
    options.count = 0;
    options.subsets = interleave * interleave;
    const Drawn drawn = draw(rig, maps, options, {own, own});
    double sum = 0.0;
    int mine = 0;
    for (const lw_vpl& v : drawn.vpls) {
        if (v.positionArea.s[0] == -7.0f) {
            ++mine;
            CHECK((v.flux.s[1] == 3.0f && v.positionArea.s[3] == 0.25f && v.normal.s[2] == 1.0f));
        } else {
            sum += double(v.flux.s[0]);
        }
    }
    CHECK(mine == 2);
    CHECK(sum == totalFlux(maps));  // the texels' own floats, added in double
}

TEST_CASE("maps without flux give VPLs without flux; seeds move the set; same seed, same bits", "[vpl_sampling]") {
    KernelRig rig(16);
    VplSamplingOptions options;
    options.count = 64;
    for (const lw_vpl& v : draw(rig, Maps({{32, 8}}, [](auto, auto) { return 0.0; }), options).vpls)
        CHECK((v.flux.s[0] == 0.0f && v.normal.s[1] == 0.0f));

    Maps maps({{64, 64}}, spotFlux);
    auto texels = [&](std::uint32_t seed) {
        options.seed = seed;
        std::vector<float> list;
        for (const lw_vpl& v : draw(rig, maps, options).vpls) list.push_back(v.positionArea.s[0]);
        return list;
    };
    CHECK(texels(0) == texels(0));
    CHECK(texels(5) == texels(5));
    CHECK(texels(0) != texels(5));
}

TEST_CASE("a drawn set's light converges to that of all texels", "[vpl_sampling][large]") {
    // A lit strip seen from above it: the sampled sum against the sum over every texel, in double.
    KernelRig rig(16);
    Maps maps({{64, 64}}, spotFlux);
    for (std::uint32_t t = 0; t < maps.padded; ++t) {
        maps.plane(RsmInput::kPositionX)[t] = float(t % 64) / 64.0f;
        maps.plane(RsmInput::kPositionZ)[t] = float(t / 64) / 64.0f;
        maps.plane(RsmInput::kArea)[t] = 1.0f / 4096.0f;
    }
    reference::Surface receiver{{0.3, 0.5, 0.2}, {0, -1, 0}, true};
    auto light = [&](std::uint32_t count, bool uniform) {
        VplSamplingOptions options;
        options.count = count;
        options.uniform = uniform;
        options.subsets = 1;
        double e = 0.0;
        for (const lw_vpl& v : draw(rig, maps, options).vpls) e += reference::vplIrradiance(v, receiver).x;
        return e;
    };
    const double all = light(0, false);
    for (const bool uniform : {false, true}) {
        CAPTURE(uniform);
        CHECK(relative(light(1024, uniform), all) < kLightOf1024);
        CHECK(relative(light(16384, uniform), all) < kLightOf16384);
    }
}
