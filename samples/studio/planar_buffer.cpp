// Aligned planar image memory, see gbuffer.h.
#include <algorithm>
#include <cstdlib>
#include <new>
#include <stdexcept>

#include <fmt/format.h>

#include "gbuffer.h"

namespace studio {
namespace {
constexpr std::size_t kAlignment = 64;  // bytes: what Lightwell asks of memory used in place
constexpr int kRowFloats = 16;          // rows are padded to this many floats
}  // namespace

void PlanarBuffer::Free::operator()(float* p) const {
    std::free(p);
}

PlanarBuffer::PlanarBuffer(int width, int height, int planes)
    : width_(width), height_(height), planes_(planes) {
    if (width < 1 || height < 1 || planes < 1)
        throw std::runtime_error(fmt::format(
            "image size: expected at least 1x1 with 1 plane, got {}x{} with {}", width, height, planes));
    rowFloats_ = (width + kRowFloats - 1) / kRowFloats * kRowFloats;
    const std::size_t count = planeFloats() * std::size_t(planes);
    float* memory = static_cast<float*>(std::aligned_alloc(kAlignment, count * sizeof(float)));
    if (memory == nullptr) throw std::bad_alloc();
    std::fill_n(memory, count, 0.0f);
    data_.reset(memory);
}

float* PlanarBuffer::row(int plane, int y) {
    return data_.get() + std::size_t(plane) * planeFloats() + std::size_t(y) * std::size_t(rowFloats_);
}
const float* PlanarBuffer::row(int plane, int y) const {
    return data_.get() + std::size_t(plane) * planeFloats() + std::size_t(y) * std::size_t(rowFloats_);
}
float* PlanarBuffer::data() {
    return data_.get();
}
const float* PlanarBuffer::data() const {
    return data_.get();
}

glm::vec3 PlanarBuffer::rgb(int x, int y) const {
    return {row(0, y)[x], row(1, y)[x], row(2, y)[x]};
}

void PlanarBuffer::setRgb(int x, int y, const glm::vec3& value) {
    row(0, y)[x] = value.x;
    row(1, y)[x] = value.y;
    row(2, y)[x] = value.z;
}

}  // namespace studio
