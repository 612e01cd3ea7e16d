// lwCheckInputs on frames that are good but unusual, and on faults that only show there. Frames are
// drawn by tests/api/drawn_frame.h, which shares nothing with the library or the studio.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "api/api_scene.h"
#include "api/drawn_frame.h"
#include "lightwell/lightwell.hpp"

using namespace lightwell::test;
using Catch::Matchers::Contains;

namespace {

constexpr std::uint32_t kWidth = 160, kHeight = 90;

struct Finding {
    std::string fault, argument, message;
    LWSeverity severity;
};

std::vector<Finding> check(const lightwell::View& view, const LWFrame* frame, const LWGBuffer* gbuffer,
                           const LWImage* overlay = nullptr) {
    std::vector<Finding> list;
    for (const LWInputFinding& f : lightwell::checkInputs(view, frame, gbuffer, overlay)) {
        auto info = lightwell::make<LWInputFaultInfo>();
        lightwell::check(lwDescribeInputFault(std::uint32_t(f.fault), &info));
        list.push_back({info.name, f.argument, f.message, f.severity});
        CHECK(list.back().message.size() + 1 < sizeof f.message);  // not cut off
    }
    return list;
}
std::vector<Finding> check(const lightwell::Device& device, const DrawnFrame& f) {
    const lightwell::View view(device, f.normal.width(), f.normal.height());
    return check(view, &f.frame, &f.gbuffer);
}

std::string describe(const std::vector<Finding>& findings) {
    std::string text;
    for (const Finding& f : findings)
        text += std::to_string(f.severity) + " " + f.fault + " " + f.argument + ": " + f.message + "\n";
    return text;
}

void expectClean(const std::vector<Finding>& findings) {
    INFO(describe(findings));
    CHECK(std::all_of(findings.begin(), findings.end(),
                      [](const Finding& f) { return f.severity == LW_SEVERITY_NOTE; }));
}
void expectOne(const std::vector<Finding>& findings, const std::string& fault,
               const std::string& argument, LWSeverity severity) {
    INFO(describe(findings));
    REQUIRE(findings.size() == 1);
    CHECK(findings[0].fault == fault);
    CHECK(findings[0].argument == argument);
    CHECK(findings[0].severity == severity);
}

TestCamera insideCamera() {
    return lookingAt({0, 2.5, 3.5}, {0.5, 1.5, -3}, 0.9, 0.5);
}
DrawnLight spotLight() {
    return DrawnLight::spot({2, 4.5, 1}, {-0.5, 1, -1}, 50);
}
DrawnFrame spotRoom() {
    DrawnFrame f;
    DrawnFrame::furnish(f);
    f.lights.push_back(spotLight());
    return f;
}
template <class Change>
void eachPixel(const DrawnFrame& f, const Change& change) {
    for (std::uint32_t y = 0; y < f.normal.height(); ++y)
        for (std::uint32_t x = 0; x < f.normal.width(); ++x) change(x, y);
}

}  // namespace

TEST_CASE("several lights of all kinds in a closed room are good inputs", "[check]") {
    const lightwell::Device device;
    DrawnFrame f = spotRoom();
    f.lights.push_back(DrawnLight::lamp({-2, 3, 2}, 20));
    f.lights.push_back(DrawnLight::sun(glm::normalize(glm::dvec3(0.3, -1, -0.4)), 2, {0, 0, 0}, 6));
    const TestCamera camera = insideCamera();
    TestCamera before = camera;
    before.eye += glm::dvec3(0.3, 0.1, 0.0);
    f.draw(camera, kWidth, kHeight, &before);
    expectClean(check(device, f));

    // A sun's direction that points to the sun is as likely as normals that are turned.
    for (float& v : f.lights[2].light.direction) v = -v;
    f.describeLights();
    const auto findings = check(device, f);
    expectOne(findings, "normal-flipped", "frame.lights[2].rsms[0].normal", LW_SEVERITY_ERROR);
    CHECK_THAT(findings[0].message, Contains("direction is turned"));
}

