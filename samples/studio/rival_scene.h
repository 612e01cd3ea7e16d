// What the rival looks up at a hit: one cache line for each triangle, small textures, lights.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "area_lights.h"
#include "ray_scene.h"

namespace studio {

// A base-colour texture reduced by averages in linear light to at most kSide texels a side, looked up
// by the nearest texel: a diffuse ray stands for a cone that is wider than a texel nearly everywhere.
struct SmallTexture {
    static constexpr int kSide = 64;
    int width = 0, height = 0;
    std::vector<glm::vec3> texels;
    // `isMask`: texels count by their alpha, since rays pass where it is low.
    SmallTexture(const Texture& texture, bool isMask);
    const glm::vec3& nearest(float u, float v) const;
};

struct RivalMaterial {
    glm::vec3 albedo{0.0f}, emission{0.0f};
    int texture = -1;
};

struct alignas(64) RivalTriangle {
    float normals[3][3];
    float uvs[3][2];
    std::uint32_t material;
};

class RivalScene {
public:
    explicit RivalScene(const RayScene& scene);
    const RayScene& rays() const { return scene_; }
    const RivalTriangle& triangle(unsigned mesh, unsigned primitive) const {
        return triangles_[first_[mesh] + primitive];
    }
    const glm::vec3& emission(const RivalTriangle& t) const { return materials_[t.material].emission; }
    glm::vec3 albedo(const RivalTriangle& t, float u, float v) const;
    const AreaLights& emitters() const { return emitters_; }
    bool hasSky() const { return scene_.scene().sky != glm::vec3(0.0f); }
    std::uint64_t bytes() const;

private:
    const RayScene& scene_;
    AreaLights emitters_;
    std::vector<SmallTexture> textures_;
    std::vector<RivalMaterial> materials_;  // of each mesh
    std::vector<RivalTriangle> triangles_;
    std::vector<std::size_t> first_;  // of each mesh
};

inline const glm::vec3& SmallTexture::nearest(float u, float v) const {
    // Never negative before the cut; a fraction that rounds up to 1 stays inside by the minimum.
    const int x = std::min(int((u - std::floor(u)) * float(width)), width - 1);
    const int y = std::min(int((v - std::floor(v)) * float(height)), height - 1);
    return texels[std::size_t(y * width + x)];
}

inline glm::vec3 RivalScene::albedo(const RivalTriangle& t, float u, float v) const {
    const RivalMaterial& material = materials_[t.material];
    if (material.texture < 0) return material.albedo;
    const float w = 1.0f - u - v;
    return material.albedo * textures_[std::size_t(material.texture)].nearest(
                                 t.uvs[0][0] * w + t.uvs[1][0] * u + t.uvs[2][0] * v,
                                 t.uvs[0][1] * w + t.uvs[1][1] * u + t.uvs[2][1] * v);
}

}  // namespace studio
