// Technique screen_space with a temporal history, through the C API: what it gains where nothing moves, that it does not
// drift, what moving light leaves behind, and what hosts rely on (cuts, eyes, memory, outputs that are not asked for).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "support/corner_picture.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

// Few samples of a wide ring: noise that a history has something to do about.
LWScreenSpaceDesc keeping(std::uint32_t history) {
    LWScreenSpaceDesc desc = descOf(LW_START_HALF, 3, 32, 40.0f);
    desc.history = history;
    return desc;
}

Result frameOf(TestTechnique& technique, const TestView& view, const LWGBuffer& gbuffer, LWDevice device, std::uint32_t reset = 0,
               bool wantsIrradiance = true, bool wantsValidity = true) {
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.reset = reset;
    technique.update(frame);
    PlanarPixels irradiance(view.width(), view.height(), 3), validity(view.width(), view.height(), 1);
    LWOutput output{};
    output.structSize = sizeof output;
    if (wantsIrradiance) output.irradiance = irradiance.image();
    if (wantsValidity) output.validity = validity.image();
    const LWStatus status = lwRender(technique, view, &gbuffer, &output);
    INFO(lastError(device));
    REQUIRE(status == LW_SUCCESS);
    REQUIRE(lwFinish(device) == LW_SUCCESS);
    return {irradiance.packed(), validity.packed()};
}

// What the technique tends to: the mean of many seeds, each alone.
std::vector<float> manySeeds(LWDevice device, const Picture& picture) {
    std::vector<float> sum;
    constexpr std::uint32_t kSeeds = 256;
    LWScreenSpaceDesc desc = keeping(0);
    for (desc.seed = 1; desc.seed <= kSeeds; ++desc.seed) {
        const Result one = render(device, desc, picture);
        sum.resize(one.irradiance.size());
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += one.irradiance[i] / float(kSeeds);
    }
    return sum;
}

}  // namespace

TEST_CASE("with a history a still view nears the light of many seeds and does not drift in 500 frames", "[screen_space][history]") {
    TestDevice device(16);
    CornerPicture picture(96, 60);
    TestView view(device, 96, 60);
    TestTechnique kept(device, keeping(32));
    const std::vector<float> truth = manySeeds(device, picture);
    const double alone = difference(render(device, keeping(0), picture).irradiance, truth);
    double worst = 0.0, first = 0.0, last = 0.0, seenFirst = 0.0, seenLast = 0.0;
    for (int f = 0; f < 500; ++f) {
        const Result result = frameOf(kept, view, picture.gbuffer, device);
        if (f >= 64) worst = std::max(worst, difference(result.irradiance, truth));
        if (f >= 64 && f < 164) {
            first += meanOf(result.irradiance) / 100.0;
            seenFirst += meanOf(result.validity) / 100.0;
        }
        if (f >= 400) {
            last += meanOf(result.irradiance) / 100.0;
            seenLast += meanOf(result.validity) / 100.0;
        }
    }
    CAPTURE(alone, worst);
    // A mean over 32 frames of independent noise would have 0.18 of it; bounds hold a part of the noise in.
    CHECK(worst < 0.4 * alone);
    CHECK(last == Approx(first).epsilon(1e-3));
    CHECK(last == Approx(meanOf(truth)).epsilon(5e-3));
    CHECK(seenLast == Approx(seenFirst).epsilon(1e-3));
    CHECK(kept.count("history_new") == 0);
}

