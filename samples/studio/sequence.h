// The catalogue of failures: deterministic sequences, each built to provoke one way in which indirect
// light goes wrong over time or in an unusual scene. docs/stability.md describes each.
//
//     for (const SequenceEntry& entry : sequenceCatalogue()) {
//         const FailureSequence sequence = makeSequence(entry.name, {32, 320, 180});
//         for (const SequenceFrame& frame : sequence.frames) ...
//     }
//
// Every sequence moves by fixed steps per frame, so that the first frames of a long one are those of a
// short one; those that sweep a value (wall thickness, the door) cover all of it in whatever frames they
// have.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "ray_scene.h"

namespace studio {

struct SequenceSize {
    int frames = 32, width = 320, height = 180;
};

struct SequenceFrame {
    std::shared_ptr<const Scene> scene;  // in its own unit of length; see FailureSequence::scale
    float time = 0.0f;                   // of the scene's keyframes
    Camera camera;
    int width = 0, height = 0;
    bool reset = false;  // the host tells the technique to forget (the first frame, cuts)
    bool isCut = false;  // nothing of the frame before is to be followed
    double value = 0.0;  // what the sequence sweeps (FailureSequence::sweeps), else 0
};

enum class SequenceTruth {
    Traced,
    Dark,  // exactly 0 everywhere: nothing is lit
};

struct FailureSequence {
    std::string name;
    std::string failure;  // what it provokes, a few words
    std::vector<SequenceFrame> frames;
    // Lengths of what techniques get, against those of `frames`: irradiance does not change with it, so
    // the truth of another scale serves.
    float scale = 1.0f;
    std::string sweeps;  // what SequenceFrame::value is, with its unit; "" = nothing
    SequenceTruth truth = SequenceTruth::Traced;
    // Paths per pixel of the truth, of both halves together: what keeps its floors low enough here.
    int truthSamples = 32;
    // Sample points shared by all pixels of the truth, which keep the noise of surfaces at rest still.
    // Where all light changes from frame to frame nothing is kept, and what pixels share adds up in
    // means over the picture (drift) and its tiles (spike): there each pixel has its own.
    bool truthSharesPoints = true;
    // 1 in the sealed room, 2 lit and outside, 0 neither; null: no sealed room. Positions in the
    // frames' own unit.
    std::function<std::uint8_t(const SequenceFrame& frame, const glm::vec3& position)> region;
};

struct SequenceEntry {
    std::string name, failure;
    bool quick = false;  // in the short catalogue
};
const std::vector<SequenceEntry>& sequenceCatalogue();

// Throws std::invalid_argument naming the valid names, or the size that cannot be.
FailureSequence makeSequence(const std::string& name, const SequenceSize& size);

// The movements that any scene can be put through (sequence_movements.cpp), by its first camera and its
// lights: camera_pan, camera_dolly, light_sweep_slow.
const std::vector<SequenceEntry>& sceneMovements();
// Named "<scene's name>.<movement>". Throws std::invalid_argument naming the valid movements, the size
// that cannot be, or what the scene lacks: a light, surfaces in view, room to move.
FailureSequence makeMovement(const Scene& scene, const std::string& movement, const SequenceSize& size);

// What each pixel of a frame shows, to follow it to the next one.
struct SeenFrame {
    int width = 0, height = 0;
    std::vector<std::uint8_t> surface;
    std::vector<int> mesh;  // -1: none
    std::vector<glm::vec3> position, normal;
};
SeenFrame seeFrame(const RayScene& scene, const SequenceFrame& frame);

// StabilityFrame::previous of `frame`: NaN where the pixel's surface point was not visible in `before`.
// `scene` stands at frame.time.
std::vector<glm::vec2> previousPositions(const RayScene& scene, const SequenceFrame& frame,
                                         const SequenceFrame& before, const SeenFrame& beforeSeen);

}  // namespace studio
