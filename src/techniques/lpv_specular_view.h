// What technique lpv keeps of a view for radiance along glossy lobes: marched at every pixel, or at every second column and row and
// up-sampled.
#pragma once

#include <optional>
#include <vector>

#include "inputs/gbuffer_input.h"
#include "inputs/output_target.h"
#include "passes/joint_bilateral.h"
#include "passes/lpv_specular.h"
#include "techniques/lpv_volume.h"
#include "techniques/technique.h"

namespace lightwell {

// A view's surfaces at half resolution; nothing at full.
struct LpvHalfSurfaces {
    const Planes &position, &normal;
    JointBilateral* bilateral;
};

class LpvSpecularView {
public:
    // Of pixels without a roughness image: neither a mirror nor matt.
    static constexpr float kRoughness = 0.5f;

    // None where the output is not asked for. Throws what a camera that rays cannot come from is told.
    static std::optional<LwSpecularRays> rays(const View& view, const LWGBuffer& gbuffer, const LWOutput& output,
                                              const float* environment);
    // GBufferNeeds of a frame with rays.
    static std::uint32_t needs(const LWGBuffer& gbuffer);

    // `half`: null at full resolution.
    void render(Executor& executor, const View& view, const LWOutput& output, const GBufferInput& gbuffer, const LwSpecularRays& rays,
                LpvVolume& volume, const LpvHalfSurfaces* half);
    void skip() { isRendered_ = false; }

    static void startReport(Report& report);
    // isAlone: no other output has counted the pixels.
    void report(Device& device, Report& report, bool isAlone) const;
    void addDebugViews(std::vector<DebugView>& views) const;
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(const LWViewDesc& view, bool half, bool uploads);

private:
    void reserve(Device& device, const View& view, bool half);

    bool half_ = false, isRendered_ = false;
    OutputTarget output_;
    PlanarImage halfRadiance_, halfRoughness_;
    Buffer counts_, upsampleCounts_;
    Planes marched_;  // of this frame
};

}  // namespace lightwell
