#include "passes/voxel_light.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "compute/device.h"
#include "passes/vpl_list.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "voxel_light/voxel_light";
constexpr const char* kTexels = "voxel_light/voxel_texels";
constexpr const char* kResolve = "voxel_light/voxel_resolve";
constexpr std::size_t kRun = 64;  // LIGHT_RUN of the kernels
constexpr Range kListGroup{16, 1};
constexpr Range kBrickGroup{4, 1};

std::size_t bricksOf(std::uint32_t size) {
    return std::size_t(voxel_table(cl_int(size), 1));
}
std::size_t planeBytes(std::uint32_t slots) {
    return std::size_t(slots) * LW_VOXEL_BRICK_VOXELS * sizeof(cl_float);
}

// Directions matter where words tell sides apart by what faces them.
cl_int planesOf(LWVoxelMode mode, bool sides) {
    return mode == LW_VOXEL_MODE_SH2 || sides ? LW_VOXEL_LIGHT_PLANES : LW_LIGHT_DIRECTION;
}

}  // namespace

VoxelLight::VoxelLight(Device& device, std::uint32_t size, std::uint32_t cascade)
    : device_(device),
      size_(size),
      cascade_(cascade),
      locate_(device.programs().kernel(kTexels, "voxel_light_locate")),
      sort_(device.programs().kernel(kTexels, "voxel_light_sort")),
      settle_(device.programs().kernel(kProgram, "voxel_light_settle")),
      unit_(device.programs().kernel(kProgram, "voxel_light_unit")),
      resolve_(device.programs().kernel(kResolve, "voxel_resolve")) {}

void VoxelLight::reserveHeard(Executor& executor, std::uint32_t slots) {
    if (irradiance_.bytes() >= 3 * planeBytes(slots)) return;
    irradiance_.reserve(device_, 3 * planeBytes(slots), "light that has come to voxels");
    executor.fill("voxel_light.clear", irradiance_, 0, 0, irradiance_.bytes());
}

void VoxelLight::reserve(Executor& executor, std::uint32_t slots, std::size_t texels,
                         const LwVoxelContents& contents) {
    if (!state_) {
        state_ = Buffer(device_, sizeof(LwVoxelTexels), "texels in voxels");
        largest_ = Buffer(device_, bricksOf(size_) * sizeof(cl_float), "brightest voxels of bricks");
        executor.fill("voxel_light.clear", largest_, 0, 0, largest_.bytes());
    }
    executor.fill("voxel_light.clear", state_, 0, 0, offsetof(LwVoxelTexels, first));
    if (contents.feedback) reserveHeard(executor, slots);
    if (isKept_) return;
    const std::size_t kept = std::max<std::size_t>(texels, 1);  // kernels take some memory
    records_.reserve(device_, kept * std::size_t(voxel_record(contents.planes)) * sizeof(cl_uint),
                     "texels in voxels");
    order_.reserve(device_, kept * sizeof(cl_int), "order of texels in voxels");
    ends_.reserve(device_, slots * LW_LIGHT_ROWS * sizeof(cl_int), "order of texels in voxels");
    lit_.reserve(device_, slots * LW_LIGHT_LIT_WORDS * sizeof(cl_uint), "voxels that hold light");
    light_.reserve(device_, std::size_t(contents.planes) * planeBytes(slots), "light in voxels");
    touched_.reserve(device_, slots * sizeof(cl_int), "bricks whose light changes");
    for (const Buffer* buffer : {&records_, &lit_, &light_, &touched_, &state_})
        executor.fill("voxel_light.clear", *buffer, 0, 0, buffer->bytes());
    slots_ = slots;
    texels_ = texels;
}

