// The scene JSON of docs/scenes.md: meshes from files or as simple shapes, materials, cameras, lights,
// sky, and keyframes of rigid objects, cameras and lights.
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "json_reader.h"
#include "scene_import.h"
#include "scene_json_parts.h"
#include "scene_primitives.h"

namespace studio {
namespace {
namespace fs = std::filesystem;

glm::quat readRotation(const JsonValue& value) {
    JsonObject o = value.object();
    const glm::vec3 axis = o.need("axis", "the axis of rotation").direction();
    const float degrees = o.need("degrees", "the angle of rotation").number();
    o.finish();
    return glm::angleAxis(degrees * kDegrees, axis);
}

class Reader {
public:
    Reader(const std::string& path, Scene& scene)
        : scene_(scene), folder_(fs::path(path).parent_path()) {}
    void read(const JsonValue& root);

private:
    std::string resolve(const JsonValue& value) const {
        const std::string path = (folder_ / value.text()).string();
        if (!fs::is_regular_file(path)) value.fail(fmt::format("a file ({} does not exist)", path));
        return path;
    }
    void readMaterial(const std::string& name, const JsonValue& value);
    void readObject(const JsonValue& value);
    struct Placement {
        float scale = 1.0f;
        glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
        glm::vec3 translation{0.0f};
        glm::vec3 point(const glm::vec3& p) const { return rotation * (p * scale) + translation; }
    };
    static Placement readPlacement(JsonObject& o);
    std::vector<Mesh> importPlaced(const JsonValue& file, const Placement& place);
    void readMesh(const JsonValue& value, std::vector<Mesh> meshes);
    std::vector<Mesh> readShape(JsonObject& o);
    int findMaterial(const JsonValue& value) const;
    int findObject(const JsonValue& value) const;

