// Measures the error split of VPL techniques (studio's error_split.h) into split.json.
#pragma once

#include <string>
#include <vector>

#include "chart_view.h"

namespace cli {

struct SplitOptions {
    std::vector<std::string> scenes, techniques;
    std::vector<std::string> only;  // as in a chart; empty: defaults and named settings
    std::string folder, device;
    int width = 1280, height = 720;
    int deviceWidth = 0;  // lanes per work-item; 0: by probe
    int patterns = 4;     // seeds that the sampling's share is estimated from
    bool firstCameraOnly = false, skipsAllBounces = false;
    TruthOptions truth;
};

// Techniques without a debug view "vpls" are passed over with a note. Interrupted (interrupt.h) between
// two pictures or passes of a truth, with everything saved.
void runSplit(const SplitOptions& options);

}  // namespace cli
