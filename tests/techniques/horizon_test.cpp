// Technique horizon through the C API: closed forms of ambient occlusion at several angles of view, and Lambert's polygon
// for the bounce. What a host relies on: horizon_host_test.cpp.
#include <catch2/catch.hpp>
#include <cmath>

#include "techniques/screen_rig.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::uint32_t kWidth = 160, kHeight = 120;

// The parameters' limit: walls have no back that is seen.
LWHorizonDesc limit() {
    LWHorizonDesc desc = horizonDesc(40, 8);
    desc.reach = 4.0f;
    desc.thickness = 10.0f;
    return desc;
}

// A floor, and a wall along x = 0 that stands on it, both far larger than any radius here.
ViewScene wallScene(double height = 20.0) {
    ViewScene scene;
    scene.quad({0, 0, -20}, {40, 0, 0}, {0, 0, 40}, 0.0);
    scene.quad({0, 0, -20}, {0, height, 0}, {0, 0, 40}, 0.0);
    return scene;
}

double imageHeight(const TestCamera& camera) { return camera.top - camera.bottom; }

double depthOf(const TestCamera& camera, Vec p) { return glm::dot(glm::dvec3(p.x, p.y, p.z) - camera.eye, camera.forward); }

const TestCamera kViews[] = {lookAt({2.0, 1.0, 0.3}, {0.5, 0.2, 0.0}, 0.5), lookAt({1.5, 2.0, 1.5}, {0.4, 0.0, 0.0}, 0.4),
                             lookAt({2.5, 0.5, -1.5}, {0.4, 0.1, 0.2}, 0.4)};

// Steps are 1/8 of their distance apart and 40 slices wide; sectors are 1/32 of a slice.
constexpr double kClosedForm = 0.03, kClosedFormMean = 0.012;
// Within 8 pixels of the wall, of which the steps leave out half of one: 0.003, 0.018 and 0.008 in the three views, and the same at
// 8 to 48 directions to within 0.003. (With stretches that begin at half of a line's vector: up to 0.052, and 0.026 to 0.036 apart.)
constexpr double kContactMean = 0.022, kContactSpread = 0.005;
// Light: a step covers its stretch of the line whole or not at all, 1/8 of its distance at 8 steps to a doubling and 1/2 at
// 2, and a texel is one pixel of its block; both are right in the mean and differ from pixel to pixel.
constexpr double kPolygon = 0.07, kPolygonMean = 0.03, kUsual = 0.1, kUsualMean = 0.03;

struct WallError {
    double mean = 0.0, worst = 0.0;
    int count = 0;
};

// On the floor before an infinite wall, from `nearest` to `farthest` of the radius away from it.
WallError wallError(LWDevice device, const TestCamera& camera, LWHorizonDesc desc, bool uniform, double nearest, double farthest) {
    ViewScene scene = wallScene();
    DrawnView drawn(scene, camera, kWidth, kHeight);
    desc.ambientRadius = 0.25f;
    desc.weighting = uniform ? LW_AMBIENT_UNIFORM : LW_AMBIENT_COSINE;
    const auto ambient = renderScreen(device, "horizon", &desc, drawn, kAmbient).ambient;
    WallError result;
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = 0; x < kWidth; ++x) {
            const Vec p = drawn.position.get(x, y), n = drawn.normal.get(x, y);
            const double range = 0.25 * imageHeight(camera) * depthOf(camera, p), t = p.x / range;
            // Floor, with all that its radius holds in the picture: the wall at most so far up and to either side.
            if (n.y < 0.5 || t > farthest || t < nearest || x < kWidth / 3 || x > 2 * kWidth / 3 || y < 35 || y > kHeight - 35) continue;
            const double root = std::sqrt(1.0 - t * t);
            const double truth = uniform ? 0.5 * (1.0 + t) : 1.0 - (std::acos(t) - t * root) / kPi;
            const double error = double(ambient[y * kWidth + x]) - truth;
            result.mean += error;
            result.worst = std::max(result.worst, std::abs(error));
            ++result.count;
        }
    result.mean /= std::max(result.count, 1);
    return result;
}

// By rays: the share of a floor point's hemisphere that meets nothing the picture shows.
double openShare(const ViewScene& scene, const TestCamera& camera, const glm::dvec3& p, bool uniform) {
    constexpr int kRays = 96;
    int open = 0;
    for (int i = 0; i < kRays; ++i)
        for (int j = 0; j < kRays; ++j) {
            const double u = (i + 0.5) / kRays, y = uniform ? u : std::sqrt(u), r = std::sqrt(1.0 - y * y);
            const double angle = 2.0 * kPi * (j + 0.5) / kRays;
            const glm::dvec3 d(r * std::cos(angle), y, r * std::sin(angle));
            const ViewScene::Hit hit = scene.cast(p + glm::dvec3(0, 1e-6, 0), d);
            const glm::dvec3 q = hit.position - camera.eye;
            const double z = glm::dot(q, camera.forward);
            const double a = glm::dot(q, camera.right) / z, b = glm::dot(q, camera.up) / z;
            if (!hit || z <= 0.0 || a < camera.left || a > camera.rightEdge || b < camera.bottom || b > camera.top) ++open;
        }
    return double(open) / (kRays * kRays);
}

}  // namespace

