// The temporal history and what hosts do with frames and cameras: pictures drawn twice or left out, cuts without a word, cameras
// of every convention and far away, light that is no number.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "passes/temporal_history.h"
#include "support/history_rig.h"
#include "support/noise_number.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Image;
using reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 45, kHeight = 9;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

double number(std::uint32_t x, std::uint32_t y, std::uint32_t frame) { return 0.5 + 0.5 * stability_test::noiseNumber(int(x), int(y), int(frame)); }

Frame frameOf(const TestCamera& camera, std::uint32_t f, double depth = 1000.0) {
    Frame frame(kWidth, kHeight);
    frame.look(camera, [depth](std::uint32_t, std::uint32_t) { return depth; });
    frame.shine([f](std::uint32_t x, std::uint32_t y) { return Vec{number(x, y, f), number(x, y, 1000 + f), 1.0}; });
    return frame;
}

TemporalHistoryOptions frames(std::uint32_t count, float clamp = 0.0f) {
    TemporalHistoryOptions options;
    options.frames = count;
    options.clamp = clamp;
    return options;
}

}  // namespace

TEST_CASE("a picture drawn twice in an update counts once", "[temporal_history][large]") {
    KernelRig rig(16);
    const auto byMotion = GENERATE(false, true);
    HistoryRig once(rig, frames(16, 3.0f), kWidth, kHeight), twice(rig, frames(16, 3.0f), kWidth, kHeight);
    TestCamera camera = pixelCamera(kWidth, kHeight);
    for (std::uint32_t f = 0; f < 8; ++f) {
        CAPTURE(byMotion, f);
        Frame frame = frameOf(camera, f);
        if (byMotion) frame.move([](std::uint32_t, std::uint32_t) { return Vec{1.3, 0, 0}; });
        const Image expected = once.render(frame);
        // First with other light, as an lwRender that fails late may leave it.
        Frame other = frame;
        other.shine([](std::uint32_t, std::uint32_t) { return Vec{9, 9, 9}; });
        twice.render(other);
        CHECK(bitDifference(twice.renderOnly(frame).planes, expected.planes) == "");
        CHECK(twice.fresh() == once.fresh());
        REQUIRE(twice.ages() == once.ages());
        camera.eye = camera.eye + camera.right * 1.3;
    }
}

TEST_CASE("motion vectors lead one frame back, and are not followed across another way", "[temporal_history]") {
    KernelRig rig(16);
    // Left out: frames without a picture between two pictures; -1: the second is of the first's update, from another place.
    const auto leftOut = GENERATE(-1, 0, 1, 5);
    CAPTURE(leftOut);
    HistoryRig history(rig, frames(4), kWidth, kHeight);
    TestCamera camera = pixelCamera(kWidth, kHeight);
    const Frame first = frameOf(camera, 1);
    history.render(first);
    camera.eye = camera.eye + camera.right * 6.0;
    Frame second = frameOf(camera, 2);
    // Of the last frame, whatever the pictures' way: 6 pixels only where these are neighbours.
    const double last = leftOut < 0 ? 2.0 : 6.0 / (leftOut + 1);
    second.move([last](std::uint32_t, std::uint32_t) { return Vec{last, 0, 0}; });
    for (int i = 0; i < leftOut; ++i) history.view().startFrame(false);
    const Image out = leftOut < 0 ? history.renderOnly(second) : history.render(second);
    const double n = std::min(1.0, 4.0 * 8.0 / (8.0 + 6.0) - 1.0);
    for (std::uint32_t x = 0; x + 6 < kWidth; ++x) {
        const double past = first.light.get(x + 6, 4).x, now = second.light.get(x, 4).x;
        REQUIRE(out.get(x, 4).x == Approx(past + (now - past) / (n + 1)).margin(1e-6));
    }
    CHECK(history.fresh() == int(6 * kHeight));
}

TEST_CASE("a cut that nobody tells of keeps nothing of other surfaces", "[temporal_history]") {
    KernelRig rig(16);
    HistoryRig history(rig, frames(16), kWidth, kHeight);
    TestCamera camera = pixelCamera(kWidth, kHeight);
    for (std::uint32_t f = 0; f < 4; ++f) history.render(frameOf(camera, f));
    SECTION("elsewhere") { camera.eye = camera.eye + camera.right * 400.0; }
    SECTION("turned round") {
        camera.forward = -camera.forward;
        camera.right = -camera.right;
    }
    SECTION("to the same wall, from behind it") {
        camera.eye = camera.eye + camera.forward * 2000.0;
        camera.forward = -camera.forward;
        camera.right = -camera.right;
    }
    const Frame after = frameOf(camera, 9);
    CHECK(bitDifference(history.render(after).planes, after.light.planes) == "");
    CHECK(history.fresh() == int(kWidth * kHeight));
}

