// Device memory and planar images in it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "compute/cl.h"

namespace lightwell {

class Device;

// Owns a cl_mem. Movable. Memory created here counts in Device::allocatedBytes.
class Buffer {
public:
    Buffer() = default;
    // Uninitialised device memory. Throws OUT_OF_MEMORY with `what` and the byte count; asks the device
    // for its largest allocation first, so that an impossible size fails here and not at first use.
    Buffer(Device& device, std::size_t bytes, const char* what);
    // Host memory in place (CL_MEM_USE_HOST_PTR); not counted as allocated.
    static Buffer overHost(Device& device, void* host, std::size_t bytes, bool writable);
    // A reference to the host's own cl_mem; not counted.
    static Buffer retained(Device& device, cl_mem memory);
    ~Buffer();
    Buffer(Buffer&& other) noexcept;
    Buffer& operator=(Buffer&& other) noexcept;

    cl_mem get() const { return memory_; }
    std::size_t bytes() const { return bytes_; }
    explicit operator bool() const { return memory_ != nullptr; }

    // Blocking; for reports, debugging and tests, after Device::finish.
    void download(std::size_t byteOffset, std::size_t bytes, void* to) const;
    // Grows to at least `bytes` (contents are lost); keeps the old memory when the new fails.
    void reserve(Device& device, std::size_t bytes, const char* what);

private:
    Device* device_ = nullptr;
    cl_mem memory_ = nullptr;
    std::size_t bytes_ = 0;
    bool counted_ = false;
};

// Planar float32 image inside a cl_mem, as kernels take it: two arguments, the memory and an int4
// layout (x = first float, y = floats per row (may be negative), z = floats per plane, w = 0).
// Every row can be read up to the next multiple of 16 pixels.
struct Planes {
    cl_mem memory = nullptr;
    std::int64_t offset = 0, rowStride = 0, planeStride = 0;  // floats
    std::uint32_t width = 0, height = 0, count = 0;
    explicit operator bool() const { return memory != nullptr; }
};

// Row length in floats of our own planar images.
inline std::uint32_t paddedWidth(std::uint32_t width) {
    return (width + 15u) & ~15u;
}

// A planar image of our own.
class PlanarImage {
public:
    PlanarImage() = default;
    PlanarImage(Device& device, std::uint32_t maxWidth, std::uint32_t maxHeight, std::uint32_t planes,
                const char* what);
    // The planes laid out for a current size (at most the maximum).
    Planes planes(std::uint32_t width, std::uint32_t height) const;
    std::size_t bytes() const { return buffer_.bytes(); }
    const Buffer& buffer() const { return buffer_; }
    explicit operator bool() const { return bool(buffer_); }

private:
    Buffer buffer_;
    std::uint32_t count_ = 0;
};

}  // namespace lightwell
