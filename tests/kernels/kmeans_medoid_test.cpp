// Where a cluster's medoid stays as VPLs move and clusters merge.
#include "support/kmeans_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::makeVpl;

namespace {

KMeansOptions optionsOf(std::uint32_t clusters) {
    KMeansOptions options;
    options.clusters = clusters;
    return options;
}

}  // namespace

TEST_CASE("a medoid stays until another member is twice as near to the mean", "[kmeans]") {
    KernelRig rig(GENERATE(1u, 16u));
    KMeans pass(rig.device(), optionsOf(1));
    // Two members about the mean and a far one that moves it: to where each of them is how far from it?
    auto at = [&](double x) { return makeVpl({x, 0, 0}, {0, 1, 0}, {1, 1, 1}, 0.1); };
    auto medoid = [&](double left, double right, bool restart) {
        // The far pair keeps the box, and with it the scale, where it is; the mean is (left + right) / 4.
        return cluster(rig, pass, {at(left), at(right), at(-8), at(8)}, restart).clusters[0].medoidPosition.s[3];
    };
    CHECK(medoid(-0.9, 1.1, true) == 0.0f);    // mean 0.05: 0.95 and 1.05 away
    CHECK(medoid(-1.1, 0.9, false) == 0.0f);   // 1.05 and 0.95: stays
    CHECK(medoid(-1.3, 0.7, false) == 0.0f);   // 1.15 and 0.85
    CHECK(medoid(-1.7, 0.3, false) == 1.0f);   // 1.35 and 0.65: more than twice
    CHECK(medoid(-1.1, 0.9, false) == 1.0f);
    CHECK(medoid(-0.7, 1.3, false) == 1.0f);   // 0.85 and 1.15: stays on its side, too
    CHECK(medoid(-0.7, 1.3, true) == 0.0f);    // a cut begins anew
}

TEST_CASE("of merged clusters the one that lives on keeps its medoid", "[kmeans]") {
    KernelRig rig(GENERATE(1u, 16u));
    KMeans pass(rig.device(), optionsOf(2));
    auto at = [&](double x) { return makeVpl({x, 0, 0}, {0, 1, 0}, {1, 1, 1}, 0.1); };
    const Vpls list{at(-4.0), at(-3.8), at(3.4), at(4.2), at(2.9)};
    std::vector<lw_cluster> seeds = cluster(rig, pass, list).clusters;
    // As ssvp_plan merges: the second goes, the first takes its members. Their mean, 0.54, is nearest to the last place.
    const float kept = seeds[0].medoidPosition.s[3];
    REQUIRE(kept != 4.0f);
    seeds[0].position = {{0.54f, 0, 0, 5}};
    seeds[1].position.s[3] = 0.0f;
    const Guarded starts = rig.upload(seeds), dead = rig.upload(std::vector<cl_uint>{2u, 0u}), vpls = rig.upload(list);
    const ClusterSeeds from{starts, dead};
    pass.record(rig.executor(), vpls, std::uint32_t(list.size()), false, &from);
    rig.device().finish();
    std::vector<lw_cluster> out(2);
    pass.clusters().download(0, out.size() * sizeof(lw_cluster), out.data());
    CHECK(out[0].position.s[3] == 5.0f);
    CHECK(out[0].medoidPosition.s[3] == kept);
    CHECK(out[1].medoidPosition.s[3] == -1.0f);
}
