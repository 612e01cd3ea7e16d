// The truth of radiance along glossy lobes, against closed forms and the path tracer's own irradiance.
#include <catch2/catch.hpp>

#include "../support/quad_scene.h"
#include "../support/studio_scenes.h"
#include "path_tracer.h"

using glm::vec3;
using studio::Image;
using studio::PathTracerOptions;
using test::kPi;
using test::QuadScene;
using test::Receivers;

namespace {

double red(const Image& image, int pixel) { return double(image.plane("specular.R")[std::size_t(pixel)]); }

// A floor of albedo 0.6 under a sun of irradiance 2.
QuadScene litFloor(float half) {
    QuadScene s;
    s.quad(s.material(vec3(0.6f)), vec3(-half, 0, -half), vec3(-half, 0, half), vec3(half, 0, half), vec3(half, 0, -half));
    s.sun(vec3(0, -1, 0), vec3(2.0f));
    return s;
}

}  // namespace

TEST_CASE("specular truth: a mirror shows the floor's radiance, and even light is even for every lobe") {
    const studio::RayScene floor = litFloor(50.0f).build();
    QuadScene empty;
    empty.quad(empty.material(vec3(0.5f)), vec3(0, -9, 0), vec3(1, -9, 0), vec3(1, -9, 1), vec3(0, -9, 1));
    empty.scene.sky = vec3(0.7f);
    const studio::RayScene sky = empty.build();
    Receivers points(3, 1, vec3(0, 1, 2));
    for (int i = 0; i < 3; ++i) points.set(i, 0, vec3(float(i), 3, 0), i == 0 ? vec3(0, -1, 0) : vec3(0.1f * float(i), -1, 0.2f));
    PathTracerOptions options;
    options.samplesPerPixel = 1 << 14;
    studio::SpecularOptions specular;
    options.specular = &specular;
    specular.roughness = 0.0;
    const Image mirror = tracePaths(floor, points.view, options);
    for (int i = 0; i < 3; ++i) CHECK(red(mirror, i) == Approx(0.6 * 2.0 / kPi).epsilon(1e-4));
    for (auto& normal : {vec3(0, 1, 0), vec3(0.3f, 1, 0.9f)})
        for (const double roughness : {0.3, 0.7, 1.0}) {
            points.set(1, 0, vec3(0, 0, 0), normal);
            specular.roughness = roughness;
            CAPTURE(roughness);
            // 16,384 points of a stratified sequence against a table of 4,096.
            CHECK(red(tracePaths(sky, points.view, options), 1) == Approx(0.7).epsilon(0.01));
        }
}

TEST_CASE("specular truth: seen straight on, the roughest lobe is the irradiance by pi") {
    const studio::RayScene scene = litFloor(1.0f).build();
    Receivers point(1, 1, vec3(0.3f, -3, 0.2f));
    point.set(0, 0, vec3(0.3f, 1.5f, 0.2f), vec3(0, -1, 0));
    PathTracerOptions options;
    options.samplesPerPixel = 1 << 15;
    const double irradiance = double(tracePaths(scene, point.view, options).plane("bounce1.R")[0]);
    const studio::SpecularOptions specular{1.0};
    options.specular = &specular;
    CHECK(red(tracePaths(scene, point.view, options), 0) == Approx(irradiance / kPi).epsilon(0.01));
}

TEST_CASE("specular truth: a checkpoint of another roughness is refused, as is a roughness beyond [0,1]") {
    const studio_test::TempFolder folder;
    const studio::RayScene scene = litFloor(1.0f).build();
    Receivers point(1, 1, vec3(0, 0.5f, 0));
    point.set(0, 0, vec3(0, 1, 0), vec3(0, -1, 0));
    PathTracerOptions options;
    options.samplesPerPixel = 8;
    options.checkpoint = folder.path() + "/film";
    studio::SpecularOptions specular;
    options.specular = &specular;
    tracePaths(scene, point.view, options);
    tracePaths(scene, point.view, options);
    specular.roughness = 0.6;
    CHECK_THROWS_AS(tracePaths(scene, point.view, options), studio::CheckpointError);
    specular.roughness = 1.5;
    CHECK_THROWS_WITH(tracePaths(scene, point.view, options), Catch::Contains("roughness") && Catch::Contains("1.5"));
}
