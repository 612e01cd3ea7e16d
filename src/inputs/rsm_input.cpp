// Reflective shadow maps (Dachsbacher and Stamminger 2005) as texels that VPLs are drawn from. All maps
// are checked before anything is enqueued, so that a refused frame leaves the last one in force.
#include "inputs/rsm_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string>

#include "compute/device.h"
#include "compute/error.h"
#include "compute/raw_enum.h"
#include "inputs/camera.h"
#include "inputs/image_access.h"
#include "shared/rsm_types.h"

namespace lightwell {
namespace {

constexpr char kProgram[] = "rsm_input/rsm_input";
constexpr std::uint32_t kMaxSide = 16384;
// Indices of floats in the texels' planes are 32-bit in kernels.
constexpr std::uint64_t kMaxTexels = 0x7fffffff / LW_RSM_PLANES / 16 * 16;
// Sine of the angle by which the axes of one directional light may differ: rounding of float matrices,
// no more. Beyond it areas and the cascades' footprints no longer belong to one light.
constexpr double kMaxAxisSine = 1e-2;
constexpr std::uint32_t kPointFaces = 6;

static_assert(RsmInput::kPositionX == LW_RSM_POSITION && RsmInput::kNormalX == LW_RSM_NORMAL &&
                  RsmInput::kFluxR == LW_RSM_FLUX && RsmInput::kArea == LW_RSM_AREA &&
                  RsmInput::kPlaneCount == LW_RSM_PLANES,
              "kernels/shared/rsm_types.h differs from RsmInput::Plane");

struct CheckedRsm {
    std::optional<CheckedImage> position, depth;
    CheckedImage normal, flux;
    Camera camera;
    LwUnprojection unprojection{};
    LwRsmSpan span{};
};

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

void checkTexels(std::uint64_t padded, const char* name) {
    if (padded > kMaxTexels)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ": expected RSMs of at most ", kMaxTexels,
             " texels in all (rows count as multiples of 16), got more");
}

}  // namespace

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
            checkTexels(texels, "frame.lights");
        }
        if (!perspective) nestCascades(light, rsms, first, name);
    }
    return rsms;
}

}  // namespace

struct RsmInput::Impl {
    Device* device = nullptr;  // of the last import
    Buffer texelMemory, counters;
    std::array<Buffer, 3> staging;  // uploads of position or depth, normal, flux: one map after the other
    std::vector<DeviceImage> opened;
    std::set<std::pair<const char*, const char*>> choices;  // of all maps, each once; literals

    // The host's maps into the texels.
    void unpackRsm(Executor& executor, const CheckedRsm& rsm, const Planes& all) {
        const auto open = [&](const CheckedImage& image, const ImageRole& role, std::size_t slot,
                              const char* what) -> DeviceImage& {
            opened.push_back(openForReading(executor, image, role, "rsm_input.upload", staging[slot]));
            choices.emplace(
                what, opened.back().planes ? "planar, copied among the texels" : opened.back().choice);
            return opened.back();
        };
        opened.reserve(opened.size() + 3);  // references stay valid
        const DeviceImage& place =
            rsm.depth ? open(*rsm.depth, kDepthRole, 0, "rsm_depth") : open(*rsm.position, kPositionRole, 0, "rsm_position");
        const DeviceImage& normal = open(rsm.normal, kNormalRole, 1, "rsm_normal");
        const DeviceImage& flux = open(rsm.flux, kRadianceRole, 2, "rsm_flux");
        Kernel& kernel = device->programs().kernel(kProgram, "rsm_input_unpack");
        executor.run("rsm_input.unpack", kernel, rowGrid(*device, std::uint32_t(rsm.span.width), std::uint32_t(rsm.span.height)),
                     rowGroup(*device), place.memory, place.pixels, cl_int(rsm.depth ? 1 : 0), rsm.unprojection, normal.memory,
                     normal.pixels, flux.memory, flux.pixels, all.memory, cl_int(all.planeStride), counters, rsm.span);
    }
};

RsmInput::RsmInput() : impl_(std::make_unique<Impl>()) {}
RsmInput::~RsmInput() = default;

