// Small scenes made in code, and a folder for files, for the tests of the studio.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "ray_scene.h"
#include "scene_primitives.h"

namespace studio_test {

// Deleted with its content at the end of the test.
class TempFolder {
public:
    TempFolder() {
        static int count = 0;
        path_ = std::filesystem::temp_directory_path() /
                ("lightwell_test_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
        std::filesystem::create_directories(path_);
    }
    ~TempFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TempFolder(const TempFolder&) = delete;
    TempFolder& operator=(const TempFolder&) = delete;
    std::string path() const { return path_.string(); }
    // Writes a file and returns its path.
    std::string write(const std::string& name, const std::string& content) const {
        const std::filesystem::path file = path_ / name;
        std::ofstream(file, std::ios::binary) << content;
        return file.string();
    }

private:
    std::filesystem::path path_;
};

// Message of the exception that `call` throws; "" when it throws none.
template <class Call>
std::string failure(Call call) {
    try {
        call();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "";
}

inline int addMaterial(studio::Scene& scene, const glm::vec3& albedo) {
    studio::Material material;
    material.albedo = albedo;
    scene.materials.push_back(material);
    return int(scene.materials.size()) - 1;
}

inline void add(studio::Scene& scene, studio::Mesh mesh, int material, int object = 0) {
    mesh.material = material;
    mesh.object = object;
    scene.meshes.push_back(std::move(mesh));
}

// Horizontal square at height y, facing up.
inline studio::Mesh floorQuad(float half, float y) {
    return studio::makeQuad({glm::vec3(-half, y, half), glm::vec3(half, y, half),
                             glm::vec3(half, y, -half), glm::vec3(-half, y, -half)});
}

inline studio::Camera cameraAt(const glm::vec3& position, const glm::vec3& target, float degrees) {
    studio::Camera camera;
    camera.name = "test";
    camera.position = position;
    camera.target = target;
    camera.verticalFov = degrees * studio::kPi / 180.0f;
    return camera;
}

inline studio::Light sun(const glm::vec3& direction, float irradiance) {
    studio::Light light;
    light.name = "sun";
    light.direction = glm::normalize(direction);
    light.emitted = glm::vec3(irradiance);
    return light;
}

inline studio::Light spot(const glm::vec3& position, const glm::vec3& target, float intensity,
                          float inner, float outer) {
    studio::Light light;
    light.name = "spot";
    light.kind = studio::LightKind::Spot;
    light.position = position;
    light.direction = glm::normalize(target - position);
    light.emitted = glm::vec3(intensity);
    light.innerCone = inner;
    light.outerCone = outer;
    return light;
}

// The same scene in another unit: lengths times `factor`, intensities times its square.
inline studio::Scene scaled(studio::Scene scene, float factor) {
    for (studio::Mesh& mesh : scene.meshes)
        for (glm::vec3& p : mesh.positions) p *= factor;
    for (studio::Object& object : scene.objects)
        for (studio::PoseKey& key : object.keys) key.translation *= factor;
    for (studio::Camera& camera : scene.cameras) {
        camera.position *= factor;
        camera.target *= factor;
        camera.nearPlane *= factor;
        camera.farPlane *= factor;
    }
    for (studio::Light& light : scene.lights) {
        light.position *= factor;
        if (light.kind != studio::LightKind::Sun) light.emitted *= factor * factor;
    }
    return scene;
}

inline std::shared_ptr<const studio::Scene> shared(studio::Scene scene) {
    return std::make_shared<const studio::Scene>(std::move(scene));
}

}  // namespace studio_test
