// The temporal history where a picture stands still or moves by known steps: closed forms.
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
// A frame's share is one division, and one multiply-add that rounds at the size of the mean: over 64 frames 64 of them.
constexpr double kMeanTolerance = 64 * 6e-8;
// Four weights of a look-up, from coordinates that are rounded at 1e-4 pixels.
constexpr double kRampTolerance = 2e-5;

TemporalHistoryOptions plain(std::uint32_t frames) {
    TemporalHistoryOptions options;
    options.frames = frames;
    options.clamp = 0.0f;
    return options;
}

Vec noise(std::uint32_t x, std::uint32_t y, std::uint32_t frame) {
    const auto number = [&](std::uint32_t channel) { return 0.5 + 0.5 * stability_test::noiseNumber(int(x), int(y), int(frame * 4 + channel)); };
    return {number(0), number(1), number(2)};
}

double flat(std::uint32_t, std::uint32_t) { return kDepth; }

}  // namespace

TEST_CASE("a static view is the mean of its frames, and its variance falls as 1/n", "[temporal_history]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    const auto [w, h] = testSize({67, 33});
    constexpr std::uint32_t kFrames = 32;
    HistoryRig history(rig, plain(kFrames), w, h);
    Frame frame(w, h);
    frame.look(pixelCamera(w, h), flat);
    std::vector<double> sum(frame.light.planes.size());
    for (std::uint32_t f = 0; f < kFrames; ++f) {
        frame.shine([&](std::uint32_t x, std::uint32_t y) { return noise(x, y, f); });
        const Image out = history.render(frame);
        double square = 0.0;
        std::vector<float> mean;
        for (std::size_t i = 0; i < sum.size(); ++i) {
            sum[i] += double(frame.light.planes[i]);
            mean.push_back(float(sum[i] / (f + 1)));
            square += std::pow(double(out.planes[i]) - 0.5, 2);
        }
        REQUIRE(disagreement(out.planes, mean, kMeanTolerance) == "");
        // Of an even distribution over [0, 1], to four standard errors of so many samples' mean square.
        const double variance = 1.0 / 12.0 / (f + 1);
        if (sum.size() > 5000) CHECK(square / double(sum.size()) == Approx(variance).epsilon(4.0 * std::sqrt(2.0 / double(sum.size()))));
        CHECK(history.fresh() == (f == 0 ? int(w * h) : 0));
    }
    for (const float age : history.ages()) REQUIRE(age == float(kFrames));
    // From then on each frame has a share of 1/32.
    for (std::uint32_t f = kFrames; f < kFrames + 8; ++f) {
        frame.shine([&](std::uint32_t x, std::uint32_t y) { return noise(x, y, f); });
        const Image out = history.render(frame);
        std::vector<float> mean;
        for (std::size_t i = 0; i < sum.size(); ++i) {
            sum[i] += double(frame.light.planes[i]) - sum[i] / kFrames;
            mean.push_back(float(sum[i] / kFrames));
        }
        REQUIRE(disagreement(out.planes, mean, kMeanTolerance) == "");
    }
}

TEST_CASE("a picture that moves by whole pixels takes its history along", "[temporal_history][large]") {
    const auto width = GENERATE(1u, 16u);
    const auto orthographic = GENERATE(false, true);
    const auto byMotion = GENERATE(false, true);
    const auto step = GENERATE(std::make_pair(3, 0), std::make_pair(-1, 2), std::make_pair(0, -5), std::make_pair(17, 1));
    CAPTURE(width, orthographic, byMotion, step.first, step.second);
    KernelRig rig(width);
    const std::uint32_t w = 70, h = 19;
    HistoryRig history(rig, plain(8), w, h);
    Frame first(w, h), second(w, h);
    TestCamera camera = pixelCamera(w, h, orthographic);
    first.look(camera, flat);
    first.shine([](std::uint32_t x, std::uint32_t y) { return noise(x, y, 1); });
    camera.eye = camera.eye + camera.right * double(step.first) - camera.up * double(step.second);
    second.look(camera, flat);  // the picture moves by -step
    if (byMotion) second.move([&](std::uint32_t, std::uint32_t) { return Vec{double(step.first), double(step.second), 0}; });
    second.shine([](std::uint32_t x, std::uint32_t y) { return noise(x, y, 2); });
    history.render(first);
    const Image out = history.render(second);
    // The speed shortens the mean of 8 frames, not below two.
    int fresh = 0;
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x) {
            const int fromX = int(x) + step.first, fromY = int(y) + step.second;
            const bool known = fromX >= 0 && fromX < int(w) && fromY >= 0 && fromY < int(h);
            const double speed = std::max(std::abs(step.first), std::abs(step.second));
            const double n = std::min(1.0, 8.0 * 8.0 / (8.0 + speed) - 1.0);
            const Vec now = second.light.get(x, y);
            const Vec past = known ? first.light.get(std::uint32_t(fromX), std::uint32_t(fromY)) : now;
            REQUIRE(out.get(x, y).x == Approx(past.x + (now.x - past.x) / (n + 1)).margin(1e-6));
            REQUIRE(out.get(x, y).z == Approx(past.z + (now.z - past.z) / (n + 1)).margin(1e-6));
            fresh += !known;
        }
    CHECK(history.fresh() == fresh);
}

