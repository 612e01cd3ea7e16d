// See scene_primitives.h.
#include "scene_primitives.h"

#include <cmath>

namespace studio {

Mesh makeQuad(const std::array<glm::vec3, 4>& corners) {
    Mesh mesh;
    mesh.positions.assign(corners.begin(), corners.end());
    // Of the diagonals: also right where the four corners are a little out of plane.
    const glm::vec3 normal =
        glm::normalize(glm::cross(corners[2] - corners[0], corners[3] - corners[1]));
    mesh.normals.assign(4, normal);
    mesh.uvs = {{0.0f, 0.0f}, {1.0f, 0.0f}, {1.0f, 1.0f}, {0.0f, 1.0f}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

Mesh makeBox(const glm::vec3& lower, const glm::vec3& upper) {
    Mesh mesh;
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            const bool high = side == 1;
            std::array<glm::vec3, 4> corners;
            for (std::size_t i = 0; i < 4; ++i) {
                // Counter-clockwise seen from outside.
                const bool along = i == 1 || i == 2, across = i == 2 || i == 3;
                corners[i][axis] = high ? upper[axis] : lower[axis];
                corners[i][u] = (high ? along : across) ? upper[u] : lower[u];
                corners[i][v] = (high ? across : along) ? upper[v] : lower[v];
            }
            const Mesh face = makeQuad(corners);
            const glm::uvec3 first(unsigned(mesh.positions.size()));
            mesh.positions.insert(mesh.positions.end(), face.positions.begin(), face.positions.end());
            mesh.normals.insert(mesh.normals.end(), face.normals.begin(), face.normals.end());
            mesh.uvs.insert(mesh.uvs.end(), face.uvs.begin(), face.uvs.end());
            for (const glm::uvec3& t : face.triangles) mesh.triangles.push_back(t + first);
        }
    return mesh;
}

Mesh makeSphere(const glm::vec3& center, float radius, int rings) {
    Mesh mesh;
    const int around = 2 * rings;
    for (int i = 0; i <= rings; ++i)
        for (int j = 0; j <= around; ++j) {
            const double polar = double(kPi) * i / rings, azimuth = 2.0 * double(kPi) * j / around;
            const glm::vec3 n(glm::dvec3(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                                         -std::sin(polar) * std::sin(azimuth)));
            mesh.normals.push_back(n);
            mesh.positions.push_back(center + radius * n);
            mesh.uvs.emplace_back(float(j) / float(around), float(i) / float(rings));
        }
    const auto vertex = [around](int i, int j) { return unsigned(i * (around + 1) + j); };
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < around; ++j) {
            if (i > 0) mesh.triangles.emplace_back(vertex(i, j), vertex(i + 1, j), vertex(i, j + 1));
            if (i + 1 < rings)
                mesh.triangles.emplace_back(vertex(i, j + 1), vertex(i + 1, j), vertex(i + 1, j + 1));
        }
    return mesh;
}

}  // namespace studio
