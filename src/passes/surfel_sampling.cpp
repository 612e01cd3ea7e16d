#include "passes/surfel_sampling.h"

#include <cmath>

#include "compute/device.h"
#include "inputs/image_access.h"

namespace lightwell {

SurfelSampling::SurfelSampling(Device& device)
    : draw_(device.programs().kernel("surfel_sampling/surfel_sampling", "surfel_sampling_draw")) {}

void SurfelSampling::record(Executor& executor, const GeometryInput& geometry, std::uint32_t count) {
    if (geometry.revision == drawnRevision_) return;
    Device& device = executor.device();
    if (geometry.triangleCount == 0) count = 0;
    drawnRevision_ = 0;
    memory_.reset(executor, count, LW_SURFEL_PLANES);
    memory_.setDiagonal(executor, geometry.diagonal);
    if (count) {
        const std::size_t bytes = geometry.areaShares.size() * sizeof(std::uint32_t);
        shares_.reserve(device, bytes, "the triangles' shares of the area");
        executor.writeCopy("surfel_sampling.upload", shares_, 0, bytes, geometry.areaShares.data());
        int steps = 0;
        while ((std::uint64_t(1) << steps) < geometry.triangleCount) ++steps;
        int shift = 0;
        while ((std::uint64_t(count) << (shift + 1)) <= (std::uint64_t(1) << 32)) ++shift;
        const auto scale = cl_uint((std::uint64_t(1) << 63) / (std::uint64_t(count) << shift));
        const double radius = std::sqrt(geometry.area / (double(count) * 3.14159265358979323846));
        const Planes& planes = memory_.planes();
        executor.run("surfel_sampling.draw", draw_, rowGrid(device, planes.width, 1), rowGroup(device),
                     geometry.triangles.memory, cl_int(geometry.triangles.planeStride), shares_,
                     cl_int(geometry.triangleCount), cl_int(steps), scale, cl_int(shift), cl_float(radius), cl_int(count), planes.memory,
                     cl_int(planes.planeStride));
    }
    memory_.noteChange();
    drawnRevision_ = geometry.revision;
}

std::uint64_t SurfelSampling::estimateBytes(std::uint32_t triangleCount, std::uint32_t count) {
    return SurfelMemory::estimateBytes(count, LW_SURFEL_PLANES) + std::uint64_t(triangleCount) * sizeof(std::uint32_t);
}

}  // namespace lightwell