TEST_CASE("a linear ramp passes through moves by parts of a pixel as it is", "[temporal_history][large]") {
    const auto width = GENERATE(1u, 16u);
    const auto step = GENERATE(std::make_pair(0.25, 0.0), std::make_pair(-1.4, 0.6), std::make_pair(0.0, 3.5));
    CAPTURE(width, step.first, step.second);
    KernelRig rig(width);
    const std::uint32_t w = 53, h = 61;
    HistoryRig history(rig, plain(16), w, h);
    TestCamera camera = pixelCamera(w, h);
    for (int f = 0; f < 8; ++f) {
        Frame frame(w, h);
        frame.look(camera, flat);
        // Fixed to the world.
        frame.shine([&](std::uint32_t x, std::uint32_t y) {
            const Vec p = frame.position.get(x, y);
            return Vec{200.0 + p.x, 100.0 - p.y, 300.0 + p.x + 2.0 * p.y};
        });
        const Image out = history.render(frame);
        // Where a way has begun outside the picture, the taps inside lean inwards; every look-up takes that a pixel further.
        const auto inside = [f](std::uint32_t at, std::uint32_t size, double by) {
            const double start = double(at) + by * f;
            return start >= 1.0 + f && start <= double(size) - 2.0 - f;
        };
        double worst = 0.0;
        for (std::uint32_t y = 0; y < h; ++y)
            for (std::uint32_t x = 0; x < w; ++x) {
                if (!inside(x, w, step.first) || !inside(y, h, step.second)) continue;
                const Vec got = out.get(x, y), expected = frame.light.get(x, y);
                for (const double error : {got.x / expected.x, got.y / expected.y, got.z / expected.z})
                    worst = std::max(worst, std::abs(error - 1.0));
            }
        CHECK(worst < kRampTolerance);
        camera.eye = camera.eye + camera.right * step.first - camera.up * step.second;
    }
    CHECK(history.fresh() <= int(w * 4 + h * 2));
}

TEST_CASE("what comes out from behind something starts anew, nothing else", "[temporal_history]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    const std::uint32_t w = 60, h = 9;
    HistoryRig history(rig, plain(8), w, h);
    TestCamera camera = pixelCamera(w, h);
    // At half the depth a step to the right by one unit moves the picture twice as far: by 2 pixels to the left.
    const auto scene = [&](std::uint32_t from, std::uint32_t to) {
        return [from, to](std::uint32_t x, std::uint32_t) { return x >= from && x < to ? 0.5 * kDepth : kDepth; };
    };
    Frame first(w, h), second(w, h);
    first.look(camera, scene(20, 30));
    camera.eye = camera.eye + camera.right;
    second.look(camera, scene(18, 28));
    for (Frame* frame : {&first, &second})
        frame->shine([&](std::uint32_t x, std::uint32_t y) { return frame->position.get(x, y).z > -0.75 * kDepth ? Vec{1, 1, 1} : Vec{}; });
    history.render(first);
    const Image out = history.render(second);
    // Column 28 was column 29, behind; column 59 was outside.
    CHECK(history.fresh() == int(2 * h));
    const std::vector<float> ages = history.ages();
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x) REQUIRE(ages[y * w + x] == (x == 28 || x == 59 ? 1.0f : 2.0f));
    // Nothing of either surface's light on the other.
    CHECK(bitDifference(out.planes, second.light.planes) == "");
}

