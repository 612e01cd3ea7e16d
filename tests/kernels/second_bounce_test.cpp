// Second-bounce VPLs in a closed furnace: flux, area and places that are known without them.
#include "passes/second_bounce.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/paraboloid_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

constexpr Vec kRoom{2.0, 1.5, 3.0};
constexpr double kAlbedo = 0.7;
// Albedo comes back from 10 bits.
constexpr double kAlbedoRounding = 1e-3;

Mesh furnace() {
    Mesh mesh;
    mesh.addBox(kRoom, 5, 4);
    std::fill(mesh.albedo.begin(), mesh.albedo.end(), float(kAlbedo));
    return mesh;
}

lw_cluster cluster(Vec position, Vec normal, double flux) {
    lw_cluster c = clusterAt(position, normal);
    c.flux = {{float(flux), float(2.0 * flux), float(0.5 * flux), 0.0f}};
    return c;
}

std::vector<lw_vpl> drawn(ParaboloidRig& rig, const std::vector<lw_cluster>& clusters,
                          SecondBounceOptions options) {
    const Guarded list = rig.upload(clusters);
    SecondBounce pass(rig.device(), options);
    const auto count = std::uint32_t(clusters.size());
    pass.reserve(count);
    pass.record(rig.executor(), list, count, rig.pass.frames(), rig.pass.records(), rig.pass.albedo(),
                rig.pass.size());
    rig.device().finish();
    std::vector<lw_vpl> vpls(pass.vplCount());
    pass.vpls().download(0, vpls.size() * sizeof(lw_vpl), vpls.data());
    return vpls;
}

double fluxOf(const std::vector<lw_vpl>& vpls, std::size_t first, std::size_t count, int channel = 0) {
    double sum = 0.0;
    for (std::size_t i = first; i < first + count; ++i) sum += double(vpls[i].flux.s[channel]);
    return sum;
}

}  // namespace

TEST_CASE("in a closed furnace the second bounce carries the albedo's share of the first",
          "[second_bounce][large]") {
    const auto width = GENERATE(1u, 16u);
    const auto directions = GENERATE(0u, 1u, 2u);
    ParaboloidRig rig(width, 128);
    const std::vector<lw_cluster> clusters = {cluster({0.6, 0.0, 1.0}, {0, 1, 0}, 4.0),
                                              cluster({2.0, 0.7, 2.2}, {-1, 0, 0}, 9.0)};
    rig.draw(furnace(), clusters);
    SecondBounceOptions options;
    options.directions = directions;
    for (const std::uint32_t perCluster : {32u, 1024u}) {
        options.perCluster = perCluster;
        const std::vector<lw_vpl> vpls = drawn(rig, clusters, options);
        for (std::size_t c = 0; c < 2; ++c)
            for (int channel = 0; channel < 3; ++channel) {
                const double expected = kAlbedo * double(clusters[c].flux.s[channel]);
                const double got = fluxOf(vpls, c * perCluster, perCluster, channel);
                // By cosine every sample weighs the same. The others integrate a smooth weight by a
                // stratified set (on the square one of five falls beside the disc): some per cent with
                // 32 samples, under one with 1,024.
                const double tolerance = directions == 0    ? kAlbedoRounding
                                         : perCluster == 32 ? 0.15
                                                            : 0.02;
                CAPTURE(directions, perCluster, c, channel);
                CHECK(got == Approx(expected).epsilon(tolerance));
            }
    }
}

TEST_CASE("they lie on the walls, face the room, and stand for the walls' area", "[second_bounce]") {
    const auto directions = GENERATE(0u, 1u, 2u);
    ParaboloidRig rig(16, 256);
    const std::vector<lw_cluster> clusters = {cluster({1.0, 0.0, 1.5}, {0, 1, 0}, 1.0)};
    rig.draw(furnace(), clusters);
    SecondBounceOptions options;
    options.directions = directions;
    options.perCluster = 1024;
    double area = 0.0;
    const std::vector<lw_vpl> vpls = drawn(rig, clusters, options);
    for (const lw_vpl& v : vpls) {
        if (v.flux.s[0] == 0.0f) continue;
        const Vec p = reference::vecOf(v.positionArea), n = reference::vecOf(v.normal);
        double nearest = 1e9;
        for (const double d : {p.x, kRoom.x - p.x, p.y, kRoom.y - p.y, p.z, kRoom.z - p.z})
            nearest = std::min(nearest, std::abs(d));
        CHECK(nearest < 1e-4);
        CHECK(reference::length(n) == Approx(1.0).epsilon(1e-5));
        CHECK(dot(n, Vec{1.0, 0.75, 1.5} - p) > 0.0);
        CHECK(v.normal.s[3] ==
              Approx(double(v.positionArea.s[3]) / (4.0 * 3.14159265358979)).epsilon(1e-5));
        area += double(v.positionArea.s[3]);
    }
    // Walls and ceiling, without the floor that the cluster lies on. By cosine, the foot of the walls is
    // seen by few samples that stand for much each, and bounded cosines take some of it.
    const double seen = 2.0 * (kRoom.x * kRoom.y + kRoom.z * kRoom.y) + kRoom.x * kRoom.z;
    CHECK(area == Approx(seen).epsilon(directions == 0 ? 0.08 : 0.03));
}

