#include "passes/bounding_compensation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/camera.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "bounding_compensation/bounding_compensation";
constexpr std::size_t kScaleBytes = 4 * sizeof(float);
constexpr double kPi = 3.14159265358979323846;

Range groupOf(const Kernel& kernel) { return kernel.width() == 1 ? Range{64, 1} : Range{8, 1}; }

Kernel& kernelOf(Device& device, const CompensationOptions& options, const char* name) {
    return device.programs().kernel(kProgram, name, {{"LW_INTERLEAVE", std::to_string(options.interleave)}});
}

std::size_t samplesBytes(const CompensationOptions& options) {
    return std::size_t(options.interleave) * options.interleave * options.samples * sizeof(lw_near_sample);
}

std::uint64_t senderFloats(const lw_sender_layout& layout) {
    return std::uint64_t(LW_COMPENSATION_PLANES) * std::uint64_t(layout.height) * std::uint64_t(layout.interleave) *
           std::uint64_t(layout.run);
}

}  // namespace

lw_sender_layout CompensationSenders::layout(std::uint32_t width, std::uint32_t height, std::uint32_t interleave) {
    lw_sender_layout layout{};
    layout.height = cl_int(height);
    layout.run = cl_int(paddedWidth((width + interleave - 1) / interleave)) + 2 * LW_SENDER_BORDER;
    layout.interleave = cl_int(interleave);
    return layout;
}

std::uint64_t CompensationSenders::estimateBytes(std::uint32_t width, std::uint32_t height, std::uint32_t interleave) {
    return senderFloats(layout(width, height, interleave)) * sizeof(float);
}

void CompensationSenders::reserve(Device& device, std::uint32_t width, std::uint32_t height, std::uint32_t interleave) {
    const std::uint64_t floats = senderFloats(layout(width, height, interleave));
    if (floats > std::uint64_t(std::numeric_limits<std::int32_t>::max()))
        fail(LW_ERROR_UNSUPPORTED, "compensation: the surfaces of ", width, "x", height,
             " pixels exceed the 32-bit indices of the kernels");
    planes_.reserve(device, std::size_t(floats) * sizeof(float), "surfaces that compensate");
}

BoundingCompensation::BoundingCompensation(Device& device, const CompensationOptions& options)
    : options_(options),
      scaleOf_(kernelOf(device, options, "bounding_compensation_scale")),
      halve_(kernelOf(device, options, "bounding_compensation_halve")),
      makeSenders_(kernelOf(device, options, "bounding_compensation_senders")),
      gather_(kernelOf(device, options, "bounding_compensation_gather")),
      scale_(device, kScaleBytes, "what VPLs stand for"),
      samples_(device, samplesBytes(options), "samples of the surroundings") {}

std::uint64_t BoundingCompensation::estimateBytes(const CompensationOptions& options) {
    return kScaleBytes + samplesBytes(options);
}

float BoundingCompensation::reachOf(std::uint32_t width, std::uint32_t height) {
    return std::max(0.25f * float(std::max(width, height)), 2.0f);
}

// Of all n^2 S samples number k has the k-th smallest distance. The pixel itself is left out: a circle of one pixel's area.
// Each subset takes one of every n^2 consecutive ones, and angles advance by the golden ratio: a window's samples are spread
// over the whole disc, and a pixel's own over all distances.
std::vector<lw_near_sample> BoundingCompensation::samples(const CompensationOptions& options, float reach) {
    const std::uint32_t subsets = options.interleave * options.interleave, count = subsets * options.samples;
    const double nearest = std::sqrt(1.0 / kPi), growth = std::log(double(reach) / nearest) / double(count);
    const auto distance = [&](double k) { return nearest * std::exp(growth * k); };
    std::vector<lw_near_sample> result(count);
    for (std::uint32_t k = 0; k < count; ++k) {
        const double r = std::max(distance(k + 0.5), 1.0), inner = distance(k), outer = distance(k + 1.0);
        const double turn = 2.0 * kPi * std::fmod(k * 0.6180339887498949, 1.0);
        const std::uint32_t stratum = k / subsets, subset = (k % subsets * 5 + stratum * 7) % subsets;
        lw_near_sample& sample = result[subset * options.samples + stratum];
        sample.x = cl_int(std::lround(r * std::cos(turn)));
        sample.y = cl_int(std::lround(r * std::sin(turn)));
        sample.cell = float(kPi * (outer * outer - inner * inner));
    }
    return result;
}

lw_pixel_area BoundingCompensation::pixelArea(const LWCamera& camera, std::uint32_t width, std::uint32_t height,
                                              const char* name) {
    const Camera from(camera, width, height, name);
    return {float4(from.eye().x, from.eye().y, from.eye().z, from.pixelArea()),
            float4(from.axis().x, from.axis().y, from.axis().z, from.perspective() ? 1.0 : 0.0)};
}

void BoundingCompensation::recordScale(Executor& executor, const Buffer& vpls, lw_subset_order order, std::uint32_t drawn) {
    executor.run("bounding_compensation.scale", scaleOf_, {1, 1}, {1, 1}, vpls, order, cl_int(drawn), scale_);
}

void BoundingCompensation::recordHalve(Executor& executor, const Planes& position, const Planes& normal,
                                       const Planes& radiance, const Planes& halfPosition, const Planes& halfNormal,
                                       const Planes& halfRadiance) {
    executor.run("bounding_compensation.halve", halve_,
                 {(halfPosition.width + halve_.width() - 1) / halve_.width(), halfPosition.height}, groupOf(halve_), position,
                 normal, radiance, cl_int(position.width), cl_int(position.height), halfPosition, halfNormal, halfRadiance);
}

void BoundingCompensation::recordSenders(Executor& executor, const Planes& position, const Planes& normal,
                                         const Planes& radiance, const lw_pixel_area& camera,
                                         const CompensationSenders& senders, const Buffer& counts) {
    const lw_sender_layout layout = CompensationSenders::layout(position.width, position.height, options_.interleave);
    const float reach = reachOf(position.width, position.height);
    executor.run("bounding_compensation.senders", makeSenders_,
                 {std::size_t(layout.run) / makeSenders_.width(), position.height}, groupOf(makeSenders_), position, normal,
                 radiance, cl_int(position.width), camera, scale_, cl_int(options_.uniformArea ? 1 : 0), reach * reach, layout,
                 senders.planes(), counts);
}

void BoundingCompensation::recordGather(Executor& executor, const Planes& position, const Planes& normal,
                                        const CompensationSenders& senders, bool alone, const Planes& irradiance,
                                        const Buffer& counts) {
    const std::vector<lw_near_sample> pattern = samples(options_, reachOf(position.width, position.height));
    executor.writeCopy("bounding_compensation.upload", samples_, 0, samplesBytes(options_), pattern.data());
    const std::uint32_t pixels = gather_.width() * options_.interleave;
    executor.run("bounding_compensation.gather", gather_, {(position.width + pixels - 1) / pixels, position.height},
                 groupOf(gather_), position, normal, cl_int(position.width), cl_int(position.height), senders.planes(),
                 CompensationSenders::layout(position.width, position.height, options_.interleave), samples_,
                 cl_int(options_.samples), cl_int(alone ? 1 : 0), irradiance, counts);
}

}  // namespace lightwell
