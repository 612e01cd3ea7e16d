// Shares of a VPL technique's error: pictures whose shares are known by hand.
#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "error_split.h"

using studio::ErrorSplit;
using studio::ErrorSplitter;
using studio::Image;

namespace {

constexpr double kRounding = 1e-6;  // pictures are floats

// One surface pixel for each value, grey; then a pixel of background that must not count.
Image picture(const std::vector<float>& values) {
    Image image(int(values.size()) + 1, 1);
    for (const char* channel : {"R", "G", "B"}) {
        std::vector<float>& plane = image.plane(channel);
        std::copy(values.begin(), values.end(), plane.begin());
        plane.back() = 1e6f;
        std::vector<float>& normal = image.plane(std::string("normal.") + channel);
        std::fill(normal.begin(), normal.end() - 1, channel[0] == 'G' ? 1.0f : 0.0f);
    }
    return image;
}

double sumOf(const ErrorSplit& split) {
    return split.model + split.resolution + split.visibility + split.sampling.value_or(0.0) +
           split.bounding;
}

}  // namespace

TEST_CASE("each approximation gets what the error loses without it") {
    // R = 2 and 4 with R1 = 1 and 2: a second bounce as strong as the first. Denominators R^2 + 0.01
    // * 9.
    const Image own = picture({1.0f, 2.0f}), all = picture({2.0f, 4.0f});
    const double near = 1.0 / 4.09, far = 1.0 / 16.09;
    ErrorSplitter splitter(own, all);
    splitter.add(picture({2.0f, 5.0f}), picture({1.5f, 4.0f}), picture({0.5f, 2.5f}));
    const ErrorSplit one = splitter.result();
    // As rendered against R, then against R1: 0 and 1; 1 and 3. Full: 0.5 and 2. Exact: -0.5 and 0.5.
    const double total = 0.5 * (0.0 * near + 1.0 * far), modelled = 0.5 * (1.0 * near + 9.0 * far);
    const double full = 0.5 * (0.25 * near + 4.0 * far), visible = 0.5 * (0.25 * near + 0.25 * far);
    CHECK(one.total == Approx(total).epsilon(kRounding));
    CHECK(one.model == Approx(total - modelled).epsilon(kRounding));
    CHECK(one.model < 0.0);  // too much light hid the bounce left out
    CHECK(one.resolution == Approx(modelled - full).epsilon(kRounding));
    CHECK(one.visibility == Approx(full - visible).epsilon(kRounding));
    CHECK_FALSE(one.sampling);
    CHECK(one.bounding == Approx(visible).epsilon(kRounding));
    CHECK(sumOf(one) == Approx(one.total).epsilon(kRounding));
}

TEST_CASE("what differs between patterns is sampling, what they share is bounding") {
    const Image truth = picture({1.0f, 1.0f});
    const double weight = 1.0 / 1.01;
    ErrorSplitter splitter(truth, truth);
    // Two patterns about a mean of 0.9: variance 2 * 0.2^2 / (2 - 1), bias -0.1.
    for (const float value : {0.7f, 1.1f}) {
        const Image pattern = picture({value, value});
        splitter.add(pattern, pattern, pattern);
    }
    const ErrorSplit split = splitter.result();
    REQUIRE(split.sampling);
    CHECK(*split.sampling == Approx(0.08 * weight).epsilon(kRounding));
    // E[(V - R)^2] = 0.05 over these two; less the variance of V.
    CHECK(split.bounding == Approx((0.05 - 0.08) * weight).epsilon(kRounding));
    CHECK(split.model == 0.0);
    CHECK(split.resolution == 0.0);
    CHECK(split.visibility == 0.0);
    CHECK(sumOf(split) == Approx(split.total).epsilon(kRounding));
}

TEST_CASE("the split between sampling and bounding is unbiased over many runs of few patterns") {
    const Image truth = picture({1.0f});
    const double weight = 1.0 / 1.01;
    // All 27 ways to draw three patterns from {0.6, 0.9, 1.5}: mean 1, variance 0.14 (population).
    const float values[] = {0.6f, 0.9f, 1.5f};
    double sampling = 0.0, bounding = 0.0;
    for (const float a : values)
        for (const float b : values)
            for (const float c : values) {
                ErrorSplitter splitter(truth, truth);
                for (const float value : {a, b, c}) {
                    const Image pattern = picture({value + 0.3f});  // and a bias of 0.3
                    splitter.add(pattern, pattern, pattern);
                }
                sampling += *splitter.result().sampling / 27.0;
                bounding += splitter.result().bounding / 27.0;
            }
    CHECK(sampling == Approx(0.14 * weight).epsilon(1e-5));
    CHECK(bounding == Approx(0.09 * weight).epsilon(1e-5));
}

TEST_CASE("a split refuses what it cannot mean") {
    const Image truth = picture({1.0f, 1.0f});
    CHECK_THROWS_AS(ErrorSplitter(truth, truth).result(), std::logic_error);
    CHECK_THROWS_WITH(ErrorSplitter(truth, picture({1.0f})),
                      Catch::Matchers::Contains("expected pictures of 3x1 pixels, got 2x1"));
    CHECK_THROWS_WITH(ErrorSplitter(picture({0.0f, 0.0f}), picture({0.0f, 0.0f})),
                      Catch::Matchers::Contains("black"));
    ErrorSplitter splitter(truth, truth);
    CHECK_THROWS_WITH(splitter.add(truth, truth, picture({1.0f})), Catch::Matchers::Contains("got 2x1"));
    const Image broken = picture({1.0f, std::numeric_limits<float>::quiet_NaN()});
    CHECK_THROWS_WITH(splitter.add(truth, broken, truth),
                      Catch::Matchers::Contains("channel R, pixel 1: expected a finite irradiance"));
    CHECK_THROWS_WITH(ErrorSplitter(broken, truth), Catch::Matchers::Contains("finite"));
}
