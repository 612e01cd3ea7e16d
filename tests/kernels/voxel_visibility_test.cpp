// Visibility through voxels: shadows against lines drawn from the eye, walls against nothing at all coming through, and what is swept when.
#include "passes/voxel_visibility.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "support/voxel_sight_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Image;
using reference::Vec;

namespace {

constexpr int kSize = 32;

std::size_t at(int size, int x, int y, int z) { return std::size_t(x + size * (y + size * z)); }
int lightOf(unsigned char byte) { return byte & LW_SIGHT_FULL; }

// Floating clusters in the open: their eyes stand off by one voxel along x.
lw_cluster eyeAt(Vec voxels) { return clusterIn(voxels - Vec{1, 0, 0}, {1, 0, 0}); }

Voxels randomVoxels(int size, int count, unsigned seed) {
    Voxels voxels(size);
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> coordinate(0, size - 1);
    for (int i = 0; i < count; ++i) {
        const int x = coordinate(random), y = coordinate(random), z = coordinate(random);
        voxels.set(x, y, z);
    }
    return voxels;
}

}  // namespace

TEST_CASE("where nothing lies, all of every eye's light arrives", "[voxel_visibility]") {
    const auto width = GENERATE(1u, 16u);
    VoxelSightRig rig(width, kSize);
    const std::vector<lw_cluster> clusters = {eyeAt({16.3, 15.8, 16.5}), eyeAt({1.2, 0.1, 0.3}), eyeAt({31.9, 30.7, 31.2}),
                                              eyeAt({7.0, 8.0, 31.99})};
    rig.sweep(Voxels(kSize), clusters);
    const std::vector<unsigned char> sights = rig.sights(clusters.size());
    CHECK(std::count(sights.begin(), sights.end(), LW_SIGHT_FULL) == std::ptrdiff_t(sights.size()));
    CHECK(rig.state().swept == 4);
}

TEST_CASE("the edge of a half-plane's shadow lies within a voxel of the line from the eye", "[voxel_visibility]") {
    // A wall in layer `wall` of an axis, over all of the second axis, and of the third up to an edge.
    const auto axis = GENERATE(0, 1, 2);
    const auto turned = GENERATE(false, true);
    VoxelSightRig rig(16, kSize);
    const int wall = 12, screen = 26, edge = 14, main = axis, along = (axis + (turned ? 2 : 1)) % 3;
    Voxels voxels(kSize);
    voxels.fill([&](int x, int y, int z) {
        const int p[3] = {x, y, z};
        return p[main] == wall && p[along] < edge;
    });
    std::vector<lw_cluster> clusters;
    std::vector<Vec> eyes;
    for (const double height : {4.3, 9.7, 13.6, 17.5, 22.4}) {
        double p[3] = {15.6, 15.6, 15.6};
        p[main] = 3.4;
        p[along] = height;
        eyes.push_back({p[0], p[1], p[2]});
        clusters.push_back(eyeAt(eyes.back()));
    }
    rig.sweep(voxels, clusters);
    const std::vector<unsigned char> sights = rig.sights(clusters.size());
    for (std::size_t e = 0; e < eyes.size(); ++e) {
        const double from[3] = {eyes[e].x, eyes[e].y, eyes[e].z};
        // The wall's far side decides for eyes above the edge, its near one for those below.
        const double corner = from[along] > edge ? wall + 1.0 : wall;
        const double line = from[along] + (edge - from[along]) * (screen + 0.5 - from[main]) / (corner - from[main]);
        if (line < 1.0 || line > kSize - 1.0) continue;
        for (const int across : {6, 15, 20}) {
            double lit = 0.0;
            for (int i = 0; i < kSize; ++i) {
                int p[3] = {across, across, across};
                p[main] = screen;
                p[along] = i;
                lit += lightOf(sights[e * kSize * kSize * kSize + at(kSize, p[0], p[1], p[2])]) / double(LW_SIGHT_FULL);
            }
            CAPTURE(axis, turned, e, across);
            CHECK(kSize - lit == Approx(line).margin(1.0));
        }
    }
}

TEST_CASE("a wall of one voxel lets nothing through, however it stands", "[voxel_visibility]") {
    const auto size = GENERATE(32, 64);
    VoxelSightRig rig(16, size);
    for (const Vec n : {Vec{1, 0, 0}, Vec{0, 1, 0}, Vec{0, 0, 1}, Vec{0.8, 0.6, 0}, Vec{0.3, -0.5, 0.9}, Vec{1, 1, 1}}) {
        const Vec normal = reference::unit(n), middle{size * 0.52, size * 0.52, size * 0.52};
        Voxels voxels(size);
        voxels.fill([&](int x, int y, int z) { return voxels.touches(middle, normal, x, y, z); });
        const Vec eye = middle + normal * (0.25 * size);
        rig.sweep(voxels, {eyeAt(eye)});
        const std::vector<unsigned char> sights = rig.sights(1);
        int behind = 0, through = 0;
        for (int z = 0; z < size; ++z)
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) {
                    if (dot(Vec{x + 0.5, y + 0.5, z + 0.5} - middle, normal) > -1.0 || voxels.has(x, y, z)) continue;
                    ++behind;
                    through += lightOf(sights[at(size, x, y, z)]) > 0;
                }
        CAPTURE(size, n.x, n.y, n.z);
        CHECK(behind > size * size * size / 8);
        CHECK(through == 0);
    }
}

