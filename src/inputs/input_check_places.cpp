// Positions against the camera: a surface must project to its own pixel. Where it does not, everything
// that hosts get wrong is tried in turn, and what brings the surfaces back to their pixels is the cause.
#include <algorithm>
#include <cmath>

#include "inputs/input_place_guesses.h"

namespace lightwell {
namespace {

// Pixels by which a surface may miss its pixel's centre. Jitter of temporal anti-aliasing that stands in
// the picture and not in the matrix moves it by up to half a pixel in x and y, 0.7 in all; matrices
// rounded on their way leave some more. Less than two, so that no flip or other camera passes.
constexpr double kTolerancePixels = 1.5;
// Share of surfaces on their pixels from which positions and camera are one: the rest may be portals,
// particles, imposters. A guess must reach as much and be clearly better.
constexpr double kGoodShare = 0.8, kClearlyBetter = 0.3;
constexpr std::uint64_t kFewest = 16;

struct Score {
    std::uint64_t good = 0, all = 0;
    double medianError = HUGE_VAL;  // pixels, of those in front of the camera; infinite without any
    double share() const { return shareOf(good, all); }
};

double toleranceAt(const Surfaces& s, const Camera& camera, const glm::dvec3& p) {
    return kTolerancePixels + s.rounding(p) / camera.footprint(camera.axial(p));
}

double pixelError(const Surfaces& s, const PlaceGuess& guess, std::uint32_t x, std::uint32_t y,
                  double& tolerance) {
    const glm::dvec3 given = s.position.triple(x, y);
    const glm::dvec3 p = guess.move(given);
    glm::dvec2 pixel;
    if (!finite(p) || !guess.camera->project(p, pixel)) return HUGE_VAL;
    tolerance = toleranceAt(s, *guess.camera, p);
    const glm::dvec2 centre((guess.flipX ? s.width - 1 - x : x) + 0.5,
                            (guess.flipY ? s.height - 1 - y : y) + 0.5);
    return glm::length(pixel - centre);
}

Score scoreOf(const Surfaces& s, const PlaceGuess& guess, std::vector<std::uint32_t>* missed = nullptr) {
    Score score;
    std::vector<double> errors;
    s.sample([&](std::uint32_t x, std::uint32_t y) {
        if (!s.surface(x, y)) return;
        ++score.all;
        double tolerance = 0.0;
        const double error = pixelError(s, guess, x, y, tolerance);
        if (error < HUGE_VAL) errors.push_back(error);
        if (error <= tolerance)
            ++score.good;
        else if (missed)
            missed->push_back(y * s.width + x);
    });
    if (!errors.empty()) score.medianError = medianOf(std::move(errors));
    return score;
}

// One and the same position on every surface: an image that was never drawn.
bool onePlace(const Surfaces& s, glm::dvec3& place) {
    bool any = false, same = true;
    s.sample([&](std::uint32_t x, std::uint32_t y) {
        if (!same || !s.surface(x, y)) return;
        const glm::dvec3 p = s.position.triple(x, y);
        same = !any || p == place;
        place = p;
        any = true;
    });
    return any && same;
}

std::string missText(double medianError) {
    if (!(medianError < HUGE_VAL)) return "all lie behind it";
    std::ostringstream text;
    text.precision(4);
    text << "median miss " << medianError << " pixels";
    return text.str();
}

std::string unitsText(double factor) {
    const char* const name = lengthFactorName(factor);
    std::ostringstream text;
    text.precision(4);
    text << "they fit the camera once multiplied by " << factor
         << (name ? std::string(" (") + name + ")" : "")
         << ": positions and camera are in different units of length";
    return text.str();
}

void reportInvalid(Surfaces& s, Findings& findings) {
    const std::optional<Camera> other = transposedCamera(s);
    const bool fits =
        other && s.position &&
        scoreOf(s, {LW_FAULT_CAMERA_TRANSPOSED, "", asGiven, &*other}).share() >= kGoodShare;
    if (fits)
        findings.add(LW_FAULT_CAMERA_TRANSPOSED, LW_SEVERITY_ERROR, s.argument("camera"),
                     {1, 1, 0.0, 1.0, 1.0},
                     "no camera as it stands, and the right one once transposed: the matrices are "
                     "column-major (OpenGL, "
                     "GLM, Unity); Lightwell reads rows");
    else
        findings.add(LW_FAULT_CAMERA_INVALID, LW_SEVERITY_ERROR,
                     s.argument(s.camera ? "previousCamera" : "camera"), {1, 1, 0.0, 1.0, 0.9},
                     s.cameraError,
                     ". Is it set, row-major, and multiplied as projection * view * position?");
    if (!s.camera) s.trusted = false;
}

// Nearest and farthest depth of the image, one of which stands for the background.
struct DepthRange {
    double lowest = HUGE_VAL, highest = -HUGE_VAL;
    explicit DepthRange(const HostPlanes& depth, std::uint32_t width, std::uint32_t height) {
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                const auto d = double(depth.at(x, y));
                if (!std::isfinite(d)) continue;
                lowest = std::min(lowest, d);
                highest = std::max(highest, d);
            }
    }
    bool between(double depth) const { return depth > lowest && depth < highest; }
};

}  // namespace

