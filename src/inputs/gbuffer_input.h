// A host's G-buffer as planar device images: used in place where the layout allows, unpacked otherwise.
#pragma once

#include <cstdint>
#include <memory>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/report.h"
#include "inputs/view.h"
#include "lightwell/lightwell.h"

namespace lightwell {

// Which images a technique reads; others are neither checked nor touched. Position and normal always.
// Albedo, direct radiance and roughness must then be given; motion and masks may be absent (empty
// planes).
enum GBufferNeeds : std::uint32_t {
    kNeedsAlbedo = 1,
    kNeedsDirectRadiance = 2,
    kNeedsRoughness = 4,
    kNeedsMotion = 8,
    kNeedsReceiveMask = 16,
    kNeedsBakedMask = 32
};

class GBufferInput {
public:
    GBufferInput();
    ~GBufferInput();
    GBufferInput(GBufferInput&&) noexcept;
    GBufferInput& operator=(GBufferInput&&) noexcept;

    // Throws what import() would say of these images.
    static void check(Device& device, const View& view, const LWGBuffer& gbuffer, std::uint32_t needs,
                      const char* name);
    // Records the unpacking (passes "gbuffer_input.*") and sets the planes below for this frame.
    // `name` begins every error, e.g. "gbuffer". Throws INVALID_ARGUMENT naming field, expected, got.
    void import(Executor& executor, const View& view, const LWGBuffer& gbuffer, std::uint32_t needs,
                const char* name);

    Planes position, normal, albedo, directRadiance, roughness, motion, receiveMask, bakedMask;

    void report(Report& report) const;  // one choice per image: in place, or unpacked from what
    std::uint64_t bytes() const;
    // The most that bytes() becomes for a view, whatever formats the host hands over (without gaps between
    // pixels and rows). `uploads`: FrameShape::uploads.
    static std::uint64_t estimateBytes(const LWViewDesc& view, std::uint32_t needs, bool uploads);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace lightwell
