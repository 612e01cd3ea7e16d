#include "inputs/read_planes.h"

#include "compute/device.h"
#include "compute/error.h"

namespace lightwell {

void readPlanes(Device& device, const Planes& planes, float* pixels) {
    const std::size_t rowBytes = planes.width * sizeof(float);
    for (std::uint32_t plane = 0; plane < planes.count; ++plane)
        for (std::uint32_t y = 0; y < planes.height; ++y) {
            const std::int64_t at = planes.offset + plane * planes.planeStride + y * planes.rowStride;
            checkCl(clEnqueueReadBuffer(device.queue(), planes.memory, CL_FALSE,
                                        std::size_t(at) * sizeof(float), rowBytes, pixels, 0, nullptr,
                                        nullptr),
                    "clEnqueueReadBuffer");
            pixels += planes.width;
        }
    checkCl(clFinish(device.queue()), "clFinish");
}

}  // namespace lightwell
