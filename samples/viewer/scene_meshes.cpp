#include "scene_meshes.h"

#include <algorithm>
#include <cstddef>

namespace viewer {
namespace {

const char* const kSurfaceVertex = R"(#version 330 core
layout(location = 0) in vec3 positionObject;
layout(location = 1) in vec3 normalObject;
layout(location = 2) in vec2 textureCoordinate;
uniform mat4 clipFromWorld, pose, previousClipFromWorld, previousPose;
out vec3 positionWorld, normalWorld;
out vec2 uv;
out vec4 clipNow, clipBefore;
void main() {
    positionWorld = (pose * vec4(positionObject, 1.0)).xyz;
    normalWorld = mat3(pose) * normalObject;
    uv = textureCoordinate;
    clipNow = clipFromWorld * vec4(positionWorld, 1.0);
    clipBefore = previousClipFromWorld * (previousPose * vec4(positionObject, 1.0));
    gl_Position = clipNow;
}
)";

struct Vertex {
    glm::vec3 position, normal;
    glm::vec2 uv;
};

// sRGB texels are filtered in linear light, as the studio does; mip levels keep far ones from flickering.
Texture makeColourTexture(int width, int height, const std::uint8_t* rgba) {
    Texture texture({GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE, 4}, width, height);
    glBindTexture(GL_TEXTURE_2D, texture.get());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
    glGenerateMipmap(GL_TEXTURE_2D);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
    return texture;
}

void describeVertices() {
    const auto attribute = [](GLuint index, GLint count, std::size_t byteOffset) {
        glEnableVertexAttribArray(index);
        glVertexAttribPointer(index, count, GL_FLOAT, GL_FALSE, sizeof(Vertex), reinterpret_cast<const void*>(byteOffset));
    };
    attribute(0, 3, offsetof(Vertex, position));
    attribute(1, 3, offsetof(Vertex, normal));
    attribute(2, 2, offsetof(Vertex, uv));
}

}  // namespace

Poses posesAt(const studio::Scene& scene, float time) {
    Poses poses;
    for (const studio::Object& object : scene.objects) poses.push_back(object.poseAt(time));
    return poses;
}

glm::mat4 rasterMatrix(const glm::mat4& projection, const glm::mat4& view, bool isReversed) {
    glm::dmat4 toGl(1.0);
    toGl[1][1] = -1.0;
    toGl[2][2] = isReversed ? -1.0 : 2.0;
    toGl[3][2] = isReversed ? 1.0 : -1.0;
    return glm::mat4(toGl * glm::dmat4(projection) * glm::dmat4(view));
}

glm::vec4 axialRow(const glm::mat4& view) {
    return -glm::vec4(view[0][2], view[1][2], view[2][2], view[3][2]);
}

SurfacePrograms::SurfacePrograms(const std::string& name, const std::string& fragment)
    : whole_(name, kSurfaceVertex, "#version 330 core\n" + std::string(kSurfaceFragment) + fragment),
      masked_(name + " with holes", kSurfaceVertex, "#version 330 core\n#define MASKED\n" + std::string(kSurfaceFragment) + fragment) {}

