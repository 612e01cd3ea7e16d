// The compensation of bounding against its serial twin, closed forms of what bounding removes, and Lambert's polygon formula.
#include "passes/bounding_compensation.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>

#include "passes/joint_bilateral.h"
#include "shared/input_limits.h"
#include "support/compensation_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Image;
using reference::Vec;

namespace {

constexpr double kPi = 3.14159265358979323846;
// Float against double: offsets of nearby surfaces are differences of nearly equal positions.
constexpr double kTwinTolerance = 1e-4;

std::vector<lw_vpl> vplsOf(double flux, double area) {
    std::vector<lw_vpl> vpls(3, reference::makeVpl({0, 0, 0}, {0, 0, 1}, {flux, flux, flux}, area));
    vpls[0] = reference::makeVpl({0, 0, 0}, {0, 0, 1}, {0.5 * flux, flux, 0.0}, 0.5 * area);
    vpls[1] = reference::makeVpl({0, 0, 0}, {0, 0, 1}, {2 * flux, 0.5 * flux, 2.0 * flux}, 1.5 * area);
    return vpls;  // means: flux, area
}

SentImage cornerOf(std::pair<std::uint32_t, std::uint32_t> size) {
    SentImage image(size.first, size.second);
    reference::fillCorner(image.position, image.normal);
    image.radiance = reference::randomImage(size.first, size.second, 5);
    image.pixelArea = 0.15 / (double(size.first) * size.second);
    return image;
}

}  // namespace

TEST_CASE("the compensation equals its serial twin", "[bounding_compensation]") {
    const auto width = GENERATE(1u, 16u);
    const auto n = GENERATE(1u, 2u, 4u, 8u);
    const auto size = testSize(GENERATE(std::make_pair(1u, 1u), std::make_pair(67u, 23u), std::make_pair(130u, 9u)));
    const bool uniform = GENERATE(false, true);
    CAPTURE(width, n, size.first, size.second, uniform);
    KernelRig rig(width);
    SentImage image = cornerOf(size);
    image.perspective = size.first != 130;
    if (!image.perspective) image.pixelArea *= 4.0;
    const CompensationOptions options{n, 6, uniform};
    const Compensated out = compensate(rig, image, vplsOf(0.2, 0.05), options);
    const Image twin = compensationTwin(image, 0.2, 0.05, options);
    CHECK(disagreement(out.light.planes, twin.planes, kTwinTolerance) == "");
    CHECK(out.saturated == 0);
}

TEST_CASE("the compensation has the same bits at every width and in ten runs", "[bounding_compensation][large]") {
    const auto n = GENERATE(1u, 4u);
    const SentImage image = cornerOf({61, 13});
    KernelRig scalar(1);
    const CompensationOptions options{n, 5, false};
    const Image first = compensate(scalar, image, vplsOf(0.2, 0.05), options).light;
    for (const std::uint32_t width : {4u, 8u, 16u}) {
        KernelRig rig(width);
        for (int run = 0; run < (width == 16 ? 10 : 1); ++run)
            REQUIRE(bitDifference(compensate(rig, image, vplsOf(0.2, 0.05), options).light.planes, first.planes) == "");
    }
}

TEST_CASE("the compensation does not depend on the unit of length", "[bounding_compensation]") {
    KernelRig rig(16);
    const SentImage image = cornerOf({48, 20});
    const CompensationOptions options{4, 6, GENERATE(false, true)};
    const Image metres = compensate(rig, image, vplsOf(0.2, 0.05), options).light;
    for (const double scale : {0.125, 1024.0, 1e-3}) {
        SentImage scaled = image;
        for (float& v : scaled.position.planes) v *= float(scale);
        scaled.eye = image.eye * scale;
        const Image other = compensate(rig, scaled, vplsOf(0.2 * scale * scale, 0.05 * scale * scale), options).light;
        // A power of two scales without rounding.
        if (scale == 1e-3)
            CHECK(disagreement(other.planes, metres.planes, 1e-4) == "");
        else
            CHECK(bitDifference(other.planes, metres.planes) == "");
    }
}

TEST_CASE("samples cover their disc once, in as many strata as a pixel has samples", "[bounding_compensation]") {
    const CompensationOptions options{GENERATE(1u, 4u, 8u), GENERATE(1u, 8u), false};
    const float reach = 200.0f;
    const auto samples = BoundingCompensation::samples(options, reach);
    const std::size_t subsets = options.interleave * options.interleave;
    REQUIRE(samples.size() == subsets * options.samples);
    double cells = 0.0;
    for (const lw_near_sample& s : samples) {
        cells += double(s.cell);
        CHECK((s.x != 0 || s.y != 0));
        CHECK(std::hypot(s.x, s.y) <= double(reach) + 1.0);
    }
    CHECK(cells == Approx(kPi * reach * reach - 1.0).epsilon(1e-5));
    // Radii grow by one factor from stratum to stratum; rounding to pixels moves them by less than one.
    const double factor = std::pow(reach * std::sqrt(kPi), 1.0 / double(options.samples));
    for (std::size_t subset = 0; subset < subsets; ++subset)
        for (std::size_t k = 0; k < options.samples; ++k) {
            const lw_near_sample& s = samples[subset * options.samples + k];
            const double inner = std::pow(factor, double(k)) / std::sqrt(kPi);
            CHECK(std::hypot(s.x, s.y) >= inner - 0.71);
            CHECK(std::hypot(s.x, s.y) <= std::max(inner * factor, 1.0) + 0.71);
        }
}

