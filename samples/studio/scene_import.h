// Reading mesh files into a Scene (glTF, GLB, OBJ through Assimp). Internal to the studio.
#pragma once

#include <string>
#include <vector>

#include "scene.h"

namespace studio {

// Appends the file's materials, textures and meshes (all as parts of object 0), cameras and lights.
// Errors: std::runtime_error naming the file and the reason.
void importFile(const std::string& path, Scene& scene);

// Fills an empty scene from a scene JSON (docs/scenes.md). Errors name the file, the key, what was
// expected and what came.
void readSceneJson(const std::string& path, Scene& scene);

// Texture from an encoded picture (JPEG, PNG, ...) in memory, or from a file. `what` names it in errors.
Texture decodeTexture(const void* bytes, std::size_t byteCount, const std::string& what);
Texture readTexture(const std::string& path);

// Makes a mesh fit for use: triangles without area go, missing normals become flat ones, all are unit.
// Throws when positions are not finite or indices out of range.
void finishMesh(Mesh& mesh);

// Throws unless every number of the scene has a meaning: reflectances in [0,1], light and emission finite
// and not negative, cones and views of possible angles. Files may say anything.
void checkScene(const Scene& scene);

// Sensible cameras for a scene that has none: one named "overview" looking at its bounds.
Camera overviewCamera(const Scene& scene);

// The parts of a glTF file's JSON that Assimp 5.2 drops, rescales or renumbers.
struct GltfMaterial {
    Material material;     // texture is not set here
    bool dropped = false;  // [glass]
    int texCoord = 0;
    glm::mat3 uvTransform{1.0f};  // KHR_texture_transform
};
struct GltfExtras {
    std::vector<GltfMaterial> materials;  // in the file's order
    std::vector<Camera> cameras;
    std::vector<Light> lights;
    // The file as Assimp shall see it: each material's name is its index, since Assimp numbers
    // materials in the order of their use.
    std::vector<char> renamedFile;
};
GltfExtras readGltfExtras(const std::string& path);

}  // namespace studio
