// Truths of what a picture can know: light from surfaces that cameras see, against Lambert's polygon
// formula and a sum over the picture's pixels in double.
#include <catch2/catch.hpp>

#include <cmath>

#include "../support/quad_scene.h"
#include "../support/studio_scenes.h"
#include "path_tracer.h"

using glm::vec3;
using studio::Image;
using studio::PathTracerOptions;
using studio::PictureView;
using test::kPi;
using test::QuadScene;
using test::Receivers;

namespace {

// Relative error of rays and lit points together: three times that of path_tracer_test.cpp, because the
// border of what is seen cuts through the cells that lit points are drawn by.
constexpr double kJoined = 0.006;
constexpr int kSamples = 1 << 15;

// Lambert 1760: irradiance per unit radiance of a polygon wholly above the receiver's horizon.
double polygonIrradiance(const std::vector<glm::dvec3>& corners, const glm::dvec3& at,
                         const glm::dvec3& normal) {
    double sum = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a = glm::normalize(corners[i] - at);
        const glm::dvec3 b = glm::normalize(corners[(i + 1) % corners.size()] - at);
        const glm::dvec3 edge = glm::cross(a, b);
        const double sine = glm::length(edge);
        sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(edge / sine, normal);
    }
    return std::abs(0.5 * sum);
}

const vec3 kReceiver(0, 0.5f, 0), kFacing(1, 0, 0);
constexpr double kSun = 5.0, kAlbedo = 0.6;

// A sunlit patch of floor, x = 1 .. 3, z = -1 .. 1.
QuadScene patch() {
    QuadScene s;
    s.quad(s.material(vec3(float(kAlbedo))), vec3(1, 0, -1), vec3(3, 0, -1), vec3(3, 0, 1),
           vec3(1, 0, 1));
    s.sun(vec3(0.3f, -1, 0), vec3(float(kSun)));
    return s;
}

// The light of the patch's part x = from .. to at the receiver.
double lightOf(double from, double to) {
    const double radiance = kAlbedo * kSun / std::sqrt(1.09) / kPi;
    return radiance * polygonIrradiance({{from, 0, -1}, {to, 0, -1}, {to, 0, 1}, {from, 0, 1}},
                                        glm::dvec3(kReceiver), glm::dvec3(kFacing));
}

// From 4 above the floor straight down; shows x +- `halfWidth`, z +- 1 there.
PictureView above(float x, float halfWidth) {
    PictureView view;
    view.camera.position = vec3(x, 4, 0);
    view.camera.target = vec3(x, 0, 0);
    view.camera.up = vec3(0, 0, -1);
    view.camera.verticalFov = 2.0f * std::atan(1.02f / 4.0f);
    view.width = 640;
    view.height = int(std::lround(640.0 * 1.02 / double(halfWidth)));
    return view;
}

double green(const QuadScene& scene, std::vector<PictureView> senders, bool unshadowed = false) {
    Receivers point(1, 1, vec3(-5, 0.5f, 0));
    point.set(0, 0, kReceiver, kFacing);
    PathTracerOptions options;
    options.samplesPerPixel = kSamples;
    options.sendersSeenBy = std::move(senders);
    options.unshadowed = unshadowed;
    return double(tracePaths(scene.build(), point.view, options).plane("bounce1.G")[0]);
}

}  // namespace

TEST_CASE("senders: a picture's sides cut what sends") {
    CHECK(green(patch(), {above(1, 1)}) == Approx(lightOf(1, 2)).epsilon(kJoined));
    CHECK(green(patch(), {above(2.5f, 0.5f)}) == Approx(lightOf(2, 3)).epsilon(kJoined));
    CHECK(green(patch(), {above(-2, 1)}) == 0.0);
}

TEST_CASE("senders: two pictures show what either shows, and nothing twice") {
    CHECK(green(patch(), {above(1, 1), above(2.5f, 0.75f)}) == Approx(lightOf(1, 3)).epsilon(kJoined));
}

TEST_CASE("senders: what stands before the camera hides them") {
    // Hides x = 1.5 .. 3 from a camera over x = 1 that shows as far as 2; its shadow falls past that.
    QuadScene s = patch();
    s.quad(s.material(vec3(0.0f)), vec3(1.125f, 3, -2), vec3(1.5f, 3, -2), vec3(1.5f, 3, 2),
           vec3(1.125f, 3, 2));
    CHECK(green(s, {above(1, 1)}) == Approx(lightOf(1, 1.5)).epsilon(kJoined));
}

