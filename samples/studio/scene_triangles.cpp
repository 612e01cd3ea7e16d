#include "scene_triangles.h"

#include <algorithm>

#include "film.h"

namespace studio {
namespace {

// Places in a triangle (weights of the second and third corner) that its reflectance and mask are averaged over.
constexpr glm::vec2 kPlaces[] = {{1.0f / 3.0f, 1.0f / 3.0f}, {0.15f, 0.15f}, {0.7f, 0.15f}, {0.15f, 0.7f},
                                 {0.45f, 0.45f},             {0.1f, 0.45f},  {0.45f, 0.1f}};
constexpr float kPlaceCount = float(sizeof kPlaces / sizeof kPlaces[0]);

struct Shade {
    glm::vec3 albedo{0.0f};
    float covered = 0.0f;  // share that the mask leaves
};

Shade shadeOf(const Mesh& mesh, const Material& material, const Texture* texture, const glm::uvec3& t) {
    if (texture == nullptr) return {material.albedo, 1.0f};
    Shade shade;
    for (const glm::vec2& place : kPlaces) {
        const glm::vec4 texel = texture->lookup(mesh.uvs[t.x] * (1.0f - place.x - place.y) + mesh.uvs[t.y] * place.x +
                                                mesh.uvs[t.z] * place.y);
        if (material.alphaCutoff > 0.0f && texel.a < material.alphaCutoff) continue;
        shade.albedo += material.albedo * glm::vec3(texel);
        shade.covered += 1.0f;
    }
    if (shade.covered > 0.0f) shade.albedo /= shade.covered;
    shade.covered /= kPlaceCount;
    return shade;
}

}  // namespace

SceneTriangles sceneTriangles(const RayScene& rayScene) {
    const Scene& scene = rayScene.scene();
    SceneTriangles all;
    const bool glows =
        scene.emissiveSurfaces &&
        std::any_of(scene.meshes.begin(), scene.meshes.end(), [&](const Mesh& mesh) {
            return scene.materials.at(std::size_t(mesh.material)).emission != glm::vec3(0.0f);
        });
    for (const Mesh& mesh : scene.meshes) {
        const Material& material = scene.materials.at(std::size_t(mesh.material));
        const Texture* texture = material.texture >= 0 && !mesh.uvs.empty()
                                     ? &scene.textures.at(std::size_t(material.texture))
                                     : nullptr;
        const Object& object = scene.objects.at(std::size_t(mesh.object));
        const glm::mat4 pose = object.poseAt(rayScene.time());
        for (const glm::uvec3& t : mesh.triangles) {
            const Shade shade = shadeOf(mesh, material, texture, t);
            if (shade.covered < 0.5f) continue;
            for (int corner = 0; corner < 3; ++corner) {
                const glm::vec3& p = mesh.positions[t[corner]];
                const glm::vec3 world = object.keys.empty() ? p : glm::vec3(pose * glm::vec4(p, 1.0f));
                for (int axis = 0; axis < 3; ++axis) all.vertices.push_back(world[axis]);
            }
            for (int channel = 0; channel < 3; ++channel) all.albedo.push_back(shade.albedo[channel]);
            if (glows)
                for (int channel = 0; channel < 3; ++channel)
                    all.emission.push_back(material.emission[channel]);
        }
    }
    all.version = hashBytes(all.vertices.data(), all.vertices.size() * sizeof(float), 5);
    all.version = hashBytes(all.albedo.data(), all.albedo.size() * sizeof(float), all.version);
    if (glows)
        all.version = hashBytes(all.emission.data(), all.emission.size() * sizeof(float), all.version);
    return all;
}

}  // namespace studio
