// What of a voxel grid is made anew, and where bricks lie: the same bits as all made anew, slots, what finds none.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <numeric>
#include <random>
#include <set>

#include "support/voxel_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr int kSize = 32;

// A floor, and small things above it.
std::vector<VoxelTriangle> someScene(int count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<VoxelTriangle> triangles = {{{{{{-5, -5, 3.4}}, {{40, -5, 3.4}}, {{40, 40, 3.4}}}}}, {{{{{-5, -5, 3.4}}, {{40, 40, 3.4}}, {{-5, 40, 3.4}}}}}};
    for (int i = 0; i < count; ++i) {
        VoxelTriangle t;
        const double x = 28 * unit(random), y = 28 * unit(random), z = 4 + 20 * unit(random);
        for (auto& p : t.at) p = {x + 3 * unit(random), y + 3 * unit(random), z + 3 * unit(random)};
        for (std::size_t c = 0; c < 3; ++c) {
            t.albedo[c] = float(unit(random));
            t.emission[c] = i % 3 ? 0.0f : float(5.0 * unit(random));
        }
        triangles.push_back(t);
    }
    // The largest emission stays whatever moves.
    triangles[0].emission = {{5.0f, 0.0f, 0.0f}};
    return triangles;
}

}  // namespace

TEST_CASE("the same bits at any width, in any order of the triangles", "[voxel_grid][large]") {
    std::vector<VoxelTriangle> triangles = someScene(150, 3);
    VoxelRig wide(16, kSize), narrow(1, kSize);
    wide.voxelise(triangles, true);
    narrow.voxelise(triangles, true);
    CHECK(wide.state().voxels > 1000);
    CHECK((wide.everything() == narrow.everything()));
    CHECK((wide.bricks() == narrow.bricks()));
    std::shuffle(triangles.begin(), triangles.end(), std::mt19937(5));
    VoxelRig other(16, kSize);
    other.voxelise(triangles, true);
    CHECK((other.everything() == wide.everything()));
}

TEST_CASE("normals, albedo and emission are means by area", "[voxel_grid]") {
    VoxelRig rig(GENERATE(1u, 16u), kSize);
    // In one voxel, three right triangles: 0.08 facing up, 0.02 facing down, 0.02 facing along x.
    const auto corner = [](double a, double b, bool up) {
        VoxelTriangle t;
        t.at = {{{{9.2, 9.2, 9.5}}, {{9.2 + a, 9.2, 9.5}}, {{9.2, 9.2 + b, 9.5}}}};
        if (!up) std::swap(t.at[1], t.at[2]);
        return t;
    };
    std::vector<VoxelTriangle> t = {corner(0.4, 0.4, true), corner(0.2, 0.2, false), {}};
    t[2].at = {{{{9.5, 9.2, 9.2}}, {{9.5, 9.4, 9.2}}, {{9.5, 9.2, 9.4}}}};
    t[0].albedo = {{0.9f, 0.0f, 0.3f}};
    t[1].albedo = {{0.3f, 1.0f, 0.3f}};
    t[2].albedo = {{0.3f, 0.0f, 0.9f}};
    t[1].emission = {{12.0f, 0.0f, 3.0f}};
    rig.voxelise(t, true);
    const std::size_t at = rig.indexOf(9, 9, 9);
    const auto areaOf = [&](int plane) { return double(rig.floats(plane)[at]); };
    CHECK(areaOf(LW_SURFACE_AREA_X) == Approx(0.02).epsilon(1e-5));
    CHECK(areaOf(LW_SURFACE_AREA_Y) == 0.0);
    CHECK(areaOf(LW_SURFACE_AREA_Z) == Approx(0.10).epsilon(1e-5));
    CHECK(areaOf(LW_SURFACE_AREA) == Approx(0.12).epsilon(1e-5));
    const cl_uint normal = rig.plane(LW_SURFACE_NORMAL)[at], albedo = rig.plane(LW_SURFACE_ALBEDO)[at],
                  emission = rig.plane(LW_SURFACE_EMISSION)[at];
    const auto tenBits = [](cl_uint word, int c) { return double(word >> (10 * c) & 1023u); };
    const double normals[3] = {1.0 / 6.0, 0.0, 0.5}, albedos[3] = {0.7, 1.0 / 6.0, 0.4}, emissions[3] = {2.0, 0.0, 0.5};
    for (int c = 0; c < 3; ++c) {
        CHECK((tenBits(normal, c) - 511.0) / 511.0 == Approx(normals[c]).margin(0.51 / 511.0));
        CHECK(tenBits(albedo, c) / 1023.0 == Approx(albedos[c]).margin(0.51 / 1023.0));
        const double mantissa = double(emission >> (9 * c) & 511u), scale = double(rig.state().emission);
        CHECK(mantissa * std::ldexp(1.0, -9 - int(emission >> 27)) * scale == Approx(emissions[c]).margin(2.0 / 512.0));
    }
    CHECK(rig.state().emission == 16.0f);
    CHECK(rig.state().bricks == 1);
    CHECK(rig.state().voxels == 1);
}

