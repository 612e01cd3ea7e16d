// Technique screen_space through the C API: what must not change its light, and what a host relies on.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "support/corner_picture.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

// Sums of the same terms in float, rounded after scaling.
constexpr double kRounding = 2e-5;

}  // namespace

TEST_CASE("same input, same bits: runs and widths", "[screen_space]") {
    CornerPicture picture(97, 61);
    const LWScreenSpaceDesc desc = descOf(GENERATE(LW_START_FULL, LW_START_HALF, LW_START_QUARTER), 4, 32);
    TestDevice wide(16), scalar(1);
    const Result first = render(wide, desc, picture);
    for (int run = 0; run < 10; ++run) {
        const Result other = render(wide, desc, picture);
        CHECK(other.irradiance == first.irradiance);
        CHECK(other.validity == first.validity);
    }
    const Result narrow = render(scalar, desc, picture);
    CHECK(narrow.irradiance == first.irradiance);
    CHECK(narrow.validity == first.validity);
}

TEST_CASE("the unit of length changes nothing but rounding", "[screen_space]") {
    TestDevice device(16);
    const LWScreenSpaceDesc desc = descOf(LW_START_HALF, 4, 64);
    CornerPicture metres(160, 90);
    const Result first = render(device, desc, metres);
    for (const double scale : {10.0, 0.1, 1000.0}) {
        CornerPicture scaled(160, 90, 1.0, scale);
        CAPTURE(scale);
        CHECK(difference(render(device, desc, scaled).irradiance, first.irradiance) < kRounding);
    }
}

TEST_CASE("two views do not disturb each other; sizes change without allocation", "[screen_space]") {
    TestDevice device(16);
    const LWScreenSpaceDesc desc = descOf(LW_START_HALF, 3, 32);
    CornerPicture left(96, 64), right(61, 40);
    const Result leftAlone = render(device, desc, left), rightAlone = render(device, desc, right);
    TestTechnique technique(device, "screen_space", &desc);
    TestView leftView(device, 96, 64), rightView(device, 128, 128);
    CHECK(render(technique, leftView, left.gbuffer, device).irradiance == leftAlone.irradiance);
    rightView.resize(61, 40);
    CHECK(render(technique, rightView, right.gbuffer, device, {}, false).irradiance == rightAlone.irradiance);
    const std::uint64_t bytes = technique.stats().deviceBytes;
    rightView.resize(96, 64);
    CHECK(render(technique, rightView, left.gbuffer, device, {}, false).irradiance == leftAlone.irradiance);
    rightView.resize(61, 40);
    CHECK(render(technique, rightView, right.gbuffer, device).irradiance == rightAlone.irradiance);
    CHECK(technique.stats().deviceBytes == bytes);
}

TEST_CASE("what is off the screen, dark or only receives sends nothing", "[screen_space]") {
    TestDevice device(GENERATE(1u, 16u));
    const LWScreenSpaceDesc desc = descOf(LW_START_QUARTER, 4, 64);
    const auto dark = [](const Result& r) { return std::all_of(r.irradiance.begin(), r.irradiance.end(), [](float v) { return v == 0.0f; }); };
    // The wall's upper half fills the picture: the floor that lights it is off the screen.
    Picture wall(64, 40, 0.1, {0, 0.7, 2.4}, litFloor());
    CHECK(dark(render(device, desc, wall)));
    Picture nothing(64, 40, 0.1, {0, 0.7, 2.4}, {});
    CHECK(dark(render(device, desc, nothing)));
    Picture one(1, 1, 0.45, kEye, litFloor());
    CHECK(dark(render(device, desc, one)));
    CornerPicture receivers(64, 40);
    const Result lit = render(device, desc, receivers);
    CHECK_FALSE(dark(lit));
    // The floor as a character: it sends nothing, and what is seen does not count it.
    for (std::uint32_t y = 0; y < 40; ++y)
        for (std::uint32_t x = 0; x < 64; ++x) receivers.mask.at(x, y, 0) = receivers.normal.get(x, y).y > 0.5 ? 1.0f : 0.0f;
    receivers.gbuffer.receiveMask = receivers.mask.image();
    CHECK(dark(render(device, desc, receivers)));
    // The wall as one: it receives as before.
    for (std::uint32_t y = 0; y < 40; ++y)
        for (std::uint32_t x = 0; x < 64; ++x) receivers.mask.at(x, y, 0) = receivers.normal.get(x, y).z > 0.5 ? 1.0f : 0.0f;
    CHECK(meanOf(render(device, desc, receivers).irradiance) == Approx(meanOf(lit.irradiance)).epsilon(0.1));
}

