// Technique ao through the C API: closed forms of ambient occlusion, the bounce's order of size, and refusals.
#include <catch2/catch.hpp>
#include <cmath>

#include "techniques/screen_rig.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::uint32_t kWidth = 160, kHeight = 120;

// 64 points in each of 16 rotations. The depth bias of 1 % of the radius lets so much of every surface's skin pass, half as
// much of the hemisphere for a wall that faces the eye and more for a slanting one.
constexpr double kMean = 0.02;
// Of a region's light: points of one pattern instead of the integral, pixels instead of places.
constexpr double kEstimator = 0.05;

// The estimator as an integral over the points' directions, the view replaced by rays: every hidden point is a disc
// of area pi R^2 / N at the place that hides it, N of them in all, by the bounded point-to-disc term.
double expectedLight(const ViewScene& scene, const TestCamera& camera, const glm::dvec3& p, const glm::dvec3& n, double radius,
                     std::uint32_t points) {
    constexpr int kSteps = 24;
    const double range = radius * (camera.top - camera.bottom) * glm::dot(p - camera.eye, camera.forward);
    const double disc = range * range / points;  // area over pi
    const glm::dvec3 t = glm::normalize(glm::cross(n, std::abs(n.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    const glm::dvec3 b = glm::cross(n, t);
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
            const double u = (i + 0.5) / kSteps, r = std::sqrt(u), angle = 2.0 * kPi * (j + 0.5) / kSteps;
            const glm::dvec3 point = p + range * (r * std::cos(angle) * t + r * std::sin(angle) * b + std::sqrt(1.0 - u) * n);
            const double depth = glm::dot(point - camera.eye, camera.forward);
            const glm::dvec3 ray = (point - camera.eye) / depth;
            const double x = glm::dot(ray, camera.right), y = glm::dot(ray, camera.up);
            const ViewScene::Hit hit = scene.cast(camera.eye, glm::normalize(ray));
            if (!hit || x < camera.left || x > camera.rightEdge || y < camera.bottom || y > camera.top) continue;
            const double before = depth - glm::dot(hit.position - camera.eye, camera.forward);
            if (before < 0.01 * range || before > range) continue;
            const glm::dvec3 d = hit.position - p;
            const double d2 = glm::dot(d, d), receiver = glm::dot(d, n) / std::sqrt(d2), sender = -glm::dot(d, hit.normal) / std::sqrt(d2);
            if (receiver <= 0.0 || sender <= 0.0) continue;
            sum += hit.radiance * sender * receiver / (d2 + 0.25 * (1.0 + 3.0 * sender * sender) * disc);
        }
    return kPi * range * range * sum / (kSteps * kSteps);
}

}  // namespace

TEST_CASE("points at the radius have the closed forms of an infinite wall", "[ao]") {
    TestDevice device(GENERATE(1u, 16u));
    const bool uniform = GENERATE(false, true);
    const TestCamera camera = lookAt({2.0, 1.0, 0.3}, {0.5, 0.2, 0.0}, 0.5);
    ViewScene scene;
    scene.quad({0, 0, -20}, {40, 0, 0}, {0, 0, 40}, 0.0);
    scene.quad({0, 0, -20}, {0, 20, 0}, {0, 0, 40}, 0.0);
    DrawnView drawn(scene, camera, kWidth, kHeight);
    LWAoDesc desc;
    lwDefaultAo(&desc);
    desc.method = LW_AO_SSAO;
    desc.samples = 64;
    desc.radius = 0.25f;
    desc.packing = 0;
    desc.rangeCheck = 0;
    desc.resolution = LW_RESOLUTION_FULL;
    desc.weighting = uniform ? LW_AMBIENT_UNIFORM : LW_AMBIENT_COSINE;
    const auto ambient = renderScreen(device, "ao", &desc, drawn, kAmbient).ambient;
    double sum = 0.0, worst = 0.0;
    int count = 0;
    for (std::uint32_t y = 35; y < kHeight - 35; ++y)
        for (std::uint32_t x = kWidth / 3; x < 2 * kWidth / 3; ++x) {
            const Vec p = drawn.position.get(x, y);
            const double depth = glm::dot(glm::dvec3(p.x, p.y, p.z) - camera.eye, camera.forward);
            const double t = p.x / (0.25 * depth);
            if (drawn.normal.get(x, y).y < 0.5 || t > 0.9 || t < 0.1) continue;
            const double truth = uniform ? 0.5 * (1.0 + t) : 1.0 - (std::acos(t) - t * std::sqrt(1.0 - t * t)) / kPi;
            const double error = double(ambient[y * kWidth + x]) - truth;
            sum += error;
            worst = std::max(worst, std::abs(error));
            ++count;
        }
    CAPTURE(count, uniform, sum / count, worst);
    REQUIRE(count > 100);
    CHECK(std::abs(sum / count) < kMean);
    CHECK(worst < 0.15);  // of one rotation's 64 points
}

TEST_CASE("ssdo's light is its estimator's, none where nothing occludes", "[ao]") {
    TestDevice device(GENERATE(1u, 16u));
    const ViewScene scene = litScene(2.0);
    const TestCamera camera = lookAt({0.7, 1.4, 2.4}, {0, 0.4, 0.3}, 0.42);
    DrawnView drawn(scene, camera, kWidth, kHeight);
    LWAoDesc desc;
    lwDefaultAo(&desc);
    desc.samples = 64;
    desc.packing = 0;
    desc.radius = GENERATE(0.2f, 0.5f);
    desc.resolution = LW_RESOLUTION_FULL;
    const auto result = renderScreen(device, "ao", &desc, drawn);
    double got = 0.0, expected = 0.0;
    for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
        const Vec p = drawn.position.get(i % kWidth, i / kWidth), n = drawn.normal.get(i % kWidth, i / kWidth);
        REQUIRE(result.validity[i] + result.ambient[i] <= 1.0f + 1e-5f);  // what is seen hides
        if (n.x == 0.0 && n.y == 0.0 && n.z == 0.0) REQUIRE(result.irradiance[i] + result.validity[i] + result.ambient[i] == 0.0f);
        if (n.z < 0.5 || p.y < 0.05 || p.y > 0.3) continue;
        got += double(result.irradiance[i]);
        expected += expectedLight(scene, camera, {p.x, p.y, p.z}, {n.x, n.y, n.z}, double(desc.radius), desc.samples);
    }
    CAPTURE(got / expected, expected);
    CHECK(got == Approx(expected).epsilon(kEstimator));
    const auto again = renderScreen(device, "ao", &desc, drawn);
    CHECK(again.irradiance == result.irradiance);
}

TEST_CASE("ssao makes no light and says so", "[ao]") {
    TestDevice device(16);
    ViewScene scene;
    scene.quad({-0.5, 0, 0}, {1, 0, 0}, {0, 0, 1}, 2.0);
    DrawnView drawn(scene, lookAt({0.7, 1.4, 2.4}, {0, 0.4, 0.3}, 0.42), 32, 24);
    LWAoDesc desc;
    lwDefaultAo(&desc);
    desc.method = LW_AO_SSAO;
    TestTechnique technique(device, "ao", &desc);
    TestView view(device, 32, 24);
    LWFrame frame{};
    frame.structSize = sizeof frame;
    technique.update(frame);
    PlanarPixels colour(32, 24, 3);
    LWOutput output{};
    output.structSize = sizeof output;
    output.irradiance = colour.image();
    CHECK(lwRender(technique, view, &drawn.gbuffer, &output) == LW_ERROR_UNSUPPORTED);
    CHECK(lastError(device).find("ssao") != std::string::npos);
    desc.samples = 3;
    LWTechnique none = nullptr;
    CHECK(lwCreateAo(device, &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("samples") != std::string::npos);
}
