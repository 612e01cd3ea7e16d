// Rays, direct light and G-buffers: sides, masks, scale, motion, determinism.
#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <limits>

#include "emitters.h"
#include "gbuffer.h"
#include "support/studio_scenes.h"

using namespace studio;
using namespace studio_test;

namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

GBuffer still(const RayScene& scene, const Camera& camera, int width, int height) {
    return renderGBuffer(scene, camera, width, height, camera, scene.time());
}

// Floor, a sphere and a turning, moving box; sun and spot.
Scene playground() {
    Scene scene;
    const int grey = addMaterial(scene, glm::vec3(0.5f, 0.4f, 0.3f));
    Object object;
    object.keys = {{0.0f, {-1, 1, 0}, glm::angleAxis(0.0f, glm::vec3(0, 0, 1))},
                   {1.0f, {1, 1.5f, 0.5f}, glm::angleAxis(1.0f, glm::normalize(glm::vec3(1, 2, 3)))}};
    scene.objects.push_back(object);
    add(scene, floorQuad(5, 0), grey);
    add(scene, makeSphere({1.5f, 0.6f, -1}, 0.6f, 24), grey);
    add(scene, makeBox(glm::vec3(-0.5f), glm::vec3(0.5f)), grey, 1);
    scene.cameras.push_back(cameraAt({0.5f, 2.5f, 6}, {0, 0.6f, 0}, 45));
    scene.lights.push_back(sun({0.4f, -1, -0.3f}, 3.0f));
    scene.lights.push_back(spot({-2, 4, 2}, {0, 0, 0}, 40.0f, 0.3f, 0.5f));
    return scene;
}

}  // namespace

TEST_CASE("planar buffers are aligned, padded and zeroed", "[gbuffer]") {
    PlanarBuffer buffer(17, 3, 3);
    CHECK(buffer.rowFloats() == 32);
    CHECK(reinterpret_cast<std::uintptr_t>(buffer.data()) % 64 == 0);
    CHECK(buffer.planeFloats() == 96);
    for (std::size_t i = 0; i < 3 * buffer.planeFloats(); ++i) REQUIRE(buffer.data()[i] == 0.0f);
    buffer.setRgb(16, 2, {1, 2, 3});
    CHECK(buffer.row(1, 2)[16] == 2.0f);
    CHECK(buffer.rgb(16, 2) == glm::vec3(1, 2, 3));
    CHECK_FALSE(failure([] { PlanarBuffer(0, 1, 1); }).empty());
}

TEST_CASE("a surface turns its normals to the ray, whatever its winding", "[ray]") {
    for (const bool wound : {false, true}) {
        Scene scene;
        Mesh quad = floorQuad(1, 0);
        if (wound)
            for (glm::uvec3& t : quad.triangles) std::swap(t.y, t.z);
        add(scene, quad, addMaterial(scene, glm::vec3(0.5f)));
        const RayScene rays(shared(scene), 0.0f);
        for (const float side : {1.0f, -1.0f}) {
            Hit hit;
            REQUIRE(rays.trace({0.1f, side, 0.2f}, {0, -side, 0}, 0.0f, kFar, hit));
            CHECK(hit.geometricNormal == glm::vec3(0, side, 0));
            CHECK(hit.normal == glm::vec3(0, side, 0));
            CHECK(hit.distance == Approx(1.0));
        }
    }
}

TEST_CASE("smooth normals are interpolated and stay on the face's side", "[ray]") {
    Scene scene;
    Mesh mesh = makeSphere({3, 2, 1}, 2.0f, 16);
    for (std::size_t i = 0; i < mesh.normals.size(); i += 3)
        mesh.normals[i] = -mesh.normals[i];  // mixed sources
    add(scene, makeSphere({-3, 2, 1}, 2.0f, 16), addMaterial(scene, glm::vec3(0.5f)));
    add(scene, mesh, 0);
    const RayScene rays(shared(scene), 0.0f);
    for (int i = 0; i < 200; ++i) {
        const glm::vec3 offset(1.9f * std::sin(float(i)) * 0.7f, 1.9f * std::cos(float(i) * 1.7f) * 0.7f,
                               6.0f);
        Hit hit;
        REQUIRE(rays.trace(glm::vec3(-3, 2, 1) + offset, {0, 0, -1}, 0.0f, kFar, hit));
        // 16 bands: a chord's normal is within 6 degrees, the interpolated one far nearer.
        REQUIRE(glm::dot(hit.normal, glm::normalize(hit.position - glm::vec3(-3, 2, 1))) > 0.999f);
        REQUIRE(glm::length(hit.normal) == Approx(1.0).epsilon(1e-5));
        REQUIRE(rays.trace(glm::vec3(3, 2, 1) + offset, {0, 0, -1}, 0.0f, kFar, hit));
        REQUIRE(glm::dot(hit.normal, hit.geometricNormal) >= 0.0f);
        REQUIRE(glm::dot(hit.geometricNormal, glm::vec3(0, 0, -1)) <= 0.0f);
    }
}

