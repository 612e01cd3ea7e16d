// The cameras that a light's reflective shadow maps are drawn through, whatever draws them.
#pragma once

#include <vector>

#include "sun_fit.h"

namespace studio {

struct RsmCamera {
    glm::mat4 view{1.0f}, projection{1.0f};  // projection: clip z in [0,1]
};

// A square frustum from a light's place. `halfAngle` in radians, less than pi / 2.
struct RsmFrustum {
    LightAxes axes;
    double halfAngle;
};
// Of a spot one, or five faces of a cube when its outer cone is over 75 degrees; of a point light six.
std::vector<RsmFrustum> rsmFrustums(const Light& light);

RsmCamera rsmCamera(const SunFit& fit, const SunRect& rect, const LightAxes& axes);
// Clip planes by the scene's bounds, for depth.
RsmCamera rsmCamera(const RayScene& scene, const glm::vec3& eye, const RsmFrustum& frustum);

// All of a light's cameras, as renderRsms draws them.
std::vector<RsmCamera> rsmCameras(const RayScene& scene, const Light& light, const RsmOptions& options);

// What an RSM's texel stands for, by its map's projection and size: the area across a sun's rays (m^2), or the solid
// angle about a frustum's axis (sr), which falls with the cube of the cosine to it.
double rsmTexelMeasure(const glm::mat4& projection, int size);

}  // namespace studio
