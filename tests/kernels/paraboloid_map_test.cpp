// Paraboloid maps: every texel's ray meets what it should, whatever the order of triangles, and a map is redrawn
// only when it has to be.
#include "passes/paraboloid_map.h"

#include <catch2/catch.hpp>
#include <random>

#include "support/errors.h"
#include "support/paraboloid_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

// Rounding of the ray's direction, of the corners, and of their products.
constexpr double kDistanceRounding = 1e-5;
// A ray that grazes a plane turns the direction's rounding into distance by the tangent of its angle.
constexpr double kDirectionRounding = 3e-7;
// A normal of 10 bits a component.
constexpr double kNormalRounding = 2e-3;
// Of texels whose ray passes an edge so closely that float and double may take different triangles.
constexpr double kNearTies = 2e-4;

// Distance at which a ray from inside leaves the box from 0 to `size`, and the tangent of its angle to the wall.
std::pair<double, double> leaveBox(Vec size, Vec origin, Vec d) {
    double least = 1e30, cosine = 1.0;
    for (const auto& [s, o, v] : {std::array{size.x, origin.x, d.x}, std::array{size.y, origin.y, d.y}, std::array{size.z, origin.z, d.z}}) {
        const double t = v > 0.0 ? (s - o) / v : v < 0.0 ? -o / v : 1e30;
        if (t < least) {
            least = t;
            cosine = std::abs(v);
        }
    }
    return {least, 1.0 / cosine};
}

Mesh soup(std::uint32_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    Mesh mesh;
    for (std::uint32_t i = 0; i < count; ++i) {
        const double size = i % 8 == 0 ? 2.0 : i % 3 ? 0.1 : 0.4;
        const auto offset = [&] { return Vec{unit(random), unit(random), unit(random)} * size; };
        const Vec centre = Vec{unit(random), unit(random), unit(random)} * 3.0;
        mesh.add(centre + offset(), centre + offset(), centre + offset());
    }
    return mesh;
}

std::uint64_t countOf(const std::vector<LWCount>& counts, const std::string& name) {
    for (const LWCount& c : counts)
        if (c.name == name) return c.value;
    FAIL("no count named " << name);
    return 0;
}

const std::vector<lw_cluster> kFour = {clusterAt({0, 0, 0}, {0, 0, 1}), clusterAt({0.3, -0.2, 0.1}, {0, 0, -1}),
                                       clusterAt({-1, 0.5, 0.2}, {1, 2, -3}), clusterAt({2, 2, 2}, {-1, -1, -0.5})};

void compareWithTwin(std::uint32_t width, const Mesh& mesh, const std::vector<lw_cluster>& clusters) {
    const std::vector<reference::Triangle> triangles = mesh.triangles();
    ParaboloidRig rig(width, 64);
    const DrawnMaps maps = rig.drawn(mesh, clusters);
    int texels = 0, ties = 0, wrong = 0, turned = 0;
    for (std::size_t k = 0; k < clusters.size(); ++k) {
        const reference::ParaboloidFrame frame(maps.frames[k]);
        for (std::uint32_t y = 0; y < maps.size; ++y)
            for (std::uint32_t x = 0; x < maps.size; ++x) {
                const std::size_t at = maps.at(k, x, y);
                if (!reference::isBeforeRim(x, y, maps.size)) {
                    CHECK(!maps.hit(at));
                    continue;
                }
                ++texels;
                const Vec d = frame.world(reference::localDirection(x, y, maps.size));
                const reference::Nearest expected = reference::nearest(triangles, frame.origin, d);
                const bool hits = std::isfinite(expected.distance);
                if (maps.hit(at) != hits || (hits && maps.triangle(at) != expected.triangle)) {
                    ++ties;
                } else if (hits) {
                    const Vec n = triangles[expected.triangle].normal();
                    const double cosine = dot(n, d);
                    if (std::abs(double(maps.distance(at)) / expected.distance - 1.0) >
                        kDistanceRounding + kDirectionRounding / std::abs(cosine))
                        ++wrong;
                    const Vec stored = frame.world(maps.normal(at)), turnedTo = n * (cosine > 0.0 ? -1.0 : 1.0);
                    if (reference::length(stored - turnedTo) > kNormalRounding) ++turned;
                } else {
                    CHECK(std::isinf(maps.distance(at)));
                }
            }
    }
    CHECK(ties <= kNearTies * texels);
    CHECK(wrong == 0);
    CHECK(turned == 0);
}

}  // namespace

