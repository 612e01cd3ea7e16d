// Reflective shadow maps against closed forms: total flux, Phi / A = rho E, projections, cascades, fit.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "gbuffer.h"
#include "support/studio_scenes.h"

using namespace studio;
using namespace studio_test;
using Catch::Contains;

namespace {

constexpr double kPiD = 3.14159265358979323846;

double totalFlux(const Rsm& rsm) {
    double sum = 0.0;
    for (int y = 0; y < rsm.height; ++y)
        for (int x = 0; x < rsm.width; ++x) sum += double(rsm.flux.rgb(x, y).x);
    return sum;
}

double totalFlux(const std::vector<Rsm>& rsms) {
    double sum = 0.0;
    for (const Rsm& rsm : rsms) sum += totalFlux(rsm);
    return sum;
}

RsmOptions size(int texels, int cascades = 1, const GBuffer* view = nullptr) {
    RsmOptions options;
    options.size = texels;
    options.cascades = cascades;
    options.view = view;
    return options;
}

// Footprint of an orthographic map in light space, (left, right, bottom, top), from its matrices.
glm::dvec4 footprint(const Rsm& rsm) {
    const glm::dmat4 p(rsm.projection);
    const double width = 2 / p[0][0], height = 2 / p[1][1];
    const double left = -(1 + p[3][0]) / p[0][0], bottom = -(1 + p[3][1]) / p[1][1];
    return {left, left + width, bottom, bottom + height};
}

}  // namespace

TEST_CASE("sun on a plane: flux is rho * E_perp * projected area", "[rsm]") {
    Scene scene;
    add(scene, floorQuad(1, 0), addMaterial(scene, glm::vec3(0.4f)));
    const RayScene rays(shared(scene), 0.0f);
    for (const glm::vec3& direction :
         {glm::vec3(0, -1, 0), glm::vec3(1, -1, 0.5f), glm::vec3(2, -0.5f, 1)}) {
        const Light light = sun(direction, 10);
        const double cosine = std::abs(double(light.direction.y));
        const std::vector<Rsm> rsms = renderRsms(rays, light, size(512));
        REQUIRE(rsms.size() == 1);
        // Counting texel centres: off by at most about half a texel along the outline, 2 / 512.
        CHECK(totalFlux(rsms) == Approx(0.4 * 10 * 4 * cosine).epsilon(4e-3));
    }
}

TEST_CASE("spot over a plane: flux is rho times the profile's integral over the cone", "[rsm]") {
    Scene scene;
    add(scene, floorQuad(100, 0), addMaterial(scene, glm::vec3(0.3f)));
    const RayScene rays(shared(scene), 0.0f);
    for (const auto& [inner, outer] :
         {std::make_pair(0.2f, 0.5f), std::make_pair(0.6f, 0.6f), std::make_pair(0.0f, 1.2f)}) {
        const Light light = spot({0, 3, 0}, {0.3f, 0, 0.2f}, 5, inner, outer);
        const std::vector<Rsm> rsms = renderRsms(rays, light, size(512));
        REQUIRE(rsms.size() == 1);
        // The ramp squared in the cosine integrates to a third of its width.
        const double a = std::cos(double(inner)), b = std::cos(double(outer));
        const double expected = 0.3 * 5 * 2 * kPiD * ((1 - a) + (a - b) / 3);
        INFO(inner << " " << outer);
        CHECK(totalFlux(rsms) == Approx(expected).epsilon(3e-3));  // the hard cone's outline in texels
        CHECK(rsms[0].normal.rgb(0, 0) !=
              glm::vec3(0.0f));  // a surface outside of the cone, without flux
        CHECK(rsms[0].flux.rgb(0, 0) == glm::vec3(0.0f));
    }
}

TEST_CASE("wide spots and points are drawn as cube faces that hold all the light", "[rsm]") {
    Scene scene;
    const glm::vec3 center(0.2f, 0.1f, -0.3f);
    add(scene, makeBox(glm::vec3(-1), glm::vec3(1)), addMaterial(scene, glm::vec3(0.6f)));
    const RayScene rays(shared(scene), 0.0f);
    const Light wide = spot(center, {0.5f, -1, 0.3f}, 2, 1.0f, 1.5f);
    const std::vector<Rsm> faces = renderRsms(rays, wide, size(128));
    CHECK(faces.size() == 5);
    const double a = std::cos(1.0), b = std::cos(1.5);
    CHECK(totalFlux(faces) == Approx(0.6 * 2 * 2 * kPiD * ((1 - a) + (a - b) / 3)).epsilon(2e-3));
    Light point = wide;
    point.kind = LightKind::Point;
    const std::vector<Rsm> six = renderRsms(rays, point, size(128));
    CHECK(six.size() == 6);
    // A closed room takes all of 4 pi I. Midpoint rule over each face: second order, 1e-5 at 128 texels.
    CHECK(totalFlux(six) == Approx(0.6 * 2 * 4 * kPiD).epsilon(1e-4));
}

