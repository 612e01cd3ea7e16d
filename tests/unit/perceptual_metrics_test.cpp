// SSIM against scikit-image, FLIP against its authors' package, the scores against closed forms.
#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "../reference/flip_values.h"
#include "../reference/metric_patterns.h"
#include "../reference/ssim_values.h"
#include "flip.h"
#include "separable_filter.h"
#include "ssim.h"

using studio::Image;

namespace {

const char* const kRgb[] = {"R", "G", "B"};

Image constantImage(int width, int height, float value) {
    Image image(width, height);
    for (const char* name : kRgb) image.plane(name).assign(image.pixelCount(), value);
    return image;
}

Image patternImage(const std::function<int(int, int, int)>& code, bool linear) {
    using namespace metric_patterns;
    Image image(kWidth, kHeight);
    for (int c = 0; c < 3; ++c) {
        std::vector<float>& plane = image.plane(kRgb[c]);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const float value = float(code(x, y, c)) / 255.0f;
                plane[std::size_t(y * kWidth + x)] = linear ? studio::srgbDecode(value) : value;
            }
    }
    return image;
}

struct Pair {
    Image reference, test;
};
Pair patternPair(int pattern, int change, bool linear) {
    using namespace metric_patterns;
    return {
        patternImage([&](int x, int y, int c) { return code(pattern, x, y, c); }, linear),
        patternImage([&](int x, int y, int c) { return changed(pattern, change, x, y, c); }, linear)};
}

double meanOf(const std::vector<float>& values) {
    double sum = 0.0;
    for (float value : values) sum += double(value);
    return sum / double(values.size());
}

std::size_t probeIndex(const int (&probe)[2]) {
    return std::size_t(probe[1] * metric_patterns::kWidth + probe[0]);
}

}  // namespace

TEST_CASE("separable filters: mirrored and clamped borders, kernels off centre") {
    const std::vector<float> row{1, 2, 4};
    const std::vector<float> left{1, 0, 0}, wide{1, 0, 0, 0, 0, 0, 0, 0, 0};  // picks x-1, and x-4
    CHECK(filterRows(row, 3, 1, left, studio::Border::Clamp) == std::vector<float>{1, 1, 2});
    CHECK(filterRows(row, 3, 1, left, studio::Border::Mirror) == std::vector<float>{1, 1, 2});
    CHECK(filterRows(row, 3, 1, wide, studio::Border::Mirror) ==
          std::vector<float>{4, 4, 2});  // 421|124|...
    CHECK(filterColumns(row, 1, 3, left, studio::Border::Clamp) == std::vector<float>{1, 1, 2});
    CHECK(filterColumns(row, 1, 3, wide, studio::Border::Mirror) == std::vector<float>{4, 4, 2});
}

TEST_CASE("SSIM agrees with scikit-image") {
    // Both in double, but the pictures come here as floats and the map leaves as floats (6e-8); the
    // power 1000 magnifies SSIM's rounding, little where it is near 1. Measured: 2e-7 and 3e-7.
    constexpr double kSsimTolerance = 1e-6, kScoreTolerance = 1e-5;
    for (const ssim_values::Row& row : ssim_values::kRows) {
        const Pair pair = patternPair(row.pattern, row.change, false);
        const studio::SsimResult result = compareSsim(pair.test, pair.reference);
        INFO("pattern " << row.pattern << " change " << row.change);
        CHECK(result.ssim == Approx(row.mean).margin(kSsimTolerance));
        CHECK(result.score == Approx(row.score).margin(kScoreTolerance));
        CHECK(result.score255 == Approx(row.score255).margin(kScoreTolerance));
        for (int k = 0; k < 8; ++k)
            CHECK(double(result.map[probeIndex(metric_patterns::kProbes[k])]) ==
                  Approx(row.probes[k]).margin(kSsimTolerance));
    }
}

