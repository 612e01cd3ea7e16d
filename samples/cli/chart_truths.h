// What a chart's results say of a view and of the truths that its points are judged by.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "chart_view.h"
#include "parameters.h"

namespace cli {

// The view's entry in results.json; writes the pictures that it names below `folder`.
nlohmann::ordered_json describeView(const ChartView& view, const std::string& folder);
// For whoever waits: samples and noise of each truth.
std::string truthNote(const ChartView& view);
// The truths that a technique with these parameters is judged by, so that better ones are noticed.
std::string truthNames(const ChartView& view, const Parameters& parameters);

}  // namespace cli