TEST_CASE("Phi / A is rho * E_direct, and texels project to themselves", "[rsm]") {
    const auto scene = shared(loadScene("cornell"));
    const RayScene rays(scene, 0.0f);
    const int n = 128;
    std::vector<Light> lights = scene->lights;
    lights.push_back(sun({0.3f, -0.4f, 1}, 6));  // in through the open front
    for (const Light& light : lights) {
        Scene lit = *scene;
        lit.lights = {light};
        const RayScene alone(shared(lit), 0.0f);
        const Rsm rsm = std::move(renderRsms(rays, light, size(n))[0]);
        const glm::dmat4 p(rsm.projection), clip = p * glm::dmat4(rsm.view);
        int lighted = 0, wrong = 0;
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) {
                const glm::vec3 normal = rsm.normal.rgb(x, y), position = rsm.position.rgb(x, y);
                if (normal == glm::vec3(0.0f)) continue;
                const glm::dvec4 c = clip * glm::dvec4(position, 1.0);
                REQUIRE((c.x / c.w + 1) * 0.5 * n == Approx(x + 0.5).margin(1e-2));
                REQUIRE((1 - c.y / c.w) * 0.5 * n == Approx(y + 0.5).margin(1e-2));
                REQUIRE(c.z / c.w >= 0.0);
                REQUIRE(c.z / c.w <= 1.0 + 1e-6);
                const double flux = double(rsm.flux.rgb(x, y).x);
                if (flux <= 0.0) continue;
                // A_p from the matrices alone.
                double area = 4 / (p[0][0] * p[1][1] * n * n), cosine = 0.0;
                if (light.kind == LightKind::Sun) {
                    cosine = -double(glm::dot(normal, light.direction));
                } else {
                    const glm::dvec3 way = glm::dvec3(position) - glm::dvec3(light.position);
                    const double distance = glm::length(way),
                                 axis = glm::dot(way, glm::dvec3(light.direction)) / distance;
                    area *= axis * axis * axis * distance * distance;
                    cosine = -glm::dot(glm::dvec3(normal), way) / distance;
                }
                REQUIRE(cosine > 0.0);
                const double e = double(alone.directIrradiance(position, normal, normal).x);
                Hit hit;
                const glm::vec3 above = rays.offset(position, normal) + normal * 0.01f;
                if (!rays.trace(above, -normal, 0.0f, 1.0f, hit)) {
                    ++wrong;
                    continue;
                }
                ++lighted;
                if (std::abs(flux / (area / cosine) - double(hit.albedo.x) * e) >
                    1e-3 * flux / (area / cosine))
                    ++wrong;
            }
        INFO(light.name);
        CHECK(lighted > n * n / 8);
        CHECK(wrong <= lighted / 100);  // texels at an edge, whose albedo or shadow is the neighbour's
    }
}

TEST_CASE("normals are on the lit side; the face's where the interpolated one leans away", "[rsm]") {
    Scene scene;
    Mesh quad = floorQuad(1, 0);
    for (glm::vec3& n : quad.normals) n = glm::normalize(glm::vec3(1, 0.1f, 0));
    add(scene, quad, addMaterial(scene, glm::vec3(0.5f)));
    const RayScene rays(shared(scene), 0.0f);
    // Light from -x above: the face is lit, the leaning normal faces away.
    const Rsm rsm = std::move(renderRsms(rays, sun({1, -1, 0}, 1), size(16))[0]);
    CHECK(rsm.normal.rgb(8, 8) == glm::vec3(0, 1, 0));
    const Rsm below = std::move(renderRsms(rays, sun({0, 1, 0}, 1), size(16))[0]);
    CHECK(below.normal.rgb(8, 8).y < 0.0f);
}

TEST_CASE("cascades nest on texel edges, and split and unsplit totals agree", "[rsm][cascades]") {
    const auto scene = shared(loadScene("basic"));
    const RayScene rays(scene, 0.0f);
    const Camera camera = scene->cameras[1];
    const GBuffer view = renderGBuffer(rays, camera, 96, 54, camera, 0.0f);
    for (const GBuffer* seen : {static_cast<const GBuffer*>(nullptr), &view}) {
        const std::vector<Rsm> one = renderRsms(rays, scene->lights[0], size(256, 1, seen));
        const std::vector<Rsm> three = renderRsms(rays, scene->lights[0], size(256, 3, seen));
        REQUIRE(three.size() == 3);
        CHECK(totalFlux(three) == Approx(totalFlux(one)).epsilon(4e-3));  // outlines in finer texels
        CHECK(totalFlux(three[0]) > 0.0);
        for (std::size_t i = 1; i < 3; ++i) {
            const glm::dvec4 fine = footprint(three[i - 1]), coarse = footprint(three[i]);
            const double texelX = (coarse.y - coarse.x) / 256, texelY = (coarse.w - coarse.z) / 256;
            CHECK((fine.y - fine.x) * 2 == Approx(coarse.y - coarse.x).epsilon(1e-5));
            const double offX = (fine.x - coarse.x) / texelX, offY = (fine.z - coarse.z) / texelY;
            CHECK(offX == Approx(std::round(offX)).margin(1e-2));  // float matrices
            CHECK(offY == Approx(std::round(offY)).margin(1e-2));
            CHECK(offX > -0.01);
            CHECK(offX < 128.01);
        }
    }
}