TEST_CASE("where a bright thing has been its light is gone after 8 frames", "[screen_space][history]") {
    // A bright slab stands before the wall, close over the floor, for 40 frames, then is 0.9 m to the right.
    TestDevice device(16);
    const auto withSlab = [](double x) {
        std::vector<Quad> quads = litFloor(0.1);
        quads.push_back({{x, 0.05, 0.5}, {0.25, 0, 0}, {0, 0, -0.25}, {0, 1, 0}, {20, 20, 20}});
        return quads;
    };
    Picture before(160, 100, 0.45, kEye, withSlab(-0.7)), after(160, 100, 0.45, kEye, withSlab(0.2));
    TestView view(device, 160, 100), other(device, 160, 100);
    LWScreenSpaceDesc desc = descOf(LW_START_HALF, 4, 64);
    desc.history = 32;
    TestTechnique moved(device, desc), resting(device, desc);
    Result shown, expected, at;
    for (int f = 0; f < 40; ++f) {
        at = frameOf(moved, view, before.gbuffer, device);
        frameOf(resting, other, after.gbuffer, device);
    }
    for (int f = 0; f < 8; ++f) {
        shown = frameOf(moved, view, after.gbuffer, device);
        expected = frameOf(resting, other, after.gbuffer, device);
    }
    // The wall behind the place where it was, which is dark now.
    double left = 0.0, was = 0.0, now = 0.0;
    for (std::uint32_t y = 0; y < 100; ++y)
        for (std::uint32_t x = 0; x < 160; ++x) {
            const Vec p = after.position.get(x, y);
            if (after.normal.get(x, y).z < 0.5 || p.x > -0.3 || p.y > 0.5) continue;
            const std::size_t i = std::size_t(y) * 160 + x;
            left += shown.e(i);
            was += at.e(i);
            now += expected.e(i);
        }
    CAPTURE(was, left, now);
    REQUIRE(was > 3.0 * now);
    CHECK(std::abs(left - now) < 0.05 * (was - now));
}

TEST_CASE("a history follows the camera and moving things", "[screen_space][history]") {
    // The slab goes 8 pixels to the right in a frame, by a sideways move of 8 pixels' width at its depth.
    TestDevice device(16);
    const auto slab = [](double x) {
        std::vector<Quad> quads = litFloor(0.1);
        quads.push_back({{x, 0.3, 0.5}, {0.4, 0, 0}, {0, 0.3, 0}, {0, 0, 1}, {2, 2, 2}});
        return quads;
    };
    const double step = 8.0 * (kEye.z - 0.5) * 2.0 * 0.45 / 100.0;  // 100 rows
    Picture before(162, 100, 0.45, kEye, slab(-0.7)), after(162, 100, 0.45, kEye, slab(-0.7 + step));
    std::vector<float> motion(2 * 162 * 100);
    for (std::uint32_t y = 0; y < 100; ++y)
        for (std::uint32_t x = 0; x < 162; ++x)
            if (after.normal.get(x, y).z > 0.5 && after.position.get(x, y).z > 0.4) motion[2 * (y * 162 + x)] = -8.0f;
    TestView view(device, 162, 100);
    const auto fresh = [&](bool withMotion) {
        TestTechnique technique(device, keeping(16));
        for (int f = 0; f < 3; ++f) frameOf(technique, view, before.gbuffer, device);
        CHECK(technique.count("history_new") == 0);
        LWGBuffer gbuffer = after.gbuffer;
        if (withMotion) {
            gbuffer.motion.host = motion.data();
            gbuffer.motion.format = LW_FORMAT_FLOAT2;
            gbuffer.motion.width = 162;
            gbuffer.motion.height = 100;
        }
        frameOf(technique, view, gbuffer, device);
        return technique.count("history_new");
    };
    const std::uint64_t followed = fresh(true), unfollowed = fresh(false);
    CAPTURE(followed, unfollowed);
    // What it uncovers is new, 4 texels wide and 8 high or so, and so is its front where it is not followed.
    CHECK(followed > 0);
    CHECK(2 * followed < unfollowed + 40);
    // The camera half a texel to the right, of a picture that is no whole number of texels wide: all but an edge is known.
    Picture turned(162, 100, 0.45, {kEye.x + 0.5 * step / 8.0, kEye.y, kEye.z}, slab(-0.7));
    TestTechnique technique(device, keeping(16));
    for (int f = 0; f < 3; ++f) frameOf(technique, view, before.gbuffer, device);
    frameOf(technique, view, turned.gbuffer, device);
    CHECK(technique.count("history_new") < 81 * 50 / 20);
}

TEST_CASE("a cut starts anew: the picture of a technique that has just been made", "[screen_space][history]") {
    TestDevice device(GENERATE(1u, 16u));
    CornerPicture bright(61, 40), dim(61, 40, 0.2);
    TestView view(device, 61, 40), another(device, 61, 40);
    TestTechnique cut(device, keeping(16)), fresh(device, keeping(16));
    for (int f = 0; f < 5; ++f) frameOf(cut, view, bright.gbuffer, device);
    const Result one = frameOf(cut, view, dim.gbuffer, device, 1), two = frameOf(fresh, another, dim.gbuffer, device, 1);
    CHECK(one.irradiance == two.irradiance);
    CHECK(one.validity == two.validity);
    // The first frame of a history is the frame alone.
    CHECK(one.irradiance == render(device, keeping(0), dim).irradiance);
}

