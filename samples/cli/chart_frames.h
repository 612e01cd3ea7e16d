// Times a technique on one still view: warm, and as many frames as the figures need.
#pragma once

#include "indirect_renderer.h"

namespace cli {

struct FrameLimits {
    int warmUp = 3;              // unmeasured frames, in which caches and clocks settle
    int fewest = 9, most = 200;  // measured ones: at least this many, unless each takes very long
    double seconds = 1.0;        // after which enough frames are enough
    double patience = 6.0;       // after which 3 must do; after three times as long, one; see timeFrames
};

struct TimeFigures {
    double median = -1.0,
           p99 = -1.0;  // ms; p99 by nearest rank: under 100 frames the slowest. < 0: unavailable
};

struct ChartedFrames {
    int frames = 0, warmUp = 0;  // measured, and rendered before these
    TimeFigures wall;            // the host's clock, from the host's images to the host's output
    TimeFigures processor;  // of this process, all its threads together: other load lengthens it less
    TimeFigures device;     // the device's clock
    FrameSample last;
};

TimeFigures summarise(std::vector<double> milliseconds);
// A frame that alone takes longer than the patience is measured cold: what warming up would save is
// small beside it.
ChartedFrames timeFrames(IndirectRenderer& renderer, const RenderInputs& inputs,
                         const FrameLimits& limits);

// The picture that timeFrames ended with, without timing: as many frames, or fewer if they repeat.
void renderAgain(IndirectRenderer& renderer, const RenderInputs& inputs, int frames);

}  // namespace cli
