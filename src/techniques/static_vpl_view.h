// One view's part of technique static_vpl: one gather, or two where some of its pixels hold baked light,
// which other lights reach.
#pragma once

#include <optional>
#include <vector>

#include "passes/light_list.h"
#include "passes/receiver_split.h"
#include "techniques/interleaved_view.h"

namespace lightwell {

class StaticVplView {
public:
    StaticVplView(Device& device, const InterleavedOptions& options, const View& view);

    void render(Executor& executor, const View& view, const LWGBuffer& gbuffer, const LWOutput& output,
                InterleavedGather& gather, JointBilateral* bilateral, const LightList& list);

    void startFrame(bool forget);
    void report(Report& report, lw_subset_order order) const;
    void addDebugViews(std::vector<DebugView>& views) const { whole_.addDebugViews(views, nullptr); }
    std::uint64_t bytes() const;
    // The most for a view of this size; `order` of the list.
    static std::uint64_t estimateBytes(const InterleavedOptions& options, const LWViewDesc& view,
                                       const FrameShape& shape, lw_subset_order order);

private:
    // What pixels with baked light take, from their first frame on.
    struct Baked {
        Baked(Device& device, const InterleavedOptions& options, const View& owner);
        ReceiverSplit split;
        GBufferInput gbuffer;
        InterleavedView view;
        PlanarImage normals[2], irradiance[2], validity[2];
        OutputTarget irradianceOut, validityOut;
    };
    void gatherOf(Executor& executor, InterleavedView& state, const View& view, const LWGBuffer& gbuffer,
                  const LWOutput& output, InterleavedGather& gather, JointBilateral* bilateral,
                  const Buffer& vpls, lw_subset_order order);

    Device& device_;
    InterleavedOptions options_;
    InterleavedView whole_;
    std::optional<Baked> baked_;
};

}  // namespace lightwell
