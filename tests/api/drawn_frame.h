// A frame of flat walls drawn by rays in double precision: any camera, one-sided walls, several lights
// with several maps each, positions or depth. Flux, direct light and motion follow their definitions;
// nothing is the library's.
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "lightwell/lightwell.h"
#include "support/camera_matrices.h"
#include "support/host_image.h"

namespace lightwell::test {

struct Wall {
    glm::dvec3 corner, u, v, albedo;
    glm::dvec3 normal() const { return glm::normalize(glm::cross(u, v)); }
};

// The six walls of a box; their normals point in or out.
inline void addBox(std::vector<Wall>& walls, const glm::dvec3& lo, const glm::dvec3& hi, bool inward,
                   const glm::dvec3& albedo) {
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
            glm::dvec3 u(0.0), v(0.0), corner = lo;
            const int a = (axis + 1) % 3, b = (axis + 2) % 3;  // u x v points along +axis
            u[a] = hi[a] - lo[a];
            v[b] = hi[b] - lo[b];
            if (side) corner[axis] = hi[axis];
            // Every wall has a grey of its own.
            const glm::dvec3 grey = albedo * (1.0 - 0.12 * (2 * axis + side));
            if ((side == 1) == inward) std::swap(u, v);
            walls.push_back({corner, u, v, grey});
        }
}

inline TestCamera lookingAt(const glm::dvec3& eye, const glm::dvec3& target, double halfWidth,
                            double halfHeight) {
    TestCamera camera = testCamera(kRightHanded, eye);
    camera.forward = glm::normalize(target - eye);
    const glm::dvec3 up = std::abs(camera.forward.y) > 0.99 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    camera.right = glm::normalize(glm::cross(camera.forward, up));
    camera.up = glm::cross(camera.right, camera.forward);
    camera.rightEdge = halfWidth;
    camera.left = -halfWidth;
    camera.top = halfHeight;
    camera.bottom = -halfHeight;
    return camera;
}

inline TestCamera orthographic(TestCamera camera) {
    camera.orthographic = true;
    return camera;
}

struct Hit {
    double t = std::numeric_limits<double>::infinity();
    const Wall* wall = nullptr;
    glm::dvec3 position{0.0};
};

// `oneSided`: walls seen from behind are not there, as with back faces culled.
inline Hit cast(const std::vector<Wall>& walls, const glm::dvec3& from, const glm::dvec3& way,
                bool oneSided, double farthest = std::numeric_limits<double>::infinity()) {
    Hit hit;
    for (const Wall& wall : walls) {
        const glm::dvec3 n = wall.normal();
        const double slope = glm::dot(n, way);
        if (slope == 0.0 || (oneSided && slope > 0.0)) continue;
        const double t = glm::dot(wall.corner - from, n) / slope;
        if (!(t > 1e-9) || t >= std::min(hit.t, farthest)) continue;
        const glm::dvec3 p = from + way * t, q = p - wall.corner;
        const double a = glm::dot(q, wall.u) / glm::dot(wall.u, wall.u),
                     b = glm::dot(q, wall.v) / glm::dot(wall.v, wall.v);
        if (a < 0.0 || a > 1.0 || b < 0.0 || b > 1.0) continue;
        hit = {t, &wall, p};
    }
    return hit;
}

inline glm::dvec3 facing(const Wall& wall, const glm::dvec3& way) {
    const glm::dvec3 n = wall.normal();
    return glm::dot(n, way) > 0.0 ? -n : n;
}

struct RayOf {
    glm::dvec3 from, way;  // `way` is 1 long along the axis
};
inline RayOf rayOf(const TestCamera& camera, std::uint32_t x, std::uint32_t y, std::uint32_t width,
                   std::uint32_t height) {
    const double u = (x + 0.5) / width, v = (y + 0.5) / height;
    const glm::dvec3 from = camera.orthographic ? camera.point(u, v, 0.0) : camera.eye;
    return {from, camera.point(u, v, 1.0) - from};
}

struct DrawnLight {
    LWLight light{};
    std::vector<TestCamera> cameras;
    std::vector<LWRsm> rsms;
    std::vector<HostImage> images;  // position, normal, flux of each map

