// K-means of VPLs on lists whose clusters are known, and on lists that leave it little or nothing to cluster.
#include <limits>

#include "compute/error.h"
#include "support/kmeans_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::makeVpl;
using reference::Vec;

namespace {

KMeansOptions optionsOf(std::uint32_t clusters) {
    KMeansOptions options;
    options.clusters = clusters;
    return options;
}

// `count` VPLs within `radius` of a place, all with this normal.
Vpls blob(Vec centre, Vec normal, double radius, std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> offset(-radius, radius);
    Vpls vpls;
    for (std::size_t i = 0; i < count; ++i)
        vpls.push_back(makeVpl(centre + Vec{offset(random), offset(random), offset(random)}, normal, {1, 2, 3}, 0.01));
    return vpls;
}

Vpls joined(Vpls a, const Vpls& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

// The cluster that all slots of a range share, or -2.
int sharedBy(const Clustered& clustered, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
        if (clustered.assignment[i] != clustered.assignment[begin]) return -2;
    return clustered.assignment[begin];
}

}  // namespace

TEST_CASE("two far blobs are two clusters", "[kmeans]") {
    KernelRig rig(GENERATE(1u, 16u));
    const Vpls vpls = joined(blob({0, 0, 0}, {0, 1, 0}, 0.5, 60, 1), blob({20, 0, 0}, {0, 1, 0}, 0.5, 45, 2));
    const Clustered got = clusterOnce(rig, optionsOf(2), vpls);
    checkSound(got, vpls);
    const int a = sharedBy(got, 0, 60), b = sharedBy(got, 60, 105);
    REQUIRE((a >= 0 && b >= 0 && a != b));
    CHECK(std::abs(got.clusters[std::size_t(a)].position.s[0]) < 0.5f);
    CHECK(std::abs(got.clusters[std::size_t(b)].position.s[0] - 20.0f) < 0.5f);
    CHECK(got.clusters[std::size_t(b)].flux.s[2] == 135.0f);
}

TEST_CASE("both sides of a wall part by their normals", "[kmeans]") {
    KernelRig rig(GENERATE(1u, 16u));
    // A wall of 1 x 1 m without thickness, and the same with every VPL at one place.
    for (const double size : {1.0, 0.0}) {
        Vpls vpls;
        for (int i = 0; i < 128; ++i)
            vpls.push_back(makeVpl({size * (i / 2 % 8) / 8.0, size * (i / 16) / 8.0, 0}, {0, 0, i % 2 ? 1.0 : -1.0},
                                   {1, 1, 1}, 0.01));
        const Clustered got = clusterOnce(rig, optionsOf(2), vpls);
        checkSound(got, vpls);
        for (std::size_t i = 2; i < 128; ++i) REQUIRE(got.assignment[i] == got.assignment[i % 2]);
        CHECK(got.assignment[0] != got.assignment[1]);
    }
}

TEST_CASE("normals that cancel leave a member's", "[kmeans]") {
    KernelRig rig(GENERATE(1u, 16u));
    const Vpls vpls = joined(blob({0, 0, 0}, {0, 0, 1}, 0.0, 20, 1), blob({1, 0, 0}, {0, 0, -1}, 0.0, 20, 2));
    const Clustered got = clusterOnce(rig, optionsOf(1), vpls);
    checkSound(got, vpls);
    CHECK(got.clusters[0].normal.s[2] == 1.0f);  // slot 0's
    CHECK(got.clusters[0].position.s[0] == 0.5f);
}

TEST_CASE("of equally near means the first, of equally near members the first", "[kmeans]") {
    KernelRig rig(GENERATE(1u, 16u));
    KMeansOptions options = optionsOf(2);
    options.iterations = 1;
    KMeans pass(rig.device(), options);
    // Two means at -1 and 1 (of two VPLs each); then a VPL in the middle of them.
    const Vec up{0, 1, 0}, grey{1, 1, 1};
    auto at = [&](double x) { return makeVpl({x, 0, 0}, up, grey, 0.1); };
    const Vpls ends{at(-1.25), at(-0.75), at(1.25), at(0.75)};
    const Clustered first = cluster(rig, pass, ends);
    CHECK(first.clusters[std::size_t(first.assignment[0])].medoidPosition.s[3] == 0.0f);
    CHECK(first.clusters[std::size_t(first.assignment[2])].medoidPosition.s[3] == 2.0f);
    const Clustered second = cluster(rig, pass, {at(-1.25), at(-0.75), at(1.25), at(0.75), at(0.0)});
    CHECK(second.assignment[4] == 0);
    // Also of a new mean: cluster 0 has lost its VPLs and is given the farthest one; another lies half way to it.
    KMeans again(rig.device(), options);
    const Clustered pair = cluster(rig, again, {at(-16), at(16)});
    const double x = pair.assignment[0] == 1 ? -16 : 16, half = 0.25 * x;
    const Clustered third = cluster(rig, again, {at(x), at(x + 2 * half), at(x + half)});
    CHECK(third.assignment == std::vector<cl_int>{1, 0, 0});
}

TEST_CASE("warm starts keep clusters in their places and give a dying one another", "[kmeans]") {
    KernelRig rig(GENERATE(1u, 16u));
    std::vector<Vec> centres;
    for (int b = 0; b < 5; ++b) centres.push_back({4.0 * b, double(b % 2) * 3.0, 0});
    auto blobs = [&](double shift, int without) {
        Vpls vpls;
        for (int b = 0; b < 5; ++b) {
            Vpls more = blob(centres[std::size_t(b)] + Vec{shift, 0, shift}, {0, 1, 0}, 0.3, 30, 7 + unsigned(b));
            if (b == without)
                for (lw_vpl& v : more) v.flux = {{0, 0, 0, 0}};
            vpls = joined(vpls, more);
        }
        return vpls;
    };
    KMeans pass(rig.device(), optionsOf(5));
    Clustered got = cluster(rig, pass, blobs(0, -1));
    int names[5];
    for (int b = 0; b < 5; ++b) {
        names[b] = sharedBy(got, std::size_t(30 * b), std::size_t(30 * b + 30));
        REQUIRE(names[b] >= 0);
    }
    for (int frame = 1; frame <= 10; ++frame) {
        got = cluster(rig, pass, blobs(0.1 * frame, -1));
        for (int b = 0; b < 5; ++b) CHECK(sharedBy(got, std::size_t(30 * b), std::size_t(30 * b + 30)) == names[b]);
    }
    // A blob goes dark: its cluster moves to a part of another blob at once, and three others stay what they are.
    const Vpls dark = blobs(1.0, 2);
    got = cluster(rig, pass, dark);
    checkSound(got, dark);
    CHECK(liveCount(got) == 5);
    int kept = 0;
    for (int b = 0; b < 5; ++b) kept += sharedBy(got, std::size_t(30 * b), std::size_t(30 * b + 30)) == names[b];
    CHECK(kept == 3);
    CHECK(sharedBy(got, 60, 90) == -1);
    // All dark, then lit again: k-means++ anew.
    Vpls night = dark;
    for (lw_vpl& v : night) v.flux = {{0, 0, 0, 0}};
    CHECK(liveCount(cluster(rig, pass, night)) == 0);
    const Clustered dawn = cluster(rig, pass, dark);
    CHECK(bitDifference(numbers(dawn), numbers(clusterOnce(rig, optionsOf(5), dark))) == "");
}

TEST_CASE("several clusters that die at once get distinct places", "[kmeans][large]") {
    KernelRig rig(GENERATE(1u, 16u));
    KMeans pass(rig.device(), optionsOf(32));
    cluster(rig, pass, roomVpls(300, 1));
    // All of the light falls into one corner: most means have no VPL left.
    const Vpls corner = blob({0.1, 0.1, 0.1}, {0, 1, 0}, 0.1, 200, 3);
    const Clustered got = cluster(rig, pass, corner);
    checkSound(got, corner);
    CHECK(liveCount(got) == 32);
    // The list shrinks below the number of clusters and grows again.
    const Clustered few = cluster(rig, pass, Vpls(corner.begin(), corner.begin() + 10));
    CHECK(liveCount(few) == 10);
    CHECK(liveCount(cluster(rig, pass, corner)) == 32);
}

TEST_CASE("nothing, one, one place, fewer than clusters", "[kmeans]") {
    KernelRig rig(GENERATE(1u, 16u));
    KMeans pass(rig.device(), optionsOf(8));
    const Vpls one = blob({3, 4, 5}, {0, 0, 1}, 0, 1, 1), place = blob({3, 4, 5}, {0, 0, 1}, 0, 200, 1),
               few = roomVpls(5, 21), fewer = blob({3, 4, 5}, {0, 1, 0}, 1, 5, 2);
    for (const bool restart : {true, false})
        for (int round = 0; round < 2; ++round) {
            CHECK(liveCount(cluster(rig, pass, {}, restart)) == 0);
            Clustered got = cluster(rig, pass, one, restart);
            checkSound(got, one);
            CHECK(liveCount(got) == 1);
            const lw_cluster& c = got.clusters[std::size_t(got.assignment[0])];
            CHECK((c.position.s[0] == 3.0f && c.position.s[1] == 4.0f && c.position.s[2] == 5.0f));
            CHECK((c.normal.s[2] == 1.0f && c.normal.s[3] == 0.0f));
            got = cluster(rig, pass, place, restart);
            checkSound(got, place);
            CHECK(liveCount(got) == 1);
            // Of 200 members as near, in two chunks.
            CHECK(got.clusters[std::size_t(got.assignment[0])].medoidPosition.s[3] == 0.0f);
            got = cluster(rig, pass, few, restart);
            checkSound(got, few);
            got = cluster(rig, pass, fewer, restart);
            checkSound(got, fewer);
            CHECK(liveCount(got) == 5);
            Vpls dark = few;
            for (lw_vpl& v : dark) v.flux = {{0, 0, 0, 0}};
            got = cluster(rig, pass, dark, restart);
            checkSound(got, dark);
            CHECK(liveCount(got) == 0);
        }
}

TEST_CASE("positions and flux at the ends of their range", "[kmeans][large]") {
    KernelRig rig(GENERATE(1u, 16u));
    Vpls far = roomVpls(300, 31);
    for (std::size_t i = 0; i < far.size(); ++i)
        for (int axis = 0; axis < 3; ++axis) far[i].positionArea.s[axis] = (far[i].positionArea.s[axis] - 2.0f) * 2.5e8f;
    Vpls bright = roomVpls(300, 32);
    for (lw_vpl& v : bright) v.flux.s[1] *= 1e30f;
    Vpls lone = roomVpls(300, 33);  // one VPL where no other is, and a garbage position without flux
    lone[17] = makeVpl({1e9, -1e9, 1e9}, {0, 1, 0}, {1, 1, 1}, 1);
    lone[18] = makeVpl({3e38, -3e38, 3e38}, {0, 1, 0}, {0, 0, 0}, 1);
    Vpls tiny = roomVpls(300, 34);
    for (lw_vpl& v : tiny)
        for (int axis = 0; axis < 3; ++axis) v.positionArea.s[axis] *= 1e-30f;
    for (const Vpls* list : {&far, &bright, &lone, &tiny})
        for (const std::uint32_t clusters : {1u, 8u, 64u}) {
            const Vpls& vpls = *list;
            KMeans pass(rig.device(), optionsOf(clusters));
            checkSound(cluster(rig, pass, vpls), vpls);
            const Clustered again = cluster(rig, pass, vpls);
            checkSound(again, vpls);
            // The others are one point to it, parted by their normals.
            if (list == &lone && clusters == 8)
                CHECK(again.clusters[std::size_t(again.assignment[17])].position.s[3] == 1.0f);
        }
}

TEST_CASE("every VPL a cluster of its own", "[kmeans]") {
    KernelRig rig(GENERATE(1u, 16u));
    KMeans pass(rig.device(), optionsOf(0));
    for (const std::size_t count : {0u, 1u, 500u}) {
        const Vpls vpls = roomVpls(count, 41);
        const Clustered got = cluster(rig, pass, vpls);
        REQUIRE(pass.clusterCount() == count);
        CHECK(pass.bytes() == KMeans::estimateBytes(optionsOf(0), std::uint32_t(count)));
        for (const float x : numbers(got)) REQUIRE(std::isfinite(x));
        for (std::size_t i = 0; i < count; ++i) {
            const bool lit = reference::KMeansTwin::lit(vpls[i]);
            REQUIRE(got.assignment[i] == (lit ? int(i) : -1));
            REQUIRE(got.clusters[i].position.s[3] == (lit ? 1.0f : 0.0f));
            REQUIRE(got.clusters[i].flux.s[0] == vpls[i].flux.s[0]);
            if (!lit) continue;
            REQUIRE(got.clusters[i].position.s[1] == vpls[i].positionArea.s[1]);
            REQUIRE(got.clusters[i].medoidNormal.s[2] == vpls[i].normal.s[2]);
            REQUIRE(got.clusters[i].medoidPosition.s[3] == float(i));
        }
    }
}

TEST_CASE("debug planes, bytes, refusals", "[kmeans]") {
    KernelRig rig(16);
    const Vpls vpls = roomVpls(200, 51);
    KMeans pass(rig.device(), optionsOf(10));
    const Clustered got = cluster(rig, pass, vpls);
    CHECK(pass.bytes() == KMeans::estimateBytes(optionsOf(10), 200));
    Planes planes = pass.debugShape();
    const Guarded memory = rig.make<float>(std::size_t(planes.planeStride) * planes.count);
    planes.memory = memory.get();
    pass.recordPlanes(rig.executor(), planes);
    rig.device().finish();
    const std::vector<float> values = rig.download<float>(memory);
    for (std::size_t k = 0; k < 10; ++k) {
        const std::size_t stride = std::size_t(planes.planeStride);
        CHECK(values[k] == got.clusters[k].position.s[0]);
        CHECK(values[9 * stride + k] == got.clusters[k].position.s[3]);
        CHECK(values[15 * stride + k] == got.clusters[k].medoidNormal.s[2]);
    }
    KMeansOptions bad = optionsOf(65);
    CHECK_THROWS_AS(KMeans(rig.device(), bad), Error);
    bad = optionsOf(8);
    bad.iterations = 0;
    CHECK_THROWS_AS(KMeans(rig.device(), bad), Error);
    for (const float weight : {-1.0f, std::numeric_limits<float>::quiet_NaN(), 1e7f}) {
        bad = optionsOf(8);
        bad.normalWeight = weight;
        CHECK_THROWS_AS(KMeans(rig.device(), bad), Error);
    }
    const Guarded list = rig.upload(vpls);
    CHECK_THROWS_AS(pass.record(rig.executor(), list, (1u << 24) + 1, false), Error);
    CHECK_THROWS_AS(KMeans::estimateBytes(optionsOf(8), (1u << 24) + 1), Error);
}
