// Ambient occlusion and on-screen light of `horizon` and `ao` on real scenes against rays cast through the same scene: at pixels
// of the picture, cosine-distributed directions, hidden where they meet something within the technique's radius; light from what
// they meet if the camera sees that point.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "parallel.h"
#include "support/seen_scene.h"

using namespace lightwell::test;

namespace {

constexpr int kWidth = 320, kHeight = 180, kStride = 3, kRays = 128;
constexpr float kRadius = 0.2f;  // of both techniques by default, in image heights at the pixel's depth

struct Truth {
    double open = 0.0, light = 0.0, noise = 0.0;  // noise: deviation of the mean of `open`
};

Truth truthAt(const SceneView& view, int x, int y) {
    const double radius = double(kRadius) * view.heightAtOne() * view.depthOf(view.pixels.position.rgb(x, y));
    int open = 0;
    double light = 0.0;
    view.castFrom(x, y, kRays, 7, [&](const glm::vec3&, bool meets, const studio::Hit& hit) {
        open += !meets || double(hit.distance) >= radius;
        if (meets && view.seesCamera(hit)) light += view.sentBy(hit) / kRays;
    });
    const double share = double(open) / kRays;
    return {share, light, std::sqrt(share * (1.0 - share) / kRays)};
}

struct Errors {
    double bias = 0.0, mean = 0.0;            // of ambient occlusion: mean of the error and of its absolute value
    double lightBias = 0.0, lightError = 0.0;  // of on-screen irradiance, over its mean: mean, root mean square
    double noise = 0.0;                       // of the truth's ambient occlusion, in the mean
};

Errors errorsOf(const SceneView& view, const std::vector<Truth>& truths, const ScreenResult& result) {
    Errors e;
    double light = 0.0, square = 0.0;
    int count = 0;
    const std::size_t plane = std::size_t(kWidth) * kHeight;
    for (int y = kStride / 2; y < kHeight; y += kStride)
        for (int x = kStride / 2; x < kWidth; x += kStride) {
            if (!view.hasSurface(x, y)) continue;
            const std::size_t i = std::size_t(y) * kWidth + std::size_t(x);
            const Truth& truth = truths[i];
            const double off = double(result.ambient[i]) - truth.open;
            const double lit = double(result.irradiance[i]) + double(result.irradiance[plane + i]) + double(result.irradiance[2 * plane + i]);
            e.bias += off;
            e.mean += std::fabs(off);
            e.noise += truth.noise * std::sqrt(2.0 / 3.14159265358979);
            e.lightBias += lit - truth.light;
            square += (lit - truth.light) * (lit - truth.light);
            light += truth.light;
            ++count;
        }
    REQUIRE(count > 1000);
    e.bias /= count;
    e.mean /= count;
    e.noise /= count;
    e.lightBias /= light;
    e.lightError = std::sqrt(square / count) / (light / count);
    return e;
}

std::vector<Truth> truthsOf(const SceneView& view) {
    std::vector<Truth> truths(std::size_t(kWidth) * kHeight);
    studio::parallelRows(kHeight / kStride, [&](int row) {
        const int y = row * kStride + kStride / 2;
        for (int x = kStride / 2; x < kWidth; x += kStride)
            if (view.hasSurface(x, y)) truths[std::size_t(y) * kWidth + std::size_t(x)] = truthAt(view, x, y);
    });
    return truths;
}

// Of bias and mean error: what was measured and a quarter more, so that a change of the pattern passes and a wrong slice does not.
struct Bounds {
    const char* scene;
    double horizonBias, horizonMean, aoBias, aoMean;
};

void check(const Bounds& bounds) {
    TestDevice device(16);
    const SceneView scene(bounds.scene, kWidth, kHeight);
    const std::vector<Truth> truths = truthsOf(scene);
    TestView view(device, kWidth, kHeight);
    const LWGBuffer gbuffer = scene.gbuffer();
    LWAoDesc ao;
    lwDefaultAo(&ao);
    ao.packing = 0;  // crowded points make a falloff of the distance, which rays do not have
    ao.samples = 64;
    LWHorizonDesc horizon, fine;
    lwDefaultHorizon(&horizon);
    fine = horizon;
    fine.steps = 8;
    fine.directions = 40;
    fine.interleave = 1;
    fine.resolution = LW_RESOLUTION_FULL;
    std::vector<Errors> all;
    for (const auto& [name, desc] : {std::pair<const char*, const void*>{"horizon", &horizon}, {"horizon", &fine}, {"ao", &ao}}) {
        TestTechnique technique(device, name, desc);
        const Errors e = errorsOf(scene, truths, renderScreen(technique, view, device, gbuffer));
        WARN(bounds.scene << ", " << name << (desc == &fine ? " fine" : "") << ": ambient bias " << e.bias << ", mean error " << e.mean
                          << " (noise of the rays " << e.noise << "); light bias " << e.lightBias << ", error " << e.lightError);
        all.push_back(e);
    }
    CHECK(std::fabs(all[0].bias) < bounds.horizonBias);
    CHECK(all[0].mean < bounds.horizonMean);
    CHECK(std::fabs(all[2].bias) < bounds.aoBias);
    CHECK(all[2].mean < bounds.aoMean);
    CHECK(all[0].mean < all[2].mean);
    CHECK(all[0].lightError < all[2].lightError);
}

}  // namespace

TEST_CASE("ambient occlusion is that of cast rays", "[horizon][ao][rays]") {
    check(GENERATE(Bounds{"cornell", 0.038, 0.07, 0.1, 0.12}, Bounds{"rooms", 0.026, 0.041, 0.065, 0.075}));
}

// Needs LIGHTWELL_SCENES: ambient_truth_test "[.scenes]".
TEST_CASE("ambient occlusion of large scenes is that of cast rays", "[horizon][ao][rays][.scenes]") {
    check(GENERATE(Bounds{"sponza_crytek", 0.04, 0.12, 0.14, 0.16}, Bounds{"sibenik", 0.068, 0.11, 0.105, 0.135},
                   Bounds{"living_room", 0.05, 0.107, 0.14, 0.15}));
}
