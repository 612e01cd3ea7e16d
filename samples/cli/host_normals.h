// Normals of a picture that brings none: geometric ones, of the surface through a pixel's place and its neighbours'.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "host_camera.h"

namespace cli {

struct MadeNormals {
    std::vector<std::vector<float>> planes;  // X, Y, Z; unit, turned to the camera; zero where there is none
    std::uint64_t lonely = 0;                // surface pixels without a usable neighbour along one of the axes, which get none
};

// `places`: row after row, the top one first; none: background. Along each axis one of the two neighbours is taken, so that nothing is mixed across an
// edge: that behind which the next pixel lies straightest on (beyond an edge or a crease none does), else the nearer one, unless what leads there
// runs along the pixel's ray: that is another surface, before or behind.
MadeNormals makeNormals(int width, int height, const std::vector<std::optional<glm::dvec3>>& places, const HostCamera& camera);

}  // namespace cli
