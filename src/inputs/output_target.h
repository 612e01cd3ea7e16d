// Where a technique's result planes go: the host's image in place, or packed into its format.
#pragma once

#include <cstdint>
#include <memory>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/report.h"
#include "inputs/view.h"
#include "lightwell/lightwell.h"

namespace lightwell {

class OutputTarget {
public:
    OutputTarget();
    ~OutputTarget();
    OutputTarget(OutputTarget&&) noexcept;
    OutputTarget& operator=(OutputTarget&&) noexcept;

    // Throws what begin() would say of this image, and changes nothing: a frame with a bad output must be
    // refused before its other images are imported.
    static void check(Device& device, const View& view, const LWImage& image, std::uint32_t planeCount,
                      const char* name);
    // The planes that kernels write for `image` (1 or 3): the host's own memory where its layout allows,
    // else an image of ours. Empty when the format is LW_FORMAT_NONE. `name`: "output.irradiance" ...
    Planes begin(Executor& executor, const View& view, const LWImage& image, std::uint32_t planeCount,
                 const char* name);
    // Packs (pass "output.pack"), copies or publishes what kernels wrote since begin().
    void end(Executor& executor);

    void report(Report& report) const;
    std::uint64_t bytes() const;
    // The most that bytes() becomes for a view, whatever format the host asks for (without gaps). `uploads`:
    // FrameShape::uploads.
    static std::uint64_t estimateBytes(const LWViewDesc& view, std::uint32_t planeCount, bool uploads);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

// Images of LWOutput that not every technique makes.
enum OutputKinds : std::uint32_t { kMakesAmbient = 1, kMakesSpecular = 2, kMakesRefracted = 4, kMakesShadow = 8 };

// Of a technique that makes irradiance, validity and `kinds`: throws what lwRender says of other outputs, of none, and of bad ones.
void checkLightOutputs(Device& device, const View& view, const LWOutput& output, const char* technique, std::uint32_t kinds = 0);

}  // namespace lightwell
