// One view's part of a technique that looks at the view's own pixels: inputs, the pyramid of them, and the way from
// weighted sums per gathered pixel to the host's images. A part of the techniques' frame: `horizon` and `ao` differ in
// what they gather.
#pragma once

#include <cstdint>
#include <optional>

#include "compute/report.h"
#include "inputs/camera.h"
#include "inputs/gbuffer_input.h"
#include "inputs/output_target.h"
#include "inputs/view.h"
#include "passes/joint_bilateral.h"
#include "passes/mip_pyramid.h"
#include "passes/temporal_history.h"
#include "passes/weighted_filter.h"
#include "techniques/technique.h"

namespace lightwell {

struct ScreenOptions {
    bool half = false;                  // gathers every second pixel and row
    std::uint32_t columns = 1, rows = 1;  // of the filter's window
    std::uint32_t levels = 1;           // of the pyramid, from the gathered one on
    std::uint32_t extras = 0;           // PyramidPlanes beside radiance
    TemporalHistoryOptions history;     // of irradiance, validity and ambient occlusion; none with 0 frames

    bool keeps() const { return history.frames > 0; }
    std::uint32_t gathered(std::uint32_t along) const { return half ? JointBilateral::halved(along) : along; }
};

// Kernels that views share.
class ScreenPasses {
public:
    ScreenPasses(Device& device, const ScreenOptions& options);

private:
    friend class ScreenView;
    MipPyramid withLight_, plain_;
    WeightedFilter filterLight_, filterAmbient_;
    std::optional<JointBilateral> upsampleAll_, upsampleOne_;  // half resolution only
    std::optional<TemporalHistory> history_;
};

// What hosts ask of such techniques: 3 planes, 1 and 1.
struct ScreenPlanes {
    Planes irradiance, validity, open;
};

class ScreenView {
public:
    ScreenView(Device& device, const ScreenOptions& options);

    // Throws what lwRender says of outputs that such a technique cannot make.
    static void check(Device& device, const View& view, const LWOutput& output, const char* technique);

    // Inputs, outputs and the pyramid; what has to be gathered stands below. turn: of the pyramid's samples.
    void begin(Executor& executor, const View& view, const LWGBuffer& gbuffer, const LWOutput& output, const Camera& camera,
               ScreenPasses& passes, std::uint32_t turn);
    bool wantsLight() const { return wantsLight_; }
    bool wantsAmbient() const { return bool(asked_.open); }
    const PyramidLevels& levels() const { return wantsLight_ ? withLight_ : plain_; }
    // Room for the weighted sums of this frame (WeightedFilter::planes).
    Planes gathered(bool light) const;
    // Filters and up-samples them to the host's images; withAmbient: light's sums hold the ambient occlusion asked for.
    void finishLight(Executor& executor, ScreenPasses& passes, bool withAmbient);
    void finishAmbient(Executor& executor, ScreenPasses& passes);
    void end(Executor& executor, ScreenPasses& passes);

    // Once per update. `forget`: what the view showed before is no history (a cut, lost commands).
    void startFrame(bool forget);
    void report(Device& device, Report& report) const;
    static void startReport(const ScreenOptions& options, Report& report);  // the counts, at 0
    void addDebugViews(ScreenPasses& passes, std::vector<DebugView>& views) const;
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(const ScreenOptions& options, const LWViewDesc& view, bool uploads);

private:
    void reserve(const View& view);
    // With a history: forgets which parts of current_ are this picture's, where another begins.
    void beginPicture(Executor& executor, const View& view, const LWCamera& camera);
    void record(Executor& executor, ScreenPasses& passes);  // into the history
    Planes sized(const PlanarImage& image) const;
    Planes between(bool light) const;  // scratch of the filter

    Device& device_;
    ScreenOptions options_;
    GBufferInput gbuffer_;
    OutputTarget irradianceTarget_, validityTarget_, ambientTarget_;
    PyramidLevels withLight_, plain_;
    PlanarImage light_, ambient_, filteredLight_, filteredAmbient_, between_;
    Buffer counts_, upsampleCounts_;  // rejected pixels, rejected radiances; rejected pixels once more, fallbacks
    ScreenPlanes asked_;  // of the host; may be empty
    ScreenPlanes made_;   // what a frame alone makes: those, or parts of current_
    PlanarImage current_, kept_;  // with a history: a frame alone; means that the host has not asked for
    std::optional<ViewHistory> history_;
    struct Parts {
        bool light = false, open = false;
    };
    // What current_ holds of this picture, and what the history does of this one and of the one before.
    Parts fresh_, held_, heldBefore_;
    bool isBegun_ = false;      // a picture, since the last startFrame
    bool hasOldLight_ = false;  // current_, perhaps of another picture
    std::uint32_t fullWidth_ = 0, fullHeight_ = 0;
    LWCamera camera_{};
    std::uint32_t width_ = 0, height_ = 0;  // of the gathered image
    bool wantsLight_ = false, isRendered_ = false, hasLight_ = false;
};

// What a frame brings that such a technique does not read: said in the stats, so that nobody waits for its light.
std::vector<LWChoice> unusedByScreen(const LWFrame& frame);

}  // namespace lightwell
