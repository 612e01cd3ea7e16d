#include "compose.h"

#include <algorithm>
#include <cmath>

namespace viewer {
namespace {

// Points of the picture that the exposure is measured at.
constexpr int kGridWidth = 96, kGridHeight = 54;

const char* const kRadiance = R"(
uniform isampler2D normalImage;
uniform sampler2D albedoImage, directImage, truth;
uniform sampler2DArray indirect;
uniform bool isTruth;
vec3 irradianceAt(ivec2 pixel) {
    if (isTruth) return texelFetch(truth, pixel, 0).rgb;
    return vec3(texelFetch(indirect, ivec3(pixel, 0), 0).r, texelFetch(indirect, ivec3(pixel, 1), 0).r,
                texelFetch(indirect, ivec3(pixel, 2), 0).r);
}
vec3 reflectedAt(ivec2 pixel, vec3 irradiance) {
    return texelFetch(albedoImage, pixel, 0).rgb * irradiance * (1.0 / 3.14159265);
}
)";

// Log of the luminance, and 1 where there is any: black pixels don't count.
const char* const kBrightnessFragment = R"(
uniform vec2 gridSize;
out vec2 sums;
void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy / gridSize * vec2(textureSize(directImage, 0)));
    vec3 radiance = texelFetch(directImage, pixel, 0).rgb + reflectedAt(pixel, irradianceAt(pixel));
    float luminance = dot(radiance, vec3(0.2126, 0.7152, 0.0722));
    sums = luminance > 0.0 ? vec2(log(luminance), 1.0) : vec2(0.0);
}
)";

const char* const kPictureFragment = R"(
uniform sampler2D depthImage, motionImage;
uniform sampler2DArray extra;
uniform int extraChannels, debugChannel, splitColumn;
uniform float exposure, debugScale, farthest;
uniform bool hasSplit;
out vec4 colour;

vec3 display(vec3 linear) {
    vec3 low = linear * 12.92, high = 1.055 * pow(max(linear, vec3(1e-8)), vec3(1.0 / 2.4)) - 0.055;
    return mix(high, low, lessThanEqual(linear, vec3(0.0031308)));
}
vec3 toneMapped(vec3 radiance) {
    vec3 exposed = max(radiance, vec3(0.0)) * exposure;
    return exposed / (1.0 + exposed);
}
vec3 debugAt(vec2 at) {
    ivec3 size = textureSize(extra, 0);
    ivec2 texel = ivec2(at * vec2(size.xy));
    float first = texelFetch(extra, ivec3(texel, debugChannel), 0).r * debugScale;
    if (extraChannels - debugChannel < 3) return vec3(first);
    return vec3(first, texelFetch(extra, ivec3(texel, debugChannel + 1), 0).r * debugScale,
                texelFetch(extra, ivec3(texel, debugChannel + 2), 0).r * debugScale);
}
vec3 shown(ivec2 pixel, vec2 at) {
    vec3 irradiance = irradianceAt(pixel);
#if SHOW == 1
    return toneMapped(texelFetch(directImage, pixel, 0).rgb);
#elif SHOW == 2
    return toneMapped(reflectedAt(pixel, irradiance));
#elif SHOW == 3
    return toneMapped(irradiance * (1.0 / 3.14159265));
#elif SHOW == 4
    return vec3(texelFetch(indirect, ivec3(pixel, 3), 0).r);
#elif SHOW == 5
    return texelFetch(albedoImage, pixel, 0).rgb;
#elif SHOW == 6
    ivec2 oct = texelFetch(normalImage, pixel, 0).xy;
    return oct.x == -32768 ? vec3(0.0) : normalOf(oct) * 0.5 + 0.5;
#elif SHOW == 7
    return vec3(texelFetch(depthImage, pixel, 0).r / farthest);
#elif SHOW == 8
    return vec3(abs(texelFetch(motionImage, pixel, 0).rg) * 0.1, 0.0);
#elif SHOW >= 9
    return debugAt(at);
#else
    return toneMapped(texelFetch(directImage, pixel, 0).rgb + reflectedAt(pixel, irradiance));
#endif
}
void main() {
    ivec2 size = textureSize(directImage, 0);
    ivec2 pixel = ivec2(int(gl_FragCoord.x), size.y - 1 - int(gl_FragCoord.y));  // images begin at the top
    vec2 at = (vec2(pixel) + 0.5) / vec2(size);
    colour = vec4(display(clamp(shown(pixel, at), 0.0, 1.0)), 1.0);
    if (hasSplit && abs(pixel.x - splitColumn) < 1) colour = vec4(1.0, 0.75, 0.2, 1.0);
}
)";

}  // namespace

