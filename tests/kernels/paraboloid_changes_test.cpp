// Which maps are redrawn when triangles changed, and what triangles that are hard to meet leave in them.
#include "passes/paraboloid_map.h"

#include <catch2/catch.hpp>
#include <limits>
#include <random>

#include "support/paraboloid_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

std::uint64_t redrawn(const std::vector<LWCount>& counts) {
    for (const LWCount& c : counts)
        if (std::string(c.name) == "maps_redrawn") return c.value;
    FAIL("no count named maps_redrawn");
    return 0;
}

// A box without thickness of its own, at a place.
void addBlock(Mesh& mesh, Vec at, double size) {
    Mesh block;
    block.addBox({size, size, size});
    for (const reference::Triangle& t : block.triangles()) mesh.add(at + t.a, at + t.b, at + t.c);
}

// Two rooms of 2 x 2 x 2 side by side along x, a wall between them, and a block in the right one.
Mesh rooms(Vec block) {
    Mesh mesh;
    mesh.addBox({4, 2, 2}, 3, 3);
    mesh.addQuad({2, 0, 0}, {0, 2, 0}, {0, 0, 2}, 3, 3);
    addBlock(mesh, block, 0.3);
    return mesh;
}

const std::vector<lw_cluster> kLeftAndRight = {clusterAt({0.5, 1.1, 0.9}, {1, 0.1, 0}), clusterAt({3.5, 0.9, 1.2}, {-1, 0, 0.1})};

void checkLikeNew(ParaboloidRig& rig, std::uint32_t width, const Mesh& mesh, const std::vector<lw_cluster>& clusters) {
    ParaboloidRig fresh(width, 64);
    const DrawnMaps expected = fresh.drawn(mesh, clusters), maps = rig.maps();
    CHECK(maps.records == expected.records);
    CHECK(maps.albedo == expected.albedo);
}

struct Fuzz {
    std::mt19937 random;
    double within(double lower, double upper) { return std::uniform_real_distribution<double>(lower, upper)(random); }
    Vec any(double size) { return {within(-size, size), within(-size, size), within(-size, size)}; }
};

}  // namespace

TEST_CASE("a map is redrawn for what changes in its sight alone", "[paraboloid_map][large]") {
    const auto width = GENERATE(1u, 16u);
    ParaboloidRig rig(width, 64);
    Mesh mesh = rooms({2.8, 0.5, 0.5});
    CHECK(redrawn(rig.draw(mesh, kLeftAndRight)) == 2);
    const auto change = [&](Mesh now) {
        now.version = mesh.version + 1;
        mesh = now;
        const std::uint64_t maps = redrawn(rig.draw(mesh, kLeftAndRight));
        checkLikeNew(rig, width, mesh, kLeftAndRight);
        return maps;
    };
    CHECK(change(mesh) == 0);                         // another version of the same
    CHECK(change(rooms({2.8, 0.6, 0.5})) == 1);       // behind the wall of the left
    CHECK(change(rooms({1.2, 0.6, 0.5})) == 2);       // through the wall
    CHECK(change(rooms({1.2, 0.7, 0.5})) == 1);
    CHECK(change(rooms({9.0, 0.7, 0.5})) == 2);       // outside: the diagonal, and with it where maps stand
    CHECK(change(rooms({9.0, 0.3, 0.5})) == 0);
    Mesh more = mesh;
    addBlock(more, {8.9, 1.2, 1.3}, 0.1);
    CHECK(change(more) == 0);
    addBlock(more, {3.0, 1.2, 1.3}, 0.2);
    CHECK(change(more) == 1);
    Mesh other = more;
    for (std::size_t i = 3 * (other.count() - 12); i < other.albedo.size(); ++i) other.albedo[i] = 1.0f - other.albedo[i];
    CHECK(change(other) == 1);  // its colour alone
    CHECK(change(rooms({9.0, 0.3, 0.5})) == 1);  // fewer
    CHECK(change(Mesh{}) == 2);
    CHECK(change(rooms({9.0, 0.3, 0.5})) == 2);
}

// Small enough for simulated devices.
TEST_CASE("a map is redrawn for what comes before what it saw, not behind", "[paraboloid_map]") {
    const std::vector<lw_cluster> clusters = {kLeftAndRight[0]};
    ParaboloidRig rig(16, 64);
    Mesh mesh;
    mesh.addQuad({2, -50, -50}, {0, 100, 0}, {0, 0, 100});
    mesh.add({3, 1, 1}, {3, 1.5, 1}, {3, 1, 1.5});
    mesh.add({9, 1, 1}, {1, 60, 1}, {9, 60, 1});  // keeps the bounding box
    rig.draw(mesh, clusters);
    mesh.vertices[9 * 2] = 3.5f;
    ++mesh.version;
    CHECK(redrawn(rig.draw(mesh, clusters)) == 0);
    mesh.vertices[9 * 2] = 1.5f;
    ++mesh.version;
    CHECK(redrawn(rig.draw(mesh, clusters)) == 1);
    checkLikeNew(rig, 16, mesh, clusters);
}

