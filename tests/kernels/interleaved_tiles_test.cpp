// Tiles that skip VPLs: what they keep, and that the picture's bits do not change.
#include <catch2/catch.hpp>
#include <limits>

#include "passes/interleaved_gather.h"
#include "reference/surfaces.h"
#include "support/kernel_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Image;
using reference::Vec;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

lw_subset_order orderOf(std::size_t slots, std::uint32_t n) {
    lw_subset_order order{};
    order.subsets = cl_int(n * n);
    order.step = 1;
    order.capacity = cl_int(slots / (n * n));
    order.count = cl_int(slots);
    return order;
}

Image gatherOn(KernelRig& rig, const Image& position, const Image& normal, const std::vector<lw_vpl>& vpls,
               std::uint32_t n) {
    const std::uint32_t w = position.width, h = position.height;
    const Guarded p = rig.uploadPlanes(position.planes, w, h, 3, kNaN), nr = rig.uploadPlanes(normal.planes, w, h, 3, 1.0f);
    const Guarded list = rig.upload(vpls), counts = rig.upload(std::vector<cl_int>{0, 0});
    const Guarded out = rig.makePlanes(w, h, 3);
    const lw_subset_order order = orderOf(vpls.size(), n);
    const Planes surfaces[2] = {rig.planes(p, w, h, 3), rig.planes(nr, w, h, 3)};
    VplTiles tiles;
    tiles.reserve(rig.device(), w, h, order, n);
    InterleavedGather pass(rig.device(), n);
    pass.recordCull(rig.executor(), surfaces[0], surfaces[1], list, order, tiles);
    pass.recordGather(rig.executor(), surfaces[0], surfaces[1], list, order, tiles.masks(), rig.planes(out, w, h, 3), counts);
    rig.device().finish();
    Image result(w, h);
    result.planes = rig.downloadPlanes(rig.planes(out, w, h, 3));
    return result;
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
