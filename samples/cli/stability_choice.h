// Which sequences `lightwell stability` goes through: the catalogue's, movements of scenes, or both.
#pragma once

#include <string>
#include <vector>

#include "sequence.h"

namespace cli {

struct SequenceChoice {
    std::string scene;     // name or path; "": of the catalogue
    std::string name;      // of the sequence, or of the scene's movement
    std::string argument;  // that asked for it, as errors name it
};

// From --scenes and --sequences:
//   neither              the catalogue; the short one with `quick`
//   --sequences only     each "NAME" of the catalogue or "SCENE.MOVEMENT"
//   --scenes only        all movements of each scene
//   both                 these movements of each scene
// UsageError naming the argument that is neither.
std::vector<SequenceChoice> chooseSequences(const std::vector<std::string>& scenes,
                                            const std::vector<std::string>& sequences, bool quick);

// Loads each scene once. UsageError naming the argument where a scene can't be moved through.
std::vector<studio::FailureSequence> makeSequences(const std::vector<SequenceChoice>& choices,
                                                   const studio::SequenceSize& size);

}  // namespace cli
