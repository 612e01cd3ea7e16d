// Checks a G-buffer, then opens each image: in place, or unpacked into planes of ours. With depth
// instead of positions the normals are always copied too: a pixel whose depth is background must end up
// with a zero normal, and the host's own normals are not ours to change.
#include "inputs/gbuffer_input.h"

#include <array>
#include <optional>
#include <string>

#include "compute/device.h"
#include "compute/error.h"
#include "compute/raw_enum.h"
#include "inputs/camera.h"
#include "inputs/image_access.h"

namespace lightwell {
namespace {

enum Field {
    kPosition,
    kNormal,
    kAlbedo,
    kDirectRadiance,
    kRoughness,
    kMotion,
    kReceiveMask,
    kBakedMask,
    kFieldCount
};

struct FieldFacts {
    const char* name;
    const ImageRole* role;
    LWImage LWGBuffer::*image;
    Planes GBufferInput::*planes;
    std::uint32_t need;  // 0: always
    bool required;       // where needed
    const char* unpackPass;
};
constexpr FieldFacts kFields[kFieldCount] = {
    {"position", &kPositionRole, &LWGBuffer::position, &GBufferInput::position, 0, true,
     "gbuffer_input.unpack_position"},
    {"normal", &kNormalRole, &LWGBuffer::normal, &GBufferInput::normal, 0, true,
     "gbuffer_input.unpack_normal"},
    {"albedo", &kAlbedoRole, &LWGBuffer::albedo, &GBufferInput::albedo, kNeedsAlbedo, true,
     "gbuffer_input.unpack_albedo"},
    {"directRadiance", &kRadianceRole, &LWGBuffer::directRadiance, &GBufferInput::directRadiance,
     kNeedsDirectRadiance, true, "gbuffer_input.unpack_direct_radiance"},
    {"roughness", &kScalarRole, &LWGBuffer::roughness, &GBufferInput::roughness, kNeedsRoughness, true,
     "gbuffer_input.unpack_roughness"},
    {"motion", &kMotionRole, &LWGBuffer::motion, &GBufferInput::motion, kNeedsMotion, false,
     "gbuffer_input.unpack_motion"},
    {"receiveMask", &kMaskRole, &LWGBuffer::receiveMask, &GBufferInput::receiveMask, kNeedsReceiveMask,
     false, "gbuffer_input.unpack_receive_mask"},
    {"bakedMask", &kMaskRole, &LWGBuffer::bakedMask, &GBufferInput::bakedMask, kNeedsBakedMask, false,
     "gbuffer_input.unpack_baked_mask"},
};
constexpr char kUploadPass[] = "gbuffer_input.upload";

bool wanted(const FieldFacts& field, std::uint32_t needs) {
    return field.need == 0 || (needs & field.need);
}

// Everything that can be wrong with a G-buffer, before anything is enqueued.
struct CheckedGBuffer {
    std::array<std::optional<CheckedImage>, kFieldCount> images;
    std::optional<CheckedImage> depth;
    LwUnprojection unprojection{};
};

CheckedGBuffer checkGBuffer(Device& device, const View& view, const LWGBuffer& gbuffer,
                            std::uint32_t needs, const std::string& name) {
    CheckedGBuffer checked;
    const bool fromDepth = !imageAbsent(gbuffer.depth);
    if (fromDepth == !imageAbsent(gbuffer.position))
        fail(LW_ERROR_INVALID_ARGUMENT, name, ": expected position or depth, got ",
             fromDepth ? "both" : "neither");
    for (int f = 0; f < kFieldCount; ++f) {
        const FieldFacts& field = kFields[f];
        const LWImage& image = gbuffer.*field.image;
        if (!wanted(field, needs) || (f == kPosition && fromDepth)) continue;
        if (imageAbsent(image)) {
            if (!field.required) continue;
            fail(LW_ERROR_INVALID_ARGUMENT, name, ".", field.name,
                 ": expected an image, which this technique needs, got none");
        }
        checked.images[std::size_t(f)] =
            checkImage(device, image, *field.role, view.width, view.height, name + "." + field.name);
    }
    if (!fromDepth) return checked;
    checked.depth =
        checkImage(device, gbuffer.depth, kDepthRole, view.width, view.height, name + ".depth");
    const auto kind = rawEnum(gbuffer.depthKind);
    if (kind > LW_DEPTH_RADIAL)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".depthKind: expected an LWDepthKind (0 .. 3), got ",
             kind);
    const Camera camera(gbuffer.camera, view.width, view.height, name + ".camera");
    checked.unprojection = camera.unprojection(gbuffer.depthKind);
    return checked;
}

}  // namespace