    Scene& scene_;
    fs::path folder_;
};

int Reader::findMaterial(const JsonValue& value) const {
    const std::string name = value.text();
    std::string names;
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
        if (scene_.materials[i].name == name) return int(i);
        names += (i == 0 ? "" : ", ") + scene_.materials[i].name;
    }
    value.fail("the name of a material, one of: " + (names.empty() ? "(none is defined)" : names));
}

int Reader::findObject(const JsonValue& value) const {
    const std::string name = value.text();
    std::string names;
    for (std::size_t i = 1; i < scene_.objects.size(); ++i) {
        if (scene_.objects[i].name == name) return int(i);
        names += (i == 1 ? "" : ", ") + scene_.objects[i].name;
    }
    value.fail("the name of an object, one of: " + (names.empty() ? "(none is defined)" : names));
}

// A new material, or changes to all of this name that a mesh file brought.
void Reader::readMaterial(const std::string& name, const JsonValue& value) {
    std::vector<Material*> targets;
    for (Material& m : scene_.materials)
        if (m.name == name) targets.push_back(&m);
    if (targets.empty()) {
        scene_.materials.push_back(Material{});
        targets.push_back(&scene_.materials.back());
        targets.back()->name = name;
    }
    JsonObject o = value.object();
    const auto albedo = o.find("albedo"), emission = o.find("emission"), texture = o.find("texture"),
               cutoff = o.find("alpha_cutoff");
    o.finish();
    if (albedo) {
        const glm::vec3 rho = albedo->colour();
        if (rho.x > 1.0f || rho.y > 1.0f || rho.z > 1.0f) albedo->fail("reflectances of at most 1");
        for (Material* m : targets) m->albedo = rho;
    }
    if (emission)
        for (Material* m : targets) m->emission = emission->colour();
    if (cutoff)
        for (Material* m : targets) m->alphaCutoff = cutoff->number(0.0f, 1.0f);
    if (!texture) return;
    scene_.textures.push_back(readTexture(resolve(*texture)));
    for (Material* m : targets) m->texture = int(scene_.textures.size()) - 1;
}

void Reader::readObject(const JsonValue& value) {
    JsonObject o = value.object();
    Object object;
    object.name = o.need("name", "the object's name").text();
    for (const auto& [time, key] :
         readKeys<PoseKey>(o.need("keys", "a list of poses"), [](JsonObject& k) {
             PoseKey pose;
             if (const auto t = k.find("translate")) pose.translation = t->vector();
             if (const auto r = k.find("rotate")) pose.rotation = readRotation(*r);
             return pose;
         })) {
        object.keys.push_back(key);
        object.keys.back().time = time;
    }
    o.finish();
    scene_.objects.push_back(object);
}

std::vector<Mesh> Reader::readShape(JsonObject& o) {
    const auto quad = o.find("quad"), box = o.find("box"), sphere = o.find("sphere");
    if (int(quad.has_value()) + int(box.has_value()) + int(sphere.has_value()) != 1)
        o.value().fail("exactly one of file, quad, box, sphere");
    Mesh mesh;
    if (quad) {
        const std::vector<JsonValue> items = quad->list();
        if (items.size() != 4) quad->fail("four corners");
        mesh = makeQuad({items[0].vector(), items[1].vector(), items[2].vector(), items[3].vector()});
        mesh.name = "quad";
    } else if (box) {
        JsonObject b = box->object();
        const glm::vec3 lower = b.need("lower", "the lower corner").vector();
        const JsonValue upper = b.need("upper", "the upper corner");
        if (glm::any(glm::lessThanEqual(upper.vector(), lower)))
            upper.fail("a corner above lower on every axis");
        b.finish();
        mesh = makeBox(lower, upper.vector());
        mesh.name = "box";
    } else {
        JsonObject s = sphere->object();
        const glm::vec3 center = s.need("center", "the centre").vector();
        const float radius = s.need("radius", "the radius").number(0.0f, kAny);
        const auto rings = s.find("rings");
        s.finish();
        mesh = makeSphere(center, radius, rings ? rings->integer(3, 1024) : 32);
        mesh.name = "sphere";
    }
    return {mesh};
}

// Scaled, then rotated, then moved: in the object's space where the mesh belongs to one.
Reader::Placement Reader::readPlacement(JsonObject& o) {
    const auto scale = o.find("scale"), rotate = o.find("rotate"), translate = o.find("translate");
    Placement p;
    if (scale) p.scale = scale->number(0.0f, kAny);
    if (rotate) p.rotation = readRotation(*rotate);
    if (translate) p.translation = translate->vector();
    return p;
}

// What a mesh file brings, in place; its cameras and lights are placed with it.
std::vector<Mesh> Reader::importPlaced(const JsonValue& file, const Placement& place) {
    Scene part;
    importFile(resolve(file), part);
    const int firstMaterial = int(scene_.materials.size()), firstTexture = int(scene_.textures.size());
    for (Material& m : part.materials)
        if (m.texture >= 0) m.texture += firstTexture;
    for (Mesh& m : part.meshes) m.material += firstMaterial;
    scene_.materials.insert(scene_.materials.end(), part.materials.begin(), part.materials.end());
    for (Texture& t : part.textures) scene_.textures.push_back(std::move(t));
    for (Camera& c : part.cameras) {
        c.position = place.point(c.position);
        c.target = place.point(c.target);
        c.up = place.rotation * c.up;
        c.nearPlane *= place.scale;
        c.farPlane *= place.scale;
        scene_.cameras.push_back(c);
    }
    for (Light& l : part.lights) {
        l.position = place.point(l.position);
        l.direction = place.rotation * l.direction;
        scene_.lights.push_back(l);
    }
    return std::move(part.meshes);
}

void Reader::readMesh(const JsonValue& value, std::vector<Mesh> meshes) {
    JsonObject o = value.object();
    const Placement place = readPlacement(o);
    const auto name = o.find("name"), material = o.find("material"), object = o.find("object");
    if (!o.find("file")) {
        meshes = readShape(o);
        o.need("material", "the name of a material");
    }
    o.finish();
    for (Mesh& mesh : meshes) {
        for (glm::vec3& p : mesh.positions) p = place.point(p);
        for (glm::vec3& n : mesh.normals) n = place.rotation * n;
        finishMesh(mesh);
        if (mesh.triangles.empty()) value.fail("a shape with an area");
        if (name) mesh.name = name->text();
        if (material) mesh.material = findMaterial(*material);
        if (object) mesh.object = findObject(*object);
        scene_.meshes.push_back(std::move(mesh));
    }
}

void Reader::read(const JsonValue& root) {
    JsonObject o = root.object();
    const auto materials = o.find("materials"), objects = o.find("objects"), cameras = o.find("cameras"),
               lights = o.find("lights"), sky = o.find("sky"), emissive = o.find("emissive_surfaces");
    if (const auto description = o.find("description")) description->text();
    const JsonValue meshes = o.need("meshes", "a list of meshes");
    o.finish();

    if (objects)
        for (const JsonValue& item : objects->list()) readObject(item);
    // Files first: materials may change what they bring, and shapes refer to materials.
    std::vector<std::vector<Mesh>> imported;
    const std::vector<JsonValue> items = meshes.list();
    if (items.empty()) meshes.fail("at least one mesh");
    for (const JsonValue& item : items) {
        JsonObject mesh = item.object();
        const auto file = mesh.find("file");
        imported.push_back(file ? importPlaced(*file, readPlacement(mesh)) : std::vector<Mesh>());
    }
    if (materials)
        for (const auto& [name, value] : materials->members()) readMaterial(name, value);
    for (std::size_t i = 0; i < items.size(); ++i) readMesh(items[i], std::move(imported[i]));

    // The scene's own cameras come first, those of its files after them; its own lights replace theirs.
    const std::vector<Camera> fileCameras = std::move(scene_.cameras);
    scene_.cameras.clear();
    if (cameras)
        for (const JsonValue& item : cameras->list()) readJsonCamera(item, scene_);
    scene_.cameras.insert(scene_.cameras.end(), fileCameras.begin(), fileCameras.end());
    if (lights) {
        scene_.lights.clear();
        for (const JsonValue& item : lights->list()) readJsonLight(item, scene_);
    }
    if (sky) scene_.sky = sky->colour();
    scene_.emissiveSurfaces = emissive ? emissive->boolean() : scene_.lights.empty();
}

}  // namespace

void readSceneJson(const std::string& path, Scene& scene) {
    std::ifstream in(path);
    if (!in) throw std::runtime_error(fmt::format("{}: can't be read", path));
    nlohmann::json document;
    try {
        document = nlohmann::json::parse(in);
    } catch (const std::exception& error) {
        throw std::runtime_error(fmt::format("{}: {}", path, error.what()));
    }
    Reader(path, scene).read(JsonValue(document, path, ""));
}

}  // namespace studio