    static DrawnLight sun(const glm::dvec3& direction, double irradiance, const glm::dvec3& target,
                          double halfSize) {
        DrawnLight l = of(LW_LIGHT_DIRECTIONAL, target - 10.0 * direction, direction);
        for (float& v : l.light.irradiance) v = float(irradiance);
        l.cameras = {orthographic(lookingAt(target - 10.0 * direction, target, halfSize, halfSize))};
        return l;
    }
    static DrawnLight spot(const glm::dvec3& position, const glm::dvec3& target, double intensity,
                           double outer = 0.7) {
        DrawnLight l = of(LW_LIGHT_SPOT, position, glm::normalize(target - position));
        for (float& v : l.light.radiantIntensity) v = float(intensity);
        l.light.innerConeAngle = float(0.7 * outer);
        l.light.outerConeAngle = float(outer);
        l.cameras = {lookingAt(position, target, std::tan(outer), std::tan(outer))};
        return l;
    }
    static DrawnLight lamp(const glm::dvec3& position, double intensity) {
        DrawnLight l = of(LW_LIGHT_POINT, position, glm::dvec3(0.0));
        for (float& v : l.light.radiantIntensity) v = float(intensity);
        for (int face = 0; face < 6; ++face) {
            glm::dvec3 way(0.0);
            way[face / 2] = face % 2 ? -1.0 : 1.0;
            l.cameras.push_back(lookingAt(position, position + way, 1.0, 1.0));
        }
        return l;
    }
    // Irradiance over that of a surface facing the light at distance 1 (lamps).
    double falloff(const glm::dvec3& way) const {
        if (light.kind != LW_LIGHT_SPOT) return 1.0;
        const glm::dvec3 axis(light.direction[0], light.direction[1], light.direction[2]);
        const double inner = std::cos(double(light.innerConeAngle)),
                     outer = std::cos(double(light.outerConeAngle));
        const double ramp =
            (glm::dot(glm::normalize(way), glm::normalize(axis)) - outer) / (inner - outer);
        return std::pow(std::min(1.0, std::max(0.0, ramp)), 2.0);
    }

private:
    static DrawnLight of(LWLightKind kind, const glm::dvec3& position, const glm::dvec3& direction) {
        DrawnLight l;
        l.light.structSize = sizeof l.light;
        l.light.kind = kind;
        for (int c = 0; c < 3; ++c) {
            l.light.position[c] = kind == LW_LIGHT_DIRECTIONAL ? 0.0f : float(position[c]);
            l.light.direction[c] = float(direction[c]);
        }
        return l;
    }
};

class DrawnFrame {
public:
    std::vector<Wall> walls;
    std::vector<DrawnLight> lights;
    bool oneSided = false;  // for the camera; lights see both sides
    bool useDepth = false;
    LWDepthKind depthKind = LW_DEPTH_ZERO_TO_ONE;
    LWFormat positionFormat = LW_FORMAT_FLOAT3, normalFormat = LW_FORMAT_FLOAT3;
    std::uint32_t rsmSize = 64;

    HostImage position, normal, albedo, direct, motion, depth;
    LWGBuffer gbuffer{};
    LWFrame frame{};

    // A room with a block in it, for a camera inside.
    static void furnish(DrawnFrame& f, const glm::dvec3& offset = glm::dvec3(0.0), double albedo = 0.8) {
        addBox(f.walls, offset + glm::dvec3(-4, 0, -4), offset + glm::dvec3(4, 5, 4), true,
               glm::dvec3(albedo));
        addBox(f.walls, offset + glm::dvec3(-1, 0, -2), offset + glm::dvec3(1, 2, 0), false,
               glm::dvec3(albedo));
    }

    void draw(const TestCamera& camera, std::uint32_t width, std::uint32_t height,
              const TestCamera* before = nullptr) {
        position = HostImage(positionFormat, width, height);
        normal = HostImage(normalFormat, width, height);
        albedo = HostImage(LW_FORMAT_FLOAT3, width, height);
        direct = HostImage(LW_FORMAT_FLOAT3, width, height);
        motion = HostImage(LW_FORMAT_FLOAT2, width, height);
        depth = HostImage(LW_FORMAT_FLOAT1, width, height);
        const TestCamera& previous = before ? *before : camera;
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) drawPixel(camera, previous, x, y);
        for (DrawnLight& light : lights) drawMaps(light);
        gbuffer = {};
        gbuffer.structSize = sizeof gbuffer;
        gbuffer.depthKind = depthKind;
        if (useDepth)
            gbuffer.depth = depth.image();
        else
            gbuffer.position = position.image();
        gbuffer.normal = normal.image();
        gbuffer.albedo = albedo.image();
        gbuffer.directRadiance = direct.image();
        gbuffer.motion = motion.image();
        gbuffer.camera = camera.matrices();
        gbuffer.previousCamera = previous.matrices();
        describeLights();
    }

    // After a change of the lights' own fields.
    void describeLights() {
        raw_.clear();
        for (DrawnLight& light : lights) {
            light.light.rsms = light.rsms.data();
            light.light.rsmCount = std::uint32_t(light.rsms.size());
            raw_.push_back(light.light);
        }
        frame = {};
        frame.structSize = sizeof frame;
        frame.lights = raw_.data();
        frame.lightCount = std::uint32_t(raw_.size());
    }

