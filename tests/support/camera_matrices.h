// Cameras of several conventions, written out by hand: where a pixel's points lie and what depth they
// have, in double precision, without inverting anything.
#pragma once

#include <cmath>
#include <glm/glm.hpp>

#include "lightwell/lightwell.h"

namespace lightwell::test {

enum TestCameraKind {
    kRightHanded,       // looks along -z of view space, depth 0 near, 1 far
    kLeftHanded,        // looks along +z
    kReversed,          // depth 1 near, 0 far
    kReversedInfinite,  // depth 1 near, 0 at infinity
    kOffCentre,         // an asymmetric frustum
    kOpenGL,            // clip z / w in [-1, 1]
    kOrthographic,      // right-handed
    kOrthographicLeftReversed,
    kTestCameraCount
};

struct TestCamera {
    const char* name;
    glm::dvec3 eye, right, up, forward;
    double left, rightEdge, bottom, top;  // of the window, at distance 1 (perspective)
    double near, far;
    bool orthographic, leftHanded, reversed, infinite, openGL;

    // The point at image coordinates in [0,1] (from the top left) and a distance along the axis.
    glm::dvec3 point(double u, double v, double axial) const {
        const double x = left + (rightEdge - left) * u, y = top + (bottom - top) * v;
        const double scale = orthographic ? 1.0 : axial;
        return eye + right * (x * scale) + up * (y * scale) + forward * axial;
    }

    // clip z / w as a function of the distance along the axis: a + b / t, or a + b t.
    void curve(double& a, double& b) const {
        const double z0 = openGL     ? -1.0
                          : reversed ? 1.0
                                     : 0.0,
                     z1 = reversed ? 0.0 : 1.0;  // at near, far
        if (orthographic) {
            b = (z1 - z0) / (far - near);
            a = z0 - b * near;
        } else if (infinite) {
            a = 0.0;
            b = near;
        } else {
            b = (z0 - z1) * near * far / (far - near);
            a = z1 - b / far;
        }
    }

    bool supports(LWDepthKind kind) const {
        if (kind == LW_DEPTH_ZERO_TO_ONE) return !openGL;
        if (kind == LW_DEPTH_GL) return openGL;
        return true;
    }

    double depth(const glm::dvec3& p, LWDepthKind kind) const {
        const double t = glm::dot(p - eye, forward);
        if (kind == LW_DEPTH_RADIAL && !orthographic) return glm::length(p - eye);
        if (kind == LW_DEPTH_AXIAL || kind == LW_DEPTH_RADIAL) return t;
        double a, b;
        curve(a, b);
        const double z = orthographic ? a + b * t : a + b / t;
        return kind == LW_DEPTH_GL ? (z + 1) / 2 : z;
    }

    double depthSlope(double t, LWDepthKind kind) const {
        if (kind == LW_DEPTH_AXIAL || kind == LW_DEPTH_RADIAL) return 1.0;
        double a, b;
        curve(a, b);
        const double slope = std::fabs(orthographic ? b : b / (t * t));
        return kind == LW_DEPTH_GL ? slope / 2 : slope;
    }

    LWCamera matrices() const {
        LWCamera camera{};
        const double side = leftHanded ? 1.0 : -1.0;  // of view space's z that is forward
        const glm::dvec3 rows[3] = {right, up, forward * side};
        for (int r = 0; r < 3; ++r) {
            for (int c = 0; c < 3; ++c) camera.view[4 * r + c] = float(rows[r][c]);
            camera.view[4 * r + 3] = float(-glm::dot(rows[r], eye));
        }
        camera.view[15] = 1.0f;
        const double sx = 2 / (rightEdge - left), sy = 2 / (top - bottom);
        const double cx = -(rightEdge + left) / (rightEdge - left),
                     cy = -(top + bottom) / (top - bottom);
        double a, b;
        curve(a, b);
        float* p = camera.projection;
        p[0] = float(sx);
        p[5] = float(sy);
        if (orthographic) {
            p[3] = float(cx);
            p[7] = float(cy);
            p[10] = float(b * side);
            p[11] = float(a);
            p[15] = 1.0f;
        } else {
            p[2] = float(cx * side);
            p[6] = float(cy * side);
            p[10] = float(a * side);
            p[11] = float(b);
            p[14] = float(side);
        }
        return camera;
    }
};

// All look the same way, turned about y.
inline TestCamera testCamera(int kind, const glm::dvec3& eye) {
    TestCamera camera{};
    camera.eye = eye;
    camera.right = {0.6, 0, -0.8};
    camera.up = {0, 1, 0};
    camera.forward = {-0.8, 0, -0.6};
    camera.left = -0.75;
    camera.rightEdge = 0.75;
    camera.bottom = -0.5;
    camera.top = 0.5;
    camera.near = 0.125;
    camera.far = 64;
    static const char* const names[] = {
        "right-handed", "left-handed", "reversed",     "reversed, infinite",
        "off-centre",   "OpenGL",      "orthographic", "orthographic, left-handed, reversed"};
    camera.name = names[kind];
    camera.leftHanded = kind == kLeftHanded || kind == kOrthographicLeftReversed;
    camera.reversed =
        kind == kReversed || kind == kReversedInfinite || kind == kOrthographicLeftReversed;
    camera.infinite = kind == kReversedInfinite;
    camera.openGL = kind == kOpenGL;
    camera.orthographic = kind == kOrthographic || kind == kOrthographicLeftReversed;
    if (kind == kOffCentre) {
        camera.left = -0.25;
        camera.top = 0.75;
    }
    if (camera.orthographic) {
        camera.left *= 20;
        camera.rightEdge *= 20;
        camera.bottom *= 20;
        camera.top *= 20;
    }
    return camera;
}

}  // namespace lightwell::test
