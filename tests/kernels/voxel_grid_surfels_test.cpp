// Surfels as voxels: their area is kept and lies where the discs are.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <random>

#include "shared/voxel_bins.h"
#include "support/voxel_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr int kSize = 32;
constexpr double kPi = 3.14159265358979323846;

struct Disc {
    std::array<double, 3> at, normal;  // in voxels
    double radius;
    std::array<double, 3> albedo{{0.5, 0.5, 0.5}}, emission{{0.0, 0.0, 0.0}};
};

std::vector<Disc> someDiscs(int count, double largest, double low, double high) {
    std::mt19937 random(23);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<Disc> discs;
    for (int i = 0; i < count; ++i) {
        Disc d{};
        double length = 0.0;
        for (std::size_t a = 0; a < 3; ++a) {
            d.at[a] = low + (high - low) * unit(random);
            d.normal[a] = unit(random) - 0.5;
            length += d.normal[a] * d.normal[a];
            d.albedo[a] = unit(random);
            d.emission[a] = i % 2 ? 7.0 * unit(random) : 0.0;
        }
        for (double& n : d.normal) n /= std::sqrt(length);
        d.radius = largest * unit(random);
        discs.push_back(d);
    }
    return discs;
}

struct DiscRig : VoxelRig {
    using VoxelRig::VoxelRig;
    std::uint64_t revision = 0;
    void voxeliseDiscs(const std::vector<Disc>& discs, bool emits) {
        const std::size_t stride = std::max<std::size_t>((discs.size() + 31) / 32 * 32, 32);
        std::vector<float> planes(stride * LW_SURFEL_EMISSIVE_PLANES);
        float most = 0.0f;
        for (std::size_t i = 0; i < discs.size(); ++i) {
            const Disc& d = discs[i];
            cl_uint word = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                planes[a * stride + i] = float(double(kOrigin[a]) + kCell * d.at[a]);
                planes[(LW_SURFEL_NORMAL + a) * stride + i] = float(d.normal[a]);
                planes[(LW_SURFEL_EMISSION + a) * stride + i] = float(d.emission[a]);
                most = std::max(most, float(d.emission[a]));
                word |= cl_uint(d.albedo[a] * 1023.0 + 0.5) << (10 * a);
            }
            planes[LW_SURFEL_RADIUS * stride + i] = float(kCell * d.radius);
            std::memcpy(&planes[LW_SURFEL_ALBEDO * stride + i], &word, sizeof word);
        }
        std::vector<cl_uint> counters(LW_SURFEL_COUNTERS);
        std::memcpy(&counters[LW_SURFEL_LARGEST], &most, sizeof most);
        const Guarded memory = upload(planes), counted = upload(counters), placed = upload(std::vector<LwLpvPlace>{place});
        SurfelSet set;
        set.count = std::uint32_t(discs.size());
        set.revision = ++revision;
        if (emits) set.emission = &counted;
        if (set.count) {
            set.planes.memory = memory.get();
            set.planes.planeStride = std::int64_t(stride);
            set.planes.width = std::uint32_t(stride);
        }
        pass.record(executor(), set, placed);
        device().finish();
        CHECK(pass.bytes() <= VoxelGrid::estimateBytes(std::uint32_t(size), true, pass.slots()) +
                                  VoxelGridBins::estimateBytes(std::uint32_t(size), std::max<std::size_t>(discs.size(), 3000)));
    }
    double sum(int plane) const {
        double total = 0.0;
        for (const float v : floats(plane)) total += double(v);
        return total;
    }
};

// A disc as a polygon of 64 sides and the disc's area.
reference::VoxelPolygon polygonOf(const Disc& d) {
    const auto& n = d.normal;
    const std::array<double, 3> other = std::abs(n[0]) < 0.6 ? std::array<double, 3>{1, 0, 0} : std::array<double, 3>{0, 1, 0};
    std::array<double, 3> u{n[1] * other[2] - n[2] * other[1], n[2] * other[0] - n[0] * other[2], n[0] * other[1] - n[1] * other[0]}, v;
    const double length = std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    for (double& x : u) x /= length;
    for (std::size_t a = 0; a < 3; ++a) v[a] = n[(a + 1) % 3] * u[(a + 2) % 3] - n[(a + 2) % 3] * u[(a + 1) % 3];
    const double radius = d.radius * std::sqrt(kPi / (32.0 * std::sin(kPi / 32.0)));
    reference::VoxelPolygon polygon;
    for (int i = 0; i < 64; ++i) {
        const double c = radius * std::cos(kPi * i / 32.0), s = radius * std::sin(kPi * i / 32.0);
        polygon.push_back({d.at[0] + c * u[0] + s * v[0], d.at[1] + c * u[1] + s * v[1], d.at[2] + c * u[2] + s * v[2]});
    }
    return polygon;
}

}  // namespace

