// Instant radiosity: flux is conserved, one photon is the light's axis, patterns stand still and sweep without
// a jump, the gather is the one in double, form factors, and with many photons the path tracer's first bounce.
#include <catch2/catch.hpp>
#include <cmath>

#include "../support/quad_scene.h"
#include "../support/rival_view.h"
#include "instant_radiosity.h"
#include "light_rays.h"

namespace {

using namespace studio;
constexpr double pi = test::kPi;

glm::dvec3 fluxOf(const std::vector<VplRecord>& vpls) {
    glm::dvec3 sum(0.0);
    for (const VplRecord& v : vpls) sum += glm::dvec3(v.flux);
    return sum;
}

struct Picture {
    PlanarBuffer irradiance, validity;
    InstantRadiosityTimes times;
};

Picture render(const RayScene& scene, const GBuffer& gbuffer, std::uint32_t vpls, bool shadows) {
    Picture p{PlanarBuffer(gbuffer.width, gbuffer.height, 3), PlanarBuffer(gbuffer.width, gbuffer.height, 1), {}};
    InstantRadiosityOptions options;
    options.vpls = vpls;
    options.shadows = shadows ? 1 : 0;
    p.times = InstantRadiosity(options).render(scene, gbuffer, p.irradiance, p.validity);
    return p;
}

double mean(const PlanarBuffer& buffer, int channel) {
    double sum = 0.0;
    for (int y = 0; y < buffer.height(); ++y)
        for (int x = 0; x < buffer.width(); ++x) sum += double(buffer.row(channel, y)[x]);
    return sum / (double(buffer.width()) * buffer.height());
}

// A closed box of one reflectance with a spot in it.
test::QuadScene spotRoom(const glm::vec3& direction, float inner, float outer) {
    test::QuadScene s;
    s.box(s.material(glm::vec3(0.2f, 0.5f, 0.8f)), glm::vec3(-2.0f), glm::vec3(2.0f));
    Light light;
    light.kind = LightKind::Spot;
    light.position = {0.1f, 0.2f, -0.1f};
    light.direction = glm::normalize(direction);
    light.emitted = glm::vec3(3.0f);
    light.innerCone = inner, light.outerCone = outer;
    s.scene.lights.push_back(light);
    return s;
}

}  // namespace

TEST_CASE("instant radiosity: VPLs carry the reflected flux, of a point light with any number of photons") {
    const rival_test::View room("sphere_room", 8, 8);  // intensity pi, albedo 1/2
    for (const std::uint32_t count : {1u, 7u, 200u}) {
        const auto vpls = tracePhotons(room.rays, count, 0);
        REQUIRE(vpls.size() == count);
        CHECK(fluxOf(vpls).x == Approx(0.5 * 4.0 * pi * pi).epsilon(1e-5));
        double area = 0.0;
        for (const VplRecord& v : vpls) area += double(v.area);
        // Facets of 32 rings stand nearer than the radius by up to half a per cent.
        CHECK(area == Approx(4.0 * pi).epsilon(0.012));
    }
}

TEST_CASE("instant radiosity: VPLs carry the reflected flux, of spots with a falloff and of a slanted sun") {
    for (const float inner : {0.0f, 0.3f}) {
        const float outer = 0.6f;
        const test::QuadScene s = spotRoom({0.3f, -1.0f, 0.2f}, inner, outer);
        const RayScene scene = s.build();
        const double ci = std::cos(double(inner)), co = std::cos(double(outer));
        const double lit = 3.0 * 2.0 * pi * ((1.0 - ci) + (ci - co) / 3.0);  // the ramp's square is 1/3 in the mean
        const glm::dvec3 flux = fluxOf(tracePhotons(scene, 4096, 0));
        // 4,096 points of a set of low discrepancy over a bounded profile.
        CHECK(flux.x == Approx(0.2 * lit).epsilon(0.002));
        CHECK(flux.z == Approx(0.8 * lit).epsilon(0.002));
    }
    test::QuadScene s;
    s.quad(s.material(glm::vec3(0.5f)), {0, 0, 0}, {0, 0, 2}, {3, 0, 2}, {3, 0, 0});
    s.sun({0.5f, -1.0f, 0.25f}, glm::vec3(10.0f));
    const RayScene scene = s.build();
    const double cosine = 1.0 / std::sqrt(1.0 + 0.25 + 0.0625);
    const auto vpls = tracePhotons(scene, 4096, 0);
    CHECK(fluxOf(vpls).y == Approx(0.5 * 10.0 * 6.0 * cosine).epsilon(0.01));
    for (const VplRecord& v : vpls)
        REQUIRE(double(v.flux.x / v.area) == Approx(0.5 * 10.0 * cosine).epsilon(1e-4));  // exitance
}

TEST_CASE("instant radiosity: one photon is the spot's axis, with all of its cone's solid angle") {
    const test::QuadScene s = spotRoom({0.0f, -1.0f, 0.0f}, 0.2f, 0.4f);
    const RayScene scene = s.build();
    const auto vpls = tracePhotons(scene, 1, 0);
    REQUIRE(vpls.size() == 1);
    CHECK(glm::length(vpls[0].position - glm::vec3(0.1f, -2.0f, -0.1f)) < 1e-5f);
    CHECK(vpls[0].normal == glm::vec3(0, 1, 0));
    const double cap = 2.0 * pi * (1.0 - std::cos(0.4));
    CHECK(double(vpls[0].flux.y) == Approx(0.5 * 3.0 * cap).epsilon(1e-5));
    CHECK(double(vpls[0].area) == Approx(cap * 2.2 * 2.2).epsilon(1e-5));
}

