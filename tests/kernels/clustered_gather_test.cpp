// The gather with clusters' visibility: the list that it walks, and its light against rays traced in double.
#include "passes/clustered_gather.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <deque>
#include <map>
#include <set>

#include "passes/interleaved_gather.h"
#include "passes/vpl_list.h"
#include "support/gather_rig.h"
#include "support/paraboloid_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Image;
using reference::Vec;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
// Float against double, as for the gather without clusters.
constexpr double kTwinTolerance = 2e-5;

struct Scene {
    std::vector<lw_vpl> firsts, seconds;
    std::vector<cl_int> assignment;
};

// VPLs in the room above a floor, each of its flux, so that one can tell them apart.
Scene randomScene(std::uint32_t firstCount, std::uint32_t secondCount, int clusterCount) {
    Scene scene;
    scene.firsts = reference::randomVpls(firstCount, 7);
    scene.seconds = reference::randomVpls(secondCount, 8);
    for (std::uint32_t k = 0; k < firstCount; ++k) {
        scene.firsts[k].flux.s[0] = float(k + 1);
        scene.assignment.push_back(k % 13 == 5 ? -1 : cl_int(k * 7 % std::uint32_t(clusterCount)));
    }
    for (std::uint32_t k = 0; k < secondCount; ++k) scene.seconds[k].flux.s[0] = float(10000 + k);
    return scene;
}

std::vector<lw_vpl> listOf(const ClusteredGather& pass) {
    std::vector<lw_vpl> list(std::size_t(pass.order().subsets * pass.order().capacity));
    pass.vpls().download(0, list.size() * sizeof(lw_vpl), list.data());
    return list;
}

void recordOrder(KernelRig& rig, ClusteredGather& pass, const Scene& scene, std::uint32_t clusterCount) {
    const Guarded firsts = rig.upload(scene.firsts), assignment = rig.upload(scene.assignment);
    const Guarded seconds = rig.upload(scene.seconds.empty() ? scene.firsts : scene.seconds);
    std::vector<GatheredList> lists{{{firsts, std::uint32_t(scene.firsts.size())}, &assignment, clusterCount}};
    if (!scene.seconds.empty()) lists.push_back({{seconds, std::uint32_t(scene.seconds.size())}});
    pass.recordOrder(rig.executor(), lists);
    rig.device().finish();
}

Image gatherOn(KernelRig& rig, ClusteredGather& pass, std::uint32_t n, const Image& position,
               const Image& normal, const ClusterMaps& maps, Bits bits) {
    const std::uint32_t w = position.width, h = position.height;
    const Guarded p = rig.uploadPlanes(position.planes, w, h, 3, kNaN),
                  nr = rig.uploadPlanes(normal.planes, w, h, 3, 1.0f);
    const Guarded out = rig.makePlanes(w, h, 3), counts = rig.upload(std::vector<cl_int>{0, 0, 0});
    const Planes surfaces[2] = {rig.planes(p, w, h, 3), rig.planes(nr, w, h, 3)};
    const lw_vpl_tiles layout = VplTiles::layout(w, h, pass.order(), n);
    const Guarded all = rig.upload(allSlots(layout, pass.order()));
    InterleavedGather passes(rig.device(), n);
    VplTiles tiles;
    if (bits == Bits::found) {
        tiles.reserve(rig.device(), w, h, pass.order(), n);
        passes.recordCull(rig.executor(), surfaces[0], surfaces[1], pass.vpls(), pass.order(), tiles);
    }
    pass.recordGather(rig.executor(), surfaces[0], surfaces[1],
                      bits == Bits::found ? tiles.masks() : all, layout, maps, rig.planes(out, w, h, 3),
                      counts);
    rig.device().finish();
    Image result(w, h);
    result.planes = rig.downloadPlanes(rig.planes(out, w, h, 3));
    return result;
}

// Of one list with clusters.
ClusterMaps mapsOf(ParaboloidRig& rig) {
    const ParaboloidMap& maps = rig.pass;
    return {{{&maps.frames(), &maps.records(), maps.mapCount()}}, maps.size()};
}

