// The cross-fade where pictures stand still or move by known steps: closed forms.
#include "passes/cross_fade.h"

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
// A step rounds once, at the size of what it shows.
constexpr double kStepTolerance = 2e-7;

double flat(std::uint32_t, std::uint32_t) { return kDepth; }

Vec noise(std::uint32_t x, std::uint32_t y) {
    const auto number = [&](int channel) { return 0.6 + 0.5 * stability_test::noiseNumber(int(x), int(y), channel); };
    return {number(0), number(1), number(2)};
}

// Irradiance and validity as an image each; validity is the first channel of a quarter of the light.
struct Shown {
    std::vector<float> irradiance, validity;
};

class FadeRig {
public:
    FadeRig(KernelRig& rig, std::uint32_t maxWidth, std::uint32_t maxHeight) : rig_(rig), fade_(rig.device()), view_(rig.device(), maxWidth, maxHeight) {}

    Shown render(const Frame& frame, float share, bool forget = false) {
        view_.startFrame(forget);
        return renderOnly(frame, share);
    }
    Shown renderOnly(const Frame& frame, float share, bool hasValidity = true) {
        constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
        const std::uint32_t w = frame.width(), h = frame.height();
        std::vector<float> quarter(frame.light.planes.begin(), frame.light.planes.begin() + std::ptrdiff_t(std::size_t(w) * h));
        for (float& v : quarter) v *= 0.25f;
        const Guarded p = rig_.uploadPlanes(frame.position.planes, w, h, 3, kNaN), n = rig_.uploadPlanes(frame.normal.planes, w, h, 3, 1.0f);
        const Guarded e = rig_.uploadPlanes(frame.light.planes, w, h, 3, kNaN), v = rig_.uploadPlanes(quarter, w, h, 1, kNaN);
        const Guarded m = rig_.uploadPlanes(frame.motion ? frame.motion->planes : frame.light.planes, w, h, 3, kNaN);
        const Guarded outE = rig_.makePlanes(w, h, 3), outV = rig_.makePlanes(w, h, 1);
        FadeFrame images;
        images.position = rig_.planes(p, w, h, 3);
        images.normal = rig_.planes(n, w, h, 3);
        if (frame.motion) images.motion = rig_.planes(m, w, h, 3);
        images.irradiance = rig_.planes(e, w, h, 3);
        images.shownIrradiance = rig_.planes(outE, w, h, 3);
        if (hasValidity) {
            images.validity = rig_.planes(v, w, h, 1);
            images.shownValidity = rig_.planes(outV, w, h, 1);
        }
        fade_.record(rig_.executor(), images, frame.camera, share, view_);
        rig_.device().finish();
        Shown shown;
        shown.irradiance = rig_.downloadPlanes(images.shownIrradiance);
        if (hasValidity) shown.validity = rig_.downloadPlanes(images.shownValidity);
        return shown;
    }
    int fresh() {
        Report report;
        view_.report(rig_.device(), report);
        rig_.device().finish();
        report.resolve();
        return report.counts.empty() ? -1 : int(report.counts.front().value);
    }
    FadedView& view() { return view_; }

private:
    KernelRig& rig_;
    CrossFade fade_;
    FadedView view_;
};

Frame still(std::uint32_t w, std::uint32_t h) {
    Frame frame(w, h);
    frame.look(pixelCamera(w, h), flat);
    return frame;
}

void shine(Frame& frame, double value) {
    frame.shine([=](std::uint32_t, std::uint32_t) { return Vec{value, 2 * value, 0.5 * value}; });
}

}  // namespace

TEST_CASE("two that agree: nothing changes, to the bit", "[cross_fade]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    const auto [w, h] = testSize({67, 33});
    FadeRig fade(rig, w, h);
    Frame frame = still(w, h);
    frame.shine(noise);
    const Shown first = fade.render(frame, 1.0f);
    CHECK(first.irradiance == frame.light.planes);
    for (int k = 7; k >= 1; --k) {
        const Shown shown = fade.render(frame, 1.0f / float(k));
        CHECK(shown.irradiance == first.irradiance);
        CHECK(shown.validity == first.validity);
        if (k > 1) CHECK(fade.fresh() == 0);
    }
}

