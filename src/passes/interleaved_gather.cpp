#include "passes/interleaved_gather.h"

#include <string>

#include "compute/device.h"

namespace lightwell {
namespace {

// Rows of work-items; small groups keep both cores busy on a CPU, and 64 lanes of a GPU full.
Range groupOf(const Kernel& kernel) { return kernel.width() == 1 ? Range{64, 1} : Range{8, 1}; }

Range itemsOver(const Planes& image, std::uint32_t pixelsPerItem) {
    return {(image.width + pixelsPerItem - 1) / pixelsPerItem, image.height};
}

Defines definesOf(std::uint32_t interleave) { return {{"LW_INTERLEAVE", std::to_string(interleave)}}; }

}  // namespace

InterleavedGather::InterleavedGather(Device& device, std::uint32_t interleave)
    : interleave_(interleave),
      gather_(device.programs().kernel("interleaved_gather/interleaved_gather", "interleaved_gather_gather",
                                       definesOf(interleave))),
      validity_(device.programs().kernel("interleaved_gather/interleaved_gather", "interleaved_gather_validity",
                                         definesOf(interleave))) {
    if (interleave > 1)
        filter_ = &device.programs().kernel("interleaved_gather/interleaved_filter", "interleaved_gather_filter",
                                            definesOf(interleave));
}

void InterleavedGather::recordGather(Executor& executor, const Planes& position, const Planes& normal,
                                     const Buffer& vpls, lw_subset_order order, const Planes& irradiance,
                                     const Buffer& counts) {
    executor.run("interleaved_gather.gather", gather_, itemsOver(position, gather_.width() * interleave_),
                 groupOf(gather_), position, normal, cl_int(position.width), cl_int(position.height), vpls, order,
                 irradiance, counts);
}

void InterleavedGather::recordFilter(Executor& executor, const Planes& position, const Planes& normal,
                                     const Planes& irradiance, const Planes& filtered) {
    executor.run("interleaved_gather.filter", *filter_, itemsOver(position, filter_->width()), groupOf(*filter_),
                 position, normal, cl_int(position.width), cl_int(position.height), irradiance, filtered);
}

void InterleavedGather::recordValidity(Executor& executor, const Planes& position, const Planes& normal,
                                       const Planes& validity) {
    executor.run("interleaved_gather.validity", validity_, itemsOver(position, validity_.width()),
                 groupOf(validity_), position, normal, cl_int(position.width), cl_int(position.height), validity);
}

}  // namespace lightwell