TEST_CASE("images of a few pixels, in every shape, are checked without a finding", "[check]") {
    const lightwell::Device device;
    for (const auto& size : std::vector<std::pair<std::uint32_t, std::uint32_t>>{
             {1, 1}, {4, 4}, {3, 3}, {1, 400}, {400, 1}, {8, 8}}) {
        DrawnFrame f = spotRoom();
        f.rsmSize = size.first;
        f.draw(insideCamera(), size.first, size.second);
        HostImage overlay(LW_FORMAT_FLOAT3, size.first, size.second);
        const LWImage image = overlay.image();
        const lightwell::View view(device, size.first, size.second);
        INFO(size.first << " x " << size.second);
        expectClean(check(view, &f.frame, &f.gbuffer, &image));
        CHECK(overlay.damagedBytes() == 0);
    }
}

TEST_CASE("a camera that sees the sky alone gets no error, a buffer never drawn does", "[check]") {
    const lightwell::Device device;
    DrawnFrame f = spotRoom();
    f.useDepth = GENERATE(false, true);
    f.draw(lookingAt({0, 50, 0}, {0, 100, 1}, 0.9, 0.5), 64, 36);
    expectOne(check(device, f), "no-surfaces", "gbuffer.normal", LW_SEVERITY_WARNING);
    f.draw(insideCamera(), 64, 36);
    eachPixel(f, [&](auto x, auto y) { f.normal.set(x, y, 0, 0, 0); });
    expectOne(check(device, f), "no-surfaces", "gbuffer.normal", LW_SEVERITY_ERROR);
}

TEST_CASE("a room seen through walls that are culled from behind is in one space", "[check]") {
    const lightwell::Device device;
    DrawnFrame f;
    DrawnFrame::furnish(f);
    f.oneSided = true;
    f.lights.push_back(DrawnLight::lamp({1, 3, 3}, 50));
    f.draw(GENERATE(lookingAt({0, 2.5, 14}, {0, 2.5, 0}, 0.5, 0.3),
                    lookingAt({9, 9, 12}, {0, 1.5, 0}, 0.5, 0.4),
                    orthographic(lookingAt({9, 9, 12}, {0, 1.5, 0}, 6, 4))),
           kWidth, kHeight);
    expectClean(check(device, f));
}

TEST_CASE("motion may hold the jitter of the matrices or not, and means nothing across a cut",
          "[check]") {
    const lightwell::Device device;
    const TestCamera camera = insideCamera();
    TestCamera now = camera, before = camera;
    const double pixelX = 1.8 / kWidth, pixelY = 1.0 / kHeight;
    for (double* side : {&now.left, &now.rightEdge}) *side += 0.45 * pixelX;
    for (double* side : {&before.left, &before.rightEdge}) *side -= 0.45 * pixelX;
    for (double* side : {&now.bottom, &now.top}) *side -= 0.3 * pixelY;
    for (double* side : {&before.bottom, &before.top}) *side += 0.4 * pixelY;
    DrawnFrame f = spotRoom();
    f.draw(now, kWidth, kHeight, &before);
    expectClean(check(device, f));
    eachPixel(f, [&](auto x, auto y) { f.motion.set(x, y, 0, 0); });
    expectClean(check(device, f));
    // While it moves, motion of either kind is right, and zero is wrong.
    before.eye += glm::dvec3(0.3, 0.1, 0.0);
    f.draw(now, kWidth, kHeight, &before);
    expectClean(check(device, f));
    eachPixel(f, [&](auto x, auto y) {
        f.motion.set(x, y, f.motion.value(x, y, 0) - 0.9, f.motion.value(x, y, 1) - 0.7);
    });
    expectClean(check(device, f));
    eachPixel(f, [&](auto x, auto y) { f.motion.set(x, y, 0, 0); });
    expectOne(check(device, f), "motion-zero", "gbuffer.motion", LW_SEVERITY_ERROR);
    f.frame.reset = 1;
    expectClean(check(device, f));
}

