// Meshes made fit for use: see finishMesh.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "scene_import.h"

namespace studio {
namespace {

glm::dvec3 faceCross(const Mesh& mesh, const glm::uvec3& t) {
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    return glm::cross(b - a, c - a);
}

void makeFlat(Mesh& mesh) {
    Mesh flat = mesh;
    flat.positions.clear();
    flat.normals.clear();
    flat.uvs.clear();
    flat.triangles.clear();
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::vec3 normal(glm::normalize(faceCross(mesh, t)));
        const unsigned first = unsigned(flat.positions.size());
        for (int corner = 0; corner < 3; ++corner) {
            flat.positions.push_back(mesh.positions[t[corner]]);
            flat.normals.push_back(normal);
            if (!mesh.uvs.empty()) flat.uvs.push_back(mesh.uvs[t[corner]]);
        }
        flat.triangles.emplace_back(first, first + 1, first + 2);
    }
    mesh = std::move(flat);
}

}  // namespace

void finishMesh(Mesh& mesh) {
    for (const glm::vec3& p : mesh.positions)
        if (!std::isfinite(p.x + p.y + p.z))
            throw std::runtime_error(
                fmt::format("positions: expected finite numbers, got ({}, {}, {})", p.x, p.y, p.z));
    for (const glm::vec2& uv : mesh.uvs)
        if (!std::isfinite(uv.x + uv.y))
            throw std::runtime_error(
                fmt::format("texture coordinates: expected finite numbers, got ({}, {})", uv.x, uv.y));
    std::vector<glm::uvec3> kept;
    for (const glm::uvec3& t : mesh.triangles) {
        if (std::max({t.x, t.y, t.z}) >= mesh.positions.size())
            throw std::runtime_error(
                fmt::format("triangles: expected vertex indices below {}, got ({}, {}, {})",
                            mesh.positions.size(), t.x, t.y, t.z));
        if (faceCross(mesh, t) != glm::dvec3(0.0)) kept.push_back(t);
    }
    mesh.triangles = std::move(kept);
    if (mesh.normals.size() != mesh.positions.size()) return makeFlat(mesh);

    std::vector<glm::dvec3> mean;  // of the faces at a vertex; made when a normal is unusable
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        const float length = glm::length(mesh.normals[i]);
        if (std::isfinite(length) && length > 0.0f) {
            mesh.normals[i] /= length;
            continue;
        }
        if (mean.empty()) {
            mean.resize(mesh.positions.size(), glm::dvec3(0.0));
            for (const glm::uvec3& t : mesh.triangles)
                for (int corner = 0; corner < 3; ++corner) mean[t[corner]] += faceCross(mesh, t);
        }
        // A vertex of no face, or of faces back to back, may take any direction.
        mesh.normals[i] = mean[i] == glm::dvec3(0.0) ? glm::vec3(0.0f, 1.0f, 0.0f)
                                                     : glm::vec3(glm::normalize(mean[i]));
    }
}

}  // namespace studio
