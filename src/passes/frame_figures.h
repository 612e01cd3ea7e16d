// What is measured of a frame in order to plan for it.
#pragma once

#include <limits>

#include "lightwell/lightwell.h"

namespace lightwell {

// What predicts errors, and what predicts times alone.
struct FrameFigures : LWPlanProbes {
    float coverage = std::numeric_limits<float>::quiet_NaN();  // share of the view's pixels that show a surface; NaN: not known

    FrameFigures() : LWPlanProbes{} {}
    FrameFigures(const LWPlanProbes& probes) : LWPlanProbes(probes) {}  // not explicit: errors' figures are known without
};

}  // namespace lightwell
