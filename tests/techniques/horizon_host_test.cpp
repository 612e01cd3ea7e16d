// Technique horizon through the C API: the furnace, who sends and who receives, what must not change the picture, and what
// a host relies on (memory, nothing built after lwPrewarm, refusals). Closed forms: horizon_test.cpp.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "support/packed_light.h"
#include "techniques/screen_rig.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr double kPi = 3.14159265358979323846;
// Sums of positive numbers in float, in another order.
constexpr double kRounding = 2e-5;

}  // namespace

TEST_CASE("in a furnace irradiance is pi L of the seen share", "[horizon]") {
    TestDevice device(GENERATE(1u, 16u));
    ViewScene box;
    for (const auto& [u, v, w] : {std::array{glm::dvec3(2, 0, 0), glm::dvec3(0, 2, 0), glm::dvec3(0, 0, 2)},
                                  std::array{glm::dvec3(0, 2, 0), glm::dvec3(0, 0, 2), glm::dvec3(2, 0, 0)},
                                  std::array{glm::dvec3(0, 0, 2), glm::dvec3(2, 0, 0), glm::dvec3(0, 2, 0)}}) {
        box.quad({-1, -1, -1}, u, v, 0.75);
        box.quad(glm::dvec3(-1, -1, -1) + w, u, v, 0.75);
    }
    DrawnView drawn(box, lookAt({0.2, 0.1, 0.9}, {0, 0, -1}, 1.2), 93, 61);
    LWHorizonDesc desc;
    lwDefaultHorizon(&desc);
    desc.resolution = GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_HALF);
    const auto result = renderScreen(device, "horizon", &desc, drawn);
    for (std::size_t i = 0; i < 93 * 61; ++i)
        REQUIRE(double(result.irradiance[i]) == Approx(0.75 * kPi * double(result.validity[i])).epsilon(kRounding));
    CHECK(meanOf(result.validity) > 0.5);  // the view shows most of the box
}

TEST_CASE("pixels that only receive hide but do not send; background neither", "[horizon]") {
    TestDevice device(GENERATE(1u, 16u));
    const TestCamera camera = lookAt({0.7, 1.4, 2.4}, {0, 0.4, 0.3}, 0.42);
    ViewScene sends = litScene(1.0), receives = litScene(1.0);
    receives.quads[0].receiveOnly = true;
    DrawnView lit(sends, camera, 77, 53), dark(receives, camera, 77, 53);
    const LWHorizonDesc desc = horizonDesc(8, 2);
    const auto with = renderScreen(device, "horizon", &desc, lit), without = renderScreen(device, "horizon", &desc, dark);
    CHECK(with.ambient == without.ambient);
    CHECK(with.validity == without.validity);
    CHECK(meanOf(with.irradiance) > 0.0);
    for (const float e : without.irradiance) REQUIRE(e == 0.0f);
    for (std::uint32_t i = 0; i < 77 * 53; ++i) {
        const Vec n = lit.normal.get(i % 77, i / 77);
        if (n.x != 0.0 || n.y != 0.0 || n.z != 0.0) continue;
        REQUIRE(with.irradiance[i] == 0.0f);
        REQUIRE(with.validity[i] == 0.0f);
        REQUIRE(with.ambient[i] == 0.0f);
    }
}

TEST_CASE("same input, same bits: runs and widths; scale changes rounding only", "[horizon]") {
    const TestCamera camera = lookAt({0.7, 1.4, 2.4}, {0, 0.4, 0.3}, 0.42);
    DrawnView drawn(litScene(), camera, 93, 61);
    LWHorizonDesc desc;
    lwDefaultHorizon(&desc);
    desc.resolution = GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_HALF);
    TestDevice wide(16), scalar(1);
    const auto first = renderScreen(wide, "horizon", &desc, drawn);
    for (int run = 0; run < 10; ++run) {
        const auto again = renderScreen(wide, "horizon", &desc, drawn);
        CHECK(again.irradiance == first.irradiance);
        CHECK(again.ambient == first.ambient);
    }
    const auto other = renderScreen(scalar, "horizon", &desc, drawn);
    CHECK(difference(other.irradiance, first.irradiance) < kRounding);
    for (const double scale : {8.0, 1.0 / 1024.0, 1000.0}) {
        DrawnView scaled(litScene(), camera, 93, 61, scale);
        CAPTURE(scale);
        // A factor that is no power of two moves single sector borders.
        CHECK(difference(renderScreen(wide, "horizon", &desc, scaled).irradiance, first.irradiance) < 5e-3);
    }
}

