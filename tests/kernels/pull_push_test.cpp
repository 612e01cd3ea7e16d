// Holes in maps: known texels stay, planes are continued, what is wide or open stays unknown.
#include "passes/pull_push.h"

#include <catch2/catch.hpp>
#include <functional>
#include <random>

#include "compute/error.h"
#include "support/surfel_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

constexpr std::uint32_t kSize = 64;
constexpr double kNormalRounding = 2e-3;
constexpr std::uint32_t kGrey = 512u | 300u << 10 | 100u << 20;

// A texel that was seen: distance along its ray, normal in the map's frame.
struct Seen {
    double distance;
    Vec normal;
};
using Scene = std::function<Seen(Vec direction)>;

std::uint32_t packed(Vec n) {
    const auto part = [](double c) { return std::uint32_t(std::lround(c * 511.0) + 512); };
    return part(n.x) | part(n.y) << 10 | part(n.z) << 20 | LW_PARABOLOID_HIT;
}

// One map that shows `scene` where `keeps` says so.
struct HolesRig : SurfelRig {
    explicit HolesRig(std::uint32_t width) : SurfelRig(width, kSize) {}

    DrawnMaps before;
    DrawnMaps filled(const Scene& scene, const std::function<bool(std::uint32_t, std::uint32_t)>& keeps) {
        before = splatted({}, {clusterAt({0, 0, 0}, {0, 0, 1})}, false);
        for (std::uint32_t y = 0; y < kSize; ++y)
            for (std::uint32_t x = 0; x < kSize; ++x) {
                if (!reference::isBeforeRim(x, y, kSize) || !keeps(x, y)) continue;
                const Seen seen = scene(reference::localDirection(x, y, kSize));
                if (!(seen.distance > 0.0)) continue;
                const std::size_t at = before.at(0, x, y);
                const float distance = float(seen.distance);
                std::memcpy(&before.records[2 * at], &distance, 4);
                before.records[2 * at + 1] = packed(seen.normal);
                before.albedo[at] = kGrey;
            }
        executor().writeCopy("test.write", pass.records(), 0, before.records.size() * 4, before.records.data());
        executor().writeCopy("test.write", pass.albedo(), 0, before.albedo.size() * 4, before.albedo.data());
        holes.record(executor(), pass.texels());
        device().finish();
        return maps();
    }
};

Scene planeOf(Vec normal, double offset) {  // normal.p = -offset, towards the origin
    return [=](Vec d) {
        const double t = -offset / dot(normal, d);
        return Seen{t, normal};
    };
}

bool randomly(std::uint32_t x, std::uint32_t y) { return ((x * 73856093u ^ y * 19349663u) * 2654435761u >> 16) % 100 >= 15; }

}  // namespace

TEST_CASE("known texels stay, a constant stays constant, a plane is continued", "[pull_push]") {
    HolesRig rig(GENERATE(1u, 16u));
    const Vec slanted = reference::unit({0.2, -0.3, -0.9});
    const auto [scene, isPlane, tangent] = GENERATE_COPY(
        std::tuple<Scene, bool, double>{[](Vec d) { return Seen{2.0, d * -1.0}; }, false, 0.0},
        std::tuple<Scene, bool, double>{planeOf({0, 0, -1}, 1.5), true, 0.0},
        std::tuple<Scene, bool, double>{planeOf(slanted, 1.5), true, kNormalRounding});
    const DrawnMaps maps = rig.filled(scene, randomly);
    int holes = 0, left = 0, wrong = 0;
    double off = 0.0;
    for (std::uint32_t y = 0; y < kSize; ++y)
        for (std::uint32_t x = 0; x < kSize; ++x) {
            const std::size_t at = maps.at(0, x, y);
            if (rig.before.hit(at)) {
                REQUIRE(maps.records[2 * at] == rig.before.records[2 * at]);
                REQUIRE(maps.records[2 * at + 1] == rig.before.records[2 * at + 1]);
                REQUIRE(maps.albedo[at] == kGrey);
                continue;
            }
            // Where a plane runs away from the map within few texels, and at the rim, nobody fills.
            const Vec d = reference::localDirection(x, y, kSize);
            const Seen expected = scene(d);
            const double cosine = -dot(expected.normal, d);
            if (!reference::isBeforeRim(x, y, kSize) || d.z < 0.3 || cosine < 0.3) continue;
            ++holes;
            if (!maps.hit(at)) {
                ++left;
                continue;
            }
            CHECK(maps.albedo[at] == kGrey);
            // A sphere takes the mean plane of the block that filled it: 8 texels a side at most, which are 0.46 from the
            // middle to the corner, where the plane is off by 1 / cos(0.46) - 1 = 0.12; mostly 2, which are 0.12.
            const double allowed = isPlane ? 2e-5 + 3.0 * tangent / cosine : 0.12;
            const double error = std::abs(double(maps.distance(at)) / expected.distance - 1.0);
            off += error;
            if (error > allowed) ++wrong;
            if (reference::length(maps.normal(at) - expected.normal) > (isPlane ? 2.0 * kNormalRounding : 0.46)) ++wrong;
        }
    CAPTURE(isPlane, holes, left);
    CHECK(off < 0.01 * holes);
    CHECK(holes > 120);
    CHECK(left <= holes / 50);
    CHECK(wrong == 0);
}

