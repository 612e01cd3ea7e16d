// The path tracer's light, against values known without it: furnace, form factors, Lambert's polygon
// formula, quadrature. What a run does besides (halves, threads, checkpoints) is in
// reference_run_test.cpp.
#include <catch2/catch.hpp>

#include "../support/quad_scene.h"
#include "path_tracer.h"
#include "sampler.h"

using glm::vec3;
using studio::Image;
using studio::PathTracerOptions;
using test::kPi;
using test::QuadScene;
using test::Receivers;

namespace {

PathTracerOptions samples(int spp) {
    PathTracerOptions options;
    options.samplesPerPixel = spp;
    return options;
}

double mean(const Image& image, const std::string& channel) {
    double sum = 0.0;
    for (const float value : image.plane(channel)) sum += double(value);
    return sum / double(image.pixelCount());
}

// Irradiance per unit radiance of a polygon at the origin of a frame whose z is the receiver's normal:
// Lambert 1760, clipped at the horizon. Doubles, and nothing of the code under test.
double polygonIrradiance(const std::vector<glm::dvec3>& corners, const glm::dvec3& at,
                         const glm::dvec3& normal) {
    std::vector<glm::dvec3> above;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a = corners[i] - at, b = corners[(i + 1) % corners.size()] - at;
        const double ha = glm::dot(a, normal), hb = glm::dot(b, normal);
        if (ha >= 0.0) above.push_back(a);
        if (ha * hb < 0.0) above.push_back(a + (b - a) * (ha / (ha - hb)));
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < above.size(); ++i) {
        const glm::dvec3 a = glm::normalize(above[i]), b = glm::normalize(above[(i + 1) % above.size()]);
        const glm::dvec3 edge = glm::cross(a, b);
        const double sine = glm::length(edge);
        if (sine > 1e-12) sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(edge / sine, normal);
    }
    return std::abs(0.5 * sum);
}

// Sum over n x n cells of a parallelogram; f(point) per area.
template <class F>
double integrate(const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v, const F& f) {
    constexpr int n = 400;  // midpoint rule: relative error below 1e-4 for the integrands here
    double sum = 0.0;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) sum += f(corner + u * ((i + 0.5) / n) + v * ((j + 0.5) / n));
    return sum * glm::length(glm::cross(u, v)) / (n * n);
}

// Geometry factor c c_p / d^2 between a receiver and a point of an emitter.
double coupling(const glm::dvec3& x, const glm::dvec3& nx, const glm::dvec3& y, const glm::dvec3& ny) {
    const glm::dvec3 w = y - x;
    const double d2 = glm::dot(w, w);
    return std::max(0.0, glm::dot(nx, w)) * std::max(0.0, -glm::dot(ny, w)) / (d2 * d2);
}

// Relative error of a mean of a few ten thousand samples whose relative deviation is about one, times
// four or more.
constexpr double kStatistical = 0.01;

// The same where lit points and rays share the light: ten thousand points of stratified sequences.
constexpr double kJoined = 0.002;

}  // namespace

TEST_CASE("sample pairs are (0,2)-nets, and different from stream to stream") {
    constexpr int kBits = 8, kCount = 1 << kBits;
    for (const std::uint64_t stream : {0u, 7u, 123456u})
        for (int skip = 0; skip < 5; ++skip) {
            std::vector<glm::vec2> points;
            for (int i = 0; i < kCount; ++i) {
                studio::Sampler sampler(42, stream, std::uint32_t(i));
                for (int p = 0; p < skip; ++p) sampler.next();
                points.push_back(sampler.next());
            }
            // Every elementary interval of area 1/256 holds exactly one of 256 points.
            for (int bits = 0; bits <= kBits; ++bits) {
                std::vector<int> hits(kCount, 0);
                for (const glm::vec2& p : points)
                    ++hits[std::size_t(p.x * float(1 << bits)) * std::size_t(1 << (kBits - bits)) +
                           std::size_t(p.y * float(1 << (kBits - bits)))];
                CAPTURE(stream, skip, bits);
                CHECK(std::all_of(hits.begin(), hits.end(), [](int n) { return n == 1; }));
            }
        }

    // Correlation of the first points of many streams; its deviation is 1 / sqrt(4096).
    double xy = 0.0, next = 0.0;
    for (std::uint64_t stream = 0; stream < 4096; ++stream) {
        studio::Sampler a(42, stream, 0), b(42, stream + 1, 0);
        const glm::vec2 p = a.next(), q = b.next();
        xy += 12.0 * (p.x - 0.5) * (p.y - 0.5) / 4096.0;
        next += 12.0 * (p.x - 0.5) * (q.x - 0.5) / 4096.0;
    }
    CHECK(std::abs(xy) < 4.0 / 64.0);
    CHECK(std::abs(next) < 4.0 / 64.0);
}

