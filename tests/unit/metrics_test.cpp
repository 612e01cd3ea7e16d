// Comparison of layered images: errors by hand, what is counted, the noise estimate, error messages.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "metrics.h"

using Catch::Matchers::Contains;
using studio::compareImages;
using studio::Image;
using studio::Metrics;

namespace {

const char* const kRgb[] = {"R", "G", "B"};

// Irradiance given per pixel, the same in each channel; direct light 0.1, albedo 0.5 everywhere.
Image greyScene(int width, int height, const std::vector<float>& irradiance) {
    Image image(width, height);
    for (const char* name : kRgb) {
        image.plane(name) = irradiance;
        image.plane(std::string("direct.") + name).assign(image.pixelCount(), 0.1f);
        image.plane(std::string("albedo.") + name).assign(image.pixelCount(), 0.5f);
    }
    return image;
}

// A scene with structure: smooth light, edges, colours, and a background in the upper rows.
Image variedScene(int width, int height) {
    Image image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if (y < height / 8) continue;
            const std::size_t i = std::size_t(y) * std::size_t(width) + std::size_t(x);
            image.plane("normal.Y");
            image.channels["normal.Y"][i] = 1.0f;
            for (int c = 0; c < 3; ++c) {
                image.plane(kRgb[c])[i] =
                    1.0f + std::sin(0.11f * float(x + 7 * c)) * std::cos(0.07f * float(y));
                image.plane(std::string("direct.") + kRgb[c])[i] =
                    (x / 16 + y / 16) % 2 == 0 ? 0.6f : 0.02f;
                image.plane(std::string("albedo.") + kRgb[c])[i] = 0.3f + 0.2f * float(c);
            }
        }
    return image;
}

}  // namespace

TEST_CASE("identical images have no error and score exactly 10") {
    const Image scene = variedScene(64, 40);
    const Metrics same = compareImages(scene, scene);
    CHECK(same.relMse == 0.0);
    CHECK(same.nrmse == 0.0);
    CHECK(same.bias == 0.0);
    CHECK(same.p99 == 0.0);
    CHECK(same.rmse == 0.0);
    CHECK(same.ssim == 1.0);
    CHECK(same.score == 10.0);
    CHECK(same.score255 == 10.0);
    CHECK(same.flip == 0.0);
    CHECK(same.referenceNoise < 0.0);
}

TEST_CASE("2x2 pixels by hand") {
    // F = 1 3 2 2, R = 1 1 2 4: F-R = 0 2 0 -2, mean(R) = 2, floor 0.01 * 4 = 0.04.
    const Image image = greyScene(2, 2, {1, 3, 2, 2}), reference = greyScene(2, 2, {1, 1, 2, 4});
    const Metrics metrics = compareImages(image, reference);
    const double terms[4] = {0.0, 4.0 / 1.04, 0.0, 4.0 / 16.04};
    CHECK(metrics.relMse == Approx((terms[1] + terms[3]) / 4.0));
    CHECK(metrics.nrmse == Approx(std::sqrt(8.0 / 4.0) / 2.0));
    CHECK(metrics.bias == Approx(0.0).margin(1e-12));
    CHECK(metrics.p99 == Approx(std::sqrt(terms[1])));  // 12 values: rank ceil(11.88) = the largest

    // Display: exposure 0.18 / geometric mean of L = 0.1 + 0.5 / pi * R; Reinhard; sRGB.
    const double kPi = 3.14159265358979, f[4] = {1, 3, 2, 2}, r[4] = {1, 1, 2, 4};
    double logSum = 0.0, squares = 0.0;
    for (double e : r) logSum += std::log(0.1 + 0.5 / kPi * e);
    const double exposure = 0.18 / std::exp(logSum / 4.0);
    const auto shown = [&](double e) {
        const double exposed = exposure * (0.1 + 0.5 / kPi * e), mapped = exposed / (1.0 + exposed);
        return 1.055 * std::pow(mapped, 1.0 / 2.4) - 0.055;
    };
    for (int i = 0; i < 4; ++i) squares += std::pow(shown(f[i]) - shown(r[i]), 2.0);
    CHECK(metrics.rmse == Approx(std::sqrt(squares / 4.0)).epsilon(1e-5));
}

TEST_CASE("bias has a sign, and channels count alike") {
    Image image = greyScene(2, 1, {2, 2});
    const Image reference = greyScene(2, 1, {2, 2});
    image.plane("G") = {1, 1};  // one channel of three at half
    const Metrics metrics = compareImages(image, reference);
    CHECK(metrics.bias == Approx(-1.0 / 6.0));
    CHECK(metrics.nrmse == Approx(std::sqrt(1.0 / 3.0) / 2.0));
    CHECK(metrics.relMse == Approx(1.0 / 4.04 / 3.0));
    CHECK(compareImages(greyScene(2, 1, {3, 3}), reference).bias == Approx(0.5));
}