TEST_CASE("an infinite wall with a range limit has its closed form at every angle of view", "[horizon]") {
    TestDevice device(GENERATE(1u, 16u));
    const TestCamera camera = kViews[GENERATE(0, 1, 2)];
    const bool uniform = GENERATE(false, true);
    const WallError error = wallError(device, camera, limit(), uniform, 0.03, 0.9);
    CAPTURE(error.count, uniform, error.mean, error.worst);
    REQUIRE(error.count > 100);
    CHECK(std::abs(error.mean) < kClosedFormMean);
    CHECK(error.worst < 2.0 * kClosedForm);
}

// Vectors of lines grow with their number: what a line leaves out before its first step must not.
TEST_CASE("contacts are as dark at many directions as at few", "[horizon]") {
    TestDevice device(16);
    const TestCamera camera = kViews[GENERATE(0, 1, 2)];
    double least = 1.0, most = -1.0;
    for (const std::uint32_t directions : {8u, 16u, 24u, 40u, 48u}) {
        LWHorizonDesc desc = limit();
        desc.directions = directions;
        desc.thickness = 0.0f;  // backs would hide what fronts leave out
        const WallError error = wallError(device, camera, desc, false, 0.03, 0.25);  // up to 8 pixels from the wall
        CAPTURE(directions, error.count, error.mean, error.worst);
        REQUIRE(error.count > 30);
        CHECK(std::abs(error.mean) < kContactMean);
        least = std::min(least, error.mean);
        most = std::max(most, error.mean);
    }
    CHECK(most - least < kContactSpread);
}

TEST_CASE("an open plane is open, a corner a quarter", "[horizon]") {
    TestDevice device(16);
    const TestCamera camera = kViews[GENERATE(0, 1, 2)];
    const bool uniform = GENERATE(false, true);
    LWHorizonDesc desc = limit();
    desc.weighting = uniform ? LW_AMBIENT_UNIFORM : LW_AMBIENT_COSINE;
    ViewScene plane;
    plane.quad({-20, 0, -20}, {40, 0, 0}, {0, 0, 40}, 0.0);
    DrawnView open(plane, camera, kWidth, kHeight);
    for (const std::uint32_t directions : {8u, 24u, 40u, 48u}) {
        desc.directions = directions;
        const auto ambient = renderScreen(device, "horizon", &desc, open, kAmbient).ambient;
        for (std::uint32_t i = 0; i < kWidth * kHeight; ++i)
            if (open.normal.get(i % kWidth, i / kWidth).y > 0.5) REQUIRE(double(ambient[i]) == Approx(1.0).margin(1e-6));
    }
    desc.directions = 40;

    ViewScene corner = wallScene();
    corner.quad({0, 0, -0.2}, {40, 0, 0}, {0, 20, 0}, 0.0);
    const TestCamera close = lookAt({1.0, 0.8, 1.0}, {0.05, 0.03, -0.15}, 0.15);
    DrawnView drawn(corner, close, kWidth, kHeight);
    desc.ambientRadius = 1.0f;
    const auto quarter = renderScreen(device, "horizon", &desc, drawn, kAmbient).ambient;
    double sum = 0.0, truth = 0.0;
    int count = 0;
    for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
        const Vec p = drawn.position.get(i % kWidth, i / kWidth);
        if (drawn.normal.get(i % kWidth, i / kWidth).y < 0.5 || p.x > 0.03 || p.z > -0.17 || p.x < 0.006 || p.z < -0.194) continue;
        sum += double(quarter[i]);
        truth += openShare(corner, close, glm::dvec3(p.x, p.y, p.z), uniform);
        ++count;
    }
    CAPTURE(count, uniform, truth / count);
    REQUIRE(count > 5);
    CHECK(truth / count == Approx(0.25).margin(0.04));  // what the picture shows of the corner is nearly all of it
    CHECK(sum / count == Approx(truth / count).margin(kClosedFormMean));
}

