// Rows of an image shared out to all cores. Each row is computed by one thread from its index alone,
// so results do not depend on how many threads there are.
#pragma once

#include <functional>

namespace studio {

// Calls body(row) for each row in [0, rows); rethrows the first exception of a body.
void parallelRows(int rows, const std::function<void(int)>& body);

}  // namespace studio
