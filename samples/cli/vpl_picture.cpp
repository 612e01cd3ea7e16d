#include "vpl_picture.h"

#include <algorithm>
#include <cmath>

#include "parallel.h"

namespace cli {
namespace {

constexpr float kRadius = 0.34f;      // of a disc, in radii of its VPL's surface
constexpr float kRim = 0.75f;         // where a disc's rim begins
constexpr float kLeastCosine = 0.6f;  // between a pixel's normal and its VPL's: discs do not turn corners
constexpr float kRing = 0.02f;        // half the width of a blocker's ring, of its radius
constexpr float kGrey = 0.55f;        // of white in the view: discs stand out

float luminance(const glm::vec3& c) {
    return glm::dot(c, glm::vec3(0.2126f, 0.7152f, 0.0722f));
}

glm::vec3 shadeOf(const studio::GBuffer& g, int x, int y) {
    const glm::vec3 towards = glm::normalize(g.camera.position - g.position.rgb(x, y));
    const float facing = std::abs(glm::dot(g.normal.rgb(x, y), towards));
    return glm::vec3(kGrey * (0.3f + 0.4f * luminance(g.albedo.rgb(x, y))) * (0.4f + 0.6f * facing));
}

glm::vec3 colourOf(const studio::GBuffer& g, int x, int y, const studio::StaticVpls& vpls) {
    const glm::vec3 position = g.position.rgb(x, y), normal = g.normal.rgb(x, y);
    if (normal == glm::vec3(0.0f)) return glm::vec3(0.0f);
    glm::vec3 colour = shadeOf(g, x, y);
    for (const studio::StaticBlocker& blocker : vpls.blockers)
        if (std::abs(glm::length(position - blocker.center) / blocker.radius - 1.0f) < kRing)
            colour = {0.8f, 0.05f, 0.05f};
    float nearest = 1.0f;  // in radii of the disc
    for (const studio::StaticVpl& vpl : vpls.vpls) {
        const float radius =
            kRadius * std::sqrt(vpl.weight.value() * vpls.areaPerWeight / studio::kPi);
        const float distance = glm::length(position - vpl.position) / radius;
        if (!(distance < nearest) || glm::dot(normal, vpl.normal) < kLeastCosine) continue;
        nearest = distance;
        colour = distance < kRim ? vpl.reflectance : glm::vec3(0.0f);
    }
    return colour;
}

}  // namespace

studio::Image drawVpls(const studio::GBuffer& gbuffer, const studio::StaticVpls& vpls) {
    studio::Image picture(gbuffer.width, gbuffer.height);
    std::vector<float>* planes[3] = {&picture.plane("R"), &picture.plane("G"), &picture.plane("B")};
    studio::parallelRows(gbuffer.height, [&](int y) {
        for (int x = 0; x < gbuffer.width; ++x) {
            const glm::vec3 colour = glm::clamp(colourOf(gbuffer, x, y, vpls), 0.0f, 1.0f);
            const auto at = std::size_t(y) * std::size_t(gbuffer.width) + std::size_t(x);
            for (int c = 0; c < 3; ++c) (*planes[c])[at] = colour[c];
        }
    });
    return picture;
}

}  // namespace cli