TEST_CASE("closed furnace: bounce k carries M_e rho^k everywhere") {
    const vec3 albedo(0.2f, 0.5f, 0.8f), exitance(1.0f, 2.0f, 3.0f);
    QuadScene s;
    s.box(s.material(albedo, exitance / float(kPi)), vec3(-1.0f, 0.0f, -2.0f), vec3(1.0f, 1.5f, 2.0f));
    Receivers floor(16, 16, vec3(0.0f, 1.0f, 0.0f));
    floor.grid(vec3(-1.0f, 0.0f, -2.0f), vec3(2.0f, 0.0f, 0.0f), vec3(0.0f, 0.0f, 4.0f), vec3(0, 1, 0));
    const Image image = tracePaths(s.build(), floor.view, samples(64));
    for (int c = 0; c < 3; ++c) {
        const double rho = double(albedo[c]), m = double(exitance[c]);
        const std::string channel(1, "RGB"[c]);
        CHECK(mean(image, "direct." + channel) == Approx(m).epsilon(kStatistical));
        CHECK(mean(image, "bounce1." + channel) == Approx(m * rho).epsilon(kStatistical));
        CHECK(mean(image, "bounce2." + channel) == Approx(m * rho * rho).epsilon(kStatistical));
        // Roulette follows the brightest channel; the darker ones' means stay right, and less noisy.
        CHECK(mean(image, "all." + channel) ==
              Approx(m * rho / (1.0 - rho)).epsilon(2.0 * kStatistical));
    }
}

TEST_CASE("sphere of albedo 1/2 about a point light of intensity pi") {
    // Direct irradiance pi everywhere (reflected radiance 1/2); each further bounce has half as much
    // (radiance 1/4 by the first bounce, 1/2 by all of them: with the direct 1/2 radiance 1 in all).
    QuadScene s;
    const int grey = s.material(vec3(0.5f));
    constexpr int kStacks = 96, kSlices = 192;
    studio::Mesh sphere;
    sphere.material = grey;
    for (int i = 0; i <= kStacks; ++i)
        for (int j = 0; j <= kSlices; ++j) {
            const double theta = kPi * i / kStacks, phi = 2.0 * kPi * j / kSlices;
            const vec3 p(glm::dvec3(std::sin(theta) * std::cos(phi), std::cos(theta),
                                    std::sin(theta) * std::sin(phi)));
            sphere.positions.push_back(p);
            sphere.normals.push_back(-p);
        }
    for (unsigned i = 0; i < kStacks; ++i)
        for (unsigned j = 0; j < kSlices; ++j) {
            const unsigned a = i * (kSlices + 1) + j, b = a + kSlices + 1;
            if (i > 0) sphere.triangles.push_back({a, b, a + 1});
            if (i + 1 < kStacks) sphere.triangles.push_back({a + 1, b, b + 1});
        }
    s.scene.meshes.push_back(sphere);
    s.point(vec3(0.0f), vec3(float(kPi)));
    Receivers wall(4, 4);
    for (int i = 0; i < 16; ++i) {
        const double z = (i + 0.5) / 8.0 - 1.0, r = std::sqrt(1.0 - z * z);
        const vec3 p(glm::dvec3(r * std::cos(2.4 * i), z, r * std::sin(2.4 * i)));
        wall.set(i % 4, i / 4, 0.9995f * p, -p);  // just inside the facets
    }
    const Image image = tracePaths(s.build(), wall.view, samples(512));
    // Facets lie up to 0.03 % inside the sphere, the receivers 0.05 %: twice that in irradiance.
    constexpr double kFacets = 0.005;
    CHECK(mean(image, "direct.G") == Approx(kPi).epsilon(kFacets));
    CHECK(mean(image, "bounce1.G") == Approx(kPi / 2.0).epsilon(kFacets));
    CHECK(mean(image, "bounce2.G") == Approx(kPi / 4.0).epsilon(kFacets));
    CHECK(mean(image, "all.G") == Approx(kPi).epsilon(kStatistical));
}