TEST_CASE("only bricks that a change touches are made anew, with the same bits as all", "[voxel_grid][large]") {
    VoxelRig rig(16, kSize);
    std::vector<VoxelTriangle> triangles = someScene(60, 9);
    rig.voxelise(triangles, true);
    const auto changedCount = [&] {
        const std::vector<cl_int> changed = rig.changed();
        return std::accumulate(changed.begin(), changed.end(), 0);
    };
    CHECK(changedCount() == 64);
    const std::vector<cl_uint> first = rig.everything();
    rig.record(true);
    CHECK(changedCount() == 0);
    CHECK(rig.state().stale == 0);
    CHECK(rig.state().todo == 0);
    CHECK((rig.everything() == first));
    const auto checkAnew = [&] {
        VoxelRig anew(16, kSize);
        anew.place = rig.place;
        anew.voxelise(triangles, true);
        CHECK((anew.everything() == rig.everything()));
        const LwVoxelGrid a = anew.state(), b = rig.state();
        CHECK(a.bricks == b.bricks);
        CHECK(a.voxels == b.voxels);
        CHECK(a.dropped == b.dropped);
        CHECK(a.outside == b.outside);
        // Bricks have slots of their own.
        std::set<cl_int> slots;
        int taken = 0;
        for (const cl_int slot : rig.bricks())
            if (slot >= 0) {
                ++taken;
                slots.insert(slot);
            }
        CHECK(int(slots.size()) == taken);
        CHECK(taken == b.bricks);
    };
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    int part = 0;
    for (int step = 0; step < 6; ++step) {
        VoxelTriangle& t = triangles[std::size_t(2 + 7 * step)];
        for (auto& p : t.at)
            for (std::size_t a = 0; a < 3; ++a) p[a] += step < 4 ? 6.0 * unit(random) : 0.0;
        t.albedo[0] = 0.5f;
        const std::vector<cl_int> before = rig.bricks();
        rig.voxelise(triangles, true);
        part += changedCount();
        CHECK(changedCount() < 40);
        CHECK(changedCount() > 0);
        const std::vector<cl_int> after = rig.bricks(), changed = rig.changed();
        for (std::size_t b = 0; b < before.size(); ++b)
            if (!changed[b] || (before[b] >= 0 && after[b] >= 0)) CHECK(after[b] == before[b]);
        checkAnew();
    }
    CHECK(part > 6);
    // One that leaves, two that come.
    triangles.erase(triangles.begin() + 20);
    rig.voxelise(triangles, true);
    checkAnew();
    // Another place: all.
    rig.place.origin.s[0] += 0.15f;
    rig.record(true);
    CHECK(changedCount() == 64);
    const std::vector<cl_uint> moved = rig.everything();
    rig.pass.forget();
    rig.record(true);
    CHECK(changedCount() == 64);
    CHECK((rig.everything() == moved));
}

TEST_CASE("a revision that was missed, or another emission's scale, makes all anew", "[voxel_grid][large]") {
    VoxelRig rig(16, kSize);
    std::vector<VoxelTriangle> triangles = someScene(20, 9);
    rig.voxelise(triangles, true);
    for (int twice = 0; twice < 2; ++twice) {
        for (auto& p : triangles[5].at) p[0] += 0.5;
        rig.setTriangles(triangles);
        const LWGeometry g = rig.geometry(true);
        rig.input.import(rig.executor(), &g, true);
    }
    rig.record(true);
    CHECK(rig.state().all == 1);
    triangles[0].emission[0] = 50.0f;
    rig.voxelise(triangles, true);
    CHECK(rig.state().all == 1);
    CHECK(rig.state().emission == 64.0f);
    VoxelRig anew(16, kSize);
    anew.voxelise(triangles, true);
    CHECK((anew.everything() == rig.everything()));
}

