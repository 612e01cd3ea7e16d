// G-buffers by casting one ray through each pixel's centre.
//
// L_d = albedo / pi * E_direct with shadow rays to the punctual lights, and with the estimator of
// emitters.h where surfaces or a sky light the scene. Motion is exact for the camera and for rigid objects.
#include "gbuffer.h"

#include <cmath>
#include <limits>

#include "emitters.h"
#include "parallel.h"

namespace studio {
namespace {

// Motion of a surface that was behind the previous camera: no pixel of any image shows it.
constexpr float kNowhere = -65536.0f;

struct PixelRays {  // unit directions through pixel centres
    glm::vec3 forward, right, up;
    float width, height;

    PixelRays(const Camera& camera, int w, int h) : width(float(w)), height(float(h)) {
        const float tangent = std::tan(0.5f * camera.verticalFov);
        forward = glm::normalize(camera.target - camera.position);
        const glm::vec3 side = glm::normalize(glm::cross(forward, camera.up));
        up = glm::cross(side, forward) * tangent;
        right = side * (tangent * width / height);
    }
    glm::vec3 through(int x, int y) const {
        return glm::normalize(forward + right * (2.0f * (float(x) + 0.5f) / width - 1.0f) +
                              up * (1.0f - 2.0f * (float(y) + 0.5f) / height));
    }
};

// Pixel coordinates (x right, y down, centres at +0.5) of a world position; false behind the camera.
bool project(const glm::dmat4& clipFromWorld, const glm::vec3& p, int width, int height,
             glm::dvec2& pixel) {
    const glm::dvec4 clip = clipFromWorld * glm::dvec4(p, 1.0);
    if (clip.w <= 0.0) return false;
    pixel = {(clip.x / clip.w + 1.0) * 0.5 * width, (1.0 - clip.y / clip.w) * 0.5 * height};
    return true;
}

}  // namespace

GBuffer renderGBuffer(const RayScene& scene, const Camera& camera, int width, int height,
                      const Camera& previousCamera, float previousTime) {
    GBuffer g;
    g.camera = camera;
    g.previousCamera = previousCamera;
    g.width = width;
    g.height = height;
    for (PlanarBuffer* buffer : {&g.position, &g.normal, &g.albedo, &g.direct})
        *buffer = PlanarBuffer(width, height, 3);
    g.motion = PlanarBuffer(width, height, 2);
    g.depth = PlanarBuffer(width, height, 1);

    const PixelRays rays(camera, width, height);
    const glm::dmat4 previousClip = glm::dmat4(previousCamera.projectionMatrix(width, height)) *
                                    glm::dmat4(previousCamera.viewMatrix());
    const EmitterSet emitters(scene);

    parallelRows(height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            const glm::vec3 direction = rays.through(x, y);
            Hit hit;
            if (!scene.trace(camera.position, direction, 0.0f, std::numeric_limits<float>::infinity(),
                             hit))
                continue;
            glm::vec3 direct = scene.directIrradiance(hit.position, hit.geometricNormal, hit.normal);
            if (!emitters.empty())
                direct +=
                    emitters.irradiance(hit.position, hit.geometricNormal, hit.normal,
                                        std::uint32_t(y) * std::uint32_t(width) + std::uint32_t(x));
            g.position.setRgb(x, y, hit.position);
            g.normal.setRgb(x, y, hit.normal);
            g.albedo.setRgb(x, y, hit.albedo);
            g.direct.setRgb(x, y, hit.albedo / kPi * direct);
            g.depth.row(0, y)[x] = glm::dot(hit.position - camera.position, rays.forward);

            glm::dvec2 before;
            const bool seen =
                project(previousClip, scene.surfacePointAt(hit, previousTime), width, height, before);
            g.motion.row(0, y)[x] = seen ? float(before.x - (double(x) + 0.5)) : kNowhere;
            g.motion.row(1, y)[x] = seen ? float(before.y - (double(y) + 0.5)) : kNowhere;
        }
    });
    return g;
}

}  // namespace studio
