// K-means of VPLs against its twin, and the properties that hold of any list.
#include "support/kmeans_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::KMeansTwin;

namespace {

// Two means whose squared distances differ by less may come out either way: a distance is a sum of six squares of
// differences of numbers up to 1, each rounded to 6e-8, of means that were rounded as often as they have members.
constexpr double kNearTie = 2e-6;
// Of all VPLs that may lie so near between two means. (None does in the cases here.)
constexpr double kTiesShare = 1e-3;
// Mean position in diagonals, mean normal: rounding of sums of up to 300 terms of at most 1.
constexpr double kMeanRounding = 2e-6;
// A VPL's share in the objective, by which rounding may raise it: squared distances of order 0.1, to means in float.
constexpr double kRise = 1e-6;
// Exponential variates of 2^16 slots: their mean has the standard deviation 1/256, of which this is four.
constexpr double kVariateMean = 4.0 / 256;

KMeansOptions optionsOf(std::uint32_t clusters, std::uint32_t iterations) {
    KMeansOptions options;
    options.clusters = clusters;
    options.iterations = iterations;
    return options;
}

KMeansTwin twinOf(const KMeansOptions& options) {
    KMeansTwin twin;
    twin.clusters = options.clusters;
    twin.positionWeight = double(options.positionWeight);
    twin.normalWeight = double(options.normalWeight);
    return twin;
}

// Counts slots that the pass gave to another cluster than the twin, all of which must be near ties.
int differences(const Clustered& got, const KMeansTwin& twin, const Vpls& vpls) {
    int count = 0;
    for (std::size_t i = 0; i < vpls.size(); ++i) {
        if (got.assignment[i] == twin.assignment[i]) continue;
        ++count;
        CAPTURE(i, got.assignment[i], twin.assignment[i]);
        REQUIRE((got.assignment[i] >= 0 && twin.assignment[i] >= 0));
        const double theirs = twin.distance(vpls[i], twin.assignedTo[std::size_t(got.assignment[i])]);
        REQUIRE(theirs - twin.distances[i] < kNearTie);
    }
    return count;
}

// `before`: the clusters that a warm start began with, none else.
void checkAgainst(const Clustered& got, const KMeansTwin& twin, const Vpls& vpls, const std::vector<lw_cluster>& before = {}) {
    const int count = differences(got, twin, vpls);
    CHECK(count <= kTiesShare * double(vpls.size()));
    if (count) return;  // means then differ by whole members
    for (std::size_t k = 0; k < twin.clusters; ++k) {
        const KMeansTwin::Mean& mean = twin.means[k];
        const lw_cluster& c = got.clusters[k];
        CAPTURE(k);
        REQUIRE(double(c.position.s[3]) == mean.members);
        if (mean.members == 0) continue;
        const reference::Vec off = reference::Vec{c.position.s[0], c.position.s[1], c.position.s[2]} - mean.position,
                             turn = reference::Vec{c.normal.s[0], c.normal.s[1], c.normal.s[2]} - mean.normal;
        CHECK(std::sqrt(dot(off, off)) <= kMeanRounding * twin.diagonal);
        CHECK(std::sqrt(dot(turn, turn)) <= kMeanRounding);
        // The medoid is the nearest member, if not the one that it was before and a quarter of whose distance is less; the
        // spread is their sum.
        const auto weighed = [&](std::size_t i) {
            const bool stays = !before.empty() && before[k].medoidPosition.s[3] == float(i);
            return twin.distance(vpls[i], mean) * (stays ? 0.25 : 1.0);
        };
        double nearest = 1e30, spread = 0.0;
        for (std::size_t i = 0; i < vpls.size(); ++i)
            if (twin.assignment[i] == int(k)) {
                nearest = std::min(nearest, weighed(i));
                spread += twin.distance(vpls[i], mean);
            }
        CHECK(weighed(std::size_t(c.medoidPosition.s[3])) - nearest < kNearTie);
        CHECK(std::abs(double(c.normal.s[3]) - spread) < kNearTie * mean.members);
    }
}

Vpls listOf(int kind, std::size_t count, unsigned seed) {
    return kind ? roomVpls(count, seed) : reference::randomVpls(count, seed);
}

}  // namespace

