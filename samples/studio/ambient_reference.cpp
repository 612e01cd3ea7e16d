// Ambient occlusion by rays through the whole geometry, which a technique of the picture alone does not
// know.
//
// Source: S. Zhukov, A. Iones and G. Kronin, "An Ambient Light Illumination Model" (1998), with
// visibility cut off at a radius instead of a falloff: only so does an infinite wall have the closed
// form that tests/unit/ambient_reference_test.cpp holds this to.
#include "ambient_reference.h"

#include <cmath>

#include "integrator.h"

namespace studio {
namespace {

// All directions of the hemisphere alike: equal steps of height (Archimedes).
glm::vec3 sampleUniform(const glm::vec3& normal, glm::vec2 point) {
    const float z = point.x, r = std::sqrt(std::max(0.0f, 1.0f - z * z));
    const float angle = 2.0f * kPi * point.y;
    const glm::vec3 away = std::abs(normal.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    const glm::vec3 u = glm::normalize(glm::cross(normal, away)), v = glm::cross(normal, u);
    return u * (r * std::cos(angle)) + v * (r * std::sin(angle)) + normal * z;
}

}  // namespace

Film traceAmbient(const RayScene& scene, const GBuffer& view, const PixelSurfaces& pixels,
                  const PathTracerOptions& options) {
    Film film(view.width, view.height, {"ambient"}, 2);
    const int most = options.untilRelMse > 0.0 ? options.maxSamplesPerPixel : options.samplesPerPixel;
    Run run(scene, view, pixels, options, film, std::uint32_t(options.samplesPerPixel / 2),
            std::uint32_t(most / 2));
    const Camera& camera = view.camera;
    const glm::vec3 axis = glm::normalize(camera.target - camera.position);
    const float perDepth = float(options.ambient->radius) * 2.0f * std::tan(0.5f * camera.verticalFov);
    const bool isUniform = options.ambient->isUniform;

    run.fill([&](const Tile& tile, std::uint32_t first, std::uint32_t last) {
        forEachPixel(tile, film, pixels, [&](std::size_t pixel) {
            const Surface& at = pixels.surface[pixel];
            const glm::vec3 origin = scene.offset(at.position, at.geometricNormal);
            const float radius = perDepth * glm::dot(at.position - camera.position, axis);
            for (int half = 0; half < 2; ++half)
                for (std::uint32_t s = first; s < last; ++s) {
                    Sampler sampler(options.seed, 2 * pixel + std::size_t(half), s);
                    const glm::vec3 direction = isUniform ? sampleUniform(at.normal, sampler.next())
                                                          : sampleCosine(at.normal, sampler.next());
                    const bool isOpen = glm::dot(at.geometricNormal, direction) > 0.0f &&
                                        !scene.occluded(origin, direction, 0.0f, radius);
                    film.at(pixel, half)[0] += glm::dvec3(isOpen ? 1.0 : 0.0);
                }
        });
    });
    return film;
}

}  // namespace studio
