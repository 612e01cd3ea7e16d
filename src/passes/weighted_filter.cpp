#include "passes/weighted_filter.h"

#include "compute/device.h"

namespace lightwell {

WeightedFilter::WeightedFilter(Device& device, bool light)
    : light_(light),
      filter_(device.programs().kernel("weighted_filter/weighted_filter", "weighted_filter_filter",
                                       {{"LW_LIGHT", light ? "1" : "0"}})) {}

void WeightedFilter::record(Executor& executor, const Planes& position, const Planes& normal, std::uint32_t columns,
                            std::uint32_t rows, const Planes& gathered, const Planes& irradiance, const Planes& validity,
                            const Planes& open) {
    const Range items{(gathered.width + filter_.width() - 1) / filter_.width(), gathered.height};
    executor.run(light_ ? "weighted_filter.filter" : "weighted_filter.filter_ambient", filter_, items,
                 filter_.width() == 1 ? Range{64, 1} : Range{8, 1}, position, normal, cl_int(gathered.width),
                 cl_int(gathered.height), cl_int(columns), cl_int(rows), gathered, irradiance, validity, open);
}

}  // namespace lightwell
