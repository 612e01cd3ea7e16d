// Measures what a technique of clustered VPLs takes to be visible against rays (studio's
// visibility_judge.h).
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "chart_view.h"
#include "parameters.h"
#include "visibility_judge.h"

namespace cli {

struct VisibilityOptions {
    ViewOptions view;
    std::string technique = "ssvp", device;
    std::vector<std::string> assignments;  // key=value, of every point
    std::vector<std::string> sweeps;       // key=value,value: every combination is a point
    int deviceWidth = 0;                   // lanes per work-item; 0: by probe
    bool skipsTruth = false;               // no path tracing, no relMSE against it
    TruthOptions truth;
};

// Debug views by which the command knows a technique with clusters.
constexpr const char* kClustersView = "clusters";
constexpr const char* kVplClustersView = "vpl_clusters";
constexpr const char* kVisibilityView = "visibility";

// The points' parameters, with whatever coarsens the picture or goes beyond the pairs of one bounce off.
// UsageError for assignments that the technique refuses or that are fixed here.
std::vector<Parameters> visibilityPoints(const VisibilityOptions& options);

struct VisibilityResult {
    nlohmann::ordered_json json;
    studio::VisibilityVerdict last;  // of the last point, at the judged pixels
};

// UsageError where the technique has not the debug views.
VisibilityResult runVisibility(const VisibilityOptions& options, const std::vector<Parameters>& points);

}  // namespace cli
