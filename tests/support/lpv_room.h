// The lit room of lit_room.h as a host's triangles, and how far light on its ceiling is from the closed form.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "support/lit_room.h"

namespace lightwell::test {

// Floor and back wall, and a lid at a height: 1 the ceiling, less a plate below it. turned: triangles the other way round.
struct RoomTriangles {
    std::vector<float> vertices;
    LWGeometry geometry{};
    explicit RoomTriangles(std::optional<double> lid, double scale = 1.0, bool turned = false) {
        quad({-0.5, 0, 0}, {0, 0, 1}, {1, 0, 0}, scale, turned);
        quad({-0.5, 0, 0}, {1, 0, 0}, {0, 1, 0}, scale, turned);
        if (lid) quad({-0.5, *lid, 0}, {1, 0, 0}, {0, 0, 1}, scale, turned);
        geometry.structSize = sizeof geometry;
        geometry.vertices = vertices.data();
        geometry.vertexCount = std::uint32_t(vertices.size() / 3);
        geometry.triangleCount = geometry.vertexCount / 3;
    }
    RoomTriangles(const RoomTriangles&) = delete;

    // Adds two triangles; `geometry` does not follow.
    void quad(reference::Vec p, reference::Vec u, reference::Vec v, double scale, bool turned) {
        if (turned) std::swap(u, v);
        for (const reference::Vec corner : {p, p + u, p + u + v, p, p + u + v, p + v})
            for (const double x : {corner.x, corner.y, corner.z}) vertices.push_back(float(x * scale));
    }
};

// Root of the mean squared error of packed light by that of the polygon's, a floor of exitance 1, over the ceiling's pixels: the
// picture's lower half but for its first column, whose cells lie in the side's own.
template <typename Scene>
double ceilingError(const std::vector<float>& light, const Scene& scene, std::uint32_t width, std::uint32_t height) {
    double squared = 0.0, truths = 0.0;
    for (std::uint32_t y = height / 2; y < height; ++y)
        for (std::uint32_t x = 1; x < width; ++x) {
            const double truth = polygonIrradiance({{-0.5, 0, 0}, {-0.5, 0, 1}, {0.5, 0, 1}, {0.5, 0, 0}}, scene.position.get(x, y),
                                                   {0, -1, 0}, 1.0);
            squared += std::pow(double(light[y * width + x]) - truth, 2.0);
            truths += truth * truth;
        }
    return std::sqrt(squared / truths);
}

// Its lights, and triangles or none.
inline LWFrame roomFrame(const std::vector<LWLight>& lights, const LWGeometry* geometry) {
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.lights = lights.data();
    frame.lightCount = std::uint32_t(lights.size());
    frame.geometry = geometry;
    return frame;
}

}  // namespace lightwell::test
