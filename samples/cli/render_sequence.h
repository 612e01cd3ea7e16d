// What a host hands over frame after frame of a scene that may move.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render_inputs.h"

namespace cli {

struct SequenceOptions {
    std::string camera;  // by name; "": the scene's first
    std::vector<std::string> sources;  // further source views: cameras by name
    double time = 0.0;   // s, of the last frame
    double step = 0.0;   // s from frame to frame; 0: one picture at rest for all frames
    int frames = 1;
    InputOptions inputs;  // size and RSMs; times and cameras are the sequence's
};

// Frame f of n is at time - (n - 1 - f) step; its motion vectors and previous camera are those of one
// step earlier, of the first frame too.
class Sequence {
public:
    Sequence(std::shared_ptr<const studio::Scene> scene, const SequenceOptions& options);
    // Good until another frame is asked for. UsageError where the scene has no picture at its time.
    const RenderInputs& at(int frame);
    const RenderInputs& last() { return at(options_.frames - 1); }

private:
    studio::Camera cameraAt(int camera, float time) const;

    std::shared_ptr<const studio::Scene> scene_;
    SequenceOptions options_;
    int camera_ = 0, frame_ = 0;
    std::vector<int> sources_;
    std::unique_ptr<studio::RayScene> rayScene_;
    std::unique_ptr<RenderInputs> inputs_;  // of rayScene_
};

}  // namespace cli