void RsmInput::check(Device& device, const LWFrame& frame) {
    std::vector<RsmSpan> unused;
    checkLights(device, frame, unused);
}

void RsmInput::import(Executor& executor, const LWFrame& frame) {
    Device& device = executor.device();
    std::vector<RsmSpan> newSpans;
    const std::vector<CheckedRsm> rsms = checkLights(device, frame, newSpans);
    impl_->device = &device;
    std::uint64_t total = 0;
    std::uint32_t newRows = 0, newTexels = 0;
    for (const RsmSpan& span : newSpans) {
        total += std::uint64_t(paddedWidth(span.width)) * span.height;
        newRows += span.height;
        newTexels += span.width * span.height;
    }
    if (total > 0) {
        impl_->texelMemory.reserve(device, std::size_t(total) * kPlaneCount * sizeof(float),
                                   "RSM texels");
        rows.reserve(device, std::size_t(newRows) * 4 * sizeof(std::int32_t), "RSM rows");
        impl_->counters.reserve(device, LW_RSM_COUNTERS * sizeof(std::uint32_t), "RSM counters");
        // For the largest map at once, so that no map of the frame replaces what an earlier one still needs.
        std::array<std::size_t, 3> bytes{};
        for (const CheckedRsm& rsm : rsms) {
            const CheckedImage* images[3] = {rsm.depth ? &*rsm.depth : &*rsm.position, &rsm.normal, &rsm.flux};
            for (std::size_t i = 0; i < 3; ++i) bytes[i] = std::max(bytes[i], stagingBytes(device, *images[i]));
        }
        for (std::size_t i = 0; i < 3; ++i)
            if (bytes[i]) impl_->staging[i].reserve(device, bytes[i], "an RSM's copy on the device");
    }
    impl_->opened.clear();
    impl_->choices.clear();
    spans = std::move(newSpans);
    shapes.clear();
    for (const CheckedRsm& rsm : rsms) shapes.push_back(rsm.span);
    rowCount = newRows;
    texelCount = newTexels;
    texels = Planes{};
    if (total == 0) return;
    texels.memory = impl_->texelMemory.get();
    texels.rowStride = texels.planeStride = std::int64_t(total);
    texels.width = std::uint32_t(total);
    texels.height = 1;
    texels.count = kPlaneCount;

    Kernel& rowsKernel = device.programs().kernel(kProgram, "rsm_input_rows");
    for (const CheckedRsm& rsm : rsms) {
        executor.run("rsm_input.rows", rowsKernel, {std::uint32_t(rsm.span.height), 1}, rowGroup(device), rows, impl_->counters,
                     rsm.span);
        impl_->unpackRsm(executor, rsm, texels);
    }
}

void RsmInput::report(Report& report) const {
    report.counts.push_back({"rsm_texels", texelCount});
    report.counts.push_back({"rejected_texels", 0});
    report.counts.push_back({"covered_texels", 0});
    if (!spans.empty()) {
        report.read(*impl_->device, "rejected_texels", impl_->counters, LW_RSM_REJECTED * sizeof(cl_uint));
        report.read(*impl_->device, "covered_texels", impl_->counters, LW_RSM_COVERED * sizeof(cl_uint));
    }
    for (const auto& choice : impl_->choices) report.choose(choice.first, choice.second);
}

std::uint64_t RsmInput::bytes() const {
    std::uint64_t total = impl_->texelMemory.bytes() + impl_->counters.bytes() + rows.bytes();
    for (const Buffer& buffer : impl_->staging) total += buffer.bytes();
    return total;
}

std::uint64_t RsmInput::estimateBytes(const FrameShape& shape) {
    checkTexels(shape.paddedTexels, "rsmTexels, frame.lights");
    if (shape.texels == 0) return 0;
    const std::uint64_t packed =
        largestPixelBytes(kPositionRole) + largestPixelBytes(kNormalRole) + largestPixelBytes(kRadianceRole);
    return shape.paddedTexels * kPlaneCount * sizeof(float) + shape.rows * 4 * sizeof(std::int32_t) +
           LW_RSM_COUNTERS * sizeof(std::uint32_t) + (shape.uploads ? packed * shape.largestMap : 0);
}

}  // namespace lightwell