TEST_CASE("surfels' area is all there, the same bits at any width and in any order", "[voxel_grid][large]") {
    // From less than half a voxel to several bricks.
    const double largest = GENERATE(0.4, 2.0, 11.0);
    std::vector<Disc> discs = someDiscs(largest < 1.0 ? 3000 : 200, largest, largest, kSize - largest);
    DiscRig wide(16, kSize), narrow(1, kSize);
    wide.voxeliseDiscs(discs, true);
    double area = 0.0, across[3] = {0.0, 0.0, 0.0};
    for (const Disc& d : discs) {
        area += kPi * d.radius * d.radius;
        for (std::size_t a = 0; a < 3; ++a) across[a] += kPi * d.radius * d.radius * std::abs(d.normal[a]);
    }
    CHECK(wide.sum(LW_SURFACE_AREA) == Approx(area).epsilon(2e-5));
    for (int a = 0; a < 3; ++a) CHECK(wide.sum(LW_SURFACE_AREA_X + a) == Approx(across[a]).epsilon(2e-5));
    CHECK(wide.state().outside == 0);
    narrow.voxeliseDiscs(discs, true);
    CHECK((narrow.everything() == wide.everything()));
    std::shuffle(discs.begin(), discs.end(), std::mt19937(5));
    DiscRig other(16, kSize);
    other.voxeliseDiscs(discs, true);
    CHECK((other.everything() == wide.everything()));
    // The same memory again: a second set of surfels in a grid that has seen others.
    wide.voxeliseDiscs(someDiscs(50, 1.0, 2.0, 30.0), true);
    wide.voxeliseDiscs(discs, true);
    CHECK((other.everything() == wide.everything()));
}

TEST_CASE("a small surfel lies in its centre's voxel whole, a larger one where its disc does", "[voxel_grid][large]") {
    DiscRig rig(GENERATE(1u, 16u), kSize);
    Disc small{{{10.99, 4.5, 17.01}}, {{0.0, 0.6, -0.8}}, 0.3};
    small.albedo = {{0.2, 1.0, 0.0}};
    small.emission = {{0.0, 3.0, 1.5}};
    rig.voxeliseDiscs({small}, true);
    const std::size_t at = rig.indexOf(10, 4, 17);
    CHECK(rig.state().voxels == 1);
    CHECK(bitOf(rig.occupied(), at));
    CHECK(double(rig.floats(LW_SURFACE_AREA)[at]) == Approx(kPi * 0.09).epsilon(1e-5));
    CHECK(rig.state().emission == 4.0f);
    const cl_uint emission = rig.plane(LW_SURFACE_EMISSION)[at], albedo = rig.plane(LW_SURFACE_ALBEDO)[at];
    CHECK(double(emission >> 9 & 511u) * std::ldexp(4.0, -9 - int(emission >> 27)) == Approx(3.0).epsilon(1.0 / 512));
    CHECK(double(emission >> 18 & 511u) * std::ldexp(4.0, -9 - int(emission >> 27)) == Approx(1.5).epsilon(1.0 / 256));
    CHECK((albedo >> 10 & 1023u) == 1023u);
    rig.voxeliseDiscs({small}, false);
    CHECK(rig.plane(LW_SURFACE_EMISSION)[at] == 0u);

    const Disc large{{{15.3, 16.2, 14.9}}, {{0.48, 0.6, 0.64}}, 5.0};
    rig.voxeliseDiscs({large}, false);
    const std::vector<float> area = rig.floats(LW_SURFACE_AREA);
    const reference::VoxelPolygon disc = polygonOf(large);
    double off = 0.0;
    for (int z = 0; z < kSize; ++z)
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                const reference::VoxelPolygon part =
                    reference::clipToBox(disc, {double(x), double(y), double(z)}, {x + 1.0, y + 1.0, z + 1.0});
                off += std::abs(double(area[rig.indexOf(x, y, z)]) - reference::polygonArea(part));
            }
    // Eight segments beyond the octagon's sides, and its corners beyond the disc: 3.7 % of the area each.
    CHECK(off < 0.08 * kPi * 25.0);
}

TEST_CASE("surfels beyond the grid are counted; none leave it empty", "[voxel_grid]") {
    DiscRig rig(16, kSize);
    std::vector<Disc> discs = someDiscs(40, 0.4, 1.0, 31.0);
    for (std::size_t i = 0; i < 15; ++i) discs[i].at[i % 3] = i % 2 ? -0.6 : kSize + 0.6;
    for (std::size_t i = 15; i < 20; ++i) discs[i].at[i % 3] = i % 2 ? -500.0 : 500.0;
    discs.push_back({{{-3.0, 16.0, 16.0}}, {{0, 0, 1}}, 5.0});  // reaches in
    discs.push_back({{{-100.0, 16.0, 16.0}}, {{0, 0, 1}}, 5.0});
    discs.push_back({{{-100.0, 16.0, 16.0}}, {{0, 0, 1}}, 105.0});
    rig.voxeliseDiscs(discs, false);
    CHECK(rig.state().outside == 21);
    CHECK(bitOf(rig.occupied(), rig.indexOf(0, 16, 16)));
    CHECK(bitOf(rig.occupied(), rig.indexOf(4, 16, 16)));
    CHECK(!bitOf(rig.occupied(), rig.indexOf(12, 16, 16)));  // an octagon reaches 5 % farther than its disc
    rig.voxeliseDiscs({}, false);
    CHECK(rig.state().bricks == 0);
    CHECK(rig.state().outside == 0);
    rig.voxeliseDiscs(discs, false);
    rig.place.origin.s[3] = 0.0f;
    rig.voxeliseDiscs(discs, false);
    CHECK(rig.state().bricks == 0);
}
