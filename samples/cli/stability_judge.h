// Indices and errors of one technique over one sequence, as stability.json states them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "stability_indices.h"
#include "stability_truth.h"

namespace cli {

// What a technique made of one frame.
struct JudgedFrame {
    studio::StabilityFrame frame;  // image: with values that are not finite set to 0, and counted
    std::shared_ptr<const FrameTruth> truth;
    std::size_t notFinite = 0;
    float largest = 0.0f;  // of the image's absolute values
    double milliseconds = -1.0;
};

// Errors of one image against a truth on the pixels with surfaces; docs/accuracy.md states each.
struct FrameErrors {
    double relMse = 0.0, nrmse = 0.0, bias = 0.0;
};
// Empty for a truth without any light, which they are relative to.
std::optional<FrameErrors> frameErrors(const studio::StabilityFrame& frame);

struct Verdict {
    studio::StabilityIndices indices, floors;
    // Of each frame; of one reference by the other.
    std::vector<std::optional<FrameErrors>> errors, noise;
    nlohmann::ordered_json toJson(const std::vector<JudgedFrame>& frames) const;
};
Verdict judgeSequence(const std::vector<JudgedFrame>& frames);

}  // namespace cli
