// Technique screen_space with an error target: what it leaves out, what that does to the picture, what it says of it.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "shared/screen_plan_types.h"
#include "support/choices.h"
#include "support/corner_picture.h"

using namespace lightwell::test;

namespace {

constexpr std::uint32_t kWidth = 320, kHeight = 180;

LWScreenSpaceDesc autoDesc(float error, std::uint32_t samples = 256, LWStart start = LW_START_HALF) {
    LWScreenSpaceDesc desc = descOf(start, 5, samples);
    desc.autoError = error;
    return desc;
}

// A part of the floor is lit: from all of it to a patch.
std::vector<Quad> litPart(double share, double light = 1.0) {
    std::vector<Quad> quads = litFloor(0.0);
    // A hair above the floor, so that it is the nearer one.
    quads.push_back({{-share, 1e-4, 0.3 * (1.0 - share)}, {2.0 * share, 0, 0}, {0, 0, share}, {0, 1, 0}, {light, light, light}});
    return quads;
}

double nrmse(const std::vector<float>& a, const std::vector<float>& b) {
    double square = 0.0, mean = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        square += std::pow(double(a[i]) - double(b[i]), 2.0);
        mean += double(b[i]);
    }
    return std::sqrt(square * double(a.size())) / mean;
}

using Choice = std::array<std::uint64_t, 3>;
Choice choiceOf(TestTechnique& technique) {
    return {technique.count("start_used"), technique.count("samples_used"), technique.count("levels_used")};
}

}  // namespace

TEST_CASE("without an error target no samples are chosen", "[screen_space_auto]") {
    TestDevice device(16);
    const LWScreenSpaceDesc desc = autoDesc(0.0f);
    CornerPicture picture(96, 64);
    TestTechnique technique(device, "screen_space", &desc);
    TestView view(device, 96, 64);
    render(technique, view, picture.gbuffer, device);
    CHECK(reasonOf(technique, "samples_used").empty());
}

TEST_CASE("a target that nothing meets leaves the bits as they are", "[screen_space_auto]") {
    TestDevice device(GENERATE(1u, 16u));
    CornerPicture picture(97, 61);
    const Result full = render(device, autoDesc(0.0f, 64), picture), same = render(device, autoDesc(1e-7f, 64), picture);
    CHECK(same.irradiance == full.irradiance);
    CHECK(same.validity == full.validity);
}

TEST_CASE("the picture is within the target of that with the most samples", "[screen_space_auto]") {
    TestDevice device(16);
    const double share = GENERATE(0.15, 0.4, 1.0);
    const LWStart start = GENERATE(LW_START_HALF, LW_START_QUARTER);
    Picture picture(kWidth, kHeight, 0.45, kEye, litPart(share));
    TestView view(device, kWidth, kHeight);
    const Result full = render(device, autoDesc(0.0f, 256, start), picture);
    Choice last{};
    for (const float error : {0.02f, 0.05f, 0.1f, 0.2f, 0.4f}) {
        const LWScreenSpaceDesc desc = autoDesc(error, 256, start);
        TestTechnique technique(device, "screen_space", &desc);
        const Result first = render(technique, view, picture.gbuffer, device);
        const std::uint64_t used = technique.count("samples_used"), levels = technique.count("levels_used");
        const double off = nrmse(first.irradiance, full.irradiance);
        CAPTURE(share, start, error, used, levels, off);
        // As of ssvp: a few receivers on a coarse level tell an error to within a half.
        CHECK(off <= 1.5 * double(error));
        last = choiceOf(technique);
        for (int i = 0; i < 3; ++i) CHECK(render(technique, view, picture.gbuffer, device).irradiance == first.irradiance);
    }
    CHECK(last != Choice{std::uint64_t(start), 256, 5});
}

TEST_CASE("rings too small for the receivers to tell keep the most", "[screen_space_auto]") {
    TestDevice device(16);
    const LWStart start = GENERATE(LW_START_FULL, LW_START_HALF, LW_START_QUARTER);
    Picture picture(kWidth, kHeight, 0.45, kEye, litPart(1.0));
    for (const float radius : {1.0f, 2.0f, 4.0f, 8.0f}) {
        LWScreenSpaceDesc desc = descOf(start, 6, 64, radius);
        const Result full = render(device, desc, picture);
        desc.autoError = 1e-6f;
        const Result same = render(device, desc, picture);
        CAPTURE(start, radius);
        CHECK(same.irradiance == full.irradiance);
        CHECK(same.validity == full.validity);
    }
}

TEST_CASE("rings that the most takes whole are not blurred for the sake of fewer samples", "[screen_space_auto]") {
    TestDevice device(16);
    Picture picture(2 * kWidth, 2 * kHeight, 0.45, kEye, litPart(GENERATE(0.4, 1.0)));
    TestView view(device, 2 * kWidth, 2 * kHeight);
    const std::uint32_t samples = GENERATE(64u, 256u);
    const LWStart start = GENERATE(LW_START_HALF, LW_START_QUARTER);
    for (const float radius : {3.0f, 5.0f, 8.0f}) {
        LWScreenSpaceDesc desc = descOf(start, 5, samples, radius);
        const Result full = render(device, desc, picture);
        for (const float error : {0.05f, 0.1f}) {
            desc.autoError = error;
            TestTechnique technique(device, "screen_space", &desc);
            const double off = nrmse(render(technique, view, picture.gbuffer, device).irradiance, full.irradiance);
            CAPTURE(samples, start, radius, error);
            CHECK(off <= 1.5 * double(error));
        }
    }
}