TEST_CASE("two constants: an even ramp over exactly as many frames as were asked for", "[cross_fade]") {
    const auto width = GENERATE(1u, 16u);
    const auto frames = GENERATE(1, 5, 12);
    KernelRig rig(width);
    const auto [w, h] = testSize({37, 9});
    FadeRig fade(rig, w, h);
    Frame frame = still(w, h);
    shine(frame, 1.0);
    fade.render(frame, 1.0f);
    shine(frame, 3.0);
    float before = 1.0f;
    for (int k = frames; k >= 1; --k) {
        const Shown shown = fade.render(frame, 1.0f / float(k));
        const double expected = 1.0 + 2.0 * double(frames - k + 1) / frames;
        std::vector<float> want(shown.irradiance.size());
        const std::size_t plane = want.size() / 3;
        for (std::size_t i = 0; i < want.size(); ++i) want[i] = float(expected * (i < plane ? 1.0 : i < 2 * plane ? 2.0 : 0.5));
        CHECK(disagreement(shown.irradiance, want, frames * kStepTolerance) == "");
        CHECK(double(shown.validity[0]) == Approx(0.25 * expected).epsilon(1e-6));
        CHECK(shown.irradiance[0] - before <= 2.0f / float(frames) * (1.0f + 1e-6f));
        before = shown.irradiance[0];
    }
    CHECK(before == 3.0f);  // the last step is the new light to the bit
}

TEST_CASE("a pan takes what was shown with it, and what comes into view has the new light at once", "[cross_fade]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    const auto [w, h] = testSize({64, 16});
    FadeRig fade(rig, w, h);
    Frame frame = still(w, h);
    frame.shine(noise);
    fade.render(frame, 1.0f);
    // Three pixels to the right.
    Frame moved(w, h);
    TestCamera camera = pixelCamera(w, h);
    camera.eye.x += 3.0;
    moved.look(camera, flat);
    shine(moved, 2.0);
    const Shown shown = fade.render(moved, 0.25f);
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x) {
            const double old = x + 3 < w ? noise(x + 3, y).x : 2.0;
            REQUIRE(double(shown.irradiance[std::size_t(y) * w + x]) == Approx(old + 0.25 * (2.0 - old)).epsilon(1e-4));
        }
    CHECK(fade.fresh() == int(3 * h));
}

TEST_CASE("what stood elsewhere, or was no surface, is not faded from", "[cross_fade]") {
    KernelRig rig(GENERATE(1u, 16u));
    const auto [w, h] = testSize({40, 12});
    FadeRig fade(rig, w, h);
    Frame frame(w, h);
    frame.look(pixelCamera(w, h), flat);
    for (std::uint32_t y = 0; y < h; ++y) frame.normal.set(0, y, {0, 0, 0});  // background
    shine(frame, 1.0);
    fade.render(frame, 1.0f);
    Frame next(w, h);
    next.look(pixelCamera(w, h), [](std::uint32_t x, std::uint32_t) { return x < 20 ? kDepth : 900.0; });
    shine(next, 5.0);
    const Shown shown = fade.render(next, 0.5f);
    for (std::uint32_t x = 0; x < w; ++x) CHECK(shown.irradiance[x] == (x == 0 || x >= 20 ? 5.0f : 3.0f));
}

TEST_CASE("light that is no number is shown as it is, and nothing is faded from it", "[cross_fade]") {
    KernelRig rig(GENERATE(1u, 16u));
    const auto [w, h] = testSize({33, 5});
    FadeRig fade(rig, w, h);
    Frame frame = still(w, h);
    frame.shine([](std::uint32_t x, std::uint32_t) { return x == 4 ? Vec{double(std::numeric_limits<float>::quiet_NaN()), 1, 1} : Vec{1, 1, 1}; });
    fade.render(frame, 1.0f);
    shine(frame, 2.0);
    const Shown shown = fade.render(frame, 0.5f);
    for (std::uint32_t x = 0; x < w; ++x) CHECK(shown.irradiance[x] == (x == 4 ? 2.0f : 1.5f));
}

