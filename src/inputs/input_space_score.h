// How well an RSM's texels lie on what the camera sees, as they are or as a guess moves them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "inputs/input_check_parts.h"

namespace lightwell {

// Fewer decide nothing.
constexpr std::uint64_t kFewestTexels = 64;
// Texels in front, of those in the picture. At most one in a thousand in every scene tried; leaves,
// levels of detail and moving things of other hosts may bring more.
constexpr double kInFrontShare = 0.15;

struct Texel {
    glm::dvec3 position, normal;
    double width;     // of the texel there
    double rounding;  // of the position
    const Surfaces* map;
    std::uint32_t x, y;
};

// Of a light's trusted maps, thinned out.
std::vector<Texel> texelsOf(const LightMaps& light);

// Distances along the camera's axis; NaN without a surface.
using Distances = std::vector<double>;

template <class Place>
Distances distancesOf(const Surfaces& g, const Place& place) {
    Distances distances(std::size_t(g.width) * g.height, std::nan(""));
    for (std::uint32_t y = 0; y < g.height; ++y)
        for (std::uint32_t x = 0; x < g.width; ++x) {
            glm::dvec3 p;
            if (g.drawn(x, y) && place(x, y, p))
                distances[std::size_t(y) * g.width + x] = g.camera->axial(p);
        }
    return distances;
}

struct SpaceScore {
    // Inside the picture; of these facing the camera; on what it sees; on it with its normal; facing the
    // camera in front of what it sees; in front, facing or not.
    std::uint64_t all = 0, inside = 0, facing = 0, on = 0, normals = 0, inFront = 0, nearer = 0;
    std::uint32_t lowX = ~0u, highX = 0, lowY = ~0u, highY = 0;
    std::vector<std::uint32_t> pixels;  // that texels lie in front of
    double spreadX(const Surfaces& g) const { return on ? double(highX - lowX + 1) / g.width : 0.0; }
    double spreadY(const Surfaces& g) const { return on ? double(highY - lowY + 1) / g.height : 0.0; }
    // What cannot be: the camera would see it. Walls seen from behind may be culled.
    double inFrontShare() const { return shareOf(inFront, facing); }
    // What a guess should hardly bring about.
    double nearerShare() const { return shareOf(nearer, inside); }
    // Normals prove a guess, or that it brings behind the picture what cannot be in front: outer walls
    // are lit whose inner sides the camera sees.
    bool explains(const Surfaces& g, const SpaceScore& given) const;
};

struct SpaceGuess {
    LWInputFault fault;
    std::string argument, text;
    std::function<bool(const Texel&, glm::dvec3&)> place;
    std::function<glm::dvec3(const glm::dvec3&)> turn;  // of normals
    const Distances* distances;
    double factor = 1.0;  // of lengths
};

SpaceScore scoreOf(const Surfaces& g, const std::vector<Texel>& texels, const SpaceGuess& guess);

// input_space_guesses.cpp: other units, spaces and axes.
std::vector<SpaceGuess> spaceGuesses(const Surfaces& g, const std::string& lightName,
                                     const Distances& distances);
// The same places with the depth of either side read otherwise. `alternatives` keeps the distances that
// guesses point to.
void addDepthGuesses(const Surfaces& g, const LightMaps& light, const Distances& distances,
                     std::vector<Distances>& alternatives, std::vector<SpaceGuess>& guesses);

}  // namespace lightwell
