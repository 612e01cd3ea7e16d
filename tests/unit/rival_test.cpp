// The rival against values that are known without it and against the reference path tracer.
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "rival_filter.h"
#include "support/rival_view.h"

namespace {

using namespace studio;

using namespace rival_test;

bool sameBits(const Result& a, const Result& b) {
    for (int c = 0; c < 3; ++c)
        for (int y = 0; y < a.validity.height(); ++y)
            for (int x = 0; x < a.validity.width(); ++x)
                if (a.irradiance.row(c, y)[x] != b.irradiance.row(c, y)[x]) return false;
    return true;
}

}  // namespace

TEST_CASE("In a furnace each bounce carries the albedo's share of the one before") {
    // Exitance 1, albedo 0.5: bounces 0.5 and 0.25. At 64 paths the mean over 48x27 pixels has a
    // standard deviation of about 0.1 %.
    constexpr double kTolerance = 0.005;
    const View view("furnace", 48, 27);
    CHECK(meanOf(render(view, unfiltered(1, 64))) == Approx(0.5).epsilon(kTolerance));
    CHECK(meanOf(render(view, unfiltered(2, 64))) == Approx(0.75).epsilon(kTolerance));
}

TEST_CASE("In the sphere with a lamp in its middle the bounces are pi/2 and pi/4 everywhere") {
    // Every ray finds the same: only the facets (64 rings) and smooth normals differ from the sphere.
    constexpr double kFacets = 0.01;
    const View view("sphere_room", 48, 27);
    const double pi = 3.14159265358979;
    CHECK(meanOf(render(view, unfiltered(1, 1))) == Approx(pi / 2).epsilon(kFacets));
    CHECK(meanOf(render(view, unfiltered(2, 1))) == Approx(0.75 * pi).epsilon(kFacets));

    // So the filter and the up-sampling have nothing to change either, at every pixel. Where the smooth
    // normal leans furthest from its facet a few of the 4 paths start under it: 3 to 4 %.
    constexpr double kLeaningNormals = 0.06;
    for (const RivalResolution resolution :
         {RivalResolution::Full, RivalResolution::Half, RivalResolution::Quarter}) {
        RivalOptions options;
        options.spp = 4;
        options.resolution = resolution;
        const Result result = render(view, options);
        INFO("resolution " << int(resolution));
        for (int y = 0; y < 27; ++y)
            for (int x = 0; x < 48; ++x)
                REQUIRE(double(result.irradiance.row(0, y)[x]) == Approx(pi / 2).epsilon(kLeaningNormals));
    }
}

TEST_CASE("The unfiltered error against the reference falls at least as a random estimate's") {
    const View view("cornell", 32, 24);
    constexpr int kTruthSamples = 4096;
    const Image truth = truthOf(view, kTruthSamples);
    for (const int bounces : {1, 2}) {
        INFO("bounces " << bounces);
        // Independent sample points would fall by 1/8 from 1 to 64 paths; Owen-scrambled ones by more.
        // 1.2: the first error is itself an estimate, of 768 pixels with some bright outliers.
        const Error one = errorOf(render(view, unfiltered(std::uint32_t(bounces), 1)), truth, bounces);
        const Error many = errorOf(render(view, unfiltered(std::uint32_t(bounces), 64)), truth, bounces);
        INFO("nRMSE " << one.nrmse << " at 1, " << many.nrmse << " at 64, bias " << many.bias);
        CHECK(many.nrmse < 1.2 * one.nrmse / 8.0);
        // The mean of 768 pixels: four standard deviations of independent pixels.
        CHECK(std::abs(many.bias) < 4.0 * many.nrmse / std::sqrt(768.0));
        // Ever more samples meet the reference as nearly as its own noise lets them.
        const Error most =
            errorOf(render(view, unfiltered(std::uint32_t(bounces), 1024)), truth, bounces);
        INFO("nRMSE " << most.nrmse << " at 1024");
        CHECK(most.nrmse < many.nrmse / 3.0);
        CHECK(std::abs(most.bias) < 0.003);
    }
}

