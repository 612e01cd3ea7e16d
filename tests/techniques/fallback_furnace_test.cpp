// Technique fallback over whole techniques in a furnace: a closed box whose walls all send the same radiance, of which the
// first technique sees a part and VPLs on all walls light the rest. The irradiance is pi L at every point, whatever is seen.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "support/packed_light.h"
#include "techniques/screen_rig.h"

using namespace lightwell::test;

namespace {

constexpr double kPi = 3.14159265358979323846, kRadiance = 0.75, kFurnace = kPi * kRadiance;
constexpr std::uint32_t kWidth = 93, kHeight = 61;
// VPLs along an edge of a wall, 2 units long. Each stands for its own square, and its bounded term takes light within about that of an edge.
constexpr int kAlong = 24;
constexpr double kFromEdges = 0.25, kMeanError = 0.005, kInnerError = 1e-3;
// One product and one sum in float of what each technique rounds.
constexpr double kRounding = 2e-5;

struct Furnace {
    ViewScene walls;
    std::vector<LWVpl> vpls;

    Furnace() {
        const glm::dvec3 axes[] = {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}, low(-1, -1, -1);
        for (int a = 0; a < 3; ++a)
            for (const bool far : {false, true}) {
                const glm::dvec3 u = axes[(a + 1) % 3], v = axes[(a + 2) % 3], corner = low + (far ? axes[a] : glm::dvec3(0));
                walls.quad(corner, u, v, kRadiance);
                for (int i = 0; i < kAlong * kAlong; ++i) {
                    const glm::dvec3 p = corner + u * ((i % kAlong + 0.5) / kAlong) + v * ((i / kAlong + 0.5) / kAlong);
                    LWVpl vpl{};
                    for (int c = 0; c < 3; ++c) {
                        vpl.position[c] = float(p[c]);
                        vpl.normal[c] = float((far ? -0.5 : 0.5) * axes[a][c]);
                        vpl.flux[c] = float(kFurnace * 4.0 / (kAlong * kAlong));
                    }
                    vpl.area = float(4.0 / (kAlong * kAlong));
                    vpls.push_back(vpl);
                }
            }
    }
};

ScreenResult renderFrame(LWDevice device, LWTechnique technique, const TestView& view, const LWGBuffer& gbuffer, const Furnace& furnace) {
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.vpls = furnace.vpls.data();
    frame.vplCount = std::uint32_t(furnace.vpls.size());
    PlanarPixels irradiance(kWidth, kHeight, 3), validity(kWidth, kHeight, 1);
    LWOutput output{};
    output.structSize = sizeof output;
    output.irradiance = irradiance.image();
    output.validity = validity.image();
    const bool done = lwUpdate(technique, &frame) == LW_SUCCESS && lwRender(technique, view, &gbuffer, &output) == LW_SUCCESS &&
                      lwFinish(device) == LW_SUCCESS;
    INFO(lastError(device));
    REQUIRE(done);
    return {irradiance.packed(), validity.packed(), {}};
}

// Distance to the nearest edge of the box.
double fromEdges(const DrawnView& drawn, std::uint32_t x, std::uint32_t y) {
    const auto p = drawn.position.get(x, y);
    std::array<double, 3> gaps{1.0 - std::abs(p.x), 1.0 - std::abs(p.y), 1.0 - std::abs(p.z)};
    std::sort(gaps.begin(), gaps.end());
    return gaps[1];
}

}  // namespace

TEST_CASE("a furnace that the screen shows in part is one with VPLs for the rest", "[fallback]") {
    TestDevice device(GENERATE(1u, 16u));
    const std::string name = GENERATE("horizon", "screen_space");
    const Furnace furnace;
    const DrawnView drawn(furnace.walls, lookAt({0.2, 0.1, 0.9}, {0, 0, -1}, 1.2), kWidth, kHeight);
    LWRsmDesc all;
    lwDefaultRsm(&all);
    all.interleave = 1;
    const TestTechnique near(device, name.c_str(), nullptr), far(device, all);
    LWFallbackDesc desc;
    lwDefaultFallback(&desc);
    desc.first = near;
    desc.second = far;
    const TestTechnique joined(device, "fallback", &desc);
    const TestView view(device, kWidth, kHeight);
    const auto first = renderFrame(device, near, view, drawn.gbuffer, furnace), second = renderFrame(device, far, view, drawn.gbuffer, furnace);
    const auto sum = renderFrame(device, joined, view, drawn.gbuffer, furnace);
    double worstInside = 0.0, least = 1.0;
    constexpr std::size_t kPixels = std::size_t(kWidth) * kHeight;
    for (std::size_t i = 0; i < 3 * kPixels; ++i) {
        const double v = double(first.validity[i % kPixels]), e2 = double(second.irradiance[i]);
        // The first alone is the furnace's light of what it has seen, but where its estimate of that was cut at 1.
        if (v < 1.0) REQUIRE(double(first.irradiance[i]) == Approx(v * kFurnace).epsilon(kRounding).margin(1e-7));
        REQUIRE(double(sum.irradiance[i]) == Approx(double(first.irradiance[i]) + (1.0 - v) * e2).epsilon(kRounding));
        REQUIRE(double(sum.validity[i % kPixels]) == Approx(1.0).epsilon(kRounding));
        least = std::min(least, v);
        if (v < 1.0 && fromEdges(drawn, std::uint32_t(i % kWidth), std::uint32_t(i / kWidth % kHeight)) > kFromEdges)
            worstInside = std::max(worstInside, std::abs(double(sum.irradiance[i]) / kFurnace - 1.0));
    }
    const double seen = meanOf(first.validity), light = meanOf(sum.irradiance) / kFurnace;
    CAPTURE(name, seen, least, light, meanOf(second.irradiance) / kFurnace, worstInside);
    CHECK(light == Approx(1.0).margin(kMeanError));
    CHECK(worstInside < kInnerError);
    // It is split: neither has it all to itself.
    CHECK(seen > 0.3);
    CHECK(seen < 0.95);
    CHECK(least < 0.6);
}

TEST_CASE("no technique stands in a tree twice", "[fallback]") {
    TestDevice device(16);
    const TestTechnique rsm(device, "rsm", nullptr), ssvp(device, "ssvp", nullptr);
    LWFallbackDesc desc;
    lwDefaultFallback(&desc);
    desc.first = rsm;
    desc.second = ssvp;
    const TestTechnique inner(device, "fallback", &desc);
    LWTechnique none = nullptr;
    for (const LWTechnique twice : {LWTechnique(rsm), LWTechnique(ssvp)})
        for (const bool before : {false, true}) {
            desc.first = before ? twice : inner;
            desc.second = before ? inner : twice;
            CHECK(lwCreateFallback(device, &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
            CHECK(lastError(device) == "lwCreateFallback: desc.second: expected another technique than desc.first and what it is made of, "
                                       "got one that both hold");
        }
    // Two fallbacks may share one, each in a tree of its own.
    desc.first = rsm;
    desc.second = ssvp;
    const TestTechnique other(device, "fallback", &desc);
    LWFallbackDesc outer = desc;
    outer.first = inner;
    outer.second = other;
    CHECK(lwCreateFallback(device, &outer, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(none == nullptr);
}