TEST_CASE("form factors of unit squares") {
    QuadScene s;
    s.quad(s.material(vec3(0.0f), vec3(1.0f)), vec3(0, 0, 0), vec3(1, 0, 0), vec3(1, 1, 0),
           vec3(0, 1, 0));
    const studio::RayScene scene = s.build();
    Receivers facing(16, 16, vec3(5.0f)), edge(32, 32, vec3(5.0f));
    facing.grid(vec3(0, 0, 1), vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, -1));
    edge.grid(vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 0, 1), vec3(0, 1, 0));
    CHECK(mean(tracePaths(scene, facing.view, samples(64)), "direct.R") / kPi ==
          Approx(0.1998249).epsilon(0.005));
    CHECK(mean(tracePaths(scene, edge.view, samples(32)), "direct.R") / kPi ==
          Approx(0.2000438).epsilon(0.005));
}

TEST_CASE("rectangle seen from tilted receivers: Lambert's polygon formula") {
    const vec3 a(-1, 2, -1), b(2, 2, -1), c(2, 2.5f, 1), d(-1, 2.5f, 1);
    QuadScene s;
    s.quad(s.material(vec3(0.0f), vec3(2.0f)), a, b, c, d);
    const vec3 normals[] = {vec3(0, 1, 0), vec3(1, 1, 0), vec3(1, 0.2f, 0.3f), vec3(-1, 0.1f, 1)};
    Receivers points(4, 1, vec3(0, -5, 0));
    for (int i = 0; i < 4; ++i) points.set(i, 0, vec3(0.3f, 0.1f, 0.2f), normals[i]);
    const Image image = tracePaths(s.build(), points.view, samples(16384));
    for (int i = 0; i < 4; ++i) {
        const double expected = 2.0 * polygonIrradiance({a, b, c, d}, glm::dvec3(0.3, 0.1, 0.2),
                                                        glm::dvec3(glm::normalize(normals[i])));
        CAPTURE(i);
        CHECK(double(image.plane("direct.G")[std::size_t(i)]) == Approx(expected).epsilon(kStatistical));
    }
}

TEST_CASE("uniform sky on a plane whose shading normal leans: its own body blocks the rest") {
    QuadScene s;
    s.quad(s.material(vec3(0.5f)), vec3(-9, 0, -9), vec3(9, 0, -9), vec3(9, 0, 9), vec3(-9, 0, 9));
    s.scene.sky = vec3(0.5f, 1.0f, 2.0f);
    Receivers points(2, 1, vec3(0, 3, 0));
    points.set(0, 0, vec3(0.5f, 0, 0), vec3(0, 1, 0));
    points.set(1, 0, vec3(0.5f, 0, 0), vec3(std::sqrt(3.0f), 1, 0));  // 60 degrees: (1 + cos 60) / 2
    const Image image = tracePaths(s.build(), points.view, samples(4096));
    CHECK(image.plane("direct.G")[0] == Approx(kPi).epsilon(1e-5));
    CHECK(image.plane("direct.B")[1] == Approx(2.0 * kPi * 0.75).epsilon(kStatistical));
    CHECK(image.plane("all.G")[0] == 0.0f);
}

TEST_CASE("one bounce from a sunlit patch, by polygon formula; a wall hides it, but not unshadowed") {
    const vec3 a(1, 0, -1), b(3, 0, -1), c(3, 0, 1), d(1, 0, 1);
    const glm::dvec3 at(0, 0.5, 0), normal(glm::normalize(glm::dvec3(1, -0.2, 0)));
    QuadScene s;
    s.quad(s.material(vec3(0.3f, 0.6f, 0.9f)), a, b, c, d);
    s.sun(vec3(0.3f, -1, 0), vec3(5.0f));
    const double sunCosine = 1.0 / std::sqrt(1.09);
    const double expected = 0.6 * 5.0 * sunCosine / kPi * polygonIrradiance({a, b, c, d}, at, normal);

    Receivers point(1, 1, vec3(-5, 0.5f, 0));
    point.set(0, 0, vec3(at), vec3(normal));
    PathTracerOptions through = samples(16384);
    through.unshadowed = true;
    const auto bounce1 = [&](const PathTracerOptions& options) {
        return double(tracePaths(s.build(), point.view, options).plane("bounce1.G")[0]);
    };
    CHECK(bounce1(samples(16384)) == Approx(expected).epsilon(kJoined));
    CHECK(bounce1(through) == Approx(expected).epsilon(kJoined));

    // A wall so low that it throws its shadow short of the patch, yet hides all of it from the point.
    s.quad(s.material(vec3(0.0f)), vec3(0.5f, -1, -9), vec3(0.5f, 0.45f, -9), vec3(0.5f, 0.45f, 9),
           vec3(0.5f, -1, 9));
    CHECK(bounce1(samples(256)) == 0.0);
    CHECK(bounce1(through) == Approx(expected).epsilon(kJoined));
}

