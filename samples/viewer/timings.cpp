#include "timings.h"

#include <epoxy/gl.h>

#include <algorithm>

namespace viewer {
namespace {

double millisecondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

double medianOf(std::vector<double> values) {
    if (values.empty()) return 0.0;
    std::sort(values.begin(), values.end());
    const std::size_t middle = values.size() / 2;
    return values.size() % 2 != 0 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

void Timings::beginFrame() {
    current_.clear();
    frameStart_ = stageStart_ = Clock::now();
}

void Timings::endStage(const char* name) {
    glFinish();
    current_.emplace_back(name, millisecondsSince(stageStart_));
    stageStart_ = Clock::now();
}

void Timings::endFrame() {
    current_.emplace_back("", millisecondsSince(frameStart_));
    if (isStale_) frames_.clear();
    isStale_ = false;
    frames_.push_back(current_);
    if (frames_.size() > kept_) frames_.erase(frames_.begin());
}

std::vector<std::pair<std::string, double>> Timings::stages() const {
    std::vector<std::pair<std::string, double>> medians;
    if (frames_.empty()) return medians;
    for (const auto& [name, unused] : frames_.back()) {
        std::vector<double> values;
        for (const Frame& frame : frames_)
            for (const auto& [other, milliseconds] : frame)
                if (other == name) values.push_back(milliseconds);
        if (!name.empty()) medians.emplace_back(name, medianOf(values));
    }
    return medians;
}

double Timings::frameMilliseconds() const {
    std::vector<double> values;
    for (const Frame& frame : frames_) values.push_back(frame.back().second);
    return medianOf(values);
}

}  // namespace viewer
