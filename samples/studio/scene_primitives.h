// Simple shapes as triangle meshes with unit normals.
#pragma once

#include <array>

#include "scene.h"

namespace studio {

// Two triangles over corners in order around the quad; texture coordinates (0,0) .. (1,1) from the
// first corner to the third.
Mesh makeQuad(const std::array<glm::vec3, 4>& corners);
Mesh makeBox(const glm::vec3& lower, const glm::vec3& upper);
// Vertices on the sphere, `rings` bands from pole to pole (+Y) of 2 * rings quads; smooth normals.
Mesh makeSphere(const glm::vec3& center, float radius, int rings);

}  // namespace studio
