// Scenes by name: the shipped ones, those in LIGHTWELL_SCENES, or a path.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "scene_import.h"

namespace studio {
namespace {
namespace fs = std::filesystem;

// Preferred first where one stem has several files: a scene JSON describes more than a mesh file.
constexpr const char* kExtensions[] = {".json", ".glb", ".gltf", ".obj"};

// An installed tree keeps its scenes in share/; LIGHTWELL_SHIPPED_SCENES says where.
std::string shippedDirectory() {
    if (const char* moved = std::getenv("LIGHTWELL_SHIPPED_SCENES"); moved != nullptr && *moved != '\0')
        return moved;
    if (fs::is_directory(LIGHTWELL_SCENE_DIR)) return LIGHTWELL_SCENE_DIR;
    return LIGHTWELL_SCENE_INSTALL_DIR;
}

void addDirectory(const std::string& directory, bool shipped, std::vector<SceneEntry>& entries) {
    std::error_code error;
    std::set<std::string> stems;
    for (const fs::directory_entry& file : fs::directory_iterator(directory, error))
        stems.insert(file.path().stem().string());
    if (error)
        throw std::runtime_error(fmt::format("{} \"{}\": {}",
                                             shipped ? "shipped scenes" : "LIGHTWELL_SCENES", directory,
                                             error.message()));
    for (const std::string& stem : stems) {
        const bool known = std::any_of(entries.begin(), entries.end(),
                                       [&](const SceneEntry& e) { return e.name == stem; });
        for (const char* extension : kExtensions) {
            const fs::path path = fs::path(directory) / (stem + extension);
            if (known || !fs::is_regular_file(path)) continue;
            entries.push_back({stem, path.string(), shipped});
            break;
        }
    }
}

std::string pathOf(const std::string& nameOrPath) {
    const bool path = nameOrPath.find('/') != std::string::npos || fs::path(nameOrPath).has_extension();
    if (path && fs::is_regular_file(nameOrPath)) return nameOrPath;
    std::string names;
    for (const SceneEntry& entry : listScenes()) {
        if (entry.name == nameOrPath) return entry.path;
        names += (names.empty() ? "" : ", ") + entry.name;
    }
    throw std::runtime_error(
        fmt::format("scene \"{}\": {}; expected a path to a scene JSON, glTF, GLB or OBJ, or one of: {}",
                    nameOrPath, path ? "no such file" : "no scene of this name", names));
}

}  // namespace

std::vector<SceneEntry> listScenes() {
    std::vector<SceneEntry> entries;
    addDirectory(shippedDirectory(), true, entries);
    const char* list = std::getenv("LIGHTWELL_SCENES");
    std::string rest = list == nullptr ? "" : list;
    while (!rest.empty()) {
        const std::size_t colon = rest.find(':');
        const std::string directory = rest.substr(0, colon);
        rest = colon == std::string::npos ? "" : rest.substr(colon + 1);
        if (!directory.empty()) addDirectory(directory, false, entries);
    }
    return entries;
}

Scene loadScene(const std::string& nameOrPath) {
    Scene scene;
    scene.path = pathOf(nameOrPath);
    scene.name = fs::path(scene.path).stem().string();
    if (fs::path(scene.path).extension() == ".json") {
        readSceneJson(scene.path, scene);
    } else {
        importFile(scene.path, scene);
        // A file without any light of its own is lit by what glows in it.
        scene.emissiveSurfaces = scene.lights.empty();
    }
    if (scene.meshes.empty())
        throw std::runtime_error(
            fmt::format("{}: expected at least one triangle, got none", scene.path));
    if (scene.cameras.empty()) scene.cameras.push_back(overviewCamera(scene));
    checkScene(scene);
    return scene;
}

}  // namespace studio
