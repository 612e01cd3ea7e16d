#include "seen_surfaces.h"

#include <cmath>

#include "film.h"

namespace studio {

SeenSurfaces::SeenSurfaces(const RayScene& scene, const std::vector<PictureView>& views)
    : scene_(scene) {
    for (const PictureView& view : views)
        eyes_.push_back(
            {view.camera.position, glm::dmat4(view.camera.projectionMatrix(view.width, view.height)) *
                                       glm::dmat4(view.camera.viewMatrix())});
}

bool SeenSurfaces::contains(const glm::vec3& position, const glm::vec3& side) const {
    for (const Eye& eye : eyes_) {
        if (glm::dot(side, eye.position - position) <= 0.0f) continue;
        // Near and far planes do not cut: the studio's pictures are made by rays that know neither.
        const glm::dvec4 clip = eye.clipFromWorld * glm::dvec4(position, 1.0);
        if (!(clip.w > 0.0) || std::abs(clip.x) > clip.w || std::abs(clip.y) > clip.w) continue;
        const glm::vec3 from = scene_.offset(position, side);
        const glm::vec3 way = eye.position - from;
        const float distance = glm::length(way);
        if (distance > 0.0f && !scene_.occluded(from, way / distance, 0.0f, distance)) return true;
    }
    return false;
}

std::uint64_t hashPictureViews(const std::vector<PictureView>& views) {
    std::uint64_t hash = hashBytes("seen", 4, views.size());
    for (const PictureView& view : views) {
        const Camera& camera = view.camera;
        const float numbers[] = {camera.position.x, camera.position.y, camera.position.z,
                                 camera.target.x,   camera.target.y,   camera.target.z,
                                 camera.up.x,       camera.up.y,       camera.up.z,
                                 camera.verticalFov};
        const int size[] = {view.width, view.height};
        hash = hashBytes(size, sizeof size, hashBytes(numbers, sizeof numbers, hash));
    }
    return hash;
}

}  // namespace studio
