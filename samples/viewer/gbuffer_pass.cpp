#include "gbuffer_pass.h"

namespace viewer {
namespace {

// A surface that was behind the previous camera was nowhere in its image.
const char* const kGBufferFragment = R"(
uniform vec3 eyePosition;
uniform vec4 axial;
uniform vec2 imageSize;
layout(location = 0) out float depthOut;
layout(location = 1) out ivec2 normalOut;
layout(location = 2) out vec4 albedoOut;
layout(location = 3) out vec2 motionOut;
void main() {
    Surface surface = surfaceSeenFrom(eyePosition - positionWorld);
    depthOut = dot(axial, vec4(positionWorld, 1.0));
    normalOut = octahedral(surface.normal);
    albedoOut = vec4(surface.albedo, 1.0);
    vec2 way = clipBefore.xy / clipBefore.w - clipNow.xy / clipNow.w;  // +y is down already: upside down
    motionOut = clipBefore.w > 0.0 ? 0.5 * imageSize * way : vec2(-65536.0);
}
)";

}  // namespace

const char* const kGBufferReader = R"(
uniform sampler2D depthImage;
uniform mat4 worldFromView;
uniform vec2 viewScale;  // of a pixel's position in -1 .. 1: the view's x and y at depth 1
vec3 positionOf(ivec2 pixel) {
    vec2 at = (vec2(pixel) + 0.5) / vec2(textureSize(depthImage, 0)) * 2.0 - 1.0;
    float depth = texelFetch(depthImage, pixel, 0).r;
    return (worldFromView * vec4(vec2(at.x, -at.y) * viewScale * depth, -depth, 1.0)).xyz;
}
)";

const char* const kNormalReader = R"(
vec3 normalOf(ivec2 oct) {
    if (oct == ivec2(-32768)) return vec3(0.0);
    vec2 p = vec2(oct) / 32767.0;
    vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
    if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
    return normalize(n);
}
)";

void bindGBufferReader(const Program& program, const GBufferImages& images, const Eye& eye, int firstUnit) {
    program.set("depthImage", firstUnit, images.depth);
    program.set("normalImage", firstUnit + 1, images.normal);
    program.set("albedoImage", firstUnit + 2, images.albedo);
    program.set("worldFromView", glm::mat4(glm::inverse(glm::dmat4(eye.view))));
    program.set("viewScale", glm::vec2(1.0f / eye.projection[0][0], 1.0f / eye.projection[1][1]));
}

GBufferImages::GBufferImages(int w, int h)
    : depth({GL_R32F, GL_RED, GL_FLOAT, 4}, w, h),
      normal({GL_RG16I, GL_RG_INTEGER, GL_SHORT, 4}, w, h),
      albedo({GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE, 4}, w, h),
      motion({GL_RG32F, GL_RG, GL_FLOAT, 8}, w, h),
      direct({GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, 8}, w, h),
      zBuffer({GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, 4}, w, h),
      width(w),
      height(h) {}

GBufferPass::GBufferPass() : programs_("gbuffer", kGBufferFragment) {}

void GBufferPass::resize(int width, int height) {
    images_ = GBufferImages(width, height);
    target_ = Framebuffer({&images_.depth, &images_.normal, &images_.albedo, &images_.motion}, &images_.zBuffer);
}

void GBufferPass::draw(const SceneMeshes& meshes, const Eye& now, const Eye& before, const Poses& posesNow, const Poses& posesBefore) {
    target_.bind(images_.width, images_.height);
    const DepthTest test;
    glEnable(GL_FRAMEBUFFER_SRGB);  // albedo alone is an sRGB image
    const float zero[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    const GLint noSurface[4] = {-32768, -32768, -32768, -32768};
    for (const GLint colour : {0, 2, 3}) glClearBufferfv(GL_COLOR, colour, zero);
    glClearBufferiv(GL_COLOR, 1, noSurface);
    programs_.set("clipFromWorld", rasterMatrix(now.projection, now.view, DepthTest::isReversed()));
    programs_.set("previousClipFromWorld", rasterMatrix(before.projection, before.view));
    programs_.set("eyePosition", glm::vec3(glm::inverse(now.view)[3]));
    programs_.set("axial", axialRow(now.view));
    programs_.set("imageSize", glm::vec2(images_.width, images_.height));
    meshes.draw(programs_, posesNow, &posesBefore);
    glDisable(GL_FRAMEBUFFER_SRGB);
}

}  // namespace viewer
