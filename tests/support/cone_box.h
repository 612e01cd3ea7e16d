// Closed boxes for tests of technique cone_tracing: walls as triangles, each lit evenly or not as its own RSM says, and a view from inside.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "support/packed_light.h"
#include "support/scoped_api.h"
#include "support/view_scene.h"

namespace lightwell::test {

// A rectangle lit straight from its normal's side: corner, sides u and v, normal v x u. profile(a, b) with a, b in [0, 1]: the
// reflected exitance (W/m^2), grey.
struct LitWall {
    PlanarPixels position, normal, flux;
    LWRsm rsm{};
    LWLight light{};

    LitWall(std::uint32_t size, glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, const std::function<double(double, double)>& profile)
        : position(size, size, 3), normal(size, size, 3), flux(size, size, 3) {
        const double wide = glm::length(u), high = glm::length(v), texel = wide * high / (double(size) * size);
        const glm::dvec3 right = u / wide, up = -v / high, n = glm::cross(right, up);
        const auto vec = [](glm::dvec3 p) { return reference::Vec{p.x, p.y, p.z}; };
        for (std::uint32_t j = 0; j < size; ++j)
            for (std::uint32_t i = 0; i < size; ++i) {
                const double a = (i + 0.5) / size, b = (j + 0.5) / size;
                position.set(i, j, vec(corner + u * a + v * b));
                normal.set(i, j, vec(n));
                flux.set(i, j, vec(glm::dvec3(profile(a, b) * texel)));
            }
        rsm.structSize = sizeof rsm;
        rsm.position = position.image();
        rsm.normal = normal.image();
        rsm.flux = flux.image();
        const glm::dvec3 eye = corner + 0.5 * (u + v) + n * wide;
        const glm::dvec3 axes[3] = {right, up, n};
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column) rsm.camera.view[4 * row + column] = float(axes[row][column]);
            rsm.camera.view[4 * row + 3] = float(-glm::dot(axes[row], eye));
        }
        rsm.camera.view[15] = 1.0f;
        rsm.camera.projection[0] = float(2.0 / wide);
        rsm.camera.projection[5] = float(2.0 / high);
        rsm.camera.projection[10] = float(-0.5 / wide);
        rsm.camera.projection[15] = 1.0f;
        light.structSize = sizeof light;
        light.kind = LW_LIGHT_DIRECTIONAL;
        for (int a = 0; a < 3; ++a) light.direction[a] = float(-n[a]);
        light.rsmCount = 1;
        light.rsms = &rsm;
    }
    LitWall(const LitWall&) = delete;
};

// Two triangles of a rectangle each time, that face the way of v x u as LitWall does.
struct WallTriangles {
    std::vector<float> vertices, albedo, emission;
    LWGeometry geometry{};

    void quad(glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, double reflects = 0.5, double emits = 0.0) {
        for (const glm::dvec3& p : {corner, corner + v, corner + u + v, corner, corner + u + v, corner + u})
            for (int a = 0; a < 3; ++a) vertices.push_back(float(p[a]));
        for (int k = 0; k < 6; ++k) {
            albedo.push_back(float(reflects));
            emission.push_back(float(emits));
        }
        geometry.structSize = sizeof geometry;
        geometry.vertices = vertices.data();
        geometry.triangleAlbedo = albedo.data();
        geometry.triangleEmission = emission.data();
        geometry.vertexCount = std::uint32_t(vertices.size() / 3);
        geometry.triangleCount = geometry.vertexCount / 3;
        geometry.version = 1;
    }
};

// The cube from -1 to 1, lengths times `scale`. Its walls reflect `exitance` in all, or emit it.
struct ConeBox {
    ViewScene walls;
    WallTriangles triangles;
    std::vector<std::unique_ptr<LitWall>> lit;
    std::vector<LWLight> lights;
    LWFrame frame{};

    explicit ConeBox(double exitance, bool emits = false, double scale = 1.0, double albedo = 0.5, std::uint32_t texels = 128) {
        const glm::dvec3 axes[] = {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}, low(-1, -1, -1);
        for (std::size_t a = 0; a < 3; ++a)
            for (const bool far : {false, true}) {
                // v x u points inwards.
                const glm::dvec3 first = axes[(a + 1) % 3], second = axes[(a + 2) % 3], u = far ? first : second, v = far ? second : first,
                                 corner = low + (far ? axes[a] : glm::dvec3(0));
                walls.quad(corner, u, v, exitance / kPi);
                triangles.quad(corner * scale, u * scale, v * scale, albedo, emits ? exitance / kPi : 0.0);
                if (emits) continue;
                lit.push_back(std::make_unique<LitWall>(texels, corner * scale, u * scale, v * scale, [=](double, double) { return exitance; }));
                lights.push_back(lit.back()->light);
            }
        frame.structSize = sizeof frame;
        frame.lights = lights.data();
        frame.lightCount = std::uint32_t(lights.size());
        frame.geometry = &triangles.geometry;
    }
    ConeBox(const ConeBox&) = delete;

    static constexpr double kPi = 3.14159265358979323846;
};

inline LWConeTracingDesc coneDesc(std::uint32_t size, LWVoxelMode mode = LW_VOXEL_MODE_ANISOTROPIC,
                                  LWConeResolution resolution = LW_CONE_RESOLUTION_FULL) {
    LWConeTracingDesc desc;
    lwDefaultConeTracing(&desc);
    desc.size = size;
    desc.mode = mode;
    desc.resolution = resolution;
    return desc;
}

// Of a technique made for this frame alone.
inline std::vector<float> renderCones(LWDevice device, const LWConeTracingDesc& desc, const LWFrame& frame, const LWGBuffer& gbuffer,
                                      std::uint32_t width, std::uint32_t height, int frames = 1) {
    TestTechnique technique(device, "cone_tracing", &desc);
    TestView view(device, width, height);
    for (int f = 0; f < frames; ++f) technique.update(frame);
    return technique.render(view, gbuffer);
}

}  // namespace lightwell::test
