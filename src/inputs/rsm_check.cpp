// What reflective shadow maps must satisfy, and where each lies among the texels.
#include "inputs/rsm_check.h"

#include <cmath>

#include "compute/device.h"
#include "compute/error.h"
#include "compute/raw_enum.h"

namespace lightwell {
namespace {

constexpr std::uint32_t kMaxSide = 16384;
// Indices of floats in the texels' planes are 32-bit in kernels.
constexpr std::uint64_t kMaxTexels = 0x7fffffff / LW_RSM_PLANES / 16 * 16;
// Sine of the angle by which the axes of one directional light may differ: rounding of float matrices,
// no more. Beyond it areas and the cascades' footprints no longer belong to one light.
constexpr double kMaxAxisSine = 1e-2;
constexpr std::uint32_t kPointFaces = 6;

CheckedRsm checkRsm(Device& device, const LWRsm& rsm, bool perspective, const std::string& name) {
    const bool fromDepth = !imageAbsent(rsm.depth);
    if (fromDepth == !imageAbsent(rsm.position))
        fail(LW_ERROR_INVALID_ARGUMENT, name, ": expected position or depth, got ",
             fromDepth ? "both" : "neither");
    const LWImage& first = fromDepth ? rsm.depth : rsm.position;
    const std::uint32_t width = first.width, height = first.height;
    if (width == 0 || height == 0 || width > kMaxSide || height > kMaxSide)
        fail(LW_ERROR_INVALID_ARGUMENT, name, fromDepth ? ".depth" : ".position", ": expected 1 .. ",
             kMaxSide, " pixels a side, got ", width, " x ", height);
    const auto kind = rawEnum(rsm.depthKind);
    if (fromDepth && kind > LW_DEPTH_RADIAL)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".depthKind: expected an LWDepthKind (0 .. 3), got ",
             kind);
    CheckedRsm checked{std::nullopt, std::nullopt,
                       checkImage(device, rsm.normal, kNormalRole, width, height, name + ".normal"),
                       checkImage(device, rsm.flux, kRadianceRole, width, height, name + ".flux"),
                       Camera(rsm.camera, width, height, name + ".camera")};
    if (checked.camera.perspective() != perspective)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".camera.projection: expected ",
             perspective ? "perspective for a point or spot light, got orthographic"
                         : "orthographic for a directional light, got perspective");
    if (fromDepth) {
        checked.depth = checkImage(device, rsm.depth, kDepthRole, width, height, name + ".depth");
        checked.unprojection = checked.camera.unprojection(rsm.depthKind);
    } else {
        checked.position =
            checkImage(device, rsm.position, kPositionRole, width, height, name + ".position");
    }
    checked.version = rsm.version;
    LwRsmSpan& span = checked.span;
    span.width = std::int32_t(width);
    span.height = std::int32_t(height);
    span.perspective = perspective ? 1 : 0;
    span.texelArea = float(checked.camera.pixelArea());
    const auto& rays = checked.camera.rays();
    span.rayX = float4(rays.perI.x, rays.perJ.x, 0.0, rays.constant.x);
    span.rayY = float4(rays.perI.y, rays.perJ.y, 0.0, rays.constant.y);
    span.rayZ = float4(rays.perI.z, rays.perJ.z, 0.0, rays.constant.z);
    const glm::dvec3 light = perspective ? checked.camera.eye() : checked.camera.axis();
    span.light = float4(light.x, light.y, light.z, 0.0);
    return checked;
}

}  // namespace

void checkRsmTexels(std::uint64_t padded, const char* name) {
    if (padded > kMaxTexels)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ": expected RSMs of at most ", kMaxTexels,
             " texels in all (rows count as multiples of 16), got more");
}

void checkLightKind(const LWLight& light, const std::string& name) {
    const auto kind = rawEnum(light.kind);
    if (kind > LW_LIGHT_SPOT)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".kind: expected an LWLightKind (0 .. 2), got ", kind);
    const std::uint32_t most = light.kind == LW_LIGHT_DIRECTIONAL ? LW_MAX_CASCADES
                               : light.kind == LW_LIGHT_POINT     ? kPointFaces
                                                                  : 1;
    if (light.rsmCount > most)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".rsmCount: expected at most ", most,
             " for this kind of light, got ", light.rsmCount);
}

namespace {

// The cascades of one directional light: parallel, finest first; each learns where the finer ones lie.
void nestCascades(const LWLight& light, std::vector<CheckedRsm>& rsms, std::size_t first,
                  const std::string& name) {
    glm::dvec3 direction(light.direction[0], light.direction[1], light.direction[2]);
    const double length = glm::length(direction);
    for (std::size_t k = first; k < rsms.size(); ++k) {
        const Camera& camera = rsms[k].camera;
        const std::string rsmName = name + ".rsms[" + std::to_string(k - first) + "]";
        if (length > 0.0 &&
            !(glm::length(glm::cross(direction / length, camera.axis())) <= kMaxAxisSine))
            fail(LW_ERROR_INVALID_ARGUMENT, rsmName, ".camera.view: expected a camera that looks along ",
                 name, ".direction, got one at an angle to it");
        for (std::size_t finer = first; finer < k; ++finer) {
            if (!(glm::length(glm::cross(rsms[finer].camera.axis(), camera.axis())) <= kMaxAxisSine))
                fail(LW_ERROR_INVALID_ARGUMENT, rsmName,
                     ".camera.view: expected the axis of the light's other cascades, got another");
            if (rsms[finer].span.texelArea > rsms[k].span.texelArea * 1.0001f)
                fail(LW_ERROR_INVALID_ARGUMENT, name,
                     ".rsms: expected the finest cascade first, got texels of ",
                     rsms[finer].span.texelArea, " before ", rsms[k].span.texelArea, " square units");
            ImageLinear<double> x, y;
            rsms[finer].camera.clipOf(camera, x, y);
            LwRsmSpan& span = rsms[k].span;
            span.finer[2 * span.finerCount] = float4(x.perI, x.perJ, 0.0, x.constant);
            span.finer[2 * span.finerCount + 1] = float4(y.perI, y.perJ, 0.0, y.constant);
            ++span.finerCount;
        }
    }
}

}  // namespace

std::vector<CheckedRsm> checkLights(Device& device, const LWFrame& frame, std::vector<RsmSpan>& spans) {
    std::vector<CheckedRsm> rsms;
    std::uint64_t texels = 0, rows = 0;
    for (std::uint32_t l = 0; l < frame.lightCount; ++l) {
        const LWLight& light = frame.lights[l];
        const std::string name = "frame.lights[" + std::to_string(l) + "]";
        checkLightKind(light, name);
        const std::size_t first = rsms.size();
        const bool perspective = light.kind != LW_LIGHT_DIRECTIONAL;
        for (std::uint32_t r = 0; r < light.rsmCount; ++r) {
            rsms.push_back(
                checkRsm(device, light.rsms[r], perspective, name + ".rsms[" + std::to_string(r) + "]"));
            LwRsmSpan& span = rsms.back().span;
            span.firstTexel = std::int32_t(texels);
            span.firstRow = std::int32_t(rows);
            span.index = std::int32_t(spans.size());
            spans.push_back({l, std::uint32_t(texels), std::uint32_t(rows), std::uint32_t(span.width),
                             std::uint32_t(span.height)});
            texels += std::uint64_t(paddedWidth(std::uint32_t(span.width))) * std::uint32_t(span.height);
            rows += std::uint32_t(span.height);
            checkRsmTexels(texels, "frame.lights");
        }
        if (!perspective) nestCascades(light, rsms, first, name);
    }
    return rsms;
}

}  // namespace lightwell