TEST_CASE("FLIP agrees with its authors' package") {
    // Both filter in 32-bit float, in another order. Measured: mean within 1.1e-6, pixels within 1.7e-6.
    constexpr double kMeanTolerance = 1e-5, kPixelTolerance = 2e-5;
    for (const flip_values::Row& row : flip_values::kRows) {
        const Pair pair = patternPair(row.pattern, row.change, true);
        const std::vector<float> flip = studio::flipMap(pair.test, pair.reference);
        INFO("pattern " << row.pattern << " change " << row.change);
        CHECK(meanOf(flip) == Approx(row.mean).margin(kMeanTolerance));
        for (int k = 0; k < 8; ++k)
            CHECK(double(flip[probeIndex(metric_patterns::kProbes[k])]) ==
                  Approx(row.probes[k]).margin(kPixelTolerance));
    }
}

TEST_CASE("FLIP: black against white is 1, and the order doesn't matter") {
    // Black to white: the largest lightness step, 100, but less than green to blue, which defines 1.
    const Image black = constantImage(30, 20, 0.0f), white = constantImage(30, 20, 1.0f);
    CHECK(meanOf(studio::flipMap(black, white)) == Approx(0.97).margin(0.02));
    Image green = black, blue = black;
    green.plane("G").assign(600, 1.0f);
    blue.plane("B").assign(600, 1.0f);
    CHECK(meanOf(studio::flipMap(green, blue)) == Approx(1.0).margin(1e-4));
    const Pair pair = patternPair(1, 2, true);
    CHECK(studio::flipMap(pair.test, pair.reference) == studio::flipMap(pair.reference, pair.test));
}

TEST_CASE("score of a constant offset: closed form and the stated figures") {
    // Flat pictures have no variance: SSIM = 1 - d^2 / (x^2 + y^2 + C1), C1 = 2.55^2 or 0.01^2.
    constexpr float kGrey = 0.40f;
    const struct {
        float offset;
        double score, scoreMargin, score255, score255Margin;
    } cases[] = {
        {0.02f, 9.4, 0.05, 3.0, 0.06}, {0.05f, 6.9, 0.05, 0.04, 0.04}, {0.1f, 2.3, 0.06, 0.0, 0.001}};
    for (const auto& c : cases) {
        const Image x = constantImage(24, 16, kGrey + c.offset), y = constantImage(24, 16, kGrey);
        const studio::SsimResult result = compareSsim(x, y);
        const double a = double(kGrey + c.offset), b = double(kGrey), d2 = (a - b) * (a - b);
        CHECK(result.score ==
              Approx(10.0 * std::pow(1.0 - d2 / (a * a + b * b + 6.5025), 1000.0)).epsilon(1e-6));
        CHECK(result.score255 ==
              Approx(10.0 * std::pow(1.0 - d2 / (a * a + b * b + 1e-4), 1000.0)).epsilon(1e-6));
        CHECK(result.score == Approx(c.score).margin(c.scoreMargin));
        CHECK(result.score255 == Approx(c.score255).margin(c.score255Margin));
    }
}

TEST_CASE("score ignores pixels black in both and counts negative SSIM as 0") {
    // Left half black in both, right half offset: the score is that of the offset alone but for the
    // windows that reach over the seam.
    const Image flat = constantImage(80, 40, 0.4f), brighter = constantImage(80, 40, 0.45f);
    Image x = flat, y = brighter;
    for (const char* name : kRgb)
        for (std::size_t i = 0; i < x.pixelCount(); ++i)
            if (i % 80 < 40) x.plane(name)[i] = y.plane(name)[i] = 0.0f;
    const double alone = compareSsim(flat, brighter).score, half = compareSsim(x, y).score;
    CHECK(half == Approx(alone).margin(0.1 * alone));  // 5 of 40 columns see the seam
    CHECK(compareSsim(constantImage(12, 12, 0.0f), constantImage(12, 12, 0.0f)).score == 10.0);

    // A checkerboard against its negative: structure is opposite, SSIM negative, score 0.
    Image board = constantImage(24, 24, 0.0f), negative = board;
    for (const char* name : kRgb)
        for (std::size_t i = 0; i < board.pixelCount(); ++i) {
            board.plane(name)[i] = (i % 24 + i / 24) % 2 == 0 ? 1.0f : 0.0f;
            negative.plane(name)[i] = 1.0f - board.plane(name)[i];
        }
    const studio::SsimResult opposite = compareSsim(board, negative);
    CHECK(opposite.ssim < -0.9);
    CHECK(opposite.score255 == 0.0);
    CHECK(opposite.score < 1e-3);
}
