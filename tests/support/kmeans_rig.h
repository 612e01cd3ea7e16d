// Runs pass `kmeans` on lists of VPLs, and what its tests ask of a result.
#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "passes/kmeans.h"
#include "reference/kmeans_twin.h"
#include "support/kernel_rig.h"

namespace lightwell::test {

using Vpls = std::vector<lw_vpl>;

struct Clustered {
    std::vector<lw_cluster> clusters;
    std::vector<cl_int> assignment;
};

inline Clustered cluster(KernelRig& rig, KMeans& pass, const Vpls& vpls, bool restart = false) {
    const Guarded list = rig.upload(vpls.empty() ? Vpls(1, reference::makeVpl({1, 1, 1}, {0, 1, 0}, {1, 1, 1}, 1)) : vpls);
    pass.record(rig.executor(), list, std::uint32_t(vpls.size()), restart);
    rig.device().finish();
    Clustered out{std::vector<lw_cluster>(pass.clusterCount()), std::vector<cl_int>(vpls.size())};
    if (!out.clusters.empty()) pass.clusters().download(0, out.clusters.size() * sizeof(lw_cluster), out.clusters.data());
    if (!vpls.empty()) pass.assignment().download(0, vpls.size() * sizeof(cl_int), out.assignment.data());
    return out;
}

inline Clustered clusterOnce(KernelRig& rig, const KMeansOptions& options, const Vpls& vpls) {
    KMeans pass(rig.device(), options);
    return cluster(rig, pass, vpls);
}

// Every number of the clusters, for comparisons of bits.
inline std::vector<float> numbers(const Clustered& clustered) {
    std::vector<float> out;
    for (const lw_cluster& c : clustered.clusters)
        for (const lw_float4& v : {c.position, c.normal, c.flux, c.medoidPosition, c.medoidNormal})
            out.insert(out.end(), v.s, v.s + 4);
    return out;
}

inline int liveCount(const Clustered& clustered) {
    int live = 0;
    for (const lw_cluster& c : clustered.clusters) live += c.position.s[3] > 0.0f;
    return live;
}

// What k-means minimises, in double, of a result as it stands.
inline double objective(const Clustered& clustered, const Vpls& vpls, const KMeansOptions& options) {
    reference::KMeansTwin twin;
    twin.positionWeight = double(options.positionWeight);
    twin.normalWeight = double(options.normalWeight);
    twin.diagonal = twin.diagonalOf(vpls);
    double sum = 0.0;
    for (std::size_t i = 0; i < vpls.size(); ++i) {
        if (clustered.assignment[i] < 0) continue;
        const lw_cluster& c = clustered.clusters[std::size_t(clustered.assignment[i])];
        sum += twin.distance(vpls[i], {{c.position.s[0], c.position.s[1], c.position.s[2]},
                                       {c.normal.s[0], c.normal.s[1], c.normal.s[2]}, 1});
    }
    return sum;
}

// What holds of every result: members and flux add up, medoids are members, all is finite, the empty are empty.
inline void checkSound(const Clustered& clustered, const Vpls& vpls) {
    std::vector<double> members(clustered.clusters.size()), flux(clustered.clusters.size()), area(clustered.clusters.size());
    for (std::size_t i = 0; i < vpls.size(); ++i) {
        const int k = clustered.assignment[i];
        REQUIRE((k >= 0) == reference::KMeansTwin::lit(vpls[i]));
        REQUIRE(k < int(clustered.clusters.size()));
        if (k < 0) continue;
        members[std::size_t(k)] += 1;
        flux[std::size_t(k)] += double(vpls[i].flux.s[1]);
        area[std::size_t(k)] += double(vpls[i].positionArea.s[3]);
    }
    for (const float x : numbers(clustered)) REQUIRE(std::isfinite(x));
    for (std::size_t k = 0; k < members.size(); ++k) {
        const lw_cluster& c = clustered.clusters[k];
        CAPTURE(k);
        REQUIRE(double(c.position.s[3]) == members[k]);
        // 128 terms of a chunk, then the chunks: at most some 600 roundings of 6e-8, mostly of either sign.
        REQUIRE(std::abs(double(c.flux.s[1]) - flux[k]) <= 1e-5 * flux[k]);
        REQUIRE(std::abs(double(c.flux.s[3]) - area[k]) <= 1e-5 * area[k]);
        REQUIRE(std::abs(std::hypot(double(c.normal.s[0]), double(c.normal.s[1]), double(c.normal.s[2])) - 1.0) < 1e-5);
        if (members[k] == 0) {
            REQUIRE((c.flux.s[0] == 0.0f && c.flux.s[2] == 0.0f && c.medoidPosition.s[3] == -1.0f));
            continue;
        }
        const std::size_t medoid = std::size_t(c.medoidPosition.s[3]);
        REQUIRE(medoid < vpls.size());
        REQUIRE(clustered.assignment[medoid] == int(k));
        for (int axis = 0; axis < 3; ++axis) {
            REQUIRE(c.medoidPosition.s[axis] == vpls[medoid].positionArea.s[axis]);
            REQUIRE(c.medoidNormal.s[axis] == vpls[medoid].normal.s[axis]);
        }
    }
}

// VPLs on the walls of a box seen from inside, some without flux: lists as scenes give them.
inline Vpls roomVpls(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    Vpls vpls;
    for (std::size_t i = 0; i < count; ++i) {
        const int wall = int(random() % 6), axis = wall % 3;
        double p[3] = {unit(random) * 6.0, unit(random) * 3.0, unit(random) * 4.0}, n[3] = {0, 0, 0};
        const double sizes[3] = {6.0, 3.0, 4.0};
        p[axis] = wall < 3 ? 0.0 : sizes[axis];
        n[axis] = wall < 3 ? 1.0 : -1.0;
        const double flux = random() % 8 ? unit(random) : 0.0;
        vpls.push_back(reference::makeVpl({p[0], p[1], p[2]}, {n[0], n[1], n[2]}, {flux, 0.5 * flux, 0.1 * flux}, 0.01));
    }
    return vpls;
}

}  // namespace lightwell::test
