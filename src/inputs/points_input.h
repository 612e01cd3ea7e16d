// A host's list of points as planar device images: used in place where the layout allows, unpacked otherwise.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/report.h"
#include "inputs/image_access.h"
#include "lightwell/lightwell.h"

namespace lightwell {

// A part of a list of points as an image, which is what kernels take: in rows that lie one after the other. Rows of a few hundred
// points keep those that a tile of pixels would hold together within a few thousand of the list.
struct PointRows {
    static constexpr std::uint32_t kWidth = 256, kMostRows = 4096;
    std::uint32_t first, width, height;
    // Of planes of the list.
    Planes of(Planes list) const;
};
// All of a list: parts of whole rows, so many that what a gather keeps of a part stays small; then what is left of one.
template <class Visit>
void eachPointRows(std::uint32_t count, Visit visit) {
    constexpr std::uint32_t kMost = PointRows::kWidth * PointRows::kMostRows;
    const std::uint32_t whole = count / PointRows::kWidth * PointRows::kWidth;
    for (std::uint32_t first = 0; first < whole; first += kMost)
        visit(PointRows{first, PointRows::kWidth, std::min(whole - first, kMost) / PointRows::kWidth});
    if (whole < count) visit(PointRows{whole, count - whole, 1});
}

class PointsInput {
public:
    // In one row of work-groups that drivers launch as they launch few (Kernel::noteLaunch), where a work-item is a point.
    static constexpr std::uint32_t kMost = 65535 * 64;

    PointsInput();

    // Throws what import() would say of these images; `normals` may be absent.
    static void check(Device& device, const LWImage& positions, const LWImage& normals, std::uint32_t count);
    // Records the unpacking (passes "points_input.upload", ".unpack") and sets the planes below, of count x 1 points.
    void import(Executor& executor, const LWImage& positions, const LWImage& normals, std::uint32_t count);

    Planes position, normal;  // normal: empty where there are none

    // Pass "points_input.check", after import(): validity, where wanted, is 1 at points within reach with a normal that can be
    // normalised, where there are normals; rejected[0] (an int) grows by the others.
    void recordCheck(Executor& executor, const Planes& validity, const Buffer& rejected) const;

    void report(Report& report) const;
    std::uint64_t bytes() const;
    // The most that bytes() becomes for so many points. `uploads`: FrameShape::uploads.
    static std::uint64_t estimateBytes(std::uint32_t count, bool uploads);

private:
    std::array<PlanarImage, 2> own_;
    std::array<DeviceImage, 2> opened_;  // keeps memory used in place alive
    std::array<Buffer, 2> staging_;      // uploads
    std::array<std::uint32_t, 2> capacity_{};
};

}  // namespace lightwell