TEST_CASE("direct irradiance: closed forms of sun, spot and point, and shadow", "[ray][light]") {
    Scene scene;
    const int grey = addMaterial(scene, glm::vec3(0.5f));
    add(scene, floorQuad(10, 0), grey);
    add(scene, makeBox({4, 1, -1}, {6, 2, 1}), grey);
    const glm::vec3 up(0, 1, 0), p(0.5f, 0, 0.25f);
    const auto irradiance = [&](const Light& light, const glm::vec3& at, const glm::vec3& n) {
        Scene lit = scene;
        lit.lights = {light};
        return double(RayScene(shared(lit), 0.0f).directIrradiance(at, n, n).x);
    };
    const double rounding = 1e-5;
    CHECK(irradiance(sun({1, -1, 0}, 10), p, up) == Approx(10 * std::sqrt(0.5)).epsilon(rounding));
    CHECK(irradiance(sun({1, -1, 0}, 10), p, -up) == 0.0);
    CHECK(irradiance(sun({0, -1, 0}, 10), {5, 0, 0}, up) == 0.0);
    Light point = spot({0.5f, 2, 1.25f}, {0, 0, 0}, 7, 0, 1);
    point.kind = LightKind::Point;
    // I cos / d^2 with d^2 = 5, cos = 2 / sqrt(5)
    CHECK(irradiance(point, p, up) == Approx(7 * 2 / std::pow(5.0, 1.5)).epsilon(rounding));
    const Light cone = spot({0, 2, 0}, {0, 0, 0}, 7, 0.2f, 0.6f);
    const double cosine = 1 / std::sqrt(1.25), distance2 = 5.0;  // 1 aside, 2 below
    const double ramp = (2 * cosine / 2 - std::cos(0.6)) / (std::cos(0.2) - std::cos(0.6));
    CHECK(irradiance(cone, {1, 0, 0}, up) == Approx(7 * ramp * ramp * cosine / distance2).epsilon(1e-4));
    CHECK(irradiance(cone, {3, 0, 0}, up) == 0.0);
}

TEST_CASE("pixels: projection, depth, direct radiance, background", "[gbuffer]") {
    const auto scene = shared(playground());
    const RayScene rays(scene, 0.0f);
    const Camera camera = scene->cameras[0];
    const int width = 97, height = 61;
    const GBuffer g = still(rays, camera, width, height);
    int background = 0;
    // By hand: axes of the camera, tangents of the pixel's angles.
    const glm::dvec3 forward = glm::normalize(glm::dvec3(camera.target) - glm::dvec3(camera.position));
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0))),
                     up = glm::cross(right, forward);
    const double tangent = std::tan(0.5 * double(camera.verticalFov));
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const glm::vec3 normal = g.normal.rgb(x, y);
            if (normal == glm::vec3(0.0f)) {
                ++background;
                REQUIRE(g.position.rgb(x, y) + g.albedo.rgb(x, y) + g.direct.rgb(x, y) ==
                        glm::vec3(0.0f));
                REQUIRE(g.depth.row(0, y)[x] == 0.0f);
                continue;
            }
            const glm::dvec3 way = glm::dvec3(g.position.rgb(x, y)) - glm::dvec3(camera.position);
            const double depth = glm::dot(way, forward);
            REQUIRE(double(g.depth.row(0, y)[x]) == Approx(depth).epsilon(1e-5));
            const double px =
                (glm::dot(way, right) / depth / (tangent * width / height) + 1) * 0.5 * width;
            const double py = (1 - glm::dot(way, up) / depth / tangent) * 0.5 * height;
            REQUIRE(px == Approx(x + 0.5).margin(
                              1e-3));  // float directions: 1e-7 of 100 pixels, on glancing floors more
            REQUIRE(py == Approx(y + 0.5).margin(1e-3));
            REQUIRE(g.motion.row(0, y)[x] == Approx(0.0).margin(1e-3));
            const glm::vec3 n = g.normal.rgb(x, y);
            REQUIRE(glm::length(n) == Approx(1.0).epsilon(1e-5));
        }
    CHECK(background > 0);
    CHECK(background < width * height / 2);
    // A floor pixel that sees the sun and is outside of the spot's cone.
    const glm::vec3 corner = g.direct.rgb(width - 3, height - 3);
    const double cosine = 1 / std::sqrt(1 + 0.16 + 0.09);
    CHECK(double(corner.x) == Approx(0.5 / 3.14159265 * 3 * cosine).epsilon(1e-4));
}

