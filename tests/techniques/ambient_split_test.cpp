// Whose error is it? The light of `horizon` and `ao` in large scenes against rays through the scene that count light from what the
// camera sees (as ambient_truth_test.cpp), next to the same rays followed over the picture alone (reference/screen_walk.h): what
// those get wrong no technique can get right that knows one layer of depth. Hidden: it takes minutes.
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "parallel.h"
#include "reference/screen_walk.h"
#include "support/seen_scene.h"

using namespace lightwell::test;
using lightwell::reference::ScreenWalk;

namespace {

constexpr int kWidth = 320, kHeight = 180, kStride = 3, kRays = 512;
constexpr double kPi = 3.14159265358979323846;
constexpr double kFloor = 0.01;  // as in relMSE (docs/metrics.md)

// The walk's thicknesses: the techniques' own, ten times as much, everything behind what is seen.
constexpr double kThicknesses[] = {0.03, 0.3, 1e9};
constexpr std::size_t kWalks = std::size(kThicknesses);

struct Light {
    double truth = 0.0, again = 0.0;    // `again`: of other rays
    double walked[kWalks] = {};
    // Of the first walk: light that it found where the rays met what the camera does not see, where they met nothing or another
    // lit place, and light that it missed.
    double unseen = 0.0, elsewhere = 0.0, missed = 0.0;
    bool judged = false;
};

Light lightAt(const SceneView& view, const ScreenWalk* walks, int x, int y) {
    Light light;
    light.judged = true;
    const glm::dvec3 p(view.pixels.position.rgb(x, y)), n = glm::normalize(glm::dvec3(view.pixels.normal.rgb(x, y)));
    view.castFrom(x, y, kRays, 7, [&](const glm::vec3& direction, bool meets, const studio::Hit& hit) {
        const bool seen = meets && view.seesCamera(hit);
        const double sent = seen ? view.sentBy(hit) / kRays : 0.0;
        light.truth += sent;
        for (std::size_t i = 0; i < kWalks; ++i) {
            int column = 0, row = 0;
            double found = 0.0;
            if (walks[i].meets(p, n, direction, &column, &row) && glm::dot(view.pixels.normal.rgb(column, row), direction) < 0.0f) {
                const glm::vec3 sends = view.pixels.direct.rgb(column, row);
                found = kPi * double(sends.x + sends.y + sends.z) / kRays;
            }
            light.walked[i] += found;
            if (i > 0) continue;
            (meets && !seen ? light.unseen : light.elsewhere) += std::max(found - sent, 0.0);
            light.missed += std::max(sent - found, 0.0);
        }
    });
    view.castFrom(x, y, kRays, 8, [&](const glm::vec3&, bool meets, const studio::Hit& hit) {
        if (meets && view.seesCamera(hit)) light.again += view.sentBy(hit) / kRays;
    });
    return light;
}

struct Score {
    double relMse = 0.0, nrmse = 0.0, bias = 0.0;
};

template <typename Value>
Score scoreOf(const std::vector<Light>& lights, Value value) {
    double mean = 0.0, count = 0.0;
    for (const Light& light : lights)
        if (light.judged) mean += light.truth, ++count;
    mean /= count;
    Score s;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        if (!lights[i].judged) continue;
        const double off = value(i) - lights[i].truth;
        s.relMse += off * off / (lights[i].truth * lights[i].truth + kFloor * mean * mean) / count;
        s.nrmse += off * off / count;
        s.bias += off / count / mean;
    }
    s.nrmse = std::sqrt(s.nrmse) / mean;
    return s;
}

void say(const char* what, const Score& s) { WARN(what << ": relMSE " << s.relMse << ", nRMSE " << s.nrmse << ", bias " << s.bias); }

Score scoreOf(const char* technique, const void* desc, const SceneView& scene, const std::vector<Light>& lights) {
    TestDevice device(16);
    TestView view(device, kWidth, kHeight);
    const LWGBuffer gbuffer = scene.gbuffer();
    TestTechnique made(device, technique, desc);
    const std::vector<float> light = renderScreen(made, view, device, gbuffer).irradiance;
    const std::size_t plane = std::size_t(kWidth) * kHeight;
    return scoreOf(lights, [&](std::size_t i) { return double(light[i]) + double(light[plane + i]) + double(light[2 * plane + i]); });
}

}  // namespace

TEST_CASE("how much of the error in dark places one layer of depth explains", "[horizon][ao][rays][.scenes][.split]") {
    struct Bounds {
        const char* scene;
        double usual, limit;
    };
    const Bounds bounds = GENERATE(Bounds{"sponza_crytek", 14.0, 4.4}, Bounds{"sibenik", 2.6, 0.78});
    const SceneView scene(bounds.scene, kWidth, kHeight);
    const ScreenWalk walks[kWalks] = {{scene, kThicknesses[0] * scene.heightAtOne()}, {scene, kThicknesses[1] * scene.heightAtOne()}, {scene, kThicknesses[2]}};
    std::vector<Light> lights(std::size_t(kWidth) * kHeight);
    studio::parallelRows(kHeight / kStride, [&](int row) {
        const int y = row * kStride + kStride / 2;
        for (int x = kStride / 2; x < kWidth; x += kStride)
            if (scene.hasSurface(x, y)) lights[std::size_t(y) * kWidth + std::size_t(x)] = lightAt(scene, walks, x, y);
    });
    WARN(bounds.scene);
    say("other rays", scoreOf(lights, [&](std::size_t i) { return lights[i].again; }));
    say("walk, thickness 0.03", scoreOf(lights, [&](std::size_t i) { return lights[i].walked[0]; }));
    say("walk, thickness 0.3", scoreOf(lights, [&](std::size_t i) { return lights[i].walked[1]; }));
    say("walk, nothing passes behind", scoreOf(lights, [&](std::size_t i) { return lights[i].walked[2]; }));
    say("walk without what rays met unseen", scoreOf(lights, [&](std::size_t i) { return lights[i].walked[0] - lights[i].unseen; }));
    double truth = 0.0, unseen = 0.0, elsewhere = 0.0, missed = 0.0;
    for (const Light& l : lights) truth += l.truth, unseen += l.unseen, elsewhere += l.elsewhere, missed += l.missed;
    WARN("of the light: found where rays meet what is not seen " << unseen / truth << ", elsewhere " << elsewhere / truth << ", missed " << missed / truth);
    LWHorizonDesc horizon, fine;
    lwDefaultHorizon(&horizon);
    fine = horizonDesc(40, 8);
    LWAoDesc ao;
    lwDefaultAo(&ao);
    const Score usual = scoreOf("horizon", &horizon, scene, lights), limit = scoreOf("horizon", &fine, scene, lights);
    say("horizon", usual);
    say("horizon, directions=40 steps=8 interleave=1 resolution=full", limit);
    say("ao", scoreOf("ao", &ao, scene, lights));
    // The finest setting is near the walk; relMSE, which weighs dark places most, within a quarter of what was measured.
    const Score walk = scoreOf(lights, [&](std::size_t i) { return lights[i].walked[0]; });
    CHECK(limit.nrmse < 1.3 * walk.nrmse);
    CHECK(limit.relMse < bounds.limit);
    CHECK(usual.relMse < bounds.usual);
}
