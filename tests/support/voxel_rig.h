// Triangles made voxels by pass voxel_grid, and what came out, voxel by voxel.
#pragma once

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "kernel_rig.h"
#include "passes/voxel_grid.h"
#include "reference/voxel_twin.h"
#include "shared/lpv_types.h"

namespace lightwell::test {

struct VoxelTriangle {
    std::array<std::array<double, 3>, 3> at;  // in voxels of the grid; its lower corner is 0
    std::array<float, 3> albedo{{0.5f, 0.5f, 0.5f}}, emission{{0.0f, 0.0f, 0.0f}};
};

struct VoxelRig : KernelRig {
    static constexpr double kCell = 0.3;
    static constexpr float kOrigin[3] = {-3.1f, 1.7f, 8.3f};
    int size;
    VoxelGrid pass;
    GeometryInput input;
    LwLpvPlace place{};
    std::vector<float> vertices, albedo, emission;
    std::uint64_t version = 0;

    VoxelRig(std::uint32_t width, int n, bool sparse = true) : KernelRig(width), size(n), pass(device(), std::uint32_t(n), sparse) {
        place.origin = {{kOrigin[0], kOrigin[1], kOrigin[2], float(1.0 / kCell)}};
        place.cell = {{float(kCell), 1.0f, 1.0f, 0.0f}};
    }
    double scale() const { return double(place.origin.s[3]); }

    void setTriangles(const std::vector<VoxelTriangle>& triangles) {
        vertices.clear();
        albedo.clear();
        emission.clear();
        for (const VoxelTriangle& t : triangles) {
            for (const auto& p : t.at)
                for (std::size_t a = 0; a < 3; ++a) vertices.push_back(float(double(kOrigin[a]) + kCell * p[a]));
            albedo.insert(albedo.end(), t.albedo.begin(), t.albedo.end());
            emission.insert(emission.end(), t.emission.begin(), t.emission.end());
        }
        ++version;
    }
    // The floats that the pass sees, in voxels.
    reference::VoxelPolygon seen(std::size_t t) const {
        reference::VoxelPolygon polygon(3);
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t a = 0; a < 3; ++a)
                polygon[k][a] = (double(vertices[9 * t + 3 * k + a]) - double(place.origin.s[a])) * scale();
        return polygon;
    }
    LWGeometry geometry(bool emits = false) const {
        LWGeometry g{};
        g.structSize = sizeof g;
        g.vertices = vertices.data();
        g.triangleAlbedo = albedo.data();
        g.triangleEmission = emits ? emission.data() : nullptr;
        g.vertexCount = std::uint32_t(vertices.size() / 3);
        g.triangleCount = std::uint32_t(vertices.size() / 9);
        g.version = version;
        return g;
    }
    void record(bool emits = false) {
        const LWGeometry g = geometry(emits);
        input.import(executor(), &g, emits);
        const Guarded placed = upload(std::vector<LwLpvPlace>{place});
        pass.record(executor(), input, placed);
        device().finish();
    }
    void voxelise(const std::vector<VoxelTriangle>& triangles, bool emits = false) {
        setTriangles(triangles);
        record(emits);
    }

    template <class T>
    static std::vector<T> read(const Buffer& buffer, std::size_t count) {
        std::vector<T> values(count);
        buffer.download(0, count * sizeof(T), values.data());
        return values;
    }
    std::size_t brickCount() const { return std::size_t(size / 8) * std::size_t(size / 8) * std::size_t(size / 8); }
    LwVoxelGrid state() const { return read<LwVoxelGrid>(pass.state(), 1)[0]; }
    std::vector<cl_int> bricks() const { return read<cl_int>(pass.bricks(), brickCount()); }
    std::vector<cl_int> changed() const { return read<cl_int>(pass.changed(), brickCount()); }
    std::vector<cl_uint> occupied() const { return read<cl_uint>(pass.occupied(), brickCount() * LW_VOXEL_WORDS); }
    // A plane of surfaces in the order of the bricks, whatever their slots; 0 where there is none.
    std::vector<cl_uint> plane(int p) const {
        const std::size_t slots = pass.slots() * std::size_t(LW_VOXEL_BRICK_VOXELS);
        std::vector<cl_uint> all(slots), result;
        pass.surfaces().download(std::size_t(p) * slots * sizeof(cl_uint), slots * sizeof(cl_uint), all.data());
        for (const cl_int slot : bricks())
            for (std::size_t i = 0; i < LW_VOXEL_BRICK_VOXELS; ++i)
                result.push_back(slot < 0 ? 0u : all[std::size_t(slot) * LW_VOXEL_BRICK_VOXELS + i]);
        return result;
    }
    std::vector<float> floats(int p) const {
        std::vector<float> result;
        for (const cl_uint word : plane(p)) {
            float value;
            std::memcpy(&value, &word, sizeof value);
            result.push_back(value);
        }
        return result;
    }
    // All that comes out, brick by brick.
    std::vector<cl_uint> everything() const {
        std::vector<cl_uint> all = occupied();
        for (int p = 0; p < LW_SURFACE_PLANES; ++p) {
            const std::vector<cl_uint> one = plane(p);
            all.insert(all.end(), one.begin(), one.end());
        }
        return all;
    }
    // Index of a voxel in occupied() as bits, and in planes.
    std::size_t indexOf(int x, int y, int z) const {
        const int side = size / 8, brick = (z / 8 * side + y / 8) * side + x / 8;
        return std::size_t(brick) * LW_VOXEL_BRICK_VOXELS + std::size_t(x % 8 + 8 * (y % 8 + 8 * (z % 8)));
    }
};

inline bool bitOf(const std::vector<cl_uint>& words, std::size_t i) { return words[i / 32] >> (i % 32) & 1u; }

}  // namespace lightwell::test
