// A room's corner with a sphere, seen by one camera.
#pragma once

#include "support/view_scene.h"

namespace lightwell::test {

// With background around it.
inline ViewScene sphereCorner() {
    ViewScene scene;
    scene.quad({-2, 0, -2}, {4, 0, 0}, {0, 0, 6}, 1.0);
    scene.quad({-2, 0, -2}, {4, 0, 0}, {0, 2, 0}, 0.5);
    scene.quad({-2, 0, -2}, {0, 0, 3}, {0, 1.5, 0}, 2.0, true);
    scene.spheres.push_back({{0.6, 0.5, -0.6}, 0.45, 3.0});
    return scene;
}

inline TestCamera cornerCamera(bool orthographic) {
    TestCamera camera = lookAt({2.5, 1.8, 2.5}, {-0.4, 0.4, -0.6}, 0.5);
    camera.orthographic = orthographic;
    if (orthographic) camera.left *= 3, camera.rightEdge *= 3, camera.bottom *= 3, camera.top *= 3;
    return camera;
}

}  // namespace lightwell::test
