// Triangles and pictures of glTF, GLB and OBJ files through Assimp 5.
//
// Reduced to what a diffuse method needs: base colour with its texture and alpha mask, emission.
// Metals are diffuse of their base colour; materials named "[glass]" are left out with their
// triangles. Texture coordinates run down from the picture's top in every format. What
// Assimp drops is read in gltf_extras.cpp.
#include "scene_import.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <stdexcept>

#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <assimp/Importer.hpp>

namespace studio {
namespace {
namespace fs = std::filesystem;

constexpr float kMaskCutoff = 0.5f;  // of OBJ's map_d

// Serves one path from memory and everything else from the disk.
class PatchedFile : public Assimp::DefaultIOSystem {
public:
    PatchedFile(std::string path, const std::vector<char>& bytes)
        : path_(std::move(path)), bytes_(bytes) {}
    Assimp::IOStream* Open(const char* file, const char* mode) override {
        if (path_ != file) return DefaultIOSystem::Open(file, mode);
        return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(bytes_.data()),
                                          bytes_.size());
    }

private:
    std::string path_;
    const std::vector<char>& bytes_;
};

glm::vec3 toVec3(const aiVector3D& v) {
    return {v.x, v.y, v.z};
}

glm::mat4 toMat4(const aiMatrix4x4& m) {  // Assimp's is row-major
    return {m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2,
            m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4};
}

class FileImport {
public:
    FileImport(const std::string& path, Scene& scene) : path_(path), scene_(scene) {
        const std::string extension = lowerExtension(path);
        isGltf_ = extension == ".gltf" || extension == ".glb";
        if (!isGltf_ && extension != ".obj")
            throw std::runtime_error(
                fmt::format("{}: expected a .glb, .gltf or .obj file, got \"{}\"", path, extension));
        if (!fs::is_regular_file(path)) throw std::runtime_error(fmt::format("{}: no such file", path));
    }
    void run();

private:
    static std::string lowerExtension(const std::string& path) {
        std::string e = fs::path(path).extension().string();
        std::transform(e.begin(), e.end(), e.begin(),
                       [](unsigned char c) { return char(std::tolower(c)); });
        return e;
    }
    void addGltfMaterial(const aiMaterial& source);
    void addObjMaterial(const aiMaterial& source);
    void addNode(const aiNode& node, const glm::mat4& parent);
    void addMesh(const aiMesh& source, const glm::mat4& world, const std::string& name);
    int texture(const std::string& reference);

