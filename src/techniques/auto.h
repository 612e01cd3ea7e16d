// Technique "auto": in each frame the technique and parameters that the planner finds best, kept until another is clearly better or the
// budget is broken, with changes cross-faded. docs/techniques/auto.md.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "planner/planner.h"
#include "techniques/technique.h"

namespace lightwell {

const TechniqueEntry& autoEntry();

// What it chooses among, and by what: the planner's tables, or a test's own.
struct AutoPlanner {
    std::vector<Candidate> candidates;
    // Indices are those of `candidates`; quickest first, none where the frame allows none.
    std::function<std::vector<Prediction>(const FrameTraits& traits, const FrameFigures& probes)> predict;
    bool usesProbes = true;
};
std::unique_ptr<Technique> makeAuto(Device& device, const LWAutoDesc& desc, AutoPlanner planner);

}  // namespace lightwell
