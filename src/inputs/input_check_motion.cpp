// Motion vectors against the cameras: a surface at rest was, in the previous frame, where the previous
// camera projects it. Moving objects differ, but not all in the way that a sign or a unit does.
#include <algorithm>
#include <cmath>

#include "inputs/input_check_parts.h"

namespace lightwell {
namespace {

// Motion that is wrong by less goes unseen: jitter, rounding, and a tenth for what turns while it moves.
constexpr double kAbsolutePixels = 0.5, kRelative = 0.1;
// Shorter true motion decides nothing.
constexpr double kShortest = 1.0;
constexpr std::uint64_t kFewest = 64;
// The surfaces at rest are at least this share of those that the camera's motion moves; a guess must
// reach it and be clearly better.
constexpr double kRestingShare = 0.5, kClearlyBetter = 0.3;
// Share of vectors that are zero, or that move without a camera's motion, from which objects are no
// excuse.
constexpr double kNearlyAll = 0.95;
constexpr double kStaticMotion = 0.25;  // pixels

struct Guess {
    LWInputFault fault;
    glm::dvec2 factor;  // what makes pixels, previous less current, +y down, of what came
    const char* text;
};

struct Sample {
    glm::dvec2 given, expected;
    std::uint32_t pixel;
};

std::uint64_t matches(const std::vector<Sample>& samples, const glm::dvec2& factor) {
    std::uint64_t count = 0;
    for (const Sample& sample : samples)
        count += glm::length(sample.given * factor - sample.expected) <=
                 kAbsolutePixels + kRelative * glm::length(sample.expected);
    return count;
}

// Cameras at rest: no pixel of a resting surface moves.
void checkStatic(const Surfaces& s, const std::vector<Sample>& still, Findings& findings) {
    std::uint64_t moving = 0;
    double longest = 0.0;
    for (const Sample& sample : still) {
        moving += glm::length(sample.given) > kStaticMotion;
        longest = std::max(longest, glm::length(sample.given));
    }
    if (still.size() < kFewest || shareOf(moving, still.size()) < kNearlyAll) return;
    Found& f = findings.add(
        LW_FAULT_MOTION_STATIC, LW_SEVERITY_WARNING, s.argument("motion"),
        {moving, still.size(), longest, 0.0, 0.8}, percent(moving, still.size()),
        " of the pixels move (by up to ", longest,
        " pixels) while camera and previousCamera are equal: keep the last frame's camera for "
        "previousCamera");
    for (const Sample& sample : still) f.pixels.push_back(sample.pixel);
    f.step = s.step;
}

}  // namespace

void checkMotion(const Surfaces& s, Findings& findings) {
    if (!s.motion || !s.camera || !s.previous || !s.trusted) return;
    std::vector<Sample> moved, still;
    std::vector<double> lengths, expected;
    s.sample([&](std::uint32_t x, std::uint32_t y) {
        const glm::dvec2 given(double(s.motion.at(x, y, 0)), double(s.motion.at(x, y, 1)));
        glm::dvec2 before;
        if (!s.surface(x, y) || !std::isfinite(given.x) || !std::isfinite(given.y)) return;
        if (!s.previous->project(s.position.triple(x, y), before)) return;  // it was behind the camera
        const Sample sample{given, before - glm::dvec2(x + 0.5, y + 0.5), y * s.width + x};
        if (glm::length(sample.expected) >= kShortest) {
            moved.push_back(sample);
            lengths.push_back(glm::length(given));
            expected.push_back(glm::length(sample.expected));
        } else {
            still.push_back(sample);
        }
    });
    const std::uint64_t all = moved.size();
    if (all < kFewest || all < still.size() / 16) {
        bool equal = true;
        for (int k = 0; k < 16; ++k)
            equal = equal && s.matrices->view[k] == s.previousMatrices->view[k] &&
                    s.matrices->projection[k] == s.previousMatrices->projection[k];
        if (equal) checkStatic(s, still, findings);
        return;
    }
    const std::uint64_t good = matches(moved, glm::dvec2(1.0));
    if (shareOf(good, all) >= kRestingShare) return;

    const double w = s.width, h = s.height;
    const Guess guesses[] = {
        {LW_FAULT_MOTION_SIGN,
         {-1, -1},
         "its sign is turned: Lightwell wants the previous position less this one; or camera "
         "and previousCamera are exchanged"},
        {LW_FAULT_MOTION_FLIPPED_Y, {1, -1}, "its y is turned: +y is down in Lightwell's images"},
        {LW_FAULT_MOTION_SIGN,
         {-1, 1},
         "its x is turned, as if it were this position less the previous one with +y up"},
        {LW_FAULT_MOTION_UNITS, {w, h}, "it is in [0,1] over the image: multiply by width and height"},
        {LW_FAULT_MOTION_UNITS,
         {-w, -h},
         "it is in [0,1] over the image and this position less the previous: multiply by "
         "-width and -height"},
        {LW_FAULT_MOTION_UNITS,
         {w, -h},
         "it is in [0,1] over the image with +y up: multiply by width and -height"},
        {LW_FAULT_MOTION_UNITS,
         {-w, h},
         "it is in [0,1] over the image, this position less the previous with +y up: "
         "multiply by -width and height"},
        {LW_FAULT_MOTION_UNITS,
         {w / 2, -h / 2},
         "it is in clip coordinates, [-1,1] over the image with +y up: multiply by "
         "width/2 and -height/2"},
        {LW_FAULT_MOTION_UNITS,
         {-w / 2, h / 2},
         "it is in clip coordinates and this position less the previous: multiply by "
         "-width/2 and height/2"},
    };
    const Guess* best = nullptr;
    std::uint64_t bestCount = good;
    for (const Guess& guess : guesses) {
        const std::uint64_t count = matches(moved, guess.factor);
        if (shareOf(count, all) < kRestingShare ||
            shareOf(count, all) < shareOf(good, all) + kClearlyBetter)
            continue;
        if (best && shareOf(count, all) < shareOf(bestCount, all) + 0.05) continue;
        best = &guess;
        bestCount = count;
    }
    std::uint64_t zero = 0;
    for (const double length : lengths) zero += length == 0.0;
    const bool allZero = shareOf(zero, all) >= kNearlyAll;
    const double measured = medianOf(lengths), wanted = medianOf(expected);
    // Without a guess: objects may move with the camera or all over the picture.
    if (!allZero && !best && shareOf(good, all) > 0.1) return;
    const LWInputFault fault = allZero ? LW_FAULT_MOTION_ZERO
                               : best  ? best->fault
                                       : LW_FAULT_MOTION_DISAGREES;
    const char* const cause = allZero ? "it is zero: was it drawn, with the previous frame's matrices?"
                              : best
                                  ? best->text
                                  : "no usual mistake explains it; is previousCamera the last frame's?";
    Found& f = findings.add(
        fault, allZero || best ? LW_SEVERITY_ERROR : LW_SEVERITY_WARNING, s.argument("motion"),
        {all - good, all, measured, wanted,
         allZero ? 0.95
         : best  ? shareOf(bestCount, all)
                 : 0.4},
        "for ", percent(all - good, all),
        " of the surfaces that the cameras move, motion is not what previousCamera says (median ",
        measured, " for ", wanted, " pixels): ", cause);
    for (const Sample& sample : moved)
        if (glm::length(sample.given - sample.expected) >
            kAbsolutePixels + kRelative * glm::length(sample.expected))
            f.pixels.push_back(sample.pixel);
    f.step = s.step;
}

}  // namespace lightwell