TEST_CASE("what is added only takes light away", "[voxel_visibility]") {
    VoxelSightRig rig(16, kSize);
    const std::vector<lw_cluster> clusters = {eyeAt({16.3, 15.8, 16.5}), eyeAt({2.2, 29.1, 8.3})};
    Voxels voxels(kSize);
    std::vector<unsigned char> before(2 * kSize * kSize * kSize, LW_SIGHT_FULL);
    for (unsigned step = 1; step <= 5; ++step) {
        const Voxels more = randomVoxels(kSize, 120, step);
        for (std::size_t i = 0; i < voxels.words.size(); ++i) voxels.words[i] |= more.words[i];
        // The voxels that eyes are in stay open: an eye that finds its own taken looks from another.
        for (const Vec eye : {Vec{16.3, 15.8, 16.5}, Vec{2.2, 29.1, 8.3}}) {
            const int bit = int(eye.x) % 8 + 8 * (int(eye.y) % 8) + 64 * (int(eye.z) % 8);
            const int brick = int(eye.x) / 8 + 4 * (int(eye.y) / 8 + 4 * (int(eye.z) / 8));
            voxels.words[std::size_t(brick * 16 + bit / 32)] &= ~(1u << (bit % 32));
        }
        rig.sweep(voxels, clusters);
        const std::vector<unsigned char> sights = rig.sights(2);
        int brighter = 0, darker = 0;
        for (std::size_t i = 0; i < sights.size(); ++i) {
            brighter += lightOf(sights[i]) > lightOf(before[i]);
            darker += lightOf(sights[i]) < lightOf(before[i]);
        }
        CHECK(brighter == 0);
        CHECK(darker > 100);
        before = sights;
    }
}

TEST_CASE("the same bits at every width, in every run", "[voxel_visibility]") {
    const Voxels voxels = randomVoxels(kSize, 900, 3);
    const std::vector<lw_cluster> clusters = {eyeAt({16.3, 15.8, 16.5}), eyeAt({2.2, 29.1, 8.3}), eyeAt({31.5, 0.5, 0.5})};
    std::vector<unsigned char> first;
    for (const std::uint32_t width : {1u, 4u, 16u, 16u}) {
        VoxelSightRig rig(width, kSize);
        rig.sweep(voxels, clusters);
        const std::vector<unsigned char> sights = rig.sights(clusters.size());
        if (first.empty()) first = sights;
        CHECK(sights == first);
    }
}

TEST_CASE("only eyes that move are swept, and all when what lies in voxels changes", "[voxel_visibility]") {
    VoxelSightRig rig(16, kSize), fresh(16, kSize);
    Voxels voxels = randomVoxels(kSize, 300, 4);
    std::vector<lw_cluster> clusters = {eyeAt({16.3, 15.8, 16.5}), eyeAt({2.2, 29.1, 8.3}), eyeAt({40.0, 3.0, 3.0})};
    rig.sweep(voxels, clusters);
    CHECK(rig.state().swept == 2);  // the third is beyond the grid
    rig.sweep(voxels, clusters);
    CHECK(rig.state().swept == 0);
    clusters[1] = eyeAt({2.2, 28.1, 8.3});
    rig.sweep(voxels, clusters);
    CHECK(rig.state().swept == 1);
    voxels.set(20, 20, 20);
    rig.sweep(voxels, clusters);
    CHECK(rig.state().swept == 2);
    fresh.sweep(voxels, clusters);
    CHECK(rig.sights(2) == fresh.sights(2));
    rig.pass.forget();
    rig.sweep(voxels, clusters);
    CHECK(rig.state().swept == 2);
}

TEST_CASE("beyond the grid counts what arrives where light leaves it", "[voxel_visibility]") {
    VoxelSightRig rig(GENERATE(1u, 16u), kSize);
    Voxels voxels(kSize);
    voxels.fill([](int x, int y, int) { return x == 24 && y < 16; });
    const Vec eye{8.5, 16.5, 16.5};
    rig.sweep(voxels, {eyeAt(eye)});
    Image position(4, 1), normal(4, 1);
    // Ways that pass the wall far above its edge and far below, to places twice and twenty times as far away as the border.
    const double reach = kSize - eye.x;
    int i = 0;
    for (const double rise : {10.0, -10.0})
        for (const double times : {2.0, 20.0}) {
            position.set(std::uint32_t(i), 0, inWorld(eye + Vec{reach, rise, 0.0} * times));
            normal.set(std::uint32_t(i++), 0, {-1, 0, 0});
        }
    const std::vector<float> seen = rig.seen(position, normal, 1);
    CHECK(seen[0] == 1.0f);
    CHECK(seen[1] == 1.0f);
    CHECK(seen[2] == 0.0f);
    CHECK(seen[3] == 0.0f);
}