TEST_CASE("positions far from the origin are rounded, which is no fault of motion or space", "[check]") {
    const lightwell::Device device;
    const bool half = GENERATE(true, false);
    for (const double offset : {1e3, half ? 2e4 : 1e5, half ? 1e3 : 1e8}) {
        const glm::dvec3 origin(offset, 0.0, offset / 2);
        DrawnFrame f;
        f.positionFormat = half ? LW_FORMAT_HALF4 : LW_FORMAT_FLOAT3;
        DrawnFrame::furnish(f, origin);
        f.lights.push_back(
            DrawnLight::spot(origin + glm::dvec3(2, 4.5, 1), origin + glm::dvec3(-0.5, 1, -1), 50));
        TestCamera camera = insideCamera();
        camera.eye += origin;
        f.draw(camera, kWidth, kHeight);
        INFO("offset " << offset);
        if (offset < 1e8)
            expectClean(check(device, f));
        else
            expectOne(check(device, f), "far-from-origin", "gbuffer.position", LW_SEVERITY_WARNING);
    }
}

TEST_CASE("flux of dark, black and unreached surfaces is told from flux never drawn", "[check]") {
    const lightwell::Device device;
    const auto drawn = [](double albedo, std::uint32_t rsmSize) {
        DrawnFrame f;
        DrawnFrame::furnish(f, glm::dvec3(0.0), albedo);
        f.lights.push_back(spotLight());
        f.rsmSize = rsmSize;
        f.draw(insideCamera(), kWidth, kHeight);
        return f;
    };
    for (const double albedo : {0.02, 0.04, 1.0})
        for (const std::uint32_t size : {8u, 16u}) {
            DrawnFrame f = drawn(albedo, size);
            f.gbuffer.albedo = LWImage{};
            INFO(albedo << ", " << size);
            expectClean(check(device, f));
        }
    expectClean(check(device, drawn(0.0, 64)));
    DrawnFrame empty = drawn(0.8, 64);
    HostImage& flux = empty.lights[0].images[2];
    for (std::uint32_t y = 0; y < 64; ++y)
        for (std::uint32_t x = 0; x < 64; ++x) flux.set(x, y, 0, 0, 0);
    expectOne(check(device, empty), "rsm-empty", "frame.lights[0].rsms", LW_SEVERITY_ERROR);
    empty.gbuffer.albedo = LWImage{};  // for all it says everything may be black
    expectOne(check(device, empty), "rsm-empty", "frame.lights[0].rsms", LW_SEVERITY_WARNING);
    // A cone that passes above the floor which the map shows.
    DrawnFrame above;
    addBox(above.walls, {-4, -1, -4}, {4, 0, 4}, false, glm::dvec3(0.8));
    above.lights.push_back(DrawnLight::spot({0, 3, 0}, {0, 3, -5}, 50, 0.3));
    above.lights[0].cameras[0] = lookingAt({0, 3, 0}, {0, 3, -5}, 1.5, 1.5);
    above.draw(lookingAt({0, 3, 4}, {0, 0, -2}, 0.9, 0.5), kWidth, kHeight);
    expectOne(check(device, above), "rsm-empty", "frame.lights[0].rsms", LW_SEVERITY_NOTE);
}

TEST_CASE("every kind of depth is found when it is called another, with and without an RSM", "[check]") {
    const lightwell::Device device;
    const bool lit = GENERATE(true, false);
    for (const LWDepthKind kind : {LW_DEPTH_ZERO_TO_ONE, LW_DEPTH_GL, LW_DEPTH_AXIAL, LW_DEPTH_RADIAL}) {
        DrawnFrame f = spotRoom();
        if (!lit) f.lights.clear();
        f.useDepth = true;
        f.depthKind = kind;
        TestCamera camera = insideCamera();
        camera.openGL = kind == LW_DEPTH_GL;
        f.draw(camera, kWidth, kHeight);
        for (const LWDepthKind called :
             {LW_DEPTH_ZERO_TO_ONE, LW_DEPTH_GL, LW_DEPTH_AXIAL, LW_DEPTH_RADIAL}) {
            f.gbuffer.depthKind = called;
            const auto findings = check(device, f);
            INFO(kind << " called " << called << ":\n" << describe(findings));
            // Both keep planes planes: only an RSM tells them apart.
            const bool alike = kind <= LW_DEPTH_GL && called <= LW_DEPTH_GL;
            if (kind == called || (alike && !lit)) {
                expectClean(findings);
            } else {
                expectOne(findings, "depth-kind", "gbuffer.depth", LW_SEVERITY_ERROR);
            }
        }
    }
}

