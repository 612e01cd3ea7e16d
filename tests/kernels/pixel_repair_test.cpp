// Marked pixels into a small image and back, against a serial list; and which pixels an up-sampling marks.
#include "passes/pixel_repair.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <random>
#include <vector>

#include "passes/joint_bilateral.h"
#include "reference/surfaces.h"
#include "shared/pixel_repair_types.h"
#include "support/kernel_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Image;

namespace {

// What a picture of any values has in it, put into memory of the pass's own.
void place(KernelRig& rig, const std::vector<float>& packed, const Planes& to) {
    const Guarded from = rig.uploadPlanes(packed, to.width, to.height, to.count, 7.0f);  // padding: as if marked
    const std::size_t bytes = std::size_t(to.planeStride) * to.count * sizeof(float);
    rig.executor().copy("test", from.get(), to.memory, 0, std::size_t(to.offset) * sizeof(float), bytes);
    rig.device().finish();
}

// The same of marks, as an up-sampling of so many lanes leaves them.
void mark(KernelRig& rig, const std::vector<float>& marks, std::uint32_t width, const RepairedPixels& memory) {
    const std::uint32_t bits = 2 * rig.device().width(), wordsOfRow = (width + bits - 1) / bits;
    std::vector<cl_uint> words(marks.size() / width * wordsOfRow);
    for (std::uint32_t i = 0; i < marks.size(); ++i)
        if (marks[i] > 0.0f) words[i / width * wordsOfRow + i % width / bits] |= 1u << i % width % bits;
    rig.executor().write("test", memory.marks(), 0, words.size() * sizeof(cl_uint), words.data());
    rig.device().finish();
}

std::vector<float> shownMarks(KernelRig& rig, PixelRepair& pass, const RepairedPixels& memory, std::uint32_t width, std::uint32_t height) {
    const Guarded shown = rig.makePlanes(width, height, 1);
    pass.recordMarks(rig.executor(), memory, rig.planes(shown, width, height, 1));
    rig.device().finish();
    return rig.downloadPlanes(rig.planes(shown, width, height, 1));
}

// The marked pixels that there is room for, in the order of their places.
std::vector<std::uint32_t> taken(const std::vector<float>& marks, std::uint32_t room) {
    std::vector<std::uint32_t> all;
    for (std::uint32_t i = 0; i < marks.size(); ++i)
        if (marks[i] > 0.0f) all.push_back(i);
    const std::uint64_t count = std::min<std::uint64_t>(all.size(), room);
    std::vector<std::uint32_t> list;
    for (std::uint64_t i = 0; i < all.size(); ++i)
        if ((i + 1) * count / all.size() > i * count / all.size()) list.push_back(all[i]);
    return list;
}

std::vector<float> randomMarks(std::uint32_t width, std::uint32_t height, double share) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> value(0.0, 1.0);
    std::vector<float> marks(std::size_t(width) * height);
    for (float& mark : marks) mark = value(random) < share ? 1.0f : 0.0f;
    return marks;
}

}  // namespace

TEST_CASE("marked pixels come into the small image, evenly where there are too many, and back", "[pixel_repair]") {
    const auto width = GENERATE(1u, 16u);
    const double share = GENERATE(0.0, 0.01, 0.3, 1.0);
    const auto size = testSize(std::make_pair(147u, 61u));
    const std::uint32_t w = size.first, h = size.second, pixels = w * h, room = RepairedPixels::room(w, h);
    CAPTURE(width, share, w, h);
    KernelRig rig(width);
    const std::vector<float> marks = randomMarks(w, h, share);
    const Image position = reference::randomImage(w, h, 1), normal = reference::randomImage(w, h, 2), light = reference::randomImage(w, h, 3);
    RepairedPixels memory(rig.device(), w + 20, h + 9);  // larger than the picture
    mark(rig, marks, w, memory);
    const Guarded p = rig.uploadPlanes(position.planes, w, h, 3, 1.0f), n = rig.uploadPlanes(normal.planes, w, h, 3, 1.0f);
    PixelRepair pass(rig.device());
    CHECK(bitDifference(shownMarks(rig, pass, memory, w, h), marks) == "");
    pass.recordCollect(rig.executor(), rig.planes(p, w, h, 3), rig.planes(n, w, h, 3), memory);
    rig.device().finish();

    const std::vector<std::uint32_t> list = taken(marks, room);
    CHECK(list.size() <= room);
    const std::vector<float> listedPosition = rig.downloadPlanes(memory.position(w, h)), listedNormal = rig.downloadPlanes(memory.normal(w, h));
    const std::size_t listed = listedNormal.size() / 3;
    REQUIRE(listed >= room);
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t i = 0; i < listed; ++i) {
            if (i >= list.size()) {
                REQUIRE(listedNormal[a * listed + i] == 0.0f);
                continue;
            }
            REQUIRE(listedPosition[a * listed + i] == position.planes[a * pixels + list[i]]);
            REQUIRE(listedNormal[a * listed + i] == normal.planes[a * pixels + list[i]]);
        }

    // Back: each pixel of the list has its place's light, all others theirs.
    std::vector<float> small(3 * listed), expected = light.planes;
    for (std::size_t i = 0; i < small.size(); ++i) small[i] = float(i);
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t i = 0; i < list.size(); ++i) expected[a * pixels + list[i]] = small[a * listed + i];
    place(rig, small, memory.light(w, h));
    const Guarded e = rig.uploadPlanes(light.planes, w, h, 3, 1.0f);
    pass.recordPut(rig.executor(), memory, rig.planes(e, w, h, 3));
    rig.device().finish();
    CHECK(bitDifference(rig.downloadPlanes(rig.planes(e, w, h, 3)), expected) == "");
}

