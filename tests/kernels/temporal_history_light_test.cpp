// The temporal history where light, objects and pictures' sizes change, and where inputs are no numbers.
#include "passes/temporal_history.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/history_rig.h"
#include "support/noise_number.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Image;
using reference::Vec;

namespace {

constexpr double kDepth = 1000.0;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

double flat(std::uint32_t, std::uint32_t) { return kDepth; }

TemporalHistoryOptions frames(std::uint32_t count, float clamp = TemporalHistoryOptions{}.clamp) {
    TemporalHistoryOptions options;
    options.frames = count;
    options.clamp = clamp;
    return options;
}

// Evenly spread in [-1, 1], one for each pixel and frame; or one that all pixels of a frame share.
double ofPixel(std::uint32_t x, std::uint32_t y, std::uint32_t frame) { return stability_test::noiseNumber(int(x), int(y), int(frame)); }
double ofFrame(std::uint32_t frame) { return stability_test::noiseNumber(1, 2, int(frame)); }

// Light of relative noise `spread` about `mean`, which pixels share or not.
void shine(Frame& frame, double mean, double spread, bool shared, std::uint32_t number) {
    frame.shine([&](std::uint32_t x, std::uint32_t y) {
        const double e = mean * (1.0 + spread * (shared ? ofFrame(number) : ofPixel(x, y, number)));
        return Vec{e, 0.5 * e, 2.0 * e};
    });
}

double meanOf(const Image& image) {
    double sum = 0.0;
    const std::size_t n = std::size_t(image.width) * image.height;
    for (std::size_t i = 0; i < n; ++i) sum += double(image.planes[i]);
    return sum / double(n);
}

double deviationOf(const Image& image, double mean) {
    double sum = 0.0;
    const std::size_t n = std::size_t(image.width) * image.height;
    for (std::size_t i = 0; i < n; ++i) sum += std::pow(double(image.planes[i]) - mean, 2);
    return std::sqrt(sum / double(n));
}

}  // namespace

TEST_CASE("light that halves leaves less than 5 % of the change behind after 8 frames", "[temporal_history][large]") {
    const auto width = GENERATE(1u, 16u);
    const auto shared = GENERATE(false, true);
    const auto spread = GENERATE(0.0, 0.1);
    const auto after = GENERATE(0.5, 2.0, 0.0);
    CAPTURE(width, shared, spread, after);
    KernelRig rig(width);
    HistoryRig history(rig, frames(32), 35, 7);
    Frame frame(35, 7);
    frame.look(pixelCamera(35, 7), flat);
    std::uint32_t number = 0;
    for (; number < 48; ++number) {
        shine(frame, 1.0, spread, shared, number);
        history.render(frame);
    }
    double mean = 0.0;
    for (int f = 0; f < 9; ++f, ++number) {
        shine(frame, after, spread, shared, number);
        mean = meanOf(history.render(frame));
    }
    // Of noise that all pixels share the mean over the picture keeps what a mean over the 9 frames does.
    const double noise = shared ? 4.0 * spread * after / std::sqrt(3.0 * 9.0) : 0.0;
    CHECK(std::abs(mean - after) < 0.05 * std::abs(1.0 - after) + noise);
}

TEST_CASE("light that goes up and down all the time is followed within its noise", "[temporal_history][large]") {
    const auto width = GENERATE(1u, 16u);
    const auto shared = GENERATE(false, true);
    const auto period = GENERATE(40.0, 80.0);
    CAPTURE(width, shared, period);
    KernelRig rig(width);
    HistoryRig history(rig, frames(32), 35, 7);
    Frame frame(35, 7);
    frame.look(pixelCamera(35, 7), flat);
    double square = 0.0;
    for (std::uint32_t f = 0; f < 120; ++f) {
        const double truth = 1.0 + 0.8 * std::sin(6.283185307 * f / period);
        shine(frame, truth, 0.1, shared, f);
        const double error = meanOf(history.render(frame)) - truth;
        if (f >= 40) square += error * error / 80.0;
    }
    // An exponential mean of share 1/32 would miss nearly all of it, 0.8 / sqrt(2) in the root of the mean square. One of
    // share 1/2, the shortest that a known surface falls back to, misses |1 - e^-iw| / |2 - e^-iw| of it: 16 % at a period of 40
    // frames, 8 % at 80. Noise that all pixels share leaves 6 % in such a mean.
    CHECK(std::sqrt(square) < (period < 60.0 ? 0.2 : 0.15) * 0.8 / std::sqrt(2.0));
}