TEST_CASE("a depth that leads nowhere is told even when no guess fits", "[check]") {
    const lightwell::Device device;
    DrawnFrame f = spotRoom();
    f.useDepth = true;
    f.draw(insideCamera(), kWidth, kHeight);
    eachPixel(f,
              [&](auto x, auto y) { f.depth.set(x, y, -5.0 - 0.37 * double((x * 7 + y * 13) % 11)); });
    f.gbuffer.depthKind = LW_DEPTH_AXIAL;
    expectOne(check(device, f), "no-surfaces", "gbuffer.depth", LW_SEVERITY_ERROR);
}

TEST_CASE("a wrong depth is told once, however many lights show it", "[check]") {
    const lightwell::Device device;
    DrawnFrame f = spotRoom();
    f.lights.push_back(DrawnLight::lamp({-2, 3, 2}, 20));
    f.lights.push_back(DrawnLight::spot({-2, 4.5, 1}, {0.5, 1, -1}, 50));
    f.useDepth = true;
    f.depthKind = LW_DEPTH_GL;
    TestCamera camera = insideCamera();
    camera.openGL = true;
    f.draw(camera, kWidth, kHeight);
    f.gbuffer.depthKind = LW_DEPTH_ZERO_TO_ONE;
    expectOne(check(device, f), "depth-kind", "gbuffer.depth", LW_SEVERITY_ERROR);
}

TEST_CASE("missing normals are found beside depth, and not where the depth is the background's",
          "[check]") {
    const lightwell::Device device;
    DrawnFrame f;
    addBox(f.walls, {-4, -1, -4}, {4, 0, 4}, false, glm::dvec3(0.5));
    f.useDepth = true;
    TestCamera camera = lookingAt({0, 3, 4}, {0, 0, -2}, 0.9, 0.7);
    camera.reversed = GENERATE(false, true);
    f.draw(camera, kWidth, kHeight);
    expectClean(check(device, f));
    eachPixel(f, [&](auto x, auto y) {
        if (y > 60) f.normal.set(x, y, 0, 0, 0);
    });
    expectOne(check(device, f), "normal-missing", "gbuffer.normal", LW_SEVERITY_WARNING);
}

TEST_CASE("numbers that are none, too large or never drawn are told once each", "[check]") {
    const lightwell::Device device;
    const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
    DrawnFrame f = spotRoom();
    f.lights.clear();
    const auto redraw = [&] { f.draw(insideCamera(), kWidth, kHeight); };
    redraw();
    f.direct.set(3, 5, -infinite, 0, 0);
    expectOne(check(device, f), "not-finite", "gbuffer.directRadiance", LW_SEVERITY_ERROR);
    redraw();
    f.albedo.set(3, 5, infinite, 0, 0);
    expectOne(check(device, f), "not-finite", "gbuffer.albedo", LW_SEVERITY_ERROR);
    redraw();
    f.position.set(3, 5, 0, 2e9, 0);
    expectOne(check(device, f), "not-finite", "gbuffer.position", LW_SEVERITY_ERROR);
    redraw();
    HostImage roughness(LW_FORMAT_FLOAT1, kWidth, kHeight);
    eachPixel(f, [&](auto x, auto y) { roughness.set(x, y, x == 7 ? nan : 0.5); });
    f.gbuffer.roughness = roughness.image();
    expectOne(check(device, f), "not-finite", "gbuffer.roughness", LW_SEVERITY_ERROR);
    redraw();
    eachPixel(f, [&](auto x, auto y) { f.position.set(x, y, 0, 0, 0); });
    const auto zero = check(device, f);
    expectOne(zero, "position-camera", "gbuffer.position", LW_SEVERITY_ERROR);
    CHECK_THAT(zero[0].message, Contains("every position is 0 0 0"));
    redraw();
    for (HostImage* image : {&f.position, &f.normal, &f.albedo, &f.direct, &f.motion})
        eachPixel(f, [&](auto x, auto y) { image->set(x, y, nan, infinite, -infinite); });
    CHECK(check(device, f).size() == 5);
    for (HostImage* image : {&f.position, &f.normal, &f.albedo, &f.direct, &f.motion})
        eachPixel(f, [&](auto x, auto y) { image->set(x, y, 3e38, -3e38, 3e38); });
    CHECK_FALSE(check(device, f).empty());
}

