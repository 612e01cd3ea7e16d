#include "passes/weighted_filter.h"

#include "compute/device.h"

namespace lightwell {
namespace {

Kernel& kernelOf(Device& device, const char* name, bool light) {
    return device.programs().kernel("weighted_filter/weighted_filter", name, {{"LW_LIGHT", light ? "1" : "0"}});
}

Range itemsOver(const Planes& image, const Kernel& kernel) {
    return {(image.width + kernel.width() - 1) / kernel.width(), image.height};
}

Range groupOf(const Kernel& kernel) { return kernel.width() == 1 ? Range{64, 1} : Range{8, 1}; }

}  // namespace

WeightedFilter::WeightedFilter(Device& device, bool light)
    : light_(light),
      columns_(kernelOf(device, "weighted_filter_columns", light)),
      filter_(kernelOf(device, "weighted_filter_filter", light)) {}

void WeightedFilter::record(Executor& executor, const Planes& position, const Planes& normal, std::uint32_t columns,
                            std::uint32_t rows, const Planes& gathered, const Planes& between, const Planes& irradiance,
                            const Planes& validity, const Planes& open) {
    const cl_int width = cl_int(gathered.width), height = cl_int(gathered.height);
    if (rows > 1)
        executor.run(light_ ? "weighted_filter.columns" : "weighted_filter.columns_ambient", columns_, itemsOver(gathered, columns_),
                     groupOf(columns_), position, normal, width, height, cl_int(rows), gathered, between);
    executor.run(light_ ? "weighted_filter.filter" : "weighted_filter.filter_ambient", filter_, itemsOver(gathered, filter_),
                 groupOf(filter_), position, normal, width, height, cl_int(columns), rows > 1 ? between : gathered, irradiance,
                 validity, open);
}

}  // namespace lightwell
