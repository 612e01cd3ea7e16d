// Levels that keep one pixel of each block, also where the picture's edge cuts blocks, and in every turn of the pattern.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "kernels/pyramid_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

// Which child of their blocks, round from the top left, all texels of a level show; what of a block lies beyond the edge stands
// for the nearest column or row inside. -1: not the same of all.
int keptChild(const Image& finePosition, const Image& fineNormal, const Image& position, const Image& normal) {
    for (int child = 0; child < 4; ++child) {
        const std::uint32_t right = child == 1 || child == 2, below = child >= 2;
        bool all = true;
        for (std::uint32_t y = 0; y < position.height && all; ++y)
            for (std::uint32_t x = 0; x < position.width && all; ++x) {
                const std::uint32_t i = std::min(2 * x + right, finePosition.width - 1), j = std::min(2 * y + below, finePosition.height - 1);
                const Vec n = normal.get(x, y), own = fineNormal.get(i, j), at = position.get(x, y), p = finePosition.get(i, j);
                all = n.x == own.x && n.y == own.y && n.z == own.z && (n.z == 0.0 || (at.x == p.x && at.y == p.y && at.z == p.z));
            }
        if (all) return child;
    }
    return -1;
}

}  // namespace

TEST_CASE("a sampled texel is one pixel of its block, background too", "[mip_pyramid]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    const auto [w, h] = testSize(std::make_pair(147u, 45u));
    const PinholeCamera camera{{0, 0, 0}, 0.5, w, h};
    const PyramidScene scene = grainyScene(camera, w, h);
    PyramidOptions options{0, 0, 5};
    options.sampled = true;
    const PyramidRead read = build(rig, scene, camera, options);
    // The first pixel of its block, then the last, level by level, so that it stays about the middle; the last one there is where
    // the edge cuts the block.
    const auto pixelOf = [](std::uint32_t texel, std::uint32_t k, std::uint32_t size) {
        for (; k > 0; --k) texel = std::min(2 * texel + (k % 2 == 0 ? 1 : 0), PyramidLevels::sizeAt(size, k - 1) - 1);
        return texel;
    };
    for (std::uint32_t k = 0; k <= 5; ++k)
        for (std::uint32_t y = 0; y < PyramidLevels::sizeAt(h, k); ++y)
            for (std::uint32_t x = 0; x < PyramidLevels::sizeAt(w, k); ++x) {
                const std::uint32_t i = pixelOf(x, k, w), j = pixelOf(y, k, h);
                const bool on = scene.normal.get(i, j).z > 0;
                const Vec got = read.position[k].get(x, y), n = read.normal[k].get(x, y);
                CAPTURE(k, x, y);
                REQUIRE((n.z > 0) == on);
                if (!on) REQUIRE(n.x * n.x + n.y * n.y == 0.0);
                if (on) REQUIRE((got.x == scene.position.get(i, j).x && got.z == scene.position.get(i, j).z));
            }
}

TEST_CASE("a sampled level keeps the same child of every block, cut ones too, and each of the four in four turns", "[mip_pyramid]") {
    const auto width = GENERATE(1u, 4u, 8u, 16u);
    const auto size = testSize(GENERATE(std::make_pair(1u, 1u), std::make_pair(3u, 5u), std::make_pair(67u, 1u), std::make_pair(1u, 37u),
                                        std::make_pair(147u, 45u)));
    const std::uint32_t first = GENERATE(0u, 1u);
    CAPTURE(width, size.first, size.second, first);
    KernelRig rig(width);
    const auto [w, h] = size;
    const PinholeCamera camera{{0, 0, 0}, 0.5, w, h};
    const PyramidScene scene = grainyScene(camera, w, h);
    PyramidOptions options{kPyramidRadiance, first, 6};
    options.sampled = true;
    for (const std::uint32_t round : {0u, 52u}) {
        std::vector<std::set<int>> kept(7);
        for (std::uint32_t turn = round; turn < round + 4; ++turn) {
            const PyramidRead read = build(rig, scene, camera, options, turn);
            CAPTURE(turn);
            for (std::uint32_t k = 1; k <= 6 - first; ++k) {
                CAPTURE(k);
                const int child = keptChild(read.position[k - 1], read.normal[k - 1], read.position[k], read.normal[k]);
                REQUIRE(child >= 0);
                kept[k].insert(child);
                // Light is a mean over the block's part in the picture: of equal light that light, in cut blocks too.
                for (std::uint32_t y = 0; y < read.normal[k].height; ++y)
                    for (std::uint32_t x = 0; x < read.normal[k].width; ++x)
                        REQUIRE(read.radiance[k].get(x, y).y == Approx(read.normal[k].get(x, y).z > 0.0 ? 3.0 : 0.0));
            }
        }
        for (std::uint32_t k = 1; k <= 6 - first; ++k)  // where all four differ in the picture at all
            if (w > 100 && k <= 4) CHECK(kept[k].size() == 4);
    }
}
