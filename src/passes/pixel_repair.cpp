#include "passes/pixel_repair.h"

#include "compute/device.h"
#include "passes/vpl_list.h"
#include "shared/pixel_repair_types.h"

namespace lightwell {
namespace {

constexpr const char* kProgram = "pixel_repair/pixel_repair";
constexpr std::uint32_t kCountWords = 4;  // as an interleaved view's
constexpr Range kRowGroup{4, 1}, kPlaceGroup{64, 1};

// Words of marks, of so many lanes.
std::uint64_t wordsOver(std::uint32_t width, std::uint32_t height, std::uint32_t lanes) {
    return std::uint64_t((width + 2 * lanes - 1) / (2 * lanes)) * height;
}

}  // namespace

std::uint32_t RepairedPixels::listedRows(std::uint32_t width, std::uint32_t height) {
    return (room(width, height) + LW_REPAIR_COLUMNS - 1) / LW_REPAIR_COLUMNS;
}

RepairedPixels::RepairedPixels(Device& device, std::uint32_t maxWidth, std::uint32_t maxHeight)
    : position_(device, LW_REPAIR_COLUMNS, listedRows(maxWidth, maxHeight), 3, "positions of marked pixels"),
      normal_(device, LW_REPAIR_COLUMNS, listedRows(maxWidth, maxHeight), 3, "normals of marked pixels"),
      light_(device, LW_REPAIR_COLUMNS, listedRows(maxWidth, maxHeight), 3, "light of marked pixels"),
      marks_(device, std::size_t(wordsOver(maxWidth, maxHeight, device.width())) * sizeof(cl_uint), "marks of pixels"),
      rows_(device, maxHeight * sizeof(cl_int), "marked pixels of rows"),
      pixels_(device, room(maxWidth, maxHeight) * sizeof(cl_int), "marked pixels"),
      state_(device, LW_REPAIR_WORDS * sizeof(cl_int), "numbers of marked pixels"),
      counts_(device, kCountWords * sizeof(cl_int), "counts of marked pixels") {}

Planes RepairedPixels::listed(const PlanarImage& image, std::uint32_t width, std::uint32_t height) {
    return image.planes(LW_REPAIR_COLUMNS, listedRows(width, height));
}

void RepairedPixels::report(Device& device, Report& report) const {
    report.read(device, "repaired_pixels", state_, LW_REPAIR_TAKEN * sizeof(cl_int));
    report.read(device, "unrepaired_pixels", state_, LW_REPAIR_LEFT * sizeof(cl_int));
}

std::uint64_t RepairedPixels::bytes() const {
    return position_.bytes() + normal_.bytes() + light_.bytes() + marks_.bytes() + rows_.bytes() + pixels_.bytes() + state_.bytes() +
           counts_.bytes();
}

std::uint64_t RepairedPixels::estimateBytes(std::uint32_t maxWidth, std::uint32_t maxHeight) {
    const std::uint64_t listed = std::uint64_t(LW_REPAIR_COLUMNS) * listedRows(maxWidth, maxHeight);
    return sizeof(float) * 9 * listed +
           sizeof(cl_int) * (wordsOver(maxWidth, maxHeight, 1) + maxHeight + room(maxWidth, maxHeight) + LW_REPAIR_WORDS + kCountWords);
}

PixelRepair::PixelRepair(Device& device)
    : count_(device.programs().kernel(kProgram, "pixel_repair_count")),
      share_(device.programs().kernel(kProgram, "pixel_repair_share")),
      collect_(device.programs().kernel(kProgram, "pixel_repair_collect")),
      put_(device.programs().kernel(kProgram, "pixel_repair_put")),
      show_(device.programs().kernel(kProgram, "pixel_repair_show")) {}

void PixelRepair::recordCollect(Executor& executor, const Planes& position, const Planes& normal, const RepairedPixels& memory) {
    const std::uint32_t width = position.width, height = position.height;
    const Buffer& normals = memory.normal_.buffer();
    executor.fill("pixel_repair.collect", normals, 0, 0, normals.bytes());
    executor.fill("pixel_repair.collect", memory.counts_, 0, 0, memory.counts_.bytes());
    executor.run("pixel_repair.collect", count_, {height, 1}, kRowGroup, memory.marks_, cl_int(width), cl_int(height), memory.rows_);
    executor.run("pixel_repair.collect", share_, {1, 1}, {1, 1}, memory.rows_, cl_int(height),
                 cl_int(RepairedPixels::room(width, height)), memory.state_);
    executor.run("pixel_repair.collect", collect_, {height, 1}, kRowGroup, memory.marks_, position, normal, cl_int(width), cl_int(height),
                 memory.rows_, memory.state_, memory.pixels_, memory.position(width, height), memory.normal(width, height));
}

void PixelRepair::recordPut(Executor& executor, const RepairedPixels& memory, const Planes& irradiance) {
    const std::uint32_t width = irradiance.width, height = irradiance.height;
    executor.run("pixel_repair.put", put_, gridOver(RepairedPixels::room(width, height)), kPlaceGroup, memory.state_, memory.pixels_,
                 memory.light(width, height), irradiance);
}

void PixelRepair::recordMarks(Executor& executor, const RepairedPixels& memory, const Planes& marks) {
    executor.run("pixel_repair.marks", show_, {(marks.width + show_.width() - 1) / show_.width(), marks.height}, kPlaceGroup, memory.marks_,
                 cl_int(marks.width), cl_int(marks.height), marks);
}

}  // namespace lightwell