TEST_CASE("the 99th percentile is the nearest rank") {
    // 200 pixels, all right but 1, 2 or 3: rank ceil(0.99 * 600) = 594 of 600 values.
    const std::vector<float> ones(200, 1.0f);
    const Image reference = greyScene(20, 10, ones);
    for (const auto& [wrong, expected] : {std::pair{1, 0.0}, {2, 0.0}, {3, std::sqrt(1.0 / 1.01)}}) {
        std::vector<float> values = ones;
        for (int i = 0; i < wrong; ++i) values[std::size_t(60 * i)] = 2.0f;
        CHECK(compareImages(greyScene(20, 10, values), reference).p99 == Approx(expected));
    }
}

TEST_CASE("pixels without a surface in both images are left out") {
    // Twice the picture in background changes none of the irradiance errors.
    const Image image = greyScene(2, 1, {1, 3}), reference = greyScene(2, 1, {2, 2});
    const Metrics alone = compareImages(image, reference);
    const auto widened = [](const Image& from, bool normals) {
        Image wide(4, 1);
        for (const auto& [name, values] : from.channels)
            wide.channels[name] = {values[0], values[1], 0.0f, 0.0f};
        if (normals) wide.channels["normal.Z"] = {-1.0f, 0.5f, 0.0f, 0.0f};
        return wide;
    };
    for (bool imageNormals : {false, true})
        for (bool referenceNormals : {false, true}) {
            Image wideImage = widened(image, imageNormals);
            const Image wideReference = widened(reference, referenceNormals);
            const Metrics wide = compareImages(wideImage, wideReference);
            CHECK(wide.relMse == Approx(alone.relMse));
            CHECK(wide.nrmse == Approx(alone.nrmse));
            CHECK(wide.bias == Approx(alone.bias).margin(1e-12));
            CHECK(wide.p99 == Approx(alone.p99));
        }
    // Light on a pixel where the normals say background isn't counted; without normals it is a surface.
    Image leaking = widened(image, false);
    leaking.plane("R")[3] = 5.0f;
    CHECK(compareImages(leaking, widened(reference, true)).nrmse == Approx(alone.nrmse));
    CHECK(compareImages(leaking, widened(reference, false)).nrmse > 1.0);
}

TEST_CASE("direct light and albedo come from the reference when the image has none") {
    const Image reference = variedScene(32, 32);
    Image image = reference;
    for (float& value : image.plane("R")) value *= 1.1f;
    const Metrics own = compareImages(image, reference);
    for (const char* name : kRgb) {
        image.channels.erase(std::string("direct.") + name);
        image.channels.erase(std::string("albedo.") + name);
    }
    const Metrics borrowed = compareImages(image, reference);
    CHECK(borrowed.rmse == own.rmse);
    CHECK(borrowed.ssim == own.ssim);
    CHECK(borrowed.flip == own.flip);
    CHECK(own.rmse > 0.0);
}

TEST_CASE("no metric depends on the unit of light") {
    // Float rounding of the scaled values only.
    constexpr double kTolerance = 1e-4;
    const Image reference = variedScene(48, 40);
    Image image = reference;
    for (std::size_t i = 0; i < image.pixelCount(); ++i) image.plane("G")[i] *= i % 3 == 0 ? 1.2f : 0.9f;
    const auto scaled = [](Image from) {
        for (auto& [name, values] : from.channels)
            if (name.find("albedo") == std::string::npos && name.find("normal") == std::string::npos)
                for (float& value : values) value *= 300.0f;
        return from;
    };
    const Metrics once = compareImages(image, reference),
                  bright = compareImages(scaled(image), scaled(reference));
    CHECK(bright.relMse == Approx(once.relMse).epsilon(kTolerance));
    CHECK(bright.nrmse == Approx(once.nrmse).epsilon(kTolerance));
    CHECK(bright.bias == Approx(once.bias).epsilon(kTolerance));
    CHECK(bright.p99 == Approx(once.p99).epsilon(kTolerance));
    CHECK(bright.rmse == Approx(once.rmse).epsilon(kTolerance));
    CHECK(bright.ssim == Approx(once.ssim).epsilon(kTolerance));
    CHECK(bright.score == Approx(once.score).epsilon(kTolerance));
    CHECK(bright.score255 == Approx(once.score255).epsilon(kTolerance));
    CHECK(bright.flip == Approx(once.flip).epsilon(kTolerance));
}

