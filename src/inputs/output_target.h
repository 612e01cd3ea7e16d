// Where a technique's result planes go: the host's image in place, or packed into its format.
#pragma once

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

// Of a technique that makes irradiance and validity, and radiance along glossy lobes where makesSpecular: throws what lwRender says
// of other outputs, of none, and of bad ones.
void checkLightOutputs(Device& device, const View& view, const LWOutput& output, const char* technique, bool makesSpecular = false);

}  // namespace lightwell
