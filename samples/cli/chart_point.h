// A point of a chart: a technique with one set of parameters, and its times in one view.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "chart_frames.h"
#include "chart_view.h"
#include "sweep.h"

namespace cli {

struct ChartedPoint {
    std::string technique;
    SweepPoint sweep;
};

// The sweeps of the techniques, and single points of those that are named with parameters
// ("rsm,vpls=64"). `only`: "key=value,value": of points with this parameter, those alone that have such
// a value. UsageError where an entry picks nothing of any technique.
std::vector<ChartedPoint> chartedPoints(const std::vector<std::string>& techniques, bool quick,
                                        const std::vector<std::string>& only);

std::string pointId(const ChartView& view, const ChartedPoint& point);

// Warms up, times, and describes the point but for its errors; `renderer` holds the last picture.
nlohmann::ordered_json timePoint(const ChartView& view, const ChartedPoint& point,
                                 IndirectRenderer& renderer, const FrameLimits& limits);

}  // namespace cli
