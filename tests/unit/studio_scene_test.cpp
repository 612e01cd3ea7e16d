// Scenes: look-up by name, the scene JSON and its errors, poses and keyframes, textures, light profile.
#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>

#include "scene.h"
#include "support/studio_scenes.h"

using namespace studio;
using namespace studio_test;
using Catch::Contains;

namespace {

constexpr double kRounding = 1e-6;  // a few float operations on values near 1

std::string minimal(const std::string& more) {
    return R"({"meshes": [{"quad": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "material": "m"}],
               "materials": {"m": {"albedo": 0.25}})" +
           more + "}";
}

std::string jsonError(const std::string& text) {
    const TempFolder folder;
    const std::string path = folder.write("broken.json", text);
    return failure([&] { loadScene(path); });
}

}  // namespace

TEST_CASE("the shipped scenes load by name, with cameras, and their names are listed", "[scene]") {
    for (const char* name : {"cornell", "basic", "rooms", "furnace", "sphere_room"}) {
        INFO(name);
        const Scene scene = loadScene(name);
        CHECK(scene.name == name);
        CHECK_FALSE(scene.cameras.empty());
        CHECK(scene.emissiveSurfaces == scene.lights.empty());
        bool listed = false;
        for (const SceneEntry& entry : listScenes())
            listed = listed || (entry.name == name && entry.shipped);
        CHECK(listed);
    }
}

TEST_CASE("a wrong scene name or path is named together with the valid ones", "[scene]") {
    CHECK_THAT(failure([] { loadScene("no_such"); }),
               Contains("no_such") && Contains("cornell") && Contains("rooms"));
    CHECK_THAT(failure([] { loadScene("/nowhere/x.glb"); }),
               Contains("/nowhere/x.glb") && Contains("no such file"));
    const Scene scene = loadScene("basic");
    CHECK(scene.findCamera("") == 0);
    CHECK(scene.findCamera("bleeding") == 1);
    CHECK_THAT(failure([&] { scene.findCamera("side"); }),
               Contains("side") && Contains("overview, bleeding"));
}

