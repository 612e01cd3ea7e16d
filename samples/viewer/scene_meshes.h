// A studio scene's triangles and textures in OpenGL's memory, and how they are drawn.
#pragma once

#include <vector>

#include "gl_objects.h"
#include "scene.h"

namespace viewer {

// Where the scene's objects are, by index.
using Poses = std::vector<glm::mat4>;
Poses posesAt(const studio::Scene& scene, float time);

// From world space to OpenGL's clip space, upside down: row 0 of what is drawn is the picture's top row, so that memory
// has the order that Lightwell, PNG and EXR expect and nothing is ever flipped. `projection`: clip z in [0,1], which
// becomes OpenGL's -1 .. 1, or 1 .. 0 within a DepthTest that is reversed.
glm::mat4 rasterMatrix(const glm::mat4& projection, const glm::mat4& view, bool isReversed = false);
// dot(axialRow(view), (x, y, z, 1)): a position's distance along the camera's axis.
glm::vec4 axialRow(const glm::mat4& view);

// What draws surfaces: one program for whole ones, and one that cuts holes, since whatever may discard a fragment can't
// be left out early by its depth.
class SurfacePrograms {
public:
    // `fragment`: what follows kSurfaceFragment.
    SurfacePrograms(const std::string& name, const std::string& fragment);
    // Sets uniforms of both.
    template <class Value>
    void set(const char* uniform, const Value& value) const {
        for (const Program* program : {&whole_, &masked_}) program->use(), program->set(uniform, value);
    }
    const Program& whole() const { return whole_; }
    const Program& masked() const { return masked_; }

private:
    Program whole_, masked_;
};

class SceneMeshes {
public:
    explicit SceneMeshes(const studio::Scene& scene);
    // Sets `pose` and, with `before`, `previousPose`; material: `reflectance`, `alphaCutoff` and texture `baseColour` in unit 0.
    void draw(const SurfacePrograms& programs, const Poses& now, const Poses* before = nullptr) const;
    std::size_t triangleCount() const { return triangleCount_; }

private:
    void draw(const Program& program, bool isMasked, const Poses& now, const Poses* before) const;
    struct Draw {
        GLsizei count;
        std::size_t byteOffset;
        GLint baseVertex;
        int object;
        glm::vec3 reflectance;
        float alphaCutoff;
        std::size_t texture;  // index in textures_; 0: white
    };
    std::vector<Draw> draws_;
    std::vector<Texture> textures_;
    VertexArray array_;
    Buffer vertices_, indices_;
    std::size_t triangleCount_ = 0;
};

// What fragment shaders of surfaces share: `cutHoles`, `surfaceSeenFrom`, octahedral normals.
extern const char* const kSurfaceFragment;

}  // namespace viewer
