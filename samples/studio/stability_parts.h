// The parts of stabilityIndices that are long enough for files of their own. Each fills its index and
// its share of every frame; `result.frames` has the sequence's length.
#pragma once

#include <algorithm>
#include <vector>

#include "stability_sequence.h"

namespace studio {

void findGhost(const StabilitySequence& sequence, StabilityIndices& result);
void findSpike(const StabilitySequence& sequence, StabilityIndices& result);

// Of at least one value.
inline double median(std::vector<double> values) {
    const std::size_t middle = values.size() / 2;
    std::sort(values.begin(), values.end());
    return values.size() % 2 != 0 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

}  // namespace studio
