// Axes and units of length that hosts exchange.
#include <cmath>

#include "inputs/input_check_parts.h"

namespace lightwell {

const std::vector<AxesChange>& axesChanges() {
    // Columns: where x, y and z go.
    static const std::vector<AxesChange> changes = {
        {"z has the other sign (the other handedness)", glm::dmat3(1, 0, 0, 0, 1, 0, 0, 0, -1)},
        {"x has the other sign (the other handedness)", glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, 1)},
        {"y has the other sign", glm::dmat3(1, 0, 0, 0, -1, 0, 0, 0, 1)},
        {"z is up in one and y in the other", glm::dmat3(1, 0, 0, 0, 0, -1, 0, 1, 0)},
        {"y is up in one and z in the other", glm::dmat3(1, 0, 0, 0, 0, 1, 0, -1, 0)},
        {"y and z are exchanged", glm::dmat3(1, 0, 0, 0, 0, 1, 0, 1, 0)},
    };
    return changes;
}

const char* lengthFactorName(double factor) {
    static constexpr struct {
        double factor;
        const char* name;
    } kNames[] = {{100.0, "metres for centimetres"},
                  {0.01, "centimetres for metres"},
                  {1000.0, "metres for millimetres"},
                  {0.001, "millimetres for metres"},
                  {10.0, "ten times"},
                  {0.1, "a tenth"},
                  {2.54, "inches for centimetres"},
                  {1 / 2.54, "centimetres for inches"},
                  {0.0254, "inches for metres"},
                  {1 / 0.0254, "metres for inches"},
                  {0.3048, "feet for metres"},
                  {1 / 0.3048, "metres for feet"}};
    for (const auto& known : kNames)
        if (std::abs(factor / known.factor - 1.0) < 0.03) return known.name;
    return nullptr;
}

}  // namespace lightwell
