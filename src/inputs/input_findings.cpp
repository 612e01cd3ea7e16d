#include "inputs/input_findings.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "inputs/input_check.h"

namespace lightwell {
namespace {

struct FaultText {
    LWInputFault fault;
    const char* name;
    const char* summary;
};
constexpr FaultText kFaults[] = {
    {LW_FAULT_NOT_FINITE, "not-finite", "NaN, infinity or a position beyond reach on a surface"},
    {LW_FAULT_NEGATIVE, "negative", "negative albedo, radiance or flux"},
    {LW_FAULT_NO_SURFACES, "no-surfaces", "every normal is zero, or no depth leads to a place"},
    {LW_FAULT_NORMAL_MISSING, "normal-missing", "zero normals where position or depth shows a surface"},
    {LW_FAULT_NORMAL_LENGTH, "normal-length", "normals that are not unit"},
    {LW_FAULT_NORMAL_ENCODED, "normal-encoded", "normals still stored as n/2 + 1/2"},
    {LW_FAULT_NORMAL_SPACE, "normal-space",
     "normals in view space, or with other axes than the positions"},
    {LW_FAULT_NORMAL_FLIPPED, "normal-flipped", "normals that face away from camera or light"},
    {LW_FAULT_NORMAL_DISAGREES, "normal-disagrees", "normals that do not fit the positions"},
    {LW_FAULT_CAMERA_INVALID, "camera-invalid", "matrices that no camera can have"},
    {LW_FAULT_CAMERA_TRANSPOSED, "camera-transposed", "column-major matrices"},
    {LW_FAULT_CAMERA_PREVIOUS, "camera-previous", "the G-buffer was drawn with previousCamera"},
    {LW_FAULT_IMAGE_FLIPPED, "image-flipped", "rows bottom-up, or columns mirrored"},
    {LW_FAULT_POSITION_SPACE, "position-space", "positions in another space than the world"},
    {LW_FAULT_POSITION_UNITS, "position-units", "positions in another unit of length than their camera"},
    {LW_FAULT_POSITION_CAMERA, "position-camera", "positions that do not project to their pixels"},
    {LW_FAULT_DEPTH_REVERSED, "depth-reversed", "1 - depth is what the projection makes"},
    {LW_FAULT_DEPTH_KIND, "depth-kind", "another LWDepthKind fits"},
    {LW_FAULT_MOTION_SIGN, "motion-sign", "motion is this frame less the previous one"},
    {LW_FAULT_MOTION_FLIPPED_Y, "motion-flipped-y", "motion has +y up"},
    {LW_FAULT_MOTION_UNITS, "motion-units", "motion is not in pixels"},
    {LW_FAULT_MOTION_ZERO, "motion-zero", "motion is zero while the camera moves"},
    {LW_FAULT_MOTION_STATIC, "motion-static", "nearly all pixels move while the cameras are equal"},
    {LW_FAULT_MOTION_DISAGREES, "motion-disagrees", "motion that does not fit the cameras"},
    {LW_FAULT_ALBEDO_RANGE, "albedo-range", "albedo above 1"},
    {LW_FAULT_ALBEDO_SRGB, "albedo-srgb",
     "albedo still sRGB-encoded, or decoded twice, in one of two buffers"},
    {LW_FAULT_DIRECT_SCALE, "direct-scale", "directRadiance is off by a factor"},
    {LW_FAULT_FLUX_PI, "flux-pi", "flux is off by pi, 2 pi or 4 pi"},
    {LW_FAULT_FLUX_TEXELS, "flux-texels", "flux is off by the number of texels"},
    {LW_FAULT_FLUX_SCALE, "flux-scale", "flux is off by another factor, or more than the light sends"},
    {LW_FAULT_RSM_EMPTY, "rsm-empty", "a lamp that shines, and no texel with flux"},
    {LW_FAULT_RSM_ELSEWHERE, "rsm-elsewhere", "RSMs far from everything the camera sees"},
    {LW_FAULT_SPACES_DIFFER, "spaces-differ", "RSM and G-buffer do not lie in one space"},
    {LW_FAULT_UNITS_DIFFER, "units-differ", "RSM and G-buffer are in different units of length"},
    {LW_FAULT_LIGHT_CAMERA, "light-camera", "an RSM's camera is not where its light is"},
    {LW_FAULT_FAR_FROM_ORIGIN, "far-from-origin", "positions coarser than what is seen, far from their origin"},
};

// Hues a golden section apart: neighbours in the list differ most.
void paint(unsigned index, float (&colour)[3]) {
    const double hue = std::fmod(0.02 + 0.618034 * index, 1.0) * 6.0;
    for (int c = 0; c < 3; ++c) {
        const double k = std::fmod(hue + (c == 0 ? 0.0 : c == 1 ? 4.0 : 2.0), 6.0);
        colour[c] = float(std::min(1.0, std::max(0.02, std::abs(k - 3.0) - 1.0)));
    }
}

template <std::size_t N>
void copyText(const std::string& from, char (&to)[N]) {
    const std::size_t count = std::min(from.size(), N - 1);
    std::memcpy(to, from.data(), count);
    to[count] = '\0';
}

}  // namespace

const std::vector<LWInputFaultInfo>& inputFaults() {
    static const std::vector<LWInputFaultInfo> faults = [] {
        std::vector<LWInputFaultInfo> list;
        for (const FaultText& text : kFaults) {
            LWInputFaultInfo info{};
            info.structSize = sizeof info;
            info.fault = text.fault;
            info.name = text.name;
            info.summary = text.summary;
            paint(unsigned(list.size()), info.colour);
            list.push_back(info);
        }
        return list;
    }();
    return faults;
}

Found& Findings::addFinding(LWInputFault fault, LWSeverity severity, const std::string& argument,
                            const Figures& figures, const std::string& message) {
    Found found;
    LWInputFinding& f = found.finding;
    f.fault = fault;
    f.severity = severity;
    f.affected = figures.affected;
    f.examined = figures.examined;
    f.measured = figures.measured;
    f.expected = figures.expected;
    f.confidence = figures.confidence;
    std::copy_n(inputFaults()[std::size_t(fault)].colour, 3, f.colour);
    copyText(argument, f.argument);
    copyText(message, f.message);
    found_.push_back(std::move(found));
    return found_.back();
}

std::vector<Found> Findings::takeSorted() {
    std::stable_sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) {
        if (a.finding.severity != b.finding.severity) return a.finding.severity > b.finding.severity;
        return a.finding.confidence > b.finding.confidence;
    });
    return std::move(found_);
}

double shareOf(std::uint64_t part, std::uint64_t whole) {
    return whole ? double(part) / double(whole) : 0.0;
}

std::string percent(std::uint64_t part, std::uint64_t whole) {
    std::ostringstream text;
    text.precision(3);
    text << 100.0 * shareOf(part, whole) << " %";
    return text.str();
}

double medianOf(std::vector<double> values) {
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace lightwell