private:
    void drawPixel(const TestCamera& camera, const TestCamera& previous, std::uint32_t x,
                   std::uint32_t y) {
        const std::uint32_t width = normal.width(), height = normal.height();
        const RayOf ray = rayOf(camera, x, y, width, height);
        const Hit hit = cast(walls, ray.from, ray.way, oneSided);
        if (!hit.wall) {
            position.set(x, y, 0, 0, 0);
            normal.set(x, y, 0, 0, 0, true);
            albedo.set(x, y, 0, 0, 0);
            direct.set(x, y, 0, 0, 0);
            motion.set(x, y, 0, 0);
            const bool distance = depthKind == LW_DEPTH_AXIAL || depthKind == LW_DEPTH_RADIAL;
            depth.set(x, y, distance || camera.reversed ? 0.0 : 1.0);
            return;
        }
        const glm::dvec3 p = hit.position, n = facing(*hit.wall, ray.way), rho = hit.wall->albedo;
        position.set(x, y, p.x, p.y, p.z);
        normal.set(x, y, n.x, n.y, n.z, true);
        albedo.set(x, y, rho.x, rho.y, rho.z);
        const double e = irradianceAt(p, n) / 3.14159265358979323846;
        direct.set(x, y, rho.x * e, rho.y * e, rho.z * e);
        depth.set(x, y, camera.depth(p, depthKind));
        const glm::dvec3 q = p - previous.eye;
        const double scale = previous.orthographic ? 1.0 : glm::dot(q, previous.forward);
        const double u =
            (glm::dot(q, previous.right) / scale - previous.left) / (previous.rightEdge - previous.left);
        const double v =
            (glm::dot(q, previous.up) / scale - previous.top) / (previous.bottom - previous.top);
        motion.set(x, y, u * width - x - 0.5, v * height - y - 0.5);
    }
    double irradianceAt(const glm::dvec3& p, const glm::dvec3& n) const {
        double sum = 0.0;
        for (const DrawnLight& l : lights) {
            const bool sun = l.light.kind == LW_LIGHT_DIRECTIONAL;
            const glm::dvec3 d(l.light.direction[0], l.light.direction[1], l.light.direction[2]);
            const glm::dvec3 way =
                sun ? d * 1e3
                    : p - glm::dvec3(l.light.position[0], l.light.position[1], l.light.position[2]);
            const double cosine = glm::dot(n, -glm::normalize(way));
            if (cosine <= 0.0 || cast(walls, p + 1e-6 * n, -way, false, 1.0 - 1e-6).wall) continue;
            sum +=
                sun ? double(l.light.irradiance[0]) * cosine
                    : double(l.light.radiantIntensity[0]) * l.falloff(way) * cosine / glm::dot(way, way);
        }
        return sum;
    }
    void drawMaps(DrawnLight& l) const {
        l.images.clear();
        l.rsms.clear();
        const bool sun = l.light.kind == LW_LIGHT_DIRECTIONAL;
        for (const TestCamera& camera : l.cameras) {
            HostImage places(LW_FORMAT_FLOAT3, rsmSize, rsmSize),
                normals(LW_FORMAT_FLOAT3, rsmSize, rsmSize), flux(LW_FORMAT_FLOAT3, rsmSize, rsmSize);
            const double texel =
                (camera.rightEdge - camera.left) * (camera.top - camera.bottom) / (rsmSize * rsmSize);
            for (std::uint32_t y = 0; y < rsmSize; ++y)
                for (std::uint32_t x = 0; x < rsmSize; ++x) {
                    const RayOf ray = rayOf(camera, x, y, rsmSize, rsmSize);
                    const Hit hit = cast(walls, ray.from, ray.way, false);
                    if (!hit.wall) {
                        places.set(x, y, 0, 0, 0);
                        normals.set(x, y, 0, 0, 0);
                        flux.set(x, y, 0, 0, 0);
                        continue;
                    }
                    const glm::dvec3 p = hit.position, n = facing(*hit.wall, ray.way),
                                     rho = hit.wall->albedo;
                    const double through = sun ? double(l.light.irradiance[0]) * texel
                                               : double(l.light.radiantIntensity[0]) *
                                                     l.falloff(ray.way) * texel /
                                                     std::pow(glm::length(ray.way), 3.0);
                    places.set(x, y, p.x, p.y, p.z);
                    normals.set(x, y, n.x, n.y, n.z);
                    flux.set(x, y, rho.x * through, rho.y * through, rho.z * through);
                }
            l.images.push_back(std::move(places));
            l.images.push_back(std::move(normals));
            l.images.push_back(std::move(flux));
        }
        for (std::size_t k = 0; k < l.cameras.size(); ++k) {
            LWRsm rsm{};
            rsm.structSize = sizeof rsm;
            rsm.position = l.images[3 * k].image();
            rsm.normal = l.images[3 * k + 1].image();
            rsm.flux = l.images[3 * k + 2].image();
            rsm.camera = l.cameras[k].matrices();
            l.rsms.push_back(rsm);
        }
    }

    std::vector<LWLight> raw_;
};

}  // namespace lightwell::test
