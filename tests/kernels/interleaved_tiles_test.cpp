// Tiles that skip VPLs: what they keep, and that the picture's bits do not change.
#include <catch2/catch.hpp>
#include <algorithm>
#include <limits>
#include <random>

#include "passes/interleaved_gather.h"
#include "reference/surfaces.h"
#include "support/gather_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Image;
using reference::Vec;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

Image gatherOn(KernelRig& rig, const Image& position, const Image& normal, const std::vector<lw_vpl>& vpls,
               std::uint32_t n, Bits bits = Bits::found) {
    return gatherImage(rig, position, normal, vpls, n, bits).irradiance;
}

}  // namespace

TEST_CASE("skipping VPLs by tiles keeps the bits", "[interleaved_tiles][large]") {
    const auto width = GENERATE(1u, 16u);
    const auto n = GENERATE(1u, 4u);
    // One tile and a bit, several tiles, and more pixels than tiles hold; normals of many directions.
    const auto size = testSize(GENERATE(std::make_pair(33u, 9u), std::make_pair(200u, 43u)));
    CAPTURE(width, n, size.first);
    KernelRig rig(width);
    Image position(size.first, size.second), normal(size.first, size.second);
    const int scene = GENERATE(0, 1);
    if (scene == 0) {
        reference::fillCorner(position, normal);
    } else {
        const auto wild = reference::randomVpls(size.first * size.second, 17);
        for (std::uint32_t i = 0; i < size.first * size.second; ++i) {
            const auto &p = wild[i].positionArea.s, &m = wild[i].normal.s;
            position.set(i % size.first, i / size.first, {p[0], p[1], p[2]});
            normal.set(i % size.first, i / size.first, {m[0] * 1.4, m[1] * 1.4, m[2] * 1.4});
        }
    }
    const std::size_t subsets = n * n, capacity = 74;  // two words and a part
    const auto vpls = reference::randomVpls(subsets * capacity, 13);
    // The same list behind so many empty slots that no tile skips anything.
    const std::size_t longer = std::size_t(VplTiles::kMostSlots) / subsets + 2;
    std::vector<lw_vpl> whole(subsets * longer, reference::makeVpl({0, 0, 0}, {0, 0, 0}, {0, 0, 0}, 0.0));
    for (std::size_t i = 0; i < vpls.size(); ++i) whole[i / capacity * longer + i % capacity] = vpls[i];
    const Image skipping = gatherOn(rig, position, normal, vpls, n), all = gatherOn(rig, position, normal, whole, n);
    CHECK(bitDifference(skipping.planes, all.planes) == "");
}

// Where rounding decides: pixels and VPLs of one slanted plane, far from the origin. Each pair of them has a cosine
// that is nothing but rounding, at the surface (its normal is the plane's) or at the VPL (its normal is). All that
// is added is then as small, so that any wrongly skipped pair shows in the bits.
struct Grazing {
    std::mt19937 random;
    double size;
    Vec normal, origin;

    double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
    Vec direction() {
        for (;;) {
            const Vec v{number(-1, 1), number(-1, 1), number(-1, 1)};
            if (dot(v, v) > 0.01) return unit(v);
        }
    }
    Grazing(unsigned seed, double offset, double size_) : random(seed), size(size_) {
        normal = direction();
        origin = direction() * offset;
    }
    Vec onPlane(double within) {
        const Vec v = direction() * within;
        return origin + v - normal * dot(v, normal);
    }
    // Tiles: of background, of one point, of a small and of a large patch; pixels: some without a surface.
    void fill(Image& position, Image& surfaceNormal, bool along) {
        const Vec turned = along ? normal : direction();
        const double oneLength = number(0.501, 1.999);
        for (std::uint32_t y = 0; y < position.height; ++y)
            for (std::uint32_t x = 0; x < position.width; ++x) {
                const std::uint32_t patch = (x / 32 + y / LW_TILE_ROWS) % 4;
                const double kind = number(0, 1);
                if (kind < 0.05 || patch == 3) continue;
                position.set(x, y, onPlane(patch == 0 ? 0.0 : patch == 1 ? 1e-3 * size : size));
                if (kind > 0.97) position.set(x, y, {kNaN, 0, 0});
                surfaceNormal.set(x, y, turned * (patch == 2 ? number(0.501, 1.999) : oneLength));
            }
    }
    std::vector<lw_vpl> vpls(std::size_t count, bool along) {
        std::vector<lw_vpl> list;
        for (std::size_t i = 0; i < count; ++i) {
            const Vec facing = (along ? direction() : normal) * number(0.981, 1.019);  // as hosts may give them
            const Vec flux = i % 11 == 7 ? Vec{} : Vec{number(0, 1), i % 5 ? number(0, 1) : 0.0, number(0, 1)} * 1e20;
            list.push_back(reference::makeVpl(onPlane(size), facing, flux, size * size * 1e-6));
        }
        return list;
    }
};

