// One view's part of a technique that gathers VPLs interleaved: the passes around the gather, and the images that lie
// between them. A part of the techniques' frame: `rsm` and `ssvp` differ in what they gather.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "compute/report.h"
#include "inputs/gbuffer_input.h"
#include "inputs/output_target.h"
#include "inputs/view.h"
#include "passes/bounding_compensation.h"
#include "passes/interleaved_gather.h"
#include "passes/joint_bilateral.h"
#include "passes/pixel_repair.h"
#include "passes/temporal_history.h"
#include "techniques/technique.h"

namespace lightwell {

struct InterleavedOptions {
    std::uint32_t interleave = 4;
    bool filter = true;  // has an effect with interleave > 1
    std::uint32_t halvings = 0;  // of columns and rows before the gather: 0, 1, 2
    TemporalHistoryOptions history;  // of what comes of these; none with 0 frames
    bool compensated = false;  // by BoundingCompensation; needs the G-buffer's direct radiance and camera
    bool doubtful = false;  // the gather is strict: what it doubts waits for the filter, if there is one
    float repairs = 0.0f;  // above 0, with one halving: the share by which light may differ around pixels that are not gathered by themselves

    bool keeps() const { return history.frames > 0; }
    bool filters() const { return filter && interleave > 1; }
    std::uint32_t gatheredPlanes() const { return doubtful && filters() ? 4 : 3; }
    std::uint32_t gathered(std::uint32_t along) const { return JointBilateral::halved(along, halvings); }
};

class InterleavedView {
public:
    InterleavedView(Device& device, const InterleavedOptions& options, const View& view);

    // Records what gathers the surfaces `position`, `normal` into `irradiance`.
    using Gather = std::function<void(const Planes& position, const Planes& normal, const Planes& irradiance)>;
    // Those passes of a technique that its options ask for; null without.
    struct Passes {
        InterleavedGather& gather;
        JointBilateral* bilateral;
        TemporalHistory* history;
        PixelRepair* repair = nullptr;
    };
    // A view's frame, from the host's images to the host's images. gatherAll: of all VPLs at each pixel, with options.repairs.
    void render(Executor& executor, const View& view, const LWGBuffer& gbuffer, const LWOutput& output, const Passes& passes,
                const Gather& gather, const Gather& gatherAll = {});
    // Recorded by `gather`: which VPLs (lw_vpl by slot) the tiles of this image can skip.
    const Buffer& cull(Executor& executor, InterleavedGather& passes, const Planes& position, const Planes& normal,
                       const Buffer& vpls, lw_subset_order order);
    // The same by `gatherAll`: passes of interleave 1, a list of one subset.
    const Buffer& cullAll(Executor& executor, InterleavedGather& passes, const Planes& position, const Planes& normal, const Buffer& vpls,
                          lw_subset_order order);

    // Recorded by `gather`, after the VPLs: near light that their bounds lack is added to `irradiance`.
    void compensate(Executor& executor, BoundingCompensation& pass, const LWCamera& camera, const Planes& irradiance);
    // What the last frame's compensation added; without memory, and filled by `pass`.
    void addCompensationView(BoundingCompensation& pass, std::vector<DebugView>& views) const;

    const Buffer& counts() const { return counts_; }  // as InterleavedGather and JointBilateral count
    const Buffer& repairCounts() const { return repaired_->counts(); }  // of `gatherAll`
    // The surfaces of the last frame, at full resolution; empty where it had no irradiance.
    Planes position() const { return lastGathered_ ? gbuffer_.position : Planes{}; }
    Planes normal() const { return lastGathered_ ? gbuffer_.normal : Planes{}; }
    // Once per update. `forget`: what the view showed before is no history (a cut, lost commands).
    void startFrame(bool forget);
    // Counts and choices of the views that this frame has rendered; `order` as the last cull had it.
    void report(Device& device, Report& report, lw_subset_order order) const;
    void addDebugViews(std::vector<DebugView>& views, TemporalHistory* history, PixelRepair* repair) const;
    std::uint64_t bytes() const;
    // Of the images, inputs, outputs and tiles for a view of this size; `order` of the longest list, with options.repairs `whole` of that
    // which gatherAll culls.
    static std::uint64_t estimateBytes(const InterleavedOptions& options, const LWViewDesc& view, bool uploads, lw_subset_order order,
                                       lw_subset_order whole = {});

private:
    void light(Executor& executor, const Passes& passes, const LWCamera& camera, const Planes& irradiance, const Planes& validity,
               const Gather& gather, const Gather& gatherAll);
    // The host's surfaces, and those of each halving.
    struct Surfaces {
        Planes position, normal;
    };
    void downsample(Executor& executor, JointBilateral* bilateral);
    void upsample(Executor& executor, const Passes& passes, Planes lit, const Planes& made, const Planes& validity, const Gather& gatherAll);
    // What comes last makes validity, too, of what it has read: the filter, or an up-sampling that marks.
    bool filtersLast() const { return options_.filters() && !options_.halvings; }
    bool lastMakesValidity() const { return filtersLast() || options_.halvings; }

    Device& device_;
    InterleavedOptions options_;
    GBufferInput gbuffer_;
    OutputTarget irradiance_, validity_;
    // What a halving leaves; light: what finer ones than the coarsest are up-sampled to; radiance: with compensation.
    struct Level {
        PlanarImage position, normal, light, radiance;
    };
    std::vector<Level> levels_;
    PlanarImage gathered_, filtered_, current_;
    std::optional<ViewHistory> history_;
    std::uint32_t gatheredWidth_, gatheredHeight_;  // at most
    VplTiles tiles_, repairTiles_;
    std::optional<RepairedPixels> repaired_;
    std::uint32_t repairRows_ = 0;  // of its small image, at most
    CompensationSenders senders_;
    Planes compensatedPosition_, compensatedNormal_;  // of the last frame
    Buffer counts_;  // rejected pixels, up-sampling fallbacks, saturated pixels, pixels whose compensation reaches too far
    std::vector<Surfaces> surfaces_;      // of the frame that is being recorded
    Planes lastGathered_, lastFiltered_;  // empty where the last frame had no irradiance
    bool isRendered_ = false;             // since the last update
};

}  // namespace lightwell