SceneMeshes::SceneMeshes(const studio::Scene& scene) : array_(makeVertexArray()), vertices_(makeBuffer()), indices_(makeBuffer()) {
    const std::uint8_t white[4] = {255, 255, 255, 255};
    textures_.push_back(makeColourTexture(1, 1, white));
    for (const studio::Texture& texture : scene.textures)
        textures_.push_back(makeColourTexture(texture.width, texture.height, texture.rgba.data()));
    std::vector<Vertex> vertices;
    std::vector<glm::uvec3> triangles;
    for (const studio::Mesh& mesh : scene.meshes) {
        const studio::Material& material = scene.materials.at(std::size_t(mesh.material));
        const bool isTextured = material.texture >= 0 && !mesh.uvs.empty();
        draws_.push_back({GLsizei(3 * mesh.triangles.size()), triangles.size() * sizeof(glm::uvec3), GLint(vertices.size()), mesh.object,
                          material.albedo, isTextured ? material.alphaCutoff : 0.0f,
                          isTextured ? std::size_t(material.texture) + 1 : 0});
        for (std::size_t i = 0; i < mesh.positions.size(); ++i)
            vertices.push_back({mesh.positions[i], mesh.normals[i], mesh.uvs.empty() ? glm::vec2(0.0f) : mesh.uvs[i]});
        triangles.insert(triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
    }
    triangleCount_ = triangles.size();
    std::sort(draws_.begin(), draws_.end(), [](const Draw& a, const Draw& b) { return a.texture < b.texture; });
    glBindVertexArray(array_.get());
    glBindBuffer(GL_ARRAY_BUFFER, vertices_.get());
    glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(vertices.size() * sizeof(Vertex)), vertices.data(), GL_STATIC_DRAW);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.get());
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, GLsizeiptr(triangles.size() * sizeof(glm::uvec3)), triangles.data(), GL_STATIC_DRAW);
    describeVertices();
}

void SceneMeshes::draw(const SurfacePrograms& programs, const Poses& now, const Poses* before) const {
    glBindVertexArray(array_.get());
    draw(programs.whole(), false, now, before);
    draw(programs.masked(), true, now, before);
}

void SceneMeshes::draw(const Program& program, bool isMasked, const Poses& now, const Poses* before) const {
    program.use();
    program.set("baseColour", 0);
    for (const Draw& draw : draws_) {
        if ((draw.alphaCutoff > 0.0f) != isMasked) continue;
        program.set("pose", now[std::size_t(draw.object)]);
        if (before != nullptr) program.set("previousPose", (*before)[std::size_t(draw.object)]);
        program.set("reflectance", draw.reflectance);
        program.set("alphaCutoff", draw.alphaCutoff);
        textures_[draw.texture].bind(0);
        glDrawElementsBaseVertex(GL_TRIANGLES, draw.count, GL_UNSIGNED_INT, reinterpret_cast<const void*>(draw.byteOffset),
                                 draw.baseVertex);
    }
}

const char* const kSurfaceFragment = R"(
in vec3 positionWorld, normalWorld;
in vec2 uv;
in vec4 clipNow, clipBefore;
uniform vec3 reflectance;
uniform float alphaCutoff;
uniform sampler2D baseColour;

// By the finest level, so that holes and shadows have the studio's sizes.
void cutHoles() {
#ifdef MASKED
    if (textureLod(baseColour, uv, 0.0).a < alphaCutoff) discard;
#endif
}

struct Surface {
    vec3 albedo, normal, geometricNormal;
};

// Surfaces are double-sided: normals turn to the side that is looked at. `towards`: to the eye or the light.
Surface surfaceSeenFrom(vec3 towards) {
    vec3 face = cross(dFdx(positionWorld), dFdy(positionWorld));
    vec4 texel = texture(baseColour, uv);
    cutHoles();
    float size = length(face);
    vec3 geometric = size > 0.0 ? face / size : towards;
    if (dot(geometric, towards) < 0.0) geometric = -geometric;
    float smoothSize = length(normalWorld);
    vec3 normal = smoothSize > 1e-6 ? normalWorld / smoothSize : geometric;
    if (dot(normal, geometric) < 0.0) normal = -normal;
    return Surface(reflectance * texel.rgb, normal, geometric);
}

// LW_FORMAT_OCT16X2: the unit sphere folded about z into a square. As whole numbers, since OpenGL 3.3 doesn't promise
// that it can draw into snorm images; both -32768, the clear value, is no surface.
ivec2 octahedral(vec3 n) {
    vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    if (n.z < 0.0) p = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
    return ivec2(round(clamp(p, -1.0, 1.0) * 32767.0));
}
)";

}  // namespace viewer