TEST_CASE("the picture does not depend on the resolution", "[horizon]") {
    TestDevice device(16);
    const TestCamera camera = lookAt({0.7, 1.4, 2.4}, {0, 0.4, 0.3}, 0.42);
    LWHorizonDesc desc;
    lwDefaultHorizon(&desc);
    double small = 0.0, large = 0.0, smallOpen = 0.0, largeOpen = 0.0;
    {
        DrawnView drawn(litScene(), camera, 160, 120);
        const auto result = renderScreen(device, "horizon", &desc, drawn);
        small = meanOf(result.irradiance), smallOpen = meanOf(result.ambient);
    }
    {
        DrawnView drawn(litScene(), camera, 480, 360);
        const auto result = renderScreen(device, "horizon", &desc, drawn);
        large = meanOf(result.irradiance), largeOpen = meanOf(result.ambient);
    }
    CHECK(large / small == Approx(1.0).margin(0.08));  // what lies within a pixel or two of an edge shrinks
    CHECK(largeOpen / smallOpen == Approx(1.0).margin(0.03));
}

TEST_CASE("after lwPrewarm frames of every kind build nothing", "[horizon]") {
    TestDevice device(16);
    const char* name = GENERATE("horizon", "ao");
    const LWResolution resolution = GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_HALF);
    const LWAmbientWeighting weighting = GENERATE(LW_AMBIENT_COSINE, LW_AMBIENT_UNIFORM);
    LWHorizonDesc horizon;
    lwDefaultHorizon(&horizon);
    horizon.resolution = resolution;
    horizon.weighting = weighting;
    LWAoDesc ao;
    lwDefaultAo(&ao);
    ao.resolution = resolution;
    ao.weighting = weighting;
    TestTechnique technique(device, name, std::strcmp(name, "ao") == 0 ? static_cast<const void*>(&ao) : &horizon);
    TestView view(device, 96, 64);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    const TestCamera camera = lookAt({0.7, 1.4, 2.4}, {0, 0.4, 0.3}, 0.42);
    DrawnView large(litScene(), camera, 96, 64), small(litScene(), camera, 41, 30);
    for (int frame = 0; frame < 40; ++frame) {
        const bool isSmall = frame % 5 == 4;
        view.resize(isSmall ? 41 : 96, isSmall ? 30 : 64);
        const unsigned outputs[] = {7u, 1u, 2u, 4u};
        renderScreen(technique, view, device, isSmall ? small.gbuffer : large.gbuffer, outputs[frame % 4]);
    }
    const LWDeviceInfo after = device.info();
    CHECK(after.programsBuilt == before.programsBuilt);
    CHECK(after.kernelsSpecialised == before.kernelsSpecialised);
    LWViewDesc viewDesc{};
    viewDesc.structSize = sizeof viewDesc;
    viewDesc.maxWidth = 96;
    viewDesc.maxHeight = 64;
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateMemory(device, name, nullptr, &viewDesc, 0, &estimate) == LW_SUCCESS);
    if (resolution == LW_RESOLUTION_HALF) {
        CHECK(technique.stats().deviceBytes <= estimate);
        CHECK(technique.stats().deviceBytes > estimate / 5);
    }
}