TEST_CASE("senders: the side that faces the camera alone") {
    // The picture is taken from below: it shows the patch's dark side.
    PictureView below = above(2, 2);
    below.camera.position.y = -4;
    CHECK(green(patch(), {below}) == 0.0);
    CHECK(green(patch(), {below}, true) == 0.0);
    CHECK(green(patch(), {}) == Approx(lightOf(1, 3)).epsilon(kJoined));
}

TEST_CASE("senders, unshadowed: walls before the receiver hide nothing, the picture's sides still cut") {
    QuadScene s = patch();
    s.quad(s.material(vec3(0.0f)), vec3(0.5f, -1, -9), vec3(0.5f, 0.45f, -9), vec3(0.5f, 0.45f, 9),
           vec3(0.5f, -1, 9));
    CHECK(green(s, {above(1, 1)}) == 0.0);
    CHECK(green(s, {above(1, 1)}, true) == Approx(lightOf(1, 2)).epsilon(kJoined));
}

TEST_CASE("senders: a picture of everything changes no bit; only the first bounce is made") {
    QuadScene s;
    const int grey = s.material(vec3(0.7f));
    s.quad(grey, vec3(-1, 0, -1), vec3(1, 0, -1), vec3(1, 0, 1), vec3(-1, 0, 1));
    s.quad(grey, vec3(-1, 0, -1), vec3(1, 0, -1), vec3(1, 2, -1), vec3(-1, 2, -1));
    s.point(vec3(0.2f, 1.2f, 0.3f), vec3(3.0f));
    Receivers floor(8, 8, vec3(0, 1.5f, 6));
    floor.grid(vec3(-1, 0, -1), vec3(2, 0, 0), vec3(0, 0, 2), vec3(0, 1, 0));
    floor.view.camera.target = vec3(0, 1, 0);
    PathTracerOptions options;
    options.samplesPerPixel = 64;
    const Image all = tracePaths(s.build(), floor.view, options);
    options.sendersSeenBy = {{floor.view.camera, 320, 320}};
    const Image seen = tracePaths(s.build(), floor.view, options);
    CHECK(seen.plane("bounce1.R") == all.plane("bounce1.R"));
    CHECK(seen.metadata.at("noise.bounce1") == all.metadata.at("noise.bounce1"));
    CHECK_FALSE(seen.has("all.R"));
    CHECK_FALSE(seen.has("direct.R"));
}

namespace {

constexpr double kWall = 0.7, kIntensity = 3.0;

struct Emitted {
    std::vector<double> irradiance;  // of each receiver
    int emitters = 0;
};

// What the pixels of a square picture, lit by a lamp without shadows, send to a row of receivers: each
// stands for the area that its solid angle cuts out of its surface. What is nearer to the camera than
// z = 2 is black.
Emitted lightOfPixels(const studio::GBuffer& shown, const vec3& lamp, const studio::GBuffer& receivers) {
    Emitted sum{std::vector<double>(std::size_t(receivers.width)), 0};
    const glm::dvec3 camera(shown.camera.position);
    const glm::dvec3 axis = glm::normalize(glm::dvec3(shown.camera.target) - camera);
    const double side = 2.0 * std::tan(0.5 * double(shown.camera.verticalFov)) / shown.height;
    for (int y = 0; y < shown.height; ++y)
        for (int x = 0; x < shown.width; ++x) {
            const glm::dvec3 at(shown.position.rgb(x, y)), normal(shown.normal.rgb(x, y));
            if (normal == glm::dvec3(0.0) || at.z > 2.0) continue;
            ++sum.emitters;
            const glm::dvec3 eye = at - camera, toLamp = glm::dvec3(lamp) - at;
            const double cosine = glm::dot(glm::normalize(eye), axis);
            const double area = side * side * cosine * cosine * cosine * glm::dot(eye, eye) /
                                std::abs(glm::dot(glm::normalize(eye), normal));
            const double lit = std::max(0.0, glm::dot(normal, glm::normalize(toLamp)));
            const double power = kWall / kPi * kIntensity * lit / glm::dot(toLamp, toLamp) * area;
            for (int i = 0; i < receivers.width; ++i) {
                const glm::dvec3 way = at - glm::dvec3(receivers.position.rgb(i, 0));
                const double squared = glm::dot(way, way);
                const double in = glm::dot(way, glm::dvec3(receivers.normal.rgb(i, 0)));
                const double out = -glm::dot(way, normal);
                if (in > 0.0 && out > 0.0)
                    sum.irradiance[std::size_t(i)] += power * in * out / (squared * squared);
            }
        }
    return sum;
}

}  // namespace

