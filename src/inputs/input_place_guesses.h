// What hosts do to positions, and how to undo it: the guesses that input_check_places.cpp holds against
// the camera.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "inputs/input_check_parts.h"

namespace lightwell {

// What may have been done to the positions, and how to undo it.
struct PlaceGuess {
    LWInputFault fault;
    std::string text;
    std::function<glm::dvec3(const glm::dvec3&)> move;
    const Camera* camera;
    bool flipX = false, flipY = false;
    double factor = 1.0;
};

glm::dvec3 asGiven(const glm::dvec3& p);

// The buffer's camera with its matrices transposed; none where that is no camera.
std::optional<Camera> transposedCamera(const Surfaces& surfaces);

// In the order of how common they are. Cameras must outlive the guesses.
std::vector<PlaceGuess> placeGuesses(const Surfaces& surfaces, const std::vector<NamedCamera>& others,
                                     const std::optional<Camera>& transposedOne);

}  // namespace lightwell
