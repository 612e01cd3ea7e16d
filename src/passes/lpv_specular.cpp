#include "passes/lpv_specular.h"

#include "compute/device.h"

namespace lightwell {
namespace {

constexpr const char* kCells = "lpv_specular/lpv_specular_cells";
constexpr const char* kMarch = "lpv_specular/lpv_specular";
constexpr Range kCellGroup{4, 4};

std::uint64_t countOf(std::uint32_t size) { return std::uint64_t(specular_first(lw_int(size), specular_levels(lw_int(size)))); }
std::uint64_t cellBytes(std::uint32_t size) { return countOf(size) * LW_SPECULAR_CELL * sizeof(float); }

Range cellsOf(std::uint32_t size) { return {size, std::size_t(size) * size}; }

}  // namespace

LwSpecularRays specularRays(const Camera& camera, const float* environment, float roughness) {
    const glm::dvec3 from = camera.perspective() ? camera.eye() : camera.axis();
    LwSpecularRays view{};
    view.eye = float4(from.x, from.y, from.z, camera.perspective() ? 1.0 : 0.0);
    view.environment = float4(double(environment[0]), double(environment[1]), double(environment[2]), 0.0);
    view.roughness = float4(double(roughness), 0.0, 0.0, 0.0);
    return view;
}

LpvSpecular::LpvSpecular(Device& device, std::uint32_t size, bool keepsShown)
    : device_(device),
      size_(size),
      keepsShown_(keepsShown),
      packSteps_(device.programs().kernel(kCells, "lpv_specular_pack_steps")),
      packSweep_(device.programs().kernel(kCells, "lpv_specular_pack_sweep")),
      halve_(device.programs().kernel(kCells, "lpv_specular_halve")),
      ways_(device.programs().kernel(kCells, "lpv_specular_ways")),
      distance_(device.programs().kernel(kCells, "lpv_specular_distances")),
      pick_(device.programs().kernel(kMarch, "lpv_specular_pick")),
      march_(device.programs().kernel(kMarch, "lpv_specular_march")) {}

Buffer& LpvSpecular::packed() {
    if (!keepsShown_) isShown_ = false;
    shown_.reserve(device_, cellBytes(size_), "cells of specular rays");
    if (keepsShown_) packed_.reserve(device_, cellBytes(size_), "cells of specular rays to come");
    return keepsShown_ ? packed_ : shown_;
}

void LpvSpecular::recordPackSteps(Executor& executor, const Buffer& injected, const Buffer& place, const Buffer* corners) {
    hasFaces_ = true;
    executor.run("lpv_specular.pack", packSteps_, cellsOf(size_), kCellGroup, injected, place, cl_int(size_),
                 corners ? *corners : injected, cl_int(corners ? 1 : 0), packed());
}

void LpvSpecular::recordPackSweep(Executor& executor, const LpvSweepSources& from, bool isAdded) {
    hasFaces_ = false;
    executor.run("lpv_specular.pack", packSweep_, cellsOf(size_), kCellGroup, from.sources, from.sheets, from.used, cl_int(size_),
                 cl_int(isAdded ? 1 : 0), packed());
}

void LpvSpecular::complete() {
    if (keepsShown_) std::swap(packed_, shown_);
    isShown_ = false;
}

void LpvSpecular::show(Executor& executor) {
    if (isShown_) return;
    const lw_int size = lw_int(size_);
    for (lw_int level = 1; level < specular_levels(size); ++level)
        executor.run("lpv_specular.halve", halve_, cellsOf(size_ >> level), kCellGroup, shown_, cl_int(specular_first(size, level - 1)),
                     cl_int(specular_first(size, level)), cl_int(size >> level));
    const std::size_t count = std::size_t(countOf(size_));
    closed_.reserve(device_, count * sizeof(cl_float4), "ways through cells of specular rays");
    for (Buffer& distances : distances_) distances.reserve(device_, count * sizeof(float), "empty cells of specular rays");
    executor.run("lpv_specular.ways", ways_, {count, 1}, {64, 1}, shown_, cl_int(count), closed_, distances_[0]);
    for (int axis = 0; axis < 3; ++axis)
        executor.run("lpv_specular.ways", distance_, {count, 1}, {64, 1}, distances_[axis % 2], cl_int(count), size, cl_int(axis),
                     cl_int(axis == 2 ? 1 : 0), closed_, distances_[1 - axis % 2]);
    isShown_ = true;
}

void LpvSpecular::recordMarch(Executor& executor, const Planes& position, const Planes& normal, const Planes& roughness,
                              const LwSpecularRays& view, const Buffer& place, const Planes& radiance, const Buffer& counts) {
    show(executor);
    const Range items{(position.width + march_.width() - 1) / march_.width(), position.height};
    // A kernel's argument must be some memory, also where it is not touched.
    executor.run("lpv_specular.march", march_, items, march_.width() == 1 ? Range{64, 1} : Range{8, 1}, position, normal,
                 roughness ? roughness : position, cl_int(roughness ? 1 : 0), cl_int(position.width), cl_int(position.height), view,
                 place, cl_int(size_), cl_int(hasFaces_ ? 1 : 0), shown_, closed_, radiance, counts);
}

void LpvSpecular::recordPick(Executor& executor, const Planes& position, const Planes& roughness, const Planes& halfPosition,
                             const Planes& halfRoughness) {
    executor.run("lpv_specular.pick", pick_, {halfPosition.width, halfPosition.height}, {16, 4}, position, roughness,
                 cl_int(position.width), cl_int(position.height), halfPosition, halfRoughness);
}

std::uint64_t LpvSpecular::bytes() const {
    return packed_.bytes() + shown_.bytes() + closed_.bytes() + distances_[0].bytes() + distances_[1].bytes();
}

std::uint64_t LpvSpecular::estimateBytes(std::uint32_t size, bool keepsShown) {
    return (keepsShown ? 2 : 1) * cellBytes(size) + countOf(size) * (sizeof(cl_float4) + 2 * sizeof(float));
}

}  // namespace lightwell
