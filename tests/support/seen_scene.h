// A scene as a camera sees it, and cast rays through the same scene: what a picture's own pixels can be held against.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "emitters.h"
#include "gbuffer.h"
#include "sampler.h"
#include "techniques/screen_rig.h"

namespace lightwell::test {

inline LWImage imageOf(const studio::PlanarBuffer& buffer) {
    LWImage image{};
    image.host = const_cast<float*>(buffer.data());
    image.format = LW_FORMAT_PLANAR_FLOAT3;
    image.width = std::uint32_t(buffer.width());
    image.height = std::uint32_t(buffer.height());
    image.byteRowStride = std::int64_t(buffer.rowFloats()) * 4;
    image.bytePlaneStride = std::int64_t(buffer.planeFloats()) * 4;
    return image;
}

struct SceneView {
    int width, height;
    std::shared_ptr<const studio::Scene> scene;
    studio::RayScene rays;
    studio::Camera camera;
    studio::GBuffer pixels;
    studio::EmitterSet emitters;

    SceneView(const std::string& name, int columns, int rows)
        : width(columns),
          height(rows),
          scene(std::make_shared<studio::Scene>(studio::loadScene(name))),
          rays(scene, 0.0f),
          camera(scene->cameraAt(0, 0.0f)),
          pixels(studio::renderGBuffer(rays, camera, width, height, camera, 0.0f)),
          emitters(rays) {}

    bool hasSurface(int x, int y) const { return glm::length(pixels.normal.rgb(x, y)) > 0.5f; }

    bool seesCamera(const studio::Hit& hit) const {
        const glm::vec4 clip = camera.projectionMatrix(width, height) * camera.viewMatrix() * glm::vec4(hit.position, 1.0f);
        if (!(clip.w > 0.0f) || std::fabs(clip.x) > clip.w || std::fabs(clip.y) > clip.w) return false;
        const glm::vec3 way = camera.position - hit.position;
        const float length = glm::length(way);
        return glm::dot(way, hit.geometricNormal) > 0.0f &&
               !rays.occluded(rays.offset(hit.position, hit.geometricNormal), way / length, 0.0f, 0.9999f * length);
    }

    // Light that a point sends towards anything, of the sum of channels.
    double sentBy(const studio::Hit& hit) const {
        const glm::vec3 arriving = rays.directIrradiance(hit.position, hit.geometricNormal, hit.normal) +
                                   emitters.irradiance(hit.position, hit.geometricNormal, hit.normal, 0);
        return double(glm::dot(hit.albedo, arriving));
    }

    // Cosine-distributed rays from a pixel: visit(direction, whether something is met, what). Those that start into the surface
    // that the shading normal leans away from are not visited.
    template <typename Visit>
    void castFrom(int x, int y, int count, std::uint64_t seed, Visit visit) const {
        const glm::vec3 p = pixels.position.rgb(x, y), n = glm::normalize(pixels.normal.rgb(x, y));
        studio::Hit own;
        own.geometricNormal = n;
        rays.trace(camera.position, glm::normalize(p - camera.position), 0.0f, 1e30f, own);
        const glm::vec3 origin = rays.offset(p, own.geometricNormal);
        for (int i = 0; i < count; ++i) {
            studio::Sampler sampler(seed, std::uint64_t(y) * std::uint64_t(width) + std::uint64_t(x), std::uint32_t(i));
            const glm::vec3 direction = studio::sampleCosine(n, sampler.next());
            if (glm::dot(direction, own.geometricNormal) <= 0.0f) continue;
            studio::Hit hit;
            const bool meets = rays.trace(origin, direction, 0.0f, 1e30f, hit);
            visit(direction, meets, hit);
        }
    }

    double depthOf(const glm::vec3& p) const { return glm::dot(p - camera.position, glm::normalize(camera.target - camera.position)); }
    // The image's height at distance 1.
    double heightAtOne() const { return 2.0 * std::tan(0.5 * double(camera.verticalFov)); }

    LWGBuffer gbuffer() const {
        LWGBuffer gbuffer{};
        gbuffer.structSize = sizeof gbuffer;
        gbuffer.position = imageOf(pixels.position);
        gbuffer.normal = imageOf(pixels.normal);
        gbuffer.directRadiance = imageOf(pixels.direct);
        // Rows one after another.
        const glm::mat4 matrix = glm::transpose(camera.viewMatrix()), projection = glm::transpose(camera.projectionMatrix(width, height));
        std::copy(&matrix[0][0], &matrix[0][0] + 16, gbuffer.camera.view);
        std::copy(&projection[0][0], &projection[0][0] + 16, gbuffer.camera.projection);
        return gbuffer;
    }
};

}  // namespace lightwell::test
