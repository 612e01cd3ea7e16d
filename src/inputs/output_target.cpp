#include "inputs/output_target.h"

#include <string>
#include <utility>
#include <vector>

#include "compute/device.h"
#include "compute/error.h"
#include "compute/raw_enum.h"
#include "inputs/image_access.h"

namespace lightwell {
namespace {

constexpr char kReadPass[] = "output.read";

// Pixels packed on the device, copied to the host: bytes between pixels' rows stay the host's. (Gaps
// between the pixels of a row come back as they were uploaded, see OutputTarget::begin.)
void readRows(Executor& executor, const Buffer& from, const CheckedImage& checked) {
    const LwPixels& pixels = checked.pixels;
    char* host = static_cast<char*>(const_cast<void*>(checked.image.host));
    const std::int64_t planes = checked.planes;
    const std::int64_t rowBytes = (pixels.width - 1) * pixels.bytePixelStride + checked.pixelBytes;
    const std::int64_t first = std::int64_t(checked.firstByte);
    const bool gapless = pixels.byteRowStride == rowBytes &&
                         (planes == 1 || pixels.bytePlaneStride == rowBytes * pixels.height);
    if (gapless) {
        executor.read(kReadPass, from.get(), 0, std::size_t(rowBytes * pixels.height * planes),
                      host + first);
        return;
    }
    for (std::int64_t plane = 0; plane < planes; ++plane)
        for (std::int64_t y = 0; y < pixels.height; ++y) {
            const std::int64_t at =
                pixels.byteOffset + y * pixels.byteRowStride + plane * pixels.bytePlaneStride;
            executor.read(kReadPass, from.get(), std::size_t(at - first), std::size_t(rowBytes),
                          host + at);
        }
}

const ImageRole& roleOf(std::uint32_t planeCount) {
    return planeCount == 1 ? kOutputScalarRole : kOutputColourRole;
}

}  // namespace

struct OutputTarget::Impl {
    enum class Mode { kNone, kInPlace, kPack };
    Mode mode = Mode::kNone;
    PlanarImage own;
    Buffer staging;  // the packed image on a device without shared memory; kept, grown on need
    std::uint32_t ownWidth = 0, ownHeight = 0, ownCount = 0;
    Planes planes;
    Buffer target;            // the host's memory, or our copy of it
    bool hostMemory = false;  // the result must reach the host's own address space
    bool staged = false;      // through a copy on the device
    CheckedImage checked{};
    const char* name = "";
    const char* choice = "";
};

OutputTarget::OutputTarget() : impl_(std::make_unique<Impl>()) {}
OutputTarget::~OutputTarget() = default;
OutputTarget::OutputTarget(OutputTarget&&) noexcept = default;
OutputTarget& OutputTarget::operator=(OutputTarget&&) noexcept = default;

void OutputTarget::check(Device& device, const View& view, const LWImage& image, std::uint32_t planeCount,
                         const char* name) {
    if (!imageAbsent(image)) checkImage(device, image, roleOf(planeCount), view.width, view.height, name);
}

Planes OutputTarget::begin(Executor& executor, const View& view, const LWImage& image,
                           std::uint32_t planeCount, const char* name) {
    Impl& impl = *impl_;
    impl.mode = Impl::Mode::kNone;
    impl.name = name;
    if (imageAbsent(image)) return {};
    Device& device = executor.device();
    const CheckedImage checked = checkImage(device, image, roleOf(planeCount), view.width, view.height, name);

    Buffer target;
    // Kernels write whole rows of 16: the padding must be the image's own, not a neighbour's pixels.
    const std::int64_t ownRow = std::int64_t(paddedWidth(view.width)) * 4;
    bool planes = checked.planesLayout &&
                  (view.width % 16 == 0 || std::abs(checked.pixels.byteRowStride) == ownRow);
    const bool staged = image.host && !device.unifiedMemory();
    if (image.clMem) {
        target = Buffer::retained(device, static_cast<cl_mem>(image.clMem));
        planes = planes && checked.paddedEndByte <= target.bytes();
    } else {
        planes = planes && !staged;
        char* start = static_cast<char*>(const_cast<void*>(image.host)) + checked.firstByte;
        const std::size_t bytes =
            std::size_t((planes ? checked.paddedEndByte : checked.endByte) - checked.firstByte);
        if (staged) reserveStaging(impl.staging, device, checked, view);
        target = staged ? Buffer::retained(device, impl.staging.get()) : Buffer::overHost(device, start, bytes, true);
        const bool pixelGaps = checked.pixels.bytePixelStride != checked.pixelBytes;
        if (staged && pixelGaps) executor.write("output.upload", target, 0, bytes, start);
    }
    LwPixels pixels = checked.pixels;
    if (image.host) pixels.byteOffset -= std::int64_t(checked.firstByte);

    Planes result;
    if (planes) {
        result.memory = target.get();
        result.offset = pixels.byteOffset / 4;
        result.rowStride = pixels.byteRowStride / 4;
        result.planeStride = pixels.bytePlaneStride / 4;
        result.width = view.width;
        result.height = view.height;
        result.count = planeCount;
    } else {
        if (!impl.own || impl.ownWidth != view.maxWidth || impl.ownHeight != view.maxHeight ||
            impl.ownCount != planeCount) {
            impl.own = PlanarImage(device, view.maxWidth, view.maxHeight, planeCount, name);
            impl.ownWidth = view.maxWidth;
            impl.ownHeight = view.maxHeight;
            impl.ownCount = planeCount;
        }
        result = impl.own.planes(view.width, view.height);
    }
    impl.planes = result;
    impl.target = std::move(target);
    impl.hostMemory = image.host != nullptr;
    impl.staged = staged;
    impl.checked = checked;
    impl.choice = planes   ? "planar, written in place"
                  : staged ? "packed on the device, then copied"
                           : "packed into the host's format";
    impl.mode = planes ? Impl::Mode::kInPlace : Impl::Mode::kPack;
    return result;
}

void OutputTarget::end(Executor& executor) {
    Impl& impl = *impl_;
    if (impl.mode == Impl::Mode::kNone) return;
    if (impl.mode == Impl::Mode::kPack) {
        Device& device = executor.device();
        LwPixels pixels = impl.checked.pixels;
        if (impl.hostMemory) pixels.byteOffset -= std::int64_t(impl.checked.firstByte);
        Kernel& kernel = device.programs().kernel("output/output", "output_pack");
        executor.run("output.pack", kernel, rowGrid(device, impl.planes.width, impl.planes.height),
                     rowGroup(device), impl.planes, impl.target, pixels);
    }
    if (impl.staged)
        readRows(executor, impl.target, impl.checked);
    else if (impl.hostMemory)
        executor.publish("output.publish", impl.target);
}

void OutputTarget::report(Report& report) const {
    if (impl_->mode != Impl::Mode::kNone) report.choose(impl_->name, impl_->choice);
}

std::uint64_t OutputTarget::bytes() const {
    return impl_->own.bytes() + impl_->staging.bytes();
}

std::uint64_t OutputTarget::estimateBytes(const LWViewDesc& view, std::uint32_t planeCount, bool uploads) {
    const std::uint64_t packed = largestPixelBytes(roleOf(planeCount));
    return std::uint64_t(planeCount) * sizeof(float) * paddedWidth(view.maxWidth) * view.maxHeight +
           (uploads ? packed * view.maxWidth * view.maxHeight : 0);
}

void checkLightOutputs(Device& device, const View& view, const LWOutput& output, const char* technique, std::uint32_t kinds) {
    constexpr std::uint32_t kAlways = 1u << 31;
    struct Entry {
        const LWImage* image;
        const char* name;
        std::uint32_t planes, kind;
    };
    const Entry entries[] = {{&output.irradiance, "irradiance", 3, kAlways},
                             {&output.validity, "validity", 1, kAlways},
                             {&output.ambientOcclusion, "ambientOcclusion", 1, kMakesAmbient},
                             {&output.specularRadiance, "specularRadiance", 3, kMakesSpecular},
                             {&output.refractedRadiance, "refractedRadiance", 3, kMakesRefracted},
                             {&output.shadow, "shadow", 1, kMakesShadow}};
    std::vector<const char*> made;
    bool isAny = false;
    for (const Entry& entry : entries) {
        if (entry.kind & (kinds | kAlways)) made.push_back(entry.name);
        isAny = isAny || rawEnum(entry.image->format) != LW_FORMAT_NONE;
    }
    const auto listed = [&](const char* last) {
        std::string list = made.front();
        for (std::size_t i = 1; i < made.size(); ++i) list += (i + 1 < made.size() ? ", " : last) + std::string(made[i]);
        return list;
    };
    for (const Entry& entry : entries)
        if (!(entry.kind & (kinds | kAlways)) && rawEnum(entry.image->format) != LW_FORMAT_NONE)
            fail(LW_ERROR_UNSUPPORTED, "output.", entry.name, ": technique ", technique, " makes ", listed(" and "), " only");
    if (!isAny) fail(LW_ERROR_INVALID_ARGUMENT, "output: expected ", listed(" or "), ", got none");
    for (const Entry& entry : entries)
        OutputTarget::check(device, view, *entry.image, entry.planes, ("output." + std::string(entry.name)).c_str());
}

}  // namespace lightwell
