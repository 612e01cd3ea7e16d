// The rival's filter: it never harms, and the more paths the better.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "rival_shrink.h"
#include "support/rival_view.h"

namespace {

using namespace studio;
using namespace rival_test;

RivalOptions filtered(std::uint32_t spp) {
    RivalOptions options = unfiltered(1, spp);
    options.filter = 1;
    return options;
}

// A floor that fills the picture.
TracedSurfaces floorOf(int width, int height) {
    TracedSurfaces surfaces(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            surfaces.position.row(0, y)[x] = float(x);
            surfaces.position.row(2, y)[x] = float(y);
            surfaces.normal.row(1, y)[x] = 1.0f;
        }
    return surfaces;
}

std::vector<std::vector<Tap>> threeLevels() {
    return {splineWindow(1), splineWindow(2), splineWindow(4)};
}

}  // namespace

TEST_CASE("Light without noise comes through the filter as it is") {
    constexpr int kWidth = 60, kHeight = 40;
    const TracedSurfaces surfaces = floorOf(kWidth, kHeight);
    WorkerPool pool(2);
    ShrinkFilter shrink(kWidth, kHeight);
    const auto light = [](int c, int x, int y) {  // a sharp shadow and a ramp
        return float(c + 1) * ((x / 7 + y / 5) % 2 == 0 ? 3.0f : 0.2f + 0.01f * float(x));
    };
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            for (int c = 0; c < 3; ++c) shrink.input().row(c, y)[x] = light(c, x, y);
            shrink.input().row(ShrinkFilter::kNoisePlane, y)[x] = 0.0f;
        }
    const PaddedPlanes& result = shrink.filter(pool, surfaces, threeLevels(), 2);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            for (int c = 0; c < 3; ++c)
                REQUIRE(result.row(c, y)[x] == Approx(light(c, x, y)).epsilon(1e-4));
}

TEST_CASE("Noise on even light is taken away, on a sharp shadow's edge the shadow stays") {
    // Two halves of standard deviation 0.5 about 1 (left) and 4 (right): their mean has 0.354.
    constexpr int kWidth = 96, kHeight = 96, kEdge = 48;
    const TracedSurfaces surfaces = floorOf(kWidth, kHeight);
    WorkerPool pool(2);
    ShrinkFilter shrink(kWidth, kHeight);
    std::mt19937 random(7);
    std::normal_distribution<float> noise(0.0f, 0.5f);
    double raw = 0.0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const float truth = x < kEdge ? 1.0f : 4.0f, a = truth + noise(random),
                        b = truth + noise(random);
            for (int c = 0; c < 3; ++c) shrink.input().row(c, y)[x] = 0.5f * (a + b);
            shrink.input().row(ShrinkFilter::kNoisePlane, y)[x] =
                ShrinkFilter::noiseScale(1, 1) * (a - b);
            raw += std::pow(double(0.5f * (a + b) - truth), 2);
        }
    const PaddedPlanes& result = shrink.filter(pool, surfaces, threeLevels(), 2);
    double even = 0.0, evenCount = 0.0, edge = 0.0, edgeCount = 0.0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const double e = std::pow(double(result.row(0, y)[x]) - (x < kEdge ? 1.0 : 4.0), 2);
            const bool isNear = std::abs(x - kEdge) < 4;
            (isNear ? edge : even) += e;
            (isNear ? edgeCount : evenCount) += 1.0;
        }
    raw /= kWidth * kHeight;
    INFO("mean squares: raw " << raw << ", even " << even / evenCount << ", edge " << edge / edgeCount);
    CHECK(raw == Approx(0.125).epsilon(0.05));
    CHECK(even / evenCount < raw / 10.0);
    // The plain filter of three levels blurs the step to about 7 times the raw error there.
    CHECK(edge / edgeCount < 2.0 * raw);
}

TEST_CASE("The error falls as paths are added, and the filter never adds to it") {
    // Shipped scenes of different light: a spot in a box, a sun, a lamp behind a door.
    for (const char* name : {"cornell", "basic", "rooms"}) {
        const View view(name, 48, 27);
        constexpr int kTruthSamples = 1024;
        constexpr std::uint32_t kSeeds = 5;
        const Image truth = truthOf(view, kTruthSamples);
        double before = 1e30, rawFirst = 0.0;
        for (const std::uint32_t spp : {1u, 2u, 4u, 16u, 64u}) {
            double raw = 0.0, error = 0.0;
            for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
                RivalOptions plain = unfiltered(1, spp), smooth = filtered(spp);
                plain.seed = smooth.seed = seed;
                raw += errorOf(render(view, plain), truth, 1).relMse / kSeeds;
                error += errorOf(render(view, smooth), truth, 1).relMse / kSeeds;
            }
            INFO(name << ", " << spp << " paths: relMSE " << raw << " -> " << error);
            constexpr double kMargin = 1.15;  // of small pictures' errors, with bright outliers
            CHECK(error < kMargin * before);
            CHECK(error < kMargin * raw);
            if (spp == 1) rawFirst = raw;
            // Independent paths: 1/n. The points do better, and the first error is an estimate too.
            if (spp == 64) CHECK(raw < 1.2 * rawFirst / 64.0);
            before = error;
        }
    }
}

TEST_CASE("Even light stays even at any number of paths") {
    // A furnace, whose raw pictures have a relMSE of 0.1 at 1 path and 0.0015 at 64.
    const View view("furnace", 48, 27);
    for (const std::uint32_t spp : {1u, 2u, 4u, 16u, 64u}) {
        const Result result = render(view, filtered(spp));
        double squares = 0.0;
        for (int y = 0; y < 27; ++y)
            for (int x = 0; x < 48; ++x)
                squares += std::pow(double(result.irradiance.row(0, y)[x]) / 0.5 - 1.0, 2) / (48 * 27);
        INFO(spp << " paths: mean square " << squares);
        CHECK(squares < 0.1 / spp / 20.0);
    }
}
