// One view's part of technique static_vpl: one gather, or two where some of its pixels hold baked light,
// which other lights reach.
#pragma once

#include <optional>
#include <vector>

#include "passes/light_list.h"
#include "passes/receiver_split.h"
#include "techniques/interleaved_view.h"
#include "techniques/static_vpl_shadows.h"

namespace lightwell {

// What a frame's VPLs are gathered with; shadows, bilateral: null without.
struct StaticVplPasses {
    InterleavedGather& gather;
    JointBilateral* bilateral;
    const LightList& list;
    StaticVplShadows* shadows;

    // list: 0, or 1 of receivers with baked light.
    const Buffer& vpls(int which) const {
        return shadows ? shadows->vpls(which) : which ? list.baked() : list.vpls();
    }
    lw_subset_order order() const { return shadows ? shadows->order() : list.order(); }
};

class StaticVplView {
public:
    StaticVplView(Device& device, const InterleavedOptions& options, const View& view);

    void render(Executor& executor, const View& view, const LWGBuffer& gbuffer, const LWOutput& output,
                const StaticVplPasses& passes);

    void startFrame(bool forget);
    void report(Report& report, lw_subset_order order) const;
    void addDebugViews(std::vector<DebugView>& views) const { whole_.addDebugViews(views, nullptr, nullptr); }
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
                  const LWOutput& output, const StaticVplPasses& passes, int list);

    Device& device_;
    InterleavedOptions options_;
    InterleavedView whole_;
    std::optional<Baked> baked_;
};

}  // namespace lightwell
