// Reflective shadow maps (Dachsbacher and Stamminger 2005) as texels that VPLs are drawn from. All maps
// are checked before anything is enqueued, so that a refused frame leaves the last one in force.
#include "inputs/rsm_input.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <optional>
#include <set>
#include <tuple>

#include "compute/device.h"
#include "inputs/image_access.h"
#include "inputs/rsm_check.h"

namespace lightwell {
namespace {

constexpr char kProgram[] = "rsm_input/rsm_input";

static_assert(RsmInput::kPositionX == LW_RSM_POSITION && RsmInput::kNormalX == LW_RSM_NORMAL &&
                  RsmInput::kFluxR == LW_RSM_FLUX && RsmInput::kArea == LW_RSM_AREA &&
                  RsmInput::kPlaneCount == LW_RSM_PLANES,
              "kernels/shared/rsm_types.h differs from RsmInput::Plane");

// No two inputs have one in common, so that what is kept of one is never taken for another's.
std::uint64_t nextGeneration() {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
}

// What texels were made of.
struct ReadRsm {
    std::uint64_t version;
    bool fromDepth;
    std::array<LWImage, 3> images;
    LwUnprojection unprojection;
    LwRsmSpan span;

    explicit ReadRsm(const CheckedRsm& rsm)
        : version(rsm.version),
          fromDepth(rsm.depth.has_value()),
          images{rsm.place().image, rsm.normal.image, rsm.flux.image},
          unprojection(rsm.unprojection),
          span(rsm.span) {}

    bool isAtSamePlace(const ReadRsm& other) const {
        const auto place = [](const LwRsmSpan& s) { return std::tie(s.firstTexel, s.firstRow, s.width, s.height); };
        return place(span) == place(other.span);
    }
    // Of maps at the same place: whether reading `other` would make the same texels.
    bool isSame(const ReadRsm& other) const {
        const auto sameMemory = [](const LWImage& a, const LWImage& b) {
            const auto fields = [](const LWImage& i) {
                return std::tie(i.host, i.clMem, i.format, i.byteOffset, i.bytePixelStride, i.byteRowStride, i.bytePlaneStride);
            };
            return fields(a) == fields(b);
        };
        return version != 0 && version == other.version && fromDepth == other.fromDepth &&
               std::equal(images.begin(), images.end(), other.images.begin(), sameMemory) &&
               std::memcmp(&unprojection, &other.unprojection, sizeof unprojection) == 0 && std::memcmp(&span, &other.span, sizeof span) == 0;
    }
};

}  // namespace

struct RsmInput::Impl {
    Device* device = nullptr;  // of the last import
    Buffer texelMemory, counters;
    std::array<Buffer, 3> staging;  // uploads of position or depth, normal, flux: one map after the other
    std::vector<DeviceImage> opened;
    using Choices = std::set<std::pair<const char*, const char*>>;  // literals
    std::vector<Choices> choices;  // of each map, when it was read
    std::vector<ReadRsm> read;                              // of each map, what its texels were made of; none: half made
    WorldOrigin origin{};                                   // what they are relative to: LWFrame::worldOrigin
    std::uint64_t failures = 0;                             // that the device had seen when they were made
    std::size_t keptCount = 0;                              // maps that the last import() did not read

    // Of each map, whether the texels made of it before are what it would make. By place among the texels: where one map has another
    // size all are read.
    std::vector<bool> findKept(const std::vector<ReadRsm>& now, Executor& executor, std::uint64_t failed) const {
        std::vector<bool> kept(now.size(), false);
        const Device& current = executor.device();
        const bool isLost = device != &current || failures != failed;
        if (isLost || !(origin == executor.worldOrigin()) || !std::equal(now.begin(), now.end(), read.begin(), read.end(),
                                  [](const ReadRsm& a, const ReadRsm& b) { return a.isAtSamePlace(b); }))
            return kept;
        for (std::size_t i = 0; i < now.size(); ++i) kept[i] = now[i].isSame(read[i]);
        return kept;
    }

    void reserve(Device& current, const std::vector<CheckedRsm>& rsms, std::uint64_t total) {
        texelMemory.reserve(current, std::size_t(total) * kPlaneCount * sizeof(float), "RSM texels");
        counters.reserve(current, rsms.size() * LW_RSM_COUNTERS * sizeof(std::uint32_t), "RSM counters");
        // For the largest map at once, so that no map of the frame replaces what an earlier one still needs.
        std::array<std::size_t, 3> bytes{};
        for (const CheckedRsm& rsm : rsms) {
            const CheckedImage* images[3] = {&rsm.place(), &rsm.normal, &rsm.flux};
            for (std::size_t i = 0; i < 3; ++i) bytes[i] = std::max(bytes[i], stagingBytes(current, *images[i]));
        }
        for (std::size_t i = 0; i < 3; ++i)
            if (bytes[i]) staging[i].reserve(current, bytes[i], "an RSM's copy on the device");
    }

