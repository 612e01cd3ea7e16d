// Device memory: created against the device's limits, counted, released with its owner.
#include "compute/buffer.h"

#include <utility>

#include "compute/device.h"
#include "compute/error.h"

namespace lightwell {

Buffer::Buffer(Device& device, std::size_t bytes, const char* what) {
    if (bytes == 0) fail(LW_ERROR_INTERNAL, what, ": a buffer of zero bytes");
    if (bytes > device.maxAllocation())
        fail(LW_ERROR_OUT_OF_MEMORY, what, ": ", bytes,
             " bytes in one piece, the device allows at most ", device.maxAllocation());
    // Drivers that allocate at first use would fail in the middle of a frame.
    if (device.allocatedBytes() + bytes > device.globalMemory())
        fail(LW_ERROR_OUT_OF_MEMORY, what, ": ", bytes, " bytes beside the ", device.allocatedBytes(),
             " held already, the device has ", device.globalMemory());
    cl_int status = CL_SUCCESS;
    memory_ = clCreateBuffer(device.context(), CL_MEM_READ_WRITE, bytes, nullptr, &status);
    if (status != CL_SUCCESS)
        fail(status == CL_INVALID_CONTEXT ? LW_ERROR_DEVICE : LW_ERROR_OUT_OF_MEMORY, what, ": ", bytes,
             " bytes: clCreateBuffer: ", clErrorName(status));
    device_ = &device;
    bytes_ = bytes;
    counted_ = true;
    device.countAllocation(std::int64_t(bytes));
}

Buffer Buffer::overHost(Device& device, void* host, std::size_t bytes, bool writable) {
    if (!host || bytes == 0) fail(LW_ERROR_INTERNAL, "Buffer::overHost: no host memory");
    cl_int status = CL_SUCCESS;
    Buffer buffer;
    const cl_mem_flags access = writable ? CL_MEM_READ_WRITE : CL_MEM_READ_ONLY;
    buffer.memory_ =
        clCreateBuffer(device.context(), CL_MEM_USE_HOST_PTR | access, bytes, host, &status);
    checkCl(status, "clCreateBuffer over host memory");
    buffer.device_ = &device;
    buffer.bytes_ = bytes;
    return buffer;
}

Buffer Buffer::retained(Device& device, cl_mem memory) {
    Buffer buffer;
    checkCl(clRetainMemObject(memory), "clRetainMemObject");
    buffer.memory_ = memory;
    buffer.device_ = &device;
    checkCl(clGetMemObjectInfo(memory, CL_MEM_SIZE, sizeof buffer.bytes_, &buffer.bytes_, nullptr),
            "clGetMemObjectInfo(CL_MEM_SIZE)");
    return buffer;
}

Buffer::~Buffer() {
    if (!memory_) return;
    clReleaseMemObject(memory_);
    if (counted_) device_->countAllocation(-std::int64_t(bytes_));
}

Buffer::Buffer(Buffer&& other) noexcept
    : device_(std::exchange(other.device_, nullptr)),
      memory_(std::exchange(other.memory_, nullptr)),
      bytes_(std::exchange(other.bytes_, 0)),
      counted_(std::exchange(other.counted_, false)) {}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(memory_, other.memory_);
    std::swap(bytes_, other.bytes_);
    std::swap(counted_, other.counted_);
    return *this;
}

void Buffer::download(std::size_t byteOffset, std::size_t bytes, void* to) const {
    checkCl(clEnqueueReadBuffer(device_->queue(), memory_, CL_TRUE, byteOffset, bytes, to, 0, nullptr,
                                nullptr),
            "clEnqueueReadBuffer");
}

void Buffer::reserve(Device& device, std::size_t bytes, const char* what) {
    if (memory_ && bytes <= bytes_) return;
    *this = Buffer(device, bytes, what);
}

PlanarImage::PlanarImage(Device& device, std::uint32_t maxWidth, std::uint32_t maxHeight,
                         std::uint32_t planes, const char* what)
    : buffer_(device, std::size_t(paddedWidth(maxWidth)) * maxHeight * planes * sizeof(float), what),
      count_(planes) {}

Planes PlanarImage::planes(std::uint32_t width, std::uint32_t height) const {
    Planes planes;
    planes.memory = buffer_.get();
    planes.rowStride = paddedWidth(width);
    planes.planeStride = planes.rowStride * height;
    planes.width = width;
    planes.height = height;
    planes.count = count_;
    if (std::uint64_t(planes.planeStride) * count_ * sizeof(float) > buffer_.bytes())
        fail(LW_ERROR_INTERNAL, "PlanarImage: ", width, " x ", height, " x ", count_,
             " planes exceed the ", buffer_.bytes(), " bytes reserved");
    return planes;
}

}  // namespace lightwell
