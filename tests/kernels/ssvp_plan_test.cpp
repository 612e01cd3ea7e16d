// How many clusters and bounces a frame takes: against counts known by construction, at rest and in slow
// motion.
#include "passes/ssvp_plan.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "support/kmeans_rig.h"
#include "support/ssvp_plan_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

Used clusterFrames(KernelRig& rig, SsvpPlan& plan, KMeans& kmeans, const Vpls& vpls, int frames,
                   bool restart = false) {
    const Guarded list = rig.upload(vpls);
    for (int i = 0; i < frames; ++i) {
        plan.begin(rig.executor(), restart && i == 0);
        kmeans.record(rig.executor(), list, std::uint32_t(vpls.size()), restart && i == 0,
                      plan.seeds(0));
        plan.recordClusters(rig.executor(), 0, kmeans);
    }
    return usedBy(rig, plan);
}

KMeansOptions most(std::uint32_t clusters) {
    KMeansOptions options;
    options.clusters = clusters;
    return options;
}

std::vector<lw_cluster> clustersOf(const KMeans& kmeans) {
    std::vector<lw_cluster> clusters(kmeans.clusterCount());
    kmeans.clusters().download(0, clusters.size() * sizeof(lw_cluster), clusters.data());
    return clusters;
}

// VPLs on the floor of a unit room and on a wall, at random.
Vpls onTwoWalls(std::size_t count, unsigned seed, double shift = 0.0) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> u(0.0, 1.0);
    Vpls vpls;
    for (std::size_t i = 0; i < count; ++i) {
        const double a = 0.6 * u(random) + shift, b = u(random);
        vpls.push_back(i % 2 ? reference::makeVpl({a, 0, b}, {0, 1, 0}, {1, 1, 1}, 0.01f)
                             : reference::makeVpl({0, a, b}, {1, 0, 0}, {1, 1, 1}, 0.01f));
    }
    return vpls;
}

}  // namespace

TEST_CASE("one place takes one cluster, two far blobs two", "[ssvp_plan]") {
    KernelRig rig(GENERATE(1u, 16u));
    KMeans kmeans(rig.device(), most(mostClusters()));
    SsvpPlan plan(rig.device(), optionsOf(0.3f));
    const Used first = clusterFrames(rig, plan, kmeans, onTwoWalls(someVpls(), 1), 1);
    CHECK(first.clusters == mostClusters());
    CHECK(first.whyClusters.find("first frame") != std::string::npos);
    const Vpls place(someVpls(), reference::makeVpl({1, 2, 3}, {0, 1, 0}, {1, 1, 1}, 0.01f));
    CHECK(clusterFrames(rig, plan, kmeans, place, 2, true).clusters == 1);
    Vpls blobs;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> u(-0.1, 0.1);
    for (std::size_t i = 0; i < someVpls(); ++i)
        blobs.push_back(reference::makeVpl({(i % 2 ? 10.0 : 0.0) + u(random), 0, u(random)}, {0, 1, 0},
                                           {1, 1, 1}, 0.01f));
    // From one cluster it grows, from the most it shrinks.
    for (const bool restart : {false, true}) {
        const Used used = clusterFrames(rig, plan, kmeans, blobs, someFrames(6, 4), restart);
        CHECK(used.clusters == 2);
        CHECK(used.whyClusters.find("spread") != std::string::npos);
        for (const lw_cluster& c : clustersOf(kmeans))
            if (c.position.s[3] > 0.0f) CHECK(c.position.s[3] == float(someVpls() / 2));
    }
    // The light goes and comes again.
    const Vpls dark(64, reference::makeVpl({1, 2, 3}, {0, 1, 0}, {0, 0, 0}, 0.01f));
    CHECK(clusterFrames(rig, plan, kmeans, dark, 2).clusters == 0);
    CHECK(clusterFrames(rig, plan, kmeans, blobs, someFrames(6, 4)).clusters == 2);
}

TEST_CASE("clusters come to rest in a still scene, and half the error never takes fewer",
          "[ssvp_plan]") {
    KernelRig rig(16);
    for (unsigned seed = 1; seed <= unsigned(someFrames(4, 1)); ++seed) {
        const Vpls vpls = onTwoWalls(someVpls(), seed);
        std::uint32_t last = mostClusters();
        for (const float error : targets()) {
            KMeans kmeans(rig.device(), most(mostClusters()));
            SsvpPlan plan(rig.device(), optionsOf(error));
            const std::uint32_t count =
                clusterFrames(rig, plan, kmeans, vpls, someFrames(24, 6)).clusters;
            CAPTURE(seed, error, count, last);
            CHECK(count <= last);
            CHECK(count >= 1);
            for (int i = 0; i < someFrames(12, 2); ++i)
                CHECK(clusterFrames(rig, plan, kmeans, vpls, 1).clusters == count);
            last = count;
        }
        CHECK(last < mostClusters());
    }
}

