// What cameras see of a scene: the surfaces that a technique of the picture alone can take light from.
#pragma once

#include <cstdint>
#include <vector>

#include "ray_scene.h"

namespace studio {

// A picture of the scene: its camera and its size, which gives the picture's sides their place.
struct PictureView {
    Camera camera;
    int width = 0, height = 0;
};

// Places that at least one of the pictures shows: inside its sides, on the surface's side that faces its
// camera, and with nothing between, by a ray. Holes of alpha masks are looked through.
class SeenSurfaces {
public:
    SeenSurfaces(const RayScene& scene, const std::vector<PictureView>& views);
    // `side`: geometric normal of the side that is asked for.
    bool contains(const glm::vec3& position, const glm::vec3& side) const;

private:
    struct Eye {
        glm::vec3 position;
        glm::dmat4 clipFromWorld;
    };
    const RayScene& scene_;
    std::vector<Eye> eyes_;
};

// Of everything that contains() depends on beside the scene.
std::uint64_t hashPictureViews(const std::vector<PictureView>& views);

}  // namespace studio