TEST_CASE("cuts, frames that were not kept, other images and a picture drawn twice", "[cross_fade]") {
    KernelRig rig(16);
    const auto [w, h] = testSize({32, 8});
    FadeRig fade(rig, w, h);
    Frame frame = still(w, h), bright = still(w, h);
    shine(frame, 1.0);
    shine(bright, 3.0);
    fade.render(frame, 1.0f);
    CHECK(fade.render(bright, 0.5f).irradiance[0] == 2.0f);
    CHECK(fade.renderOnly(bright, 0.5f).irradiance[0] == 2.0f);  // again: from the same picture
    CHECK(fade.render(bright, 0.5f).irradiance[0] == 2.5f);
    CHECK(fade.render(bright, 0.5f, true).irradiance[0] == 3.0f);  // a cut
    fade.render(frame, 1.0f);
    fade.view().startFrame(false);
    fade.view().forget();  // shown without being kept
    CHECK_FALSE(fade.view().isKept());
    CHECK(fade.render(bright, 0.5f).irradiance[0] == 3.0f);
    fade.render(frame, 1.0f);
    fade.view().startFrame(false);
    CHECK(fade.renderOnly(bright, 0.5f, false).irradiance[0] == 3.0f);  // without validity: another picture
}

TEST_CASE("another size: what was shown is looked up where its pixels lie", "[cross_fade]") {
    KernelRig rig(GENERATE(1u, 16u));
    FadeRig fade(rig, 64, 32);
    Frame frame = still(64, 32);
    shine(frame, 1.0);
    fade.render(frame, 1.0f);
    Frame half(32, 16);
    half.look(pixelCamera(64, 32), flat);
    shine(half, 3.0);
    const Shown shown = fade.render(half, 0.5f);
    std::vector<float> want(shown.irradiance.size());
    for (std::size_t i = 0; i < want.size(); ++i) want[i] = i < 512 ? 2.0f : i < 1024 ? 4.0f : 1.0f;
    CHECK(disagreement(shown.irradiance, want, 1e-5) == "");
}

TEST_CASE("motion vectors lead to what a moving surface showed", "[cross_fade]") {
    KernelRig rig(GENERATE(1u, 16u));
    const auto [w, h] = testSize({48, 8});
    FadeRig fade(rig, w, h);
    Frame frame = still(w, h);
    frame.shine([](std::uint32_t x, std::uint32_t) { return Vec{double(x), 1, 1}; });
    fade.render(frame, 1.0f);
    Frame next = still(w, h);
    shine(next, 100.0);
    next.move([](std::uint32_t, std::uint32_t) { return Vec{-2, 0, 0}; });  // it was two pixels to the left
    const Shown shown = fade.render(next, 0.5f);
    for (std::uint32_t x = 2; x < w; ++x) CHECK(double(shown.irradiance[x]) == Approx(0.5 * (x - 2.0) + 50.0).epsilon(1e-5));
    for (std::uint32_t x = 0; x < 2; ++x) CHECK(shown.irradiance[x] == 100.0f);
}

TEST_CASE("a fade goes on where the origin of positions moves", "[cross_fade]") {
    KernelRig rig(GENERATE(1u, 16u));
    const auto [w, h] = testSize({67, 33});
    FadeRig fade(rig, w, h);
    Frame frame = still(w, h), moved(w, h);
    const WorldOrigin first{1e6, 0.0, -2e5}, second{1e6 + 12.37, -40.1, -2e5 + 3000.0};
    TestCamera camera = pixelCamera(w, h);
    for (int a = 0; a < 3; ++a) camera.eye[a] = first[std::size_t(a)] - second[std::size_t(a)];
    moved.look(camera, flat);
    frame.shine(noise);
    moved.shine([](std::uint32_t x, std::uint32_t y) { return noise(x, y) * 3.0; });
    rig.executor().setWorldOrigin(first);
    fade.render(frame, 1.0f);
    rig.executor().setWorldOrigin(second);
    const Shown shown = fade.render(moved, 0.5f);
    CHECK(fade.fresh() == 0);
    for (std::size_t i = 0; i < shown.irradiance.size(); ++i)
        REQUIRE(double(shown.irradiance[i]) == Approx(2.0 * double(frame.light.planes[i])).epsilon(1e-6));
}
