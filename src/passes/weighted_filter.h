// Weighted sums that neighbouring pixels gathered with different patterns, made means over an edge-aware window.
#pragma once

#include "compute/buffer.h"
#include "compute/executor.h"

namespace lightwell {

class WeightedFilter {
public:
    // light: of radiance (3 planes), seen share, open share and weight; else of open share and weight alone.
    WeightedFilter(Device& device, bool light);

    static std::uint32_t planes(bool light) { return light ? 6 : 2; }

    // Passes "weighted_filter.columns", where patterns differ from row to row, and "weighted_filter.filter" (".columns_ambient",
    // ".filter_ambient" without light). columns, rows: after which patterns repeat, 1 or even. between: scratch planes as
    // gathered, read with rows > 1. Of the results each may be empty.
    void record(Executor& executor, const Planes& position, const Planes& normal, std::uint32_t columns, std::uint32_t rows,
                const Planes& gathered, const Planes& between, const Planes& irradiance, const Planes& validity, const Planes& open);

private:
    bool light_;
    Kernel &columns_, &filter_;
};

}  // namespace lightwell
