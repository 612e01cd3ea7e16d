// The triangles of a scene as Lightwell's geometry, without a copy: for the command line and the viewer.
#pragma once

#include "lightwell/lightwell.hpp"
#include "scene_triangles.h"

namespace cli {

inline LWGeometry describeTriangles(const studio::SceneTriangles& from) {
    LWGeometry to = lightwell::make<LWGeometry>();
    to.vertices = from.vertices.data();
    to.triangleAlbedo = from.albedo.data();
    to.triangleEmission = from.emission.empty() ? nullptr : from.emission.data();
    to.triangleCount = from.count();
    to.vertexCount = 3 * from.count();
    to.version = from.version;
    return to;
}

}  // namespace cli