TEST_CASE("up-sampling marks steep light and lost pixels, and makes the same light", "[pixel_repair]") {
    const auto width = GENERATE(1u, 16u);
    const auto size = testSize(std::make_pair(75u, 37u));
    const std::uint32_t w = size.first, h = size.second, hw = JointBilateral::halved(w), hh = JointBilateral::halved(h);
    CAPTURE(width, w, h);
    KernelRig rig(width);
    Image position(w, h), normal(w, h);
    // A wall; one pixel of another surface that no sample is of (odd column, odd row: the last that down-sampling would take).
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x) {
            position.set(x, y, {0.1 * x, 0.1 * y, 0.0});
            normal.set(x, y, {0, 0, 1});
        }
    const std::uint32_t lostX = 7, lostY = 4;
    normal.set(lostX, lostY, {1, 0, 0});
    // Light 1, from sample column `step` on 2: samples differ by a third to a half of what comes of them beside it.
    Image light(hw, hh);
    const std::uint32_t step = 8;
    for (std::uint32_t y = 0; y < hh; ++y)
        for (std::uint32_t x = 0; x < hw; ++x) light.set(x, y, x < step ? reference::Vec{1, 1, 1} : reference::Vec{2, 2, 2});

    const Guarded p = rig.uploadPlanes(position.planes, w, h, 3, 1.0f), n = rig.uploadPlanes(normal.planes, w, h, 3, 1.0f);
    const Guarded hp = rig.makePlanes(hw, hh, 3), hn = rig.makePlanes(hw, hh, 3), l = rig.uploadPlanes(light.planes, hw, hh, 3, 1.0f);
    const Guarded plain = rig.makePlanes(w, h, 3), marked = rig.makePlanes(w, h, 3), validity = rig.makePlanes(w, h, 1);
    const Guarded counts = rig.upload(std::vector<cl_int>{0, 0}), markedCounts = rig.upload(std::vector<cl_int>{0, 0});
    const auto full = [&](const Guarded& buffer, std::uint32_t planes) { return rig.planes(buffer, w, h, planes); };
    const auto half = [&](const Guarded& buffer) { return rig.planes(buffer, hw, hh, 3); };
    RepairedPixels memory(rig.device(), w, h);
    PixelRepair repair(rig.device());
    JointBilateral without(rig.device()), with(rig.device(), 3, true);
    without.recordDownsample(rig.executor(), full(p, 3), full(n, 3), half(hp), half(hn));
    without.recordUpsample(rig.executor(), full(p, 3), full(n, 3), half(hp), half(hn), half(l), full(plain, 3), counts);
    const float share = GENERATE(0.25f, 1.5f);
    with.recordUpsampleMarked(rig.executor(), full(p, 3), full(n, 3), half(hp), half(hn), half(l), full(marked, 3), share, memory.marks(),
                              full(validity, 1), markedCounts);
    rig.device().finish();
    CHECK(bitDifference(rig.downloadPlanes(full(marked, 3)), rig.downloadPlanes(full(plain, 3))) == "");
    CHECK(rig.download<cl_int>(markedCounts) == rig.download<cl_int>(counts));

    CHECK(bitDifference(rig.downloadPlanes(full(validity, 1)), std::vector<float>(std::size_t(w) * h, 1.0f)) == "");
    const std::vector<float> found = shownMarks(rig, repair, memory, w, h);
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x) {
            // A block's first pixel sees the samples of the columns before and after its own: blocks step - 1 and step are steep.
            const std::uint32_t block = x / 2;
            const bool isSteep = share < 1.0f && (block + 1 == step || block == step);
            const bool isLost = x == lostX && y == lostY;
            CAPTURE(x, y);
            REQUIRE(found[y * w + x] == (isSteep || isLost ? 1.0f : 0.0f));
        }
}
