// Motion vectors against the cameras: a surface at rest was, in the previous frame, where the previous
// camera projects it. Moving objects differ, but not all in the way that a sign or a unit does.
#include <algorithm>
#include <cmath>

#include "compute/error.h"
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
    glm::dvec2 steady;  // what is expected of motion without the jitter that the matrices hold
    double rounding;    // of the position, in pixels
    std::uint32_t pixel;

    double shortest() const { return std::min(glm::length(expected), glm::length(steady)); }
    bool fits(const glm::dvec2& motion) const {
        const auto near = [&](const glm::dvec2& wanted) {
            return glm::length(motion - wanted) <=
                   kAbsolutePixels + rounding + kRelative * glm::length(wanted);
        };
        return near(expected) || near(steady);
    }
};

std::uint64_t matches(const std::vector<Sample>& samples, const glm::dvec2& factor) {
    std::uint64_t count = 0;
    for (const Sample& sample : samples) count += sample.fits(sample.given * factor);
    return count;
}

// Temporal anti-aliasing moves the whole picture by part of a pixel, another one each frame: rows x and
// y of the projection change by a small share of its last row. Motion holds that in some engines and not
// in others, and both serve. The previous camera with this frame's jitter; none where nothing or more
// differs.
std::optional<Camera> withoutJitter(const Surfaces& s) {
    LWCamera steady = *s.previousMatrices;
    const float *now = s.matrices->projection, *last = steady.projection + 12;
    double length2 = 0.0;
    for (int c = 0; c < 4; ++c) length2 += double(last[c]) * double(last[c]);
    bool any = false;
    for (int row = 0; row < 2; ++row) {
        float* before = steady.projection + 4 * row;
        double shift = 0.0, rest = 0.0, size = 0.0;
        for (int c = 0; c < 4; ++c)
            shift += (double(before[c]) - double(now[4 * row + c])) * double(last[c]) / length2;
        for (int c = 0; c < 4; ++c) {
            rest = std::max(
                rest, std::abs(double(before[c]) - shift * double(last[c]) - double(now[4 * row + c])));
            size = std::max(size, std::abs(double(now[4 * row + c])));
        }
        const double pixel = 2.0 / (row == 0 ? s.width : s.height);
        if (rest > 1e-5 * size || std::abs(shift) > pixel) return std::nullopt;
        any = any || shift != 0.0;
        std::copy_n(now + 4 * row, 4, before);
    }
    if (!any) return std::nullopt;
    try {
        return Camera(steady, s.width, s.height, s.argument("previousCamera"));
    } catch (const Error&) {
        return std::nullopt;
    }
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
    if (s.shown)
        for (const Sample& sample : still) f.pixels.push_back(sample.pixel);
    f.step = s.step;
}

struct Samples {
    std::vector<Sample> moved, still;  // by the cameras
};

Samples samplesOf(const Surfaces& s) {
    Samples samples;
    const std::optional<Camera> steadyPrevious = withoutJitter(s);
    s.sample([&](std::uint32_t x, std::uint32_t y) {
        const glm::dvec2 given(double(s.motion.at(x, y, 0)), double(s.motion.at(x, y, 1)));
        glm::dvec2 before, steady;
        const glm::dvec3 p = s.position.triple(x, y);
        if (!s.surface(x, y) || !std::isfinite(given.x) || !std::isfinite(given.y)) return;
        if (!s.previous->project(p, before)) return;  // it was behind the camera
        if (!steadyPrevious || !steadyPrevious->project(p, steady)) steady = before;
        const glm::dvec2 centre(x + 0.5, y + 0.5);
        const double rounding = s.rounding(p) / s.previous->footprint(s.previous->axial(p));
        const Sample sample{given, before - centre, steady - centre, rounding, y * s.width + x};
        (sample.shortest() >= kShortest + rounding ? samples.moved : samples.still).push_back(sample);
    });
    return samples;
}

bool equalCameras(const Surfaces& s) {
    return std::equal(s.matrices->view, s.matrices->view + 16, s.previousMatrices->view) &&
           std::equal(s.matrices->projection, s.matrices->projection + 16,
                      s.previousMatrices->projection);
}

std::vector<Guess> guessesFor(double w, double h) {
    return {
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
}

// The guess that makes clearly more vectors right than the `good` that are; null where none does.
const Guess* bestOf(const std::vector<Guess>& guesses, const std::vector<Sample>& moved,
                    std::uint64_t good, std::uint64_t& bestCount) {
    const Guess* best = nullptr;
    const std::uint64_t all = moved.size();
    bestCount = good;
    for (const Guess& guess : guesses) {
        const std::uint64_t count = matches(moved, guess.factor);
        if (shareOf(count, all) < kRestingShare ||
            shareOf(count, all) < shareOf(good, all) + kClearlyBetter)
            continue;
        if (best && shareOf(count, all) < shareOf(bestCount, all) + 0.05) continue;
        best = &guess;
        bestCount = count;
    }
    return best;
}

}  // namespace

void checkMotion(const Surfaces& s, Findings& findings) {
    if (!s.motion || !s.camera || !s.previous || !s.trusted) return;
    const Samples samples = samplesOf(s);
    const std::vector<Sample>& moved = samples.moved;
    const std::uint64_t all = moved.size();
    if (all < kFewest || all < samples.still.size() / 16) {
        if (equalCameras(s)) checkStatic(s, samples.still, findings);
        return;
    }
    const std::uint64_t good = matches(moved, glm::dvec2(1.0));
    if (shareOf(good, all) >= kRestingShare) return;

    const std::vector<Guess> guesses = guessesFor(s.width, s.height);
    std::uint64_t bestCount = 0, zero = 0;
    const Guess* const best = bestOf(guesses, moved, good, bestCount);
    std::vector<double> lengths, expected;
    for (const Sample& sample : moved) {
        lengths.push_back(glm::length(sample.given));
        expected.push_back(glm::length(sample.expected));
        zero += lengths.back() == 0.0;
    }
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
        if (s.shown && !sample.fits(sample.given)) f.pixels.push_back(sample.pixel);
    f.step = s.step;
}

}  // namespace lightwell
