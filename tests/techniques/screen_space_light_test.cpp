// The light of technique screen_space through the C API against closed forms, and what its levels add up to.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "shared/screen_types.h"
#include "support/corner_picture.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

// Rings of 10 texels, samples of many seeds together, the unbounded term: what is left is how fine texels, rings and pixels
// are. (All texels of each ring, in double precision: +0.4 % and 2.6 %.)
constexpr double kLimitBias = 0.02, kLimitError = 0.03;
// Rings of 4 texels, all taken: light is counted across their inner edges, by about 1 / r^2 of it (passes/screen_pattern.h).
constexpr double kCoarseBias = 1.25 / (4.0 * 4.0);
// Rings of 10 texels of which 256 are taken: the prototype of this method had +0.8 %, and 8 % in the mean error, unfiltered
// (radius 20).
constexpr double kSampledBias = 0.01, kSampledError = 0.06;
// What the bound takes: a sample stands for 4.9 texels of the first level, which next to the corner are as near as they are
// wide, so the more the coarser that level's 360, 180 and 90 rows are.
constexpr double kBoundTakes[] = {0.02, 0.03, 0.045};
constexpr double kStartChange = 0.04;
// A level's light is up-sampled by weights that sum to 1, level by level.
constexpr double kWeightRounding = 1e-5;
// Irradiance and share of the hemisphere are the same sum but for the factor pi L.
constexpr double kFurnaceRounding = 1e-5;
// What is seen of an open box, against one less the opening's form factor: corners, and texels near them.
constexpr double kSeenError = 0.03;

}  // namespace

TEST_CASE("with all samples of many seeds the irradiance is the polygon's", "[screen_space]") {
    TestDevice device(16);
    CornerPicture picture(320, 180);
    LWScreenSpaceDesc desc = descOf(LW_START_FULL, 6, 256, 40.0f);
    desc.bounded = 0;
    Result sum;
    constexpr std::uint32_t kSeeds = 8;
    for (desc.seed = 1; desc.seed <= kSeeds; ++desc.seed) {
        const Result one = render(device, desc, picture);
        sum.irradiance.resize(one.irradiance.size());
        for (std::size_t i = 0; i < one.irradiance.size(); ++i) sum.irradiance[i] += one.irradiance[i] / float(kSeeds);
    }
    const Error error = wallError(picture, sum);
    CAPTURE(error.bias, error.mean);
    CHECK(std::abs(error.bias) < kLimitBias);
    CHECK(error.mean < kLimitError);
    const Error coarse = wallError(picture, render(device, descOf(LW_START_FULL, 6, 256, 16.0f), picture));
    CAPTURE(coarse.bias, coarse.mean);
    CHECK(std::abs(coarse.bias) < kCoarseBias);
}

TEST_CASE("levels add up to the whole, each in its place", "[screen_space]") {
    // Up-sampling takes means of 3 x 3 texels, level by level: what a texel of the first level has beyond its own gather lies
    // between the least and the largest that each coarser level has about it.
    TestDevice device(16);
    CornerPicture picture(160, 100);
    const std::uint32_t levels = 4;
    const LWScreenSpaceDesc desc = descOf(LW_START_HALF, levels, 64, 40.0f);
    TestTechnique technique(device, "screen_space", &desc);
    TestView view(device, 160, 100);
    render(technique, view, picture.gbuffer, device);
    const auto sizeOf = [](std::uint32_t base, std::uint32_t k) { return (base + (2u << k) - 1) / (2u << k); };
    const auto read = [&](const std::string& name, std::uint32_t k) {
        std::vector<float> pixels(std::size_t(sizeOf(160, k)) * sizeOf(100, k) * LW_LIGHT_PLANES);
        REQUIRE(lwReadDebugView(technique, view, name.c_str(), pixels.data(), pixels.size()) == LW_SUCCESS);
        return pixels;
    };
    const std::vector<float> all = read("gathered", 0);
    std::vector<std::vector<float>> own;
    for (std::uint32_t k = 0; k < levels; ++k) own.push_back(read("level" + std::to_string(k + 1), k));
    for (std::uint32_t k = 0; k < levels; ++k) CHECK(*std::max_element(own[k].begin(), own[k].end()) > 0.0f);
    for (int y = 0; y < 50; ++y)
        for (int x = 0; x < 80; ++x) {
            const Vec normal = picture.normal.get(2 * std::uint32_t(x), 2 * std::uint32_t(y));
            if (normal.y + normal.z < 0.5) continue;
            for (std::size_t a = 0; a < LW_LIGHT_PLANES; ++a) {
                const std::size_t at = a * 80 * 50 + std::size_t(y * 80 + x);
                double low = double(own[0][at]), high = low;
                for (std::uint32_t k = 1; k < levels; ++k) {
                    double least = 1e30, most = 0.0;
                    // A texel away on this level, and less than that on each finer one.
                    for (int j = (y >> k) - 2; j <= (y >> k) + 2; ++j)
                        for (int i = (x >> k) - 2; i <= (x >> k) + 2; ++i) {
                            const int w = int(sizeOf(160, k)), h = int(sizeOf(100, k));
                            if (i < 0 || j < 0 || i >= w || j >= h) continue;
                            const double v = double(own[k][a * std::size_t(w * h) + std::size_t(j * w + i)]);
                            least = std::min(least, v);
                            most = std::max(most, v);
                        }
                    low += least;
                    high += most;
                }
                CAPTURE(x, y, a, low, high);
                REQUIRE(double(all[at]) >= low * (1.0 - kWeightRounding) - 1e-7);
                REQUIRE(double(all[at]) <= high * (1.0 + kWeightRounding) + 1e-7);
            }
        }
}

