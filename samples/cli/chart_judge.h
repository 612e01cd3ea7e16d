// Errors of a charted picture against the truths of its view, and what the report shows of it.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "chart_view.h"

namespace cli {

// No figure is trusted where the truth's own noise exceeds this share of it.
constexpr double kNoiseShare = 0.1;

struct JudgedPicture {
    studio::Image irradiance;  // R, G, B
    int bounces = 1;           // that the technique models
    bool knowsPictureOnly = false;
    std::string imageName;     // of the previews, without folder and extension
};

// "own": against the truth of as many bounces as the technique models; "all" against all bounces, of the
// irradiance alone; "screen": of a technique of the picture alone, against the light of what the view
// shows; null where the view has no such truth, or a black one; "images": previews written below
// `folder`. Touches nothing shared: pictures of one view may be judged in parallel.
nlohmann::ordered_json judge(const JudgedPicture& picture, const ChartView& view,
                             const std::string& folder);

// The view's own pictures: its truths, and direct light alone.
nlohmann::ordered_json writeViewPictures(const ChartView& view, const std::string& folder);

}  // namespace cli
