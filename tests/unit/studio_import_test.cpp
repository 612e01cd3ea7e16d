// glTF and OBJ import: what Assimp drops or renumbers, double-sided normals, masks, and the test scenes.
#include <catch2/catch.hpp>

#include <cstdlib>
#include <cstring>
#include <fstream>

#include "image.h"
#include "scene_import.h"
#include "support/studio_scenes.h"

using namespace studio;
using namespace studio_test;
using Catch::Contains;

namespace {

// GLB of one position accessor (a triangle of legs 1 in the plane z = 0) that all meshes share.
std::string makeGlb(std::string json) {
    const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    while (json.size() % 4 != 0) json += ' ';
    std::string bin(reinterpret_cast<const char*>(positions), sizeof positions);
    const auto word = [](std::uint32_t v) { return std::string(reinterpret_cast<const char*>(&v), 4); };
    return "glTF" + word(2) + word(std::uint32_t(28 + json.size() + bin.size())) +
           word(std::uint32_t(json.size())) + "JSON" + json + word(std::uint32_t(bin.size())) +
           std::string("BIN\0", 4) + bin;
}

// Nodes, meshes, materials and what else is given; buffers and accessors are added.
std::string gltfJson(const std::string& parts) {
    return R"({"asset": {"version": "2.0"}, "scene": 0, "buffers": [{"byteLength": 36}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                       "min": [0,0,0], "max": [1,1,0]}], )" +
           parts + "}";
}

const char* kMeshes = R"("meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 2}]},
    {"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]},
    {"primitives": [{"attributes": {"POSITION": 0}, "material": 1}]}])";

const char* kMaterials = R"("materials": [
    {"name": "lamp", "emissiveFactor": [1, 0.5, 0.25],
     "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}}},
    {"name": "pane [glass]"},
    {"name": "lamp", "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 1], "metallicFactor": 1},
     "emissiveFactor": [1, 1, 1], "extras": {"emissive_radiance": [30, 20, 10]}}])";

Scene loadGlb(const std::string& parts) {
    const TempFolder folder;
    return loadScene(folder.write("file.glb", makeGlb(gltfJson(parts))));
}

}  // namespace

TEST_CASE("glTF materials keep their numbers, emission strength and names; glass goes", "[import]") {
    // The nodes use the materials in another order than the file lists them, and two share a name.
    const Scene scene = loadGlb(std::string(R"("scenes": [{"nodes": [0, 1, 2]}],
        "nodes": [{"mesh": 0, "name": "a"}, {"mesh": 1, "name": "b", "translation": [0, 0, 5]}, {"mesh": 2}], )") +
                                kMeshes + ", " + kMaterials);
    REQUIRE(scene.meshes.size() == 2);
    const Material& first = scene.materials.at(std::size_t(scene.meshes[0].material));
    CHECK(first.albedo == glm::vec3(0.1f, 0.2f, 0.3f));
    CHECK(first.emission == glm::vec3(30, 20, 10));
    const Material& second = scene.materials.at(std::size_t(scene.meshes[1].material));
    CHECK(second.emission == glm::vec3(8, 4, 2));
    CHECK(second.albedo == glm::vec3(1));
    CHECK(scene.meshes[1].positions.at(0).z == 5.0f);
    CHECK(scene.emissiveSurfaces);                               // no punctual light
    CHECK(scene.meshes[0].normals.at(0) == glm::vec3(0, 0, 1));  // made flat
}

