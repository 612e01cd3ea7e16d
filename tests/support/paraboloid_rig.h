// Paraboloid maps of made-up triangles in tests: geometry, clusters, and what the pass leaves.
#pragma once

#include <algorithm>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "inputs/geometry_input.h"
#include "passes/paraboloid_map.h"
#include "reference/paraboloid.h"
#include "support/kernel_rig.h"

namespace lightwell::test {

// Triangles as a host keeps them: own vertices each, and albedo that tells them apart.
struct Mesh {
    std::vector<float> vertices, albedo;
    std::uint64_t version = 1;

    void add(reference::Vec a, reference::Vec b, reference::Vec c) {
        // Eleven steps a channel: 10 bits hold them apart.
        const std::size_t n = vertices.size() / 9;
        for (const std::size_t digit : {n % 11, n / 11 % 11, n / 121 % 11}) albedo.push_back(float(digit) / 10.0f);
        for (const reference::Vec& v : {a, b, c})
            for (const double x : {v.x, v.y, v.z}) vertices.push_back(float(x));
    }
    // The parallelogram at `corner`, cut into columns * rows cells of two triangles.
    void addQuad(reference::Vec corner, reference::Vec u, reference::Vec v, int columns = 1, int rows = 1) {
        const auto at = [&](int i, int j) { return corner + u * (double(i) / columns) + v * (double(j) / rows); };
        for (int j = 0; j < rows; ++j)
            for (int i = 0; i < columns; ++i) {
                add(at(i, j), at(i + 1, j), at(i + 1, j + 1));
                add(at(i, j), at(i + 1, j + 1), at(i, j + 1));
            }
    }
    // The walls of a box from 0 to `size`.
    void addBox(reference::Vec size, int columns = 1, int rows = 1) {
        const reference::Vec x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z}, zero{};
        for (const auto& [u, v, w] : {std::array{x, y, z}, std::array{y, z, x}, std::array{z, x, y}}) {
            addQuad(zero, u, v, columns, rows);
            addQuad(w, u, v, columns, rows);
        }
    }
    std::uint32_t count() const { return std::uint32_t(vertices.size() / 9); }
    LWGeometry geometry() const {
        LWGeometry g{};
        g.structSize = sizeof g;
        g.triangleCount = count();
        g.vertexCount = 3 * count();
        g.vertices = vertices.data();
        g.triangleAlbedo = albedo.data();
        g.version = version;
        return g;
    }
    // As the device has them: rounded to float.
    std::vector<reference::Triangle> triangles() const {
        std::vector<reference::Triangle> all;
        const auto at = [&](std::size_t i) {
            return reference::Vec{double(vertices[i]), double(vertices[i + 1]), double(vertices[i + 2])};
        };
        for (std::size_t i = 0; i < vertices.size(); i += 9) all.push_back({at(i), at(i + 3), at(i + 6)});
        return all;
    }
};

inline lw_cluster clusterAt(reference::Vec position, reference::Vec normal) {
    const reference::Vec n = reference::unit(normal);
    lw_cluster c{};
    c.medoidPosition = {{float(position.x), float(position.y), float(position.z), 0.0f}};
    c.position = {{float(position.x), float(position.y), float(position.z), 1.0f}};
    c.normal = c.medoidNormal = {{float(n.x), float(n.y), float(n.z), 0.0f}};
    return c;
}

// What the pass left.
struct DrawnMaps {
    std::uint32_t size = 0;
    std::vector<lw_paraboloid> frames;
    std::vector<std::uint32_t> records, albedo;

    std::size_t at(std::size_t map, std::uint32_t x, std::uint32_t y) const { return (map * size + y) * size + x; }
    float distance(std::size_t texel) const {
        float d;
        std::memcpy(&d, &records[2 * texel], sizeof d);
        return d;
    }
    bool hit(std::size_t texel) const { return (records[2 * texel + 1] & LW_PARABOLOID_HIT) != 0; }
    bool isDoubtful(std::size_t texel) const { return (records[2 * texel + 1] & LW_PARABOLOID_DOUBTFUL) != 0; }
    reference::Vec normal(std::size_t texel) const {  // in the map's frame
        const auto part = [&](int c) { return (double(records[2 * texel + 1] >> (10 * c) & 1023u) - 512.0) / 511.0; };
        return {part(0), part(1), part(2)};
    }
    std::size_t triangle(std::size_t texel) const {  // of Mesh
        const auto digit = [&](int c) { return std::size_t(std::lround((albedo[texel] >> (10 * c) & 1023u) / 102.3)); };
        return digit(0) + 11 * digit(1) + 121 * digit(2);
    }
};

class ParaboloidRig : public KernelRig {
public:
    // marked: maps for strict look-ups.
    ParaboloidRig(std::uint32_t width, std::uint32_t size, bool marked = false) : KernelRig(width), pass(device(), size), marks(marked) {}

    // Draws what is stale; the counts of the report.
    std::vector<LWCount> draw(const Mesh& mesh, std::vector<lw_cluster> clusters) {
        const LWGeometry geometry = mesh.geometry();
        input.import(executor(), &geometry);
        const std::uint32_t count = std::uint32_t(clusters.size());
        clusters.resize(std::max(count, 1u));  // some memory
        pass.record(executor(), upload(clusters), count, input);
        if (marks) pass.recordMarks(executor());
        Report report;
        pass.report(report);
        device().finish();
        report.resolve();
        return report.counts;
    }
    DrawnMaps maps() {
        DrawnMaps result;
        result.size = pass.size();
        result.frames.resize(pass.mapCount());
        result.albedo.resize(std::size_t(pass.mapCount()) * pass.size() * pass.size());
        result.records.resize(2 * result.albedo.size());
        pass.frames().download(0, result.frames.size() * sizeof(lw_paraboloid), result.frames.data());
        pass.records().download(0, result.records.size() * 4, result.records.data());
        pass.albedo().download(0, result.albedo.size() * 4, result.albedo.data());
        return result;
    }
    DrawnMaps drawn(const Mesh& mesh, const std::vector<lw_cluster>& clusters) {
        draw(mesh, clusters);
        return maps();
    }

    GeometryInput input;
    ParaboloidMap pass;
    bool marks;
};

}  // namespace lightwell::test
