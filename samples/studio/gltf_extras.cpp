// The JSON of a glTF or GLB file: materials, cameras and punctual lights as the file states them.
//
// Assimp 5.2 reads only the normalised emissive factor, scales light intensities into colours, and
// numbers materials in the order of their use; geometry and pictures are read by Assimp, the rest here.
// glTF's lux and candela are taken as W/m^2 and W/sr (colour times intensity, per channel).
#include <array>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <nlohmann/json.hpp>

#include "scene_import.h"

namespace studio {
namespace {
using Json = nlohmann::json;

constexpr std::uint32_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A;
constexpr int kDeepest = 1000;  // levels of nodes: readers, Assimp's too, call themselves once a level
constexpr float kBlendCutoff = 0.5f;  // blended materials are cut where less than half covers

std::uint32_t word(const std::vector<char>& bytes, std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
}

std::vector<char> readBytes(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    if (!in) throw std::runtime_error(fmt::format("{}: can't be read", path));
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

glm::vec3 vec3(const Json& object, const char* key, glm::vec3 fallback) {
    const auto it = object.find(key);
    if (it == object.end()) return fallback;
    return {it->at(0).get<float>(), it->at(1).get<float>(), it->at(2).get<float>()};
}

const Json& extension(const Json& object, const char* name) {
    static const Json kNone = Json::object();
    const auto all = object.find("extensions");
    if (all == object.end()) return kNone;
    const auto it = all->find(name);
    return it == all->end() ? kNone : *it;
}

GltfMaterial readMaterial(const Json& json) {
    GltfMaterial result;
    Material& m = result.material;
    m.name = json.value("name", "");
    const Json pbr = json.value("pbrMetallicRoughness", Json::object());
    m.albedo = vec3(pbr, "baseColorFactor", glm::vec3(1.0f));
    const Json factor = pbr.value("baseColorFactor", Json::array({1, 1, 1, 1}));
    if (!factor.is_array() || factor.size() != 4)
        throw std::runtime_error(fmt::format(
            "material \"{}\": baseColorFactor: expected four numbers, got {}", m.name, factor.dump()));
    const float alpha = factor[3].get<float>();

    m.emission = vec3(json, "emissiveFactor", glm::vec3(0.0f)) *
                 extension(json, "KHR_materials_emissive_strength").value("emissiveStrength", 1.0f);
    m.emission = vec3(json.value("extras", Json::object()), "emissive_radiance", m.emission);

    const std::string mode = json.value("alphaMode", "OPAQUE");
    const bool textured = pbr.contains("baseColorTexture");
    if (mode == "MASK") m.alphaCutoff = json.value("alphaCutoff", 0.5f);
    if (mode == "BLEND" && textured) m.alphaCutoff = kBlendCutoff;
    // Coverage is the factor's alpha times the texture's.
    const float cutoff = mode == "BLEND" ? kBlendCutoff : m.alphaCutoff;
    const bool nothingLeft = mode != "OPAQUE" && alpha < cutoff;
    if (textured && alpha > 0.0f) m.alphaCutoff /= alpha;
    result.dropped = m.name.find("[glass]") != std::string::npos || nothingLeft;

    if (textured) {
        const Json& texture = pbr["baseColorTexture"];
        const Json& t = extension(texture, "KHR_texture_transform");
        result.texCoord = t.value("texCoord", texture.value("texCoord", 0));
        const std::array<float, 2> offset = t.value("offset", std::array<float, 2>{0.0f, 0.0f});
        const std::array<float, 2> scale = t.value("scale", std::array<float, 2>{1.0f, 1.0f});
        const float angle = t.value("rotation", 0.0f), c = std::cos(angle), s = std::sin(angle);
        // Translation * rotation * scale, as the extension's page writes it (columns here).
        result.uvTransform = glm::mat3(1, 0, 0, 0, 1, 0, offset[0], offset[1], 1) *
                             glm::mat3(c, -s, 0, s, c, 0, 0, 0, 1) *
                             glm::mat3(scale[0], 0, 0, 0, scale[1], 0, 0, 0, 1);
    }
    return result;
}

glm::mat4 localMatrix(const Json& node) {
    if (node.contains("matrix")) {
        const auto m = node["matrix"].get<std::array<float, 16>>();
        return glm::make_mat4(m.data());
    }
    const auto r = node.value("rotation", std::array<float, 4>{0, 0, 0, 1});
    return glm::translate(glm::mat4(1.0f), vec3(node, "translation", glm::vec3(0.0f))) *
           glm::mat4_cast(glm::quat(r[3], r[0], r[1], r[2])) *
           glm::scale(glm::mat4(1.0f), vec3(node, "scale", glm::vec3(1.0f)));
}

Camera readCamera(const Json& json, const glm::mat4& world, const std::string& name) {
    const auto perspective = json.find("perspective");
    if (perspective == json.end())
        throw std::runtime_error(fmt::format("camera \"{}\": expected a perspective camera, got {}",
                                             name, json.value("type", "none")));
    Camera camera;
    camera.name = name;
    camera.position = glm::vec3(world[3]);
    camera.target = camera.position - glm::normalize(glm::vec3(world[2]));
    camera.up = glm::normalize(glm::vec3(world[1]));
    camera.verticalFov = perspective->at("yfov").get<float>();
    camera.aspect = perspective->value("aspectRatio", 0.0f);
    camera.nearPlane = perspective->at("znear").get<float>();
    camera.farPlane = perspective->value("zfar", camera.nearPlane * 1e5f);
    return camera;
}

Light readLight(const Json& json, const glm::mat4& world, const std::string& name) {
    Light light;
    light.name = name;
    const std::string type = json.at("type").get<std::string>();
    if (type == "directional")
        light.kind = LightKind::Sun;
    else if (type == "spot")
        light.kind = LightKind::Spot;
    else if (type == "point")
        light.kind = LightKind::Point;
    else
        throw std::runtime_error(
            fmt::format("light \"{}\": expected type directional, spot or point, got {}", name, type));
    light.position = glm::vec3(world[3]);
    light.direction = -glm::normalize(glm::vec3(world[2]));
    light.emitted = vec3(json, "color", glm::vec3(1.0f)) * json.value("intensity", 1.0f);
    const Json spot = json.value("spot", Json::object());
    light.innerCone = spot.value("innerConeAngle", 0.0f);
    light.outerCone = spot.value("outerConeAngle", 0.25f * kPi);
    return light;
}

// `visited`: nodes form trees, so that each comes once; a ring would be walked for ever.
void readNode(const Json& gltf, std::size_t index, const glm::mat4& parent, int depth,
              std::vector<bool>& visited, GltfExtras& out) {
    if (index >= visited.size())
        throw std::runtime_error(
            fmt::format("node index: expected 0 .. {}, got {}", long(visited.size()) - 1, long(index)));
    if (visited[index])
        throw std::runtime_error(fmt::format("node {}: expected one parent, got a second", index));
    if (depth > kDeepest)
        throw std::runtime_error(fmt::format("nodes: expected a tree of at most {} levels", kDeepest));
    visited[index] = true;
    const Json& node = gltf.at("nodes").at(index);
    const glm::mat4 world = parent * localMatrix(node);
    const std::string name = node.value("name", fmt::format("node_{}", index));
    if (node.contains("camera"))
        out.cameras.push_back(
            readCamera(gltf.at("cameras").at(node["camera"].get<std::size_t>()), world, name));
    const Json& punctual = extension(node, "KHR_lights_punctual");
    if (punctual.contains("light"))
        out.lights.push_back(readLight(
            extension(gltf, "KHR_lights_punctual").at("lights").at(punctual["light"].get<std::size_t>()),
            world, name));
    for (const Json& child : node.value("children", Json::array()))
        readNode(gltf, child.get<std::size_t>(), world, depth + 1, visited, out);
}

// Nodes "suggested_*" were added to the assets to have something; a file's own come before them.
template <class T>
void preferOwn(std::vector<T>& items) {
    const auto suggested = [](const T& item) { return item.name.rfind("suggested_", 0) == 0; };
    bool own = false;
    for (const T& item : items) own = own || !suggested(item);
    if (!own) return;
    std::vector<T> kept;
    for (const T& item : items)
        if (!suggested(item)) kept.push_back(item);
    items = kept;
}

std::vector<char> withRenamedMaterials(Json gltf, const std::vector<char>& file, bool binary,
                                       std::size_t jsonEnd) {
    if (gltf.contains("materials"))
        for (std::size_t i = 0; i < gltf["materials"].size(); ++i)
            gltf["materials"][i]["name"] = std::to_string(i);
    std::string text = gltf.dump();
    if (!binary) return {text.begin(), text.end()};
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::array<std::uint32_t, 5> head = {kGlbMagic, 2,
                                               std::uint32_t(20 + text.size() + file.size() - jsonEnd),
                                               std::uint32_t(text.size()), kJsonChunk};
    std::vector<char> out(reinterpret_cast<const char*>(head.data()),
                          reinterpret_cast<const char*>(head.data() + head.size()));
    out.insert(out.end(), text.begin(), text.end());
    out.insert(out.end(), file.begin() + std::ptrdiff_t(jsonEnd), file.end());
    return out;
}

}  // namespace

GltfExtras readGltfExtras(const std::string& path) {
    const std::vector<char> file = readBytes(path);
    const bool binary = file.size() >= 20 && word(file, 0) == kGlbMagic;
    std::size_t begin = 0, end = file.size();
    if (binary) {
        begin = 20;
        end = 20 + std::size_t(word(file, 12));
        if (word(file, 4) != 2 || word(file, 16) != kJsonChunk || end > file.size())
            throw std::runtime_error(
                fmt::format("{}: expected a glTF 2.0 binary file whose first chunk is JSON", path));
    }
    GltfExtras result;
    try {
        const Json gltf =
            Json::parse(file.begin() + std::ptrdiff_t(begin), file.begin() + std::ptrdiff_t(end));
        for (const Json& material : gltf.value("materials", Json::array()))
            result.materials.push_back(readMaterial(material));
        const Json scenes = gltf.value("scenes", Json::array());
        std::vector<bool> visited(gltf.value("nodes", Json::array()).size(), false);
        if (!scenes.empty())
            for (const Json& root :
                 scenes.at(gltf.value("scene", std::size_t(0))).value("nodes", Json::array()))
                readNode(gltf, root.get<std::size_t>(), glm::mat4(1.0f), 0, visited, result);
        result.renamedFile = withRenamedMaterials(gltf, file, binary, end);
    } catch (const std::exception& error) {
        throw std::runtime_error(fmt::format("{}: {}", path, error.what()));
    }
    preferOwn(result.cameras);
    preferOwn(result.lights);
    return result;
}

}  // namespace studio