TEST_CASE("normals that Lightwell refuses are an error, those that it brings to unit length a warning",
          "[check]") {
    const lightwell::Device device;
    const double length = GENERATE(0.8, 0.4, 2.5);
    DrawnFrame f = spotRoom();
    f.draw(insideCamera(), kWidth, kHeight);
    eachPixel(f, [&](auto x, auto y) {
        f.normal.set(x, y, length * f.normal.value(x, y, 0), length * f.normal.value(x, y, 1),
                     length * f.normal.value(x, y, 2));
    });
    expectOne(check(device, f), "normal-length", "gbuffer.normal",
              length == 0.8 ? LW_SEVERITY_WARNING : LW_SEVERITY_ERROR);
    // The picture is the same or dark, as the message says.
    const lightwell::View view(device, kWidth, kHeight);
    lightwell::Technique technique(device, "rsm");
    HostImage irradiance(LW_FORMAT_FLOAT3, kWidth, kHeight);
    auto output = lightwell::make<LWOutput>();
    output.irradiance = irradiance.image();
    technique.update(f.frame);
    technique.render(view, f.gbuffer, output);
    lightwell::check(lwFinish(device.get()), device.get());
    CHECK((irradiance.value(80, 45, 0) > 0.0) == (length == 0.8));
}

TEST_CASE("a lamp's camera is checked without a G-buffer, and once for several views", "[check]") {
    const lightwell::Device device;
    DrawnFrame f = spotRoom(), other = spotRoom();
    f.draw(insideCamera(), kWidth, kHeight);
    other.draw(lookingAt({1, 2.5, 3.5}, {0.5, 1.5, -3}, 0.9, 0.5), 320, 180);
    f.lights[0].light.position[0] = -3.0f;
    f.describeLights();
    const lightwell::View view(device, kWidth, kHeight), otherView(device, 320, 180);
    expectOne(check(view, &f.frame, nullptr), "light-camera", "frame.lights[0].position",
              LW_SEVERITY_WARNING);
    const LWSourceView source{otherView.get(), &other.gbuffer};
    f.frame.sourceViews = &source;
    f.frame.sourceViewCount = 1;
    expectOne(check(view, &f.frame, &f.gbuffer), "light-camera", "frame.lights[0].position",
              LW_SEVERITY_WARNING);
}

TEST_CASE("source views are told apart, and only the view's own faults are in the overlay", "[check]") {
    const lightwell::Device device;
    DrawnFrame f = spotRoom(), other = spotRoom();
    f.draw(insideCamera(), kWidth, kHeight);
    other.draw(insideCamera(), 320, 180);
    eachPixel(other, [&](auto x, auto y) { other.albedo.set(x, y, -1, 0, 0); });
    const lightwell::View view(device, kWidth, kHeight), otherView(device, 320, 180);
    LWSourceView source{otherView.get(), &other.gbuffer};
    f.frame.sourceViews = &source;
    f.frame.sourceViewCount = 1;
    HostImage overlay(LW_FORMAT_FLOAT3, kWidth, kHeight);
    LWImage image = overlay.image();
    expectOne(check(view, &f.frame, &f.gbuffer, &image), "negative",
              "frame.sourceViews[0].gbuffer.albedo", LW_SEVERITY_ERROR);
    bool grey = true;
    eachPixel(f, [&](auto x, auto y) {
        for (int c : {1, 2}) grey = grey && overlay.value(x, y, c) == overlay.value(x, y, 0);
    });
    CHECK(grey);

    // The view itself, with normals from the same address and another albedo, is another G-buffer.
    LWGBuffer twin = f.gbuffer;
    HostImage albedo(LW_FORMAT_FLOAT3, kWidth, kHeight);
    eachPixel(f, [&](auto x, auto y) { albedo.set(x, y, -1, 0, 0); });
    twin.albedo = albedo.image();
    source = {view.get(), &twin};
    expectOne(check(view, &f.frame, &f.gbuffer), "negative", "frame.sourceViews[0].gbuffer.albedo",
              LW_SEVERITY_ERROR);

    // An image of which nothing is set is none.
    f.frame.sourceViewCount = 0;
    image = LWImage{};
    expectClean(check(view, &f.frame, &f.gbuffer, &image));
}