TEST_CASE("motion vectors are those of the surface point, for camera and rigid objects",
          "[gbuffer][motion]") {
    const Scene source = playground();
    const auto scene = shared(source);
    const float now = 0.6f, before = 0.25f;
    const RayScene rays(scene, now);
    const Camera camera = source.cameras[0];
    Camera previous = camera;
    previous.position += glm::vec3(0.3f, -0.2f, 0.4f);
    previous.target += glm::vec3(-0.1f, 0.15f, 0.0f);
    const int width = 96, height = 64;
    const GBuffer g = renderGBuffer(rays, camera, width, height, previous, before);

    // By hand: Rodrigues' rotation about the key's axis by the interpolated angle (the first key is at
    // rest), and projection by dot products.
    const auto pose = [](double t, const glm::dvec3& p, bool inverse) {
        const glm::dvec3 axis = glm::normalize(glm::dvec3(1, 2, 3)),
                         move = glm::dvec3(-1, 1, 0) * (1 - t) + glm::dvec3(1, 1.5, 0.5) * t;
        const double angle = inverse ? -t : t;
        const glm::dvec3 q = inverse ? p - move : p;
        const glm::dvec3 r = q * std::cos(angle) + glm::cross(axis, q) * std::sin(angle) +
                             axis * glm::dot(axis, q) * (1 - std::cos(angle));
        return inverse ? r : r + move;
    };
    const auto project = [&](const Camera& c, const glm::dvec3& p) {
        const glm::dvec3 forward = glm::normalize(glm::dvec3(c.target) - glm::dvec3(c.position));
        const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0))),
                         up = glm::cross(right, forward);
        const glm::dvec3 way = p - glm::dvec3(c.position);
        const double depth = glm::dot(way, forward), tangent = std::tan(0.5 * double(c.verticalFov));
        return glm::dvec2((glm::dot(way, right) / depth / (tangent * width / height) + 1) * 0.5 * width,
                          (1 - glm::dot(way, up) / depth / tangent) * 0.5 * height);
    };
    int onBox = 0, elsewhere = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if (g.normal.rgb(x, y) == glm::vec3(0.0f)) continue;
            const glm::dvec3 p(g.position.rgb(x, y)), local = pose(now, p, true);
            const bool box = glm::all(glm::lessThan(glm::abs(local), glm::dvec3(0.5 + 1e-4)));
            (box ? onBox : elsewhere) += 1;
            const glm::dvec3 then = box ? pose(before, local, false) : p;
            const glm::dvec2 expected = project(previous, then) - project(camera, p);
            INFO(x << " " << y << " box " << box);
            REQUIRE(double(g.motion.row(0, y)[x]) ==
                    Approx(expected.x).margin(2e-3));  // float positions: 1e-6 of 6 m
            REQUIRE(double(g.motion.row(1, y)[x]) == Approx(expected.y).margin(2e-3));
        }
    CHECK(onBox > 50);
    CHECK(elsewhere > 1000);
}

TEST_CASE("a surface behind the previous camera has no place in its picture", "[gbuffer][motion]") {
    Scene scene;
    add(scene, floorQuad(50, 0), addMaterial(scene, glm::vec3(0.5f)));
    const Camera camera = cameraAt({0, 2, 0}, {0, 0, -5}, 40),
                 turned = cameraAt({0, 2, 0}, {0, 0, 5}, 40);
    const GBuffer g = renderGBuffer(RayScene(shared(scene), 0.0f), camera, 16, 16, turned, 0.0f);
    CHECK(std::abs(g.motion.row(0, 15)[8]) > 16.0f);
    CHECK(std::isfinite(g.motion.row(0, 15)[8]));
}

