#include "passes/screen_combine.h"

#include <string>

#include "compute/device.h"
#include "inputs/camera.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "screen_combine/screen_combine";

Defines definesOf(std::uint32_t interleave) { return {{"LW_INTERLEAVE", std::to_string(interleave)}}; }

Defines filterDefines(std::uint32_t interleave, bool planned) {
    Defines defines = definesOf(interleave);
    if (planned) defines.push_back({"LW_PLANNED", "1"});
    return defines;
}

Range groupOf(const Kernel& kernel) { return kernel.width() == 1 ? Range{64, 1} : Range{8, 1}; }

Range itemsOver(const Planes& planes, std::uint32_t columnsPerItem, std::uint32_t rowsPerItem = 1) {
    return {(planes.width + columnsPerItem - 1) / columnsPerItem, (planes.height + rowsPerItem - 1) / rowsPerItem};
}

constexpr std::uint32_t kRows = 2;  // LW_LIT_ROWS of kernels/screen_combine

}  // namespace

ScreenCombine::ScreenCombine(Device& device, const Options& options)
    : factor_(options.factor), finish_(device.programs().kernel(kProgram, "screen_combine_finish", definesOf(options.factor))) {
    if (options.interleave > 1)
        filter_ = &device.programs().kernel("screen_combine/screen_filter", "screen_combine_filter",
                                             filterDefines(options.interleave, options.planned));
    if (options.adds) add_ = &device.programs().kernel(kProgram, "screen_combine_add", definesOf(2));
    if (options.joins) join_ = &device.programs().kernel("screen_combine/screen_join", "screen_combine_join");
    if (options.moves && factor_ > 1)
        motion_ = &device.programs().kernel("screen_combine/screen_motion", "screen_combine_motion", definesOf(factor_));
}

void ScreenCombine::recordFilter(Executor& executor, const Planes& texels, bool alike, const Planes& light, const Planes& filtered) {
    executor.run("screen_combine.filter", *filter_, itemsOver(light, filter_->width()), groupOf(*filter_), texels,
                 cl_int(light.width), cl_int(light.height), cl_int(alike ? 1 : 0), light, filtered);
}

void ScreenCombine::recordFilter(Executor& executor, const Planes& texels, std::uint32_t alike, std::uint32_t discsAlike,
                                 const Planes& light, const Planes& filtered, const Buffer& plan, std::uint32_t level) {
    executor.run("screen_combine.filter", *filter_, itemsOver(light, filter_->width()), groupOf(*filter_), texels,
                 cl_int(light.width), cl_int(light.height), cl_int(alike), light, filtered, cl_int(discsAlike), plan, cl_int(level));
}

void ScreenCombine::recordAdd(Executor& executor, const Planes& fine, const Planes& own, const Planes& coarse,
                              const Planes& light, const Planes& sum) {
    executor.run("screen_combine.add", *add_, itemsOver(own, 2 * add_->width(), kRows), groupOf(*add_), fine, cl_int(own.width),
                 cl_int(own.height), own, coarse, cl_int(coarse.height), light, sum);
}

void ScreenCombine::recordFinish(Executor& executor, const Planes& position, const Planes& normal, const Planes& texels,
                                 const Planes& light, const Planes& irradiance, const Planes& validity, const Buffer& counts) {
    const Planes& e = irradiance ? irradiance : light;  // not touched where there is none
    const Planes& v = validity ? validity : light;
    executor.run("screen_combine.finish", finish_, itemsOver(position, factor_ * finish_.width(), kRows), groupOf(finish_), position,
                 normal, cl_int(position.width), cl_int(position.height), texels, cl_int(texels.height), light,
                 cl_int(irradiance ? 1 : 0), e, cl_int(validity ? 1 : 0), v, counts);
}

void ScreenCombine::recordJoin(Executor& executor, const Planes& position, const Planes& normal, const Planes& texels,
                               const Camera& camera, const Planes& light, const Planes& irradiance, const Planes& validity) {
    const Planes& e = irradiance ? irradiance : light;
    const Planes& v = validity ? validity : light;
    executor.run("screen_combine.join", *join_, itemsOver(position, join_->width()), groupOf(*join_), position, normal,
                 cl_int(position.width), cl_int(position.height), texels, cl_int(texels.width), cl_int(texels.height),
                 camera.texelsOf(factor_), light, cl_int(irradiance ? 1 : 0), e, cl_int(validity ? 1 : 0), v);
}

void ScreenCombine::recordMotion(Executor& executor, const Planes& position, const Planes& motion, const Planes& texels,
                                 const Planes& moved) {
    executor.run("screen_combine.motion", *motion_, itemsOver(moved, motion_->width()), groupOf(*motion_), position, motion,
                 cl_int(position.width), cl_int(position.height), texels, moved);
}

}  // namespace lightwell
