// One frame of a sequence before any technique has seen it: its scene, what each pixel shows, where that
// was in the frame before.
#pragma once

#include <memory>

#include "lit_points.h"
#include "sequence.h"
#include "stability_indices.h"

namespace cli {

// What two neighbouring frames need of each other.
struct FrameScene {
    studio::SequenceFrame frame;
    std::unique_ptr<studio::RayScene> scene;
    studio::SeenFrame seen;

    explicit FrameScene(const studio::SequenceFrame& sequenceFrame);
};

// Everything that the indices need but image and truth. `before`: null for the first frame.
studio::StabilityFrame frameToJudge(const studio::FailureSequence& sequence, const FrameScene& now,
                                    const FrameScene* before);

// The choice of lit points that all truths of a sequence share: that of its middle frame.
struct SequenceGuide {
    std::unique_ptr<studio::RayScene> scene;  // `points` refers to it
    std::unique_ptr<studio::LitPoints> points;

    explicit SequenceGuide(const studio::FailureSequence& sequence);
};

}  // namespace cli