TEST_CASE("nothing met, empty clusters, no light: no flux, nothing that is no number",
          "[second_bounce]") {
    ParaboloidRig rig(16, 64);
    Mesh mesh;  // one wall: most samples meet nothing
    mesh.addQuad({-1, 1, -1}, {0.5, 0, 0}, {0, 0, 0.5});
    std::fill(mesh.albedo.begin(), mesh.albedo.end(), float(kAlbedo));
    std::vector<lw_cluster> clusters = {cluster({0, 0, 0}, {0, 1, 0}, 5.0),
                                        cluster({0, 0, 0}, {0, 1, 0}, 0.0), lw_cluster{}};
    rig.draw(mesh, clusters);
    SecondBounceOptions options;
    options.perCluster = 64;
    const std::vector<lw_vpl> vpls = drawn(rig, clusters, options);
    const double flux = fluxOf(vpls, 0, 64);
    CHECK(flux > 0.0);
    CHECK(flux < 5.0);
    CHECK(fluxOf(vpls, 64, 128) == 0.0);
    for (const lw_vpl& v : vpls)
        for (int i = 0; i < 4; ++i)
            CHECK(std::isfinite(v.positionArea.s[i] + v.normal.s[i] + v.flux.s[i]));
}

TEST_CASE("the set is kept, and a seed turns it", "[second_bounce]") {
    ParaboloidRig rig(16, 64);
    const std::vector<lw_cluster> clusters = {cluster({0.6, 0.0, 1.0}, {0, 1, 0}, 4.0)};
    rig.draw(furnace(), clusters);
    SecondBounceOptions options;
    const auto first = drawn(rig, clusters, options), again = drawn(rig, clusters, options);
    options.seed = 3;
    const auto other = drawn(rig, clusters, options);
    CHECK(std::memcmp(first.data(), again.data(), first.size() * sizeof(lw_vpl)) == 0);
    CHECK(std::memcmp(first.data(), other.data(), first.size() * sizeof(lw_vpl)) != 0);
}

TEST_CASE("beside a wide cluster a VPL is as wide as the cluster makes the light", "[second_bounce]") {
    ParaboloidRig rig(GENERATE(1u, 16u), 128);
    std::vector<lw_cluster> clusters = {cluster({0.6, 0.0, 1.0}, {0, 1, 0}, 4.0)};
    rig.draw(furnace(), clusters);
    SecondBounceOptions options;
    const std::vector<lw_vpl> points = drawn(rig, clusters, options);
    constexpr double kArea = 2.5;
    clusters[0].flux.s[3] = float(kArea);
    const std::vector<lw_vpl> discs = drawn(rig, clusters, options);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec way = reference::vecOf(points[i].positionArea) - reference::vecOf(clusters[0].medoidPosition);
        const double r2 = reference::dot(way, way);
        CHECK(discs[i].flux.s[0] == points[i].flux.s[0]);
        CHECK(double(discs[i].positionArea.s[3]) ==
              Approx(double(points[i].positionArea.s[3]) * std::max(1.0, kArea / (4.0 * M_PI * r2))).epsilon(1e-3));
    }
}

