#include "inputs/read_planes.h"

#include "compute/device.h"
#include "compute/error.h"

namespace lightwell {

void enqueueReadPlanes(Executor& executor, const Planes& planes, float* pixels) {
    const std::size_t rowBytes = planes.width * sizeof(float);
    for (std::uint32_t plane = 0; plane < planes.count; ++plane)
        for (std::uint32_t y = 0; y < planes.height; ++y) {
            const std::int64_t at = planes.offset + plane * planes.planeStride + y * planes.rowStride;
            executor.read("debug.read", planes.memory, std::size_t(at) * sizeof(float), rowBytes, pixels);
            pixels += planes.width;
        }
}

void readPlanes(Device& device, const Planes& planes, float* pixels) {
    Profile untimed;
    Executor executor(device, untimed);
    try {
        enqueueReadPlanes(executor, planes, pixels);
    } catch (...) {
        clFinish(device.queue());  // the caller's memory must not be written after this
        throw;
    }
    device.finish();
}

}  // namespace lightwell
