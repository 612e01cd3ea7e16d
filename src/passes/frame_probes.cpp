#include "passes/frame_probes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "compute/device.h"
#include "inputs/image_access.h"
#include "passes/vpl_list.h"
#include "shared/vpl_types.h"

namespace lightwell {
namespace {

constexpr const char *kTexelProgram = "frame_probes/frame_probes_texels", *kProgram = "frame_probes/frame_probes";
constexpr Range kGroup{64, 1};
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// A side of the grid that each of so many maps gets: about LW_PROBE_TEXELS of all, one of each at least.
std::uint32_t sideFor(std::size_t maps) {
    std::uint32_t side = 1;
    while (std::size_t(side + 1) * (side + 1) * maps <= LW_PROBE_TEXELS) ++side;
    return side;
}

float ratio(double part, double whole, bool has = true) {
    return float(has && whole > 0.0 && std::isfinite(whole) && std::isfinite(part) ? part / whole : kNone);
}

// Root mean square distance from the middle; none where that is no more than what float's rounding makes of a point.
double radiusOf(const LwProbeChunk& places) {
    if (!(places.count > 0.0f)) return kNone;
    constexpr double kRounding = 2e-6;
    const double radius = std::sqrt(double(places.spread) / double(places.count));
    double squared = 0.0;
    for (const float part : places.mean) squared += double(part) * double(part);
    return radius > kRounding * std::sqrt(squared) ? radius : 0.0;
}

}  // namespace

FrameFigures probesOf(const LwFrameProbes& sums, std::uint32_t has) {
    const bool camera = has & LW_PROBE_HAS_CAMERA, albedo = has & LW_PROBE_HAS_ALBEDO, radiance = has & LW_PROBE_HAS_RADIANCE;
    const bool lit = sums.emitters > 0.0f && sums.texels.weight > 0.0f && std::isfinite(sums.texels.weight);
    const double pixels = double(sums.sums[LW_PROBE_VALID]), indirect = double(sums.sums[LW_PROBE_INDIRECT]);
    FrameFigures probes;
    probes.indirectShare = ratio(indirect, indirect + double(sums.sums[LW_PROBE_DIRECT]), lit && albedo && radiance);
    probes.fluxOnScreen = ratio(double(sums.texels.shown), double(sums.texels.weight), lit && camera);
    probes.fluxConcentration = ratio(double(sums.texels.squares), 1.0, lit);
    probes.depthComplexity = ratio(double(sums.sums[LW_PROBE_EDGES]), double(sums.sums[LW_PROBE_NEIGHBOURS]), camera);
    probes.extent = ratio(radiusOf(sums.pixels), radiusOf(sums.texels));
    probes.albedo = ratio(double(sums.sums[LW_PROBE_ALBEDO]), pixels, albedo);
    probes.facing = ratio(double(sums.sums[LW_PROBE_FACING]), pixels * double(sums.emitters), lit);
    probes.hidden = ratio(double(sums.sums[LW_PROBE_HIDDEN]), double(sums.sums[LW_PROBE_TESTED]), lit && camera);
    probes.coverage = ratio(pixels, LW_PROBE_PIXELS);
    return probes;
}

FrameProbes::FrameProbes(Device& device)
    : device_(device),
      texels_(device.programs().kernel(kTexelProgram, "frame_probes_texels")),
      chunks_(device.programs().kernel(kTexelProgram, "frame_probes_chunks")),
      draw_(device.programs().kernel(kTexelProgram, "frame_probes_draw")),
      pixels_(device.programs().kernel(kProgram, "frame_probes_pixels")),
      rows_(device.programs().kernel(kProgram, "frame_probes_rows")),
      join_(device.programs().kernel(kProgram, "frame_probes_join")),
      chunkSums_(device, LW_PROBE_CHUNKS * sizeof(LwProbeChunk), "sums of probed texels"),
      emitters_(device, LW_PROBE_EMITTERS * sizeof(lw_vpl), "probing emitters"),
      pixelPlanes_(device, std::size_t(LW_PROBE_PIXEL_PLANES) * LW_PROBE_PIXELS * sizeof(float), "probed pixels"),
      rowSums_(device, LW_PROBE_ROWS * sizeof(LwFrameProbes), "sums of probed pixels"),
      probes_(device, sizeof(LwFrameProbes), "probes of a frame") {}

void FrameProbes::recordTexels(Executor& executor, const ProbedView& view, const RsmInput& rsms, const LWVpl* vpls,
                               std::uint32_t vplCount) {
    const std::uint32_t side = sideFor(std::max<std::size_t>(rsms.spans.size(), 1));
    const std::uint32_t samples = std::uint32_t(rsms.spans.size()) * side * side, count = samples + vplCount;
    const std::uint32_t step = paddedWidth(std::max(count, 1u)), length = (count + LW_PROBE_CHUNKS - 1) / LW_PROBE_CHUNKS;
    std::vector<LwProbeMap> maps;
    for (const RsmSpan& span : rsms.spans)
        maps.push_back({cl_int(span.firstTexel), cl_int(paddedWidth(span.width)), cl_int(span.width), cl_int(span.height)});
    // A kernel's argument must be some memory, also where none is read.
    maps_.reserve(device_, std::max<std::size_t>(maps.size(), 1) * sizeof(LwProbeMap), "probed RSMs");
    authored_.reserve(device_, std::max(vplCount, 1u) * sizeof(lw_vpl), "frame.vpls");
    texelPlanes_.reserve(device_, std::size_t(step) * LW_PROBE_TEXEL_PLANES * sizeof(float), "probed texels");
    places_.reserve(device_, std::size_t(step) * sizeof(cl_int), "probed texels");
    if (!maps.empty()) executor.writeCopy("frame_probes.upload", maps_, 0, maps.size() * sizeof(LwProbeMap), maps.data());
    static_assert(sizeof(LWVpl) == sizeof(lw_vpl), "LWVpl is uploaded as it is");
    if (vplCount) executor.writeCopy("frame_probes.upload", authored_, 0, vplCount * sizeof(lw_vpl), vpls);
    Planes texels = rsms.texels;
    if (!texels) texels.memory = authored_.get();
    executor.run("frame_probes.texels", texels_, gridOver(count), kGroup, texels, maps_, cl_int(side), cl_int(samples), authored_,
                 cl_int(vplCount), view.camera, cl_int(view.hasCamera ? 1 : 0), view.position, view.normal, cl_int(view.width),
                 cl_int(view.height), cl_int(step), texelPlanes_, places_);
    executor.run("frame_probes.chunks", chunks_, {LW_PROBE_CHUNKS, 1}, {1, 1}, texelPlanes_, cl_int(step), cl_int(count),
                 cl_int(length), chunkSums_);
    executor.run("frame_probes.draw", draw_, {LW_PROBE_EMITTERS, 1}, {8, 1}, texelPlanes_, cl_int(step), cl_int(count), cl_int(length),
                 chunkSums_, places_, texels, cl_int(samples), authored_, emitters_);
}

void FrameProbes::record(Executor& executor, const ProbedView& view, const RsmInput& rsms, const LWVpl* vpls,
                         std::uint32_t vplCount) {
    has_ = (view.hasCamera ? LW_PROBE_HAS_CAMERA : 0) | (view.albedo ? LW_PROBE_HAS_ALBEDO : 0) |
           (view.directRadiance ? LW_PROBE_HAS_RADIANCE : 0);
    chunkCount_ = rsms.spans.empty() && vplCount == 0 ? 0 : LW_PROBE_CHUNKS;
    if (chunkCount_) recordTexels(executor, view, rsms, vpls, vplCount);
    else executor.fill("frame_probes.counts", emitters_, 0, 0, emitters_.bytes());
    executor.run("frame_probes.pixels", pixels_, rowGrid(device_, LW_PROBE_COLUMNS, LW_PROBE_ROWS), rowGroup(device_), view.position, view.normal,
                 view.albedo ? view.albedo : view.normal, view.directRadiance ? view.directRadiance : view.normal,
                 cl_int(view.width), cl_int(view.height), cl_int(has_), view.camera, emitters_, pixelPlanes_);
    executor.run("frame_probes.rows", rows_, {LW_PROBE_ROWS, 1}, {1, 1}, pixelPlanes_, rowSums_);
    executor.run("frame_probes.join", join_, {1, 1}, {1, 1}, rowSums_, chunkSums_, cl_int(chunkCount_), emitters_, probes_);
}

void FrameProbes::readLate(Executor& executor) {
    if (late_.isPending()) return;
    late_.record(executor, "frame_probes.read", probes_, 0);
    lateHas_ = has_;
}

const FrameFigures* FrameProbes::take() {
    const LwFrameProbes* sums = late_.take();
    if (!sums) return nullptr;
    taken_ = probesOf(*sums, lateHas_);
    return &taken_;
}

std::uint64_t FrameProbes::estimateBytes(std::uint64_t maps, std::uint64_t vplCount) {
    const std::uint64_t texels = (std::max<std::uint64_t>(maps, LW_PROBE_TEXELS) + vplCount + 15) / 16 * 16;
    return std::max<std::uint64_t>(maps, 1) * sizeof(LwProbeMap) + std::max<std::uint64_t>(vplCount, 1) * sizeof(lw_vpl) +
           texels * (LW_PROBE_TEXEL_PLANES * sizeof(float) + sizeof(cl_int)) + LW_PROBE_CHUNKS * sizeof(LwProbeChunk) +
           LW_PROBE_EMITTERS * sizeof(lw_vpl) + std::uint64_t(LW_PROBE_PIXEL_PLANES) * LW_PROBE_PIXELS * sizeof(float) +
           (LW_PROBE_ROWS + 1) * sizeof(LwFrameProbes);
}

std::uint64_t FrameProbes::bytes() const {
    std::uint64_t total = 0;
    for (const Buffer* buffer : {&maps_, &authored_, &texelPlanes_, &places_, &chunkSums_, &emitters_, &pixelPlanes_, &rowSums_, &probes_})
        total += buffer->bytes();
    return total;
}

}  // namespace lightwell