struct GBufferInput::Impl {
    std::uint32_t maxWidth = 0, maxHeight = 0;
    std::array<PlanarImage, kFieldCount> own;
    std::array<DeviceImage, kFieldCount> opened;  // keeps memory used in place alive
    DeviceImage depth;
    std::array<Buffer, kFieldCount> staging;  // uploads; a depth's is the position's
    std::array<const char*, kFieldCount> choices{};

    // Our planes for a field, made on first use for the view's largest size.
    Planes ownPlanes(Device& device, const View& view, Field field) {
        if (maxWidth != view.maxWidth || maxHeight != view.maxHeight) {
            own = {};
            maxWidth = view.maxWidth;
            maxHeight = view.maxHeight;
        }
        PlanarImage& image = own[field];
        if (!image)
            image = PlanarImage(device, maxWidth, maxHeight, kFields[field].role->channels,
                                kFields[field].name);
        return image.planes(view.width, view.height);
    }
};

GBufferInput::GBufferInput() : impl_(std::make_unique<Impl>()) {}
GBufferInput::~GBufferInput() = default;
GBufferInput::GBufferInput(GBufferInput&&) noexcept = default;
GBufferInput& GBufferInput::operator=(GBufferInput&&) noexcept = default;

void GBufferInput::check(Device& device, const View& view, const LWGBuffer& gbuffer, std::uint32_t needs,
                         const char* name) {
    checkGBuffer(device, view, gbuffer, needs, name);
}

void GBufferInput::import(Executor& executor, const View& view, const LWGBuffer& gbuffer,
                          std::uint32_t needs, const char* name) {
    Device& device = executor.device();
    const CheckedGBuffer checked = checkGBuffer(device, view, gbuffer, needs, name);
    for (int f = 0; f < kFieldCount; ++f) {
        const FieldFacts& field = kFields[f];
        this->*field.planes = Planes{};
        impl_->choices[std::size_t(f)] = nullptr;
        const auto& image = checked.images[std::size_t(f)];
        if (!image) continue;
        DeviceImage& opened = impl_->opened[std::size_t(f)];
        reserveStaging(impl_->staging[std::size_t(f)], device, *image, view);
        opened = openForReading(executor, *image, *field.role, kUploadPass, impl_->staging[std::size_t(f)]);
        impl_->choices[std::size_t(f)] = opened.choice;
        if (checked.depth && f == kNormal) continue;  // below, with the positions
        if (!opened.planes) {
            opened.planes = impl_->ownPlanes(device, view, Field(f));
            unpack(executor, field.unpackPass, opened, opened.planes);
        }
        this->*field.planes = opened.planes;
    }
    if (!checked.depth) return;
    reserveStaging(impl_->staging[kPosition], device, *checked.depth, view);
    impl_->depth = openForReading(executor, *checked.depth, kDepthRole, kUploadPass, impl_->staging[kPosition]);
    position = impl_->ownPlanes(device, view, kPosition);
    normal = impl_->ownPlanes(device, view, kNormal);
    unproject(executor, "gbuffer_input.unproject", impl_->depth, impl_->opened[kNormal],
              checked.unprojection, position, normal);
    impl_->choices[kPosition] = "from depth";
    impl_->choices[kNormal] = "unpacked beside the depth, which may have no surface";
}

void GBufferInput::report(Report& report) const {
    for (std::size_t f = 0; f < kFieldCount; ++f)
        if (impl_->choices[f]) report.choose(kFields[f].name, impl_->choices[f]);
}

std::uint64_t GBufferInput::bytes() const {
    std::uint64_t total = 0;
    for (const PlanarImage& image : impl_->own) total += image.bytes();
    for (const Buffer& buffer : impl_->staging) total += buffer.bytes();
    return total;
}

std::uint64_t GBufferInput::estimateBytes(const LWViewDesc& view, std::uint32_t needs, bool uploads) {
    std::uint64_t planes = 0, packed = 0;
    for (const FieldFacts& field : kFields)
        if (wanted(field, needs)) {
            planes += field.role->channels;
            packed += largestPixelBytes(*field.role);
        }
    return planes * sizeof(float) * paddedWidth(view.maxWidth) * view.maxHeight +
           (uploads ? packed * view.maxWidth * view.maxHeight : 0);
}

}  // namespace lightwell
