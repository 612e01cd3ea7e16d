// Where the surface points of one frame stood in the frame before.
//
// Each pixel's ray is traced again, its point taken to its place at the earlier time, projected, and
// compared with what the earlier frame shows in the pixel it falls in: the same mesh, the same side, the
// same plane.
#include <cmath>
#include <limits>

#include <glm/gtc/matrix_transform.hpp>

#include "parallel.h"
#include "sequence.h"

namespace studio {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr float kSameSide = 0.8f;     // cosine between normals that count as one surface's
constexpr float kPixelsApart = 4.0f;  // and the most between two such places, in pixels' footprints

glm::mat4 clipFromWorld(const SequenceFrame& frame) {
    return frame.camera.projectionMatrix(frame.width, frame.height) * frame.camera.viewMatrix();
}

// Rays through pixel centres, as renderGBuffer casts them.
struct View {
    glm::vec3 origin, forward, right, up;
    float width, height, pixelAngle;

    explicit View(const SequenceFrame& frame)
        : origin(frame.camera.position), width(float(frame.width)), height(float(frame.height)) {
        const float tangent = std::tan(0.5f * frame.camera.verticalFov);
        forward = glm::normalize(frame.camera.target - frame.camera.position);
        const glm::vec3 side = glm::normalize(glm::cross(forward, frame.camera.up));
        up = glm::cross(side, forward) * tangent;
        right = side * (tangent * width / height);
        pixelAngle = 2.0f * tangent / height;
    }
    glm::vec3 through(int x, int y) const {
        return glm::normalize(forward + right * (2.0f * (float(x) + 0.5f) / width - 1.0f) +
                              up * (1.0f - 2.0f * (float(y) + 0.5f) / height));
    }
};

}  // namespace

SeenFrame seeFrame(const RayScene& scene, const SequenceFrame& frame) {
    SeenFrame seen;
    seen.width = frame.width;
    seen.height = frame.height;
    const std::size_t count = std::size_t(frame.width) * std::size_t(frame.height);
    seen.surface.assign(count, 0);
    seen.mesh.assign(count, -1);
    seen.position.assign(count, glm::vec3(0.0f));
    seen.normal.assign(count, glm::vec3(0.0f));
    const View view(frame);
    parallelRows(frame.height, [&](int y) {
        for (int x = 0; x < frame.width; ++x) {
            Hit hit;
            if (!scene.trace(view.origin, view.through(x, y), 0.0f, kFar, hit)) continue;
            const std::size_t i = std::size_t(y) * std::size_t(frame.width) + std::size_t(x);
            seen.surface[i] = 1;
            seen.mesh[i] = hit.mesh;
            seen.position[i] = hit.position;
            seen.normal[i] = hit.geometricNormal;
        }
    });
    return seen;
}

std::vector<glm::vec2> previousPositions(const RayScene& scene, const SequenceFrame& frame,
                                         const SequenceFrame& before, const SeenFrame& beforeSeen) {
    const glm::vec2 nowhere(std::numeric_limits<float>::quiet_NaN());
    std::vector<glm::vec2> previous(std::size_t(frame.width) * std::size_t(frame.height), nowhere);
    if (frame.isCut || frame.width != before.width || frame.height != before.height) return previous;
    const View view(frame), beforeView(before);
    const glm::dmat4 beforeClip(clipFromWorld(before));

    parallelRows(frame.height, [&](int y) {
        for (int x = 0; x < frame.width; ++x) {
            Hit hit;
            const glm::vec3 direction = view.through(x, y);
            if (!scene.trace(view.origin, direction, 0.0f, kFar, hit)) continue;
            const glm::vec3 point = scene.surfacePointAt(hit, before.time);
            const glm::dvec4 clip = beforeClip * glm::dvec4(point, 1.0);
            if (clip.w <= 0.0) continue;
            const glm::dvec2 at((clip.x / clip.w + 1.0) * 0.5 * before.width,
                                (1.0 - clip.y / clip.w) * 0.5 * before.height);
            if (!(at.x >= 0.0 && at.y >= 0.0 && at.x < before.width && at.y < before.height)) continue;

            const std::size_t there = std::size_t(at.y) * std::size_t(before.width) + std::size_t(at.x);
            if (beforeSeen.mesh[there] != hit.mesh) continue;
            // A turned object's normal has turned with it: compared at the earlier time, against the
            // plane that the earlier frame shows.
            const glm::vec3 way = point - beforeSeen.position[there];
            const float footprint = glm::length(point - before.camera.position) * beforeView.pixelAngle;
            const float offPlane = std::abs(glm::dot(way, beforeSeen.normal[there]));
            const glm::vec3 towards = glm::normalize(before.camera.position - point);
            const float slope = std::max(0.02f, glm::dot(beforeSeen.normal[there], towards));
            if (offPlane > footprint || glm::length(way) > kPixelsApart * footprint / slope) continue;
            // Of a thin box the other side lies in nearly the same place.
            const bool isAtRest =
                frame.scene->objects[std::size_t(frame.scene->meshes[std::size_t(hit.mesh)].object)]
                    .keys.empty();
            if (isAtRest && glm::dot(hit.geometricNormal, beforeSeen.normal[there]) < kSameSide)
                continue;
            previous[std::size_t(y) * std::size_t(frame.width) + std::size_t(x)] = glm::vec2(at);
        }
    });
    return previous;
}

}  // namespace studio