TEST_CASE("senders: the sum over the picture's pixels as emitters, in double") {
    // A floor and a wall that the picture cuts, and a black card before the camera, which hides a part
    // of both and lies behind the lamp and the receivers: with shadows or without, the light is the
    // same.
    constexpr int kPixels = 512;
    const vec3 lamp(0.2f, 1.2f, 0.3f);
    QuadScene s;
    const int grey = s.material(vec3(float(kWall)));
    s.quad(grey, vec3(-1, 0, -1), vec3(1, 0, -1), vec3(1, 0, 1), vec3(-1, 0, 1));
    s.quad(grey, vec3(-1, 0, -1), vec3(1, 0, -1), vec3(1, 2, -1), vec3(-1, 2, -1));
    s.quad(s.material(vec3(0.0f)), vec3(-0.3f, 1.2f, 2.5f), vec3(0, 1.2f, 2.5f), vec3(0, 1.5f, 2.5f),
           vec3(-0.3f, 1.5f, 2.5f));
    s.point(lamp, vec3(float(kIntensity)));
    PictureView picture;
    picture.camera.position = vec3(0, 1.5f, 3.5f);
    picture.camera.target = vec3(0.3f, 0.6f, -1);
    picture.camera.verticalFov = 0.35f;
    picture.width = picture.height = kPixels;
    const studio::RayScene scene = s.build();
    const studio::GBuffer shown =
        studio::renderGBuffer(scene, picture.camera, kPixels, kPixels, picture.camera, 0.0f);

    Receivers points(3, 1, vec3(-5, 0.5f, 0));
    points.set(0, 0, vec3(0, 1, 0.5f), vec3(0, -0.2f, -1));
    points.set(1, 0, vec3(0.6f, 0.9f, -0.1f), vec3(-1, -0.5f, -0.3f));
    points.set(2, 0, vec3(-0.5f, 1.4f, 0.2f), vec3(0.3f, -1, 0));
    const Emitted sum = lightOfPixels(shown, lamp, points.view);
    const std::vector<double>& expected = sum.irradiance;
    REQUIRE(sum.emitters > kPixels * kPixels / 2);  // and not all: the card and the sky beside the wall
    REQUIRE(sum.emitters < kPixels * kPixels * 99 / 100);

    PathTracerOptions options;
    options.samplesPerPixel = kSamples;
    options.sendersSeenBy = {picture};
    for (const bool unshadowed : {false, true}) {
        options.unshadowed = unshadowed;
        options.threads = 1;
        const Image image = tracePaths(scene, points.view, options);
        options.threads = 3;
        CHECK(tracePaths(scene, points.view, options).plane("bounce1.G") == image.plane("bounce1.G"));
        for (int i = 0; i < 3; ++i) {
            CAPTURE(unshadowed, i);
            CHECK(double(image.plane("bounce1.G")[std::size_t(i)]) ==
                  Approx(expected[std::size_t(i)]).epsilon(kJoined));
        }
    }
}

TEST_CASE("senders: a checkpoint of other pictures is refused; impossible questions are named") {
    const studio_test::TempFolder folder;
    const studio::RayScene scene = patch().build();
    Receivers point(1, 1, vec3(-5, 0.5f, 0));
    point.set(0, 0, kReceiver, kFacing);
    PathTracerOptions options;
    options.samplesPerPixel = 8;
    options.checkpoint = folder.path() + "/film";
    options.sendersSeenBy = {above(1, 1)};
    tracePaths(scene, point.view, options);
    tracePaths(scene, point.view, options);
    options.sendersSeenBy = {above(1, 1.01f)};
    CHECK_THROWS_AS(tracePaths(scene, point.view, options), studio::CheckpointError);
    studio::AmbientOptions ambient;
    options.ambient = &ambient;
    CHECK_THROWS_WITH(tracePaths(scene, point.view, options), Catch::Contains("ambient: expected"));
    options.sendersSeenBy.clear();
    ambient.radius = 0.0;
    CHECK_THROWS_WITH(tracePaths(scene, point.view, options),
                      Catch::Contains("ambient.radius: expected"));
}