TEST_CASE("as the twin: k-means++, three iterations, warm starts", "[kmeans]") {
    const auto width = GENERATE(1u, 16u);
    const auto shape = testSize(GENERATE(std::make_pair(1u, 1u), std::make_pair(7u, 3u), std::make_pair(100u, 8u),
                                         std::make_pair(257u, 33u), std::make_pair(300u, 64u)));
    const auto kind = GENERATE(0, 1);
    CAPTURE(width, shape.first, shape.second, kind);
    KernelRig rig(width);
    const Vpls vpls = listOf(kind, shape.first, 11 + shape.first);

    // The seeds and one step from them; then whole frames.
    const KMeansOptions one = optionsOf(shape.second, 1), three = optionsOf(shape.second, 3);
    KMeansTwin twin = twinOf(one);
    twin.run(vpls, {}, 1);
    const Clustered first = clusterOnce(rig, one, vpls);
    checkSound(first, vpls);
    checkAgainst(first, twin, vpls);

    KMeans pass(rig.device(), three);
    Clustered frame = cluster(rig, pass, vpls);
    twin.run(vpls, {}, 3);
    checkAgainst(frame, twin, vpls);

    // A frame that begins anew may take more, those after it do not.
    KMeansOptions settled = three;
    settled.firstIterations = 9;
    KMeans settling(rig.device(), settled);
    KMeansTwin patient = twinOf(settled);
    const Clustered begun = cluster(rig, settling, vpls);
    patient.run(vpls, {}, 9);
    checkAgainst(begun, patient, vpls);
    patient.run(vpls, begun.clusters, 3);
    checkAgainst(cluster(rig, settling, vpls), patient, vpls, begun.clusters);

    // The lists move on; each warm start is compared from the same means.
    Vpls moved = vpls;
    for (int step = 1; step <= 3; ++step) {
        for (std::size_t i = 0; i < moved.size(); ++i) moved[i].positionArea.s[i % 3] += 0.02f;
        twin.run(moved, frame.clusters, 3);
        const std::vector<lw_cluster> before = frame.clusters;
        frame = cluster(rig, pass, moved);
        checkSound(frame, moved);
        checkAgainst(frame, twin, moved, before);
    }
}

TEST_CASE("the objective never rises", "[kmeans][large]") {
    KernelRig rig(GENERATE(1u, 16u));
    const auto clusters = GENERATE(1u, 2u, 8u, 23u);
    for (unsigned seed = 1; seed <= 24; ++seed) {
        KMeansOptions options = optionsOf(clusters, 1);
        if (seed % 4 == 1) options.positionWeight = 0.0f;
        if (seed % 4 == 2) options.normalWeight = 0.0f;
        KMeans pass(rig.device(), options);
        const Vpls vpls = listOf(int(seed % 2), 40 + 13 * seed, seed);
        double before = objective(cluster(rig, pass, vpls), vpls, options);
        for (int step = 0; step < 8; ++step) {
            const double now = objective(cluster(rig, pass, vpls), vpls, options);
            CAPTURE(clusters, seed, step, before, now);
            REQUIRE(now <= before + kRise * double(vpls.size()));
            before = now;
        }
    }
}

TEST_CASE("same input, same bits, at every width", "[kmeans]") {
    const auto [count, clusters] = testSize(GENERATE(std::make_pair(500u, 8u), std::make_pair(500u, 37u)));
    const Vpls vpls = roomVpls(count, 3), moved = roomVpls(count - 7, 4);
    std::vector<float> bits;
    std::vector<cl_int> assignment;
    for (const std::uint32_t width : {1u, 4u, 8u, 16u, 16u}) {
        KernelRig rig(width);
        KMeans pass(rig.device(), optionsOf(clusters, 3));
        cluster(rig, pass, vpls);
        const Clustered second = cluster(rig, pass, moved);
        CAPTURE(width);
        if (bits.empty()) {
            bits = numbers(second);
            assignment = second.assignment;
        }
        CHECK(bitDifference(numbers(second), bits) == "");
        CHECK(second.assignment == assignment);
    }
}