TEST_CASE("one view alternating between two places takes no light from one to the other", "[temporal_history][large]") {
    KernelRig rig(16);
    HistoryRig history(rig, frames(16), kWidth, kHeight);
    TestCamera cameras[2] = {pixelCamera(kWidth, kHeight), pixelCamera(kWidth, kHeight)};
    cameras[1].eye = cameras[1].right * 3.0;
    for (std::uint32_t f = 0; f < 8; ++f) {
        const Frame frame = frameOf(cameras[f % 2], f, f % 2 ? 700.0 : 1000.0);
        CHECK(bitDifference(history.render(frame).planes, frame.light.planes) == "");
    }
}

TEST_CASE("cameras of every convention lead to the same places", "[temporal_history][large]") {
    KernelRig rig(16);
    const auto run = [&](void (*turn)(TestCamera&)) {
        HistoryRig history(rig, frames(16), kWidth, kHeight);
        TestCamera camera = pixelCamera(kWidth, kHeight);
        turn(camera);
        std::vector<float> out;
        for (std::uint32_t f = 0; f < 5; ++f) {
            Frame frame = frameOf(camera, f);
            if (f == 4) frame.move([](std::uint32_t, std::uint32_t) { return Vec{1.7, -0.6, 0}; });
            out = history.render(frame).planes;
            camera.eye = camera.eye + camera.right * 1.7 + camera.up * 0.6;
        }
        return out;
    };
    const std::vector<float> expected = run([](TestCamera&) {});
    // Bilinear weights from coordinates that are rounded at 1e-5 pixels.
    constexpr double kTolerance = 5e-5;
    CHECK(disagreement(run([](TestCamera& c) { c.leftHanded = true; }), expected, kTolerance) == "");
    CHECK(disagreement(run([](TestCamera& c) { c.reversed = true; }), expected, kTolerance) == "");
    CHECK(disagreement(run([](TestCamera& c) { c.reversed = c.infinite = true; }), expected, kTolerance) == "");
    CHECK(disagreement(run([](TestCamera& c) { c.openGL = true; }), expected, kTolerance) == "");
    CHECK(disagreement(run([](TestCamera& c) { c.near = 999.0; c.far = 1001.0; }), expected, kTolerance) == "");  // clipped close
    // At one depth an orthographic camera sees the same, moved to where its window is as wide.
    CHECK(disagreement(run([](TestCamera& c) { c = pixelCamera(kWidth, kHeight, true); }), expected, kTolerance) == "");
}

TEST_CASE("an eye that no float stands for leads to the right places", "[temporal_history][large]") {
    KernelRig rig(16);
    const std::uint32_t w = 64, h = 8;
    HistoryRig history(rig, frames(8), w, h);
    // Pixels of 1/1024 at depth 1, at 1000 from the world's origin, where floats lie 1/16384 apart.
    TestCamera camera = pixelCamera(w, h);
    camera.left = -32.0 / 1024, camera.rightEdge = 32.0 / 1024, camera.bottom = -4.0 / 1024, camera.top = 4.0 / 1024;
    camera.near = 0.125, camera.far = 16;
    camera.eye = {1000, 0, 0};
    Image lights[2] = {Image(w, h), Image(w, h)};
    Image out(w, h);
    for (std::uint32_t f = 0; f < 2; ++f) {
        Frame frame(w, h);
        frame.look(camera, [](std::uint32_t, std::uint32_t) { return 1.0; });
        frame.shine([f](std::uint32_t x, std::uint32_t y) { return Vec{number(x, y, f), 1, 1}; });
        // The eye half of such a step to the right, a thirty-second of a pixel, and the window back by as much: x - d (w + z).
        float* row = frame.camera.projection;
        const float by = row[0] / 32768.0f;
        row[2] -= by;
        row[3] -= by;
        lights[f] = frame.light;
        out = history.render(frame);
        camera.eye = camera.eye + camera.right * (3.0 / 1024);
    }
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x + 3 < w; ++x)
            REQUIRE(out.get(x, y).x == Approx(0.5 * (lights[0].get(x + 3, y).x + lights[1].get(x, y).x)).margin(1e-5));
    CHECK(history.fresh() == int(3 * h));
}

TEST_CASE("a frame that is no number is left out of the mean", "[temporal_history]") {
    KernelRig rig(GENERATE(1u, 16u));
    HistoryRig history(rig, frames(16), kWidth, kHeight);
    const TestCamera camera = pixelCamera(kWidth, kHeight);
    std::vector<double> sum(3 * kWidth * kHeight);
    Image out(kWidth, kHeight);
    for (std::uint32_t f = 0; f < 7; ++f) {
        Frame frame = frameOf(camera, f);
        if (f == 2 || f == 4)
            for (float& e : frame.light.planes) e = f == 2 ? kNaN : 3e38f;  // sums of the latter would overflow
        else
            for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += double(frame.light.planes[i]) / 5.0;
        out = history.render(frame);
    }
    CHECK(disagreement(out.planes, std::vector<float>(sum.begin(), sum.end()), 1e-6) == "");
    for (const float age : history.ages()) REQUIRE(age == 5.0f);
}

