// What technique lpv keeps of a view: light read at every pixel, or at every second column and row and up-sampled.
#pragma once

#include <optional>
#include <vector>

#include "inputs/gbuffer_input.h"
#include "inputs/output_target.h"
#include "passes/joint_bilateral.h"
#include "techniques/lpv_specular_view.h"
#include "techniques/lpv_volume.h"
#include "techniques/technique.h"

namespace lightwell {

class LpvView {
public:
    LpvView(Device& device, const View& view, bool half);

    void startFrame() { isRendered_ = false; }
    // bilateral: of three channels, with half resolution only.
    void render(Executor& executor, const View& view, const LWGBuffer& gbuffer, const LWOutput& output, JointBilateral* bilateral,
                LpvVolume& volume, const std::optional<LwSpecularRays>& rays);

    static void startReport(Report& report);
    void report(Device& device, Report& report) const;
    void addDebugViews(std::vector<DebugView>& views) const;
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(const LWViewDesc& view, bool half, bool uploads);

private:
    void lightHalf(Executor& executor, const Planes& irradiance, const Planes& validity, const LpvHalfSurfaces& half,
                   LpvVolume& volume);

    bool half_, isRendered_ = false, isGathered_ = false;
    GBufferInput gbuffer_;
    OutputTarget irradiance_, validity_;
    LpvSpecularView specular_;
    PlanarImage halfPosition_, halfNormal_, halfLight_;
    // Of pixels that light was read at, of those that it was up-sampled for, and of what validity found meanwhile, which is not
    // reported: each image must not be counted twice.
    Buffer counts_, upsampleCounts_, validityCounts_;
    Planes lastHalf_;  // of this frame, where there is one
};

}  // namespace lightwell
