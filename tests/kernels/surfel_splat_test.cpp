// Splatted surfels: every texel's ray meets the disc that it should, whatever their order; covered walls are where they are.
#include "passes/surfel_splat.h"

#include <catch2/catch.hpp>
#include <random>

#include "support/surfel_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

constexpr double kDistanceRounding = 1e-5;
constexpr double kDirectionRounding = 3e-7;  // times the tangent of the ray's angle to the plane
constexpr double kNormalRounding = 2e-3;
// Texels whose ray passes a disc's rim so closely that float and double may take different discs.
constexpr double kNearTies = 2e-3;
// As the pass states them.
constexpr double kOverlap = 1.35, kLeastTexels = 0.71, kNearest = 2.0;

const std::vector<lw_cluster> kThree = {clusterAt({0, 0, 0}, {0, 0, 1}), clusterAt({0.3, -0.2, 0.1}, {0, 0, -1}),
                                        clusterAt({-1, 0.5, 0.2}, {1, 2, -3})};

std::vector<Disc> soup(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const auto any = [&] { return Vec{unit(random), unit(random), unit(random)}; };
    std::vector<Disc> discs;
    for (std::size_t i = 0; i < count; ++i) {
        const double radius = i % 16 == 0 ? 0.8 : i % 3 ? 0.05 : 0.2;
        discs.push_back({any() * 3.0, reference::unit(any()), 3.14159265358979323846 * radius * radius,
                         std::uint32_t(i * 2654435761u) & 0x3fffffffu});
    }
    return discs;
}

// The nearest disc that a ray meets, and at what distance.
struct Met {
    double distance = std::numeric_limits<double>::infinity();
    std::size_t disc = 0;
    double cosine = 1.0;
};

Met meetDiscs(const std::vector<Disc>& discs, const reference::ParaboloidFrame& frame, Vec d, std::uint32_t size) {
    Met met;
    for (std::size_t i = 0; i < discs.size(); ++i) {
        const Vec to = discs[i].centre - frame.origin;
        const double away = reference::length(to), own = std::sqrt(discs[i].area / 3.14159265358979323846);
        if (away <= kNearest * own) continue;
        // Of a texel in that direction: d(angle) = 2 dr / (1 + r^2).
        const double r2 = std::pow(std::tan(0.5 * std::acos(std::min(1.0, dot(to, frame.z) / away))), 2.0);
        const double texel = 2.0 * (2.0 * reference::kRim / size) / (1.0 + r2);
        const double radius = std::max(own * kOverlap, kLeastTexels * texel * away);
        const double cosine = dot(discs[i].normal, d);
        if (cosine == 0.0) continue;
        const double t = dot(discs[i].normal, to) / cosine;
        if (t <= 0.0 || t >= met.distance || reference::length(d * t - to) > radius) continue;
        met = {t, i, cosine};
    }
    return met;
}

// Where a ray from inside leaves the box from 0 to `size`.
double leaveBox(Vec size, Vec o, Vec d) {
    double least = 1e30;
    for (const auto& [s, at, v] : {std::array{size.x, o.x, d.x}, std::array{size.y, o.y, d.y}, std::array{size.z, o.z, d.z}})
        if (v != 0.0) least = std::min(least, v > 0.0 ? (s - at) / v : -at / v);
    return least;
}

}  // namespace

TEST_CASE("random discs as the serial twin sees them", "[surfel_splat]") {
    const auto width = GENERATE(1u, 16u);
    const std::vector<Disc> discs = soup(500, 3);
    SurfelRig rig(width, 64);
    const DrawnMaps maps = rig.splatted(discs, kThree, false);
    int texels = 0, ties = 0, wrong = 0, turned = 0, hits = 0;
    for (std::size_t k = 0; k < kThree.size(); ++k) {
        const reference::ParaboloidFrame frame(maps.frames[k]);
        for (std::uint32_t y = 0; y < 64; ++y)
            for (std::uint32_t x = 0; x < 64; ++x) {
                const std::size_t at = maps.at(k, x, y);
                if (!reference::isBeforeRim(x, y, 64)) {
                    CHECK(!maps.hit(at));
                    continue;
                }
                ++texels;
                const Vec d = frame.world(reference::localDirection(x, y, 64));
                const Met expected = meetDiscs(discs, frame, d, 64);
                const bool hit = std::isfinite(expected.distance);
                if (maps.hit(at) != hit || (hit && maps.albedo[at] != discs[expected.disc].albedo)) {
                    ++ties;
                } else if (hit) {
                    ++hits;
                    if (std::abs(double(maps.distance(at)) / expected.distance - 1.0) >
                        kDistanceRounding + kDirectionRounding / std::abs(expected.cosine))
                        ++wrong;
                    const Vec towards = discs[expected.disc].normal * (expected.cosine > 0.0 ? -1.0 : 1.0);
                    if (reference::length(frame.world(maps.normal(at)) - towards) > kNormalRounding) ++turned;
                } else {
                    CHECK((std::isinf(maps.distance(at)) && maps.albedo[at] == 0));
                }
            }
    }
    CAPTURE(texels, hits, ties);
    CHECK(hits > texels / 4);
    CHECK(ties <= kNearTies * texels);
    CHECK(wrong == 0);
    CHECK(turned == 0);
}

