#include "passes/joint_bilateral.h"

#include <string>

#include "compute/device.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "joint_bilateral/joint_bilateral";

Defines definesOf(std::uint32_t channels, bool marks = false) {
    Defines defines = {{"LW_CHANNELS", std::to_string(channels)}};
    if (marks) defines.push_back({"LW_MARKS", "1"});
    return defines;
}

Range groupOf(const Kernel& kernel) { return kernel.width() == 1 ? Range{64, 1} : Range{8, 1}; }

// One work-item per `width` half-resolution columns; rows as given.
Range itemsOver(std::uint32_t fullWidth, std::uint32_t rows, const Kernel& kernel) {
    return {(JointBilateral::halved(fullWidth) + kernel.width() - 1) / kernel.width(), rows};
}

}  // namespace

JointBilateral::JointBilateral(Device& device, std::uint32_t channels, bool marks)
    : channels_(channels),
      downsample_(device.programs().kernel(kProgram, "joint_bilateral_downsample", definesOf(channels))),
      upsample_(device.programs().kernel(kProgram, "joint_bilateral_upsample", definesOf(channels, marks))) {}

void JointBilateral::recordDownsample(Executor& executor, const Planes& position, const Planes& normal,
                                      const Planes& halfPosition, const Planes& halfNormal) {
    executor.run("joint_bilateral.downsample", downsample_,
                 itemsOver(position.width, halved(position.height), downsample_), groupOf(downsample_), position,
                 normal, cl_int(position.width), cl_int(position.height), halfPosition, halfNormal);
}

void JointBilateral::recordUpsample(Executor& executor, const Planes& position, const Planes& normal,
                                    const Planes& halfPosition, const Planes& halfNormal,
                                    const Planes& halfIrradiance, const Planes& irradiance, const Buffer& counts,
                                    const Planes& validity) {
    const auto run = [&](const auto&... rest) {
        executor.run("joint_bilateral.upsample", upsample_, itemsOver(position.width, halved(position.height), upsample_),
                     groupOf(upsample_), position, normal, cl_int(position.width), cl_int(position.height), halfPosition,
                     halfNormal, halfIrradiance, irradiance, rest...);
    };
    if (channels_ != 3) return run(counts);
    // A kernel's argument must be some memory, also where it is not written.
    run(validity ? validity : irradiance, cl_int(validity ? 1 : 0), counts);
}

void JointBilateral::recordUpsampleMarked(Executor& executor, const Planes& position, const Planes& normal, const Planes& halfPosition,
                                          const Planes& halfNormal, const Planes& halfIrradiance, const Planes& irradiance, float share,
                                          const Buffer& marks, const Planes& validity, const Buffer& counts) {
    // A kernel's argument must be some memory, also where it is not written.
    executor.run("joint_bilateral.upsample", upsample_, itemsOver(position.width, halved(position.height), upsample_),
                 groupOf(upsample_), position, normal, cl_int(position.width), cl_int(position.height), halfPosition, halfNormal,
                 halfIrradiance, irradiance, validity ? validity : irradiance, cl_int(validity ? 1 : 0), share, marks, counts);
}

void JointBilateral::recordUpsampleAll(Executor& executor, const Planes& position, const Planes& normal,
                                       const Planes& halfPosition, const Planes& halfNormal, const Planes& halfLight,
                                       const Planes& irradiance, const Planes& fourth, const Planes& fifth,
                                       const Buffer& counts) {
    executor.run("joint_bilateral.upsample", upsample_, itemsOver(position.width, halved(position.height), upsample_),
                 groupOf(upsample_), position, normal, cl_int(position.width), cl_int(position.height), halfPosition,
                 halfNormal, halfLight, irradiance, fourth, fifth, counts);
}

}  // namespace lightwell
