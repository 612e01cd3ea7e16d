// Light of every kind as the rival finds it, and the borders of what it can be given.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <memory>

#include "area_lights.h"
#include "rival_arrivals.h"
#include "scene_primitives.h"
#include "support/quad_scene.h"
#include "support/rival_view.h"

namespace {

using namespace studio;
using namespace rival_test;

constexpr float kDegree = float(test::kPi) / 180.0f;

Light spot(float innerDegrees, float outerDegrees) {
    Light light;
    light.kind = LightKind::Spot;
    light.position = {0.3f, 2.0f, -0.1f};
    light.direction = glm::normalize(glm::vec3(0.2f, -1.0f, 0.1f));
    light.innerCone = innerDegrees * kDegree;
    light.outerCone = outerDegrees * kDegree;
    return light;
}

// Vertices about the spot's axis, from its middle to beyond its outer cone.
void placeAcross(const Light& light, PathBatch& batch) {
    const glm::vec3 side = glm::normalize(glm::cross(light.direction, glm::vec3(0, 0, 1)));
    batch.count = 200;
    for (int i = 0; i < batch.count; ++i) {
        const float angle = light.outerCone * float(i) / 160.0f;
        const glm::vec3 at =
            light.position + 2.0f * (std::cos(angle) * light.direction + std::sin(angle) * side);
        for (int c = 0; c < 3; ++c) {
            batch.position[c][i] = at[c];
            batch.normal[c][i] = batch.face[c][i] = -light.direction[c];
        }
    }
}

}  // namespace

TEST_CASE("A lamp's profile is the reference's, for cones of any width") {
    constexpr double kTolerance = 2e-3;  // 1e-7 of a cosine on the ramp of the narrowest cone here
    auto batch = std::make_unique<PathBatch>();
    auto found = std::make_unique<Arrivals>();
    for (const Light& light : {spot(0, 45), spot(20, 30), spot(0, 2), spot(0.5f, 1)}) {
        placeAcross(light, *batch);
        findArrivals(light, *batch, *found);
        INFO("cones " << light.innerCone / kDegree << " to " << light.outerCone / kDegree << " degrees");
        for (int i = 0; i < batch->count; ++i) {
            const glm::vec3 at{batch->position[0][i], batch->position[1][i], batch->position[2][i]};
            const LightArrival truth = arrivalOf(light, at);
            const float cosine = -glm::dot(light.direction, truth.toLight);
            INFO("vertex " << i);
            REQUIRE(double(found->strength[i]) ==
                    Approx(double(truth.irradiance.x * cosine)).margin(0.25 * kTolerance));
        }
    }
}

TEST_CASE("On its axis a lamp has its full intensity, however narrow its cone") {
    auto batch = std::make_unique<PathBatch>();
    auto found = std::make_unique<Arrivals>();
    for (const float degrees : {90.0f, 10.0f, 0.1f, 0.06f, 0.04f}) {
        Light light = spot(0, degrees);
        light.position = {0, 2, 0};
        light.direction = {0, -1, 0};
        batch->count = 1;
        for (int c = 0; c < 3; ++c) {
            batch->position[c][0] = 0.0f;
            batch->normal[c][0] = batch->face[c][0] = c == 1 ? 1.0f : 0.0f;
        }
        findArrivals(light, *batch, *found);
        INFO(degrees << " degrees");
        CHECK(found->strength[0] == Approx(0.25));
    }
}

TEST_CASE("Cones that coincide are a step") {
    const Light light = spot(12, 12);
    auto batch = std::make_unique<PathBatch>();
    auto found = std::make_unique<Arrivals>();
    placeAcross(light, *batch);
    findArrivals(light, *batch, *found);
    for (int i = 0; i < batch->count; ++i) {
        INFO("vertex " << i);
        if (i < 159) REQUIRE(found->strength[i] > 0.2f);
        if (i > 161) REQUIRE(found->strength[i] == 0.0f);
    }
}

TEST_CASE("Emissive surfaces that lie in the same place shine once") {
    // A furnace whose walls are there twice: exitance 1 and albedo 0.5 make 0.5 at the first bounce.
    test::QuadScene scene;
    const int wall = scene.material(glm::vec3(0.5f), glm::vec3(1.0f / float(test::kPi)));
    scene.box(wall, glm::vec3(-1.0f), glm::vec3(1.0f));
    scene.box(wall, glm::vec3(-1.0f), glm::vec3(1.0f));
    const RayScene rays = scene.build();
    test::Receivers pixels(32, 32);
    pixels.grid({-0.9f, -1, -0.9f}, {1.8f, 0, 0}, {0, 0, 1.8f}, {0, 1, 0});
    // 65,536 paths of standard deviation about 0.3.
    CHECK(meanOf(render(rays, pixels.view, unfiltered(1, 64))) == Approx(0.5).epsilon(0.01));
}

TEST_CASE("Both ways to a lamplit place share its light whatever their densities") {
    const float infinite = std::numeric_limits<float>::infinity();
    CHECK(rayShare(1.0f, 3.0f) == Approx(0.25));
    CHECK(rayShare(1.0f, 0.0f) == 1.0f);
    CHECK(rayShare(0.0f, 0.0f) == 0.0f);     // a ray in the horizon
    CHECK(rayShare(-1e-9f, 1e-9f) == 0.0f);  // as rounding has it
    CHECK(rayShare(infinite, 2.0f) == 1.0f);
}

TEST_CASE("The smallest scene that is allowed is finite and lit") {
    // Triangles of 1e-10 m: squares of their areas are beyond floats.
    Scene scene;
    scene.materials.push_back(Material{});
    scene.meshes.push_back(makeSphere(glm::vec3(0.0f), 1e-8f, 128));
    Light lamp;
    lamp.kind = LightKind::Point;
    lamp.emitted = glm::vec3(float(test::kPi) * 1e-16f);  // direct irradiance pi
    scene.lights.push_back(lamp);
    Camera camera;
    camera.position = {0.0f, 0.0f, 5e-9f};
    scene.cameras.push_back(camera);
    const View view(std::move(scene), 32, 24);
    // Albedo 0.5: pi/2 at the first bounce; facets and smooth normals change it by a few parts in 1,000.
    CHECK(meanOf(render(view, unfiltered(1, 4))) == Approx(test::kPi / 2).epsilon(0.01));
}

TEST_CASE("A G-buffer of another size is refused") {
    const View view("basic", 16, 9);
    PlanarBuffer irradiance(16, 9, 3), validity(16, 9, 1), narrow(15, 9, 3);
    Rival larger(RivalOptions{}, 17, 9), fitting(RivalOptions{}, 16, 9);
    CHECK_THROWS_WITH(larger.render(view.rays, view.gbuffer, irradiance, validity),
                      Catch::Contains("17 x 9") && Catch::Contains("16 x 9"));
    CHECK_THROWS_WITH(fitting.render(view.rays, view.gbuffer, narrow, validity),
                      Catch::Contains("irradiance") && Catch::Contains("15 x 9"));
    fitting.render(view.rays, view.gbuffer, irradiance, validity);
}
