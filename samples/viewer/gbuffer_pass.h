// The view's G-buffer, drawn by rasterisation, in the formats that Lightwell takes as they are.
#pragma once

#include "scene_meshes.h"

namespace viewer {

// What a pass draws through: world -> view, and view -> clip with z in [0,1], as studio::Camera makes them.
struct Eye {
    glm::mat4 view{1.0f}, projection{1.0f};
    bool operator==(const Eye& other) const { return view == other.view && projection == other.projection; }
};

struct GBufferImages {
    Texture depth;    // R32F: distance along the axis, m; 0: nothing (LW_FORMAT_FLOAT1, LW_DEPTH_AXIAL)
    Texture normal;   // RG16I: LW_FORMAT_OCT16X2
    Texture albedo;   // SRGB8_ALPHA8: LW_FORMAT_UNORM8X4_SRGB
    Texture motion;   // RG32F: LW_FORMAT_FLOAT2, pixels, +y down
    Texture direct;   // RGBA16F: L_d, W/(sr m^2): LW_FORMAT_HALF4
    Texture zBuffer;
    int width = 0, height = 0;
    GBufferImages() = default;
    GBufferImages(int width, int height);
};

class GBufferPass {
public:
    GBufferPass();
    void resize(int width, int height);
    // All but `direct`.
    void draw(const SceneMeshes& meshes, const Eye& now, const Eye& before, const Poses& posesNow, const Poses& posesBefore);
    const GBufferImages& images() const { return images_; }

private:
    SurfacePrograms programs_;
    GBufferImages images_;
    Framebuffer target_;
};

// GLSL: `vec3 normalOf(ivec2 oct)`; `vec3 positionOf(ivec2 pixel)` by uniforms `depthImage`, `worldFromView`, `viewScale`.
extern const char* const kNormalReader;
extern const char* const kGBufferReader;
void bindGBufferReader(const Program& program, const GBufferImages& images, const Eye& eye, int firstUnit);

}  // namespace viewer