TEST_CASE("restart forgets the frame before; a still list comes to rest", "[kmeans][large]") {
    KernelRig rig(GENERATE(1u, 16u));
    const Vpls vpls = roomVpls(256, 5);
    KMeans pass(rig.device(), optionsOf(8, 3));
    const Clustered fresh = cluster(rig, pass, vpls);
    cluster(rig, pass, roomVpls(300, 6));
    CHECK(bitDifference(numbers(cluster(rig, pass, vpls, true)), numbers(fresh)) == "");
    KMeansOptions cold = optionsOf(8, 3);
    cold.warmStart = false;
    KMeans each(rig.device(), cold);
    cluster(rig, each, roomVpls(300, 6));
    CHECK(bitDifference(numbers(cluster(rig, each, vpls)), numbers(fresh)) == "");

    // Lloyd's iteration ends, also through the rounding of means to the world and back.
    for (int frame = 0; frame < 12; ++frame) cluster(rig, pass, vpls);
    const std::vector<float> rest = numbers(cluster(rig, pass, vpls));
    for (int frame = 0; frame < 5; ++frame) CHECK(bitDifference(numbers(cluster(rig, pass, vpls)), rest) == "");
}

TEST_CASE("the unit of length does not matter", "[kmeans][large]") {
    KernelRig rig(GENERATE(1u, 16u));
    const Vpls vpls = roomVpls(400, 8);
    const Clustered plain = clusterOnce(rig, optionsOf(16, 3), vpls);
    for (const float scale : {1000.0f, 1e-3f, 1024.0f, 0x1p-40f}) {
        Vpls scaled = vpls;
        for (lw_vpl& v : scaled)
            for (int axis = 0; axis < 3; ++axis) v.positionArea.s[axis] *= scale;
        CAPTURE(scale);
        Clustered got = clusterOnce(rig, optionsOf(16, 3), scaled);
        CHECK(got.assignment == plain.assignment);
        if (scale != 1024.0f && scale != 0x1p-40f) continue;
        for (lw_cluster& c : got.clusters)
            for (int axis = 0; axis < 3; ++axis) {
                c.position.s[axis] /= scale;
                c.medoidPosition.s[axis] /= scale;
            }
        CHECK(bitDifference(numbers(got), numbers(plain)) == "");
    }
}

TEST_CASE("k-means++ draws in proportion to the squared distance", "[kmeans][large]") {
    double sum = 0.0, squares = 0.0;
    for (std::uint32_t slot = 0; slot < 65536; ++slot) {
        const double e = KMeansTwin::variate(slot, 3);
        sum += e;
        squares += e * e;
    }
    CHECK(std::abs(sum / 65536 - 1.0) < kVariateMean);
    CHECK(std::abs(squares / 65536 - 2.0) < 5.0 * kVariateMean);  // e^2 varies by 20
    // 32 places in a row, 20 VPLs at each: 32 draws find nearly all of them.
    KernelRig rig(GENERATE(1u, 16u));
    Vpls vpls;
    for (int i = 0; i < 640; ++i) {
        const double place = i % 32, jitter = 0.001 * (i / 32);
        vpls.push_back(reference::makeVpl({place, jitter, 0}, {0, 0, 1}, {1, 1, 1}, 0.1));
    }
    const Clustered got = clusterOnce(rig, optionsOf(32, 1), vpls);
    int mixed = 0;
    for (int k = 0; k < 32; ++k) {
        std::set<int> places;
        for (int i = 0; i < 640; ++i)
            if (got.assignment[std::size_t(i)] == k) places.insert(i % 32);
        mixed += places.size() > 1;
    }
    // Within a place squared distances are below 4e-4 of those between neighbours.
    CHECK(mixed <= 2);
}

TEST_CASE("lists of any length", "[kmeans][large]") {
    KernelRig rig(GENERATE(1u, 16u));
    const Vpls vpls = roomVpls(65536, 9);
    KMeans pass(rig.device(), optionsOf(64, 2));
    const Clustered first = cluster(rig, pass, vpls);
    checkSound(first, vpls);
    CHECK(liveCount(first) == 64);
    const double before = objective(first, vpls, optionsOf(64, 2));
    CHECK(objective(cluster(rig, pass, vpls), vpls, optionsOf(64, 2)) <= before + kRise * 65536);
    CHECK(pass.bytes() == KMeans::estimateBytes(optionsOf(64, 2), 65536));
    checkSound(cluster(rig, pass, roomVpls(100, 2)), roomVpls(100, 2));
}
