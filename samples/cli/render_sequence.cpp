#include "render_sequence.h"

#include "cli.h"
#include "ray_scene.h"

namespace cli {

Sequence::Sequence(std::shared_ptr<const studio::Scene> scene, const SequenceOptions& options)
    : scene_(std::move(scene)),
      options_(options),
      camera_(asUsage([&] { return scene_->findCamera(options.camera); })) {
    for (const std::string& name : options.sources)
        sources_.push_back(asUsage([&] { return scene_->findCamera(name); }));
}

studio::Camera Sequence::cameraAt(int camera, float time) const {
    return asUsage([&] { return scene_->cameraAt(camera, time); });
}

const RenderInputs& Sequence::at(int frame) {
    if (inputs_ != nullptr && (options_.step == 0.0 || frame == frame_)) return *inputs_;
    inputs_.reset();  // one frame's memory at a time
    frame_ = frame;
    const double time = options_.time - options_.step * (options_.frames - 1 - frame);
    InputOptions inputs = options_.inputs;
    inputs.time = float(time);
    inputs.previousTime = float(time - options_.step);
    const studio::Camera camera = cameraAt(camera_, inputs.time),
                         before = cameraAt(camera_, inputs.previousTime);
    for (const int source : sources_)
        inputs.sources.emplace_back(cameraAt(source, inputs.time),
                                    cameraAt(source, inputs.previousTime));
    inputs.previousCamera = &before;
    rayScene_ = asUsage([&] { return std::make_unique<studio::RayScene>(scene_, inputs.time); });
    inputs_ = std::make_unique<RenderInputs>(*rayScene_, camera, inputs);
    return *inputs_;
}

}  // namespace cli
