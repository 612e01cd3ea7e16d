// A scene as the studio sees it: triangles in world space with diffuse materials, cameras, lights,
// a sky, and keyframes. Units as in lightwell.h: metres, linear RGB, W.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace studio {

constexpr float kPi = 3.14159265358979323846f;

// 8-bit texture as decoded; colour textures are sRGB-encoded, looked up bilinearly in linear light.
struct Texture {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgba;
    glm::vec4 lookup(glm::vec2 uv) const;  // linear RGB and alpha, wrapping
};

struct Material {
    std::string name;
    glm::vec3 albedo{0.5f};     // base colour; a [metal] is taken as diffuse of its base colour
    glm::vec3 emission{0.0f};   // radiance, W/(sr m^2)
    int texture = -1;           // index of the base-colour texture
    float alphaCutoff = 0.0f;   // > 0: alpha mask
};

// Rigid objects: `vertices` are in object space, moved by the object's pose at the time of evaluation.
struct Mesh {
    std::string name;
    int material = 0;
    int object = 0;  // index of Scene::objects; object 0 never moves
    std::vector<glm::vec3> positions, normals;  // same length; normals unit
    std::vector<glm::vec2> uvs;                 // same length, or empty
    std::vector<glm::uvec3> triangles;
};

// Rigid pose (rotation then translation), linear / spherical interpolation between keys.
struct PoseKey {
    float time = 0.0f;
    glm::vec3 translation{0.0f};
    glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
};
struct Object {
    std::string name;
    std::vector<PoseKey> keys;  // empty: at rest
    glm::mat4 poseAt(float time) const;
};

struct Camera {
    std::string name;
    glm::vec3 position{0.0f}, target{0.0f, 0.0f, -1.0f}, up{0.0f, 1.0f, 0.0f};
    float verticalFov = 1.0f;   // radians, whole angle
    float aspect = 0.0f;        // width / height suggested by the file; 0: any
    float nearPlane = 0.01f, farPlane = 1000.0f;  // for depth outputs only
    glm::mat4 viewMatrix() const;                            // right-handed, looking down -z
    glm::mat4 projectionMatrix(int width, int height) const; // clip z in [0,1]
};

enum class LightKind { Sun, Spot, Point };
struct Light {
    std::string name;
    LightKind kind = LightKind::Sun;
    glm::vec3 position{0.0f}, direction{0.0f, -1.0f, 0.0f};  // direction: the way light travels, unit
    glm::vec3 emitted{1.0f};  // sun: E_perp, W/m^2; spot (on its axis), point: intensity, W/sr
    float innerCone = 0.0f, outerCone = 0.785398f;  // spot: half angles, radians
};

// Spot profile of KHR_lights_punctual: 1 inside the inner cone, 0 outside the outer, and the square of
// the linear ramp in the cosine between. 1 for other lights. `toSurface`: unit, light to surface.
float coneFalloff(const Light& light, const glm::vec3& toSurface);

// What a light would bring to a position with nothing between: where it comes from, how far that is
// (infinity for a sun), and the irradiance of a surface that faces it. Zero at a light's very place.
struct LightArrival {
    glm::vec3 toLight{0.0f}, irradiance{0.0f};
    float distance = 0.0f;
};
LightArrival arrivalOf(const Light& light, const glm::vec3& position);

template <class T> struct Track {  // keyframes of a camera or light; linear in every field
    int target = 0;
    std::vector<std::pair<float, T>> keys;
};

struct Scene {
    std::string name, path;
    std::vector<Texture> textures;
    std::vector<Material> materials;
    std::vector<Mesh> meshes;
    std::vector<Object> objects{Object{}};
    std::vector<Camera> cameras;
    std::vector<Light> lights;
    glm::vec3 sky{0.0f};             // radiance of rays that leave the scene
    bool emissiveSurfaces = false;   // whether material emission lights the scene
    std::vector<Track<Camera>> cameraTracks;
    std::vector<Track<Light>> lightTracks;

    Camera cameraAt(int index, float time) const;
    Light lightAt(int index, float time) const;
    // Index by name ("" = the first); throws naming the valid ones.
    int findCamera(const std::string& cameraName) const;
    void bounds(glm::vec3& lower, glm::vec3& upper) const;  // at time 0
};

// Directory of the shipped scenes, then LIGHTWELL_SCENES (':'-separated), then a path.
// `name`: a stem, or a path to a scene JSON, glTF, GLB or OBJ. Errors: std::runtime_error naming the
// path or the valid names.
Scene loadScene(const std::string& nameOrPath);
struct SceneEntry { std::string name, path; bool shipped = false; };
std::vector<SceneEntry> listScenes();

}  // namespace studio
