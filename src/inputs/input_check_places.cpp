// Positions against the camera: a surface must project to its own pixel. Where it does not, everything
// that hosts get wrong is tried in turn, and what brings the surfaces back to their pixels is the cause.
// (A little over 300 lines: a dozen guesses with their texts.)
#include <algorithm>
#include <cmath>
#include <functional>

#include "compute/error.h"
#include "inputs/input_check_parts.h"

namespace lightwell {
namespace {

// Pixels by which a surface may miss its pixel's centre. Jitter of temporal anti-aliasing that stands in
// the picture and not in the matrix moves it by up to half a pixel in x and y, 0.7 in all; matrices
// rounded on their way leave some more. Less than two, so that no flip or other camera passes.
constexpr double kTolerancePixels = 1.5;
// Relative rounding of a coordinate.
constexpr double kHalfRounding = 1.0 / 1024, kFloatRounding = 1.0 / (1 << 21);
// Share of surfaces on their pixels from which positions and camera are one: the rest may be portals,
// particles, imposters. A guess must reach as much and be clearly better.
constexpr double kGoodShare = 0.8, kClearlyBetter = 0.3;
constexpr std::uint64_t kFewest = 16;

// What may have been done to the positions, and how to undo it.
struct Guess {
    LWInputFault fault;
    std::string text;
    std::function<glm::dvec3(const glm::dvec3&)> move;
    const Camera* camera;
    bool flipX = false, flipY = false;
    double factor = 1.0;
};

struct Score {
    std::uint64_t good = 0, all = 0;
    double medianError = 0.0;  // pixels, of those in front of the camera
    double share() const { return shareOf(good, all); }
};

double toleranceAt(const Surfaces& s, const Camera& camera, const glm::dvec3& p) {
    const double largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    const double footprint = camera.footprint(camera.axial(p));
    return kTolerancePixels + (s.halfPositions ? kHalfRounding : kFloatRounding) * largest / footprint;
}

double pixelError(const Surfaces& s, const Guess& guess, std::uint32_t x, std::uint32_t y,
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

Score scoreOf(const Surfaces& s, const Guess& guess, std::vector<std::uint32_t>* missed = nullptr) {
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
    score.medianError = medianOf(std::move(errors));
    return score;
}

// The factor that brings most positions onto their pixels' rays, q + t d: least squares pixel by pixel,
// then the median.
double fitFactor(const Surfaces& s) {
    std::vector<double> factors;
    const Camera& camera = *s.camera;
    s.sample([&](std::uint32_t x, std::uint32_t y) {
        if (!s.surface(x, y)) return;
        const glm::dvec3 ray = camera.rays().at(x, y), p = s.position.triple(x, y);
        const glm::dvec3 q = camera.perspective() ? camera.eye() : camera.eye() + ray;
        const glm::dvec3 d = glm::normalize(camera.perspective() ? ray : camera.axis());
        const glm::dvec3 acrossP = glm::cross(p, d), acrossQ = glm::cross(q, d);
        if (glm::dot(acrossP, acrossP) > 0.0)
            factors.push_back(glm::dot(acrossQ, acrossP) / glm::dot(acrossP, acrossP));
    });
    return medianOf(std::move(factors));
}

LWCamera transposed(const LWCamera& camera) {
    LWCamera result{};
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) {
            result.view[4 * row + column] = camera.view[4 * column + row];
            result.projection[4 * row + column] = camera.projection[4 * column + row];
        }
    return result;
}

std::optional<Camera> transposedCamera(const Surfaces& s) {
    std::optional<Camera> camera;
    try {
        if (s.matrices) camera.emplace(transposed(*s.matrices), s.width, s.height, s.argument("camera"));
    } catch (const Error&) {
    }
    return camera;
}

glm::dvec3 asGiven(const glm::dvec3& p) {
    return p;
}

std::vector<Guess> guessesFor(const Surfaces& s, const std::vector<NamedCamera>& others,
                              const std::optional<Camera>& transposedOne) {
    std::vector<Guess> guesses;
    const Camera* own = &*s.camera;
    if (s.previous)
        guesses.push_back({LW_FAULT_CAMERA_PREVIOUS,
                           "they project through previousCamera: this frame's and the previous frame's "
                           "camera have been "
                           "exchanged, or the camera was updated before the G-buffer was drawn",
                           asGiven, &*s.previous});
    const char* const kRows =
        "rows run bottom-up: give byteOffset of the last row and a negative byteRowStride for every "
        "image of the buffer, or turn the projection's sign of y";
    guesses.push_back({LW_FAULT_IMAGE_FLIPPED, kRows, asGiven, own, false, true});
    guesses.push_back({LW_FAULT_IMAGE_FLIPPED,
                       "columns are mirrored: the camera's x axis has the wrong sign", asGiven, own,
                       true, false});
    guesses.push_back({LW_FAULT_IMAGE_FLIPPED,
                       "the image is turned by half a turn: rows and columns are reversed", asGiven, own,
                       true, true});
    if (transposedOne)
        guesses.push_back(
            {LW_FAULT_CAMERA_TRANSPOSED,
             "the matrices fit once transposed: they are column-major (OpenGL, GLM, Unity); Lightwell "
             "reads rows",
             asGiven, &*transposedOne});
    guesses.push_back(
        {LW_FAULT_POSITION_SPACE,
         "they are in view space of the buffer's own camera: multiply by the inverse view matrix",
         [own](const glm::dvec3& p) { return own->positionFromView(p); }, own});
    guesses.push_back(
        {LW_FAULT_POSITION_SPACE,
         "they are in view space with z turned (a left-handed view): bring them to the world",
         [own](const glm::dvec3& p) {
             return own->positionFromView({p.x, p.y, -p.z});
         },
         own});
    guesses.push_back(
        {LW_FAULT_POSITION_SPACE,
         "they are relative to the eye (camera-relative rendering): add the eye's position",
         [own](const glm::dvec3& p) { return p + own->eye(); }, own});
    for (const NamedCamera& other : others) {
        const Camera* camera = other.camera;
        guesses.push_back(
            {LW_FAULT_POSITION_SPACE,
             "they are in the view space of " + other.name + ": multiply by its inverse view matrix",
             [camera](const glm::dvec3& p) { return camera->positionFromView(p); }, own});
    }
    for (const AxesChange& change : axesChanges()) {
        const glm::dmat3 matrix = change.matrix;
        guesses.push_back({LW_FAULT_POSITION_SPACE,
                           std::string("positions and camera have different axes: ") + change.what,
                           [matrix](const glm::dvec3& p) { return matrix * p; }, own});
    }
    const double factor = fitFactor(s);
    if (std::abs(factor) > 0.0 && std::abs(std::log(std::abs(factor))) > 0.05)
        guesses.push_back({LW_FAULT_POSITION_UNITS, "",
                           [factor](const glm::dvec3& p) { return p * factor; }, own, false, false,
                           factor});
    return guesses;
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

// Zero normals although the position projects to the pixel, or the depth is no clear value.
void checkMissingNormals(const Surfaces& s, Findings& findings) {
    std::uint64_t missing = 0, examined = 0;
    std::vector<std::uint32_t> pixels;
    const Guess none{LW_FAULT_NORMAL_MISSING, "", asGiven, &*s.camera};
    s.sample([&](std::uint32_t x, std::uint32_t y) {
        ++examined;
        if (s.normal.triple(x, y) != glm::dvec3(0.0)) return;
        const glm::dvec3 p = s.position.triple(x, y);
        double tolerance = 0.0;
        if (p == glm::dvec3(0.0) || !finite(p) || !(pixelError(s, none, x, y, tolerance) <= tolerance))
            return;
        ++missing;
        pixels.push_back(y * s.width + x);
    });
    // A sky drawn as a dome has positions too, so this is no more than a warning, and only where it is
    // much.
    if (missing < kFewest || shareOf(missing, examined) < 0.02) return;
    Found& f = findings.add(
        LW_FAULT_NORMAL_MISSING, LW_SEVERITY_WARNING, s.argument("normal"),
        {missing, examined, shareOf(missing, examined), 0.0, 0.5}, percent(missing, examined),
        " of the pixels have a position that projects to them and a zero normal, which means no "
        "surface: no light will reach them. Give normals there, unless it is sky");
    f.pixels = std::move(pixels);
    f.step = s.step;
}

}  // namespace

const std::vector<AxesChange>& axesChanges() {
    // Columns: where x, y and z go.
    static const std::vector<AxesChange> changes = {
        {"z has the other sign (the other handedness)", glm::dmat3(1, 0, 0, 0, 1, 0, 0, 0, -1)},
        {"x has the other sign (the other handedness)", glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, 1)},
        {"y has the other sign", glm::dmat3(1, 0, 0, 0, -1, 0, 0, 0, 1)},
        {"z is up in one and y in the other", glm::dmat3(1, 0, 0, 0, 0, -1, 0, 1, 0)},
        {"y is up in one and z in the other", glm::dmat3(1, 0, 0, 0, 0, 1, 0, -1, 0)},
        {"y and z are exchanged", glm::dmat3(1, 0, 0, 0, 0, 1, 0, 1, 0)},
    };
    return changes;
}

const char* lengthFactorName(double factor) {
    static constexpr struct {
        double factor;
        const char* name;
    } kNames[] = {{100.0, "metres for centimetres"},
                  {0.01, "centimetres for metres"},
                  {1000.0, "metres for millimetres"},
                  {0.001, "millimetres for metres"},
                  {10.0, "ten times"},
                  {0.1, "a tenth"},
                  {2.54, "inches for centimetres"},
                  {1 / 2.54, "centimetres for inches"},
                  {0.0254, "inches for metres"},
                  {1 / 0.0254, "metres for inches"},
                  {0.3048, "feet for metres"},
                  {1 / 0.3048, "metres for feet"}};
    for (const auto& known : kNames)
        if (std::abs(factor / known.factor - 1.0) < 0.03) return known.name;
    return nullptr;
}

void checkPlaces(Surfaces& s, const std::vector<NamedCamera>& others, Findings& findings) {
    if (!s.cameraError.empty()) reportInvalid(s, findings);
    if (!s.camera || !s.trusted || s.depth) return;  // depth is on its pixel's ray by construction
    const Guess given{LW_FAULT_POSITION_CAMERA, "", asGiven, &*s.camera};
    std::vector<std::uint32_t> missed;
    const Score score = scoreOf(s, given, &missed);
    if (score.all < kFewest) return;
    if (score.share() >= kGoodShare) {
        if (!s.isRsm) checkMissingNormals(s, findings);
        return;
    }
    s.trusted = false;
    const std::optional<Camera> transposedOne = transposedCamera(s);
    const std::vector<Guess> guesses = guessesFor(s, others, transposedOne);
    const Guess* best = nullptr;
    Score bestScore = score;
    for (const Guess& guess : guesses) {
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
        ".camera does not project to them (median miss ", score.medianError, " pixels): ", cause);
    if (!s.isRsm) f.pixels = std::move(missed);
    f.step = s.step;
}

}  // namespace lightwell
