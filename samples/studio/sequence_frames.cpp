// Frames of a sequence, one after the other.
#include "sequence_parts.h"

namespace studio {

SequenceFrame& addFrame(FailureSequence& sequence, const SequenceSize& size,
                        std::shared_ptr<const Scene> scene, const Camera& camera) {
    SequenceFrame frame;
    frame.scene = std::move(scene);
    frame.time = float(sequence.frames.size());
    frame.camera = camera;
    frame.width = size.width;
    frame.height = size.height;
    frame.reset = frame.isCut = sequence.frames.empty();
    sequence.frames.push_back(std::move(frame));
    return sequence.frames.back();
}

FailureSequence makeFlight(const SequenceSize& size, const std::shared_ptr<Scene>& scene,
                           const std::function<Camera(int frame)>& cameraOf) {
    FailureSequence sequence;
    for (int f = 0; f < size.frames; ++f) addFrame(sequence, size, scene, cameraOf(f));
    return sequence;
}

void sweepLight(Scene& scene, const SequenceSize& size, const std::function<Light(int frame)>& lightOf) {
    setLight(scene, lightOf(0));
    Track<Light> track;
    for (int f = 0; f < size.frames; ++f) track.keys.emplace_back(float(f), lightOf(f));
    scene.lightTracks = {track};
}

Camera cameraOf(const Scene& scene, const char* name) {
    return scene.cameras[std::size_t(scene.findCamera(name))];
}

double shareOf(int frame, const SequenceSize& size) {
    return size.frames > 1 ? double(frame) / double(size.frames - 1) : 0.0;
}

FailureSequence withSamples(int samples, FailureSequence sequence) {
    sequence.truthSamples = samples;
    return sequence;
}

}  // namespace studio