TEST_CASE("skipping keeps the bits where rounding decides", "[interleaved_tiles][large]") {
    const auto width = GENERATE(1u, 4u, 8u, 16u);
    const auto n = GENERATE(1u, 2u, 4u, 8u);
    const double offset = GENERATE(0.0, 1e4);
    const bool along = GENERATE(true, false);
    CAPTURE(width, n, offset, along);
    KernelRig rig(width);
    Grazing scene(n + (along ? 16u : 0u), offset, 300.0);
    const auto w = std::uint32_t(scene.number(33, 200)), h = std::uint32_t(scene.number(9, 40));
    const auto capacity = 2 * std::size_t(scene.number(1, 40));
    Image position(w, h), normal(w, h);
    scene.fill(position, normal, along);
    const auto vpls = scene.vpls(capacity * n * n, along);
    const Image skipping = gatherOn(rig, position, normal, vpls, n);
    const Image all = gatherOn(rig, position, normal, vpls, n, Bits::all);
    CHECK(bitDifference(skipping.planes, all.planes) == "");
}

// Positions out of reach are no surfaces, as everywhere positions come in.
TEST_CASE("pixels too far away to be lit take no light and change no other", "[interleaved_tiles]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    Image position(32, 8), normal(32, 8);
    reference::fillCorner(position, normal);
    const auto vpls = reference::randomVpls(64, 29);
    const Image before = gatherOn(rig, position, normal, vpls, 1);
    const Vec far[] = {{1e20, 0, 0}, {0, -3e38, 0}, {3e38, 3e38, -3e38}, {0.8e9, 0, -0.8e9}};
    Image expected = before;
    for (std::uint32_t i = 0; i < 4; ++i) {
        position.set(3 + 5 * i, 5, far[i]);
        normal.set(3 + 5 * i, 5, unit(Vec{-1, 1, 1}));
        expected.set(3 + 5 * i, 5, {0, 0, 0});
    }
    for (const Bits bits : {Bits::found, Bits::all})
        CHECK(bitDifference(gatherOn(rig, position, normal, vpls, 1, bits).planes, expected.planes) == "");
}

TEST_CASE("a tile keeps the VPLs that can light it", "[interleaved_tiles]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    // A floor of one tile, [0,1] x [0,1], that looks up; background in a corner must not widen its box.
    const std::uint32_t w = 32, h = LW_TILE_ROWS;
    Image position(w, h), normal(w, h);
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x) {
            position.set(x, y, {x / (w - 1.0), y / (h - 1.0), 0});
            normal.set(x, y, {0, 0, 1});
        }
    position.set(5, 0, {0, 0, 1e6});
    normal.set(5, 0, {0, 0, 0});
    auto vpls = reference::randomVpls(64, 23);
    vpls[9].flux = {{0, 0, 0, 0}};
    const Guarded p = rig.uploadPlanes(position.planes, w, h, 3, kNaN), nr = rig.uploadPlanes(normal.planes, w, h, 3, kNaN);
    const Guarded list = rig.upload(vpls);
    const lw_subset_order order = orderOf(vpls.size(), 1);
    VplTiles tiles;
    tiles.reserve(rig.device(), w, h, order, 1);
    InterleavedGather pass(rig.device(), 1);
    pass.recordCull(rig.executor(), rig.planes(p, w, h, 3), rig.planes(nr, w, h, 3), list, order, tiles);
    rig.device().finish();
    const lw_vpl_tiles layout = VplTiles::layout(w, h, order, 1);
    std::vector<cl_uint> masks(std::size_t(lw_tile_stride(layout)) * 2);
    tiles.masks().download(0, masks.size() * 4, masks.data());
    for (std::size_t word = 0; word < 2; ++word) {
        cl_uint expected = 0;
        for (std::size_t k = 0; k < 32; ++k) {
            const lw_vpl& v = vpls[word * 32 + k];
            const Vec at{v.positionArea.s[0], v.positionArea.s[1], v.positionArea.s[2]};
            const Vec facing{v.normal.s[0], v.normal.s[1], v.normal.s[2]};
            bool seen = false;  // from a corner, and so from anywhere
            for (int corner = 0; corner < 4; ++corner)
                seen = seen || dot(Vec{double(corner & 1), double(corner >> 1), 0} - at, facing) > 0.0;
            if (at.z > 0.0 && seen && v.flux.s[0] > 0.0f) expected |= 1u << k;
        }
        // An odd one is joined by the lowest that is skipped.
        int count = 0;
        for (cl_uint bits = expected; bits; bits &= bits - 1) ++count;
        if (count % 2) expected |= ~expected & (expected + 1);
        CHECK(masks[word * std::size_t(lw_tile_stride(layout))] == expected);
        CHECK(count > 4);
        CHECK(count < 24);
    }
}