TEST_CASE("reference noise from halves, their sum, or metadata") {
    const Image image = greyScene(2, 1, {1, 1});
    Image reference = greyScene(2, 1, {2, 2});
    CHECK(compareImages(image, reference).referenceNoise < 0.0);

    reference.metadata = {{"layer", "bounce1"}, {"noise.bounce1", "0.0125"}};
    CHECK(compareImages(image, reference).referenceNoise == 0.0125);
    reference.metadata["noise.bounce1"] = "little";
    CHECK_THROWS_WITH(compareImages(image, reference), Contains("noise.bounce1") && Contains("little"));

    // Halves 2 +- 0.1: variance of their mean 0.01, over 2^2 + 0.01 * 2^2.
    for (const char* name : kRgb) {
        reference.channels[std::string("a.bounce1.") + name] = {2.1f, 1.9f};
        reference.channels[std::string("b.bounce1.") + name] = {1.9f, 2.1f};
    }
    CHECK(compareImages(image, reference).referenceNoise == Approx(0.01 / 4.04).epsilon(1e-5));

    // A second layer whose halves err the same way doubles the difference.
    reference.metadata["layer"] = "bounce1+bounce2";
    for (const char* name : kRgb) {
        reference.channels[std::string("a.bounce2.") + name] = {0.1f, -0.1f};
        CHECK_THROWS_WITH(compareImages(image, reference), Contains("missing channel"));
    }
    for (const char* name : kRgb) reference.channels[std::string("b.bounce2.") + name] = {-0.1f, 0.1f};
    CHECK(compareImages(image, reference).referenceNoise == Approx(0.04 / 4.04).epsilon(1e-5));
}

TEST_CASE("maps are pictures ready to be written") {
    const Image reference = variedScene(40, 32);
    Image image = reference;
    image.plane("R")[700] *= 30.0f;
    studio::MetricMaps maps;
    compareImages(image, reference, &maps);
    for (const Image* map : {&maps.relativeError, &maps.ssim, &maps.flip}) {
        REQUIRE(map->width == 40);
        REQUIRE(map->height == 32);
        for (const char* name : kRgb) {
            const std::vector<float>& plane = map->plane(name);
            CHECK(*std::min_element(plane.begin(), plane.end()) >= 0.0f);
            CHECK(*std::max_element(plane.begin(), plane.end()) <= 1.0f);
            CHECK(plane[0] == Approx(0.0f).margin(1e-3));  // background, far from the change: black
        }
        CHECK(map->plane("R")[700] + map->plane("G")[700] + map->plane("B")[700] > 0.01f);
    }
}

TEST_CASE("what can't be compared is said") {
    const Image good = greyScene(2, 2, {1, 2, 3, 4});
    CHECK_THROWS_WITH(compareImages(greyScene(4, 1, {1, 2, 3, 4}), good),
                      Contains("4x1") && Contains("2x2"));

    Image bad = good;
    bad.channels.erase("G");
    CHECK_THROWS_WITH(compareImages(bad, good), Contains("image") && Contains("missing channel G"));
    bad = good;
    bad.channels.erase("albedo.B");
    CHECK_THROWS_WITH(compareImages(bad, good), Contains("image") && Contains("albedo.B"));
    CHECK_THROWS_WITH(compareImages(good, bad), Contains("reference") && Contains("albedo.B"));

    bad = good;
    bad.plane("R")[1] = bad.plane("B")[1] = std::numeric_limits<float>::quiet_NaN();
    bad.plane("direct.G")[3] = std::numeric_limits<float>::infinity();
    CHECK_THROWS_WITH(compareImages(bad, good),
                      Contains("image: 2 of 4 pixels") && Contains("R, B, direct.G"));
    CHECK_THROWS_WITH(compareImages(good, bad), Contains("reference: 2 of 4 pixels"));

    bad = good;
    bad.plane("R").resize(3);
    CHECK_THROWS_WITH(compareImages(bad, good), Contains("3 values"));

    bad = good;
    bad.metadata[studio::kDisplayReferredKey] = "sRGB";
    CHECK_THROWS_WITH(compareImages(bad, good), Contains("scene-linear"));

    CHECK_THROWS_WITH(compareImages(good, greyScene(2, 2, {0, 0, 0, 0})),
                      Contains("mean irradiance is 0"));
    Image nothing = good;
    for (auto& channel : nothing.channels) channel.second.assign(4, 0.0f);
    CHECK_THROWS_WITH(compareImages(nothing, nothing), Contains("no pixel shows a surface"));
}