    // The host's maps into the texels.
    void unpackRsm(Executor& executor, const CheckedRsm& rsm, const Planes& all, Choices& made) {
        const auto open = [&](const CheckedImage& image, const ImageRole& role, std::size_t slot,
                              const char* what) -> DeviceImage& {
            opened.push_back(openForReading(executor, image, role, "rsm_input.upload", staging[slot]));
            made.emplace(what, opened.back().planes ? "planar, copied among the texels" : opened.back().choice);
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
    std::vector<ReadRsm> now(rsms.begin(), rsms.end());
    const std::uint64_t failures = device.failures();  // once: another may happen meanwhile, which the next import's is
    const std::vector<bool> kept = impl_->findKept(now, executor, failures);
    impl_->keptCount = std::size_t(std::count(kept.begin(), kept.end(), true));
    impl_->read.clear();  // until all commands are on their way
    impl_->device = &device;
    impl_->failures = failures;
    impl_->origin = executor.worldOrigin();
    std::uint64_t total = 0;
    std::uint32_t newRows = 0, newTexels = 0;
    for (const RsmSpan& span : newSpans) {
        total += std::uint64_t(paddedWidth(span.width)) * span.height;
        newRows += span.height;
        newTexels += span.width * span.height;
    }
    if (total > 0) {
        rows.reserve(device, std::size_t(newRows) * 4 * sizeof(std::int32_t), "RSM rows");
        impl_->reserve(device, rsms, total);
    }
    impl_->opened.clear();
    impl_->choices.resize(rsms.size());
    spans = std::move(newSpans);
    shapes.clear();
    for (const CheckedRsm& rsm : rsms) shapes.push_back(rsm.span);
    rowCount = newRows;
    texelCount = newTexels;
    texels = Planes{};
    if (impl_->keptCount < rsms.size() || rsms.empty()) generation = nextGeneration();
    if (total == 0) return;
    texels.memory = impl_->texelMemory.get();
    texels.rowStride = texels.planeStride = std::int64_t(total);
    texels.width = std::uint32_t(total);
    texels.height = 1;
    texels.count = kPlaneCount;

    Kernel& rowsKernel = device.programs().kernel(kProgram, "rsm_input_rows");
    for (std::size_t i = 0; i < rsms.size(); ++i) {
        if (kept[i]) continue;
        executor.run("rsm_input.rows", rowsKernel, {std::uint32_t(rsms[i].span.height), 1}, rowGroup(device), rows, impl_->counters,
                     rsms[i].span);
        impl_->choices[i].clear();
        impl_->unpackRsm(executor, rsms[i], texels, impl_->choices[i]);
    }
    impl_->read = std::move(now);
}

void RsmInput::report(Report& report) const {
    report.counts.push_back({"rsm_texels", texelCount});
    report.counts.push_back({"rejected_texels", 0});
    report.counts.push_back({"covered_texels", 0});
    for (std::size_t i = 0; i < spans.size(); ++i) {
        const std::size_t first = i * LW_RSM_COUNTERS;
        report.read(*impl_->device, "rejected_texels", impl_->counters, (first + LW_RSM_REJECTED) * sizeof(cl_uint));
        report.read(*impl_->device, "covered_texels", impl_->counters, (first + LW_RSM_COVERED) * sizeof(cl_uint));
    }
    for (const Impl::Choices& ofMap : impl_->choices)
        for (const auto& choice : ofMap) report.choose(choice.first, choice.second);
    if (impl_->keptCount)
        report.choose("rsms", impl_->keptCount < spans.size() ? "some not read again: their versions are those of the frame before"
                                                              : "not read again: their versions are those of the frame before");
}

std::uint64_t RsmInput::bytes() const {
    std::uint64_t total = impl_->texelMemory.bytes() + impl_->counters.bytes() + rows.bytes();
    for (const Buffer& buffer : impl_->staging) total += buffer.bytes();
    return total;
}

std::uint64_t RsmInput::estimateBytes(const FrameShape& shape) {
    checkRsmTexels(shape.paddedTexels, "rsmTexels, frame.lights");
    if (shape.texels == 0) return 0;
    const std::uint64_t packed =
        largestPixelBytes(kPositionRole) + largestPixelBytes(kNormalRole) + largestPixelBytes(kRadianceRole);
    return shape.paddedTexels * kPlaneCount * sizeof(float) + shape.rows * 4 * sizeof(std::int32_t) +
           shape.maps * LW_RSM_COUNTERS * sizeof(std::uint32_t) + (shape.uploads ? packed * shape.largestMap : 0);
}

}  // namespace lightwell
