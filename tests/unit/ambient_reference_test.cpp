// The truth of ambient occlusion by rays, against closed forms.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "../support/quad_scene.h"
#include "../support/studio_scenes.h"
#include "path_tracer.h"

using glm::vec3;
using studio::Image;
using studio::PathTracerOptions;
using test::kPi;
using test::QuadScene;
using test::Receivers;

TEST_CASE("ambient occlusion: a checkpoint of another radius, weighting or angle of view is refused") {
    const studio_test::TempFolder folder;
    QuadScene s;
    s.quad(s.material(vec3(0.6f)), vec3(1, 0, -1), vec3(3, 0, -1), vec3(3, 0, 1), vec3(1, 0, 1));
    s.sun(vec3(0, -1, 0), vec3(1.0f));
    const studio::RayScene scene = s.build();
    Receivers point(1, 1, vec3(-5, 0.5f, 0));
    point.set(0, 0, vec3(0, 0.5f, 0), vec3(1, 0, 0));
    PathTracerOptions options;
    options.samplesPerPixel = 8;
    options.checkpoint = folder.path() + "/film";
    studio::AmbientOptions ambient;
    options.ambient = &ambient;
    tracePaths(scene, point.view, options);
    tracePaths(scene, point.view, options);
    ambient.radius = 0.21;
    CHECK_THROWS_WITH(tracePaths(scene, point.view, options), Catch::Contains("ambient occlusion"));
    ambient = {0.2, true};
    CHECK_THROWS_AS(tracePaths(scene, point.view, options), studio::CheckpointError);
    ambient = {};
    options.ambient = nullptr;
    CHECK_THROWS_AS(tracePaths(scene, point.view, options), studio::CheckpointError);
    options.ambient = &ambient;
    // The same pixel of a wider picture, whose radius there is a longer one.
    point.view.camera.verticalFov *= 1.5f;
    CHECK_THROWS_AS(tracePaths(scene, point.view, options), studio::CheckpointError);
}

TEST_CASE("ambient occlusion: an infinite wall within the radius, a plane, a corner, both weightings") {
    // The camera looks down from 10: R = 0.1 heights of 2 tan(fov / 2) 10 m each. A wall at x = 0
    // reaches past R, and another at z = 0 past it from the corner.
    constexpr float kFov = 0.9f;
    const double range = 0.1 * 2.0 * std::tan(0.5 * double(kFov)) * 10.0;
    QuadScene s;
    const int grey = s.material(vec3(0.5f));
    s.quad(grey, vec3(0, 0, -9), vec3(9, 0, -9), vec3(9, 0, 9), vec3(0, 0, 9));
    s.quad(grey, vec3(0, 0, -9), vec3(0, 3, -9), vec3(0, 3, 9), vec3(0, 0, 9));
    s.quad(grey, vec3(0, 0, -9), vec3(9, 0, -9), vec3(9, 3, -9), vec3(0, 3, -9));
    const double shares[] = {0.05, 0.4, 0.9, 1.2};
    Receivers points(5, 1, vec3(0, 10, 0));
    points.view.camera.target = vec3(0, 0, 0);
    points.view.camera.up = vec3(0, 0, -1);
    points.view.camera.verticalFov = kFov;
    for (int i = 0; i < 4; ++i) points.set(i, 0, vec3(float(shares[i] * range), 0, 0), vec3(0, 1, 0));
    points.set(4, 0, vec3(1e-4f, 0, -9 + 1e-4f), vec3(0, 1, 0));  // the corner: 1/4
    studio::AmbientOptions ambient;
    ambient.radius = 0.1;
    PathTracerOptions options;
    options.samplesPerPixel = 1 << 14;
    options.ambient = &ambient;
    for (const bool isUniform : {false, true}) {
        ambient.isUniform = isUniform;
        const Image image = tracePaths(s.build(), points.view, options);
        for (int i = 0; i < 5; ++i) {
            const double x = std::min(1.0, i < 4 ? shares[i] : 0.0);
            double expected =
                isUniform ? 0.5 * (1.0 + x) : 1.0 - (std::acos(x) - x * std::sqrt(1.0 - x * x)) / kPi;
            if (i == 4) expected = 0.25;
            CAPTURE(isUniform, i);
            // Two stratified sequences of 8192: far below a deviation of independent samples, 0.004.
            CHECK(double(image.plane("ambient.G")[std::size_t(i)]) == Approx(expected).margin(0.002));
        }
        options.threads = options.threads == 1 ? 3 : 1;
        CHECK(tracePaths(s.build(), points.view, options).plane("ambient.G") ==
              image.plane("ambient.G"));
        CHECK(image.has("a.ambient.R"));
        CHECK_FALSE(image.has("bounce1.R"));
    }
}