TEST_CASE("a dark picture and an empty one take the least", "[screen_space_auto]") {
    TestDevice device(GENERATE(1u, 16u));
    const LWScreenSpaceDesc desc = autoDesc(0.1f);
    TestView view(device, 96, 64);
    for (const bool isEmpty : {false, true}) {
        Picture picture(96, 64, 0.45, kEye, isEmpty ? std::vector<Quad>{} : litFloor(0.0));
        TestTechnique technique(device, "screen_space", &desc);
        const Result result = render(technique, view, picture.gbuffer, device);
        CHECK(technique.count("samples_used") <= 32);
        CHECK(reasonOf(technique, "samples_used").find("nothing is lit") != std::string::npos);
        CHECK(meanOf(result.irradiance) == 0.0);
        if (isEmpty) CHECK(technique.count("levels_used") == 1);
    }
}

TEST_CASE("the unit of radiance changes no choice", "[screen_space_auto]") {
    TestDevice device(16);
    const LWScreenSpaceDesc desc = autoDesc(0.1f);
    TestView view(device, kWidth, kHeight);
    Choice first{};
    for (const double light : {1.0, 1e-24, 1e24}) {
        Picture picture(kWidth, kHeight, 0.45, kEye, litPart(0.4, light));
        TestTechnique technique(device, "screen_space", &desc);
        render(technique, view, picture.gbuffer, device);
        if (light == 1.0) first = choiceOf(technique);
        CAPTURE(light);
        CHECK(choiceOf(technique) == first);
    }
}

TEST_CASE("frames of other light and units are no scale for each other", "[screen_space_auto]") {
    TestDevice device(16);
    const LWScreenSpaceDesc desc = autoDesc(0.1f);
    TestTechnique technique(device, "screen_space", &desc), fresh(device, "screen_space", &desc);
    TestView view(device, kWidth, kHeight);
    Picture dim(kWidth, kHeight, 0.45, kEye, litPart(1.0, 1e-12)), bright(kWidth, kHeight, 0.45, kEye, litPart(0.3, 1e12));
    render(technique, view, dim.gbuffer, device);
    for (int i = 0; i < LW_PROBE_TURNS; ++i) render(technique, view, bright.gbuffer, device);
    render(fresh, view, bright.gbuffer, device);
    // A choice that still meets the target may stay; one for the light before would be far off.
    const Result full = render(device, autoDesc(0.0f), bright), now = render(technique, view, bright.gbuffer, device);
    CHECK(nrmse(now.irradiance, full.irradiance) <= 0.15);
    CHECK(choiceOf(technique)[0] <= choiceOf(fresh)[0] + 1);
}

TEST_CASE("what moves slowly changes the choice rarely, and never to and fro", "[screen_space_auto]") {
    TestDevice device(16);
    const LWScreenSpaceDesc desc = autoDesc(GENERATE(0.05f, 0.1f, 0.2f));
    const bool isLight = GENERATE(true, false);  // or the camera
    TestTechnique technique(device, "screen_space", &desc);
    TestView view(device, kWidth, kHeight);
    std::vector<Choice> kept;  // one after the other
    int frames = 0, shortest = 1000;
    for (int i = 0; i < 50; ++i) {
        const double at = i / 49.0;
        const Vec eye = isLight ? kEye : kEye + Vec{0.6 * at - 0.3, 0.1 * at, 0.4 * at};
        Picture picture(kWidth, kHeight, 0.45, eye, litPart(isLight ? 0.1 + 0.9 * at : 0.4));
        render(technique, view, picture.gbuffer, device);
        const Choice now = choiceOf(technique);
        ++frames;
        if (!kept.empty() && now == kept.back()) continue;
        if (kept.size() > 1 && now == kept[kept.size() - 2]) shortest = std::min(shortest, frames);
        kept.push_back(now);
        frames = 0;
    }
    CAPTURE(isLight, desc.autoError, kept.size(), shortest);
    CHECK(kept.size() <= 6);
    CHECK(shortest > 10);
}

TEST_CASE("an error target takes no more memory than estimated, and compiles nothing late", "[screen_space_auto]") {
    TestDevice device(16);
    LWScreenSpaceDesc desc = autoDesc(0.1f);
    desc.history = 8;
    CornerPicture picture(96, 64);
    TestView view(device, 96, 64);
    TestTechnique technique(device, "screen_space", &desc);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    render(technique, view, picture.gbuffer, device);
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
    LWViewDesc viewDesc{};
    viewDesc.structSize = sizeof viewDesc;
    viewDesc.maxWidth = 96;
    viewDesc.maxHeight = 64;
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateMemory(device, "screen_space", &desc, &viewDesc, 0, &estimate) == LW_SUCCESS);
    CHECK(technique.stats().deviceBytes <= estimate);
    desc.autoError = -1.0f;
    LWTechnique none = nullptr;
    CHECK(lwCreateScreenSpace(device, &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("auto_error") != std::string::npos);
}