TEST_CASE("another unit of length gives the same picture", "[gbuffer][scale]") {
    const Scene source = playground();
    const int width = 160, height = 100;
    const auto render = [&](float factor) {
        const auto scene = shared(scaled(source, factor));
        const RayScene rays(scene, 0.4f);
        return still(rays, scene->cameras[0], width, height);
    };
    const GBuffer base = render(1.0f);
    for (const float factor : {10.0f, 0.1f}) {
        const GBuffer other = render(factor);
        int different = 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const glm::vec3 a = base.direct.rgb(x, y), b = other.direct.rgb(x, y);
                const glm::vec3 p = base.position.rgb(x, y), q = other.position.rgb(x, y) / factor;
                const bool same =
                    glm::length(a - b) <= 1e-4f * (glm::length(a) + 0.1f) && glm::length(p - q) <= 1e-4f;
                different += same ? 0 : 1;
            }
        INFO(factor);
        CHECK(different <=
              width * height / 1000);  // edges and shadow borders within rounding of a pixel centre
    }
}

TEST_CASE("no acne and no leak: floors lit at grazing angles far from the origin", "[ray][light]") {
    for (const float far : {0.0f, 100.0f, 1000.0f}) {
        Scene scene;
        Mesh quad = floorQuad(10, 0);
        for (glm::vec3& p : quad.positions) p += glm::vec3(far, 0, far);
        add(scene, quad, addMaterial(scene, glm::vec3(0.5f)));
        scene.lights.push_back(sun({1, -0.02f, 0.3f}, 1.0f));
        const RayScene rays(shared(scene), 0.0f);
        const Camera camera = cameraAt({far, 6, far + 1}, {far, 0, far}, 60);
        const GBuffer g = still(rays, camera, 64, 64);
        int dark = 0;
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x)
                if (g.normal.rgb(x, y) != glm::vec3(0.0f) && g.direct.rgb(x, y).x <= 0.0f) ++dark;
        INFO(far);
        CHECK(dark == 0);
    }
}

TEST_CASE("scenes without extent, or beyond what floats can hold, are refused", "[ray]") {
    const auto built = [](float side) {
        Scene scene;
        scene.name = "s";
        add(scene, floorQuad(side, 0), addMaterial(scene, glm::vec3(0.5f)));
        return failure([&] { RayScene(shared(scene), 0.0f); });
    };
    CHECK(built(1.0f).empty());
    CHECK_THAT(built(1e10f), Catch::Contains("\"s\"") && Catch::Contains("diagonal"));
    CHECK_THAT(built(1e-10f), Catch::Contains("diagonal"));
    CHECK_THAT(built(1e37f), Catch::Contains("at least one triangle"));  // Embree leaves them out
    CHECK_THAT(failure([] { RayScene(shared(Scene()), 0.0f); }),
               Catch::Contains("at least one triangle"));
}

TEST_CASE("two runs give the same bits", "[gbuffer]") {
    const auto scene = shared(loadScene("cornell"));
    const Camera camera = scene->cameras[0];
    const GBuffer a = still(RayScene(scene, 0.0f), camera, 80, 80),
                  b = still(RayScene(scene, 0.0f), camera, 80, 80);
    for (const auto& [first, second] :
         {std::make_pair(&a.position, &b.position), std::make_pair(&a.direct, &b.direct)})
        CHECK(std::memcmp(first->data(), second->data(), 3 * first->planeFloats() * sizeof(float)) == 0);
}

TEST_CASE("emissive surfaces light pixels directly: furnace and lamp against closed forms",
          "[gbuffer][emitters]") {
    // Furnace: E = exitance = 1 everywhere.
    const auto furnace = shared(loadScene("furnace"));
    const GBuffer g = still(RayScene(furnace, 0.0f), furnace->cameras[0], 48, 32);
    double sum = 0.0, squares = 0.0, worst = 0.0;
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 48; ++x) {
            const double e = double(g.direct.rgb(x, y).x) * 3.14159265 / 0.5;
            sum += e;
            squares += (e - 1) * (e - 1);
            worst = std::max(worst, std::abs(e - 1));
        }
    CHECK(sum / (48 * 32) == Approx(1.0).epsilon(2e-3));  // mean of 1536 pixels
    CHECK(std::sqrt(squares / (48 * 32)) < 0.02);
    CHECK(worst < 0.15);  // a pixel in a corner, where an emitter is near

    // Square lamp of side 1 at height 1 over a point below its centre: four corner rectangles, each
    // E = L/2 (a/s1 atan(b/s1) + b/s2 atan(a/s2)), s1 = sqrt(1+a^2), s2 = sqrt(1+b^2) (Lambert).
    Scene scene;
    const int grey = addMaterial(scene, glm::vec3(0.5f)), lamp = addMaterial(scene, glm::vec3(0.0f));
    scene.materials[std::size_t(lamp)].emission = glm::vec3(4.0f);
    scene.emissiveSurfaces = true;
    add(scene, floorQuad(3, 0), grey);
    add(scene, floorQuad(0.5f, 1), lamp);
    const RayScene rays(shared(scene), 0.0f);
    const EmitterSet emitters(rays);
    const double s = std::sqrt(1.25), expected = 4 * 4.0 / 2 * 2 * (0.5 / s) * std::atan(0.5 / s);
    double mean = 0.0;
    for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
        const double e = double(emitters.irradiance({0, 0, 0}, {0, 1, 0}, {0, 1, 0}, pixel).x);
        CHECK(e == Approx(expected).epsilon(0.04));  // five standard deviations
        mean += e / 64;
    }
    CHECK(mean == Approx(expected).epsilon(5e-3));
    CHECK(EmitterSet(RayScene(shared(loadScene("cornell")), 0.0f)).empty());
}