// A receiver looks up at a disc of radius R and radiance L on its axis, at distance h. VPLs of area A light it with
//   pi L h^2 int_{h^2}^{h^2+R^2} du / (u^2 + A' u + 3 A' h^2),  A' = A / 4 pi,
// on average (u the squared distance, c = c_p = h / sqrt(u)), for A' < 12 h^2 an arc tangent; points with
// pi L R^2 / (h^2 + R^2).
TEST_CASE("what is gathered of a disc on its axis is what bounding removes", "[bounding_compensation][large]") {
    KernelRig rig(GENERATE(1u, 16u));
    const std::uint32_t size = 129, middle = 64;
    const double L = 2.0, cell = 1.0 / 64.0, h = GENERATE(0.1, 0.3), area = GENERATE(0.4, 4.0) * h * h;
    SentImage image(size, size);
    image.perspective = false;
    image.pixelArea = cell * cell;
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x) {
            image.position.set(x, y, {(double(x) - middle) * cell, (double(y) - middle) * cell, h});
            image.normal.set(x, y, {0, 0, -1});
            image.radiance.set(x, y, {L, L, 0.5 * L});
        }
    image.position.set(middle, middle, {0, 0, 0});
    image.normal.set(middle, middle, {0, 0, 1});
    const double R = double(BoundingCompensation::reachOf(size, size)) * cell;
    const auto lit = [&](double vplArea) {
        const double a = vplArea / (4.0 * kPi), root = std::sqrt(12.0 * a * h * h - a * a);
        return kPi * L * h * h * 2.0 / root *
               (std::atan((2.0 * (h * h + R * R) + a) / root) - std::atan((2.0 * h * h + a) / root));
    };
    const Vec light = compensate(rig, image, vplsOf(1.0, area), {1, 16384, true}).light.get(middle, middle);
    CAPTURE(h, area);
    // The pixel in the middle is the receiver's own: for h = 0.1, 1 / 128 of what lies within h of the axis is missing.
    CHECK(light.x == Approx(kPi * L * R * R / (h * h + R * R) - lit(area)).epsilon(h < 0.2 ? 0.03 : 0.01));
    CHECK(light.z == Approx(0.5 * light.x).epsilon(1e-5));
}

TEST_CASE("points need no compensation, and what has no surface gets and sends none", "[bounding_compensation]") {
    KernelRig rig(GENERATE(1u, 16u));
    const CompensationOptions options{GENERATE(1u, 4u), 6, false};
    SentImage image = cornerOf({64, 32});
    for (const float v : compensate(rig, image, vplsOf(0.0, 0.0), options).light.planes) REQUIRE(v == 0.0f);
    const Image clean = compensate(rig, image, vplsOf(0.2, 0.05), options).light;
    SECTION("bad pixels") {
        const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
        SentImage dark = image;
        std::set<std::pair<std::uint32_t, std::uint32_t>> spoilt;
        const auto spoil = [&](std::uint32_t x, Vec position, Vec normal, Vec radiance) {
            image.position.set(x, 20, position);
            image.normal.set(x, 20, normal);
            image.radiance.set(x, 20, radiance);
            dark.position.set(x, 20, position);
            dark.normal.set(x, 20, normal);
            dark.radiance.set(x, 20, {0, 0, 0});
        };
        const Vec p = image.position.get(8, 20), n = image.normal.get(8, 20);
        spoil(8, {nan, 0, 0}, n, {1, 1, 1});
        spoil(9, {0, inf, 0}, n, {1, 1, 1});
        spoil(10, p, {0, 0, 0}, {1, 1, 1});
        spoil(11, p, {nan, 0, 1}, {1, 1, 1});
        spoil(12, p, n, {nan, -1.0, inf});
        const Image out = compensate(rig, image, vplsOf(0.2, 0.05), options).light;
        CHECK(bitDifference(out.planes, compensate(rig, dark, vplsOf(0.2, 0.05), options).light.planes) == "");
        for (const float v : out.planes) REQUIRE((std::isfinite(v) && v >= 0.0f));
        for (const std::uint32_t x : {8u, 9u, 10u, 11u}) CHECK(out.get(x, 20).x == 0.0);
    }
    SECTION("added to what is there") {
        const Image before = reference::randomImage(64, 32, 8);
        const Image out = compensate(rig, image, vplsOf(0.2, 0.05), options, &before).light;
        for (std::uint32_t y = 0; y < 32; ++y)
            for (std::uint32_t x = 0; x < 64; ++x)
                if (reference::surfaceAt(image.position, image.normal, x, y).valid)
                    REQUIRE(out.get(x, y).y == Approx(before.get(x, y).y + clean.get(x, y).y).epsilon(1e-5));
    }
    SECTION("brought down and counted beyond float's range") {
        Image before(64, 32);
        for (float& v : before.planes) v = 0.999f * LW_LARGEST_IRRADIANCE;
        for (float& v : image.radiance.planes) v = LW_LARGEST_IRRADIANCE;
        const Compensated out = compensate(rig, image, vplsOf(1e36, 0.05), options, &before);
        CHECK(out.saturated > 0);
        for (const float v : out.light.planes) REQUIRE(v <= LW_LARGEST_IRRADIANCE);
    }
}

