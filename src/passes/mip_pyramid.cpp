#include "passes/mip_pyramid.h"

#include <string>

#include "compute/device.h"
#include "inputs/camera.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "mip_pyramid/mip_pyramid";

Defines definesOf(std::uint32_t extras) {
    PyramidOptions options;
    options.extras = extras;
    return {{"LW_PYRAMID_RADIANCE", extras & kPyramidRadiance ? "1" : "0"},
            {"LW_PYRAMID_AREA", extras & kPyramidArea ? "1" : "0"},
            {"LW_PYRAMID_DEPTH", extras & kPyramidDepth ? "1" : "0"},
            {"LW_PYRAMID_PLANES", std::to_string(options.planes())}};
}

Range groupOf(const Kernel& kernel) { return kernel.width() == 1 ? Range{64, 1} : Range{8, 1}; }

Range itemsOver(const Planes& planes, const Kernel& kernel) {
    return {(planes.width + kernel.width() - 1) / kernel.width(), planes.height};
}

// Opposite corners by turns of the level, so that kept children do not drift; from turn to turn the next one round the block,
// from another start in every four turns, so that levels take all pairs of children.
cl_int firstChild(std::uint32_t level, std::uint32_t turn) {
    const std::uint32_t round = turn / 4, start = (round * (2 * level + 1) + round / 4 * level) % 4;
    return cl_int(((level % 2 ? 2 : 0) + turn + start) % 4);
}

std::uint64_t layOut(std::uint32_t width, std::uint32_t height, const PyramidOptions& options, std::vector<Planes>* levels) {
    return layOutLevels(width, height, {options.firstLevel, options.lastLevel}, options.planes(), 16, LW_PYRAMID_BORDER, levels);
}

}  // namespace

PyramidLevels::PyramidLevels(Device& device, std::uint32_t maxWidth, std::uint32_t maxHeight, const PyramidOptions& options)
    : options_(options), memory_(device, std::size_t(estimateBytes(maxWidth, maxHeight, options)), "mip pyramid of a view") {}

std::uint64_t PyramidLevels::estimateBytes(std::uint32_t maxWidth, std::uint32_t maxHeight, const PyramidOptions& options) {
    return layOut(maxWidth, maxHeight, options, nullptr) * sizeof(float);
}

bool PyramidLevels::resize(std::uint32_t width, std::uint32_t height) {
    if (width == width_ && height == height_) return false;
    levels_.clear();
    layOut(width, height, options_, &levels_);
    for (Planes& planes : levels_) planes.memory = memory_.get();
    width_ = width;
    height_ = height;
    return true;
}

Planes PyramidLevels::part(std::uint32_t k, std::uint32_t first, std::uint32_t count) const {
    Planes planes = level(k);
    planes.offset += first * planes.planeStride;
    planes.count = count;
    return planes;
}

MipPyramid::MipPyramid(Device& device, std::uint32_t extras)
    : extras_(extras),
      copy_(device.programs().kernel(kProgram, "mip_pyramid_copy", definesOf(extras))),
      base_(device.programs().kernel(kProgram, "mip_pyramid_base", definesOf(extras))),
      quarter_(device.programs().kernel(kProgram, "mip_pyramid_quarter", definesOf(extras))),
      reduce_(device.programs().kernel(kProgram, "mip_pyramid_reduce", definesOf(extras))) {}

void MipPyramid::record(Executor& executor, const Planes& position, const Planes& normal, const Planes& radiance,
                        const Planes& receiveMask, const Camera& camera, PyramidLevels& levels, const Buffer& counts,
                        std::uint32_t turn) {
    const PyramidOptions& options = levels.options();
    if (levels.resize(position.width, position.height))
        executor.fill("mip_pyramid.clear", levels.memory(), 0, 0, levels.memory().bytes());
    LwPyramidCamera eye;
    eye.eye = float4(camera.eye().x, camera.eye().y, camera.eye().z, camera.pixelArea());
    eye.axis = float4(camera.axis().x, camera.axis().y, camera.axis().z, camera.perspective() ? 1.0 : 0.0);
    const Planes& light = extras_ & kPyramidRadiance ? radiance : position;
    const Planes& mask = receiveMask ? receiveMask : position;
    const auto fromBase = [&](const char* pass, Kernel& kernel, const Planes& level) {
        executor.run(pass, kernel, itemsOver(level, kernel), groupOf(kernel), position, normal, light, mask,
                     cl_int(receiveMask ? 1 : 0), cl_int(position.width), cl_int(position.height), eye, level, counts);
    };
    std::uint32_t k = options.firstLevel;
    if (k == 0)
        fromBase("mip_pyramid.copy", copy_, levels.level(0));
    else if (k == 1)
        fromBase("mip_pyramid.base", base_, levels.level(1));
    else
        fromBase("mip_pyramid.quarter", quarter_, levels.level(2));
    for (; k < options.lastLevel; ++k) {
        const Planes fine = levels.level(k), coarse = levels.level(k + 1);
        executor.run("mip_pyramid.reduce", reduce_, itemsOver(coarse, reduce_), groupOf(reduce_), fine, cl_int(fine.width),
                     cl_int(fine.height), coarse, eye, firstChild(k, options.sampled ? turn : 0), cl_int(options.sampled));
    }
}

}  // namespace lightwell