void VoxelLight::record(Executor& executor, const RsmInput& rsms, const VoxelSurfaces& surfaces,
                        const Buffer& place, const VoxelMips& mips, const VoxelVolume& volume,
                        cl_int aware, bool hears) {
    LwVoxelContents contents{};
    contents.mode = cl_int(volume.mode);
    contents.sides = volume.sides ? 1 : 0;
    contents.aware = aware;
    contents.feedback = hears ? 1 : 0;
    contents.size = cl_int(size_);
    contents.slots = cl_int(surfaces.slots);
    contents.planeWords = cl_int(volume.baseSlots * LW_VOXEL_STRIDE);
    contents.planes = planesOf(volume.mode, volume.sides);
    const std::size_t texels = rsms.texels ? rsms.texels.width : 0;
    const bool isSame =
        isKept_ && texels == texels_ && std::memcmp(&contents, &contents_, sizeof contents) == 0;
    if (!isSame) isKept_ = false;  // until all is enqueued
    reserve(executor, surfaces.slots, texels, contents);
    contents_ = contents;
    isKept_ = false;

    constexpr std::size_t kFrame =
        offsetof(LwVoxelState, largest);  // and what follows: of this frame alone
    executor.fill("voxel_light.clear", volume.state, 0, cascade_ * sizeof(LwVoxelState) + kFrame,
                  sizeof(LwVoxelState) - kFrame);
    if (texels) {
        executor.run("voxel_light.inject", locate_, gridOver((texels + kRun - 1) / kRun), kListGroup,
                     rsms.texels, cl_int(texels), place, contents, surfaces.bricks, surfaces.surfaces,
                     records_, touched_, state_);
        executor.run("voxel_light.inject", sort_, {LW_LIGHT_ROWS, 1}, {1, 1}, place, contents,
                     cl_int(texels), records_, touched_, state_, ends_, order_);
    }
    const Buffer& heard = hears ? irradiance_ : light_;  // a kernel's argument must be some memory
    const Range bricks = gridOver(bricksOf(size_));
    executor.run("voxel_light.settle", settle_, bricks, kBrickGroup, place, contents,
                 cl_int(isSame ? 0 : 1), surfaces.bricks, surfaces.surfaces, surfaces.changed,
                 surfaces.state, state_, cl_int(texels), records_, order_, ends_, lit_, touched_, light_, heard, largest_, mips.marks(), volume.state,
                 cl_int(cascade_));
    executor.run("voxel_light.settle", unit_, {1, 1}, {1, 1}, place, state_, volume.state,
                 cl_int(cascade_), mips.work());
    executor.run("voxel_light.resolve", resolve_, bricks, kBrickGroup, place, contents, surfaces.bricks,
                 surfaces.surfaces, surfaces.state, light_, heard, volume.table,
                 cl_int(cascade_ * volume.tableSize()), mips.work(), volume.state, cl_int(cascade_),
                 mips.marks(), volume.base);
    isKept_ = true;
}

void VoxelLight::report(Device& device, Report& report) const {
    if (!state_) return;
    report.read(device, "outside_texels", state_, offsetof(LwVoxelTexels, outside));
    report.read(device, "lost_texels", state_, offsetof(LwVoxelTexels, lost));
}

std::uint64_t VoxelLight::bytes() const {
    std::uint64_t total = 0;
    for (const Buffer* buffer : {&records_, &order_, &ends_, &lit_, &light_, &irradiance_, &touched_,
                                 &largest_, &state_})
        total += buffer->bytes();
    return total;
}

std::uint64_t VoxelLight::estimateBytes(std::uint32_t size, LWVoxelMode mode, bool sides, bool hears,
                                        std::uint32_t slots, std::uint64_t texels) {
    const cl_int planes = planesOf(mode, sides);
    const std::uint64_t words = 1 + LW_LIGHT_ROWS + LW_LIGHT_LIT_WORDS;  // a slot's
    return (std::uint64_t(planes) + (hears ? 3 : 0)) * planeBytes(slots) +
           slots * words * sizeof(cl_int) +
           std::max<std::uint64_t>(texels, 1) * std::uint64_t(voxel_record(planes) + 1) * sizeof(cl_uint) +
           bricksOf(size) * sizeof(cl_float) + sizeof(LwVoxelTexels);
}

}  // namespace lightwell