namespace {

struct Bounds {
    double least = 0.0, most = 0.0;
};

// A sample takes the surface that the centre of its texel sees; in a map of 64 it lies within 3.3 degrees of that.
constexpr double kTexel = 0.06;
// Where a look-up falls on the border of two texels, or a surface is as far off as just counts as the texel's.
constexpr double kBorder = 1e-3, kSlack = 1.05;

// Whether map `m` shows the surface at `way` from its origin: by every texel that rounding may choose, and by any.
std::pair<bool, bool> sees(const DrawnMaps& maps, std::size_t m, const reference::ParaboloidFrame& frame, Vec way) {
    const double distance = reference::length(way);
    const Vec d = frame.local(way) * (1.0 / distance);
    std::pair<bool, bool> seen{true, false};
    for (const double i : {-kBorder, kBorder})
        for (const double j : {-kBorder, kBorder}) {
            const auto texel = [&](double along, double by) {
                const double at = (along / (1.0 + d.z) / reference::kRim + 1.0) * 0.5 * maps.size + by;
                return std::uint32_t(std::clamp(at, 0.0, maps.size - 1.0));
            };
            const double limit = kSlack * double(maps.distance(maps.at(m, texel(d.x, i), texel(d.y, j))));
            seen.first = seen.first && distance <= limit * (1.0 - kBorder);
            seen.second = seen.second || distance <= limit * (1.0 + kBorder);
        }
    return seen;
}

// The radiosity, its channels summed up, that all clusters cause at a VPL drawn from `own`.
Bounds radiosityAt(const lw_vpl& vpl, std::size_t own, const std::vector<lw_cluster>& clusters, const DrawnMaps& maps) {
    const Vec position = reference::vecOf(vpl.positionArea), normal = reference::vecOf(vpl.normal);
    Bounds sum;
    for (std::size_t m = 0; m < clusters.size(); ++m) {
        if (!(clusters[m].position.s[3] > 0.0f)) continue;
        const reference::ParaboloidFrame frame(maps.frames[m]);
        const Vec way = position - frame.origin, flux = reference::vecOf(clusters[m].flux);
        const double distance = reference::length(way), cosine = dot(frame.z, way) / distance, facing = -dot(normal, way) / distance;
        const double straight = kAlbedo * (flux.x + flux.y + flux.z) / (M_PI * distance * distance);
        if (m == own) {
            sum.least += straight * std::max(facing, 0.05) * std::max(cosine - kTexel, 0.0);
            sum.most += straight * std::max(facing, 0.05) * (cosine + kTexel);
        } else if (cosine > 0.0 && facing > 0.0) {
            const auto [surely, perhaps] = sees(maps, m, frame, way);
            sum.least += surely ? straight * cosine * facing : 0.0;
            sum.most += perhaps ? straight * cosine * facing : 0.0;
        }
    }
    return sum;
}

// 28 VPLs of four clusters, one of them empty: they fill no registers.
const std::vector<lw_cluster>& fewClusters() {
    static const std::vector<lw_cluster> clusters = {cluster({0.6, 0.0, 1.0}, {0, 1, 0}, 4.0), cluster({2.0, 0.7, 2.2}, {-1, 0, 0}, 9.0),
                                                     lw_cluster{}, cluster({1.1, 1.5, 0.4}, {0, -1, 0}, 3.0)};
    return clusters;
}

SecondBounceOptions fewEach() {
    SecondBounceOptions options;
    options.perCluster = 7;
    return options;
}

}  // namespace

TEST_CASE("a VPL stands for its flux over the radiosity of all clusters whose maps show its place", "[second_bounce]") {
    ParaboloidRig rig(16, 64);
    rig.draw(furnace(), fewClusters());
    const DrawnMaps maps = rig.maps();
    const std::vector<lw_vpl> vpls = drawn(rig, fewClusters(), fewEach());
    REQUIRE(vpls.size() == 28);
    for (std::size_t i = 0; i < vpls.size(); ++i) {
        CAPTURE(i);
        const double flux = fluxOf(vpls, i, 1, 0) + fluxOf(vpls, i, 1, 1) + fluxOf(vpls, i, 1, 2), area = double(vpls[i].positionArea.s[3]);
        REQUIRE((flux > 0.0) == (i / 7 != 2));
        if (flux == 0.0) continue;
        const Bounds radiosity = radiosityAt(vpls[i], i / 7, fewClusters(), maps);
        CHECK(area >= flux / radiosity.most * (1.0 - kAlbedoRounding));
        CHECK(area * radiosity.least <= flux * (1.0 + kAlbedoRounding));
    }
}

TEST_CASE("widths draw the same VPLs, bit for bit", "[second_bounce][large]") {
    std::vector<lw_vpl> first;
    for (const std::uint32_t width : {1u, 16u}) {
        ParaboloidRig rig(width, 64);
        rig.draw(furnace(), fewClusters());
        const std::vector<lw_vpl> vpls = drawn(rig, fewClusters(), fewEach());
        if (first.empty()) first = vpls;
        CHECK(std::memcmp(first.data(), vpls.data(), vpls.size() * sizeof(lw_vpl)) == 0);
    }
}
