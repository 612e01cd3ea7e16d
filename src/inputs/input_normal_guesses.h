// What hosts do to normals and depth, and how to undo it: the guesses that input_check_normals.cpp holds
// against the geometry.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "inputs/input_check_parts.h"

namespace lightwell {

// Where a pixel's surface lies; false where it has none.
using Place = std::function<bool(std::uint32_t x, std::uint32_t y, glm::dvec3& p)>;

struct NormalGuess {
    LWInputFault fault;
    std::string text;
    Place place;                                          // empty: as given
    std::function<glm::dvec3(const glm::dvec3&)> normal;  // of the unit normal as given
    bool flipX = false, flipY = false;                    // the normal of the mirrored pixel
};

std::vector<NormalGuess> normalGuesses(const Surfaces& surfaces, const std::vector<NamedCamera>& others);
// Needs a depth and a camera; `surfaces` must outlive the guesses.
std::vector<NormalGuess> depthGuesses(const Surfaces& surfaces);

}  // namespace lightwell