TEST_CASE("256 samples and any start resolution keep the light", "[screen_space]") {
    TestDevice device(16);
    CornerPicture picture(640, 360);
    double full = 0.0;
    for (const LWStart start : {LW_START_FULL, LW_START_HALF, LW_START_QUARTER}) {
        LWScreenSpaceDesc desc = descOf(start, 5, 256, 20.0f);
        const Result result = render(device, desc, picture);
        const Error error = wallError(picture, result);
        desc.bounded = 0;
        const Error unbounded = wallError(picture, render(device, desc, picture));
        CAPTURE(start, error.bias, error.mean, unbounded.bias, unbounded.mean);
        CHECK(std::abs(unbounded.bias) < kSampledBias);
        CHECK(error.mean < kSampledError);
        CHECK(error.bias < unbounded.bias);
        CHECK(error.bias > unbounded.bias - kBoundTakes[start]);
        const double mean = meanOf(result.irradiance);
        if (start == LW_START_FULL) full = mean;
        CHECK(mean == Approx(full).epsilon(kStartChange));
    }
}

TEST_CASE("resolution of the picture changes sampling alone", "[screen_space]") {
    TestDevice device(16);
    CornerPicture small(320, 180), large(640, 360);
    const LWScreenSpaceDesc desc = descOf(LW_START_HALF, 4, 64);
    CHECK(meanOf(render(device, desc, small).irradiance) == Approx(meanOf(render(device, desc, large).irradiance)).epsilon(kStartChange));
}

TEST_CASE("validity is what is seen: a furnace is exact with the rest filled in", "[screen_space]") {
    // A box open towards the camera, all of it of radiance 1 and all of it seen.
    TestDevice device(16);
    const Vec one{1, 1, 1};
    const std::vector<Quad> box = {{{-1, -1, -2}, {2, 0, 0}, {0, 2, 0}, {0, 0, 1}, one},  {{-1, -1, -2}, {2, 0, 0}, {0, 0, 2}, {0, 1, 0}, one},
                                   {{-1, 1, -2}, {2, 0, 0}, {0, 0, 2}, {0, -1, 0}, one},  {{-1, -1, -2}, {0, 2, 0}, {0, 0, 2}, {1, 0, 0}, one},
                                   {{1, -1, -2}, {0, 2, 0}, {0, 0, 2}, {-1, 0, 0}, one}};
    Picture picture(320, 180, 0.36, {0, 0, 3}, box);
    const Result result = render(device, descOf(LW_START_FULL, 6, 256, 16.0f), picture);
    const std::vector<Vec> opening = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    double worst = 0.0, got = 0.0, truth = 0.0;
    for (std::uint32_t y = 0; y < 180; ++y)
        for (std::uint32_t x = 0; x < 320; ++x) {
            const std::size_t i = std::size_t(y) * 320 + x;
            const double v = double(result.validity[i]);
            if (picture.normal.get(x, y).z + std::abs(picture.normal.get(x, y).x) + std::abs(picture.normal.get(x, y).y) < 0.5) {
                REQUIRE(v == 0.0);
                REQUIRE(result.e(i) == 0.0);
                continue;
            }
            REQUIRE(v <= 1.0);
            // The fallback's sum: E + (1 - v) pi L. Only where the estimate of the share had to be cut at 1 is it above.
            if (v < 1.0) worst = std::max(worst, std::abs((result.e(i) + (1.0 - v) * kPi) / kPi - 1.0));
            got += v;
            truth += 1.0 - polygonIrradiance(opening, picture.position.get(x, y), picture.normal.get(x, y), 1.0);
        }
    CAPTURE(worst, got / truth);
    CHECK(worst < kFurnaceRounding);
    CHECK(got / truth == Approx(1.0).margin(kSeenError));
}

TEST_CASE("bounded light has no spikes, unbounded light has", "[screen_space]") {
    TestDevice device(16);
    CornerPicture picture(320, 180);
    LWScreenSpaceDesc desc = descOf(LW_START_QUARTER, 4, 8, 64.0f);  // a sample stands for 402 texels
    desc.interleave = 1;  // one pattern: nothing is averaged away
    double largest[2] = {};
    for (desc.seed = 1; desc.seed <= 8; ++desc.seed)
        for (desc.bounded = 0; desc.bounded < 2; ++desc.bounded)
            for (const float e : render(device, desc, picture).irradiance)
                largest[desc.bounded] = std::max(largest[desc.bounded], double(e));
    CAPTURE(largest[0], largest[1]);
    CHECK(largest[1] < kPi);  // half of the hemisphere at the most, and the noise of 8 samples
    CHECK(largest[0] > 2.0 * kPi);
}
