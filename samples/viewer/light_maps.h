// What a light sees, drawn by rasterisation: reflective shadow maps for Lightwell, shadow maps for direct light.
#pragma once

#include <cmath>
#include <vector>

#include "gbuffer.h"  // the studio's: what RSMs are fitted to
#include "gbuffer_pass.h"
#include "ray_scene.h"

namespace viewer {

struct RsmImages {
    Eye eye;
    Texture depth;   // R32F: distance along the axis, m (LW_FORMAT_FLOAT1, LW_DEPTH_AXIAL)
    Texture normal;  // RG16I: LW_FORMAT_OCT16X2, on the lit side
    Texture flux;    // RGBA32F: albedo * incident flux through the texel, W (LW_FORMAT_FLOAT4); half floats are too coarse for it
    Texture zBuffer;
    Framebuffer target;
};

struct LightMaps {
    studio::Light light;
    std::vector<RsmImages> rsms;
    std::vector<Eye> shadowEyes;  // of the shadow map's layers
    Texture shadows;              // depth, compared with when looked up
    std::vector<Framebuffer> shadowTargets;
};

class LightPasses {
public:
    LightPasses();
    // Places the light's maps, which keep their images when their number and sizes stay. `options`: of the RSMs; its view is what
    // a sun's are fitted to. A sun's shadow map holds all of the scene.
    void place(LightMaps& maps, const studio::RayScene& scene, const studio::RsmOptions& options, int shadowSize) const;
    void drawRsms(const LightMaps& maps, const SceneMeshes& meshes, const Poses& poses) const;
    void drawShadows(const LightMaps& maps, const SceneMeshes& meshes, const Poses& poses) const;

private:
    SurfacePrograms rsmPrograms_, shadowPrograms_;
};

// GLSL: `vec3 arrivalAt(vec3 position, out vec3 toLight)`: irradiance of a surface that faces the light, without shadows,
// and the uniforms that describe it.
extern const char* const kLightReader;
template <class Programs>  // a Program in use, or SurfacePrograms
void setLight(const Programs& programs, const studio::Light& light) {
    programs.set("kind", int(light.kind));  // in the order of LightKind
    programs.set("lightPosition", light.position);
    programs.set("lightDirection", light.direction);
    programs.set("emitted", light.emitted);
    programs.set("coneCosines", glm::vec2(std::cos(light.innerCone), std::cos(light.outerCone)));
}

// Direct diffuse radiance of all lights into the G-buffer's `direct`, one pass each.
class DirectPass {
public:
    DirectPass();
    void draw(const GBufferImages& images, const Eye& eye, const std::vector<LightMaps>& lights);

private:
    Program program_;
    Framebuffer target_;
    GLuint drawn_ = 0;  // the image that target_ belongs to
};

}  // namespace viewer
