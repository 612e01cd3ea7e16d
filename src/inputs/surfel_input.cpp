#include "inputs/surfel_input.h"

#include <optional>
#include <string>
#include <vector>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/image_access.h"

namespace lightwell {
namespace {

// In rows of work-groups that drivers launch as they launch few (Kernel::noteLaunch).
constexpr std::uint32_t kMaxSurfels = 65535 * 256;

struct Field {
    const char* name;
    LWImage LWGeometry::*image;
    const ImageRole* role;
    std::uint32_t plane;
    bool required;
};
const std::array<Field, 5> kFields = {{
    {"surfelPosition", &LWGeometry::surfelPosition, &kPositionRole, LW_SURFEL_POSITION, true},
    {"surfelNormal", &LWGeometry::surfelNormal, &kNormalRole, LW_SURFEL_NORMAL, true},
    {"surfelArea", &LWGeometry::surfelArea, &kScalarRole, LW_SURFEL_RADIUS, true},
    {"surfelAlbedo", &LWGeometry::surfelAlbedo, &kAlbedoRole, LW_SURFEL_ALBEDO, false},
    {"surfelEmission", &LWGeometry::surfelEmission, &kRadianceRole, LW_SURFEL_EMISSION, false},
}};
std::size_t fieldCount(bool withEmission) { return withEmission ? kFields.size() : kFields.size() - 1; }

std::array<std::optional<CheckedImage>, 5> checkImages(Device& device, const LWGeometry& g, bool withEmission) {
    constexpr const char* kName = "frame.geometry.";
    if (g.surfelCount > kMaxSurfels)
        fail(LW_ERROR_INVALID_ARGUMENT, kName, "surfelCount: expected at most ", kMaxSurfels, ", got ", g.surfelCount);
    std::array<std::optional<CheckedImage>, 5> checked;
    for (std::size_t f = 0; f < fieldCount(withEmission); ++f) {
        const LWImage& image = g.*kFields[f].image;
        if (!imageAbsent(image))
            checked[f] = checkImage(device, image, *kFields[f].role, g.surfelCount, 1, std::string(kName) + kFields[f].name);
        else if (kFields[f].required)
            fail(LW_ERROR_INVALID_ARGUMENT, kName, kFields[f].name, ": expected an image of ", g.surfelCount,
                 " x 1 pixels, one for each surfel, got none");
    }
    return checked;
}

}  // namespace

SurfelInput::Key SurfelInput::keyOf(const LWGeometry* g, bool withEmission) {
    Key key;
    if (!g || g->surfelCount == 0) return key;
    for (std::size_t f = 0; f < fieldCount(withEmission); ++f) {
        const LWImage& image = g->*kFields[f].image;
        key.images[f] = image.host ? image.host : image.clMem;
    }
    key.count = g->surfelCount;
    key.version = g->version;
    return key;
}

void SurfelInput::check(Device& device, const LWGeometry* geometry, bool withEmission) {
    if (geometry && geometry->surfelCount) checkImages(device, *geometry, withEmission);
}

void SurfelInput::import(Executor& executor, const LWGeometry* geometry, bool withEmission) {
    const Key key = keyOf(geometry, withEmission);
    if (key == key_ && executor.worldOrigin() == origin_) return;
    Device& device = executor.device();
    if (key.count == 0) {
        memory_.reset(executor, 0, LW_SURFEL_RAW_PLANES);
    } else {
        const auto checked = checkImages(device, *geometry, withEmission);
        const bool emits = checked[4].has_value();
        const std::uint32_t planeCount = emits ? LW_SURFEL_EMISSIVE_PLANES : LW_SURFEL_RAW_PLANES;
        key_ = Key{};  // until all is enqueued
        memory_.reset(executor, key.count, planeCount);
        memory_.setEmits(emits);
        Planes raw = memory_.planes();
        raw.count = planeCount;
        raw.width = key.count;
        for (std::size_t f = 0; f < kFields.size(); ++f) {
            if (!checked[f]) continue;
            const DeviceImage opened =
                openForReading(executor, *checked[f], *kFields[f].role, "surfel_input.upload", staging_[f]);
            unpack(executor, "surfel_input.unpack", opened, subPlanes(raw, kFields[f].plane, kFields[f].role->channels));
        }
        Kernel& finish = device.programs().kernel("surfel_input/surfel_input", "surfel_input_finish");
        executor.run("surfel_input.finish", finish, rowGrid(device, memory_.planes().width, 1), rowGroup(device),
                     memory_.planes().memory, cl_int(raw.planeStride), cl_int(key.count), cl_int(checked[3] ? 1 : 0),
                     cl_int(emits ? 1 : 0), memory_.counters());
    }
    memory_.measure(executor);
    memory_.noteChange();
    device_ = &device;
    key_ = key;
    origin_ = executor.worldOrigin();
}

void SurfelInput::report(Report& report) const {
    report.counts.push_back({"surfels", key_.count});
    report.counts.push_back({"rejected_surfels", 0});
    if (device_) report.read(*device_, "rejected_surfels", memory_.counters(), LW_SURFEL_REJECTED * sizeof(cl_uint));
}

std::uint64_t SurfelInput::bytes() const {
    std::uint64_t total = memory_.bytes();
    for (const Buffer& buffer : staging_) total += buffer.bytes();
    return total;
}

std::uint64_t SurfelInput::estimateBytes(std::uint32_t surfelCount, bool uploads, bool withEmission) {
    if (surfelCount > kMaxSurfels)
        fail(LW_ERROR_INVALID_ARGUMENT, "frame.geometry.surfelCount: expected at most ", kMaxSurfels, ", got ", surfelCount);
    std::uint64_t packed = 0;
    for (std::size_t f = 0; f < fieldCount(withEmission); ++f) packed += largestPixelBytes(*kFields[f].role);
    return SurfelMemory::estimateBytes(surfelCount, withEmission ? LW_SURFEL_EMISSIVE_PLANES : LW_SURFEL_RAW_PLANES) + (uploads ? packed * surfelCount : 0);
}

}  // namespace lightwell
