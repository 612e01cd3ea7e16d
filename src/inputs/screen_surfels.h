// What a frame's images show, as surfels: the texels of its RSMs and the pixels of its source views.
#pragma once

#include <cstdint>
#include <vector>

#include "compute/executor.h"
#include "compute/report.h"
#include "inputs/frame_shape.h"
#include "inputs/gbuffer_input.h"
#include "inputs/rsm_input.h"
#include "inputs/surfel_set.h"
#include "lightwell/lightwell.h"

namespace lightwell {

class ScreenSurfels {
public:
    // Throws what import() would say of this frame's source views.
    static void check(Device& device, const LWFrame& frame);

    // Passes "surfel_input.*" and "gbuffer_input.*". `rsms`: this frame's, imported. Every texel and pixel with a surface
    // is one, but texels within a finer cascade, which has its own, and pixels without a neighbour on their surface, whose
    // area nobody knows. Albedo: of texels, reflected flux over what the light's description says arrives; of pixels, the
    // G-buffer's; where these are absent LW_UNKNOWN_ALBEDO. Surfels change with every frame.
    void import(Executor& executor, const LWFrame& frame, const RsmInput& rsms);
    // Lets go of the last frame's images.
    void clear() { views_.clear(); }

    SurfelSet surfels() const { return memory_.set(); }
    void report(Report& report) const;  // surfels, rejected_surfels
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(const FrameShape& shape);

private:
    void drawTexels(Executor& executor, const LWFrame& frame, const RsmInput& rsms);
    void drawPixels(Executor& executor, const GBufferInput& pixels, bool hasAlbedo, std::uint32_t first);

    SurfelMemory memory_;
    std::vector<GBufferInput> views_;
    Device* device_ = nullptr;  // of the last import
};

}  // namespace lightwell
