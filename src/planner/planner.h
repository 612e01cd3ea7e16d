// The planner: which technique, with which parameters, for what a frame brings and what may be spent.
//
//     const FrameTraits traits = traitsOf(frame, gbuffer, pixels, views);     // what is possible, and how large
//     const FrameFigures probes = ...;                                        // frame_probing.h
//     const Choice choice = choose(predict(calibrationOf(device), traits, probes), budget, target);
//
// Pure arithmetic but for probes and calibration; docs/planner.md derives it. The tables stand in plan_tables.h, written by
// docs/figures/planner.py.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lightwell/lightwell.h"
#include "passes/frame_figures.h"

namespace lightwell {

class Device;

// What a frame brings and how large it is: all that decides what is possible and what it costs.
struct FrameTraits {
    double pixels = 0.0;     // of a view
    std::uint32_t views = 1;
    double rsmTexels = 0.0;  // of all RSMs
    double triangles = 0.0, surfels = 0.0;
    std::uint32_t lights = 0, staticVpls = 0;
    bool hasRsms = false, hasVpls = false, hasDirectRadiance = false, hasAlbedo = false, hasCamera = false, hasMotion = false, hasViews = false;
    bool isAtRest = false;   // light and geometry stand still, and the host tells so; traitsOf knows no frame before
    bool hasMoved = false;   // lights or geometry, since the frame before: maps are drawn anew; traitsOf knows no frame before
};
// Checks nothing: the arguments are checked by who records or plans.
FrameTraits traitsOf(const LWFrame& frame, const LWGBuffer& gbuffer, double pixels, std::uint32_t views);
// Whether a camera is given: not all of its numbers are 0.
bool hasCamera(const LWGBuffer& gbuffer);

// Rates of this device against those of the one that the cost tables were measured on.
struct Calibration {
    double computeScale = 1.0, memoryScale = 1.0, launchScale = 1.0;  // times as long as there
};
// Measured in less than two seconds when the device is first asked, then kept with it and in its cache directory.
Calibration calibrationOf(Device& device);

// A technique with parameters that the planner knows times and errors of.
struct Candidate {
    const char* technique;
    const char* settings;  // as lwCreateTechniqueFromText takes them
};
const std::vector<Candidate>& candidates();

struct Prediction {
    std::size_t candidate = 0;  // index
    double milliseconds = 0.0;
    double error = 0.0;         // relMSE against all bounces
    double confidence = 0.0;    // that the true error is within a factor of two
};
// Of all candidates that the frame allows, quickest first; none where it allows none.
std::vector<Prediction> predict(const Calibration& calibration, const FrameTraits& traits, const FrameFigures& probes);
// What the frame lacks for the others: "RSMs, static VPLs"; "" where it allows all.
std::string missingFor(const FrameTraits& traits);

struct Choice {
    Prediction prediction;
    bool isWithinBudget = true, reachesError = true;
    std::string reason;  // a sentence
};
// `predictions`: not empty, quickest first. A budget or target of 0: none.
Choice choose(const std::vector<Prediction>& predictions, double budgetMilliseconds, double errorTarget);

}  // namespace lightwell