TEST_CASE("scenes of LIGHTWELL_SCENES are found; JSON goes before a mesh file of the same stem",
          "[scene]") {
    const TempFolder folder;
    folder.write("own_scene.json", minimal(""));
    folder.write("own_scene.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const char* before = std::getenv("LIGHTWELL_SCENES");
    const std::string saved = before == nullptr ? "" : before;
    ::setenv("LIGHTWELL_SCENES", (":" + folder.path()).c_str(), 1);
    const Scene scene = loadScene("own_scene");
    ::setenv("LIGHTWELL_SCENES", "/nowhere/at/all", 1);
    const std::string error = failure([] { listScenes(); });
    if (before == nullptr)
        ::unsetenv("LIGHTWELL_SCENES");
    else
        ::setenv("LIGHTWELL_SCENES", saved.c_str(), 1);
    CHECK(scene.materials.at(0).albedo == glm::vec3(0.25f));
    CHECK_THAT(error, Contains("LIGHTWELL_SCENES") && Contains("/nowhere/at/all"));
}

TEST_CASE("errors of a scene JSON name file, key, expectation and value", "[scene][json]") {
    CHECK_THAT(jsonError("{ nonsense"), Contains("broken.json") && Contains("line 1"));
    CHECK_THAT(jsonError("[]"), Contains("the file: expected an object, got []"));
    CHECK_THAT(jsonError("{}"), Contains("meshes: expected a list of meshes, got nothing"));
    CHECK_THAT(jsonError(R"({"meshes": []})"), Contains("meshes: expected at least one mesh, got []"));
    CHECK_THAT(jsonError(minimal(R"(, "skyy": 1)")),
               Contains("skyy: unknown key") && Contains("emissive_surfaces"));
    CHECK_THAT(jsonError(minimal(R"(, "sky": -1)")),
               Contains("sky: expected a colour (no negative number), got -1"));
    CHECK_THAT(jsonError(minimal(R"(, "sky": [1, 2])")),
               Contains("sky: expected three numbers, got [1,2]"));
    CHECK_THAT(jsonError(R"({"meshes": [{"file": "gone.glb"}]})"),
               Contains("meshes[0].file: expected a file") && Contains("gone.glb"));
    CHECK_THAT(
        jsonError(R"({"meshes": [{"quad": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "material": "x"}]})"),
        Contains("meshes[0].material: expected the name of a material") && Contains("\"x\""));
    CHECK_THAT(jsonError(R"({"meshes": [{"material": "x"}]})"),
               Contains("exactly one of file, quad, box, sphere"));
    CHECK_THAT(jsonError(R"({"meshes": [{"quad": [[0,0,0],[1,0,0],[2,0,0],[3,0,0]], "material": "m"}],
                             "materials": {"m": {}}})"),
               Contains("meshes[0]: expected a shape with an area"));
    CHECK_THAT(jsonError(minimal(R"(, "cameras": [{"name": "c", "position": [0,0,0], "target": [0,0,0],
                                     "vertical_fov_degrees": 40}])")),
               Contains("cameras[0]: expected a target away"));
    CHECK_THAT(jsonError(minimal(R"(, "cameras": [{"name": "c", "position": [0,0,0], "target": [0,0,-1],
                                     "vertical_fov_degrees": 400}])")),
               Contains("vertical_fov_degrees") && Contains("170"));
    CHECK_THAT(jsonError(minimal(R"(, "lights": [{"name": "l", "kind": "lamp"}])")),
               Contains("lights[0].kind: expected sun, spot or point, got \"lamp\""));
    CHECK_THAT(
        jsonError(minimal(
            R"(, "lights": [{"name": "l", "kind": "sun", "direction": [0,-1,0], "intensity": 3}])")),
        Contains("lights[0].irradiance: expected"));
    CHECK_THAT(jsonError(minimal(
                   R"(, "lights": [{"name": "l", "kind": "sun", "direction": [0,-1,0], "irradiance": 3,
                                     "position": [0,0,0]}])")),
               Contains("lights[0].position: unknown key"));
    CHECK_THAT(
        jsonError(minimal(
            R"(, "lights": [{"name": "l", "kind": "spot", "position": [0,1,0], "direction": [0,-1,0],
                                     "intensity": 3, "inner_cone_degrees": 50, "outer_cone_degrees": 40}])")),
        Contains("inner_cone_degrees: expected an inner cone of at most the outer one, got 50"));
    CHECK_THAT(jsonError(minimal(R"(, "objects": [{"name": "o", "keys": [{"time": 1}, {"time": 1}]}])")),
               Contains("objects[0].keys[1].time: expected a time after the key before, 1"));
    CHECK_THAT(jsonError(R"({"meshes": [{"quad": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "material": "m"}],
                             "materials": {"m": {"albedo": 1.5}}})"),
               Contains("reflectances of at most 1, got 1.5"));
}

TEST_CASE("meshes are scaled, then rotated, then moved", "[scene][json]") {
    const TempFolder folder;
    const Scene scene =
        loadScene(folder.write("s.json", R"({"meshes": [{"box": {"lower": [0,0,0], "upper": [1,2,3]},
        "material": "m", "scale": 2, "rotate": {"axis": [0,0,1], "degrees": 90}, "translate": [10,0,0]}],
        "materials": {"m": {}}})"));
    glm::vec3 lower, upper;
    scene.bounds(lower, upper);
    // (x, y) -> (-y, x): x in [-4, 0] + 10, y in [0, 2], z in [0, 6].
    const double tolerance = 1e-5;  // float sine and cosine of 90 degrees, times 4
    CHECK(lower.x == Approx(6).margin(tolerance));
    CHECK(upper.x == Approx(10).margin(tolerance));
    CHECK(lower.y == Approx(0).margin(tolerance));
    CHECK(upper.y == Approx(2).margin(tolerance));
    CHECK(upper.z == Approx(6).margin(tolerance));
    CHECK(scene.cameras.at(0).name == "overview");
    CHECK(scene.emissiveSurfaces);
}

