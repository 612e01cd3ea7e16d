// Surfaces dealt out by a mask and light joined again: every pixel is in one image, and comes back from
// it.
#include "passes/receiver_split.h"
#include "support/static_vpl_pass_rig.h"

using namespace lightwell;
using namespace lightwell::test;

TEST_CASE("every pixel goes to one image and comes back from it", "[receiver_split]") {
    KernelRig rig(GENERATE(1u, 16u));
    const auto [width, height] = testSize({37, 11});
    const std::size_t size = std::size_t(width) * height;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0.1f, 1.0f);
    std::vector<float> normals(3 * size), marks(size),
        light[2] = {std::vector<float>(3 * size), std::vector<float>(3 * size)};
    for (float& v : normals) v = unit(random);
    for (std::size_t i = 0; i < size; ++i) marks[i] = i % 3 == 0 ? 0.0f : i % 3 == 1 ? 1.0f : 0.5f;
    for (auto& image : light)
        for (float& v : image) v = unit(random);
    const float padding = std::nanf("");
    const Guarded normal = rig.uploadPlanes(normals, width, height, 3, padding),
                  mask = rig.uploadPlanes(marks, width, height, 1, padding),
                  firstLight = rig.uploadPlanes(light[0], width, height, 3, padding),
                  secondLight = rig.uploadPlanes(light[1], width, height, 3, padding),
                  first = rig.makePlanes(width, height, 3), second = rig.makePlanes(width, height, 3),
                  joined = rig.makePlanes(width, height, 3);
    const auto planes = [&](const Guarded& buffer, std::uint32_t count) {
        return rig.planes(buffer, width, height, count);
    };
    ReceiverSplit split(rig.device());
    split.recordNormals(rig.executor(), planes(normal, 3), planes(mask, 1), planes(first, 3),
                        planes(second, 3));
    split.recordJoin(rig.executor(), planes(mask, 1), planes(firstLight, 3), planes(secondLight, 3),
                     planes(joined, 3));
    rig.device().finish();
    const auto a = rig.downloadPlanes(planes(first, 3)), b = rig.downloadPlanes(planes(second, 3)),
               e = rig.downloadPlanes(planes(joined, 3));
    for (std::size_t i = 0; i < 3 * size; ++i) {
        const bool baked = marks[i % size] != 0.0f;
        CAPTURE(i, baked);
        REQUIRE(a[i] == (baked ? 0.0f : normals[i]));
        REQUIRE(b[i] == (baked ? normals[i] : 0.0f));
        REQUIRE(e[i] == light[baked ? 1 : 0][i]);
    }
}
