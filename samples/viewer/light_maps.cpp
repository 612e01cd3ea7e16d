#include "light_maps.h"

#include "rsm_cameras.h"

namespace viewer {
namespace {

// In multiples of what one step of the depth image is, and of the surface's slope: less shows acne, more detaches shadows.
constexpr float kSlopeOffset = 1.5f, kDepthOffset = 4.0f;

const char* const kRsmFragment = R"(
uniform vec4 axial;
uniform float texelMeasure;  // m^2 across a sun's rays, sr on a frustum's axis
uniform vec3 axis;           // of the map's camera
layout(location = 0) out float depthOut;
layout(location = 1) out ivec2 normalOut;
layout(location = 2) out vec4 fluxOut;
void main() {
    vec3 toLight;
    vec3 incident = arrivalAt(positionWorld, toLight);
    Surface surface = surfaceSeenFrom(toLight);
    // An interpolated normal can lean away from a light that its face sees.
    vec3 normal = dot(surface.normal, toLight) > 0.0 ? surface.normal : surface.geometricNormal;
    float measure = texelMeasure;
    if (kind != 0) {
        vec3 way = lightPosition - positionWorld;
        float cosine = -dot(axis, toLight);
        measure *= cosine * cosine * cosine * dot(way, way);  // arrivalAt has divided by the square
    }
    depthOut = dot(axial, vec4(positionWorld, 1.0));
    normalOut = octahedral(normal);
    fluxOut = vec4(surface.albedo * incident * measure, 1.0);
}
)";

const char* const kShadowFragment = R"(
void main() {
    cutHoles();
}
)";

// The shadow map's texel as seen from the light; what is looked up is moved along its normal by about that much.
const char* const kDirectFragment = R"(
uniform isampler2D normalImage;
uniform sampler2D albedoImage;
uniform sampler2DArrayShadow shadows;
uniform mat4 shadowFromWorld[6];
uniform int faces;
uniform float texelSize;  // m for a sun, else at a distance of 1 m
out vec4 radianceOut;

float litShare(vec3 position) {
    vec2 step = 1.0 / vec2(textureSize(shadows, 0).xy);
    for (int face = 0; face < faces; ++face) {
        vec4 clip = shadowFromWorld[face] * vec4(position, 1.0);
        if (clip.w <= 0.0 || any(greaterThan(abs(clip.xy), vec2(clip.w)))) continue;
        vec3 at = clip.xyz / clip.w * 0.5 + 0.5;
        // Four look-ups of four texels each: a soft edge of three texels.
        return 0.25 * (texture(shadows, vec4(at.xy - 0.5 * step, float(face), at.z)) +
                       texture(shadows, vec4(at.xy + 0.5 * step, float(face), at.z)) +
                       texture(shadows, vec4(at.xy + vec2(0.5, -0.5) * step, float(face), at.z)) +
                       texture(shadows, vec4(at.xy + vec2(-0.5, 0.5) * step, float(face), at.z)));
    }
    return 1.0;  // outside of a spot's maps its light is zero
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 normal = normalOf(texelFetch(normalImage, pixel, 0).xy);
    if (normal == vec3(0.0)) discard;
    vec3 position = positionOf(pixel), toLight;
    vec3 arriving = arrivalAt(position, toLight);
    float cosine = dot(normal, toLight);
    if (cosine <= 0.0 || arriving == vec3(0.0)) discard;
    float size = kind == 0 ? texelSize : texelSize * length(lightPosition - position);
    float sine = sqrt(max(0.0, 1.0 - cosine * cosine));
    float lit = litShare(position + normal * size * (0.5 + 2.0 * sine));
    radianceOut = vec4(texelFetch(albedoImage, pixel, 0).rgb * (1.0 / 3.14159265) * arriving * (cosine * lit), 0.0);
}
)";

// GL_COMPARE_REF_TO_TEXTURE with linear filtering: the share of the four nearest texels that is farther.
Texture makeShadowTexture(int size, int layers) {
    Texture texture({GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, 4}, size, size, layers);
    glBindTexture(GL_TEXTURE_2D_ARRAY, texture.get());
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    return texture;
}

RsmImages makeRsmImages(int size) {
    RsmImages rsm;
    rsm.depth = Texture({GL_R32F, GL_RED, GL_FLOAT, 4}, size, size);
    rsm.normal = Texture({GL_RG16I, GL_RG_INTEGER, GL_SHORT, 4}, size, size);
    rsm.flux = Texture({GL_RGBA32F, GL_RGBA, GL_FLOAT, 16}, size, size);
    rsm.zBuffer = Texture({GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, 4}, size, size);
    rsm.target = Framebuffer({&rsm.depth, &rsm.normal, &rsm.flux}, &rsm.zBuffer);
    return rsm;
}

void clearDepth() {
    const float farthest = 1.0f;
    glClearBufferfv(GL_DEPTH, 0, &farthest);
}

}  // namespace

