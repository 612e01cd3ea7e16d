// How a technique behaves from frame to frame, against the truth of every frame: flicker, ghosts, leaks,
// drift, spikes. docs/stability.md states each formula, its range and what it is blind to.
//
// Approximations: a surface point is followed from frame to frame to the pixel that it falls in, not
// between pixels. Weights of several pixels would average a technique's noise away wherever the picture
// moves by parts of a pixel, and call the same noise steadier in motion than at rest. Image and truth
// are read at the same pixels, so an image that equals the truth has no flicker, however it moves.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

namespace studio {

// One frame of a sequence. Images are planes R,G,B, rows top to bottom.
struct StabilityFrame {
    int width = 0, height = 0;
    std::vector<float> image;           // 3 planes, W/m^2, the technique's
    std::vector<float> truth;           // 3 planes, W/m^2
    std::vector<std::uint8_t> surface;  // per pixel, 1: shows a surface
    // Per pixel, where its surface point stood in the previous frame (pixels, centres at +0.5). NaN, or
    // outside that frame, or on a pixel of it that shows no surface: it was not visible there, that is,
    // the pixel is revealed. So is all of the first frame, of a cut, and after a change of size. The
    // pixel that it falls in must show the same surface: at silhouettes the maker of the sequence
    // compares positions and gives NaN where they differ.
    std::vector<glm::vec2> previous;
    std::vector<std::uint8_t>
        region;  // empty, or per pixel, 1: in the sealed room, 2: lit, outside, 0: neither
    bool isCut = false;
};

enum class StabilityReason { None, Error, Flicker, Ghost, Leak, Drift, Spike };
const char* stabilityReasonName(StabilityReason reason);

// One frame's share in the indices; empty where it has none (nothing matched, no region ...).
struct FrameIndices {
    double error = 0.0;             // mean of |F-R| over the frame's scale
    double bias = 0.0;              // mean of F-R over the frame's scale
    std::optional<double> flicker;  // against the frame before
    std::optional<double> ghost;    // of what changed kGhostAge frames before
    std::optional<double> leak;
    std::optional<double> drift;  // median of the relative bias around it, less the first frames'
    std::optional<double> spike;  // the worst tile's
};

// An index is empty where the sequence has nothing to judge it by.
struct StabilityIndices {
    double error = 0.0, bias = 0.0;  // means over the frames; what the indices are blind to
    std::optional<double> flicker, ghost, leak, drift, spike;
    int worstFrame = 0;
    StabilityReason worstReason = StabilityReason::None;
    std::vector<FrameIndices> frames;
};

constexpr int kGhostAge = 2;     // frames after a change, when an image should have followed it
constexpr int kSettledAge = 12;  // frames after it, when it counts as settled

// What a viewer begins to notice in one frame, roughly: weighs the indices against each other to name a
// sequence's worst frame. Flicker and spike alike: what differs in one frame only is a spike.
struct StabilityNoticeable {
    double spike = 0.25, flicker = 0.25, ghost = 1.0, leak = 0.01, drift = 0.1;
};

// All indices are relative to the truth's mean light: the unit of light does not matter, and lightless
// sequences give finite values. Throws std::invalid_argument naming frame and plane when sizes do not
// fit or a surface's light is NaN or infinite.
StabilityIndices stabilityIndices(const std::vector<StabilityFrame>& frames);

}  // namespace studio