TEST_CASE("another camera lends its light to the surfaces that both see", "[screen_space]") {
    TestDevice device(GENERATE(1u, 16u));
    LWScreenSpaceDesc desc = descOf(LW_START_HALF, 5, 64);
    Picture wall(96, 64, 0.1, {0, 0.5, 2.4}, litFloor());
    CornerPicture corner(160, 90);
    TestView view(device, 96, 64), other(device, 160, 90);
    const auto with = [&](const std::vector<LWSourceView>& sources) {
        TestTechnique technique(device, "screen_space", &desc);
        return render(technique, view, wall.gbuffer, device, sources);
    };
    CHECK(meanOf(with({{other, &corner.gbuffer}}).irradiance) == 0.0);  // cameras is off
    desc.cameras = 1;
    const Result lent = with({{other, &corner.gbuffer}});
    const Error error = wallError(wall, lent);
    CAPTURE(error.bias, error.mean);
    CHECK(std::abs(error.bias) < 0.08);
    CHECK(error.mean < 0.12);
    // A view takes nothing from itself, and a camera that sees nothing of it changes nothing.
    CHECK(meanOf(with({{view, &corner.gbuffer}}).irradiance) == 0.0);
    Picture away(160, 90, 0.45, {0, 0.62, 2.4}, {{{-1, 0, 2}, {2, 0, 0}, {0, 0, -1}, {0, 1, 0}, {1, 1, 1}}});
    CHECK(meanOf(with({{other, &away.gbuffer}}).irradiance) == 0.0);
    const Result own = render(device, desc, corner), both = render(device, desc, corner, {{other, &away.gbuffer}});
    CHECK(own.irradiance == both.irradiance);
}

TEST_CASE("after lwPrewarm frames of all sizes build nothing", "[screen_space]") {
    TestDevice device(16);
    LWScreenSpaceDesc desc = descOf(GENERATE(LW_START_FULL, LW_START_QUARTER), 4, 16);
    desc.cameras = 1;
    TestTechnique technique(device, "screen_space", &desc);
    TestView view(device, 64, 64), source(device, 64, 64);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    CornerPicture large(64, 64), small(40, 24);
    for (int frame = 0; frame < 100; ++frame) {
        const bool isSmall = frame % 5 == 4;
        view.resize(isSmall ? 40 : 64, isSmall ? 24 : 64);
        render(technique, view, isSmall ? small.gbuffer : large.gbuffer, device, {{source, &large.gbuffer}});
    }
    const LWDeviceInfo after = device.info();
    CHECK(after.programsBuilt == before.programsBuilt);
    CHECK(after.programsLoaded == before.programsLoaded);
    CHECK(after.kernelsSpecialised == before.kernelsSpecialised);
}

