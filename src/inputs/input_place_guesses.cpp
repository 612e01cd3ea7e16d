#include "inputs/input_place_guesses.h"

#include <cmath>

#include "compute/error.h"

namespace lightwell {
namespace {

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

}  // namespace

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

std::vector<PlaceGuess> placeGuesses(const Surfaces& s, const std::vector<NamedCamera>& others,
                                     const std::optional<Camera>& transposedOne) {
    std::vector<PlaceGuess> guesses;
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

}  // namespace lightwell
