// G-buffers of parallelograms and spheres, ray-cast in double precision, for tests of techniques that look at the view's
// own pixels: everything they see is known by formula.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "support/camera_matrices.h"
#include "support/lit_room.h"

namespace lightwell::test {

struct ViewScene {
    struct Quad {
        glm::dvec3 corner, u, v, normal;
        double radiance;
        bool receiveOnly;
    };
    struct Sphere {
        glm::dvec3 centre;
        double radius, radiance;
    };
    std::vector<Quad> quads;
    std::vector<Sphere> spheres;

    // Seen from both sides; the normal is that of the eye's side.
    void quad(glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, double radiance = 0.0, bool receiveOnly = false) {
        quads.push_back({corner, u, v, glm::normalize(glm::cross(u, v)), radiance, receiveOnly});
    }

    struct Hit {
        double distance = HUGE_VAL, radiance = 0.0;
        glm::dvec3 position{0.0}, normal{0.0};
        bool receiveOnly = false;
        explicit operator bool() const { return distance < HUGE_VAL; }
    };
    Hit cast(const glm::dvec3& from, const glm::dvec3& direction) const {
        Hit hit;
        for (const Quad& q : quads) {
            const double along = glm::dot(direction, q.normal);
            if (along == 0.0) continue;
            const double t = glm::dot(q.corner - from, q.normal) / along;
            const glm::dvec3 p = from + direction * t - q.corner;
            // Coordinates in the parallelogram's own axes.
            const double uu = glm::dot(q.u, q.u), uv = glm::dot(q.u, q.v), vv = glm::dot(q.v, q.v), d = uu * vv - uv * uv;
            const double a = (vv * glm::dot(p, q.u) - uv * glm::dot(p, q.v)) / d;
            const double b = (uu * glm::dot(p, q.v) - uv * glm::dot(p, q.u)) / d;
            if (t < 1e-9 || t >= hit.distance || a < 0.0 || a > 1.0 || b < 0.0 || b > 1.0) continue;
            hit = {t, q.radiance, from + direction * t, along < 0.0 ? q.normal : -q.normal, q.receiveOnly};
        }
        for (const Sphere& s : spheres) {
            const double b = glm::dot(direction, s.centre - from), c = glm::dot(s.centre - from, s.centre - from) - s.radius * s.radius;
            const double t = b - std::sqrt(std::fmax(b * b - c, 0.0));
            if (b * b < c || t < 1e-9 || t >= hit.distance) continue;
            const glm::dvec3 p = from + direction * t;
            hit = {t, s.radiance, p, (p - s.centre) / s.radius, false};
        }
        return hit;
    }
};

// What a camera sees of it; lengths times `scale`.
struct DrawnView {
    PlanarPixels position, normal, radiance, receiveMask;
    LWGBuffer gbuffer{};

    DrawnView(const ViewScene& scene, const TestCamera& camera, std::uint32_t width, std::uint32_t height, double scale = 1.0)
        : position(width, height, 3), normal(width, height, 3), radiance(width, height, 3), receiveMask(width, height, 1) {
        const auto vec = [](const glm::dvec3& v) { return reference::Vec{v.x, v.y, v.z}; };
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                const double u = (x + 0.5) / width, v = (y + 0.5) / height;
                const glm::dvec3 from = camera.orthographic ? camera.point(u, v, 0.0) : camera.eye;
                const ViewScene::Hit hit = scene.cast(from, glm::normalize(camera.point(u, v, 1.0) - from));
                if (!hit) continue;
                position.set(x, y, vec(hit.position * scale));
                normal.set(x, y, vec(hit.normal));
                radiance.set(x, y, vec(glm::dvec3(hit.radiance)));
                receiveMask.at(x, y, 0) = hit.receiveOnly ? 1.0f : 0.0f;
            }
        TestCamera scaled = camera;
        scaled.eye *= scale;
        scaled.near *= scale;
        scaled.far *= scale;
        if (camera.orthographic) scaled.left *= scale, scaled.rightEdge *= scale, scaled.bottom *= scale, scaled.top *= scale;
        gbuffer.structSize = sizeof gbuffer;
        gbuffer.position = position.image();
        gbuffer.normal = normal.image();
        gbuffer.directRadiance = radiance.image();
        gbuffer.receiveMask = receiveMask.image();
        gbuffer.camera = scaled.matrices();
    }
    DrawnView(const DrawnView&) = delete;
};

// At `eye`, looking at `target`; half the window's height at distance 1.
inline TestCamera lookAt(const glm::dvec3& eye, const glm::dvec3& target, double halfHeight, double aspect = 4.0 / 3.0) {
    TestCamera camera{};
    camera.eye = eye;
    camera.forward = glm::normalize(target - eye);
    camera.right = glm::normalize(glm::cross(camera.forward, glm::dvec3(0, 1, 0)));
    camera.up = glm::cross(camera.right, camera.forward);
    camera.bottom = -halfHeight;
    camera.top = halfHeight;
    camera.left = -halfHeight * aspect;
    camera.rightEdge = halfHeight * aspect;
    camera.near = 0.01;
    camera.far = 1000.0;
    return camera;
}

// The three outputs of techniques that look at the view's own pixels, packed; empty where not asked for.
struct ScreenResult {
    std::vector<float> irradiance, validity, ambient;
};
enum ScreenOutputs : unsigned { kIrradiance = 1, kValidity = 2, kAmbient = 4 };

}  // namespace lightwell::test
