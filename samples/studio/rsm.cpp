// Reflective shadow maps (Dachsbacher and Stamminger 2005) by casting one ray through each texel.
//
// A texel's flux is albedo times the flux incident through it: for a sun E_perp * A_texel with A_texel
// on the plane facing the light (the projected area already holds the cosine), for spots and points
// I(w) * Omega_texel with Omega_texel = 4 / (P00 P11 W H) * cos^3(angle to the axis).
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "gbuffer.h"
#include "parallel.h"
#include "sun_fit.h"

namespace studio {
namespace {

// A frustum this wide spends its texels at the rim; wider spots are drawn as faces of a cube.
constexpr float kWidestFrustum = 75.0f * kPi / 180.0f;
constexpr float kFar = std::numeric_limits<float>::infinity();

Rsm makeRsm(int size) {
    Rsm rsm;
    rsm.width = rsm.height = size;
    rsm.position = PlanarBuffer(size, size, 3);
    rsm.normal = PlanarBuffer(size, size, 3);
    rsm.flux = PlanarBuffer(size, size, 3);
    return rsm;
}

void store(Rsm& rsm, int x, int y, const Hit& hit, const glm::vec3& direction,
           const glm::vec3& incident) {
    rsm.position.setRgb(x, y, hit.position);
    // The lit side: an interpolated normal can lean away from a light that its face sees.
    rsm.normal.setRgb(x, y, glm::dot(hit.normal, direction) < 0.0f ? hit.normal : hit.geometricNormal);
    rsm.flux.setRgb(x, y, hit.albedo * incident);
}

glm::dmat4 viewOf(const LightAxes& axes, const glm::dvec3& eye) {
    const glm::dmat3 rows = glm::transpose(glm::dmat3(axes.right, axes.up, axes.back));
    glm::dmat4 view(rows);
    view[3] = glm::dvec4(-(rows * eye), 1.0);
    return view;
}

Rsm renderSun(const RayScene& scene, const Light& light, const SunFit& fit, const SunRect& rect,
              int size) {
    Rsm rsm = makeRsm(size);
    const LightAxes axes(light.direction);
    rsm.view = glm::mat4(viewOf(axes, axes.back * fit.nearBack));
    rsm.projection = glm::mat4(glm::orthoRH_ZO(rect.lower.x, rect.upper.x, rect.lower.y, rect.upper.y,
                                               0.0, fit.nearBack - fit.farBack));
    const glm::dvec2 texel = rect.size() / double(size);
    const glm::vec3 incident = light.emitted * float(texel.x * texel.y);
    parallelRows(size, [&](int y) {
        for (int x = 0; x < size; ++x) {
            const glm::dvec2 at(rect.lower.x + texel.x * (x + 0.5), rect.upper.y - texel.y * (y + 0.5));
            const glm::vec3 origin(axes.right * at.x + axes.up * at.y + axes.back * fit.nearBack);
            Hit hit;
            if (scene.trace(origin, light.direction, 0.0f, kFar, hit))
                store(rsm, x, y, hit, light.direction, incident);
        }
    });
    return rsm;
}

// What a finer cascade shows carries no flux in the coarser ones.
void cutFootprint(Rsm& coarse, const SunRect& rect, const SunRect& finer) {
    const glm::dvec2 texel = rect.size() / double(coarse.width);
    for (int y = 0; y < coarse.height; ++y)
        for (int x = 0; x < coarse.width; ++x) {
            const glm::dvec2 at(rect.lower.x + texel.x * (x + 0.5), rect.upper.y - texel.y * (y + 0.5));
            if (at.x > finer.lower.x && at.x < finer.upper.x && at.y > finer.lower.y &&
                at.y < finer.upper.y)
                coarse.flux.setRgb(x, y, glm::vec3(0.0f));
        }
}

Rsm renderFrustum(const RayScene& scene, const Light& light, const LightAxes& axes, double halfAngle,
                  int size) {
    Rsm rsm = makeRsm(size);
    const double tangent = std::tan(halfAngle);
    const glm::dvec3 eye(light.position);
    // Clip planes for depth outputs only: the farthest corner of the scene, and a share of that.
    glm::vec3 lower, upper;
    scene.boundsAlong(glm::mat3(1.0f), lower, upper);
    const double farPlane =
        glm::length(glm::max(glm::abs(eye - glm::dvec3(lower)), glm::abs(eye - glm::dvec3(upper))));
    rsm.view = glm::mat4(viewOf(axes, eye));
    rsm.projection = glm::mat4(glm::perspectiveRH_ZO(2.0 * halfAngle, 1.0, 1e-4 * farPlane, farPlane));
    const double areaAtUnit = 4.0 * tangent * tangent / (double(size) * size);
    parallelRows(size, [&](int y) {
        for (int x = 0; x < size; ++x) {
            const double u = (2.0 * (x + 0.5) / size - 1.0) * tangent,
                         v = (1.0 - 2.0 * (y + 0.5) / size) * tangent;
            const double cosine = 1.0 / std::sqrt(1.0 + u * u + v * v);
            const glm::vec3 direction((axes.right * u + axes.up * v - axes.back) * cosine);
            const glm::vec3 intensity = light.emitted * coneFalloff(light, direction);
            Hit hit;
            if (scene.trace(light.position, direction, 0.0f, kFar, hit))
                store(rsm, x, y, hit, direction,
                      intensity * float(areaAtUnit * cosine * cosine * cosine));
        }
    });
    return rsm;
}

std::vector<Rsm> renderSuns(const RayScene& scene, const Light& light, const RsmOptions& options) {
    const SunFit fit = fitSun(scene, light, options);
    std::vector<Rsm> rsms;
    for (std::size_t i = 0; i < fit.cascades.size(); ++i) {
        rsms.push_back(renderSun(scene, light, fit, fit.cascades[i], options.size));
        if (i > 0) cutFootprint(rsms[i], fit.cascades[i], fit.cascades[i - 1]);
    }
    return rsms;
}

// Cube around the light; the first face looks along `forward`, the last the other way.
std::vector<Rsm> renderFaces(const RayScene& scene, const Light& light, const glm::vec3& forward,
                             int faces, int size) {
    const LightAxes cube(forward);
    // Each face's "up" is an axis of the cube too, so that the faces tile the sphere.
    const LightAxes axes[6] = {cube,
                               {cube.right, cube.up},
                               {-cube.right, cube.up},
                               {cube.up, cube.back},
                               {-cube.up, -cube.back},
                               {cube.back, cube.up}};
    std::vector<Rsm> rsms;
    for (int i = 0; i < faces; ++i)
        rsms.push_back(renderFrustum(scene, light, axes[i], 0.25 * double(kPi), size));
    return rsms;
}

}  // namespace

std::vector<Rsm> renderRsms(const RayScene& scene, const Light& light, const RsmOptions& options) {
    constexpr int kLargest = 16384, kMostCascades = 8;
    if (options.size < 1 || options.size > kLargest)
        throw std::runtime_error(
            fmt::format("RSM size: expected 1 .. {}, got {}", kLargest, options.size));
    if (options.cascades < 1 || options.cascades > kMostCascades)
        throw std::runtime_error(
            fmt::format("cascades: expected 1 .. {}, got {}", kMostCascades, options.cascades));
    if (options.cascades > 1 && options.size % 2 != 0)
        throw std::runtime_error(
            fmt::format("RSM size with cascades: expected an even number, got {}", options.size));
    if (light.kind == LightKind::Sun) return renderSuns(scene, light, options);
    if (options.cascades != 1)
        throw std::runtime_error(
            fmt::format("cascades of light \"{}\": expected 1 (only suns have more), got {}", light.name,
                        options.cascades));
    if (light.kind == LightKind::Point)
        return renderFaces(scene, light, {0.0f, 0.0f, -1.0f}, 6, options.size);
    if (light.outerCone > kWidestFrustum)
        return renderFaces(scene, light, light.direction, 5, options.size);
    std::vector<Rsm> rsms;
    rsms.push_back(
        renderFrustum(scene, light, LightAxes(light.direction), double(light.outerCone), options.size));
    return rsms;
}

}  // namespace studio