TEST_CASE("shapes face outwards with unit normals and the right area", "[scene]") {
    const Mesh box = makeBox(glm::vec3(-1), glm::vec3(1, 2, 3));
    const Mesh sphere = makeSphere(glm::vec3(1, 2, 3), 2.0f, 64);
    double boxArea = 0.0, sphereArea = 0.0;
    for (const auto* shape : {&box, &sphere}) {
        const glm::dvec3 center = shape == &box ? glm::dvec3(0, 0.5, 1) : glm::dvec3(1, 2, 3);
        for (const glm::uvec3& t : shape->triangles) {
            const glm::dvec3 a(shape->positions[t.x]), b(shape->positions[t.y]),
                c(shape->positions[t.z]);
            const glm::dvec3 cross = glm::cross(b - a, c - a);
            REQUIRE(glm::dot(cross, a - center) > 0.0);
            REQUIRE(glm::dot(cross, glm::dvec3(shape->normals[t.x])) > 0.0);
            REQUIRE(glm::length(shape->normals[t.x]) == Approx(1.0).epsilon(kRounding));
            (shape == &box ? boxArea : sphereArea) += 0.5 * glm::length(cross);
        }
    }
    CHECK(boxArea == Approx(2 * (2 * 3 + 2 * 4 + 3 * 4)).epsilon(kRounding));
    CHECK(sphereArea == Approx(16 * 3.14159265).epsilon(2e-3));  // inscribed: 64 bands lose 0.1 %
}

TEST_CASE("poses turn and move between keys and rest outside them", "[scene][keys]") {
    Object object;
    object.keys = {{1.0f, {0, 0, 0}, glm::angleAxis(0.0f, glm::vec3(0, 1, 0))},
                   {3.0f, {4, 0, 0}, glm::angleAxis(glm::radians(90.0f), glm::vec3(0, 1, 0))}};
    const auto at = [&](float time) { return glm::vec3(object.poseAt(time) * glm::vec4(1, 0, 0, 1)); };
    const auto near = [](const glm::vec3& a, const glm::vec3& b) { return glm::length(a - b) < 1e-5f; };
    CHECK(near(at(0.0f), {1, 0, 0}));
    CHECK(near(at(1.0f), {1, 0, 0}));
    const float half = std::sqrt(0.5f);  // 45 degrees about +Y takes +X towards -Z
    CHECK(near(at(2.0f), {2 + half, 0, -half}));
    CHECK(near(at(3.0f), {4, 0, -1}));
    CHECK(near(at(9.0f), {4, 0, -1}));
    CHECK(Object{}.poseAt(5.0f) == glm::mat4(1.0f));
}