// A floor under a wall that stands on it, lit by two clusters on either side.
struct Walled {
    Mesh mesh;
    std::vector<lw_cluster> clusters{clusterAt({-0.9, -0.4, 0.7}, {1, 0.2, 0.1}),
                                     clusterAt({0.9, 0.3, 0.5}, {-1, 0.1, 0.2})};
    Scene scene;
    Image position, normal;

    Walled(std::uint32_t w, std::uint32_t h) : position(w, h), normal(w, h) {
        mesh.addQuad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 3, 3);
        mesh.addQuad({0.05, -0.5, 0}, {0, 1, 0}, {0, 0, 0.45}, 2, 1);
        for (int k = 0; k < 40; ++k) {
            const lw_cluster& c = clusters[std::size_t(k % 2)];
            const Vec place = reference::vecOf(c.medoidPosition);
            scene.firsts.push_back(
                reference::makeVpl(place, reference::vecOf(c.normal), {1.0 + k, 2.0, 3.0}, 0.01));
            scene.assignment.push_back(k % 2);
        }
        for (std::uint32_t y = 0; y < h; ++y)
            for (std::uint32_t x = 0; x < w; ++x) {
                position.set(x, y, {-1.0 + 2.0 * (x + 0.5) / w, -1.0 + 2.0 * (y + 0.5) / h, 0.0});
                normal.set(x, y, {0, 0, 1});
            }
    }
    // Light of all VPLs that a ray from their cluster's origin reaches.
    Vec lightAt(std::uint32_t x, std::uint32_t y, const std::vector<lw_paraboloid>& frames,
                const std::vector<reference::Triangle>& triangles) const {
        const reference::Surface s = reference::surfaceAt(position, normal, x, y);
        bool seen[2];
        for (std::size_t c = 0; c < 2; ++c) {
            const Vec way = s.position - reference::vecOf(frames[c].origin);
            const double distance = reference::length(way);
            seen[c] =
                reference::nearest(triangles, reference::vecOf(frames[c].origin), way * (1.0 / distance))
                    .distance > distance * (1.0 - 1e-6);
        }
        Vec sum;
        for (std::size_t k = 0; k < scene.firsts.size(); ++k)
            if (seen[std::size_t(scene.assignment[k])])
                sum = sum + reference::vplIrradiance(scene.firsts[k], s);
        return sum;
    }
};

}  // namespace

TEST_CASE("the list holds every VPL once, cluster by cluster, then the further ones", "[clustered_gather]") {
    const auto n = GENERATE(1u, 4u);
    const auto clusters = GENERATE(1u, 8u, 64u, 200u);
    const auto groups = GENERATE(1u, 2u, 16u);
    if (groups > n * n) return;
    KernelRig rig(16);
    const Scene scene = randomScene(257, 70, int(clusters));
    ClusteredGather pass(rig.device(), n, groups, ClusterVisibility::hard);
    recordOrder(rig, pass, scene, clusters);
    const std::vector<lw_vpl> list = listOf(pass);
    std::map<float, int> seen;
    for (std::uint32_t s = 0; s < n * n; ++s) {
        float last = -1.0f;
        bool further = false;
        for (int i = 0; i < pass.order().capacity; ++i) {
            const lw_vpl& v = list[std::size_t(int(s) * pass.order().capacity + i)];
            if (v.flux.s[0] == 0.0f) continue;
            ++seen[v.flux.s[0]];
            if (v.flux.s[0] >= 10000.0f) {
                further = true;
                CHECK(v.flux.s[3] == -1.0f);
                continue;
            }
            CHECK(!further);
            CHECK(v.flux.s[3] == float(scene.assignment[std::size_t(v.flux.s[0]) - 1]));
            if (clusters <= 64) CHECK(v.flux.s[3] >= last);  // with more they keep their order
            last = v.flux.s[3];
        }
    }
    const auto lit = std::size_t(
        std::count_if(scene.assignment.begin(), scene.assignment.end(), [](int c) { return c >= 0; }));
    CHECK(seen.size() == lit + scene.seconds.size());
    for (const auto& [flux, times] : seen) CHECK(times == 1);
}

