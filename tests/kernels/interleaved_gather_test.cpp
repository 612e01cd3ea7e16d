// The gather and its filter against serial double-precision twins, closed forms, and themselves at
// other widths.
#include "passes/interleaved_gather.h"

#include <catch2/catch.hpp>
#include <limits>

#include "reference/surfaces.h"
#include "shared/input_limits.h"
#include "support/gather_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Image;
using reference::Vec;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr double kPi = 3.14159265358979323846;
// Kernel in float against the twin in double. A VPL's cosine is a difference of nearly equal products
// where it grazes: absolute 1e-5 of the mean covers it.
constexpr double kTwinTolerance = 2e-5;

Gathered gatherOn(KernelRig& rig, const Image& position, const Image& normal, const std::vector<lw_vpl>& vpls,
                  std::uint32_t n) {
    return gatherImage(rig, position, normal, vpls, n, Bits::all);
}

// One pixel that looks up from the origin.
void lookUp(Image& position, Image& normal) {
    for (std::uint32_t y = 0; y < position.height; ++y)
        for (std::uint32_t x = 0; x < position.width; ++x) {
            position.set(x, y, {0, 0, 0});
            normal.set(x, y, {0, 0, 1});
        }
}

}  // namespace

TEST_CASE("the gather equals its serial twin", "[interleaved_gather]") {
    const auto width = GENERATE(1u, 16u);
    const auto n = GENERATE(1u, 2u, 4u, 8u);
    const auto size = testSize(GENERATE(std::make_pair(1u, 1u), std::make_pair(67u, 23u), std::make_pair(130u, 9u)));
    CAPTURE(width, n, size.first, size.second);
    KernelRig rig(width);
    Image position(size.first, size.second), normal(size.first, size.second);
    reference::fillCorner(position, normal);
    const auto vpls = reference::randomVpls(128, 7);
    const Gathered out = gatherOn(rig, position, normal, vpls, n);
    const Image twin = reference::gather(position, normal, vpls, orderOf(vpls.size(), n), n);
    CHECK(disagreement(out.irradiance.planes, twin.planes, kTwinTolerance) == "");
    CHECK(out.rejected == 0);
}

TEST_CASE("the gather has the same bits at every width", "[interleaved_gather][large]") {
    const auto n = GENERATE(1u, 4u);
    Image position(61, 13), normal(61, 13);
    reference::fillCorner(position, normal);
    const auto vpls = reference::randomVpls(64, 3);
    KernelRig scalar(1);
    const Image first = gatherOn(scalar, position, normal, vpls, n).irradiance;
    for (const std::uint32_t width : {4u, 8u, 16u}) {
        KernelRig rig(width);
        CHECK(bitDifference(gatherOn(rig, position, normal, vpls, n).irradiance.planes, first.planes) == "");
    }
}

TEST_CASE("a disc on its axis: E = pi L R^2 / (r^2 + R^2)", "[interleaved_gather]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    Image position(8, 2), normal(8, 2);
    lookUp(position, normal);
    const double radiance = 3.0, radius = 0.5;
    for (const double r : {0.01, 0.1, 0.5, 2.0, 100.0}) {
        const double area = kPi * radius * radius, flux = kPi * radiance * area;
        std::vector<lw_vpl> vpls(2);
        vpls[0] = reference::makeVpl({0, 0, r}, {0, 0, -1}, {flux, flux, flux}, area);
        vpls[1] = reference::makeVpl({0, 0, r}, {0, 0, 1}, {flux, flux, flux}, area);  // faces away
        const double expected = kPi * radiance * radius * radius / (r * r + radius * radius);
        CHECK(gatherOn(rig, position, normal, vpls, 1).irradiance.get(5, 1).x == Approx(expected).epsilon(1e-5));
    }
}