TEST_CASE("cameras and lights follow their keys", "[scene][keys]") {
    const TempFolder folder;
    const Scene scene = loadScene(folder.write("s.json", minimal(R"(,
        "cameras": [{"name": "still", "position": [0,0,5], "target": [0,0,0], "vertical_fov_degrees": 40},
                    {"name": "c", "position": [0,0,5], "target": [0,0,0], "vertical_fov_degrees": 40,
                     "keys": [{"time": 0}, {"time": 2, "position": [4,0,5]}]}],
        "lights": [{"name": "l", "kind": "point", "position": [0,1,0], "intensity": [1,2,3],
                    "keys": [{"time": 0}, {"time": 2, "intensity": 5, "position": [2,1,0]}]}])")));
    CHECK(scene.cameraAt(0, 1.0f).position == glm::vec3(0, 0, 5));
    CHECK(scene.cameraAt(1, 1.0f).position == glm::vec3(2, 0, 5));
    CHECK(scene.cameraAt(1, 1.0f).name == "c");
    CHECK(scene.cameraAt(1, 7.0f).position == glm::vec3(4, 0, 5));
    CHECK_THAT(failure([&] {
                   Scene through = scene;
                   through.cameraTracks[0].keys[1].second.position = {0, 0, -5};
                   through.cameraAt(1, 1.0f);
               }),
               Contains("\"c\" at 1 s") && Contains("target"));
    CHECK(scene.lightAt(0, 1.0f).emitted == glm::vec3(3, 3.5f, 4));
    CHECK(scene.lightAt(0, 1.0f).position == glm::vec3(1, 1, 0));
    CHECK(scene.lightAt(0, 1.0f).kind == LightKind::Point);
}

TEST_CASE("the closed door of the two rooms seals them, the open one does not", "[scene]") {
    const auto scene = shared(loadScene("rooms"));
    // From the lit to the dark room through the middle of the doorway.
    const glm::vec3 from(-1.0f, 1.0f, 0.0f), along(1.0f, 0.0f, 0.0f);
    CHECK_FALSE(RayScene(scene, 0.0f).occluded(from, along, 0.0f, 2.0f));
    const RayScene closed(scene, 4.0f);
    CHECK(closed.occluded(from, along, 0.0f, 2.0f));
    for (int i = 0; i <= 200; ++i)  // along the gap under the door and beside it
        for (const float y : {1e-4f, 1.0f, 1.9999f}) {
            const glm::vec3 start(-1.0f, y, -0.45f + 0.9f * float(i) / 200.0f);
            REQUIRE(closed.occluded(start, along, 0.0f, 2.0f));
        }
}

TEST_CASE("the spot profile is glTF's", "[scene][light]") {
    const float inner = 0.3f, outer = 0.7f;
    const Light light = spot({0, 0, 0}, {0, 0, -1}, 1.0f, inner, outer);
    const auto at = [&](float angle) {
        return coneFalloff(light, {std::sin(angle), 0.0f, -std::cos(angle)});
    };
    CHECK(at(0.0f) == 1.0f);
    CHECK(at(0.29f) == 1.0f);
    CHECK(at(0.71f) == 0.0f);
    CHECK(at(3.0f) == 0.0f);
    // KHR_lights_punctual's formula with its angular scale and offset.
    const double scale = 1.0 / std::max(0.001, std::cos(double(inner)) - std::cos(double(outer)));
    const double offset = -std::cos(double(outer)) * scale;
    for (double angle = 0.31; angle < 0.69; angle += 0.02) {
        const double attenuation = std::cos(angle) * scale + offset;
        CHECK(double(at(float(angle))) ==
              Approx(attenuation * attenuation).margin(1e-5));  // float cosines
    }
    const Light hard = spot({0, 0, 0}, {0, 0, -1}, 1.0f, outer, outer);
    CHECK(coneFalloff(hard, glm::vec3(0, 0, -1)) == 1.0f);
    CHECK(coneFalloff(sun({0, -1, 0}, 1.0f), glm::vec3(0, 1, 0)) == 1.0f);
}

TEST_CASE("textures are sRGB, bilinear in linear light, and repeat", "[scene][texture]") {
    Texture texture;
    texture.width = 2;
    texture.height = 1;
    texture.rgba = {188, 0, 255, 255, 0, 255, 255, 51};
    // Texel centres at u = 0.25 and 0.75; 188 is 0.5029 linear (IEC 61966-2-1).
    const double half = std::pow((188.0 / 255.0 + 0.055) / 1.055, 2.4);
    CHECK(texture.lookup({0.25f, 0.5f}).r == Approx(half).epsilon(kRounding));
    CHECK(texture.lookup({0.75f, 0.9f}).a == Approx(0.2).epsilon(kRounding));
    CHECK(texture.lookup({0.5f, 0.1f}).r == Approx(half / 2).epsilon(kRounding));
    CHECK(texture.lookup({0.0f, 0.1f}).r == Approx(half / 2).epsilon(kRounding));  // across the border
    CHECK(texture.lookup({-7.75f, 3.5f}).r == Approx(half).epsilon(kRounding));
    CHECK(texture.lookup({1.0f, 1.0f}).g == Approx(0.5).epsilon(kRounding));
}

TEST_CASE("a light's direction keeps its bits, and its meaning at the ends of floats", "[scene]") {
    const auto directionOf = [](const std::string& text) {
        const TempFolder folder;
        const std::string path = folder.write(
            "sun.json",
            minimal(R"(, "lights": [{"name": "l", "kind": "sun", "irradiance": 1, "direction": )" +
                    text + "}]"));
        return loadScene(path).lights.at(0).direction;
    };
    // Kept truths are named by the scene's bits: the sun of `basic`, as single precision has it.
    const glm::vec3 sun(0.4f, -1.0f, -0.55f);
    CHECK(directionOf("[0.4, -1.0, -0.55]") == sun / glm::length(sun));
    for (const char* text : {"[3e30, -4e30, 0]", "[3e-30, -4e-30, 0]"}) {
        INFO(text);
        const glm::vec3 direction = directionOf(text);
        CHECK(std::abs(direction.x - 0.6) < kRounding);
        CHECK(std::abs(direction.y + 0.8) < kRounding);
    }
}