TEST_CASE("unshadowed: every lit side that faces the pixel counts once, the others not at all") {
    // Walls at x = 1 and x = 2, a lamp before each: the first wall is also lit from behind by the second
    // lamp, the second wall by the second lamp alone. The receiver looks along +x from the origin.
    QuadScene s;
    const int wall = s.material(vec3(0.5f));
    for (const float x : {1.0f, 2.0f})
        s.quad(wall, vec3(x, -2, -2), vec3(x, 2, -2), vec3(x, 2, 2), vec3(x, -2, 2));
    const glm::dvec3 lamps[] = {{0.5, 0.3, 0.0}, {1.5, -0.4, 0.2}};
    const double intensity[] = {2.0, 7.0};
    for (int i = 0; i < 2; ++i) s.point(vec3(lamps[i]), vec3(float(intensity[i])));

    double expected = 0.0;
    for (int i = 0; i < 2; ++i)
        expected += integrate({i + 1.0, -2, -2}, {0, 4, 0}, {0, 0, 4}, [&](const glm::dvec3& y) {
            const glm::dvec3 toLamp = lamps[i] - y, facing(-1, 0, 0);
            const double d2 = glm::dot(toLamp, toLamp);
            const double irradiance = intensity[i] * glm::dot(toLamp, facing) / (d2 * std::sqrt(d2));
            return 0.5 * irradiance / kPi * coupling({0, 0, 0}, {1, 0, 0}, y, facing);
        });
    Receivers point(1, 1, vec3(-5, 0, 0));
    point.set(0, 0, vec3(0.0f), vec3(1, 0, 0));
    PathTracerOptions options = samples(16384);
    options.unshadowed = true;
    const Image image = tracePaths(s.build(), point.view, options);
    CHECK(double(image.plane("bounce1.R")[0]) == Approx(expected).epsilon(kJoined));
    CHECK_FALSE(image.has("bounce2.R"));
}

TEST_CASE("unshadowed: flux by the geometric normal, lobe about the shading normal, as VPLs have it") {
    QuadScene s;
    const glm::dvec3 shading = glm::normalize(glm::dvec3(1, 1, 0));
    s.quad(s.material(vec3(0.5f)), vec3(-1, 0, -1), vec3(1, 0, -1), vec3(1, 0, 1), vec3(-1, 0, 1),
           vec3(shading));
    s.sun(vec3(0, -1, 0), vec3(4.0f));
    // Before the patch, and below its plane where only the lobe of the leaning normal reaches.
    const glm::dvec3 at[] = {{1.5, 0.8, 0.5}, {3.0, -0.3, 0.2}};
    const glm::dvec3 normal = glm::normalize(glm::dvec3(-1, -0.3, 0));
    Receivers points(2, 1, vec3(-5, 5, 0));
    for (int i = 0; i < 2; ++i) points.set(i, 0, vec3(at[i]), vec3(normal));
    PathTracerOptions options = samples(1 << 16);
    options.unshadowed = true;
    const Image image = tracePaths(s.build(), points.view, options);
    for (int i = 0; i < 2; ++i) {
        const double expected = integrate({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, [&](const glm::dvec3& y) {
            return 0.5 * 4.0 / kPi * coupling(at[i], normal, y, shading);
        });
        CAPTURE(i);
        CHECK(expected > 0.0);
        CHECK(double(image.plane("bounce1.R")[std::size_t(i)]) ==
              Approx(expected).epsilon(kJoined));
    }
}

TEST_CASE("another unit of length gives the same picture") {
    const auto render = [](float scale) {
        QuadScene s;
        s.box(s.material(vec3(0.6f)), scale * vec3(-1), scale * vec3(1));
        s.point(scale * vec3(0.3f, 0.5f, 0.1f), vec3(scale * scale));
        Receivers floor(8, 8);
        floor.grid(scale * vec3(-1), scale * vec3(2, 0, 0), scale * vec3(0, 0, 2), vec3(0, 1, 0));
        return tracePaths(s.build(), floor.view, samples(64));
    };
    const Image metres = render(1.0f), tenths = render(10.0f);
    for (const char* layer : {"direct.R", "bounce1.R", "bounce2.R", "all.R"})
        CHECK(mean(tenths, layer) == Approx(mean(metres, layer)).epsilon(1e-3));
}