TEST_CASE("Coherent patterns and single rays estimate the same light") {
    const View view("cornell", 32, 24);
    const double expected = meanOf(render(view, unfiltered(2, 256)));
    for (const std::uint32_t pattern : {1u, 2u, 4u, 8u})
        for (const RivalRays rays : {RivalRays::Packets, RivalRays::Single}) {
            RivalOptions options = unfiltered(2, 256);
            options.pattern = pattern;
            options.rays = rays;
            INFO("pattern " << pattern << ", rays " << int(rays));
            // Pixels that share sample points share their error: 256 points in all with pattern 1.
            CHECK(meanOf(render(view, options)) == Approx(expected).epsilon(0.03));
        }
}

TEST_CASE("Connections to lit points bring the same light with less noise") {
    const View view("cornell", 32, 24);
    const Image truth = truthOf(view, 4096);
    for (const int bounces : {1, 2}) {
        RivalOptions options = unfiltered(std::uint32_t(bounces), 64);
        const Error without = errorOf(render(view, options), truth, bounces);
        options.connect = 1;
        const Error with = errorOf(render(view, options), truth, bounces);
        INFO("bounces " << bounces << ", nRMSE " << without.nrmse << " -> " << with.nrmse << ", bias "
                        << with.bias);
        CHECK(with.nrmse < without.nrmse);
        CHECK(std::abs(with.bias) < 0.005);  // the mean of 768 pixels, and the truth's own noise
    }
}

TEST_CASE("Same seed, same bits; another seed, other noise") {
    const View view("basic", 64, 48);
    RivalOptions options;
    options.bounces = 2;
    options.resolution = RivalResolution::Half;
    const Result first = render(view, options), again = render(view, options);
    CHECK(sameBits(first, again));
    options.seed = 1;
    CHECK_FALSE(sameBits(first, render(view, options)));
}

TEST_CASE("Background is black and invalid; every surface is finite at any resolution") {
    const View view("basic", 61, 47);
    for (const RivalResolution resolution :
         {RivalResolution::Full, RivalResolution::Half, RivalResolution::Quarter}) {
        RivalOptions options;
        options.resolution = resolution;
        const Result result = render(view, options);
        int background = 0;
        for (int y = 0; y < 47; ++y)
            for (int x = 0; x < 61; ++x) {
                const glm::vec3 e = result.irradiance.rgb(x, y);
                const bool isSurface = view.gbuffer.normal.rgb(x, y) != glm::vec3(0.0f);
                REQUIRE(result.validity.row(0, y)[x] == (isSurface ? 1.0f : 0.0f));
                REQUIRE((std::isfinite(e.x) && std::isfinite(e.y) && std::isfinite(e.z)));
                if (!isSurface) {
                    ++background;
                    REQUIRE(e == glm::vec3(0.0f));
                }
            }
        CHECK(background > 0);
    }
}

TEST_CASE("The filter keeps a constant and lets nothing across an edge") {
    constexpr int kWidth = 50, kHeight = 20, kEdge = 23;
    TracedSurfaces surfaces(kWidth, kHeight);
    PaddedPlanes from(kWidth, kHeight, 3), to(kWidth, kHeight, 3);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {  // a floor that meets a wall
            const bool isWall = x >= kEdge;
            surfaces.position.row(0, y)[x] = float(isWall ? kEdge : x);
            surfaces.position.row(1, y)[x] = float(isWall ? x - kEdge : 0);
            surfaces.position.row(2, y)[x] = float(y);
            surfaces.normal.row(isWall ? 0 : 1, y)[x] = isWall ? -1.0f : 1.0f;
            for (int c = 0; c < 3; ++c) from.row(c, y)[x] = isWall ? 7.0f : float(c + 1);
        }
    WorkerPool pool(2);
    for (const std::vector<Tap>& window : {patternWindow(4), patternWindow(8), splineWindow(4)}) {
        filterImage(pool, surfaces, window, from, to);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                for (int c = 0; c < 3; ++c)
                    REQUIRE(to.row(c, y)[x] == Approx(x >= kEdge ? 7.0f : float(c + 1)).epsilon(1e-5));
    }
}

TEST_CASE("Options out of range are refused by name") {
    RivalOptions options;
    options.bounces = 3;
    CHECK_THROWS_WITH(Rival(options, 8, 8), Catch::Contains("bounces") && Catch::Contains("got 3"));
    options = {};
    options.spp = 0;
    CHECK_THROWS_WITH(Rival(options, 8, 8), Catch::Contains("spp"));
    options = {};
    options.pattern = 3;
    CHECK_THROWS_WITH(Rival(options, 8, 8), Catch::Contains("pattern"));
}