// Zero normals although the position projects to the pixel, or the depth is no clear value.
void checkMissingNormals(const Surfaces& s, Findings& findings) {
    if (!s.camera) return;
    std::uint64_t missing = 0, examined = 0;
    std::vector<std::uint32_t> pixels;
    const PlaceGuess none{LW_FAULT_NORMAL_MISSING, "", asGiven, &*s.camera};
    const DepthRange range(s.depth, s.depth ? s.width : 0, s.height);
    s.sample([&](std::uint32_t x, std::uint32_t y) {
        ++examined;
        if (s.normal.triple(x, y) != glm::dvec3(0.0)) return;
        const glm::dvec3 p = s.position.triple(x, y);
        if (!withinReach(p)) return;
        if (s.depth) {
            if (!range.between(double(s.depth.at(x, y)))) return;
        } else {
            double tolerance = 0.0;
            if (p == glm::dvec3(0.0) || !(pixelError(s, none, x, y, tolerance) <= tolerance)) return;
        }
        ++missing;
        if (s.shown) pixels.push_back(y * s.width + x);
    });
    // A sky drawn as a dome has positions too, so this is no more than a warning, and only where it is
    // much.
    if (missing < kFewest || shareOf(missing, examined) < 0.02) return;
    Found& f = findings.add(
        LW_FAULT_NORMAL_MISSING, LW_SEVERITY_WARNING, s.argument("normal"),
        {missing, examined, shareOf(missing, examined), 0.0, 0.5}, percent(missing, examined),
        " of the pixels have a ",
        s.depth ? "depth that is not the background's" : "position that projects to them",
        " and a zero normal, which means no surface: no light will reach them. Give normals there, "
        "unless it is sky");
    f.pixels = std::move(pixels);
    f.step = s.step;
}

void checkPlaces(Surfaces& s, const std::vector<NamedCamera>& others, Findings& findings) {
    if (!s.cameraError.empty()) reportInvalid(s, findings);
    if (!s.camera || !s.trusted || s.depth) return;  // depth is on its pixel's ray by construction
    const PlaceGuess given{LW_FAULT_POSITION_CAMERA, "", asGiven, &*s.camera};
    std::vector<std::uint32_t> missed;
    const Score score = scoreOf(s, given, &missed);
    if (score.all < kFewest) return;
    if (score.share() >= kGoodShare) return;
    s.trusted = false;
    glm::dvec3 place(0.0);
    if (onePlace(s, place)) {
        Found& f = findings.add(LW_FAULT_POSITION_CAMERA, LW_SEVERITY_ERROR, s.argument("position"),
                                {score.all, score.all, score.medianError, 0.0, 0.95},
                                "every position is ", place.x, " ", place.y, " ", place.z,
                                ": was the image drawn, and the right texture bound?");
        if (s.shown) f.pixels = std::move(missed);
        f.step = s.step;
        return;
    }
    const std::optional<Camera> transposedOne = transposedCamera(s);
    const std::vector<PlaceGuess> guesses = placeGuesses(s, others, transposedOne);
    const PlaceGuess* best = nullptr;
    Score bestScore = score;
    for (const PlaceGuess& guess : guesses) {
        const Score other = scoreOf(s, guess);
        // Guesses come in the order of how common they are: a later one must be better by more than
        // noise.
        if (other.share() < kGoodShare || other.share() < score.share() + kClearlyBetter) continue;
        if (best && other.share() < bestScore.share() + 0.05) continue;
        best = &guess;
        bestScore = other;
    }
    const char* const what = s.isRsm ? " of the texels" : " of the pixels";
    const std::uint64_t off = score.all - score.good;
    std::string cause = best ? best->text : std::string();
    if (best && best->fault == LW_FAULT_POSITION_UNITS) cause = unitsText(best->factor);
    if (!best)
        cause =
            "no usual mistake explains it. Is this the camera that drew the buffer, with the same "
            "viewport, and are "
            "the positions the world's?";
    const bool units = best && best->fault == LW_FAULT_POSITION_UNITS;
    const double measured = units ? 1.0 / best->factor : score.medianError;
    Found& f = findings.add(
        best ? best->fault : LW_FAULT_POSITION_CAMERA, LW_SEVERITY_ERROR, s.argument("position"),
        {off, score.all, measured, units ? 1.0 : 0.0, best ? bestScore.share() : 0.6},
        percent(off, score.all), what, " have a position that ", s.name,
        ".camera does not project to them (", missText(score.medianError), "): ", cause);
    if (s.shown) f.pixels = std::move(missed);
    f.step = s.step;
}

}  // namespace lightwell