const std::vector<std::string>& showNames() {
    static const std::vector<std::string> names = {"picture", "direct", "indirect", "irradiance", "validity", "albedo",
                                                   "normal",  "depth",  "motion",   "check",      "debug"};
    return names;
}

Compose::Compose()
    : brightness_("brightness", kWholeImageVertex, std::string("#version 330 core\n") + kRadiance + kBrightnessFragment),
      grid_({GL_RG32F, GL_RG, GL_FLOAT, 8}, kGridWidth, kGridHeight),
      gridTarget_({&grid_}, nullptr),
      nothing_({GL_RGB32F, GL_RGB, GL_FLOAT, 12}, 1, 1),
      nothingLayered_({GL_R32F, GL_RED, GL_FLOAT, 4}, 1, 1, 1) {}

// One program for each thing to show: choosing in the shader would cost all of them at every pixel on a CPU.
const Program& Compose::pictureOf(Show show) {
    const auto known = pictures_.find(show);
    if (known != pictures_.end()) return known->second;
    const std::string head = "#version 330 core\n#define SHOW " + std::to_string(int(show)) + "\n";
    return pictures_.emplace(show, Program("picture", kWholeImageVertex, head + kNormalReader + kRadiance + kPictureFragment)).first->second;
}

void Compose::setTruth(int width, int height, const std::vector<float>& rgb) {
    truth_ = Texture({GL_RGB32F, GL_RGB, GL_FLOAT, 12}, width, height);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGB, GL_FLOAT, rgb.data());
}

void Compose::setExtra(int width, int height, int channels, const std::vector<float>& planes) {
    if (width < 1 || height < 1 || channels < 1) {
        extra_ = Texture();
        return;
    }
    extra_ = Texture({GL_R32F, GL_RED, GL_FLOAT, 4}, width, height, channels);
    extraChannels_ = channels;
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, 0, width, height, channels, GL_RED, GL_FLOAT, planes.data());
}

void Compose::bind(const Program& program, const GBufferImages& images, const Texture& indirect) const {
    program.use();
    program.set("normalImage", 0, images.normal);
    program.set("albedoImage", 1, images.albedo);
    program.set("directImage", 2, images.direct);
    program.set("indirect", 3, indirect);
    program.set("truth", 4, hasTruth() ? truth_ : nothing_);
    program.set("isTruth", 0);
}

float Compose::measureExposure(const GBufferImages& images, const Texture& indirect) {
    gridTarget_.bind(kGridWidth, kGridHeight);
    bind(brightness_, images, indirect);
    brightness_.set("gridSize", glm::vec2(kGridWidth, kGridHeight));
    drawWholeImage();
    std::vector<glm::vec2> sums(std::size_t(kGridWidth) * kGridHeight);
    grid_.bind(0);
    glGetTexImage(GL_TEXTURE_2D, 0, GL_RG, GL_FLOAT, sums.data());
    glm::dvec2 sum(0.0);
    for (const glm::vec2& value : sums) sum += glm::dvec2(value);
    return sum.y > 0.0 ? float(0.18 / std::exp(sum.x / sum.y)) : 1.0f;
}

void Compose::draw(GLuint target, int width, int height, const GBufferImages& images, const Texture& indirect, const Look& look) {
    const Program& picture = pictureOf(look.show);
    glBindFramebuffer(GL_FRAMEBUFFER, target);
    glViewport(0, 0, width, height);
    bind(picture, images, indirect);
    picture.set("depthImage", 5, images.depth);
    picture.set("motionImage", 6, images.motion);
    picture.set("extra", 7, extra_.get() != 0 ? extra_ : nothingLayered_);
    picture.set("extraChannels", extra_.get() != 0 ? extraChannels_ : 1);
    picture.set("debugChannel", look.show == Show::Check ? 0 : std::min(look.debugChannel, std::max(0, extraChannels_ - 1)));
    picture.set("debugScale", look.show == Show::Check ? 1.0f : look.debugScale);
    picture.set("farthest", look.farthest);
    picture.set("exposure", look.exposure);
    const bool hasSplit = hasTruth() && look.split < 1.0f;
    const int column = hasSplit ? int(look.split * float(width)) : width;
    picture.set("hasSplit", hasSplit ? 1 : 0);
    picture.set("splitColumn", column);
    glEnable(GL_SCISSOR_TEST);
    glScissor(0, 0, column, height);
    drawWholeImage();
    if (hasSplit) {
        glScissor(column, 0, width - column, height);
        picture.set("isTruth", 1);
        drawWholeImage();
    }
    glDisable(GL_SCISSOR_TEST);
}

}  // namespace viewer