TEST_CASE("nothing crosses an edge of depth or normals while a picture moves", "[temporal_history][large]") {
    const auto width = GENERATE(1u, 16u);
    const auto byNormal = GENERATE(false, true);
    KernelRig rig(width);
    const std::uint32_t w = 45, h = 21;
    HistoryRig history(rig, plain(16), w, h);
    TestCamera camera = pixelCamera(w, h);
    for (int f = 0; f < 12; ++f) {
        Frame frame(w, h);
        const auto isNear = [&](std::uint32_t x, std::uint32_t y) { return (x / 9 + y / 7 + std::uint32_t(f) / 3) % 2 == 0; };
        frame.look(camera, [&](std::uint32_t x, std::uint32_t y) { return isNear(x, y) && !byNormal ? 0.9 * kDepth : kDepth; });
        if (byNormal)
            for (std::uint32_t y = 0; y < h; ++y)
                for (std::uint32_t x = 0; x < w; ++x)
                    if (isNear(x, y)) frame.normal.set(x, y, reference::unit({0.7, 0, 0.7}));
        frame.shine([&](std::uint32_t x, std::uint32_t y) { return isNear(x, y) ? Vec{1, 2, 3} : Vec{}; });
        const Image out = history.render(frame);
        CHECK(disagreement(out.planes, frame.light.planes, 1e-6) == "");
        camera.eye = camera.eye + camera.right * 0.3 + camera.up * 0.2;
    }
}

TEST_CASE("the same bits ten times and at every width", "[temporal_history][large]") {
    const std::uint32_t w = 75, h = 23;
    const auto run = [&](std::uint32_t width) {
        KernelRig rig(width);
        TemporalHistoryOptions options;
        options.frames = 16;
        HistoryRig history(rig, options, w, h);
        TestCamera camera = pixelCamera(w, h);
        Image out(w, h);
        for (std::uint32_t f = 0; f < 9; ++f) {
            Frame frame(w, h);
            frame.look(camera, [&](std::uint32_t x, std::uint32_t y) { return (x / 11 + y / 5) % 2 ? 900.0 : 1000.0; });
            frame.shine([&](std::uint32_t x, std::uint32_t y) { return noise(x, y, f); });
            out = history.render(frame);
            camera.eye = camera.eye + camera.right * 0.7 - camera.up * 0.4;
        }
        return out.planes;
    };
    const std::vector<float> expected = run(16);
    for (int i = 0; i < 9; ++i) REQUIRE(bitDifference(run(16), expected) == "");
    for (const std::uint32_t width : {1u, 4u, 8u}) CHECK(bitDifference(run(width), expected) == "");
}

TEST_CASE("the unit of length changes nothing", "[temporal_history][large]") {
    const std::uint32_t w = 75, h = 23;
    const auto run = [&](double scale, float clamp) {
        KernelRig rig(16);
        TemporalHistoryOptions options = plain(16);
        options.clamp = clamp;
        HistoryRig history(rig, options, w, h);
        TestCamera camera = pixelCamera(w, h);
        Image out(w, h);
        for (std::uint32_t f = 0; f < 9; ++f) {
            Frame frame(w, h);
            frame.look(camera, [&](std::uint32_t x, std::uint32_t y) { return ((x / 11 + y / 5) % 2 ? 900.0 : 1000.0) * scale; });
            frame.shine([&](std::uint32_t x, std::uint32_t y) { return noise(x, y, f); });
            out = history.render(frame);
            camera.eye = camera.eye + camera.right * (0.7 * scale) - camera.up * (0.4 * scale);
        }
        return out.planes;
    };
    // By a power of two, which rounds alike: to the bit.
    CHECK(bitDifference(run(8.0, 3.0f), run(1.0, 3.0f)) == "");
    // By ten places are rounded otherwise, by 1e-4 pixels a frame between neighbours that differ by up to 1. (Bounds would make
    // more of it: noise is learnt in steps, and one taken otherwise is a sixteenth.)
    CHECK(disagreement(run(10.0, 0.0f), run(1.0, 0.0f), 9 * 1e-4) == "");
}
