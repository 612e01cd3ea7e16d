// A frame's time by stages, on the host's clock. Drivers draw later than they are told to, so each stage ends by waiting
// for OpenGL: on a GPU that costs some ten microseconds a stage, and nothing overlaps.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace viewer {

class Timings {
public:
    void beginFrame();
    void endStage(const char* name);  // of what was done since the last stage's end
    void endFrame();
    // Medians over the last `kept` frames.
    std::vector<std::pair<std::string, double>> stages() const;
    double frameMilliseconds() const;
    void restart() { isStale_ = true; }  // the next frame takes the place of all before it, which settled caches
    std::size_t frameCount() const { return frames_.size(); }
    void keep(std::size_t frames) { kept_ = frames; }

private:
    using Clock = std::chrono::steady_clock;
    using Frame = std::vector<std::pair<std::string, double>>;
    Frame current_;
    std::vector<Frame> frames_;
    std::size_t kept_ = 30;
    bool isStale_ = false;
    Clock::time_point frameStart_, stageStart_;
};

double medianOf(std::vector<double> values);  // 0 of none

}  // namespace viewer