TEST_CASE("an alpha mask's holes neither glow nor cast a shadow", "[gbuffer][emitters]") {
    // The lamp of the case before with its half u < 1/2 cut away: half of the light is left by symmetry.
    Scene scene;
    Texture holes;  // bilinear and repeating, so that alpha is above 1/2 exactly where u is
    holes.width = 2;
    holes.height = 1;
    holes.rgba = {255, 255, 255, 0, 255, 255, 255, 255};
    scene.textures.push_back(holes);
    const int grey = addMaterial(scene, glm::vec3(0.5f)), lamp = addMaterial(scene, glm::vec3(0.0f));
    scene.materials[std::size_t(lamp)].emission = glm::vec3(4.0f);
    scene.materials[std::size_t(lamp)].texture = 0;
    scene.materials[std::size_t(lamp)].alphaCutoff = 0.5f;
    scene.emissiveSurfaces = true;
    add(scene, floorQuad(3, 0), grey);
    add(scene, floorQuad(0.5f, 1), lamp);
    const Light above = sun({0, -1, 0}, 2);
    const RayScene rays(shared(scene), 0.0f);
    const EmitterSet emitters(rays);
    const double s = std::sqrt(1.25), whole = 4 * 4.0 / 2 * 2 * (0.5 / s) * std::atan(0.5 / s);
    double mean = 0.0;
    for (std::uint32_t pixel = 0; pixel < 64; ++pixel)
        mean += double(emitters.irradiance({0, 0, 0}, {0, 1, 0}, {0, 1, 0}, pixel).x) / 64;
    CHECK(mean == Approx(0.5 * whole).epsilon(0.01));
    // Through the hole the sun reaches the floor; u runs with x.
    const glm::vec3 up(0, 1, 0);
    CHECK(rays.directIrradiance(above, {-0.25f, 0, 0}, up, up).x == Approx(2.0f));
    CHECK(rays.directIrradiance(above, {0.25f, 0, 0}, up, up).x == 0.0f);
}

TEST_CASE("the sky is direct light: open plane, foot of a wall, closed room", "[gbuffer][emitters]") {
    Scene scene;
    const int grey = addMaterial(scene, glm::vec3(0.5f));
    scene.sky = glm::vec3(0.3f);
    add(scene, floorQuad(10, 0), grey);
    const auto irradiance = [&](const glm::vec3& at) {
        const RayScene rays(shared(scene), 0.0f);
        double mean = 0.0;
        for (std::uint32_t pixel = 0; pixel < 64; ++pixel)
            mean += double(EmitterSet(rays).irradiance(at, {0, 1, 0}, {0, 1, 0}, pixel).x) / 64;
        return mean;
    };
    const double open = 3.14159265 * 0.3;
    CHECK(irradiance({0, 0, 0}) == Approx(open).epsilon(1e-5));
    // A wall of height H at distance t, long against both: (1 + cos atan(H / t)) / 2 of it stays.
    add(scene, makeBox({1, 0, -1000}, {2, 1, 1000}), grey);
    CHECK(irradiance({0, 0, 0}) == Approx(open * (1 + std::sqrt(0.5)) / 2).epsilon(3e-3));
    add(scene, makeBox({-20, -1, -1200}, {20, 5, 1200}), grey);
    CHECK(irradiance({0, 0, 0}) == 0.0);
}