TEST_CASE("screen_space refuses what it cannot use, counts what it leaves out, and takes the memory it says", "[screen_space]") {
    TestDevice device(16);
    CornerPicture picture(64, 40);
    const LWScreenSpaceDesc desc = descOf(LW_START_HALF, 4, 16);
    TestTechnique technique(device, "screen_space", &desc);
    TestView view(device, 64, 40);
    LWFrame frame{};
    frame.structSize = sizeof frame;
    technique.update(frame);
    PlanarPixels irradiance(64, 40, 3), scalar(64, 40, 1);
    LWOutput output{};
    output.structSize = sizeof output;
    output.irradiance = irradiance.image();
    const auto refused = [&](const LWGBuffer& gbuffer, LWStatus status) {
        CHECK(lwRender(technique, view, &gbuffer, &output) == status);
        return lastError(device);
    };
    LWGBuffer bad = picture.gbuffer;
    bad.directRadiance = LWImage{};
    CHECK(refused(bad, LW_ERROR_INVALID_ARGUMENT).find("gbuffer.directRadiance") != std::string::npos);
    bad = picture.gbuffer;
    bad.camera = LWCamera{};
    CHECK(refused(bad, LW_ERROR_INVALID_ARGUMENT).find("gbuffer.camera") != std::string::npos);
    output.ambientOcclusion = scalar.image();
    CHECK(refused(picture.gbuffer, LW_ERROR_UNSUPPORTED).find("ambientOcclusion") != std::string::npos);
    for (const auto& [field, name] : {std::pair(&LWScreenSpaceDesc::levels, "levels"), std::pair(&LWScreenSpaceDesc::samples, "samples"),
                                      std::pair(&LWScreenSpaceDesc::interleave, "interleave")}) {
        LWScreenSpaceDesc wrong = desc;
        wrong.*field = 7;
        LWTechnique none = nullptr;
        CHECK(lwCreateScreenSpace(device, &wrong, &none) == LW_ERROR_INVALID_ARGUMENT);
        CHECK(lastError(device).find(name) != std::string::npos);
    }
    picture.position.at(32, 18, 0) = std::nanf("");
    picture.radiance.at(32, 35, 1) = std::numeric_limits<float>::infinity();
    const Result result = render(technique, view, picture.gbuffer, device);
    CHECK(technique.count("rejected_pixels") == 1);
    CHECK(technique.count("rejected_radiances") == 1);
    for (const float v : result.irradiance) REQUIRE((v >= 0.0f && v < 10.0f));
    LWViewDesc viewDesc{};
    viewDesc.structSize = sizeof viewDesc;
    viewDesc.maxWidth = 64;
    viewDesc.maxHeight = 40;
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateMemory(device, "screen_space", &desc, &viewDesc, 0, &estimate) == LW_SUCCESS);
    const std::uint64_t bytes = technique.stats().deviceBytes;
    CHECK(bytes <= estimate);
    CHECK(bytes > estimate / 4);
}

TEST_CASE("pictures of any shape, of radii far beyond them and of any numbers stay finite", "[screen_space]") {
    TestDevice device(GENERATE(1u, 16u));
    const auto [w, h] = GENERATE(std::make_pair(1u, 1u), std::make_pair(2u, 1u), std::make_pair(3u, 5u), std::make_pair(17u, 2u));
    LWScreenSpaceDesc desc = descOf(GENERATE(LW_START_FULL, LW_START_QUARTER), 6, 8, 64.0f);
    desc.bounded = GENERATE(0u, 1u);
    CAPTURE(w, h, desc.start, desc.bounded);
    CornerPicture picture(w, h);
    // The largest that is taken, at the largest distance, beside what is not.
    picture.radiance.set(0, 0, {1e30, 1e30, 1e30});
    if (w > 1) picture.position.set(1, 0, {1e9, 0, -1e9});
    if (h > 2) {
        picture.radiance.set(0, 1, {std::nan(""), -1, 1});
        picture.normal.set(1, 1, {std::nan(""), 0, 1});
        picture.position.set(2, 1, {0, std::numeric_limits<double>::infinity(), 0});
        for (std::uint32_t x = 0; x < w; ++x) picture.mask.at(x, 2, 0) = 1.0f;
        picture.gbuffer.receiveMask = picture.mask.image();
    }
    const Result result = render(device, desc, picture);
    for (const float v : result.irradiance) REQUIRE((v >= 0.0f && v <= 1e36f));
    for (const float v : result.validity) REQUIRE((v >= 0.0f && v <= 1.0f));
}
