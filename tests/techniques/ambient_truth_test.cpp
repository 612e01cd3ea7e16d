// Ambient occlusion and on-screen light of `horizon` and `ao` on real scenes against rays cast through the same scene: at pixels
// of the picture, cosine-distributed directions, hidden where they meet something within the technique's radius; light from what
// they meet if the camera sees that point.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <string>

#include "emitters.h"
#include "gbuffer.h"
#include "parallel.h"
#include "sampler.h"
#include "techniques/screen_rig.h"

using namespace lightwell::test;

namespace {

constexpr int kWidth = 320, kHeight = 180, kStride = 3, kRays = 128;
constexpr float kRadius = 0.2f;  // of both techniques by default, in image heights at the pixel's depth

struct Truth {
    double open = 0.0, light = 0.0, noise = 0.0;  // noise: deviation of the mean of `open`
};

LWImage imageOf(const studio::PlanarBuffer& buffer) {
    LWImage image{};
    image.host = const_cast<float*>(buffer.data());
    image.format = LW_FORMAT_PLANAR_FLOAT3;
    image.width = std::uint32_t(buffer.width());
    image.height = std::uint32_t(buffer.height());
    image.byteRowStride = std::int64_t(buffer.rowFloats()) * 4;
    image.bytePlaneStride = std::int64_t(buffer.planeFloats()) * 4;
    return image;
}

struct SceneView {
    std::shared_ptr<const studio::Scene> scene;
    studio::RayScene rays;
    studio::Camera camera;
    studio::GBuffer pixels;
    studio::EmitterSet emitters;

    explicit SceneView(const std::string& name)
        : scene(std::make_shared<studio::Scene>(studio::loadScene(name))),
          rays(scene, 0.0f),
          camera(scene->cameraAt(0, 0.0f)),
          pixels(studio::renderGBuffer(rays, camera, kWidth, kHeight, camera, 0.0f)),
          emitters(rays) {}

    bool hasSurface(int x, int y) const { return glm::length(pixels.normal.rgb(x, y)) > 0.5f; }

    bool seesCamera(const studio::Hit& hit) const {
        const glm::vec4 clip = camera.projectionMatrix(kWidth, kHeight) * camera.viewMatrix() * glm::vec4(hit.position, 1.0f);
        if (!(clip.w > 0.0f) || std::fabs(clip.x) > clip.w || std::fabs(clip.y) > clip.w) return false;
        const glm::vec3 way = camera.position - hit.position;
        const float length = glm::length(way);
        return glm::dot(way, hit.geometricNormal) > 0.0f &&
               !rays.occluded(rays.offset(hit.position, hit.geometricNormal), way / length, 0.0f, 0.9999f * length);
    }

    Truth truthAt(int x, int y) const {
        const glm::vec3 p = pixels.position.rgb(x, y), n = glm::normalize(pixels.normal.rgb(x, y));
        const glm::vec3 fromEye = glm::normalize(p - camera.position);
        studio::Hit own;
        own.geometricNormal = n;
        rays.trace(camera.position, fromEye, 0.0f, 1e30f, own);
        const float depth = glm::dot(p - camera.position, glm::normalize(camera.target - camera.position));
        const float radius = kRadius * 2.0f * std::tan(0.5f * camera.verticalFov) * depth;
        const glm::vec3 origin = rays.offset(p, own.geometricNormal);
        int open = 0;
        double light = 0.0;
        for (int i = 0; i < kRays; ++i) {
            studio::Sampler sampler(7, std::uint64_t(y) * kWidth + std::uint64_t(x), std::uint32_t(i));
            const glm::vec3 direction = studio::sampleCosine(n, sampler.next());
            // Into the surface that the shading normal leans away from.
            if (glm::dot(direction, own.geometricNormal) <= 0.0f) continue;
            studio::Hit hit;
            const bool meets = rays.trace(origin, direction, 0.0f, 1e30f, hit);
            open += !meets || hit.distance >= radius;
            if (!meets || !seesCamera(hit)) continue;
            const glm::vec3 arriving = rays.directIrradiance(hit.position, hit.geometricNormal, hit.normal) +
                                       emitters.irradiance(hit.position, hit.geometricNormal, hit.normal, 0);
            light += double(glm::dot(hit.albedo, arriving)) / kRays;
        }
        const double share = double(open) / kRays;
        return {share, light, std::sqrt(share * (1.0 - share) / kRays)};
    }
};

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
            if (view.hasSurface(x, y)) truths[std::size_t(y) * kWidth + std::size_t(x)] = view.truthAt(x, y);
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
    const SceneView scene(bounds.scene);
    const std::vector<Truth> truths = truthsOf(scene);
    TestView view(device, kWidth, kHeight);
    LWGBuffer gbuffer{};
    gbuffer.structSize = sizeof gbuffer;
    gbuffer.position = imageOf(scene.pixels.position);
    gbuffer.normal = imageOf(scene.pixels.normal);
    gbuffer.directRadiance = imageOf(scene.pixels.direct);
    // Rows one after another.
    const glm::mat4 matrix = glm::transpose(scene.camera.viewMatrix());
    const glm::mat4 projection = glm::transpose(scene.camera.projectionMatrix(kWidth, kHeight));
    std::copy(&matrix[0][0], &matrix[0][0] + 16, gbuffer.camera.view);
    std::copy(&projection[0][0], &projection[0][0] + 16, gbuffer.camera.projection);
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
    check(GENERATE(Bounds{"cornell", 0.045, 0.07, 0.1, 0.12}, Bounds{"rooms", 0.03, 0.045, 0.065, 0.075}));
}

// Needs LIGHTWELL_SCENES: ambient_truth_test "[.scenes]".
TEST_CASE("ambient occlusion of large scenes is that of cast rays", "[horizon][ao][rays][.scenes]") {
    check(GENERATE(Bounds{"sponza_crytek", 0.07, 0.12, 0.14, 0.16}, Bounds{"sibenik", 0.09, 0.11, 0.105, 0.135},
                   Bounds{"living_room", 0.07, 0.11, 0.14, 0.15}));
}