const char* const kLightReader = R"(
uniform int kind;  // 0 sun, 1 spot, 2 point
uniform vec3 lightPosition, lightDirection, emitted;
uniform vec2 coneCosines;  // of the inner and the outer angle
vec3 arrivalAt(vec3 position, out vec3 toLight) {
    toLight = -lightDirection;
    if (kind == 0) return emitted;
    vec3 way = lightPosition - position;
    float squared = dot(way, way);
    if (squared <= 0.0) return vec3(0.0);
    toLight = way * inversesqrt(squared);
    float falloff = 1.0;
    if (kind == 1) {  // KHR_lights_punctual
        float cosine = dot(lightDirection, -toLight);
        float ramp = (cosine - coneCosines.y) / max(coneCosines.x - coneCosines.y, 1e-9);
        falloff = cosine >= coneCosines.x ? 1.0 : cosine <= coneCosines.y ? 0.0 : ramp * ramp;
    }
    return emitted * (falloff / squared);
}
)";

LightPasses::LightPasses()
    : rsmPrograms_("rsm", std::string(kLightReader) + kRsmFragment), shadowPrograms_("shadow", kShadowFragment) {}

void LightPasses::place(LightMaps& maps, const studio::RayScene& scene, const studio::RsmOptions& options, int shadowSize) const {
    const std::vector<studio::RsmCamera> cameras = studio::rsmCameras(scene, maps.light, options);
    studio::RsmOptions all;  // of a sun: everything, not only what lights the view
    const std::vector<studio::RsmCamera> shadowCameras =
        maps.light.kind == studio::LightKind::Sun ? studio::rsmCameras(scene, maps.light, all) : cameras;
    while (maps.rsms.size() > cameras.size()) maps.rsms.pop_back();
    while (maps.rsms.size() < cameras.size()) maps.rsms.push_back(makeRsmImages(options.size));
    for (std::size_t i = 0; i < cameras.size(); ++i) maps.rsms[i].eye = {cameras[i].view, cameras[i].projection};
    maps.shadowEyes.clear();
    for (const studio::RsmCamera& camera : shadowCameras) maps.shadowEyes.push_back({camera.view, camera.projection});
    if (maps.shadows.layers() == int(shadowCameras.size()) && maps.shadows.width() == shadowSize) return;
    maps.shadows = makeShadowTexture(shadowSize, int(shadowCameras.size()));
    maps.shadowTargets.clear();
    for (int layer = 0; layer < maps.shadows.layers(); ++layer) maps.shadowTargets.push_back(Framebuffer({}, &maps.shadows, layer));
}

void LightPasses::drawRsms(const LightMaps& maps, const SceneMeshes& meshes, const Poses& poses) const {
    setLight(rsmPrograms_, maps.light);
    for (const RsmImages& rsm : maps.rsms) {
        rsm.target.bind(rsm.flux.width(), rsm.flux.height());
        const float zero[4] = {0.0f, 0.0f, 0.0f, 0.0f};
        const GLint noSurface[4] = {-32768, -32768, -32768, -32768};
        glClearBufferfv(GL_COLOR, 0, zero);
        glClearBufferiv(GL_COLOR, 1, noSurface);
        glClearBufferfv(GL_COLOR, 2, zero);
        const DepthTest test;
        rsmPrograms_.set("clipFromWorld", rasterMatrix(rsm.eye.projection, rsm.eye.view, DepthTest::isReversed()));
        rsmPrograms_.set("axial", axialRow(rsm.eye.view));
        rsmPrograms_.set("axis", glm::vec3(axialRow(rsm.eye.view)));
        rsmPrograms_.set("texelMeasure", float(studio::rsmTexelMeasure(rsm.eye.projection, rsm.flux.width())));
        meshes.draw(rsmPrograms_, poses);
    }
}

void LightPasses::drawShadows(const LightMaps& maps, const SceneMeshes& meshes, const Poses& poses) const {
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(kSlopeOffset, kDepthOffset);
    for (std::size_t i = 0; i < maps.shadowEyes.size(); ++i) {
        maps.shadowTargets[i].bind(maps.shadows.width(), maps.shadows.height());
        clearDepth();
        shadowPrograms_.set("clipFromWorld", rasterMatrix(maps.shadowEyes[i].projection, maps.shadowEyes[i].view));
        meshes.draw(shadowPrograms_, poses);
    }
    glDisable(GL_POLYGON_OFFSET_FILL);
    glDisable(GL_DEPTH_TEST);
}

DirectPass::DirectPass() : program_("direct", kWholeImageVertex, std::string("#version 330 core\n") + kNormalReader + kGBufferReader + kLightReader + kDirectFragment) {}

void DirectPass::draw(const GBufferImages& images, const Eye& eye, const std::vector<LightMaps>& lights) {
    if (drawn_ != images.direct.get()) {
        target_ = Framebuffer({&images.direct}, nullptr);
        drawn_ = images.direct.get();
    }
    target_.bind(images.width, images.height);
    const float zero[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    glClearBufferfv(GL_COLOR, 0, zero);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    program_.use();
    bindGBufferReader(program_, images, eye, 0);
    for (const LightMaps& maps : lights) {
        setLight(program_, maps.light);
        program_.set("faces", int(maps.shadowEyes.size()));
        for (std::size_t i = 0; i < maps.shadowEyes.size(); ++i)
            program_.set(("shadowFromWorld[" + std::to_string(i) + "]").c_str(),
                         rasterMatrix(maps.shadowEyes[i].projection, maps.shadowEyes[i].view));
        program_.set("shadows", 3, maps.shadows);
        // An ortho map's texel in metres, a frustum's at 1 m.
        program_.set("texelSize", 2.0f / (maps.shadowEyes[0].projection[0][0] * float(maps.shadows.width())));
        drawWholeImage();
    }
    glDisable(GL_BLEND);
}

}  // namespace viewer
