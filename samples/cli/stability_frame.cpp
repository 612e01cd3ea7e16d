#include "stability_frame.h"

#include <limits>

#include "path_tracer.h"

namespace cli {

using studio::SequenceFrame;

FrameScene::FrameScene(const SequenceFrame& sequenceFrame)
    : frame(sequenceFrame),
      scene(std::make_unique<studio::RayScene>(frame.scene, frame.time)),
      seen(studio::seeFrame(*scene, frame)) {}

studio::StabilityFrame frameToJudge(const studio::FailureSequence& sequence, const FrameScene& now,
                                    const FrameScene* before) {
    studio::StabilityFrame judged;
    judged.width = now.frame.width;
    judged.height = now.frame.height;
    judged.surface = now.seen.surface;
    judged.isCut = now.frame.isCut;
    const std::size_t count = judged.surface.size();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    judged.previous = before == nullptr ? std::vector<glm::vec2>(count, glm::vec2(nan))
                                        : studio::previousPositions(*now.scene, now.frame, before->frame,
                                                                    before->seen);
    if (!sequence.region) return judged;
    judged.region.assign(count, 0);
    for (std::size_t i = 0; i < count; ++i)
        if (judged.surface[i] != 0) judged.region[i] = sequence.region(now.frame, now.seen.position[i]);
    return judged;
}

SequenceGuide::SequenceGuide(const studio::FailureSequence& sequence) {
    const SequenceFrame& middle = sequence.frames[sequence.frames.size() / 2];
    scene = std::make_unique<studio::RayScene>(middle.scene, middle.time);
    points = studio::makeGuide(*scene, studio::renderGBuffer(*scene, middle.camera, middle.width,
                                                             middle.height, middle.camera, middle.time));
}

}  // namespace cli