TEST_CASE("noise falls though history is held to its frame's light", "[temporal_history][large]") {
    const auto width = GENERATE(1u, 16u);
    const auto shared = GENERATE(false, true);
    CAPTURE(width, shared);
    KernelRig rig(width);
    constexpr std::uint32_t kFrames = 32;
    HistoryRig history(rig, frames(kFrames), 67, 33);
    Frame frame(67, 33);
    frame.look(pixelCamera(67, 33), flat);
    double square = 0.0;
    for (std::uint32_t f = 0; f < 256; ++f) {
        shine(frame, 1.0, 0.5, shared, f);
        const Image out = history.render(frame);
        if (f >= 2 * kFrames) square += std::pow(deviationOf(out, 1.0), 2) / double(256 - 2 * kFrames);
    }
    // An exponential mean of share 1/32 keeps 1/63 of the variance, and bounds about the last three frames cut off some of it.
    const double unclamped = 0.25 / 3.0 / (2 * kFrames - 1);
    CHECK(square < 1.5 * unclamped);
}

TEST_CASE("500 frames: no drift", "[temporal_history][large]") {
    KernelRig rig(16);
    HistoryRig still(rig, frames(64), 35, 7), free(rig, frames(64, 0.0f), 35, 7), bound(rig, frames(64), 35, 7);
    Frame frame(35, 7);
    frame.look(pixelCamera(35, 7), flat);
    Frame constant = frame;
    constant.shine([](std::uint32_t x, std::uint32_t y) { return Vec{0.3 + 0.017 * x, 1e-6 + 0.1 * y, 3e4 / (1.0 + x)}; });
    double early[2] = {}, late[2] = {};
    for (std::uint32_t f = 0; f < 500; ++f) {
        // The same light: to the bit.
        REQUIRE(bitDifference(still.render(constant).planes, constant.light.planes) == "");
        // Samples that come again after 16 frames: the mean stays theirs.
        shine(frame, 1.0, 0.3, false, f % 16);
        HistoryRig* rigs[2] = {&free, &bound};
        for (int i = 0; i < 2; ++i) {
            const double mean = meanOf(rigs[i]->render(frame));
            if (f >= 240 && f < 368) early[i] += mean / 128;
            if (f >= 368 && f < 496) late[i] += mean / 128;
        }
    }
    // What is left of the start after 240 frames of share 1/64, 2 %, of its distance to the mean, and rounding.
    CHECK(late[0] == Approx(early[0]).epsilon(2e-5));
    // Bounds go round in cycles that are longer than the light's.
    CHECK(late[1] == Approx(early[1]).epsilon(1e-4));
}

TEST_CASE("a cut keeps nothing", "[temporal_history]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    HistoryRig history(rig, frames(16), 35, 7);
    Frame frame(35, 7);
    frame.look(pixelCamera(35, 7), flat);
    shine(frame, 1.0, 0.3, false, 1);
    for (int f = 0; f < 6; ++f) history.render(frame);
    shine(frame, 5.0, 0.3, false, 2);
    CHECK(bitDifference(history.render(frame, true).planes, frame.light.planes) == "");
    CHECK(history.fresh() == 35 * 7);
}

TEST_CASE("another size takes its history from the picture of the old one", "[temporal_history][large]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    HistoryRig history(rig, frames(16, 0.0f), 96, 48);
    for (const auto& [w, h] : {std::make_pair(96u, 48u), std::make_pair(48u, 24u), std::make_pair(33u, 17u), std::make_pair(96u, 48u)}) {
        CAPTURE(w, h);
        Frame frame(w, h);
        frame.look(pixelCamera(96, 48), flat);  // the same window, in more or fewer pixels
        frame.shine([&](std::uint32_t x, std::uint32_t y) {
            const Vec p = frame.position.get(x, y);
            return Vec{200.0 + p.x, 100.0 - p.y, 300.0 + p.x + 2.0 * p.y};
        });
        const Image out = history.render(frame);
        // A ramp over the world: as it is, but for pixels at the border that lie between the middles of the old ones.
        for (std::uint32_t y = 4; y + 4 < h; ++y)
            for (std::uint32_t x = 4; x + 4 < w; ++x) {
                REQUIRE(out.get(x, y).x == Approx(frame.light.get(x, y).x).epsilon(2e-5));
                REQUIRE(out.get(x, y).z == Approx(frame.light.get(x, y).z).epsilon(2e-5));
            }
        for (const float e : out.planes) REQUIRE((e > 40.0f && e < 420.0f));
    }
    CHECK(history.fresh() == 0);
}