TEST_CASE("a box covered with surfels: the walls' distance in every texel", "[surfel_splat]") {
    const auto width = GENERATE(1u, 16u);
    const Vec size{1.75, 1.125, 2.25}, x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z}, zero{};
    std::vector<Disc> discs;
    for (const auto& [u, v, w] : {std::array{x, y, z}, std::array{y, z, x}, std::array{z, x, y}}) {
        addDiscs(discs, zero, u, v, 0.03);
        addDiscs(discs, w, u, v, 0.03);
    }
    const std::vector<lw_cluster> clusters = {clusterAt({0.8, 0.5, 1.1}, {0, 0, 1}), clusterAt({0.8, 0, 1.1}, {0, 1, 0}),
                                              clusterAt({0.4, 1.125, 1.9}, {0, -1, 0})};
    SurfelRig rig(width, 64);
    const DrawnMaps maps = rig.splatted(discs, clusters, false);
    int texels = 0, missed = 0, wrong = 0;
    for (std::size_t k = 0; k < clusters.size(); ++k) {
        const reference::ParaboloidFrame frame(maps.frames[k]);
        for (std::uint32_t j = 0; j < 64; ++j)
            for (std::uint32_t i = 0; i < 64; ++i) {
                const Vec local = reference::localDirection(i, j, 64);
                // Below the horizon of a cluster on a wall lies the wall, whose nearest surfels are left out.
                if (!reference::isBeforeRim(i, j, 64) || local.z < 0.0) continue;
                ++texels;
                const std::size_t at = maps.at(k, i, j);
                if (!maps.hit(at)) {
                    ++missed;
                    continue;
                }
                const Vec d = frame.world(local);
                const double distance = leaveBox(size, frame.origin, d);
                const double least = std::min({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
                if (std::abs(double(maps.distance(at)) / distance - 1.0) >
                    kDistanceRounding + kDirectionRounding / std::max(least, 1e-3))
                    ++wrong;
            }
    }
    CAPTURE(texels);
    CHECK(texels > 3 * 1800);
    CHECK(missed == 0);
    CHECK(wrong == 0);
}

TEST_CASE("a sphere covered with surfels: its radius in every texel", "[surfel_splat]") {
    constexpr double kRadius = 2.0;
    constexpr int kCount = 20000;
    std::vector<Disc> discs;  // on a Fibonacci spiral
    for (int i = 0; i < kCount; ++i) {
        const double z = 1.0 - 2.0 * (i + 0.5) / kCount, turn = 2.399963229728653 * i, r = std::sqrt(1.0 - z * z);
        const Vec d{r * std::cos(turn), r * std::sin(turn), z};
        discs.push_back({d * kRadius, d, 4.0 * 3.14159265358979323846 * kRadius * kRadius / kCount, 1});
    }
    SurfelRig rig(16, 64);
    const DrawnMaps maps = rig.splatted(discs, {clusterAt({0, 0, 0}, {0.3, -0.5, 0.8})}, false);
    // A tangent disc leaves the sphere by the square of its radius, seen from the middle, over two.
    const double texel = 2.0 * (2.0 * reference::kRim / 64), radius = std::max(kOverlap * 2.0 / std::sqrt(double(kCount)), kLeastTexels * texel);
    int wrong = 0, missed = 0;
    for (std::uint32_t y = 0; y < 64; ++y)
        for (std::uint32_t x = 0; x < 64; ++x) {
            if (!reference::isBeforeRim(x, y, 64)) continue;
            const std::size_t at = maps.at(0, x, y);
            missed += maps.hit(at) ? 0 : 1;
            const double off = double(maps.distance(at)) / kRadius - 1.0;
            // The origin stands a ten-thousandth of the diagonal from the middle.
            if (maps.hit(at) && (off < -1e-3 || off > 0.5 * radius * radius + 1e-3)) ++wrong;
        }
    CHECK(missed == 0);
    CHECK(wrong == 0);
}

TEST_CASE("the same bits whatever the order of surfels, the width and the run", "[surfel_splat]") {
    std::vector<Disc> discs = soup(700, 9);
    discs.insert(discs.end(), discs.begin(), discs.begin() + 50);  // twice at one place, in two colours
    for (std::size_t i = 700; i < 750; ++i) discs[i].albedo ^= 0x2aaaaaaau;
    SurfelRig rig(16, 64), narrow(1, 64);
    const DrawnMaps maps = rig.splatted(discs, kThree, true);
    const DrawnMaps again = rig.splatted(discs, kThree, true), at1 = narrow.splatted(discs, kThree, true);
    CHECK(again.records == maps.records);
    CHECK(again.albedo == maps.albedo);
    CHECK(at1.records == maps.records);
    CHECK(at1.albedo == maps.albedo);
    std::shuffle(discs.begin(), discs.end(), std::mt19937(5));
    const DrawnMaps shuffled = rig.splatted(discs, kThree, true);
    CHECK(shuffled.records == maps.records);
    CHECK(shuffled.albedo == maps.albedo);
}

TEST_CASE("more surfels than a map takes: a share of them, chosen by place, that stands for all", "[surfel_splat][large]") {
    std::vector<Disc> discs;
    const std::uint32_t most = SurfelSplat::mostSurfels(64);
    addDiscs(discs, {-2, -2, 1}, {4, 0, 0}, {0, 4, 0}, 4.0 / std::sqrt(3.0 * most));
    REQUIRE(discs.size() > 2 * most);
    const std::vector<lw_cluster> clusters = {clusterAt({0, 0, 0}, {0, 0, 1})};
    SurfelRig rig(16, 64);
    const DrawnMaps maps = rig.splatted(discs, clusters, false);
    std::shuffle(discs.begin(), discs.end(), std::mt19937(1));
    CHECK(rig.splatted(discs, clusters, false).records == maps.records);
    int inside = 0, missed = 0, wrong = 0;
    const reference::ParaboloidFrame frame(maps.frames[0]);
    for (std::uint32_t y = 0; y < 64; ++y)
        for (std::uint32_t x = 0; x < 64; ++x) {
            const Vec d = frame.world(reference::localDirection(x, y, 64));
            const double t = (1.0 - frame.origin.z) / d.z;
            if (d.z <= 0.0 || std::max(std::abs(d.x * t), std::abs(d.y * t)) > 1.9) continue;
            ++inside;
            const std::size_t at = maps.at(0, x, y);
            missed += maps.hit(at) ? 0 : 1;
            if (maps.hit(at) && std::abs(double(maps.distance(at)) / t - 1.0) > 1e-4) ++wrong;
        }
    CAPTURE(inside, missed);
    CHECK(inside > 700);
    // Independently chosen discs that cover a place 1.35^2 times on average leave exp(-1.82) = 0.16 of a continuum; texels
    // are wider than these discs, whose least size covers them several times.
    CHECK(missed <= inside / 100);
    CHECK(wrong == 0);
}

TEST_CASE("splats in another unit of length", "[surfel_splat]") {
    const std::vector<Disc> discs = soup(400, 21);
    SurfelRig rig(16, 64);
    const DrawnMaps maps = rig.splatted(discs, kThree, true);
    std::vector<lw_cluster> clusters = kThree;
    for (lw_cluster& c : clusters)
        for (int i = 0; i < 3; ++i) c.medoidPosition.s[i] *= 1024.0f;
    const DrawnMaps scaled = rig.splatted(discs, clusters, true, 1024.0);
    int differing = 0;
    for (std::size_t t = 0; t < maps.albedo.size(); ++t)
        if (scaled.distance(t) != 1024.0f * maps.distance(t) || scaled.records[2 * t + 1] != maps.records[2 * t + 1]) ++differing;
    CHECK(differing == 0);
    CHECK(scaled.albedo == maps.albedo);
}

TEST_CASE("no surfels, no clusters; a map at rest is left alone", "[surfel_splat]") {
    SurfelRig rig(GENERATE(1u, 16u), 64);
    const DrawnMaps empty = rig.splatted({}, kThree, true);
    for (std::size_t t = 0; t < empty.albedo.size(); ++t)
        REQUIRE((!empty.hit(t) && std::isinf(empty.distance(t)) && empty.albedo[t] == 0));
    const SurfelSet set = rig.upload(soup(100, 1));
    const auto draw = [&](const std::vector<lw_cluster>& clusters) {
        rig.pass.recordPlaces(rig.executor(), rig.KernelRig::upload(clusters), std::uint32_t(clusters.size()), *set.diagonal, set.revision);
        rig.splat.record(rig.executor(), set, rig.pass.texels());
        rig.holes.record(rig.executor(), rig.pass.texels());
        rig.pass.noteDrawn(set.revision);
        rig.device().finish();
        return rig.maps();
    };
    const DrawnMaps drawn = draw(kThree);
    rig.executor().fill("test.fill", rig.pass.records(), 0x12345678u, 0, drawn.records.size() * 4);
    CHECK(draw(kThree).records[0] == 0x12345678u);
    std::vector<lw_cluster> moved = kThree;
    moved[1].medoidPosition.s[0] += 1e-3f;
    const DrawnMaps after = draw(moved);
    CHECK(after.records[0] == 0x12345678u);
    CHECK(after.records[2 * after.at(1, 0, 0)] != 0x12345678u);
    CHECK(after.records[2 * after.at(2, 0, 0)] == 0x12345678u);
}