TEST_CASE("form factors of unit squares", "[interleaved_gather][large]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    // Emitter: z = 1, facing down, exitance 1, 64^2 VPLs. Receivers: midpoints of 32^2 cells of the square
    // below it, or of the square that shares an edge with it.
    constexpr int kEmitters = 64;
    constexpr std::uint32_t kReceivers = 32;
    std::vector<lw_vpl> vpls;
    for (int j = 0; j < kEmitters; ++j)
        for (int i = 0; i < kEmitters; ++i) {
            const double a = 1.0 / (kEmitters * kEmitters);
            vpls.push_back(reference::makeVpl({(i + 0.5) / kEmitters, (j + 0.5) / kEmitters, 1}, {0, 0, -1}, {a, a, a}, a));
        }
    const bool parallel = GENERATE(true, false);
    Image position(kReceivers, kReceivers), normal(kReceivers, kReceivers);
    for (std::uint32_t y = 0; y < kReceivers; ++y)
        for (std::uint32_t x = 0; x < kReceivers; ++x) {
            const double u = (x + 0.5) / kReceivers, v = (y + 0.5) / kReceivers;
            position.set(x, y, parallel ? Vec{u, v, 0} : Vec{u, 0, v});
            normal.set(x, y, parallel ? Vec{0, 0, 1} : Vec{0, 1, 0});
        }
    const Image e = gatherOn(rig, position, normal, vpls, 1).irradiance;
    double mean = 0.0;
    for (std::size_t i = 0; i < kReceivers * kReceivers; ++i) mean += double(e.planes[i]) / (kReceivers * kReceivers);
    // Midpoint quadrature; the common edge is a weak singularity, cut off by the bounded term.
    if (parallel)
        CHECK(mean == Approx(0.1998249).epsilon(5e-4));
    else
        CHECK(mean == Approx(0.2000438).epsilon(1e-2));
}

TEST_CASE("the mean over all assignments of subsets is the full gather", "[interleaved_gather][large]") {
    const auto width = GENERATE(1u, 16u);
    const auto n = GENERATE(2u, 4u, 8u);
    KernelRig rig(width);
    Image position(64, 8), normal(64, 8);
    lookUp(position, normal);
    const auto vpls = reference::randomVpls(256, 11);
    const Image dealt = gatherOn(rig, position, normal, vpls, n).irradiance;
    const Image full = gatherOn(rig, position, normal, vpls, 1).irradiance;
    Vec mean;
    for (std::uint32_t y = 0; y < n; ++y)
        for (std::uint32_t x = 0; x < n; ++x) mean = mean + dealt.get(16 + x, y) * (1.0 / (n * n));
    CHECK(mean.x == Approx(full.get(20, 4).x).epsilon(1e-5));
    CHECK(mean.y == Approx(full.get(20, 4).y).epsilon(1e-5));
}

TEST_CASE("nothing depends on the unit of length", "[interleaved_gather][large]") {
    Image position(48, 20), normal(48, 20);
    reference::fillCorner(position, normal);
    auto vpls = reference::randomVpls(64, 5);
    KernelRig rig(16);
    const Image metres = gatherOn(rig, position, normal, vpls, 4).irradiance;
    for (const float scale : {0.125f, 1024.0f, 1e-3f}) {
        Image scaled = position;
        for (float& v : scaled.planes) v *= scale;
        auto scaledVpls = vpls;
        for (lw_vpl& v : scaledVpls)
            for (int a = 0; a < 4; ++a) {
                v.positionArea.s[a] *= a < 3 ? scale : scale * scale;
                v.flux.s[a] *= scale * scale;
            }
        for (lw_vpl& v : scaledVpls) v.normal.s[3] *= scale * scale;
        // A power of two scales without rounding.
        const Image other = gatherOn(rig, scaled, normal, scaledVpls, 4).irradiance;
        if (scale == 1e-3f)
            CHECK(disagreement(other.planes, metres.planes, 1e-5) == "");
        else
            CHECK(bitDifference(other.planes, metres.planes) == "");
    }
}

