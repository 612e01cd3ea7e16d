// Planes with room around each row, so that a filter's taps never ask where the picture ends.
#pragma once

#include <cstddef>
#include <memory>

#include "gbuffer.h"

namespace studio {

class PaddedPlanes {
public:
    static constexpr int kPad = 64;  // floats on either side of a row, at least; zero
    PaddedPlanes() = default;
    PaddedPlanes(int width, int height, int planes)
        : width_(width), height_(height), buffer_(width + 2 * kPad, height, planes) {}
    int width() const { return width_; }
    int height() const { return height_; }
    int planes() const { return buffer_.planes(); }
    // Readable from -kPad to width + kPad, and on to a whole vector of 16.
    float* row(int plane, int y) { return buffer_.row(plane, y) + kPad; }
    const float* row(int plane, int y) const { return buffer_.row(plane, y) + kPad; }
    std::size_t bytes() const {
        return buffer_.planeFloats() * std::size_t(buffer_.planes()) * sizeof(float);
    }

private:
    int width_ = 0, height_ = 0;
    PlanarBuffer buffer_;
};

// What the filter works on: the surfaces of the traced pixels, where the normal of none is zero.
struct TracedSurfaces {
    PaddedPlanes position, normal;
    TracedSurfaces() = default;
    TracedSurfaces(int width, int height) : position(width, height, 3), normal(width, height, 3) {}
};

}  // namespace studio