TEST_CASE("a sun's map holds 99.9 % of what can light the view, and is no larger than that needs",
          "[rsm][fit]") {
    // A box on a floor of 200 m, seen close up.
    Scene scene;
    const int grey = addMaterial(scene, glm::vec3(0.5f));
    add(scene, floorQuad(100, 0), grey);
    add(scene, makeBox({-1, 0, -1}, {1, 2, 1}), grey);
    add(scene, makeBox({30, 0, -40}, {33, 15, 40}), grey);
    const RayScene rays(shared(scene), 0.0f);
    const Camera camera = cameraAt({3, 2, 4}, {0, 0.8f, 0}, 50);
    const int w = 80, h = 45;
    const GBuffer view = renderGBuffer(rays, camera, w, h, camera, 0.0f);
    const Light light = sun({-0.6f, -1, -0.2f}, 5);
    const std::vector<Rsm> fitted = renderRsms(rays, light, size(256, 1, &view)),
                           whole = renderRsms(rays, light, size(1024));
    const glm::dvec4 part = footprint(fitted[0]), all = footprint(whole[0]);
    const glm::dmat4 toLight(whole[0].view);

    // Independently of the fit: every texel of the whole scene's map to every fifth pixel.
    double inside = 0.0, total = 0.0;
    const double texel = (all.y - all.x) * (all.w - all.z) / (1024.0 * 1024.0);
    for (int y = 0; y < 1024; ++y)
        for (int x = 0; x < 1024; ++x) {
            const glm::dvec3 n(whole[0].normal.rgb(x, y)), p(whole[0].position.rgb(x, y));
            if (n == glm::dvec3(0.0)) continue;
            double sum = 0.0;
            for (int j = 2; j < h; j += 9)
                for (int i = 2; i < w; i += 10) {
                    const glm::dvec3 m(view.normal.rgb(i, j)),
                        way = p - glm::dvec3(view.position.rgb(i, j));
                    if (m == glm::dvec3(0.0)) continue;
                    const double d2 = glm::dot(way, way), c = glm::dot(m, way), cp = -glm::dot(n, way);
                    if (c > 0 && cp > 0) sum += c * cp / (d2 * (d2 + texel / kPiD));
                }
            const glm::dvec4 at = toLight * glm::dvec4(p, 1.0);
            total += sum;
            if (at.x > part.x && at.x < part.y && at.y > part.z && at.y < part.w) inside += sum;
        }
    CHECK(inside / total > 0.999);
    CHECK((part.y - part.x) * (part.w - part.z) < 0.8 * (all.y - all.x) * (all.w - all.z));

    // A small step of the camera leaves the texels where they were.
    Camera moved = camera;
    moved.position.x += 0.013f;
    const GBuffer next = renderGBuffer(rays, moved, w, h, camera, 0.0f);
    const glm::dvec4 after = footprint(renderRsms(rays, light, size(256, 1, &next))[0]);
    if (std::abs((after.y - after.x) - (part.y - part.x)) < 1e-3) {
        const double steps = (after.x - part.x) / ((part.y - part.x) / 256);
        CHECK(steps == Approx(std::round(steps)).margin(0.02));
    }
}

TEST_CASE("maps in another unit of length are the same", "[rsm][scale]") {
    for (const char* name : {"basic", "cornell"}) {
        const Scene source = loadScene(name);
        const RayScene base(shared(source), 0.0f);
        const double expected = totalFlux(renderRsms(base, source.lights[0], size(128)));
        for (const float factor : {10.0f, 0.1f}) {
            const Scene other = scaled(source, factor);
            const RayScene rays(shared(other), 0.0f);
            const std::vector<Rsm> rsms = renderRsms(rays, other.lights[0], size(128));
            CHECK(totalFlux(rsms) / (double(factor) * double(factor)) == Approx(expected).epsilon(1e-4));
        }
    }
}

TEST_CASE("wrong options are named", "[rsm]") {
    const auto scene = shared(loadScene("cornell"));
    const RayScene rays(scene, 0.0f);
    CHECK_THAT(failure([&] { renderRsms(rays, scene->lights[0], size(0)); }),
               Contains("RSM size") && Contains("got 0"));
    CHECK_THAT(failure([&] { renderRsms(rays, scene->lights[0], size(64, 2)); }),
               Contains("cascades") && Contains("lamp"));
    CHECK_THAT(failure([&] { renderRsms(rays, sun({0, -1, 0}, 1), size(63, 2)); }), Contains("even"));
}