TEST_CASE("in a slow sweep the number of clusters changes rarely; the same frames have the same bits",
          "[ssvp_plan]") {
    KernelRig rig(16);
    std::vector<std::uint32_t> before;
    for (int run = 0; run < 2; ++run) {
        KMeans kmeans(rig.device(), most(mostClusters()));
        SsvpPlan plan(rig.device(), optionsOf(0.3f));
        std::vector<std::uint32_t> counts;
        for (int i = 0; i < someFrames(120, 3); ++i)
            counts.push_back(clusterFrames(rig, plan, kmeans,
                                           onTwoWalls(someVpls(), 5, 0.4 * std::max(0, i - 20) / 100.0),
                                           1)
                                 .clusters);
        int changes = 0;
        for (std::size_t i = 20; i < counts.size(); ++i) changes += counts[i] != counts[i - 1];
        CHECK(changes <= 8);
        if (run) CHECK(counts == before);
        before = counts;
    }
}

TEST_CASE("a bounce is used while it and what follows bring more than the target", "[ssvp_plan]") {
    KernelRig rig(GENERATE(1u, 16u));
    KMeans kmeans(rig.device(), most(4));
    const Vpls vpls = onTwoWalls(64, 3);
    const Guarded list = rig.upload(vpls);
    // The kernel by itself: the VPLs of the next bounce are the test's, 25 of each cluster. Those of the
    // first carry 64 W, of which `arriving` meets a surface.
    Kernel& kernel = rig.kernel("ssvp_plan/ssvp_plan", "ssvp_plan_bounce");
    kmeans.record(rig.executor(), list, std::uint32_t(vpls.size()), true);
    const Guarded words = rig.upload(std::vector<cl_int>(LW_PLAN_WORDS, 1));
    const auto next = [&](double ratio, int left, int restart, double arriving = 1.0) {
        Vpls drawn(100, reference::makeVpl({0, 0, 0}, {0, 1, 0}, {1, 1, 1}, 0.01f));
        const double each = 64.0 * ratio / 100.0;
        for (std::size_t i = 0; i < drawn.size(); ++i)
            for (int c = 0; c < 3; ++c)
                drawn[i].flux.s[c] = double(i % 25) < 25.0 * arriving ? float(each) : 0.0f;
        const Guarded buffer = rig.upload(drawn);
        rig.run("ssvp_plan.bounce", kernel, {64, 1}, {64, 1}, kmeans.clusters(), cl_int(25), buffer,
                cl_int(drawn.size()), cl_int(0), cl_int(left), cl_float(0.1f), cl_int(restart), words);
        double flux = 0.0;
        for (const lw_vpl& v : rig.download<lw_vpl>(buffer)) flux += double(v.flux.s[0]);
        const auto plan = rig.download<cl_int>(words);
        CHECK(plan[LW_PLAN_BOUNCES] == (plan[LW_PLAN_USES] ? 2 : 1));
        CHECK(flux == Approx(plan[LW_PLAN_USES] ? 64.0 * ratio * arriving : 0.0).epsilon(1e-5));
        return plan[LW_PLAN_USES] != 0;
    };
    // Of one bounce in all, ratio / (1 + ratio) is the share: 0.09 at 0.0989, 0.11 at 0.1236, 0.07 at
    // 0.0753.
    CHECK(next(0.0, 1, 1));     // a first frame
    CHECK(next(0.0989, 1, 0));  // in use, it stays
    CHECK_FALSE(next(0.07, 1, 0));
    CHECK_FALSE(next(0.0989, 1, 0));  // out of use, it stays out
    CHECK(next(0.1236, 1, 0));
    CHECK_FALSE(next(0.0, 1, 0));  // black
    // Three to come bring ratio + ratio^2 + ratio^3: 0.1111 of 0.1, which is a tenth of all.
    CHECK_FALSE(next(0.0995, 3, 0));
    CHECK(next(0.1015, 3, 0));
    // Most goes to the sky: a fifth of the surfaces as bright as before count for as much as all of them
    // did.
    CHECK_FALSE(next(0.07, 1, 0, 0.2));
    CHECK(next(0.1236, 1, 0, 0.2));
}
