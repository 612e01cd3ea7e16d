// Builds the pyramid of a small G-buffer and reads it back; what lies behind and between its levels must be zero.
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <vector>

#include "inputs/camera.h"
#include "passes/mip_pyramid.h"
#include "reference/pyramid_twin.h"
#include "support/kernel_rig.h"

namespace lightwell::test {

using reference::Image;
using reference::PinholeCamera;

inline constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();

struct PyramidScene {
    Image position, normal, radiance;
    std::vector<float> mask;
    PyramidScene(std::uint32_t w, std::uint32_t h) : position(w, h), normal(w, h), radiance(w, h), mask(std::size_t(w) * h) {}
};

// Ground whose depths all differ, and 30 % of background.
inline PyramidScene grainyScene(const PinholeCamera& camera, std::uint32_t w, std::uint32_t h) {
    PyramidScene scene(w, h);
    const Image noise = reference::randomImage(w, h, 9);
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x) {
            if (noise.get(x, y).y < 0.3) continue;
            scene.position.set(x, y, camera.ray(x + 0.5, y + 0.5) * (2.0 + noise.get(x, y).x));
            scene.normal.set(x, y, {0, 0, 1});
            scene.radiance.set(x, y, {2, 3, 4});
        }
    return scene;
}

// What a pyramid holds, packed, by level.
struct PyramidRead {
    std::vector<Image> position, normal, radiance;
    std::vector<std::vector<float>> area, depth;
    std::vector<cl_int> counts;
};

inline PyramidRead build(KernelRig& rig, const PyramidScene& scene, const PinholeCamera& camera, const PyramidOptions& options,
                         std::uint32_t turn = 0) {
    const std::uint32_t w = scene.position.width, h = scene.position.height;
    const Guarded p = rig.uploadPlanes(scene.position.planes, w, h, 3, kNoNumber), n = rig.uploadPlanes(scene.normal.planes, w, h, 3, 1.0f);
    const Guarded l = rig.uploadPlanes(scene.radiance.planes, w, h, 3, kNoNumber), m = rig.uploadPlanes(scene.mask, w, h, 1, kNoNumber);
    const Guarded counts = rig.upload(std::vector<cl_int>{0, 0});
    MipPyramid pass(rig.device(), options.extras);
    // Larger than the image: what lies behind the levels must stay zero, as must the borders.
    PyramidLevels levels(rig.device(), w + 40, h + 5, options);
    for (int frame = 0; frame < 2; ++frame) {  // the second finds the memory of the first
        rig.executor().fill("test.counts", counts, 0, 0, counts.dataBytes());
        pass.record(rig.executor(), rig.planes(p, w, h, 3), rig.planes(n, w, h, 3), rig.planes(l, w, h, 3), rig.planes(m, w, h, 1),
                    Camera(camera.matrices(), w, h, "camera"), levels, counts, turn);
    }
    rig.device().finish();
    PyramidRead read;
    std::vector<float> all(levels.bytes() / sizeof(float));
    levels.memory().download(0, levels.bytes(), all.data());
    for (std::uint32_t k = options.firstLevel; k <= options.lastLevel; ++k) {
        const auto image = [&](const Planes& planes) {
            Image result(planes.width, planes.height, planes.count);
            result.planes = rig.downloadPlanes(planes);
            return result;
        };
        read.position.push_back(image(levels.position(k)));
        read.normal.push_back(image(levels.normal(k)));
        if (options.extras & kPyramidRadiance) read.radiance.push_back(image(levels.radiance(k)));
        if (options.extras & kPyramidArea) read.area.push_back(image(levels.area(k)).planes);
        if (options.extras & kPyramidDepth) read.depth.push_back(image(levels.depth(k)).planes);
        const Planes planes = levels.level(k);
        for (std::uint32_t row = 0; row < planes.height * planes.count; ++row)
            for (std::uint32_t x = 0; x < planes.width; ++x) all[std::size_t(planes.offset + row * planes.rowStride + x)] = 0.0f;
    }
    CHECK(std::all_of(all.begin(), all.end(), [](float v) { return v == 0.0f; }));
    read.counts = rig.download<cl_int>(counts);
    return read;
}

}  // namespace lightwell::test