TEST_CASE("a closed box from inside: the right distance in every texel, no crack", "[paraboloid_map][large]") {
    const auto width = GENERATE(1u, 16u);
    const auto cut = GENERATE(std::pair<int, int>{1, 1}, std::pair<int, int>{37, 3});
    const Vec size{1.75, 1.125, 2.25};  // exact as floats
    Mesh mesh;
    mesh.addBox(size, cut.first, cut.second);
    const std::vector<lw_cluster> clusters = {
        clusterAt({0.8, 0.5, 1.1}, {0, 0, 1}),      clusterAt({0.8, 0.001, 1.1}, {0, 1, 0}),
        clusterAt({0.002, 0.003, 0.001}, {1, 1, 1}), clusterAt({1.749, 0.6, 2.249}, {-1, 0.2, -1}),
        clusterAt({0.4, 1.124, 1.9}, {0, -1, 0}),   clusterAt({0.4, 0.3, 0.7}, {0.01, 0.02, -1})};
    ParaboloidRig rig(width, 64);
    const DrawnMaps maps = rig.drawn(mesh, clusters);
    int missed = 0, wrong = 0, turned = 0, texels = 0;
    for (std::size_t k = 0; k < clusters.size(); ++k) {
        const reference::ParaboloidFrame frame(maps.frames[k]);
        for (std::uint32_t y = 0; y < maps.size; ++y)
            for (std::uint32_t x = 0; x < maps.size; ++x) {
                const std::size_t at = maps.at(k, x, y);
                if (!reference::isBeforeRim(x, y, maps.size)) continue;
                ++texels;
                if (!maps.hit(at)) {
                    ++missed;
                    continue;
                }
                const Vec d = frame.world(reference::localDirection(x, y, maps.size));
                const auto [distance, tangent] = leaveBox(size, frame.origin, d);
                const double error = std::abs(double(maps.distance(at)) / distance - 1.0);
                if (error > kDistanceRounding + kDirectionRounding * tangent) ++wrong;
                const Vec n = frame.world(maps.normal(at));
                const double most = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
                if (most < 1.0 - kNormalRounding || dot(n, d) >= 0.0) ++turned;
            }
    }
    CHECK(texels > 6 * 3000);
    CHECK(missed == 0);
    CHECK(wrong == 0);
    CHECK(turned == 0);
}

TEST_CASE("random triangles as the serial twin sees them", "[paraboloid_map][large]") {
    compareWithTwin(GENERATE(1u, 16u), soup(300, 7), kFour);
}

// Small enough for simulated devices.
TEST_CASE("a few random triangles as the serial twin sees them", "[paraboloid_map]") {
    compareWithTwin(GENERATE(1u, 16u), soup(20, 7), {kFour[1]});
}

TEST_CASE("the same bits whatever the order of triangles, the width and the run", "[paraboloid_map][large]") {
    const Mesh mesh = soup(400, 3);
    ParaboloidRig rig(16, 64), narrow(1, 64);
    const DrawnMaps maps = rig.drawn(mesh, kFour);
    CHECK(rig.maps().records == maps.records);
    CHECK(narrow.drawn(mesh, kFour).records == maps.records);
    CHECK(narrow.maps().albedo == maps.albedo);
    Mesh shuffled = mesh;
    std::vector<std::size_t> order(mesh.count());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), std::mt19937(5));
    for (std::size_t i = 0; i < order.size(); ++i) {
        for (std::size_t c = 0; c < 9; ++c) shuffled.vertices[9 * i + c] = mesh.vertices[9 * order[i] + c];
        for (std::size_t c = 0; c < 3; ++c) shuffled.albedo[3 * i + c] = mesh.albedo[3 * order[i] + c];
    }
    const DrawnMaps again = rig.drawn(shuffled, kFour);
    CHECK(again.records == maps.records);
    CHECK(again.albedo == maps.albedo);
    for (std::size_t i = 0; i < order.size(); ++i)
        CHECK(std::memcmp(&shuffled.vertices[9 * rig.input.hostIndices[i]], &mesh.vertices[9 * narrow.input.hostIndices[i]], 36) == 0);
}

TEST_CASE("nothing depends on the unit of length", "[paraboloid_map][large]") {
    const auto width = GENERATE(1u, 16u);
    const Mesh mesh = soup(200, 11);
    ParaboloidRig rig(width, 64);
    const DrawnMaps maps = rig.drawn(mesh, kFour);
    Mesh larger = mesh;
    for (float& v : larger.vertices) v *= 1024.0f;
    std::vector<lw_cluster> clusters = kFour;
    for (lw_cluster& c : clusters)
        for (int i = 0; i < 3; ++i) c.medoidPosition.s[i] *= 1024.0f;
    const DrawnMaps scaled = rig.drawn(larger, clusters);
    int differing = 0;
    for (std::size_t t = 0; t < maps.albedo.size(); ++t)
        if (scaled.distance(t) != 1024.0f * maps.distance(t) || scaled.records[2 * t + 1] != maps.records[2 * t + 1]) ++differing;
    CHECK(differing == 0);
    CHECK(scaled.albedo == maps.albedo);
}