TEST_CASE("two eyes with histories do not disturb each other", "[screen_space][history]") {
    TestDevice device(16);
    CornerPicture left(97, 61), right(61, 40);
    const auto run = [&](bool withLeft, bool withRight) {
        TestTechnique technique(device, keeping(16));
        TestView leftView(device, 97, 61), rightView(device, 61, 40);
        std::pair<Result, Result> pictures;
        for (int f = 0; f < 6; ++f) {
            if (withLeft) pictures.first = frameOf(technique, leftView, left.gbuffer, device);
            if (withRight) pictures.second = render(technique, rightView, right.gbuffer, device, {}, !withLeft);
        }
        return pictures;
    };
    const auto both = run(true, true);
    CHECK(both.first.irradiance == run(true, false).first.irradiance);
    CHECK(both.second.irradiance == run(false, true).second.irradiance);
    CHECK(both.second.validity == run(false, true).second.validity);
}

TEST_CASE("a history goes on where an output is not asked for", "[screen_space][history]") {
    TestDevice device(16);
    CornerPicture picture(61, 40);
    TestView view(device, 61, 40), another(device, 61, 40);
    TestTechnique always(device, keeping(16)), now(device, keeping(16));
    Result expected, got;
    for (int f = 0; f < 6; ++f) {
        expected = frameOf(always, view, picture.gbuffer, device);
        got = frameOf(now, another, picture.gbuffer, device, 0, f % 3 != 0, f % 3 != 1);
        if (f % 3 != 0) CHECK(got.irradiance == expected.irradiance);
        if (f % 3 != 1) CHECK(got.validity == expected.validity);
    }
}

TEST_CASE("with a history, too, lwPrewarm builds all and the memory is what was said", "[screen_space][history]") {
    TestDevice device(16);
    LWScreenSpaceDesc desc = keeping(16);
    desc.cameras = 1;
    TestTechnique technique(device, desc);
    TestView view(device, 64, 64), source(device, 64, 64);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    CornerPicture large(64, 64), small(40, 24);
    std::uint64_t bytes = 0;
    for (int f = 0; f < 12; ++f) {
        const bool isSmall = f % 5 == 4;
        view.resize(isSmall ? 40 : 64, isSmall ? 24 : 64);
        render(technique, view, isSmall ? small.gbuffer : large.gbuffer, device, {{source, &large.gbuffer}});
        if (f == 0) bytes = technique.stats().deviceBytes;
        CHECK(technique.stats().deviceBytes == bytes);
    }
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
    desc.cameras = 0;
    view.resize(64, 64);
    TestTechnique single(device, desc);
    render(single, view, large.gbuffer, device);
    LWViewDesc viewDesc{};
    viewDesc.structSize = sizeof viewDesc;
    viewDesc.maxWidth = viewDesc.maxHeight = 64;
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateMemory(device, "screen_space", &desc, &viewDesc, 0, &estimate) == LW_SUCCESS);
    CHECK(single.stats().deviceBytes <= estimate);
    CHECK(single.stats().deviceBytes > estimate / 2);
}

TEST_CASE("a source view keeps its own history when another before it is gone", "[screen_space][history]") {
    TestDevice device(16);
    LWScreenSpaceDesc desc = keeping(16);
    desc.cameras = 1;
    // Of one size, and from elsewhere, so that the one's picture is no history of the other's.
    CornerPicture own(61, 40), second(64, 40);
    Picture first(64, 40, 0.3, {0.4, 0.5, 1.9}, litFloor(0.3));
    TestView a(device, 64, 40), b(device, 64, 40);
    const auto run = [&](bool withFirst) {
        TestTechnique technique(device, desc);
        TestView view(device, 61, 40);
        Result result;
        for (int f = 0; f < 5; ++f) {
            std::vector<LWSourceView> sources = {{b, &second.gbuffer}};
            if (withFirst && f < 4) sources.insert(sources.begin(), {a, &first.gbuffer});
            result = render(technique, view, own.gbuffer, device, sources);
        }
        CHECK(technique.count("history_new") == 0);
        return result;
    };
    const Result left = run(true), alone = run(false);
    CHECK(left.irradiance == alone.irradiance);
    CHECK(left.validity == alone.validity);
}