TEST_CASE("horizon refuses what it cannot use or make", "[horizon]") {
    TestDevice device(16);
    DrawnView drawn(litScene(), lookAt({0.7, 1.4, 2.4}, {0, 0.4, 0.3}, 0.42), 32, 24);
    LWHorizonDesc desc = horizonDesc(8, 2);
    TestTechnique technique(device, "horizon", &desc);
    TestView view(device, 32, 24);
    PlanarPixels scalar(32, 24, 1), colour(32, 24, 3);
    LWFrame frame{};
    frame.structSize = sizeof frame;
    technique.update(frame);
    const auto refused = [&](const LWGBuffer& gbuffer, const LWOutput& output, LWStatus status, const char* word) {
        CHECK(lwRender(technique, view, &gbuffer, &output) == status);
        const std::string message = lastError(device);
        CAPTURE(message);
        CHECK(message.find(word) != std::string::npos);
    };
    LWOutput output{};
    output.structSize = sizeof output;
    output.shadow = scalar.image();
    refused(drawn.gbuffer, output, LW_ERROR_UNSUPPORTED, "shadow");
    output.shadow = LWImage{};
    output.irradiance = colour.image();
    LWGBuffer lacking = drawn.gbuffer;
    lacking.directRadiance = LWImage{};
    refused(lacking, output, LW_ERROR_INVALID_ARGUMENT, "directRadiance");
    lacking = drawn.gbuffer;
    std::memset(&lacking.camera, 0, sizeof lacking.camera);
    refused(lacking, output, LW_ERROR_INVALID_ARGUMENT, "camera");
    // Ambient occlusion alone needs no radiance.
    lacking = drawn.gbuffer;
    lacking.directRadiance = LWImage{};
    output.irradiance = LWImage{};
    output.ambientOcclusion = scalar.image();
    CHECK(lwRender(technique, view, &lacking, &output) == LW_SUCCESS);
    CHECK(lwFinish(device) == LW_SUCCESS);
    for (const std::uint32_t directions : {3u, 7u, 41u}) {
        LWHorizonDesc bad = horizonDesc(directions, 2);
        LWTechnique none = nullptr;
        CHECK(lwCreateHorizon(device, &bad, &none) == LW_ERROR_INVALID_ARGUMENT);
        CHECK(lastError(device).find("directions") != std::string::npos);
    }
    // Rejected pixels and radiances are counted and put no NaN into the picture.
    drawn.position.at(16, 16, 0) = std::numeric_limits<float>::quiet_NaN();
    drawn.radiance.at(14, 16, 1) = std::numeric_limits<float>::infinity();
    for (const float e : renderScreen(technique, view, device, drawn.gbuffer).irradiance) REQUIRE(std::isfinite(e));
    CHECK(technique.count("rejected_pixels") == 1);
    CHECK(technique.count("rejected_radiances") == 1);
}

TEST_CASE("thin views, wide and narrow cameras, far reaches: shares stay shares, and no output depends on another", "[horizon]") {
    TestDevice device(GENERATE(1u, 16u));
    const auto [w, h] = GENERATE(std::make_pair(1u, 1u), std::make_pair(1u, 37u), std::make_pair(53u, 1u), std::make_pair(19u, 3u));
    const bool isAo = GENERATE(false, true);
    LWHorizonDesc horizon = horizonDesc(40, 8, GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_HALF));
    horizon.interleave = 4;
    horizon.reach = 4.0f;
    horizon.thickness = 10.0f;
    LWAoDesc ao;
    lwDefaultAo(&ao);
    ao.resolution = horizon.resolution;
    ao.radius = 10.0f;
    TestTechnique technique(device, isAo ? "ao" : "horizon", isAo ? static_cast<const void*>(&ao) : &horizon);
    TestView view(device, w, h);
    for (const double half : {1e-3, 0.42, 60.0}) {
        CAPTURE(w, h, isAo, half);
        DrawnView drawn(litScene(3.0), lookAt({0.7, 1.4, 2.4}, {0, 0.2, 0.1}, half), w, h);
        drawn.position.at(w / 2, h / 2, 1) = std::numeric_limits<float>::infinity();
        drawn.normal.at(w / 3, h - 1, 2) = std::numeric_limits<float>::quiet_NaN();
        const auto all = renderScreen(technique, view, device, drawn.gbuffer);
        for (std::size_t i = 0; i < all.validity.size(); ++i) {
            REQUIRE((all.validity[i] >= 0.0f && all.validity[i] <= 1.0f));
            REQUIRE((all.ambient[i] >= 0.0f && all.ambient[i] <= 1.0f));
        }
        for (const float e : all.irradiance) REQUIRE((e >= 0.0f && std::isfinite(e)));
        for (unsigned outputs = 1; outputs < 7; ++outputs) {
            const auto some = renderScreen(technique, view, device, drawn.gbuffer, outputs);
            CAPTURE(outputs);
            if (outputs & kIrradiance) CHECK(some.irradiance == all.irradiance);
            if (outputs & kValidity) CHECK(some.validity == all.validity);
            for (std::size_t i = 0; i < some.ambient.size(); ++i)
                REQUIRE(double(some.ambient[i]) == Approx(double(all.ambient[i])).margin(kRounding));
        }
    }
}