// 8 clusters of 16 VPLs each, in groups of whole clusters.
TEST_CASE("a subset's VPLs come from one group of the clusters, its neighbours' from the others", "[clustered_gather]") {
    const auto groups = GENERATE(1u, 2u, 4u, 8u);
    constexpr std::uint32_t n = 4, clusters = 8;
    KernelRig rig(16);
    Scene scene = randomScene(128, 0, int(clusters));
    for (std::uint32_t k = 0; k < 128; ++k) scene.assignment[k] = cl_int(k * 5 % clusters);
    ClusteredGather pass(rig.device(), n, groups, ClusterVisibility::hard);
    recordOrder(rig, pass, scene, clusters);
    const std::vector<lw_vpl> list = listOf(pass);
    std::vector<std::set<int>> of(n * n);
    for (std::uint32_t s = 0; s < n * n; ++s)
        for (int i = 0; i < pass.order().capacity; ++i) {
            const lw_vpl& v = list[std::size_t(int(s) * pass.order().capacity + i)];
            if (v.flux.s[0] > 0.0f) of[s].insert(int(v.flux.s[3]));
        }
    for (const std::set<int>& seen : of) CHECK(seen.size() == clusters / groups);
    // Side by side, and of every 2 x 2: also across the window's border, where the pattern begins anew.
    for (std::uint32_t s = 0; s < n * n; ++s) {
        const std::uint32_t x = s % n, y = s / n, right = y * n + (x + 1) % n, below = (y + 1) % n * n + x,
                            across = (y + 1) % n * n + (x + 1) % n;
        std::set<int> pair = of[s], square = of[s];
        pair.insert(of[right].begin(), of[right].end());
        for (const std::uint32_t other : {right, below, across}) square.insert(of[other].begin(), of[other].end());
        CHECK(pair.size() >= std::min(2u * clusters / groups, clusters));
        CHECK(square.size() >= std::min(4u * clusters / groups, clusters));
    }
}

TEST_CASE("without visibility it is the gather of the same list", "[clustered_gather]") {
    const auto width = GENERATE(1u, 16u);
    const auto n = GENERATE(1u, 4u);
    KernelRig rig(width);
    const auto size = testSize({67, 23});
    Image position(size.first, size.second), normal(size.first, size.second);
    reference::fillCorner(position, normal);
    Scene scene = randomScene(128, 32, 8);
    ClusteredGather pass(rig.device(), n, n == 1 ? 1 : 4, ClusterVisibility::none);
    recordOrder(rig, pass, scene, 8);
    const Guarded none = rig.upload(std::vector<float>(64, 0.0f));
    const auto bits = GENERATE(Bits::found, Bits::all);
    const Image light = gatherOn(rig, pass, n, position, normal, {{{&none, &none, 8}}, 64}, bits);
    const Image twin = reference::gather(position, normal, listOf(pass), pass.order(), n);
    CHECK(disagreement(light.planes, twin.planes, kTwinTolerance) == "");
}

TEST_CASE("a wall's shadow as rays from the clusters cast it", "[clustered_gather]") {
    const auto width = GENERATE(1u, 16u);
    ParaboloidRig rig(width, 256, true);
    const auto size = testSize({96, 64});
    const Walled room(size.first, size.second);
    const DrawnMaps maps = rig.drawn(room.mesh, room.clusters);
    const std::vector<reference::Triangle> triangles = room.mesh.triangles();
    double excessOfHard = 0.0;
    for (const ClusterVisibility visibility : {ClusterVisibility::hard, ClusterVisibility::soft, ClusterVisibility::strict}) {
        ClusteredGather pass(rig.device(), 1, 1, visibility);
        recordOrder(rig, pass, room.scene, 2);
        const Image light = gatherOn(rig, pass, 1, room.position, room.normal, mapsOf(rig), Bits::found);
        int off = 0;
        double sum = 0.0, expected = 0.0, excess = 0.0;
        for (std::uint32_t y = 0; y < light.height; ++y)
            for (std::uint32_t x = 0; x < light.width; ++x) {
                const double exact = room.lightAt(x, y, maps.frames, triangles).x,
                             got = light.get(x, y).x;
                sum += got;
                expected += exact;
                if (std::abs(got - exact) > 1e-4 * (got + exact)) ++off;
                excess += std::max(got - exact, 0.0);
            }
        // Only where the shadow's edge runs through a texel: some 60 texels along the edge of two
        // shadows, of a map in which the floor covers half of 256 x 256; soft ones blur it over two, and strict ones end up to half a texel
        // farther out.
        const bool isHard = visibility == ClusterVisibility::hard, isStrict = visibility == ClusterVisibility::strict;
        CAPTURE(int(visibility), off, excess / expected, sum / expected);
        CHECK(off <= int(0.03 * (isHard ? 1.0 : 2.0) * light.width * light.height));
        CHECK(std::abs(sum / expected - 1.0) < 0.01 * (isStrict ? 2.0 : 1.0));
        if (isHard) excessOfHard = excess;
        if (isStrict) CHECK(excess <= 0.75 * excessOfHard + 1e-6 * expected);  // small pictures have rounding alone
    }
}

