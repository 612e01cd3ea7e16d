#include "inputs/points_input.h"

#include <optional>

#include "compute/device.h"
#include "compute/error.h"

namespace lightwell {
namespace {

constexpr std::uint32_t kPlanes = 3;

struct Field {
    const char* name;
    const ImageRole* role;
    Planes PointsInput::*planes;
};
const std::array<Field, 2> kFields = {
    {{"positions", &kPositionRole, &PointsInput::position}, {"normals", &kNormalRole, &PointsInput::normal}}};

using CheckedPoints = std::array<std::optional<CheckedImage>, 2>;

CheckedPoints checkPoints(Device& device, const LWImage& positions, const LWImage& normals, std::uint32_t count) {
    CheckedPoints checked;
    checked[0] = checkImage(device, positions, *kFields[0].role, count, 1, kFields[0].name);
    if (!imageAbsent(normals)) checked[1] = checkImage(device, normals, *kFields[1].role, count, 1, kFields[1].name);
    return checked;
}

}  // namespace

Planes PointRows::of(Planes list) const {
    if (!list) return list;
    list.offset += first;
    list.rowStride = kWidth;
    list.width = width;
    list.height = height;
    return list;
}

PointsInput::PointsInput() = default;

void PointsInput::check(Device& device, const LWImage& positions, const LWImage& normals, std::uint32_t count) {
    checkPoints(device, positions, normals, count);
}

void PointsInput::import(Executor& executor, const LWImage& positions, const LWImage& normals, std::uint32_t count) {
    Device& device = executor.device();
    const CheckedPoints checked = checkPoints(device, positions, normals, count);
    for (std::size_t f = 0; f < kFields.size(); ++f) {
        const Field& field = kFields[f];
        this->*field.planes = Planes{};
        opened_[f] = DeviceImage{};
        if (!checked[f]) continue;
        opened_[f] = openForReading(executor, *checked[f], *field.role, "points_input.upload", staging_[f]);
        DeviceImage& opened = opened_[f];
        if (!opened.planes) {
            if (capacity_[f] < count) {
                own_[f] = PlanarImage(device, count, 1, kPlanes, field.name);
                capacity_[f] = count;
            }
            opened.planes = own_[f].planes(count, 1);
            unpack(executor, "points_input.unpack", opened, opened.planes);
        }
        this->*field.planes = opened.planes;
    }
}

void PointsInput::recordCheck(Executor& executor, const Planes& validity, const Buffer& rejected) const {
    Device& device = executor.device();
    Kernel& kernel = device.programs().kernel("points_input/points_input", "points_input_check");
    eachPointRows(position.width, [&](const PointRows& rows) {
        const Planes p = rows.of(position), v = rows.of(validity);
        // A kernel's argument must be some memory, also where it is not touched.
        executor.run("points_input.check", kernel, rowGrid(device, rows.width, rows.height), rowGroup(device), p,
                     normal ? rows.of(normal) : p, cl_int(normal ? 1 : 0), cl_int(rows.width), cl_int(rows.height),
                     cl_int(v ? 1 : 0), v ? v : p, rejected);
    });
}

void PointsInput::report(Report& report) const {
    for (std::size_t f = 0; f < kFields.size(); ++f)
        if (opened_[f].planes) report.choose(kFields[f].name, opened_[f].choice);
}

std::uint64_t PointsInput::bytes() const {
    std::uint64_t total = 0;
    for (std::size_t f = 0; f < kFields.size(); ++f) total += own_[f].bytes() + staging_[f].bytes();
    return total;
}

std::uint64_t PointsInput::estimateBytes(std::uint32_t count, bool uploads) {
    std::uint64_t total = 0;
    for (const Field& field : kFields)
        total += kPlanes * sizeof(float) * std::uint64_t(paddedWidth(count)) +
                 (uploads ? std::uint64_t(largestPixelBytes(*field.role)) * count : 0);
    return total;
}

}  // namespace lightwell