TEST_CASE("a moving object keeps its history by motion vectors, and starts anew without", "[temporal_history]") {
    const auto width = GENERATE(1u, 16u);
    const auto byMotion = GENERATE(false, true);
    CAPTURE(width, byMotion);
    KernelRig rig(width);
    const std::uint32_t w = 60, h = 9, size = 10;
    HistoryRig history(rig, frames(16, 0.0f), w, h);
    const TestCamera camera = pixelCamera(w, h);
    // A face turned by 45 degrees, so that it leaves its own plane as it slides: 3 pixels a frame to the right.
    int fresh = 0;
    std::vector<float> ages;
    for (std::uint32_t f = 0; f < 6; ++f) {
        const std::uint32_t from = 8 + 3 * f;
        const auto on = [&](std::uint32_t x) { return x >= from && x < from + size; };
        Frame frame(w, h);
        frame.look(camera, [&](std::uint32_t x, std::uint32_t) { return on(x) ? 500.0 + 0.5 * (double(x) - from) : kDepth; });
        for (std::uint32_t y = 0; y < h; ++y)
            for (std::uint32_t x = from; x < from + size; ++x) frame.normal.set(x, y, reference::unit({-1, 0, 1}));
        if (byMotion) frame.move([&](std::uint32_t x, std::uint32_t) { return Vec{on(x) ? -3.0 : 0.0, 0, 0}; });
        frame.shine([&](std::uint32_t x, std::uint32_t) { return on(x) ? Vec{1, 1, 1} : Vec{0.25, 0.25, 0.25}; });
        const Image out = history.render(frame);
        CHECK(disagreement(out.planes, frame.light.planes, 1e-6) == "");  // neither trails light
        fresh = history.fresh();
        ages = history.ages();
    }
    const std::uint32_t from = 8 + 3 * 5;
    CHECK(ages[4 * w + from + 5] == (byMotion ? 6.0f : 1.0f));
    CHECK(ages[4 * w + from - 2] == 1.0f);  // just uncovered
    CHECK(ages[4 * w + from - 5] == 2.0f);  // a frame earlier
    CHECK(fresh == int(h * (byMotion ? 3 : 3 + size)));
}

TEST_CASE("what is no number goes no further", "[temporal_history]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    const std::uint32_t w = 35, h = 7;
    HistoryRig history(rig, frames(16), w, h);
    TestCamera camera = pixelCamera(w, h);
    for (std::uint32_t f = 0; f < 12; ++f) {
        Frame frame(w, h);
        frame.look(camera, flat);
        shine(frame, 1.0, 0.3, false, f);
        frame.move([&](std::uint32_t x, std::uint32_t y) {
            const double bad[] = {0.4, std::numeric_limits<double>::quiet_NaN(), 1e30, -std::numeric_limits<double>::infinity()};
            return Vec{bad[f < 6 ? (x + y) % 4 : 0], 0, 0};
        });
        for (std::uint32_t x = 3; x < 9 && f % 3 == 1; ++x) frame.light.set(x, 2, {kNaN, 1, std::numeric_limits<float>::infinity()});
        if (f % 4 == 2) frame.position.set(20, 3, {kNaN, 0, 0});
        frame.normal.set(11, 4, {0, 0, 0});  // background
        const Image out = history.render(frame);
        for (const float e : out.planes) REQUIRE((e >= 0.0f && e < 3.0f));
        REQUIRE(out.get(11, 4).x == 0.0);
        camera.eye = camera.eye + camera.right * 0.4;
    }
}

TEST_CASE("two eyes side by side in one image do not disturb each other", "[temporal_history]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    const std::uint32_t w = 48, h = 9;  // rows of 48 + 48: both eyes' begin at a multiple of 16
    HistoryRig left(rig, frames(8), w, h), right(rig, frames(8), w, h), alone(rig, frames(8), w, h), other(rig, frames(8), w, h);
    const Guarded both = rig.makePlanes(2 * w, h, 3);
    TestCamera cameras[2] = {pixelCamera(w, h), pixelCamera(w, h)};
    cameras[1].eye = cameras[1].right * 4.0;
    for (std::uint32_t f = 0; f < 5; ++f) {
        Image expected[2] = {Image(w, h), Image(w, h)};
        for (int eye = 0; eye < 2; ++eye) {
            Frame frame(w, h);
            frame.look(cameras[eye], [&](std::uint32_t x, std::uint32_t) { return x < 20 ? 800.0 : kDepth; });
            shine(frame, eye ? 9.0 : 1.0, 0.3, false, f);
            expected[eye] = (eye ? other : alone).render(frame);
            Planes half = rig.planes(both, 2 * w, h, 3);
            half.offset = eye ? w : 0;
            half.width = w;
            (eye ? right : left).render(frame, false, &half);
            cameras[eye].eye = cameras[eye].eye + cameras[eye].right * 0.3;
        }
        for (std::uint32_t eye = 0; eye < 2; ++eye) {
            Planes half = rig.planes(both, 2 * w, h, 3);
            half.offset = eye ? w : 0;
            half.width = w;
            CHECK(bitDifference(rig.downloadPlanes(half), expected[eye].planes) == "");
        }
    }
}
