// Technique horizon through the C API: closed forms of ambient occlusion at several angles of view, Lambert's polygon for
// the bounce, the furnace, and what a host relies on.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "techniques/screen_rig.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::uint32_t kWidth = 160, kHeight = 120;

LWHorizonDesc descOf(std::uint32_t directions, std::uint32_t steps, LWResolution resolution = LW_RESOLUTION_FULL) {
    LWHorizonDesc desc;
    lwDefaultHorizon(&desc);
    desc.directions = directions;
    desc.steps = steps;
    desc.interleave = 1;
    desc.resolution = resolution;
    return desc;
}
// The parameters' limit: walls have no back that is seen.
LWHorizonDesc limit() {
    LWHorizonDesc desc = descOf(40, 8);
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
// Light: a coarse texel that its emitter covers in part counts as covered whole, so emitters before nothing grow by up to
// half a texel: by 1/16 of their distance at 8 steps to a doubling, 1/4 at 2 (docs/techniques/horizon.md, "Where it fails").
constexpr double kPolygon = 0.08, kPolygonMean = 0.05, kUsual = 0.3;
// Sums of positive numbers in float, in another order.
constexpr double kRounding = 2e-5;

double rootMeanSquare(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0.0, mean = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        sum += std::pow(double(a[i]) - double(b[i]), 2.0);
        mean += double(b[i]);
    }
    return std::sqrt(sum / double(a.size())) / (mean / double(a.size()));
}
double meanOf(const std::vector<float>& values) {
    double sum = 0.0;
    for (const float v : values) sum += double(v);
    return sum / double(values.size());
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

// A lit floor patch and the wall over its far edge, all in view.
ViewScene litScene(double radiance = 1.0) {
    ViewScene scene;
    scene.quad({-0.5, 0, 0}, {1, 0, 0}, {0, 0, 1}, radiance);
    scene.quad({-0.5, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.0);
    return scene;
}

}  // namespace

TEST_CASE("an infinite wall with a range limit has its closed form at every angle of view", "[horizon]") {
    TestDevice device(GENERATE(1u, 16u));
    const TestCamera camera = kViews[GENERATE(0, 1, 2)];
    const bool uniform = GENERATE(false, true);
    ViewScene scene = wallScene();
    DrawnView drawn(scene, camera, kWidth, kHeight);
    LWHorizonDesc desc = limit();
    desc.ambientRadius = 0.25f;
    desc.weighting = uniform ? LW_AMBIENT_UNIFORM : LW_AMBIENT_COSINE;
    const auto ambient = renderScreen(device, "horizon", &desc, drawn, kAmbient).ambient;
    double sum = 0.0, worst = 0.0;
    int count = 0;
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = 0; x < kWidth; ++x) {
            const Vec p = drawn.position.get(x, y), n = drawn.normal.get(x, y);
            const double range = 0.25 * imageHeight(camera) * depthOf(camera, p), t = p.x / range;
            // Floor, with all that its radius holds in the picture: the wall at most so far up and to either side.
            if (n.y < 0.5 || t > 0.9 || t < 0.03 || x < kWidth / 3 || x > 2 * kWidth / 3 || y < 35 || y > kHeight - 35) continue;
            const double root = std::sqrt(1.0 - t * t);
            const double truth = uniform ? 0.5 * (1.0 + t) : 1.0 - (std::acos(t) - t * root) / kPi;
            const double error = double(ambient[y * kWidth + x]) - truth;
            sum += error;
            worst = std::max(worst, std::abs(error));
            ++count;
        }
    CAPTURE(count, uniform, sum / count, worst);
    REQUIRE(count > 100);
    CHECK(std::abs(sum / count) < kClosedFormMean);
    CHECK(worst < 2.0 * kClosedForm);
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
    const auto ambient = renderScreen(device, "horizon", &desc, open, kAmbient).ambient;
    for (std::uint32_t i = 0; i < kWidth * kHeight; ++i)
        if (open.normal.get(i % kWidth, i / kWidth).y > 0.5) REQUIRE(double(ambient[i]) == Approx(1.0).margin(1e-6));

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
    const auto error = [&](const LWHorizonDesc& desc, double* mean) {
        const auto result = renderScreen(device, "horizon", &desc, drawn);
        double sum = 0.0, square = 0.0, truths = 0.0;
        int count = 0;
        for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
            const Vec p = drawn.position.get(i % kWidth, i / kWidth);
            if (drawn.normal.get(i % kWidth, i / kWidth).z < 0.5 || p.y < 0.04) continue;
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
    double mean = 0.0;
    const double fine = error(limit(), &mean);
    CAPTURE(fine, mean);
    CHECK(fine < kPolygon);
    CHECK(std::abs(mean) < kPolygonMean);
    double usualMean = 0.0;
    LWHorizonDesc usual;
    lwDefaultHorizon(&usual);
    const double coarse = error(usual, &usualMean);
    CAPTURE(coarse, usualMean);
    CHECK(coarse < kUsual);
    CHECK(std::abs(usualMean) < kUsual);
    CHECK(std::abs(mean) < 0.5 * std::abs(usualMean));
}

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
    const LWHorizonDesc desc = descOf(8, 2);
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
    CHECK(rootMeanSquare(other.irradiance, first.irradiance) < kRounding);
    for (const double scale : {8.0, 1.0 / 1024.0, 1000.0}) {
        DrawnView scaled(litScene(), camera, 93, 61, scale);
        CAPTURE(scale);
        // A factor that is no power of two moves single sector borders.
        CHECK(rootMeanSquare(renderScreen(wide, "horizon", &desc, scaled).irradiance, first.irradiance) < 5e-3);
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
    LWHorizonDesc desc = descOf(8, 2);
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
        LWHorizonDesc bad = descOf(directions, 2);
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