TEST_CASE("widths agree, and ten runs are one", "[clustered_gather][large]") {
    const Walled room(61, 13);
    std::vector<float> first;
    for (const std::uint32_t width : {1u, 4u, 8u, 16u}) {
        ParaboloidRig rig(width, 64);
        rig.draw(room.mesh, room.clusters);
        for (int run = 0; run < (width == 16 ? 10 : 1); ++run) {
            ClusteredGather pass(rig.device(), 4, 4, ClusterVisibility::hard);
            recordOrder(rig, pass, room.scene, 2);
            const Image light = gatherOn(rig, pass, 4, room.position, room.normal, mapsOf(rig), Bits::found);
            if (first.empty()) first = light.planes;
            CHECK(bitDifference(light.planes, first) == "");
        }
    }
}

TEST_CASE("bounces with clusters are one list with the clusters of all", "[clustered_gather][large]") {
    const auto width = GENERATE(1u, 16u);
    ParaboloidRig rig(width, 64, true);
    const auto size = testSize({96, 64});
    const Walled room(size.first, size.second);
    rig.draw(room.mesh, room.clusters);
    const Guarded list = rig.upload(room.scene.firsts), assignment = rig.upload(room.scene.assignment);
    ClusteredGather pass(rig.device(), 1, 1, GENERATE(ClusterVisibility::hard, ClusterVisibility::soft, ClusterVisibility::strict));
    pass.recordOrder(rig.executor(), {{{list, 40}, &assignment, 2}});
    const Image expected = gatherOn(rig, pass, 1, room.position, room.normal, mapsOf(rig), Bits::found);

    // The same VPLs, each cluster's as a bounce of its own, with a map of its own.
    // Each cluster's VPLs as one list, or as two.
    const std::size_t parts = GENERATE(1u, 2u);
    std::vector<lw_vpl> bounce[2];
    for (std::size_t k = 0; k < 40; ++k) bounce[room.scene.assignment[k]].push_back(room.scene.firsts[k]);
    const std::uint32_t each = std::uint32_t(20 / parts);
    const Guarded own = rig.upload(std::vector<cl_int>(20, 0));
    std::deque<Guarded> vpls;
    std::deque<ParaboloidMap> maps;
    std::vector<GatheredList> lists;
    std::vector<ClusterMaps::List> read;
    for (std::size_t i = 0; i < 2 * parts; ++i) {
        const std::size_t cluster = i / parts;
        const auto first = bounce[cluster].begin() + std::ptrdiff_t(i % parts * each);
        vpls.push_back(rig.upload(std::vector<lw_vpl>(first, first + each)));
        maps.emplace_back(rig.device(), 64).record(rig.executor(), rig.upload(std::vector<lw_cluster>{room.clusters[cluster]}), 1, rig.input);
        maps.back().recordMarks(rig.executor());
        lists.push_back({{vpls.back(), each}, &own, 1});
        read.push_back({&maps.back().frames(), &maps.back().records(), 1});
    }
    pass.recordOrder(rig.executor(), lists);
    const Image light = gatherOn(rig, pass, 1, room.position, room.normal, {read, 64}, Bits::found);
    CHECK(bitDifference(light.planes, expected.planes) == "");
}