TEST_CASE("a finite wall hides its form factor, a sphere its own", "[horizon]") {
    TestDevice device(16);
    LWHorizonDesc desc = limit();
    desc.ambientRadius = 1000.0f;
    const TestCamera camera = lookAt({1.6, 1.3, 2.6}, {0, 0.35, 0.4}, 0.45);
    DrawnView drawn(litScene(), camera, kWidth, kHeight);
    const auto ambient = renderScreen(device, "horizon", &desc, drawn, kAmbient).ambient;
    const std::vector<Vec> wall = {{-0.5, 0, 0}, {0.5, 0, 0}, {0.5, 1, 0}, {-0.5, 1, 0}};
    double sum = 0.0, square = 0.0;
    int count = 0;
    for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
        const Vec p = drawn.position.get(i % kWidth, i / kWidth), n = drawn.normal.get(i % kWidth, i / kWidth);
        if (n.y < 0.5 || p.z < 0.05) continue;
        const double error = double(ambient[i]) - (1.0 - polygonIrradiance(wall, p, {0, 1, 0}, 1.0));
        sum += error;
        square += error * error;
        ++count;
    }
    CAPTURE(count, sum / count, square / count);
    REQUIRE(count > 500);
    CHECK(std::abs(sum / count) < kClosedFormMean);
    CHECK(std::sqrt(square / count) < kClosedForm);  // pixels beside the wall's free edges: half a step in or out

    // The view shows half of a sphere; a thickness of its radius or so stands for the rest.
    ViewScene ball;
    ball.quad({-20, 0, -20}, {40, 0, 0}, {0, 0, 40}, 0.0);
    ball.spheres.push_back({{0, 0.5, 0}, 0.3, 0.0});
    const TestCamera above = lookAt({0.4, 2.6, 1.6}, {0, 0.1, 0}, 0.5);
    DrawnView sphere(ball, above, kWidth, kHeight);
    desc.thickness = 0.15f;  // of an image height of 3
    const auto shadow = renderScreen(device, "horizon", &desc, sphere, kAmbient).ambient;
    sum = 0.0;
    count = 0;
    for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
        const Vec p = sphere.position.get(i % kWidth, i / kWidth);
        if (p.y != 0.0 || sphere.normal.get(i % kWidth, i / kWidth).y < 0.5) continue;
        const double d = std::sqrt(p.x * p.x + 0.25 + p.z * p.z);
        if (d > 1.2) continue;
        sum += double(shadow[i]) - (1.0 - 0.3 * 0.3 / (d * d) * 0.5 / d);
        ++count;
    }
    CAPTURE(count, sum / count);
    REQUIRE(count > 500);
    // One thickness for all of it is too much at the rim and too little in the middle.
    CHECK(std::abs(sum / count) < 0.03);
}

TEST_CASE("a lit floor lights the wall as Lambert's polygon does", "[horizon]") {
    TestDevice device(GENERATE(1u, 16u));
    const TestCamera camera = lookAt({0.7, 1.4, 2.4}, {0, 0.4, 0.3}, 0.42);
    DrawnView drawn(litScene(2.0), camera, kWidth, kHeight);
    const std::vector<Vec> floor = {{-0.5, 0, 0}, {0.5, 0, 0}, {0.5, 0, 1}, {-0.5, 0, 1}};
    const auto errorIn = [&](DrawnView& view, const LWHorizonDesc& desc, double* mean) {
        const std::uint32_t width = view.position.width();
        const auto result = renderScreen(device, "horizon", &desc, view);
        double sum = 0.0, square = 0.0, truths = 0.0;
        int count = 0;
        for (std::uint32_t i = 0; i < width * view.position.height(); ++i) {
            const Vec p = view.position.get(i % width, i / width);
            if (view.normal.get(i % width, i / width).z < 0.5 || p.y < 0.04) continue;
            const double truth = polygonIrradiance(floor, p, {0, 0, 1}, 2.0 * kPi);
            const double got = double(result.irradiance[i]);
            // All of the light comes from the seen share, at one radiance.
            CHECK(got == Approx(2.0 * kPi * double(result.validity[i])).epsilon(1e-4).margin(1e-6));
            sum += got - truth;
            square += (got - truth) * (got - truth);
            truths += truth;
            ++count;
        }
        REQUIRE(count > 1000);
        *mean = sum / truths;
        return std::sqrt(square / count) / (truths / count);
    };
    const auto error = [&](const LWHorizonDesc& desc, double* mean) { return errorIn(drawn, desc, mean); };
    double mean = 0.0;
    const double fine = error(limit(), &mean);
    CAPTURE(fine, mean);
    CHECK(fine < kPolygon);
    CHECK(std::abs(mean) < kPolygonMean);
    double usualMean = 0.0;
    LWHorizonDesc usual;
    lwDefaultHorizon(&usual);
    // The filter's window is 9 half-resolution rows: a seventh of this picture, which takes the contact's light away.
    const double blurred = error(usual, &usualMean);
    CAPTURE(blurred, usualMean);
    CHECK(blurred < 0.13);  // 0.12, said on the page
    usual.interleave = 4;
    const double coarse = error(usual, &usualMean);
    CAPTURE(coarse, usualMean);
    CHECK(coarse < kUsual);
    CHECK(std::abs(usualMean) < kUsualMean);
    lwDefaultHorizon(&usual);
    DrawnView large(litScene(2.0), camera, 2 * kWidth, 2 * kHeight);
    const double largeError = errorIn(large, usual, &usualMean);
    CAPTURE(largeError, usualMean);
    CHECK(largeError < kUsual);
    CHECK(std::abs(usualMean) < kUsualMean);
    CHECK(fine < coarse);
}
