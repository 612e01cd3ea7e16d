// Visibility through voxels between the walls of rooms: of convex ones next to nothing is missing, and of the light of one next to
// nothing comes into another.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "support/voxel_sight_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Image;
using reference::Vec;

namespace {

// A closed room, turned about an axis: corner and three edges of `side` voxels each.
struct TurnedRoom {
    Vec middle, axes[3];
    double half;

    TurnedRoom(int size, double share, Vec about, double angle) : middle{size * 0.5, size * 0.5, size * 0.5}, half(0.5 * share * size) {
        const Vec k = reference::unit(about);
        const double c = std::cos(angle), s = std::sin(angle);
        const Vec unit[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        for (int a = 0; a < 3; ++a) {  // Rodrigues' formula
            const Vec v = unit[a], cross{k.y * v.z - k.z * v.y, k.z * v.x - k.x * v.z, k.x * v.y - k.y * v.x};
            axes[a] = v * c + cross * s + k * (dot(k, v) * (1.0 - c));
        }
    }
    // Of wall 2 a + (0 or 1), across axis a; u, v from -1 to 1.
    Vec wallPoint(int wall, double u, double v) const {
        const int a = wall / 2;
        return middle + axes[a] * (wall % 2 ? half : -half) + axes[(a + 1) % 3] * (u * half) + axes[(a + 2) % 3] * (v * half);
    }
    Vec inward(int wall) const { return axes[wall / 2] * (wall % 2 ? -1.0 : 1.0); }
    Voxels voxels(int size) const {
        Voxels result(size);
        result.fill([&](int x, int y, int z) {
            const Vec p = Vec{x + 0.5, y + 0.5, z + 0.5} - middle;
            for (int a = 0; a < 3; ++a)
                for (const double side : {-half, half}) {
                    const double reach = 0.5 * (std::abs(axes[a].x) + std::abs(axes[a].y) + std::abs(axes[a].z));
                    if (std::abs(dot(p, axes[a]) - side) <= reach && std::abs(dot(p, axes[(a + 1) % 3])) <= half + reach &&
                        std::abs(dot(p, axes[(a + 2) % 3])) <= half + reach)
                        return true;
                }
            return false;
        });
        return result;
    }
};

// Of the light of clusters on a room's walls, what arrives on its walls: everywhere, and more than two voxels from all edges. Weighed by
// the form factor, as light is.
struct Arriving {
    double lit = 0.0, all = 0.0, litInside = 0.0, allInside = 0.0;
};

void addRoom(Arriving& sum, const TurnedRoom& room, int size) {
    VoxelSightRig rig(16, size);
    std::vector<lw_cluster> clusters;
    for (int wall = 0; wall < 6; ++wall)
        for (const double u : {-0.6, 0.1, 0.7}) clusters.push_back(clusterIn(room.wallPoint(wall, u, 0.3 * u), room.inward(wall)));
    rig.sweep(room.voxels(size), clusters);
    constexpr std::uint32_t kPlaces = 40;
    const auto at = [](std::uint32_t i) { return -1.0 + (2 * i + 1.0) / kPlaces; };
    Image position(kPlaces, 6 * kPlaces), normal(kPlaces, 6 * kPlaces);
    for (std::uint32_t row = 0; row < 6 * kPlaces; ++row)
        for (std::uint32_t i = 0; i < kPlaces; ++i) {
            const int wall = int(row / kPlaces);
            position.set(i, row, inWorld(room.wallPoint(wall, at(i), at(row % kPlaces))));
            normal.set(i, row, room.inward(wall));
        }
    const std::vector<float> seen = rig.seen(position, normal, std::uint32_t(clusters.size()));
    std::size_t k = 0;
    for (const lw_cluster& c : clusters)
        for (std::uint32_t y = 0; y < 6 * kPlaces; ++y)
            for (std::uint32_t x = 0; x < kPlaces; ++x, ++k) {
                const Vec to = reference::vecOf(c.medoidPosition) - position.get(x, y);
                const double d2 = dot(to, to);
                const double w = std::max(0.0, dot(to, normal.get(x, y))) * std::max(0.0, -dot(to, reference::vecOf(c.normal))) / (d2 * d2);
                const bool isInside = room.half * (1.0 - std::max(std::abs(at(x)), std::abs(at(y % kPlaces)))) > 2.0;
                sum.all += w;
                sum.lit += w * double(seen[k]);
                if (isInside) sum.allInside += w, sum.litInside += w * double(seen[k]);
            }
}

}  // namespace

TEST_CASE("walls of a convex room shadow neither each other nor themselves, but for a strip beside edges", "[voxel_visibility][large]") {
    const auto size = GENERATE(32, 64);
    const auto turn = GENERATE(0, 1, 2);
    Arriving sum;
    for (const double share : {0.52, 0.54, 0.56, 0.58, 0.6, 0.62})  // wherever in voxels the walls lie
        addRoom(sum, TurnedRoom(size, share, turn == 2 ? Vec{1, 2, 3} : Vec{0, 0, 1}, turn == 0 ? 0.0 : 0.6), size);
    CAPTURE(size, turn, sum.lit / sum.all, sum.litInside / sum.allInside);
    // Where two walls meet, the place off one may lie in the other's voxels, and what arrives at these comes past more of them.
    CHECK(sum.lit > (size == 32 ? 0.94 : 0.96) * sum.all);
    // A way that falls towards a turned wall's steps is interpolated with them.
    CHECK(sum.litInside > (turn == 0 ? 0.999 : 0.985) * sum.allInside);
}

TEST_CASE("of one room's light less than a thousandth comes through a wall into the next", "[voxel_visibility][large]") {
    // Two rooms of 0.8 and 0.4 of the grid beside each other, between them a wall of `thick` voxels; turned against the grid.
    const auto size = GENERATE(32, 64);
    const auto thick = GENERATE(2.0, 3.0);
    const auto angle = GENERATE(0.0, 0.35);
    VoxelSightRig rig(16, size);
    const TurnedRoom room(size, 0.6, {0, 0, 1}, angle);
    Voxels voxels = room.voxels(size);
    const double near = 0.37, far = near + thick;  // the wall's sides, along the room's first axis from its middle
    voxels.fill([&](int x, int y, int z) {
        const Vec p = Vec{x + 0.5, y + 0.5, z + 0.5} - room.middle;
        const double reach = 0.5 * (std::abs(room.axes[0].x) + std::abs(room.axes[0].y)), along = dot(p, room.axes[0]);
        return along >= near - reach && along <= far + reach && std::abs(dot(p, room.axes[1])) <= room.half && std::abs(dot(p, room.axes[2])) <= room.half;
    });
    std::vector<lw_cluster> clusters;
    for (const double u : {-0.7, -0.3, 0.4, 0.8}) clusters.push_back(clusterIn(room.wallPoint(4, -0.5, u), room.inward(4)));
    rig.sweep(voxels, clusters);
    // The floor, on both sides of the wall, and the wall's dark side.
    constexpr std::uint32_t kPlaces = 64;
    Image position(kPlaces, 2 * kPlaces), normal(kPlaces, 2 * kPlaces);
    const auto at = [](std::uint32_t i) { return -1.0 + (2 * i + 1.0) / kPlaces; };
    for (std::uint32_t y = 0; y < kPlaces; ++y)
        for (std::uint32_t x = 0; x < kPlaces; ++x) {
            position.set(x, y, inWorld(room.wallPoint(4, at(x), at(y))));
            normal.set(x, y, room.inward(4));
            position.set(x, kPlaces + y, inWorld(room.wallPoint(0, at(x), at(y)) + room.axes[0] * (room.half + far)));
            normal.set(x, kPlaces + y, room.axes[0]);
        }
    const std::vector<float> seen = rig.seen(position, normal, std::uint32_t(clusters.size()));
    double light = 0.0, dark = 0.0;
    int lit = 0, unlit = 0;
    std::size_t k = 0;
    for (std::size_t c = 0; c < clusters.size(); ++c)
        for (std::uint32_t y = 0; y < 2 * kPlaces; ++y)
            for (std::uint32_t x = 0; x < kPlaces; ++x, ++k) {
                const double along = dot((position.get(x, y) - kGridCorner) * (1.0 / kVoxelSide) - room.middle, room.axes[0]);
                if (along < near) light += double(seen[k]), ++lit;
                if (along > far - 1e-3) dark += double(seen[k]), ++unlit;
            }
    CAPTURE(size, thick, angle);
    CHECK(light / lit > 0.9);
    CHECK(dark / unlit < 1e-3);
    CHECK(dark >= 0.0);
    CHECK(unlit > 1000);
}
