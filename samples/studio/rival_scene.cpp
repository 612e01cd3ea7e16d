#include "rival_scene.h"

#include <array>

#include "image.h"

namespace studio {
namespace {

std::array<float, 256> linearOfCodes() {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = srgbDecode(float(i) / 255.0f);
    return table;
}

}  // namespace

SmallTexture::SmallTexture(const Texture& texture, bool isMask)
    : width(std::min(texture.width, kSide)), height(std::min(texture.height, kSide)) {
    static const std::array<float, 256> kLinear = linearOfCodes();
    const auto average = [&](int left, int right, int top, int bottom, bool byAlpha) {
        glm::vec4 sum(0.0f);
        for (int y = top; y < bottom; ++y)
            for (int x = left; x < right; ++x) {
                const std::size_t at = std::size_t(y) * std::size_t(texture.width) + std::size_t(x);
                const std::uint8_t* p = &texture.rgba[4 * at];
                const float weight = byAlpha ? float(p[3]) : 1.0f;
                sum += weight * glm::vec4(kLinear[p[0]], kLinear[p[1]], kLinear[p[2]], 1.0f);
            }
        return sum;
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int left = x * texture.width / width, right = (x + 1) * texture.width / width;
            const int top = y * texture.height / height, bottom = (y + 1) * texture.height / height;
            glm::vec4 sum = average(left, right, top, bottom, isMask);
            if (sum.w <= 0.0f) sum = average(left, right, top, bottom, false);
            texels.push_back(glm::vec3(sum) / sum.w);
        }
}

RivalScene::RivalScene(const RayScene& rayScene) : scene_(rayScene), emitters_(rayScene) {
    const Scene& scene = rayScene.scene();
    for (std::size_t i = 0; i < scene.textures.size(); ++i) {
        const bool isMask =
            std::any_of(scene.materials.begin(), scene.materials.end(), [&](const Material& material) {
                return material.texture == int(i) && material.alphaCutoff > 0.0f;
            });
        textures_.emplace_back(scene.textures[i], isMask);
    }
    for (const Mesh& mesh : scene.meshes) {
        const Material& material = scene.materials[std::size_t(mesh.material)];
        const bool isTextured = material.texture >= 0 && !mesh.uvs.empty();
        const auto index = std::uint32_t(materials_.size());
        materials_.push_back({material.albedo,
                              scene.emissiveSurfaces ? material.emission : glm::vec3(0.0f),
                              isTextured ? material.texture : -1});
        first_.push_back(triangles_.size());
        const glm::mat3 turn(scene.objects[std::size_t(mesh.object)].poseAt(rayScene.time()));
        for (const glm::uvec3& corners : mesh.triangles) {
            RivalTriangle triangle{};
            triangle.material = index;
            for (int c = 0; c < 3; ++c) {
                const glm::vec3 normal = turn * mesh.normals[corners[c]];
                for (int axis = 0; axis < 3; ++axis) triangle.normals[c][axis] = normal[axis];
                if (!isTextured) continue;
                triangle.uvs[c][0] = mesh.uvs[corners[c]].x;
                triangle.uvs[c][1] = mesh.uvs[corners[c]].y;
            }
            triangles_.push_back(triangle);
        }
    }
}

std::uint64_t RivalScene::bytes() const {
    std::uint64_t sum = triangles_.size() * sizeof(RivalTriangle);
    for (const SmallTexture& texture : textures_) sum += texture.texels.size() * sizeof(glm::vec3);
    return sum;
}

}  // namespace studio