TEST_CASE("background, bad pixels and coincident VPLs get no light and spoil none", "[interleaved_gather]") {
    const auto width = GENERATE(1u, 16u);
    const auto n = GENERATE(1u, 4u);
    KernelRig rig(width);
    Image position(64, 4), normal(64, 4);
    lookUp(position, normal);
    auto vpls = reference::randomVpls(64, 9);
    vpls[0] = reference::makeVpl({0, 0, 0}, {0, 0, -1}, {1, 1, 1}, 0.0);  // at the pixel itself, a point
    const Image clean = gatherOn(rig, position, normal, vpls, n).irradiance;
    const float inf = std::numeric_limits<float>::infinity();
    normal.set(1, 0, {0, 0, 0});             // background
    normal.set(2, 0, {kNaN, 0, 1});
    normal.set(3, 0, {0, 0, 0.1});           // no normal
    normal.set(4, 0, {0, 0, 30});
    position.set(5, 0, {kNaN, 0, 0});
    position.set(6, 0, {0, inf, 0});
    const Gathered out = gatherOn(rig, position, normal, vpls, n);
    CHECK(out.rejected == 5);
    for (std::uint32_t y = 0; y < 4; ++y)
        for (std::uint32_t x = 0; x < 64; ++x) {
            const Vec e = out.irradiance.get(x, y), c = clean.get(x, y);
            if (y == 0 && x >= 1 && x <= 6)
                CHECK((e.x == 0.0 && e.y == 0.0 && e.z == 0.0));
            else
                CHECK((e.x == c.x && std::isfinite(e.x)));
        }
}

TEST_CASE("light beyond float's range is brought down, counted, and harms no neighbour", "[interleaved_gather]") {
    KernelRig rig(GENERATE(1u, 16u));
    Image position(32, 4), normal(32, 4);
    lookUp(position, normal);
    for (std::uint32_t y = 0; y < 4; ++y)
        for (std::uint32_t x = 0; x < 32; ++x) position.set(x, y, {double(x), double(y), x % 2 * 5.0});
    std::vector<lw_vpl> vpls(64);
    for (lw_vpl& vpl : vpls) vpl = reference::makeVpl({4, 2, 1e-9}, {0, 0, -1}, {1e30, 1, 0}, 0);
    const Gathered out = gatherOn(rig, position, normal, vpls, 4);
    CHECK(out.saturated == 1);
    CHECK(out.irradiance.get(4, 2).x == double(LW_LARGEST_IRRADIANCE));
    CHECK(out.irradiance.get(4, 2).y > 1e17);
    CHECK(out.irradiance.get(4, 2).z == 0.0);
    const Image filtered = filterImage(rig, position, normal, out.irradiance, 4);
    for (const float value : filtered.planes) REQUIRE(std::isfinite(value));
    CHECK(filtered.get(5, 2).x < 1e31);  // across an edge
}

TEST_CASE("normals of compact formats are normalised", "[interleaved_gather]") {
    KernelRig rig(16);
    Image position(16, 1), normal(16, 1);
    lookUp(position, normal);
    const auto vpls = reference::randomVpls(32, 2);
    const double exact = gatherOn(rig, position, normal, vpls, 1).irradiance.get(3, 0).x;
    for (float& v : normal.planes) v *= 1.007f;
    CHECK(gatherOn(rig, position, normal, vpls, 1).irradiance.get(3, 0).x == Approx(exact).epsilon(1e-5));
}

TEST_CASE("the filter equals its serial twin", "[interleaved_gather]") {
    const auto width = GENERATE(1u, 16u);
    const auto n = GENERATE(2u, 4u, 8u);
    const auto size = testSize(GENERATE(std::make_pair(1u, 1u), std::make_pair(3u, 70u), std::make_pair(131u, 37u)));
    KernelRig rig(width);
    Image position(size.first, size.second), normal(size.first, size.second);
    reference::fillCorner(position, normal);
    const Image light = reference::randomImage(size.first, size.second, 21);
    const Image twin = reference::filter(position, normal, light, n);
    CAPTURE(width, n, size.first);
    // 1e-3 of the pixels may decide the edge test differently within rounding.
    CHECK(disagreement(filterImage(rig, position, normal, light, n).planes, twin.planes, kTwinTolerance, 1e-3) == "");
}

