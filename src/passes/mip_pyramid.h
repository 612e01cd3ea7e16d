// Mip pyramid of a G-buffer: per level the surface nearest the camera, the direct radiance averaged over it, and
// what else a technique wants of it. kernels/mip_pyramid says how texels come about.
#pragma once

#include <vector>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "passes/level_planes.h"
#include "shared/pyramid_types.h"

namespace lightwell {

class Camera;

// Planes beside position (3) and normal (3, unit or zero), in this order.
enum PyramidPlanes : std::uint32_t {
    kPyramidRadiance = 1,  // 3: direct radiance, W/(sr m^2)
    kPyramidArea = 2,      // 1: of the surface that the texel shows, m^2; negative: it only receives. Radiance is then weighted
                           // by it, and pixels that only receive never hide one that sends
    kPyramidDepth = 4      // 1: along the camera's axis; 0 without a surface
};

struct PyramidOptions {
    std::uint32_t extras = 0;      // PyramidPlanes
    std::uint32_t firstLevel = 1;  // 0: with a checked copy of the base; 1: from half resolution on; 2: from a quarter on, not `sampled`
    std::uint32_t lastLevel = 1;   // level k has 1 / 2^k of the columns and rows, rounded up
    // Levels above the first keep one child for all four, background too, in place of the nearest: surfaces then keep their
    // size in the mean, where the nearest grow by up to half a texel. Not with kPyramidArea or kPyramidDepth.
    bool sampled = false;
    std::uint32_t planes() const {
        return 6 + (extras & kPyramidRadiance ? 3 : 0) + (extras & kPyramidArea ? 1 : 0) + (extras & kPyramidDepth ? 1 : 0);
    }
};

// All levels in one allocation, for images up to a size. Every row can be read from 16 columns before its first to 16
// columns behind its length rounded up to 16; what lies beyond the image there has no surface (all planes zero).
class PyramidLevels {
public:
    PyramidLevels() = default;
    PyramidLevels(Device& device, std::uint32_t maxWidth, std::uint32_t maxHeight, const PyramidOptions& options);

    static std::uint32_t sizeAt(std::uint32_t base, std::uint32_t level) { return levelSize(base, level); }
    // What an allocation takes.
    static std::uint64_t estimateBytes(std::uint32_t maxWidth, std::uint32_t maxHeight, const PyramidOptions& options);

    const PyramidOptions& options() const { return options_; }
    Planes level(std::uint32_t k) const { return levels_[k - options_.firstLevel]; }  // every plane
    Planes position(std::uint32_t k) const { return part(k, LW_PYRAMID_POSITION, 3); }
    Planes normal(std::uint32_t k) const { return part(k, LW_PYRAMID_NORMAL, 3); }
    Planes radiance(std::uint32_t k) const { return part(k, 6, 3); }
    Planes area(std::uint32_t k) const { return part(k, options_.extras & kPyramidRadiance ? 9 : 6, 1); }
    Planes depth(std::uint32_t k) const { return part(k, options_.planes() - 1, 1); }
    std::uint64_t bytes() const { return memory_.bytes(); }
    const Buffer& memory() const { return memory_; }

private:
    friend class MipPyramid;
    // Lays the levels out for a base of this size; true when they stand elsewhere than before.
    bool resize(std::uint32_t width, std::uint32_t height);
    Planes part(std::uint32_t k, std::uint32_t first, std::uint32_t count) const;

    PyramidOptions options_;
    Buffer memory_;
    std::vector<Planes> levels_;
    std::uint32_t width_ = 0, height_ = 0;
};

class MipPyramid {
public:
    MipPyramid(Device& device, std::uint32_t extras);  // PyramidPlanes

    // Passes "mip_pyramid.base" (or ".copy", ".quarter": to the first level) and ".reduce". radiance: 3 planes, or none without
    // kPyramidRadiance; receiveMask: 1 plane, nonzero pixels send nothing (with kPyramidArea), or none.
    // counts[0] grows by the pixels with neither a surface nor a zero normal, counts[1] by surfaces whose radiance
    // lies outside 0 .. LW_LARGEST_RADIANCE and which therefore send nothing. turn: of sampled levels, which keep other children
    // in another turn, and each of a block's four in any four turns from a multiple of four on.
    void record(Executor& executor, const Planes& position, const Planes& normal, const Planes& radiance,
                const Planes& receiveMask, const Camera& camera, PyramidLevels& levels, const Buffer& counts,
                std::uint32_t turn = 0);

private:
    std::uint32_t extras_;
    Kernel &copy_, &base_, &quarter_, &reduce_;
};

}  // namespace lightwell