TEST_CASE("glTF cameras and lights come through node transforms with the file's numbers", "[import]") {
    const std::string parts = std::string(R"("scenes": [{"nodes": [0, 1]}], "nodes": [{"mesh": 0},
        {"translation": [1, 2, 3], "rotation": [0, 0.70710678, 0, 0.70710678], "children": [2, 3, 4, 5]},
        {"name": "suggested_camera", "camera": 0}, {"name": "own_camera", "camera": 0, "translation": [0, 0, 1]},
        {"name": "suggested_light", "extensions": {"KHR_lights_punctual": {"light": 1}}},
        {"name": "lamp", "extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "aspectRatio": 0.5, "znear": 0.1}}],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "color": [1, 0.5, 0.25], "intensity": 40,
            "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.6}}, {"type": "directional"}]}}, )") +
                              kMeshes + ", " + kMaterials;
    const Scene scene = loadGlb(parts);
    REQUIRE(scene.cameras.size() == 1);  // the suggestion gives way to the file's own
    const Camera& camera = scene.cameras[0];
    CHECK(camera.name == "own_camera");
    // A quarter turn about +Y takes the parent's +Z to +X: one unit along it from (1, 2, 3).
    CHECK(glm::length(camera.position - glm::vec3(2, 2, 3)) < 1e-5f);
    CHECK(glm::length(camera.target - camera.position - glm::vec3(-1, 0, 0)) < 1e-5f);
    CHECK(camera.verticalFov == 0.8f);
    CHECK(camera.aspect == 0.5f);
    REQUIRE(scene.lights.size() == 1);
    const Light& light = scene.lights[0];
    CHECK(light.kind == LightKind::Spot);
    CHECK(light.emitted == glm::vec3(40, 20, 10));
    CHECK(light.innerCone == 0.2f);
    CHECK(light.outerCone == 0.6f);
    CHECK(glm::length(light.direction - glm::vec3(-1, 0, 0)) < 1e-5f);
    CHECK_FALSE(scene.emissiveSurfaces);
}

TEST_CASE("broken files are named with the reason", "[import]") {
    const TempFolder folder;
    CHECK_THAT(failure([&] { loadScene(folder.write("cut.glb", "glTF")); }), Contains("cut.glb"));
    CHECK_THAT(failure([&] { loadScene(folder.write("text.gltf", "not json")); }),
               Contains("text.gltf"));
    CHECK_THAT(failure([&] { loadScene(folder.write("empty.obj", "# nothing\n")); }),
               Contains("empty.obj"));
    CHECK_THAT(failure([&] { loadScene(folder.write("x.ply", "ply\n")); }),
               Contains("x.ply") && Contains(".glb"));
    CHECK_THAT(
        failure([&] { loadScene(folder.write("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")); }),
        Contains("nan.obj"));
    CHECK_THAT(failure([&] {
                   folder.write("t.mtl", "newmtl m\nmap_Kd gone.png\n");
                   loadScene(folder.write(
                       "t.obj", "mtllib t.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
               }),
               Contains("gone.png"));
}

TEST_CASE("numbers without a meaning are refused, whatever the format", "[import]") {
    const auto refused = [](const std::string& node, const std::string& parts, const char* field,
                            const char* came) {
        const std::string all = R"("scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0)" + node +
                                R"(}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0},
                                   "material": 0}]}])" +
                                parts;
        INFO(all);
        CHECK_THAT(failure([&] { loadGlb(all); }),
                   Contains("file.glb") && Contains(field) && Contains(came));
    };
    const auto material = [&](const std::string& fields, const char* field, const char* came) {
        refused("", R"(, "materials": [{"name": "m", )" + fields + "}]", field, came);
    };
    material(R"("pbrMetallicRoughness": {"baseColorFactor": [1, 5, 1, 1]})", "base colour", "(1, 5, 1)");
    material(R"("pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1]})", "baseColorFactor", "[1,1,1]");
    material(R"("emissiveFactor": [0, -1, 0])", "emission", "(0, -1, 0)");
    material(R"("emissiveFactor": [1, 1, 1], "extensions": {"KHR_materials_emissive_strength":
                {"emissiveStrength": 1e39}})",
             "emission", "inf");
    const auto light = [&](const std::string& fields, const char* field, const char* came) {
        refused(R"(, "extensions": {"KHR_lights_punctual": {"light": 0}})",
                R"(, "materials": [{}], "extensionsUsed": ["KHR_lights_punctual"],
                   "extensions": {"KHR_lights_punctual": {"lights": [{)" +
                    fields + "}]}}",
                field, came);
    };
    light(R"("type": "point", "intensity": -3)", "intensity", "-3");
    light(R"("type": "spot", "spot": {"innerConeAngle": 1, "outerConeAngle": 0.5})", "inner cone", "1");
    light(R"("type": "spot", "spot": {"outerConeAngle": 3})", "outer cone", "3");
    const auto camera = [&](const std::string& fields, const char* field, const char* came) {
        refused(R"(, "camera": 0)",
                R"(, "materials": [{}], "cameras": [{"type": "perspective", "perspective": {)" + fields +
                    "}}]",
                field, came);
    };
    camera(R"("yfov": 0, "znear": 0.1)", "field of view", "got 0");
    camera(R"("yfov": 4, "znear": 0.1)", "field of view", "got 4");
    camera(R"("yfov": 1, "znear": 0)", "near plane", "got 0");
    camera(R"("yfov": 1, "znear": 2, "zfar": 1)", "far plane", "got 1");
    const TempFolder folder;
    folder.write("m.mtl", "newmtl m\nKd nan -1 0.5\n");
    CHECK_THAT(failure([&] {
                   loadScene(folder.write(
                       "m.obj", "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
               }),
               Contains("m.obj") && Contains("base colour") && Contains("nan"));
}

TEST_CASE("glTF nodes that form no tree are refused instead of walked for ever", "[import]") {
    const auto nodes = [](const std::string& list) {
        return failure([&] {
            loadGlb(R"("scenes": [{"nodes": [0]}], "nodes": [)" + list + "], " + kMeshes + ", " +
                    kMaterials);
        });
    };
    CHECK_THAT(nodes(R"({"mesh": 0, "children": [0]})"), Contains("node 0") && Contains("one parent"));
    CHECK_THAT(nodes(R"({"mesh": 0, "children": [1]}, {"children": [0]})"), Contains("node 0"));
    CHECK_THAT(nodes(R"({"mesh": 0, "children": [7]})"), Contains("0 .. 0") && Contains("got 7"));
    std::string chain;
    for (int i = 1; i < 1100; ++i) chain += R"({"children": [)" + std::to_string(i) + "]}, ";
    CHECK_THAT(nodes(chain + R"({"mesh": 0})"), Contains("1000 levels"));
}

TEST_CASE("glTF coverage is the factor's alpha times the texture's", "[import]") {
    const auto load = [](const std::string& material) {
        return loadGlb(R"("scenes": [{"nodes": [0, 1]}], "nodes": [{"mesh": 0}, {"mesh": 1}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]},
                       {"primitives": [{"attributes": {"POSITION": 0}, "material": 1}]}],
            "materials": [{"name": "m", )" +
                       material + R"(}, {"name": "other"}])");
    };
    const auto masked = [&](float alpha) {
        return load(R"("alphaMode": "MASK", "alphaCutoff": 0.4, "pbrMetallicRoughness":
                       {"baseColorFactor": [1, 1, 1, )" +
                    std::to_string(alpha) + "]}");
    };
    CHECK(masked(0.5f).meshes.size() == 2);
    CHECK(masked(0.3f).meshes.size() == 1);  // nothing of it is left
    const std::string texture = R"("alphaMode": "MASK", "alphaCutoff": 0.4, "pbrMetallicRoughness":
        {"baseColorTexture": {"index": 0}, "baseColorFactor": [1, 1, 1, 0.5]})";
    // Assimp refuses the absent picture; the reader of the JSON has come before it.
    const TempFolder folder;
    const GltfExtras extras = readGltfExtras(folder.write(
        "t.glb", makeGlb(gltfJson(R"("scenes": [], "materials": [{"name": "m", )" + texture + "}]"))));
    CHECK(extras.materials.at(0).material.alphaCutoff == 0.8f);
    CHECK_FALSE(extras.materials.at(0).dropped);
}

TEST_CASE("OBJ: colours, emission, texture the right way up, mask as holes", "[import]") {
    const TempFolder folder;
    // Upper half red, lower half green; the mask's left half is open.
    Image colour(4, 4), mask(4, 4);
    for (int i = 0; i < 16; ++i) {
        const bool top = i < 8, left = i % 4 < 2;
        colour.plane("R").resize(16), colour.plane("G").resize(16), colour.plane("B").resize(16);
        colour.plane("R")[std::size_t(i)] = top ? 1.0f : 0.0f;
        colour.plane("G")[std::size_t(i)] = top ? 0.0f : 1.0f;
        for (const char* c : {"R", "G", "B"}) mask.plane(c)[std::size_t(i)] = left ? 0.0f : 1.0f;
    }
    writePng(folder.path() + "/colour.png", colour);
    writePng(folder.path() + "/mask.png", mask);
    folder.write("q.mtl", "newmtl m\nKd 0.5 0.5 0.5\nKe 3 2 1\nmap_Kd colour.png\nmap_d mask.png\n");
    const auto scene = shared(loadScene(
        folder.write("q.obj",
                     "mtllib q.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                     "usemtl m\nf 1/1 2/2 3/3 4/4\n")));
    CHECK(scene->emissiveSurfaces);
    const RayScene rays(scene, 0.0f);
    const glm::vec3 towards(0, 0, -1);
    Hit hit;
    REQUIRE(rays.trace({0.75f, 0.8f, 1.0f}, towards, 0.0f, 10.0f, hit));
    CHECK(hit.albedo == glm::vec3(0.5f, 0, 0));  // the picture's top is the quad's
    CHECK(hit.emission == glm::vec3(3, 2, 1));
    REQUIRE(rays.trace({0.75f, 0.2f, 1.0f}, towards, 0.0f, 10.0f, hit));
    CHECK(hit.albedo == glm::vec3(0, 0.5f, 0));
    CHECK_FALSE(rays.trace({0.25f, 0.5f, 1.0f}, towards, 0.0f, 10.0f, hit));
    CHECK_FALSE(rays.occluded({0.25f, 0.5f, 1.0f}, towards, 0.0f, 10.0f));
    CHECK(rays.occluded({0.75f, 0.5f, 1.0f}, towards, 0.0f, 10.0f));
}

TEST_CASE("unusable normals are mended and degenerate triangles dropped", "[import]") {
    const TempFolder folder;
    const Scene scene = loadScene(folder.write(
        "n.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nvn 0 0 0\nvn 0 0 5\nf 1//1 2//1 3//2\nf 1//2 2//2 4//2\n"));
    REQUIRE(scene.meshes.size() == 1);
    CHECK(scene.meshes[0].triangles.size() == 1);
    for (const glm::uvec3& t : scene.meshes[0].triangles)
        for (int corner = 0; corner < 3; ++corner)
            CHECK(scene.meshes[0].normals[t[corner]] == glm::vec3(0, 0, 1));
}

// Triangles (after [glass]), first camera's height and field of view, as the scenes' page states them.
TEST_CASE("the scenes of LIGHTWELL_SCENES load with the numbers their page states", "[import][scenes]") {
    struct Expected {
        const char* name;
        std::size_t triangles;  // at most; [glass] goes
        float cameraY, degrees;
        LightKind light;
        float emitted;
    };
    const Expected table[] = {{"cornell_original", 36, 1.0f, 38, LightKind::Spot, 100},
                              {"sponza_crytek", 262266, 2.2f, 55, LightKind::Sun, 10},
                              {"sponza_dabrovic", 66445, 3.0f, 55, LightKind::Sun, 10},
                              {"sibenik", 73553, -11.5f, 55, LightKind::Spot, 100},
                              {"wooden_staircase", 262508, 1.527f, 35, LightKind::Spot, 100},
                              {"living_room", 142973, 0.731f, 58, LightKind::Sun, 10},
                              {"breakfast_room", 269538, 2.762f, 36, LightKind::Sun, 10},
                              {"level_zdm2", 70691, 9.7f, 60, LightKind::Sun, 10},
                              {"bunny_corner", 69455, 1.1f, 40, LightKind::Sun, 10}};
    int found = 0;
    for (const SceneEntry& entry : listScenes())
        for (const Expected& expected : table) {
            if (entry.name != expected.name) continue;
            ++found;
            INFO(entry.name);
            const Scene scene = loadScene(entry.path);
            bool glass = false;
            std::size_t triangles = 0;
            for (const Mesh& mesh : scene.meshes) triangles += mesh.triangles.size();
            glass = entry.name == "living_room" || entry.name == "wooden_staircase";
            if (glass)
                CHECK(triangles < expected.triangles);
            else
                CHECK(triangles == expected.triangles);
            CHECK(scene.cameras.at(0).position.y == Approx(expected.cameraY));
            CHECK(scene.cameras[0].verticalFov == Approx(expected.degrees * kPi / 180));
            CHECK(scene.lights.at(0).kind == expected.light);
            CHECK(scene.lights[0].emitted == glm::vec3(expected.emitted));
            CHECK_FALSE(scene.emissiveSurfaces);
        }
    if (found == 0) WARN("LIGHTWELL_SCENES holds none of the test scenes: not checked");
}
