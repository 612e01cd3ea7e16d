// Indices of sequences whose values are known by hand.
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <string>

#include "stability_indices.h"
#include "support/noise_number.h"
#include "support/stability_frames.h"

using Catch::Matchers::Contains;
using stability_test::Light;
using stability_test::makeFrames;
using stability_test::noiseNumber;
using studio::StabilityFrame;
using studio::stabilityIndices;
using studio::StabilityIndices;
using studio::StabilityReason;

namespace {

constexpr int kCount = 32, kWidth = 40, kHeight = 24;  // tiles of 2x2 pixels
constexpr double kExact = 1e-6;                        // images are float

Light even(double value) {
    return [value](int, int, int) { return value; };
}

StabilityIndices indicesOf(const Light& image, const Light& truth, float step = 0.0f) {
    return stabilityIndices(makeFrames(kCount, kWidth, kHeight, image, truth, step));
}

std::string failureOf(const std::vector<StabilityFrame>& frames) {
    try {
        stabilityIndices(frames);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

void checkFinite(const StabilityIndices& indices) {
    for (const auto& index :
         {indices.flicker, indices.ghost, indices.leak, indices.drift, indices.spike})
        if (index.has_value()) CHECK(std::isfinite(*index));
    CHECK(std::isfinite(indices.error));
    CHECK(std::isfinite(indices.bias));
}

}  // namespace

TEST_CASE("an image that equals the truth has no index above 0, however it moves") {
    for (float step : {0.0f, 0.3f, 1.0f, 2.5f}) {
        INFO("step " << step);
        const Light light = [](int t, int x, int y) { return 1.0 + 0.9 * noiseNumber(t, x, y); };
        const StabilityIndices indices = indicesOf(light, light, step);
        CHECK(indices.flicker.value() == 0.0);
        CHECK(indices.ghost.value_or(0.0) == 0.0);
        CHECK(indices.drift.value() == 0.0);
        CHECK(indices.spike.value() == 0.0);
        CHECK_FALSE(indices.leak.has_value());
        CHECK(indices.worstReason == StabilityReason::None);
    }
}

TEST_CASE("flicker: brightness that alternates") {
    // F - R = +0.3, -0.3, +0.3 ...: each difference is 0.6; mean(R) is 2.
    const auto image = [](int t, int, int) { return 2.0 + (t % 2 == 0 ? 0.3 : -0.3); };
    const StabilityIndices indices = indicesOf(image, even(2.0));
    CHECK(indices.flicker.value() == Approx(0.3));
    CHECK(indices.drift.value() == Approx(0.0).margin(kExact));
    CHECK_FALSE(indices.frames[0].flicker.has_value());
    CHECK(indices.frames[1].flicker.value() == Approx(0.3));
}

TEST_CASE("flicker: the same noise at rest and in motion") {
    // Two independent numbers of [-a,a] differ by 2a/3 in the mean.
    const auto image = [](int t, int x, int y) { return 1.0 + 0.3 * noiseNumber(t, x, y); };
    for (float step : {0.0f, 0.5f, 1.0f, 3.25f}) {
        INFO("step " << step);
        CHECK(indicesOf(image, even(1.0), step).flicker.value() == Approx(0.2).epsilon(0.03));
    }
}

TEST_CASE("a constant offset is in no index but the bias") {
    const auto truth = [](int t, int x, int y) { return 2.0 + std::sin(0.5 * t + 0.1 * x + 0.2 * y); };
    const auto image = [&](int t, int x, int y) { return truth(t, x, y) + 0.5; };
    const StabilityIndices indices = indicesOf(image, truth, 1.0f);
    CHECK(indices.flicker.value() == Approx(0.0).margin(kExact));
    CHECK(indices.ghost.value_or(0.0) == Approx(0.0).margin(0.05));  // relative to two frames' own light
    CHECK(indices.spike.value() == Approx(0.0).margin(kExact));
    CHECK(indices.bias == Approx(0.25).epsilon(0.1));
    CHECK(indices.worstReason != StabilityReason::Spike);
}

TEST_CASE("an even factor is no drift and no spike while the light changes") {
    for (double factor : {0.5, 1.5}) {
        INFO("factor " << factor);
        const auto truth = [](int t, int x, int) {
            return (1.0 + 0.02 * x) * (t < 16 ? 1.0 + 0.2 * t : 1.0);
        };
        const auto image = [&](int t, int x, int y) { return factor * truth(t, x, y); };
        const StabilityIndices indices = indicesOf(image, truth);
        CHECK(indices.drift.value() == Approx(0.0).margin(kExact));
        CHECK(indices.spike.value() == Approx(0.0).margin(kExact));
        CHECK(indices.flicker.value() > 0.0);  // it follows the light by another amount
    }
}

TEST_CASE("nothing depends on the unit of light") {
    const auto image = [](int t, int x, int y) {
        return 1.0 + 0.01 * t + 0.3 * noiseNumber(t, x, y) + (t == 9 ? 1 : 0);
    };
    const auto truth = [](int t, int x, int) { return (t < 12 ? 1.0 : 4.0) + 0.01 * x; };
    auto frames = makeFrames(kCount, kWidth, kHeight, image, truth, 2.0f);
    for (StabilityFrame& frame : frames) {
        frame.region.assign(frame.surface.size(), 2);
        frame.region[0] = 1;
    }
    const StabilityIndices one = stabilityIndices(frames);
    for (float unit : {1e-12f, 1e12f}) {
        auto scaled = frames;
        for (StabilityFrame& frame : scaled) {
            for (float& value : frame.image) value *= unit;
            for (float& value : frame.truth) value *= unit;
        }
        const StabilityIndices other = stabilityIndices(scaled);
        CHECK(other.flicker.value() == Approx(one.flicker.value()));
        CHECK(other.ghost.value() == Approx(one.ghost.value()));
        CHECK(other.leak.value() == Approx(one.leak.value()));
        CHECK(other.drift.value() == Approx(one.drift.value()));
        CHECK(other.spike.value() == Approx(one.spike.value()));
        CHECK(other.worstFrame == one.worstFrame);
    }
}

TEST_CASE("ghost: light that doubles and an image that follows by half of what is missing") {
    // 1 W/m^2, from frame 4 on 3: at age k the image lacks 2 * 0.5^(k+1), of 3.
    const auto truth = [](int t, int, int) { return t < 4 ? 1.0 : 3.0; };
    const auto lag = [](int t, int, int) { return t < 4 ? 1.0 : 3.0 - 2.0 * std::pow(0.5, t - 3); };
    const double young = 0.25 / 3.0, settled = 2.0 * std::pow(0.5, 13) / 3.0;
    // The settled error is under a percent and counts as one.
    CHECK(indicesOf(lag, truth).ghost.value() == Approx((young - settled) / 0.01));
    // With an error that stays: 0.3 of 3 too dark.
    const auto dark = [&](int t, int x, int y) { return lag(t, x, y) - 0.3; };
    const StabilityIndices indices = indicesOf(dark, truth);
    CHECK(indices.ghost.value() == Approx((young + 0.1) / (settled + 0.1) - 1.0));
    CHECK(indices.frames[6].ghost.value() == indices.ghost.value());
    CHECK_FALSE(indices.frames[7].ghost.has_value());
}

TEST_CASE("ghost: what a moving picture reveals") {
    // Two columns come into sight in each frame, at the left. Their error is 0.5 up to age 2, then 0.1.
    const auto image = [](int t, int x, int) {
        const int age = x / 2;
        return 1.0 + (age < t && age <= 2 ? 0.5 : 0.1);
    };
    CHECK(indicesOf(image, even(1.0), 2.0f).ghost.value() == Approx(4.0).epsilon(1e-4));
    // An error that belongs to surfaces, whatever their age.
    const auto painted = [](int t, int x, int y) { return 1.0 + noiseNumber(7, x - 2 * t, y); };
    CHECK(indicesOf(painted, even(1.0), 2.0f).ghost.value() == Approx(0.0).margin(1e-4));
    // Nothing comes into sight: nothing to judge.
    CHECK_FALSE(indicesOf(painted, even(1.0)).ghost.has_value());
}

TEST_CASE("ghost: cuts and changes of size reveal all of the picture") {
    const auto image = [](int t, int, int) { return t < 10 ? 1.1 : t < 14 ? 1.4 : 1.1; };
    for (bool isCut : {true, false}) {
        auto frames = makeFrames(kCount, kWidth, kHeight, image, even(1.0));
        const auto others = makeFrames(kCount, 20, 12, image, even(1.0));
        frames[10].isCut = isCut;
        if (!isCut) std::copy(others.begin() + 10, others.end(), frames.begin() + 10);
        const StabilityIndices indices = stabilityIndices(frames);
        CHECK(indices.ghost.value() == Approx(3.0).epsilon(1e-4));
        CHECK_FALSE(indices.frames[10].flicker.has_value());
        // From the cut's 1.4 to 1.1 at frame 14: the only difference among 30 pairs of frames.
        const double weight = isCut ? 30.0 : (9.0 * kWidth * kHeight + 21.0 * 240.0) / 240.0;
        CHECK(indices.flicker.value() == Approx(0.3 / weight).epsilon(1e-4));
    }
}

TEST_CASE("leak: light inside over light outside") {
    // The left half is the sealed room: no light in truth, 0.04 in the image; outside 2.
    const auto truth = [](int, int x, int) { return x < kWidth / 2 ? 0.0 : 2.0; };
    const auto image = [](int, int x, int) { return x < kWidth / 2 ? 0.04 : 3.0; };
    auto frames = makeFrames(kCount, kWidth, kHeight, image, truth);
    for (StabilityFrame& frame : frames)
        for (std::size_t i = 0; i < frame.surface.size(); ++i)
            frame.region.push_back(i % kWidth < kWidth / 2 ? 1 : 2);
    CHECK(stabilityIndices(frames).leak.value() == Approx(0.02));
    // Seen from inside in one half of the frames and from outside in the other.
    for (int t = 0; t < kCount; ++t)
        for (std::uint8_t& region : frames[std::size_t(t)].region)
            if (region == (t % 2 == 0 ? 1 : 2)) region = 0;
    const StabilityIndices indices = stabilityIndices(frames);
    CHECK(indices.leak.value() == Approx(0.02));
    CHECK_FALSE(indices.frames[0].leak.has_value());
    CHECK(indices.frames[1].leak.value() == Approx(0.02));
}

TEST_CASE("drift: the range of the bias, in steps of a quarter of the sequence") {
    // A percent more light with every frame: the medians of the first and the last 8 frames are 24
    // apart.
    const auto gaining = [](int t, int, int) { return 1.0 + 0.01 * t; };
    const StabilityIndices indices = indicesOf(gaining, even(1.0));
    CHECK(indices.drift.value() == Approx(0.24));
    CHECK(indices.frames[0].drift.value() == 0.0);
    CHECK(indices.frames[31].drift.value() == Approx(0.24));
    CHECK(indices.worstFrame == 28);  // the last 8 frames' median is the worst
    CHECK(indices.worstReason == StabilityReason::Drift);
    // Losing and coming back.
    const auto wandering = [](int t, int, int) { return 1.0 - 0.01 * (t < 16 ? t : 31 - t); };
    CHECK(indicesOf(wandering, even(1.0)).drift.value() == Approx(0.135 - 0.035).epsilon(0.1));
    // A picture that moves over surfaces of other errors: theirs stay what they are.
    const auto painted = [](int t, int x, int) { return 1.0 + 0.01 * (x - 2 * t); };
    CHECK(indicesOf(painted, even(1.0), 2.0f).drift.value() == Approx(0.0).margin(1e-4));
    // A flash, a cut, too few frames to tell from flicker.
    const auto flash = [](int t, int, int) { return t == 9 ? 2.0 : 1.0; };
    CHECK(indicesOf(flash, even(1.0)).drift.value() == Approx(0.0).margin(kExact));
    const auto otherPlace = [](int t, int, int) { return t < 16 ? 1.0 : 1.4; };
    auto frames = makeFrames(kCount, kWidth, kHeight, otherPlace, even(1.0));
    CHECK(stabilityIndices(frames).drift.value() == Approx(0.4));
    frames[16].isCut = true;
    CHECK(stabilityIndices(frames).drift.value() == Approx(0.0).margin(kExact));
    frames.resize(5);
    CHECK_FALSE(stabilityIndices(frames).drift.has_value());
}

TEST_CASE("spike: flashes of all of the picture and of parts") {
    const auto flash = [](int t, int, int) { return t == 9 ? 1.3 : 1.0; };
    const StabilityIndices indices = indicesOf(flash, even(1.0));
    CHECK(indices.spike.value() == Approx(0.3));
    CHECK(indices.frames[9].spike.value() == Approx(0.3));
    CHECK(indices.frames[8].spike.value() == Approx(0.0).margin(kExact));
    CHECK(indices.worstFrame == 9);
    CHECK(indices.worstReason == StabilityReason::Spike);
    // One tile, a quarter of one; a hole instead of a flash.
    const auto spot = [](int t, int x, int y) { return t == 9 && x / 2 == 5 && y / 2 == 3 ? 2.0 : 1.0; };
    CHECK(indicesOf(spot, even(1.0)).spike.value() == Approx(1.0));
    const auto pixel = [](int t, int x, int y) { return t == 9 && x == 5 && y == 3 ? 5.0 : 1.0; };
    CHECK(indicesOf(pixel, even(1.0)).spike.value() == Approx(1.0));
    const auto hole = [](int t, int x, int y) { return t == 9 && x / 2 == 5 && y / 2 == 3 ? 0.0 : 1.0; };
    CHECK(indicesOf(hole, even(1.0)).spike.value() == Approx(1.0));
}

TEST_CASE("spike: not what stays, what comes all the time, or what the truth does, too") {
    const auto stepUp = [](int t, int, int) { return t < 9 ? 1.0 : 1.5; };
    CHECK(indicesOf(stepUp, even(1.0)).spike.value() == Approx(0.0).margin(kExact));
    const auto alternating = [](int t, int, int) { return t % 2 == 0 ? 1.3 : 1.0; };
    CHECK(indicesOf(alternating, even(1.0)).spike.value() == Approx(0.0).margin(kExact));
    const auto truth = [](int t, int, int) { return t == 9 ? 3.0 : 1.0; };
    const auto image = [&](int t, int x, int y) { return 1.4 * truth(t, x, y); };
    CHECK(indicesOf(image, truth).spike.value() == Approx(0.0).margin(kExact));
}

TEST_CASE("black sequences have finite indices") {
    const auto dim = [](int t, int x, int y) { return 1e-20 * (2.0 + noiseNumber(t, x, y)); };
    CHECK(indicesOf(even(0.0), even(0.0)).flicker.value() == 0.0);
    checkFinite(indicesOf(even(0.0), even(0.0)));
    // Light where there is none in truth is judged by its own mean.
    const StabilityIndices wrong = indicesOf(dim, even(0.0));
    checkFinite(wrong);
    CHECK(wrong.error == Approx(1.0).epsilon(1e-3));
    CHECK(wrong.flicker.value() == Approx(1.0 / 3.0).epsilon(0.03));
    // A dark frame among others: relative to a tenth of the sequence's mean.
    const auto truth = [](int t, int, int) { return t == 31 ? 0.0 : 1.0; };
    const auto image = [](int t, int, int) { return t == 31 ? 0.01 : 1.0; };
    const StabilityIndices indices = indicesOf(image, truth);
    checkFinite(indices);
    CHECK(indices.frames[31].flicker.value() == Approx(0.01 / (0.1 * 31.0 / 32.0)));
}

TEST_CASE("sequences of few frames or without surfaces have what can be judged") {
    CHECK_FALSE(stabilityIndices({}).flicker.has_value());
    const auto one = stabilityIndices(makeFrames(1, 4, 4, even(1.5), even(1.0)));
    CHECK_FALSE(one.flicker.has_value());
    CHECK_FALSE(one.spike.has_value());
    CHECK(one.error == Approx(0.5));
    CHECK(one.worstReason == StabilityReason::Error);
    auto frames = makeFrames(kCount, kWidth, kHeight, even(1.0), even(1.0));
    for (StabilityFrame& frame : frames) {
        frame.surface.assign(frame.surface.size(), 0);
        frame.image.assign(frame.image.size(), std::numeric_limits<float>::quiet_NaN());  // never read
    }
    checkFinite(stabilityIndices(frames));
    CHECK_FALSE(stabilityIndices(frames).flicker.has_value());
    CHECK_FALSE(stabilityIndices(frames).drift.has_value());
}

TEST_CASE("frames that do not fit are named") {
    auto frames = makeFrames(3, 4, 4, even(1.0), even(1.0));
    frames[2].truth.pop_back();
    CHECK_THAT(failureOf(frames),
               Contains("frame 2") && Contains("truth") && Contains("expected 48 values, got 47"));
    frames = makeFrames(3, 4, 4, even(1.0), even(1.0));
    frames[1].image[5] = std::numeric_limits<float>::quiet_NaN();
    CHECK_THAT(failureOf(frames), Contains("frame 1") && Contains("image") && Contains("1 NaN"));
    frames[1].image[5] = 1.0f;
    frames[0].height = 0;
    CHECK_THAT(failureOf(frames), Contains("frame 0") && Contains("4x0"));
}