TEST_CASE("light of any size, dark frames between, leaves numbers", "[temporal_history][large]") {
    KernelRig rig(GENERATE(1u, 16u));
    HistoryRig history(rig, frames(64, 3.0f), kWidth, kHeight);
    const TestCamera camera = pixelCamera(kWidth, kHeight);
    const double sizes[] = {0.0, 1e-38, 1e-20, 1e-3, 1.0, 40.0, 1e4, 1e15, 9e29, 3e38};
    for (std::uint32_t f = 0; f < 300; ++f) {
        Frame frame = frameOf(camera, f);
        frame.shine([&](std::uint32_t x, std::uint32_t y) {
            // A size for 20 frames or so, noise within it as large as it, and one frame in five dark.
            const double size = sizes[std::size_t(number(x, y, 5000 + (f + 3 * x) / 20) * 9.999)];
            const double noise = std::pow(number(x, y, f), 3.0) * (number(x, y, 9000 + f) < 0.2 ? 0.0 : 1.0);
            return Vec{size * noise, size * noise * 0.5, 0.0};
        });
        for (const float e : history.render(frame).planes) REQUIRE((e >= 0.0f && e <= 1e30f));
    }
}

TEST_CASE("rare bright frames keep their mean", "[temporal_history][large]") {
    KernelRig rig(16);
    HistoryRig history(rig, frames(32, 3.0f), kWidth, kHeight);
    const TestCamera camera = pixelCamera(kWidth, kHeight);
    double sum = 0.0, square = 0.0, own = 0.0, ownSquare = 0.0, count = 0.0;
    for (std::uint32_t f = 0; f < 256; ++f) {
        Frame frame = frameOf(camera, f);
        frame.shine([&](std::uint32_t x, std::uint32_t y) {
            const double e = number(x, y, f) < 0.125 ? 3.1 : 0.7;
            return Vec{e, 0.5 * e, e};
        });
        const Image out = history.render(frame);
        for (std::uint32_t i = 0; i < kWidth * kHeight && f >= 64; ++i) {
            const double got = double(out.planes[i]), given = double(frame.light.planes[i]);
            sum += got, square += got * got, own += given, ownSquare += given * given, count += 1.0;
        }
    }
    // The mean of 78,000 frames of deviation 0.8, some 30 of which go into a picture.
    CHECK(sum / own == Approx(1.0).margin(0.02));
    CHECK(square - sum * sum / count < 0.75 * (ownSquare - own * own / count));
}

TEST_CASE("a history goes on where the origin of positions moves, with the camera at rest and in motion", "[temporal_history]") {
    KernelRig rig(GENERATE(1u, 16u));
    const double step = GENERATE(0.0, 1.3);
    const auto byMotion = GENERATE(false, true);
    HistoryRig stays(rig, frames(16), kWidth, kHeight), moves(rig, frames(16), kWidth, kHeight);
    const WorldOrigin place{1e6 + 0.3, -70.0, 2e5};
    TestCamera camera = pixelCamera(kWidth, kHeight);
    for (std::uint32_t f = 0; f < 5; ++f) {
        CAPTURE(step, byMotion, f);
        const WorldOrigin origin{place[0] + 12.37 * f, place[1] - 4.7 * f, place[2] + (f > 2 ? 1000.0 : 0.0)};
        TestCamera elsewhere = camera;
        for (int a = 0; a < 3; ++a) elsewhere.eye[a] += place[std::size_t(a)] - origin[std::size_t(a)];
        Frame expected = frameOf(camera, f), moved = frameOf(elsewhere, f);
        for (Frame* frame : {&expected, &moved})
            if (byMotion) frame->move([=](std::uint32_t, std::uint32_t) { return Vec{step, 0, 0}; });
        rig.executor().setWorldOrigin(place);
        const Image still = stays.render(expected);
        rig.executor().setWorldOrigin(origin);
        const Image shown = moves.render(moved);
        CHECK(moves.fresh() == stays.fresh());
        // A place between pixels, by 1e-4 of one, of light between 0 and 1.
        for (std::size_t i = 0; i < shown.planes.size(); ++i) REQUIRE(double(shown.planes[i]) == Approx(double(still.planes[i])).margin(3e-4));
        camera.eye = camera.eye + camera.right * step;
    }
}