TEST_CASE("discs wider than the samples reach are counted", "[bounding_compensation]") {
    KernelRig rig(GENERATE(1u, 16u));
    SentImage image = cornerOf({64, 32});
    for (float& v : image.radiance.planes) v = 1.0f;
    const CompensationOptions options{4, 4, true};
    const double reach = double(BoundingCompensation::reachOf(64, 32));
    // R^2 = A / pi against reach^2 cross-sections K z^2, z the way along the axis.
    for (const double area : {1e-6, 0.01, 0.03, 10.0}) {
        int expected = 0;
        for (std::uint32_t y = 0; y < 32; ++y)
            for (std::uint32_t x = 0; x < 64; ++x) {
                const auto s = reference::surfaceAt(image.position, image.normal, x, y);
                const double z = 3.0 - s.position.z;
                expected += s.valid && area / kPi > reach * reach * image.pixelArea * z * z ? 1 : 0;
            }
        CHECK(compensate(rig, image, vplsOf(1.0, area), options).capped == expected);
    }
}

TEST_CASE("half-resolution radiance is the mean of each block's pixels on the surface chosen", "[bounding_compensation]") {
    KernelRig rig(GENERATE(1u, 16u));
    const auto [w, h] = testSize(GENERATE(std::make_pair(1u, 1u), std::make_pair(67u, 23u)));
    SentImage image = cornerOf({w, h});
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x) {
            // Each surface by one colour: what crosses an edge shows.
            const Vec n = image.normal.get(x, y), p = image.position.get(x, y);
            const double l = n.y > 0.5 ? 1.0 : p.z > 0.5 ? 3.0 : 5.0, noise = x % 2 == y % 2 ? 0.25 : -0.25;
            image.radiance.set(x, y, {l, 2.0 * l, l + noise});
        }
    const std::uint32_t hw = JointBilateral::halved(w), hh = JointBilateral::halved(h);
    Image halfPosition(hw, hh), halfNormal(hw, hh), half(hw, hh);
    reference::downsample(image.position, image.normal, halfPosition, halfNormal);
    constexpr float kPadding = std::numeric_limits<float>::quiet_NaN();
    const auto up = [&](const Image& i) { return rig.uploadPlanes(i.planes, i.width, i.height, 3, kPadding); };
    const Guarded p = up(image.position), n = up(image.normal), l = up(image.radiance), hp = up(halfPosition),
                  hn = up(halfNormal), out = rig.makePlanes(hw, hh, 3);
    BoundingCompensation pass(rig.device(), {4, 4, false});
    pass.recordHalve(rig.executor(), rig.planes(p, w, h, 3), rig.planes(n, w, h, 3), rig.planes(l, w, h, 3),
                     rig.planes(hp, hw, hh, 3), rig.planes(hn, hw, hh, 3), rig.planes(out, hw, hh, 3));
    rig.device().finish();
    half.planes = rig.downloadPlanes(rig.planes(out, hw, hh, 3));
    for (std::uint32_t y = 0; y < hh; ++y)
        for (std::uint32_t x = 0; x < hw; ++x) {
            const auto s = reference::surfaceAt(halfPosition, halfNormal, x, y);
            Vec sum;
            int count = 0;
            for (std::uint32_t k = 0; k < 4; ++k) {
                const std::uint32_t fx = 2 * x + k % 2, fy = 2 * y + k / 2;
                if (!s.valid || fx >= w || fy >= h) continue;
                if (!(reference::edgeWeight(s, reference::surfaceAt(image.position, image.normal, fx, fy)) > 0.0)) continue;
                sum = sum + image.radiance.get(fx, fy);
                ++count;
            }
            const Vec expected = count ? sum * (1.0 / count) : Vec{}, got = half.get(x, y);
            REQUIRE(got.x == Approx(expected.x).epsilon(1e-6));
            REQUIRE(got.y == Approx(expected.y).epsilon(1e-6));
            REQUIRE(got.z == Approx(expected.z).epsilon(1e-6));
        }
}