TEST_CASE("a constant image passes the filter unchanged, and nothing crosses an edge", "[interleaved_gather][large]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    Image position(96, 64), normal(96, 64), light(96, 64);
    reference::fillCorner(position, normal);
    for (float& v : light.planes) v = 0.7f;
    const Image constant = filterImage(rig, position, normal, light, 4);
    // Light on the slab only: none of it may reach wall, floor or background, and none may be lost.
    for (std::uint32_t y = 0; y < 64; ++y)
        for (std::uint32_t x = 0; x < 96; ++x) {
            const bool surface = normal.get(x, y).y + normal.get(x, y).z > 0.5;
            REQUIRE(constant.get(x, y).x == Approx(surface ? 0.7 : 0.0).epsilon(1e-6));
            light.set(x, y, position.get(x, y).z == Approx(0.7) && normal.get(x, y).z > 0.5 ? Vec{5, 5, 5} : Vec{0, 0, 0});
        }
    const Image slab = filterImage(rig, position, normal, light, 4);
    for (std::uint32_t y = 0; y < 64; ++y)
        for (std::uint32_t x = 0; x < 96; ++x) REQUIRE(slab.get(x, y).x == Approx(light.get(x, y).x).epsilon(1e-6));
}

TEST_CASE("a neighbour without a usable normal takes no part in the filter", "[interleaved_gather]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    Image position(48, 16), normal(48, 16), light(48, 16);
    lookUp(position, normal);
    for (float& v : light.planes) v = 0.7f;
    for (const std::uint32_t x : {5u, 20u, 21u}) {
        normal.set(x, 7, {kNaN, kNaN, kNaN});
        light.set(x, 7, {0, 0, 0});
    }
    const Image filtered = filterImage(rig, position, normal, light, 4);
    for (std::uint32_t y = 0; y < 16; ++y)
        for (std::uint32_t x = 0; x < 48; ++x)
            REQUIRE(filtered.get(x, y).x == Approx(std::isnan(normal.get(x, y).x) ? 0.0 : 0.7).epsilon(1e-6));
}

TEST_CASE("validity is one on surfaces and zero elsewhere", "[interleaved_gather]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    Image position(33, 21), normal(33, 21);
    reference::fillCorner(position, normal);
    const Guarded p = rig.uploadPlanes(position.planes, 33, 21, 3, kNaN), nr = rig.uploadPlanes(normal.planes, 33, 21, 3, kNaN);
    const Guarded out = rig.makePlanes(33, 21, 1);
    InterleavedGather pass(rig.device(), 4);
    if (GENERATE(false, true)) {
        const Guarded light = rig.uploadPlanes(std::vector<float>(33 * 21 * 3), 33, 21, 3, kNaN),
                      filtered = rig.makePlanes(33, 21, 3);
        pass.recordFilter(rig.executor(), rig.planes(p, 33, 21, 3), rig.planes(nr, 33, 21, 3), rig.planes(light, 33, 21, 3),
                          rig.planes(filtered, 33, 21, 3), rig.planes(out, 33, 21, 1));
    } else {
        pass.recordValidity(rig.executor(), rig.planes(p, 33, 21, 3), rig.planes(nr, 33, 21, 3), rig.planes(out, 33, 21, 1));
    }
    rig.device().finish();
    const auto validity = rig.downloadPlanes(rig.planes(out, 33, 21, 1));
    for (std::uint32_t y = 0; y < 21; ++y)
        for (std::uint32_t x = 0; x < 33; ++x)
            REQUIRE(validity[y * 33 + x] == (reference::surfaceAt(position, normal, x, y).valid ? 1.0f : 0.0f));
}
