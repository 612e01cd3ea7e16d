// Single pixels of a picture lit by themselves: those that an up-sampling has marked are put side by side into a small image, which
// any gather can light, and their light is put back (kernels/pixel_repair).
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/report.h"

namespace lightwell {

// A view's memory for it.
class RepairedPixels {
public:
    // One of so many pixels can be repaired. More of them: a picture of marks alone takes as long as two. Fewer: what no half
    // resolution gets right, such as grass, keeps the light of its neighbours.
    static constexpr std::uint32_t kOneOf = 32;

    RepairedPixels(Device& device, std::uint32_t maxWidth, std::uint32_t maxHeight);

    // For an up-sampling to mark what shall be repaired, a bit a pixel (LW_REPAIR_BITS). All for a picture of one size.
    const Buffer& marks() const { return marks_; }
    static std::uint32_t room(std::uint32_t width, std::uint32_t height) {
        return std::uint32_t((std::uint64_t(width) * height + kOneOf - 1) / kOneOf);
    }
    static std::uint32_t listedRows(std::uint32_t width, std::uint32_t height);
    // The small image, as large as there is room: surfaces, without a normal where there is none, and their light; 3 planes each.
    Planes position(std::uint32_t width, std::uint32_t height) const { return listed(position_, width, height); }
    Planes normal(std::uint32_t width, std::uint32_t height) const { return listed(normal_, width, height); }
    Planes light(std::uint32_t width, std::uint32_t height) const { return listed(light_, width, height); }
    const Buffer& counts() const { return counts_; }  // of the small image, as InterleavedGather counts; not reported
    // "repaired_pixels", and "unrepaired_pixels" that there was no room for.
    void report(Device& device, Report& report) const;
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(std::uint32_t maxWidth, std::uint32_t maxHeight);

private:
    friend class PixelRepair;
    static Planes listed(const PlanarImage& image, std::uint32_t width, std::uint32_t height);

    PlanarImage position_, normal_, light_;
    Buffer marks_, rows_, pixels_, state_, counts_;
};

class PixelRepair {
public:
    explicit PixelRepair(Device& device);

    // Passes "pixel_repair.collect": the marked pixels' surfaces become the small image.
    void recordCollect(Executor& executor, const Planes& position, const Planes& normal, const RepairedPixels& memory);
    // Pass "pixel_repair.put": the small image's light becomes theirs in `irradiance`.
    void recordPut(Executor& executor, const RepairedPixels& memory, const Planes& irradiance);
    // Pass "pixel_repair.marks": 1 at marked pixels of a picture of this size, 0 elsewhere.
    void recordMarks(Executor& executor, const RepairedPixels& memory, const Planes& marks);

private:
    Kernel &count_, &share_, &collect_, &put_, &show_;
};

}  // namespace lightwell
