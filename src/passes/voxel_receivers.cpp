#include "passes/voxel_receivers.h"

#include <cstddef>

#include "compute/device.h"
#include "passes/vpl_list.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "voxel_light/voxel_receivers";
constexpr std::size_t kRun = 64;  // RECEIVER_RUN of the kernels
constexpr Range kListGroup{16, 1};
constexpr Range kBrickGroup{4, 1};
// How far off its last place, in voxels, a grid is the same one where the origin of positions has moved: what that rounds. More: a grid
// that moves as well hears what another place has heard.
constexpr float kSamePlace = 0.01f;

std::size_t bricksOf(std::uint32_t size) {
    return std::size_t(voxel_table(cl_int(size), 1));
}
std::uint32_t roomOf(std::uint32_t slots) {
    const std::uint32_t rows =
        (slots * VoxelReceivers::kPerSlot + VoxelReceivers::kRow - 1) / VoxelReceivers::kRow;
    return rows * VoxelReceivers::kRow;
}

}  // namespace

VoxelReceivers::VoxelReceivers(Device& device, std::uint32_t size)
    : device_(device),
      size_(size),
      count_(device.programs().kernel(kProgram, "voxel_receivers_count")),
      scan_(device.programs().kernel(kProgram, "voxel_receivers_scan")),
      list_(device.programs().kernel(kProgram, "voxel_receivers_list")),
      end_(device.programs().kernel(kProgram, "voxel_receivers_end")),
      hear_(device.programs().kernel(kProgram, "voxel_receivers_hear")) {}

void VoxelReceivers::record(Executor& executor, const VoxelSurfaces& surfaces, const Buffer& place,
                            const VoxelMips& mips, VoxelLight& light) {
    const bool isNew = surfaces.slots != slots_;
    if (isNew) {
        const std::uint32_t room = roomOf(surfaces.slots);
        counts_.reserve(device_, bricksOf(size_) * sizeof(cl_int), "counts of voxels that hear");
        before_.reserve(device_, bricksOf(size_) * sizeof(cl_int), "slots of voxels that hear");
        points_.reserve(device_, std::size_t(room) * 6 * sizeof(cl_float), "voxels that hear");
        gathered_.reserve(device_, std::size_t(room) * 3 * sizeof(cl_float),
                          "light at voxels that hear");
        voxels_.reserve(device_, std::size_t(room) * sizeof(cl_int), "numbers of voxels that hear");
        place_.reserve(device_, sizeof(cl_float4), "place of voxels that hear");
        state_.reserve(device_, sizeof(LwVoxelReceivers), "counts of voxels that hear");
        for (const Buffer* buffer : {&before_, &points_, &gathered_, &place_, &state_})
            executor.fill("voxel_light.clear", *buffer, 0, 0, buffer->bytes());
        room_ = room;
        slots_ = surfaces.slots;
    }
    const bool moves = kept_.moves(executor);
    if (moves) kept_.move(executor, place_, {});
    kept_.arrive(executor);
    light.reserveHeard(executor, surfaces.slots);
    LwVoxelContents contents{};
    contents.size = cl_int(size_);
    contents.slots = cl_int(surfaces.slots);
    const Range bricks = gridOver(bricksOf(size_));
    const char* pass = "voxel_light.receivers";
    executor.run(pass, count_, bricks, kBrickGroup, contents, surfaces.bricks, surfaces.surfaces,
                 mips.work(), counts_);
    executor.run(pass, scan_, {1, 1}, {1, 1}, place, place_, cl_int(bricksOf(size_)), cl_int(room_),
                 cl_int(isNew ? 1 : 0), cl_float(moves ? kSamePlace : 0.0f), mips.work(), counts_, state_);
    executor.run(pass, list_, bricks, kBrickGroup, place, contents, surfaces.bricks, surfaces.surfaces,
                 mips.work(), counts_, cl_int(room_), state_, before_, light.irradiance(), points_,
                 voxels_);
    executor.run(pass, end_, gridOver((room_ + kRun - 1) / kRun), kListGroup, cl_int(room_), mips.work(),
                 state_, points_);
}

void VoxelReceivers::recordHeard(Executor& executor, VoxelLight& light) {
    executor.run("voxel_light.hear", hear_, gridOver((room_ + kRun - 1) / kRun), kListGroup, gathered_,
                 cl_int(room_), state_, voxels_, cl_int(slots_ * LW_VOXEL_BRICK_VOXELS),
                 light.irradiance(), light.touched());
}

Planes VoxelReceivers::planesFrom(const Buffer& memory, std::uint32_t plane) const {
    Planes planes;
    planes.memory = memory.get();
    planes.offset = std::int64_t(plane) * room_;
    planes.rowStride = kRow;
    planes.planeStride = room_;
    planes.width = kRow;
    planes.height = room_ / kRow;
    planes.count = 3;
    return planes;
}

void VoxelReceivers::report(Device& device, Report& report) const {
    if (!state_) return;
    report.read(device, "voxel_receivers", state_, offsetof(LwVoxelReceivers, receivers));
    report.read(device, "missing_receivers", state_, offsetof(LwVoxelReceivers, missing));
}

std::uint64_t VoxelReceivers::bytes() const {
    return counts_.bytes() + before_.bytes() + points_.bytes() + gathered_.bytes() + voxels_.bytes() +
           place_.bytes() + state_.bytes();
}

std::uint64_t VoxelReceivers::estimateBytes(std::uint32_t size, std::uint32_t slots) {
    return 2 * bricksOf(size) * sizeof(cl_int) + std::uint64_t(roomOf(slots)) * 10 * sizeof(cl_float) +
           sizeof(cl_float4) + sizeof(LwVoxelReceivers);
}

}  // namespace lightwell
