// Reflective shadow maps (Dachsbacher and Stamminger 2005) by casting one ray through each texel.
//
// A texel's flux is albedo times the flux incident through it: for a sun E_perp * A_texel with A_texel
// on the plane facing the light (the projected area already holds the cosine), for spots and points
// I(w) * Omega_texel with Omega_texel = 4 / (P00 P11 W H) * cos^3(angle to the axis).
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "gbuffer.h"
#include "parallel.h"
#include "rsm_cameras.h"

namespace studio {
namespace {

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

Rsm renderSun(const RayScene& scene, const Light& light, const SunFit& fit, const SunRect& rect,
              int size) {
    Rsm rsm = makeRsm(size);
    const LightAxes axes(light.direction);
    const RsmCamera camera = rsmCamera(fit, rect, axes);
    rsm.view = camera.view;
    rsm.projection = camera.projection;
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

Rsm renderFrustum(const RayScene& scene, const Light& light, const RsmFrustum& frustum, int size) {
    Rsm rsm = makeRsm(size);
    const LightAxes& axes = frustum.axes;
    const double tangent = std::tan(frustum.halfAngle);
    const RsmCamera camera = rsmCamera(scene, light.position, frustum);
    rsm.view = camera.view;
    rsm.projection = camera.projection;
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
    std::vector<Rsm> rsms;
    for (const RsmFrustum& frustum : rsmFrustums(light))
        rsms.push_back(renderFrustum(scene, light, frustum, options.size));
    return rsms;
}

}  // namespace studio
