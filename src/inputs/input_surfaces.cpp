// Images are unpacked by the kernel that techniques use, so that whatever lwRender accepts is read here
// with the same result, and copied to the host whole. Normals alone are read as they are stored where
// the format can hold a length: the checker wants to see what unpacking would repair.
#include "inputs/input_surfaces.h"

#include <algorithm>
#include <cmath>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/image_access.h"
#include "shared/input_limits.h"

namespace lightwell {
namespace {

// Pixels examined of one image, about: enough for shares to a tenth of a per cent, few enough for a
// tenth of a second.
constexpr std::uint32_t kExaminedPixels = 1u << 16;

HostPlanes readImage(Executor& executor, const LWImage& image, ImageRole role, const std::string& name) {
    if (imageAbsent(image)) return {};
    if (image.format == LW_FORMAT_HALF4) role.decode = LW_ROLE_VALUE;
    Device& device = executor.device();
    const CheckedImage checked = checkImage(device, image, role, image.width, image.height, name);
    Buffer staging;
    const DeviceImage opened = openForReading(executor, checked, role, "input_check.upload", staging);
    const PlanarImage own(device, image.width, image.height, role.channels, "an image to be checked");
    unpack(executor, "input_check.unpack", opened, own.planes(image.width, image.height));
    HostPlanes planes(image.width, image.height, role.channels);
    try {
        executor.read("input_check.read", own.buffer().get(), 0, planes.bytes(), planes.values().data());
        device.finish();
    } catch (...) {
        clFinish(device.queue());  // nothing may be written to the planes after this
        throw;
    }
    return planes;
}

std::uint32_t stepFor(std::uint32_t width, std::uint32_t height) {
    const double pixels = double(width) * height;
    return std::max(1u, std::uint32_t(std::sqrt(pixels / kExaminedPixels)));
}

void makeCamera(const LWCamera& matrices, Surfaces& surfaces, std::optional<Camera>& camera,
                const char* field) {
    try {
        camera.emplace(matrices, surfaces.width, surfaces.height, surfaces.argument(field));
    } catch (const Error& error) {
        if (surfaces.cameraError.empty()) surfaces.cameraError = error.what();  // the first one's
    }
}

void placeByDepth(Surfaces& s) {
    s.position = HostPlanes(s.width, s.height, 3);
    const LwUnprojection unprojection = s.camera->unprojection(s.depthKind);
    for (std::uint32_t y = 0; y < s.height; ++y)
        for (std::uint32_t x = 0; x < s.width; ++x) {
            glm::dvec3 p;
            const bool there =
                unprojectDepth(unprojection, x + 0.5, y + 0.5, double(s.depth.at(x, y)), p);
            for (std::uint32_t c = 0; c < 3; ++c)
                s.position.at(x, y, c) = there ? float(p[int(c)]) : std::nanf("");
        }
}

}  // namespace

HostPlanes::HostPlanes(std::uint32_t width, std::uint32_t height, std::uint32_t channels)
    : height_(height),
      channels_(channels),
      stride_(paddedWidth(width)),
      values_(std::size_t(channels) * height * stride_) {}

bool finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool cameraAbsent(const LWCamera& camera) {
    const auto zero = [](float value) { return value == 0.0f; };
    return std::all_of(camera.view, camera.view + 16, zero) &&
           std::all_of(camera.projection, camera.projection + 16, zero);
}

bool withinReach(const glm::dvec3& p) {
    constexpr double kFarthest = LW_LARGEST_DISTANCE;
    return finite(p) && glm::dot(p, p) <= kFarthest * kFarthest;
}

double Surfaces::rounding(const glm::dvec3& p) const {
    constexpr double kHalf = 1.0 / 1024, kFloat = 1.0 / (1 << 21);  // of the largest coordinate
    return (halfPositions ? kHalf : kFloat) * std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

glm::dvec3 Surfaces::towardsEye(const glm::dvec3& p) const {
    if (!camera) return glm::dvec3(0.0);
    if (!camera->perspective()) {
        const double length = glm::length(lightDirection);
        return length > 0.0 ? -lightDirection / length : glm::dvec3(0.0);
    }
    const glm::dvec3 way = camera->eye() - p;
    const double length = glm::length(way);
    return length > 0.0 ? way / length : glm::dvec3(0.0);
}

bool unprojectDepth(const LwUnprojection& u, double i, double j, double depth, glm::dvec3& position) {
    const auto linear = [&](const lw_float4& c) {
        return double(c.s[0]) * i + double(c.s[1]) * j + double(c.s[3]);
    };
    if (!std::isfinite(depth) || (u.positiveOnly && depth <= 0.0)) return false;
    glm::dvec3 p(linear(u.x), linear(u.y), linear(u.z));
    if (u.mode == LW_UNPROJECT_HOMOGENEOUS) {
        const double w =
            linear(u.w) + linear(u.wRest) + (double(u.w.s[2]) + double(u.wRest.s[2])) * depth;
        if (!(w > 0.0)) return false;
        p = (p + glm::dvec3(u.x.s[2], u.y.s[2], u.z.s[2]) * depth) / w;
    } else {
        p *= u.mode == LW_UNPROJECT_RADIAL ? depth / glm::length(p) : depth;
    }
    position = p + glm::dvec3(u.origin.s[0], u.origin.s[1], u.origin.s[2]);
    return withinReach(position);
}

Surfaces readGBuffer(Executor& executor, const LWGBuffer& gbuffer, std::uint32_t width,
                     std::uint32_t height, const std::string& name) {
    Surfaces s;
    s.name = name;
    s.width = width;
    s.height = height;
    s.step = stepFor(width, height);
    s.depthKind = gbuffer.depthKind;
    s.halfPositions = gbuffer.position.format == LW_FORMAT_HALF4;
    s.position = readImage(executor, gbuffer.position, kPositionRole, s.argument("position"));
    s.depth = readImage(executor, gbuffer.depth, kDepthRole, s.argument("depth"));
    s.normal = readImage(executor, gbuffer.normal, kNormalRole, s.argument("normal"));
    s.albedo = readImage(executor, gbuffer.albedo, kAlbedoRole, s.argument("albedo"));
    s.direct = readImage(executor, gbuffer.directRadiance, kRadianceRole, s.argument("directRadiance"));
    s.motion = readImage(executor, gbuffer.motion, kMotionRole, s.argument("motion"));
    s.roughness = readImage(executor, gbuffer.roughness, kScalarRole, s.argument("roughness"));
    if (!cameraAbsent(gbuffer.camera)) {
        s.matrices = &gbuffer.camera;
        makeCamera(gbuffer.camera, s, s.camera, "camera");
    }
    if (!cameraAbsent(gbuffer.previousCamera)) {
        s.previousMatrices = &gbuffer.previousCamera;
        makeCamera(gbuffer.previousCamera, s, s.previous, "previousCamera");
    }
    if (s.depth) placeByDepth(s);
    return s;
}

Surfaces readRsm(Executor& executor, const LWLight& light, const LWRsm& rsm, const std::string& name) {
    Surfaces s;
    s.name = name;
    s.isRsm = true;
    s.width = rsm.flux.width;
    s.height = rsm.flux.height;
    s.step = stepFor(s.width, s.height);
    s.depthKind = rsm.depthKind;
    s.halfPositions = rsm.position.format == LW_FORMAT_HALF4;
    s.position = readImage(executor, rsm.position, kPositionRole, s.argument("position"));
    s.depth = readImage(executor, rsm.depth, kDepthRole, s.argument("depth"));
    s.normal = readImage(executor, rsm.normal, kNormalRole, s.argument("normal"));
    s.flux = readImage(executor, rsm.flux, kRadianceRole, s.argument("flux"));
    s.matrices = &rsm.camera;
    makeCamera(rsm.camera, s, s.camera, "camera");
    if (light.kind == LW_LIGHT_DIRECTIONAL)
        s.lightDirection = {double(light.direction[0]), double(light.direction[1]),
                            double(light.direction[2])};
    if (s.depth) placeByDepth(s);
    return s;
}

}  // namespace lightwell
