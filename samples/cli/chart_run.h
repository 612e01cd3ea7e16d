// Measures what a chart shows into results.json.
#pragma once

#include <string>
#include <vector>

#include "chart_frames.h"
#include "chart_view.h"

namespace cli {

struct ChartOptions {
    std::vector<std::string> scenes, techniques;
    std::vector<std::string> only;  // "key=value": of techniques with this parameter, only such points
    std::string folder, device;
    int width = 1280, height = 720;
    int deviceWidth = 0;  // lanes per work-item; 0: by probe
    int frames = 0;       // measured ones of each point; 0: enough for steady figures
    int warmUp = FrameLimits{}.warmUp;  // unmeasured ones before
    bool quick = false, firstCameraOnly = false, onlyTruths = false, skipsAllBounces = false;
    TruthOptions truth;
};

// Interrupted (interrupt.h) between two points or passes of a truth, with everything saved.
void runChart(const ChartOptions& options);

}  // namespace cli
