#include "rsm_cameras.h"

#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

namespace studio {
namespace {

// A frustum this wide spends its texels at the rim; wider spots are drawn as faces of a cube.
constexpr float kWidestFrustum = 75.0f * kPi / 180.0f;

glm::dmat4 viewOf(const LightAxes& axes, const glm::dvec3& eye) {
    const glm::dmat3 rows = glm::transpose(glm::dmat3(axes.right, axes.up, axes.back));
    glm::dmat4 view(rows);
    view[3] = glm::dvec4(-(rows * eye), 1.0);
    return view;
}

// Cube around the light; the first face looks along `forward`, the last the other way.
std::vector<RsmFrustum> cubeFaces(const glm::vec3& forward, std::size_t count) {
    const LightAxes cube(forward);
    // Each face's "up" is an axis of the cube too, so that the faces tile the sphere.
    const LightAxes axes[6] = {cube,
                               {cube.right, cube.up},
                               {-cube.right, cube.up},
                               {cube.up, cube.back},
                               {-cube.up, -cube.back},
                               {cube.back, cube.up}};
    std::vector<RsmFrustum> faces;
    for (std::size_t i = 0; i < count; ++i) faces.push_back({axes[i], 0.25 * double(kPi)});
    return faces;
}

}  // namespace

std::vector<RsmFrustum> rsmFrustums(const Light& light) {
    if (light.kind == LightKind::Point) return cubeFaces({0.0f, 0.0f, -1.0f}, 6);
    if (light.outerCone > kWidestFrustum) return cubeFaces(light.direction, 5);
    return {{LightAxes(light.direction), double(light.outerCone)}};
}

RsmCamera rsmCamera(const SunFit& fit, const SunRect& rect, const LightAxes& axes) {
    return {glm::mat4(viewOf(axes, axes.back * fit.nearBack)),
            glm::mat4(glm::orthoRH_ZO(rect.lower.x, rect.upper.x, rect.lower.y, rect.upper.y, 0.0,
                                      fit.nearBack - fit.farBack))};
}

RsmCamera rsmCamera(const RayScene& scene, const glm::vec3& eye, const RsmFrustum& frustum) {
    // Clip planes: the farthest corner of the scene, and a share of that.
    glm::vec3 lower, upper;
    scene.boundsAlong(glm::mat3(1.0f), lower, upper);
    const glm::dvec3 from(eye);
    const double farPlane =
        glm::length(glm::max(glm::abs(from - glm::dvec3(lower)), glm::abs(from - glm::dvec3(upper))));
    return {glm::mat4(viewOf(frustum.axes, from)),
            glm::mat4(glm::perspectiveRH_ZO(2.0 * frustum.halfAngle, 1.0, 1e-4 * farPlane, farPlane))};
}

std::vector<RsmCamera> rsmCameras(const RayScene& scene, const Light& light, const RsmOptions& options) {
    std::vector<RsmCamera> cameras;
    if (light.kind == LightKind::Sun) {
        const SunFit fit = fitSun(scene, light, options);
        for (const SunRect& rect : fit.cascades) cameras.push_back(rsmCamera(fit, rect, LightAxes(light.direction)));
    } else {
        for (const RsmFrustum& frustum : rsmFrustums(light)) cameras.push_back(rsmCamera(scene, light.position, frustum));
    }
    return cameras;
}

double rsmTexelMeasure(const glm::mat4& projection, int size) {
    return 4.0 / (double(projection[0][0]) * double(projection[1][1]) * double(size) * double(size));
}

}  // namespace studio
