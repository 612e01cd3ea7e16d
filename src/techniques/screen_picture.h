// What technique screen_space keeps of one picture, a view's own or another camera's: its G-buffer's pyramid, and the
// light of every level of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "inputs/camera.h"
#include "inputs/gbuffer_input.h"
#include "passes/mip_pyramid.h"
#include "passes/screen_combine.h"
#include "passes/screen_gather.h"
#include "passes/screen_plan.h"
#include "passes/temporal_history.h"
#include "techniques/technique.h"

namespace lightwell {

struct ScreenSpaceOptions {
    std::uint32_t start = 2;  // level of the pyramid: 0 full, 1 half, 2 quarter resolution
    std::uint32_t levels = 4, samples = 64, interleave = 4, seed = 0;
    double radius = 20.0;  // texels, of an image of kRadiusRows rows
    bool bounded = true, cameras = false;
    float autoError = 0.0f;  // above 0: start, samples and levels are the most there may be
    TemporalHistoryOptions history;  // none with 0 frames

    static constexpr double kRadiusRows = 720.0;
    LevelRange range() const { return {start, start + levels - 1}; }
    PyramidOptions pyramid() const { return {ScreenGather::kExtras, start, range().last}; }
    bool keeps() const { return history.frames > 0; }
    bool plans() const { return autoError > 0.0f; }
    // GBufferNeeds.
    std::uint32_t needs() const { return kNeedsDirectRadiance | kNeedsReceiveMask | (keeps() ? std::uint32_t(kNeedsMotion) : 0u); }
    // The radius in texels of every level, for an image of so many rows.
    double radiusAt(std::uint32_t rows) const { return radius * rows / kRadiusRows; }
};

// The passes of a technique; its pictures share them.
struct ScreenSpacePasses {
    ScreenSpacePasses(Device& device, const ScreenSpaceOptions& options)
        : pyramid(device, ScreenGather::kExtras), gather(device, options.interleave, options.plans()),
          combine(device, {options.interleave, 1u << options.start, options.levels > 1, options.cameras, options.keeps(), options.plans()}) {
        if (options.plans())
            plan.emplace(device, ScreenPlanOptions{options.autoError, options.start, options.samples, options.levels, options.interleave,
                                                       options.bounded});
        if (options.keeps()) history.emplace(device, options.history);
    }
    MipPyramid pyramid;
    ScreenGather gather;
    ScreenCombine combine;
    std::optional<ScreenPlanPass> plan;
    std::optional<TemporalHistory> history;
};

class ScreenPicture {
public:
    ScreenPicture(Device& device, const ScreenSpaceOptions& options, std::uint32_t maxWidth, std::uint32_t maxHeight);

    // Throws what light() would say of the images. Nothing is enqueued.
    static void check(Device& device, const ScreenSpaceOptions& options, const View& view, const LWGBuffer& gbuffer, const std::string& name);
    // From the host's images to the light of the first level, by sample patterns turned by `turn` steps.
    void light(Executor& executor, ScreenSpacePasses& passes, const View& view, const LWGBuffer& gbuffer, const std::string& name,
               std::uint32_t turn);
    // To the outputs, or none, after light().
    void finish(Executor& executor, ScreenSpacePasses& passes, const Planes& irradiance, const Planes& validity);
    // Raises outputs made by finish() to what `other` sees.
    void join(Executor& executor, ScreenSpacePasses& passes, const ScreenPicture& other, const Planes& irradiance, const Planes& validity);

    // Once per update. `forget`: what the picture showed before is no history.
    void startFrame(bool forget) {
        isLit_ = false;
        if (plan_ && forget) plan_->forget();
        if (history_) history_->view.startFrame(forget);
    }
    bool isLit() const { return isLit_; }
    std::uint32_t maxWidth() const { return maxWidth_; }
    std::uint32_t maxHeight() const { return maxHeight_; }
    void report(Device& device, Report& report) const;
    void addDebugViews(std::vector<DebugView>& views, ScreenSpacePasses& passes) const;
    std::uint64_t bytes() const;
    // The most that bytes() becomes for a view. `uploads`: FrameShape::uploads.
    static std::uint64_t estimateBytes(const ScreenSpaceOptions& options, const LWViewDesc& view, bool uploads);

private:
    void makePatterns(Executor& executor, std::uint32_t rows, std::uint32_t turn);
    void gatherLevels(Executor& executor, ScreenSpacePasses& passes);
    void keep(Executor& executor, ScreenSpacePasses& passes, const View& view, const LWCamera& camera);

    Device& device_;
    ScreenSpaceOptions options_;
    std::uint32_t maxWidth_, maxHeight_;
    GBufferInput gbuffer_;
    PyramidLevels pyramid_;
    ScreenLevels levels_;
    Buffer patterns_[2];  // of the first level's disc, and of the others' ring; with a plan of all numbers of samples that it chooses from
    std::uint32_t alike_[2] = {};  // of each, the sum of the numbers of samples of which all patterns are alike
    std::optional<ScreenPlan> plan_;
    std::uint32_t patternRows_ = 0, patternTurn_ = 0;
    Buffer counts_;
    // Of the light at the first level's resolution.
    struct History {
        History(Device& device, const ScreenSpaceOptions& options, std::uint32_t maxWidth, std::uint32_t maxHeight);
        ViewHistory view;
        PlanarImage motion;  // in texels
        Buffer memory;
        Planes light;  // the mean, laid out as ScreenLevels' is
    };
    std::optional<History> history_;
    std::vector<Planes> contributions_;  // by level, of the last frame
    Planes lit_;                         // all levels together
    Camera camera_;
    bool isLit_ = false;  // since the last startFrame
};

}  // namespace lightwell