TEST_CASE("a map is redrawn when its medoid, its normal or the geometry moved, and only then", "[paraboloid_map][large]") {
    const auto width = GENERATE(1u, 16u);
    ParaboloidRig rig(width, 64);
    Mesh mesh = soup(60, 2);
    std::vector<lw_cluster> clusters = kFour;
    CHECK(countOf(rig.draw(mesh, clusters), "maps_redrawn") == 4);
    const DrawnMaps maps = rig.maps();
    const auto poison = [&] { rig.executor().fill("test.fill", rig.pass.records(), 0x12345678u, 0, maps.records.size() * 4); };
    const auto poisoned = [&](std::size_t k) {
        const DrawnMaps now = rig.maps();
        return now.records[2 * now.at(k, 32, 32)] == 0x12345678u && now.records[2 * now.at(k, 0, 0)] == 0x12345678u;
    };
    poison();
    clusters[0].position.s[0] += 1.0f;  // the mean alone
    CHECK(countOf(rig.draw(mesh, clusters), "maps_redrawn") == 0);
    for (std::size_t k = 0; k < 4; ++k) CHECK(poisoned(k));
    clusters[1].medoidPosition.s[0] += 1e-3f;
    clusters[2].normal = clusters[3].normal;
    CHECK(countOf(rig.draw(mesh, clusters), "maps_redrawn") == 2);
    for (std::size_t k = 0; k < 4; ++k) CHECK(poisoned(k) == (k == 0 || k == 3));
    poison();
    rig.draw(mesh, kFour);
    CHECK(rig.maps().records != maps.records);
    Mesh other = soup(60, 9);
    other.version = 2;
    CHECK(countOf(rig.draw(other, kFour), "maps_redrawn") == 4);
    mesh.version = 3;
    CHECK(countOf(rig.draw(mesh, kFour), "maps_redrawn") == 4);
    CHECK(rig.maps().records == maps.records);
    poison();
    rig.pass.redrawAll();
    rig.draw(mesh, kFour);
    CHECK(rig.maps().records == maps.records);
    // A cluster that dies leaves an empty map, once.
    clusters = kFour;
    clusters[1].position.s[3] = 0.0f;
    CHECK(countOf(rig.draw(mesh, clusters), "maps_redrawn") == 1);
    const DrawnMaps emptied = rig.maps();
    for (std::uint32_t t = 0; t < 64 * 64; ++t) REQUIRE(!emptied.hit(64 * 64 + t));
    CHECK(countOf(rig.draw(mesh, clusters), "maps_redrawn") == 0);
}

TEST_CASE("no triangles, no clusters, more clusters than before", "[paraboloid_map][large]") {
    const auto width = GENERATE(1u, 16u);
    ParaboloidRig rig(width, 64);
    rig.draw(Mesh{}, {});
    CHECK(rig.pass.mapCount() == 0);
    const DrawnMaps empty = rig.drawn(Mesh{}, kFour);
    for (std::size_t t = 0; t < empty.albedo.size(); ++t)
        REQUIRE((!empty.hit(t) && std::isinf(empty.distance(t)) && empty.albedo[t] == 0));
    const Mesh mesh = soup(12, 2);
    rig.draw(mesh, {kFour[0], kFour[1]});
    const DrawnMaps four = rig.drawn(mesh, kFour);
    ParaboloidRig fresh(width, 64);
    CHECK(four.records == fresh.drawn(mesh, kFour).records);
    CHECK(rig.pass.bytes() >= ParaboloidMap::estimateBytes(64, 4));
    CHECK(fresh.pass.bytes() == ParaboloidMap::estimateBytes(64, 4));
}

TEST_CASE("of many walls the nearest is seen", "[paraboloid_map][large]") {
    const auto width = GENERATE(1u, 16u);
    ParaboloidRig rig(width, 64);
    Mesh mesh;  // one behind the other, each over half the map
    for (int i = 0; i < 600; ++i) mesh.addQuad({-9, -9, 2.0 - 0.002 * i}, {18, 0, 0}, {0, 18, 0});
    const std::vector<lw_cluster> clusters = {kFour[0]};
    rig.draw(mesh, clusters);
    const DrawnMaps maps = rig.maps();
    CHECK(double(maps.distance(maps.at(0, 32, 32))) == Approx(2.0 - 0.002 * 599).epsilon(0.01));
    Mesh front;
    front.addQuad({-9, -9, 2.0 - 0.002 * 599}, {18, 0, 0}, {0, 18, 0});
    ParaboloidRig alone(width, 64);
    const DrawnMaps expected = alone.drawn(front, clusters);
    int differing = 0;
    for (std::size_t t = 0; t < maps.albedo.size(); ++t) differing += maps.hit(t) != expected.hit(t) ? 1 : 0;
    CHECK(differing < 64);
}

TEST_CASE("a map's size is refused by name", "[paraboloid_map]") {
    KernelRig rig(16);
    for (const std::uint32_t size : {0u, 48u, 72u, 528u})
        CHECK(thrown([&] { ParaboloidMap(rig.device(), size); }).says("mapSize: expected a multiple of 16 in 64 .. 512, got " + std::to_string(size)));
}