    std::string path_;
    Scene& scene_;
    bool isGltf_ = false;
    GltfExtras gltf_;
    const aiScene* file_ = nullptr;
    struct Slot {
        int material = -1;  // -1: dropped
        unsigned texCoord = 0;
        glm::mat3 uvTransform{1.0f};
    };
    std::vector<Slot> slots_;  // by Assimp's material index
    std::map<std::string, int> textures_;
};

int FileImport::texture(const std::string& reference) {
    const auto known = textures_.find(reference);
    if (known != textures_.end()) return known->second;
    const std::string what = fmt::format("{}: texture \"{}\"", path_, reference);
    if (const aiTexture* embedded = file_->GetEmbeddedTexture(reference.c_str())) {
        if (embedded->mHeight != 0)
            throw std::runtime_error(what + ": expected an encoded picture, got raw texels");
        scene_.textures.push_back(decodeTexture(embedded->pcData, embedded->mWidth, what));
    } else {
        std::string relative = reference;
        std::replace(relative.begin(), relative.end(), '\\', '/');
        scene_.textures.push_back(readTexture((fs::path(path_).parent_path() / relative).string()));
    }
    return textures_[reference] = int(scene_.textures.size()) - 1;
}

void FileImport::addGltfMaterial(const aiMaterial& source) {
    Slot slot;
    GltfMaterial gltf;  // for primitives without a material: glTF's default
    gltf.material.name = "default";
    gltf.material.albedo = glm::vec3(1.0f);
    const std::string name = source.GetName().C_Str();
    const bool numbered = !name.empty() && name.find_first_not_of("0123456789") == std::string::npos;
    if (numbered) gltf = gltf_.materials.at(std::stoul(name));
    aiString reference;
    if (source.GetTexture(aiTextureType_BASE_COLOR, 0, &reference) == aiReturn_SUCCESS && !gltf.dropped)
        gltf.material.texture = texture(reference.C_Str());
    slot.texCoord = unsigned(gltf.texCoord);
    slot.uvTransform = gltf.uvTransform;
    if (!gltf.dropped) {
        slot.material = int(scene_.materials.size());
        scene_.materials.push_back(gltf.material);
    }
    slots_.push_back(slot);
}

void FileImport::addObjMaterial(const aiMaterial& source) {
    Material m;
    m.name = source.GetName().C_Str();
    aiColor3D colour(0.5f, 0.5f, 0.5f), emission(0, 0, 0);
    source.Get(AI_MATKEY_COLOR_DIFFUSE, colour);
    source.Get(AI_MATKEY_COLOR_EMISSIVE, emission);
    m.albedo = {colour.r, colour.g, colour.b};
    m.emission = {emission.r, emission.g, emission.b};
    Slot slot;
    if (m.name.find("[glass]") == std::string::npos) {
        aiString reference;
        if (source.GetTexture(aiTextureType_DIFFUSE, 0, &reference) == aiReturn_SUCCESS) {
            m.texture = texture(reference.C_Str());
            // Exporters write Kd 0 beside a texture that is meant to show.
            if (m.albedo == glm::vec3(0.0f)) m.albedo = glm::vec3(1.0f);
        }
        if (source.GetTexture(aiTextureType_OPACITY, 0, &reference) == aiReturn_SUCCESS) {
            const Texture mask = scene_.textures[std::size_t(texture(reference.C_Str()))];
            Texture both = m.texture >= 0 ? scene_.textures[std::size_t(m.texture)] : mask;
            for (int y = 0; y < both.height; ++y)
                for (int x = 0; x < both.width; ++x) {
                    const int mx = x * mask.width / both.width, my = y * mask.height / both.height;
                    const std::uint8_t* from = &mask.rgba[std::size_t(my * mask.width + mx) * 4];
                    std::uint8_t* to = &both.rgba[std::size_t(y * both.width + x) * 4];
                    if (m.texture < 0) to[0] = to[1] = to[2] = 255;
                    // A mask's alpha where it has one, else its grey value.
                    to[3] = from[3] < 255 ? from[3] : from[0];
                }
            scene_.textures.push_back(std::move(both));
            m.texture = int(scene_.textures.size()) - 1;
            m.alphaCutoff = kMaskCutoff;
        }
        slot.material = int(scene_.materials.size());
        scene_.materials.push_back(m);
    }
    slots_.push_back(slot);
}

void FileImport::addMesh(const aiMesh& source, const glm::mat4& world, const std::string& name) {
    const Slot& slot = slots_.at(source.mMaterialIndex);
    if (slot.material < 0 || (source.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) return;
    Mesh mesh;
    mesh.name = name;
    mesh.material = slot.material;
    const glm::mat3 normalMatrix = glm::transpose(glm::inverse(glm::mat3(world)));
    const bool hasUv = source.HasTextureCoords(slot.texCoord);
    for (unsigned i = 0; i < source.mNumVertices; ++i) {
        mesh.positions.push_back(glm::vec3(world * glm::vec4(toVec3(source.mVertices[i]), 1.0f)));
        if (source.HasNormals()) mesh.normals.push_back(normalMatrix * toVec3(source.mNormals[i]));
        if (!hasUv) continue;
        const aiVector3D& uv = source.mTextureCoords[slot.texCoord][i];
        mesh.uvs.emplace_back(slot.uvTransform * glm::vec3(uv.x, uv.y, 1.0f));
    }
    for (unsigned i = 0; i < source.mNumFaces; ++i) {
        const aiFace& face = source.mFaces[i];
        if (face.mNumIndices == 3)
            mesh.triangles.emplace_back(face.mIndices[0], face.mIndices[1], face.mIndices[2]);
    }
    try {
        finishMesh(mesh);
    } catch (const std::exception& error) {
        throw std::runtime_error(fmt::format("{}: mesh \"{}\": {}", path_, name, error.what()));
    }
    if (!mesh.triangles.empty()) scene_.meshes.push_back(std::move(mesh));
}

void FileImport::addNode(const aiNode& node, const glm::mat4& parent) {
    const glm::mat4 world = parent * toMat4(node.mTransformation);
    for (unsigned i = 0; i < node.mNumMeshes; ++i)
        addMesh(*file_->mMeshes[node.mMeshes[i]], world, node.mName.C_Str());
    for (unsigned i = 0; i < node.mNumChildren; ++i) addNode(*node.mChildren[i], world);
}

void FileImport::run() {
    Assimp::Importer importer;
    if (isGltf_) {
        gltf_ = readGltfExtras(path_);
        importer.SetIOHandler(new PatchedFile(path_, gltf_.renamedFile));  // the importer owns it
    }
    // Both importers count v upwards from the picture's bottom; the flip counts it from the top.
    unsigned steps = aiProcess_Triangulate | aiProcess_FlipUVs;
    if (!isGltf_) steps |= aiProcess_JoinIdenticalVertices;
    file_ = importer.ReadFile(path_, steps);
    if (file_ == nullptr || file_->mRootNode == nullptr)
        throw std::runtime_error(fmt::format("{}: Assimp: {}", path_, importer.GetErrorString()));
    for (unsigned i = 0; i < file_->mNumMaterials; ++i) {
        if (isGltf_)
            addGltfMaterial(*file_->mMaterials[i]);
        else
            addObjMaterial(*file_->mMaterials[i]);
    }
    addNode(*file_->mRootNode, glm::mat4(1.0f));
    scene_.cameras.insert(scene_.cameras.end(), gltf_.cameras.begin(), gltf_.cameras.end());
    scene_.lights.insert(scene_.lights.end(), gltf_.lights.begin(), gltf_.lights.end());
}

}  // namespace

Camera overviewCamera(const Scene& scene) {
    glm::vec3 lower, upper;
    scene.bounds(lower, upper);
    Camera camera;
    camera.name = "overview";
    camera.target = 0.5f * (lower + upper);
    const float radius = 0.5f * glm::length(upper - lower);
    camera.verticalFov = 0.25f * kPi;
    // From the front, a little to the right and above, far enough to hold the bounding sphere.
    camera.position = camera.target + glm::normalize(glm::vec3(0.4f, 0.3f, 1.0f)) *
                                          (radius / std::sin(0.5f * camera.verticalFov));
    camera.nearPlane = radius * 1e-3f;
    camera.farPlane = radius * 10.0f;
    return camera;
}

void importFile(const std::string& path, Scene& scene) {
    FileImport(path, scene).run();
}

}  // namespace studio