TEST_CASE("maps kept over random changes are those of a new pass, bit for bit", "[paraboloid_map][large]") {
    const auto width = GENERATE(1u, 16u);
    Fuzz fuzz{std::mt19937(4)};
    const std::vector<lw_cluster> clusters = {kLeftAndRight[0], kLeftAndRight[1], clusterAt({1.99, 1, 1}, {-1, 0, 0}),
                                              clusterAt({2.01, 1, 1}, {1, 0, 0}), clusterAt({0.1, 0.1, 0.1}, {1, 1, 1})};
    ParaboloidRig rig(width, 64);
    Mesh mesh = rooms({2.8, 0.5, 0.5});
    for (int i = 0; i < 12; ++i) addBlock(mesh, {fuzz.within(0, 3.7), fuzz.within(0, 1.7), fuzz.within(0, 1.7)}, 0.2);
    rig.draw(mesh, clusters);
    std::uint64_t kept = 0;
    for (int round = 0; round < 30; ++round) {
        const std::size_t t = std::uniform_int_distribution<std::size_t>(60, mesh.count() - 1)(fuzz.random);
        const double by = fuzz.within(-0.02, 0.02);
        for (std::size_t i = 9 * t; i < 9 * t + 9; ++i) mesh.vertices[i] += float(by);
        ++mesh.version;
        kept += clusters.size() - redrawn(rig.draw(mesh, clusters));
        checkLikeNew(rig, width, mesh, clusters);
    }
    CHECK(kept > 30);
}

TEST_CASE("the same bits at every width where rays graze what they meet", "[paraboloid_map][large]") {
    const double unit = GENERATE(1e-6, 1.0, 1e6);
    Fuzz fuzz{std::mt19937(12)};
    Mesh mesh;
    mesh.addQuad(Vec{-5, 0, -5} * unit, Vec{10, 0, 0} * unit, Vec{0, 0, 10} * unit, 40, 40);
    for (int i = 0; i < 300; ++i) {  // walls across the floor, and next to it
        const Vec at = Vec{fuzz.within(-4, 4), fuzz.within(-0.3, 0.0), fuzz.within(-4, 4)} * unit;
        mesh.addQuad(at, Vec{fuzz.within(-1, 1), 0, fuzz.within(-1, 1)} * unit, Vec{0, fuzz.within(0.0, 0.6), 0} * unit);
        mesh.addQuad(at, fuzz.any(0.3) * unit, Vec{fuzz.within(-1, 1), 1e-4, fuzz.within(-1, 1)} * unit);
    }
    std::vector<lw_cluster> clusters;
    for (int i = 0; i < 12; ++i)
        clusters.push_back(clusterAt(Vec{fuzz.within(-3, 3), 0, fuzz.within(-3, 3)} * unit, {fuzz.within(-1, 1), i % 2 ? 1.0 : 0.2, fuzz.within(-1, 1)}));
    for (int i = 0; i < 4; ++i) {  // exactly on corners
        const std::size_t v = 3 * std::uniform_int_distribution<std::size_t>(0, 3 * mesh.count() - 1)(fuzz.random);
        clusters.push_back(clusterAt({double(mesh.vertices[v]), double(mesh.vertices[v + 1]), double(mesh.vertices[v + 2])}, {0, 1, 0}));
    }
    ParaboloidRig wide(16, 64);
    const DrawnMaps maps = wide.drawn(mesh, clusters);
    for (const std::uint32_t width : {1u, 4u, 8u}) {
        ParaboloidRig rig(width, 64);
        const DrawnMaps other = rig.drawn(mesh, clusters);
        int differing = 0;
        for (std::size_t t = 0; t < maps.albedo.size(); ++t)
            differing += maps.records[2 * t] != other.records[2 * t] || maps.records[2 * t + 1] != other.records[2 * t + 1] || maps.albedo[t] != other.albedo[t] ? 1 : 0;
        CAPTURE(unit, width);
        CHECK(differing == 0);
    }
}

TEST_CASE("normals of slivers are unit, and coincident triangles the same whatever their order", "[paraboloid_map][large]") {
    const auto width = GENERATE(1u, 16u);
    Fuzz fuzz{std::mt19937(5)};
    Mesh mesh;
    for (int i = 0; i < 400; ++i) {  // corners in line, but for rounding
        const Vec a = fuzz.any(2.0), along = fuzz.any(3.0);
        mesh.add(a, a + along, a + along * fuzz.within(0.2, 3.0));
    }
    for (int i = 0; i < 40; ++i) {
        const Vec a = fuzz.any(3.0), b = fuzz.any(3.0), c = fuzz.any(3.0);
        for (int copies = 0; copies < 20; ++copies) mesh.add(a, b, c);
    }
    ParaboloidRig rig(width, 64);
    const std::vector<lw_cluster> clusters = {clusterAt({0, 0, 0}, {0, 0, 1}), clusterAt({0.3, -0.2, 0.1}, {0, 0, -1})};
    const DrawnMaps maps = rig.drawn(mesh, clusters);
    int hits = 0, odd = 0;
    for (std::size_t t = 0; t < maps.albedo.size(); ++t) {
        if (!maps.hit(t)) continue;
        ++hits;
        odd += std::abs(reference::length(maps.normal(t)) - 1.0) > 4e-3 ? 1 : 0;
    }
    CHECK(hits > 1000);
    CHECK(odd == 0);
    Mesh turned;
    for (std::size_t t = mesh.count(); t-- > 0;) {
        turned.vertices.insert(turned.vertices.end(), &mesh.vertices[9 * t], &mesh.vertices[9 * t] + 9);
        turned.albedo.insert(turned.albedo.end(), &mesh.albedo[3 * t], &mesh.albedo[3 * t] + 3);
    }
    ParaboloidRig again(width, 64);
    CHECK(again.drawn(turned, clusters).albedo == maps.albedo);
}