TEST_CASE("bricks that find no slot are counted, and have one as soon as the count is back", "[voxel_grid][large]") {
    VoxelRig rig(16, 64), all(16, 64, false);
    // Everywhere: more bricks than a room's sides.
    std::mt19937 random(2);
    std::uniform_real_distribution<double> unit(0.0, 64.0);
    std::vector<VoxelTriangle> triangles;
    for (int i = 0; i < 4000; ++i) {
        const double x = unit(random), y = unit(random), z = unit(random);
        triangles.push_back({{{{{x, y, z}}, {{x + 0.3, y, z}}, {{x, y + 0.3, z + 0.1}}}}});
    }
    rig.voxelise(triangles);
    all.voxelise(triangles);
    const int room = int(rig.pass.slots());
    CHECK(room == 6 * 64);
    CHECK(rig.state().bricks == 512);
    CHECK(rig.state().dropped == 512 - room);
    CHECK((rig.occupied() == all.occupied()));
    // Where no surfaces are kept, no brick wants for a slot.
    VoxelGrid bare(rig.device(), 64, VoxelGrid::Keeps::none);
    const Guarded place = rig.upload(std::vector<LwLpvPlace>{rig.place});
    bare.record(rig.executor(), rig.input, place);
    rig.device().finish();
    CHECK((VoxelRig::read<cl_uint>(bare.occupied(), rig.brickCount() * LW_VOXEL_WORDS) == all.occupied()));
    CHECK(VoxelRig::read<LwVoxelGrid>(bare.state(), 1)[0].dropped == 0);
    CHECK(bare.bytes() <= VoxelGrid::estimateBytes(64, VoxelGrid::Keeps::none));
    CHECK(bare.bytes() < rig.pass.bytes() / 10);
    // In the order of the bricks, so that those that are dropped are the last.
    const std::vector<cl_int> bricks = rig.bricks();
    for (int b = 0; b < 512; ++b) CHECK(bricks[std::size_t(b)] == (b < room ? b : LW_VOXEL_EMPTY));
    CHECK(rig.pass.bytes() <= VoxelGrid::estimateBytes(64, true));
    rig.record();
    CHECK(rig.state().dropped == 0);
    CHECK(rig.pass.slots() == 512);
    CHECK((rig.everything() == all.everything()));
    CHECK(rig.pass.bytes() <= VoxelGrid::estimateBytes(64, true, rig.pass.slots()));
    CHECK(all.pass.bytes() <= VoxelGrid::estimateBytes(64, false));
    Report report;
    rig.pass.report(rig.device(), report);
    rig.device().finish();
    report.resolve();
    const auto countOf = [&](const std::string& name) {
        for (const LWCount& c : report.counts)
            if (c.name == name) return c.value;
        return ~std::uint64_t(0);
    };
    CHECK(countOf("voxel_bricks") == 512);
    CHECK(countOf("voxels") == std::uint64_t(all.state().voxels));
    CHECK(countOf("dropped_bricks") == 0);
    CHECK(countOf("outside_surfaces") == 0);
}

TEST_CASE("without a grid, or triangles, nothing is occupied; what lies beyond is counted", "[voxel_grid]") {
    VoxelRig rig(GENERATE(1u, 16u), kSize);
    std::vector<VoxelTriangle> triangles = someScene(8, 4);
    rig.voxelise(triangles);
    CHECK(rig.state().bricks > 0);
    const LwLpvPlace place = rig.place;
    rig.place.origin.s[3] = 0.0f;
    rig.place.cell.s[0] = 0.0f;
    rig.record();
    CHECK(rig.state().bricks == 0);
    CHECK(rig.state().voxels == 0);
    const std::vector<cl_uint> bits = rig.occupied();
    CHECK(std::all_of(bits.begin(), bits.end(), [](cl_uint w) { return w == 0; }));
    rig.place = place;
    for (int i = 0; i < 7; ++i) {
        VoxelTriangle t = triangles[5];
        for (auto& p : t.at) p[std::size_t(i % 3)] += i % 2 ? 200.0 : -200.0;
        triangles.push_back(t);
    }
    rig.voxelise(triangles);
    CHECK(rig.state().outside == 7);
    CHECK(rig.state().bricks > 0);
    rig.voxelise({});
    CHECK(rig.state().bricks == 0);
    for (const cl_int slot : rig.bricks()) CHECK(slot == LW_VOXEL_EMPTY);
}