TEST_CASE("a wide hole stays open, and a border does not grow", "[pull_push]") {
    HolesRig rig(GENERATE(1u, 16u));
    const Scene wall = planeOf({0, 0, -1}, 1.5);
    const DrawnMaps window = rig.filled(wall, [](std::uint32_t x, std::uint32_t y) {
        return x < 24 || x >= 48 || y < 24 || y >= 48;  // on the levels' own borders
    });
    for (std::uint32_t y = 24; y < 48; ++y)
        for (std::uint32_t x = 24; x < 48; ++x) REQUIRE(!window.hit(window.at(0, x, y)));
    const DrawnMaps half = rig.filled(wall, [](std::uint32_t x, std::uint32_t) { return x < 31; });
    // Off the levels' borders: blocks half of which were seen stay as they are.
    int grown = 0;
    for (std::uint32_t y = 8; y < 56; ++y)
        for (std::uint32_t x = 31; x < kSize; ++x) grown += half.hit(half.at(0, x, y)) ? 1 : 0;
    CHECK(grown == 0);
}

TEST_CASE("a hole between near and far takes the nearer surface, not their mean", "[pull_push]") {
    HolesRig rig(16);
    // A screen before a wall, its border between columns 31 and 32; holes on both sides.
    const DrawnMaps maps = rig.filled(
        [](Vec d) {
            const double t = (d.x < 0.0 ? 1.0 : 3.0) / d.z;
            return Seen{t, {0, 0, -1}};
        },
        randomly);
    int holes = 0, between = 0;
    for (std::uint32_t y = 16; y < 48; ++y)
        for (std::uint32_t x = 16; x < 48; ++x) {
            const std::size_t at = maps.at(0, x, y);
            if (rig.before.hit(at) || !maps.hit(at)) continue;
            ++holes;
            const double z = double(maps.distance(at)) * reference::localDirection(x, y, kSize).z;
            if (std::abs(z - 1.0) > 1e-3 && std::abs(z - 3.0) > 1e-3) ++between;
        }
    CHECK(holes > 50);
    CHECK(between == 0);
}

TEST_CASE("nothing known stays unknown", "[pull_push]") {
    HolesRig rig(GENERATE(1u, 16u));
    const DrawnMaps maps = rig.filled(planeOf({0, 0, -1}, 1.0), [](std::uint32_t, std::uint32_t) { return false; });
    for (std::size_t t = 0; t < maps.albedo.size(); ++t) REQUIRE(!maps.hit(t));
    CHECK(rig.holes.bytes() == PullPush::estimateBytes(kSize, 1));
    // Levels of 9 planes reach the kernels' indices before the maps do.
    CHECK_NOTHROW(PullPush::estimateBytes(512, 3640));
    CHECK_THROWS_AS(PullPush::estimateBytes(512, 3641), Error);
}