TEST_CASE("instant radiosity: patterns stand still, turn with their seed, and sweep with a light without a jump") {
    const test::QuadScene s = spotRoom({1.0f, -1.0f, 0.3f}, 0.3f, 0.5f);
    const RayScene scene = s.build();
    const auto same = [](const std::vector<VplRecord>& a, const std::vector<VplRecord>& b) {
        if (a.size() != b.size()) return false;
        for (std::size_t i = 0; i < a.size(); ++i)
            if (a[i].position != b[i].position || a[i].flux != b[i].flux || a[i].area != b[i].area) return false;
        return true;
    };
    CHECK(same(tracePhotons(scene, 50, 0), tracePhotons(scene, 50, 0)));
    CHECK_FALSE(same(tracePhotons(scene, 50, 0), tracePhotons(scene, 50, 3)));

    // From straight down to 30 degrees from straight up in steps of a degree: no ray turns by much more.
    constexpr double step = pi / 180.0;
    double most = 0.0;
    std::vector<glm::vec3> before;
    for (int i = 0; i <= 150; ++i) {
        Light light = s.scene.lights[0];
        const double angle = step * i;
        light.direction = glm::vec3(glm::normalize(glm::dvec3(std::sin(angle), -std::cos(angle), 0.05)));
        const LightRays rays(scene, light);
        std::vector<glm::vec3> now;
        for (int k = 0; k < 16; ++k) now.push_back(rays.at({(k % 4 + 0.5) / 4.0, (k / 4 + 0.5) / 4.0}).direction);
        for (std::size_t k = 0; k < before.size(); ++k)
            most = std::max(most, std::acos(std::min(1.0, double(glm::dot(before[k], now[k])))));
        before = now;
    }
    CHECK(most < 2.0 * step);
}

TEST_CASE("instant radiosity: the gather is the sum in double, with and without shadows") {
    const rival_test::View view("cornell", 32, 18);
    const auto vpls = tracePhotons(view.rays, 300, 0);
    for (const bool shadows : {false, true}) {
        PathTracerOptions options;
        options.vpls = &vpls;
        options.unshadowed = !shadows;
        const Image truth = tracePaths(view.rays, view.gbuffer, options);
        const Picture picture = render(view.rays, view.gbuffer, 300, shadows);
        CHECK((picture.times.shadowRays > 0) == shadows);
        for (int c = 0; c < 3; ++c)
            for (int y = 0; y < 18; ++y)
                for (int x = 0; x < 32; ++x) {
                    CAPTURE(shadows, c, x, y);
                    REQUIRE(double(picture.irradiance.row(c, y)[x]) ==
                            Approx(rival_test::truthAt(truth, 1, c, x, y)).epsilon(1e-4).margin(1e-6));
                }
    }
}

TEST_CASE("instant radiosity: form factors of unit squares") {
    test::QuadScene s;
    s.quad(s.material(glm::vec3(0.5f)), {0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0});
    s.sun({0, -1, 0}, glm::vec3(2.0f));
    const RayScene scene = s.build();
    test::Receivers facing(16, 16), upright(64, 64);
    facing.grid({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0});
    upright.grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    for (const bool shadows : {false, true}) {
        // Exitance 1. Receivers at the common edge lie nearer to it than a VPL's radius: what bounding takes there.
        CHECK(mean(render(scene, facing.view, 1024, shadows).irradiance, 1) == Approx(0.1998249).epsilon(0.002));
        CHECK(mean(render(scene, upright.view, 4096, shadows).irradiance, 1) == Approx(0.2000438).epsilon(0.02));
    }
}

TEST_CASE("instant radiosity: with many photons and shadows it is the path tracer's first bounce") {
    const rival_test::View view("cornell", 24, 18);
    const Image truth = rival_test::truthOf(view, 2048);
    const double noise = estimateNoise(truth, {"bounce1"});
    const auto errorOf = [&](std::uint32_t count) {
        Picture p = render(view.rays, view.gbuffer, count, true);
        return rival_test::errorOf({std::move(p.irradiance), std::move(p.validity), {}}, truth, 1);
    };
    double before = 1e9;
    rival_test::Error error;
    for (const std::uint32_t count : {64u, 512u, 4096u, 32768u}) {
        error = errorOf(count);
        INFO(count << ": relMSE " << error.relMse << ", bias " << error.bias << ", noise " << noise);
        CHECK(error.relMse < 0.5 * before + noise);
        before = error.relMse;
    }
    CHECK(error.relMse < 0.001 + 4.0 * noise);
    CHECK(std::abs(error.bias) < 0.005);
}

TEST_CASE("instant radiosity refuses what it cannot mean") {
    InstantRadiosityOptions none;
    none.vpls = 0;
    CHECK_THROWS_WITH(InstantRadiosity(none), Catch::Contains("vpls") && Catch::Contains("got 0"));
    InstantRadiosityOptions odd;
    odd.shadows = 2;
    CHECK_THROWS_WITH(InstantRadiosity(odd), Catch::Contains("shadows") && Catch::Contains("got 2"));
    const rival_test::View view("basic", 16, 9);
    PlanarBuffer irradiance(16, 9, 3), narrow(15, 9, 1);
    CHECK_THROWS_WITH(InstantRadiosity({}).render(view.rays, view.gbuffer, irradiance, narrow),
                      Catch::Contains("validity") && Catch::Contains("15 x 9"));
}
