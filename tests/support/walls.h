// Walls for tests of techniques that draw occluders, as triangles and as surfels.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "lightwell/lightwell.h"
#include "reference/surfaces.h"

namespace lightwell::test {

// Parallelograms as LWGeometry takes them.
struct Walls {
    std::vector<float> vertices;
    std::vector<std::array<reference::Vec, 3>> quads;  // corner, u, v
    LWGeometry geometry{};

    void add(reference::Vec corner, reference::Vec u, reference::Vec v) {
        quads.push_back({corner, u, v});
        for (const reference::Vec& p : {corner, corner + u, corner + u + v, corner, corner + u + v, corner + v})
            for (const double x : {p.x, p.y, p.z}) vertices.push_back(float(x));
    }
    const LWGeometry* describe(std::uint64_t version = 1) {
        geometry.structSize = sizeof geometry;
        geometry.vertices = vertices.data();
        geometry.vertexCount = std::uint32_t(vertices.size() / 3);
        geometry.triangleCount = geometry.vertexCount / 3;
        geometry.version = version;
        return &geometry;
    }
    // The same walls as surfels, each for a square of side near `spacing`; nothing else.
    const LWGeometry* describeSurfels(double spacing, std::uint64_t version = 1) {
        position_.clear();
        normal_.clear();
        area_.clear();
        for (const auto& [corner, u, v] : quads) {
            const auto length = [](reference::Vec a) { return std::sqrt(dot(a, a)); };
            const reference::Vec n{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
            const int columns = int(std::ceil(length(u) / spacing)), rows = int(std::ceil(length(v) / spacing));
            for (int j = 0; j < rows; ++j)
                for (int i = 0; i < columns; ++i) {
                    const reference::Vec p = corner + u * ((i + 0.5) / columns) + v * ((j + 0.5) / rows), m = unit(n);
                    for (const double x : {p.x, p.y, p.z}) position_.push_back(float(x));
                    for (const double x : {m.x, m.y, m.z}) normal_.push_back(float(x));
                    area_.push_back(float(length(n) / (columns * rows)));
                }
        }
        geometry = LWGeometry{};
        geometry.structSize = sizeof geometry;
        geometry.surfelCount = std::uint32_t(area_.size());
        geometry.surfelPosition = row(position_, LW_FORMAT_FLOAT3);
        geometry.surfelNormal = row(normal_, LW_FORMAT_FLOAT3);
        geometry.surfelArea = row(area_, LW_FORMAT_FLOAT1);
        geometry.version = version;
        return &geometry;
    }
    // The room that LitFloor and WallAndCeiling show, closed all around.
    static Walls room(double s = 1.0) {
        Walls walls;
        const reference::Vec x{s, 0, 0}, y{0, s, 0}, z{0, 0, s}, corner{-0.5 * s, 0, 0};
        for (const auto& [u, v, w] : {std::array{x, y, z}, std::array{y, z, x}, std::array{z, x, y}}) {
            walls.add(corner, u, v);
            walls.add(corner + w, u, v);
        }
        return walls;
    }

private:
    LWImage row(std::vector<float>& values, LWFormat format) const {
        LWImage image{};
        image.host = values.data();
        image.format = format;
        image.width = std::uint32_t(area_.size());
        image.height = 1;
        return image;
    }
    std::vector<float> position_, normal_, area_;
};

}  // namespace lightwell::test
