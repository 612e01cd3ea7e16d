// Triangles as surfels: their area, how evenly they lie on it, and that the same triangles give the same ones.
#include "passes/surfel_sampling.h"

#include <catch2/catch.hpp>
#include <random>

#include "support/paraboloid_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

constexpr std::uint32_t kCount = 20000;
constexpr double kOverlap = 1.35;  // as the pass surfel_splat draws them

struct Sampled {
    std::size_t stride = 0;
    std::vector<float> planes;
    Vec at(std::size_t i, std::size_t plane) const {
        return {double(planes[plane * stride + i]), double(planes[(plane + 1) * stride + i]), double(planes[(plane + 2) * stride + i])};
    }
    double radius(std::size_t i) const { return double(planes[LW_SURFEL_RADIUS * stride + i]); }
    std::size_t triangle(std::size_t i) const {  // of Mesh, by its albedo
        std::uint32_t word;
        std::memcpy(&word, &planes[LW_SURFEL_ALBEDO * stride + i], 4);
        const auto digit = [&](int c) { return std::size_t(std::lround((word >> (10 * c) & 1023u) / 102.3)); };
        return digit(0) + 11 * digit(1) + 121 * digit(2);
    }
};

struct SamplingRig : KernelRig {
    explicit SamplingRig(std::uint32_t width) : KernelRig(width), pass(device()) {}
    GeometryInput input;
    SurfelSampling pass;

    Sampled sampled(const Mesh& mesh, std::uint32_t count = kCount) {
        const LWGeometry geometry = mesh.geometry();
        input.import(executor(), &geometry);
        pass.record(executor(), input, count);
        device().finish();
        Sampled result;
        result.stride = pass.surfels().planes.width;
        result.planes.resize(result.stride * LW_SURFEL_PLANES);
        if (!result.planes.empty())
            Buffer::retained(device(), pass.surfels().planes.memory).download(0, result.planes.size() * 4, result.planes.data());
        return result;
    }
};

double areaOf(const reference::Triangle& t) { return 0.5 * reference::length(reference::cross(t.b - t.a, t.c - t.a)); }

Mesh scatter(int count) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const auto any = [&] { return Vec{unit(random), unit(random), unit(random)}; };
    Mesh mesh;
    for (int i = 0; i < count; ++i) {
        const Vec centre = any() * 10.0;
        const double size = i % 5 == 0 ? 3.0 : 0.5;
        mesh.add(centre + any() * size, centre + any() * size, centre + any() * size);
    }
    return mesh;
}

// Of `taken` among kCount where a share is expected: within four deviations of independent choice, which this sequence
// undercuts.
bool isFair(double taken, double share) {
    return std::abs(taken - share * kCount) <= 4.0 * std::sqrt(share * kCount) + 1.0;
}

}  // namespace

TEST_CASE("surfels lie on their triangles, their areas are the mesh's, their density is even", "[surfel_sampling]") {
    SamplingRig rig(GENERATE(1u, 16u));
    const Mesh mesh = scatter(150);
    const std::vector<reference::Triangle> triangles = mesh.triangles();
    double area = 0.0, covered = 0.0;
    for (const reference::Triangle& t : triangles) area += areaOf(t);
    const Sampled s = rig.sampled(mesh);
    std::vector<int> taken(triangles.size()), inner(triangles.size());
    int off = 0, turned = 0;
    for (std::size_t i = 0; i < s.stride; ++i) {
        if (i >= kCount) {
            CHECK(s.radius(i) == 0.0);
            continue;
        }
        covered += 3.14159265358979323846 * s.radius(i) * s.radius(i);
        const std::size_t n = s.triangle(i);
        REQUIRE(n < triangles.size());
        const reference::Triangle& t = triangles[n];
        const Vec p = s.at(i, LW_SURFEL_POSITION) - t.a, e1 = t.b - t.a, e2 = t.c - t.a;
        const Vec normal = t.normal();
        // Barycentric, by areas.
        const double whole = dot(reference::cross(e1, e2), normal);
        const double v = dot(reference::cross(p, e2), normal) / whole, w = dot(reference::cross(e1, p), normal) / whole;
        if (std::abs(dot(p, normal)) > 1e-5 || v < -1e-4 || w < -1e-4 || v + w > 1.0001) ++off;
        if (reference::length(s.at(i, LW_SURFEL_NORMAL) - normal) > 1e-4) ++turned;
        ++taken[n];
        inner[n] += v < 0.5 && w < 0.5 && v + w > 0.5 ? 1 : 0;  // the middle one of its four quarters
    }
    CHECK(off == 0);
    CHECK(turned == 0);
    CHECK(covered == Approx(area).epsilon(1e-5));
    for (std::size_t n = 0; n < triangles.size(); ++n) {
        CAPTURE(n, taken[n], inner[n]);
        CHECK(std::abs(taken[n] - kCount * areaOf(triangles[n]) / area) < 1.01);  // systematic
        CHECK(isFair(inner[n], 0.25 * areaOf(triangles[n]) / area));
    }
}

// Where triangles hold several surfels each. With about one for each, the curve that orders them decides: less than the
// 0.16 that discs at independent places would leave.
TEST_CASE("discs as large as they are splatted leave less than 4 % of a wall open", "[surfel_sampling]") {
    SamplingRig rig(16);
    Mesh mesh;
    const int cells = GENERATE(1, 5, 40);
    mesh.addQuad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, cells, cells);
    const std::uint32_t count = GENERATE(1000u, 2917u);
    const Sampled s = rig.sampled(mesh, count);
    constexpr int kProbes = 60;  // a side, a little off the border
    int open = 0;
    for (int v = 0; v < kProbes; ++v)
        for (int u = 0; u < kProbes; ++u) {
            const Vec at{0.05 + 0.9 * u / kProbes, 0.05 + 0.9 * v / kProbes, 0.0};
            double nearest = 1e9;
            for (std::uint32_t i = 0; i < count; ++i) nearest = std::min(nearest, reference::length(s.at(i, LW_SURFEL_POSITION) - at));
            if (nearest > kOverlap * s.radius(0)) ++open;
        }
    CAPTURE(cells, count, open);
    CHECK(open <= (cells == 40 ? 0.15 : 0.04) * kProbes * kProbes);
}

TEST_CASE("the same triangles, in whatever order, at whatever width: the same surfels, drawn once", "[surfel_sampling]") {
    SamplingRig rig(16), narrow(1);
    const Mesh mesh = scatter(90);
    const Sampled s = rig.sampled(mesh);
    CHECK(bitDifference(narrow.sampled(mesh).planes, s.planes) == "");
    const std::uint64_t revision = rig.pass.surfels().revision;
    rig.sampled(mesh);
    CHECK(rig.pass.surfels().revision == revision);
    Mesh reversed = mesh;
    ++reversed.version;
    for (std::size_t i = 0; i < mesh.count(); ++i) {
        std::copy_n(&mesh.vertices[9 * i], 9, &reversed.vertices[9 * (mesh.count() - 1 - i)]);
        std::copy_n(&mesh.albedo[3 * i], 3, &reversed.albedo[3 * (mesh.count() - 1 - i)]);
    }
    CHECK(bitDifference(rig.sampled(reversed).planes, s.planes) == "");
    CHECK(rig.pass.surfels().revision != revision);
    CHECK(rig.pass.bytes() <= SurfelSampling::estimateBytes(mesh.count(), kCount));
    rig.sampled(Mesh{});
    CHECK(rig.pass.surfels().count == 0);
}
