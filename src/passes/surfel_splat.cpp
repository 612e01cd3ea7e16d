#include "passes/surfel_splat.h"

#include <algorithm>
#include <cmath>

#include "compute/device.h"
#include "compute/error.h"
#include "shared/paraboloid_map_types.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "surfel_splat/surfel_splat";

// Groups side by side, at most: well below 65,535, from which on drivers may compile anew (Kernel::noteLaunch). Work-items take
// several blocks then.
constexpr std::size_t kMostGroups = 1u << 15;

// Blocks of very different cost make a group on a CPU, where each group costs little.
Range drawGroup(const Device& device) { return {device.width() == 1 ? std::size_t(64) : std::size_t(1), 1}; }

std::uint64_t blocksOf(std::uint64_t surfels) { return (surfels + LW_SURFEL_BLOCK - 1) / LW_SURFEL_BLOCK; }

// Words of the candidates of one map. At least one: a kernel's argument must be some memory.
std::uint64_t wordsOf(std::uint64_t surfels) { return std::max<std::uint64_t>(blocksOf(surfels), 1); }

}  // namespace

SurfelSplat::SurfelSplat(Device& device)
    : device_(device),
      clear_(device.programs().kernel(kProgram, "surfel_splat_clear")),
      depth_(device.programs().kernel(kProgram, "surfel_splat_depth")),
      normal_(device.programs().kernel(kProgram, "surfel_splat_normal")),
      albedo_(device.programs().kernel(kProgram, "surfel_splat_albedo")),
      resolve_(device.programs().kernel(kProgram, "surfel_splat_resolve")) {}

void SurfelSplat::record(Executor& executor, const SurfelSet& surfels, const MapTexels& maps) {
    if (maps.mapCount == 0) return;
    candidates_.reserve(device_, std::size_t(estimateBytes(surfels.count, maps.mapCount)), "candidates of surfels");
    const std::size_t texels = std::size_t(maps.size) * maps.size;
    const Range every{texels, maps.mapCount}, group{64, 1};
    executor.run("surfel_splat.clear", clear_, every, group, maps.states, cl_int(texels), maps.albedo);
    if (surfels.planes) {
        // Those that a map leaves out are as many times the others' share.
        const double share = std::min(1.0, double(mostSurfels(maps.size)) / double(surfels.count));
        const cl_uint threshold = share < 1.0 ? cl_uint(share * 4294967295.0) : 0xffffffffu;
        const cl_float scale = cl_float(std::sqrt(1.0 / share));
        const auto blocks = std::size_t(blocksOf(surfels.count));
        const Range grid{std::min(blocks, kMostGroups * drawGroup(device_)[0]), (maps.mapCount + LW_MAPS_PER_ITEM - 1) / LW_MAPS_PER_ITEM};
        const auto sweep = [&](const char* pass, Kernel& kernel) {
            executor.run(pass, kernel, grid, drawGroup(device_), surfels.planes.memory, cl_int(surfels.planes.planeStride),
                         cl_int(blocks), maps.frames, maps.states, cl_int(maps.mapCount), cl_int(maps.size), threshold, scale,
                         maps.records, maps.albedo, candidates_);
        };
        sweep("surfel_splat.depth", depth_);
        sweep("surfel_splat.normal", normal_);
        sweep("surfel_splat.albedo", albedo_);
    }
    executor.run("surfel_splat.resolve", resolve_, every, group, maps.states, cl_int(texels), maps.records, maps.albedo);
}

std::uint64_t SurfelSplat::estimateBytes(std::uint64_t surfelCount, std::uint32_t clusterCount) {
    const std::uint64_t words = wordsOf(surfelCount) * std::max(clusterCount, 1u);
    if (words > 0x7fffffffu)
        fail(LW_ERROR_UNSUPPORTED, "surfels: ", surfelCount, " of them on ", clusterCount,
             " maps exceed the 32-bit indices of the kernels");
    return words * sizeof(cl_uint);
}

}  // namespace lightwell
