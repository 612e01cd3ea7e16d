// The technique itself: auto.cpp makes and prewarms it, auto_frame.cpp chooses and updates, auto_render.cpp lights a view and tells.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "compute/error.h"
#include "passes/cross_fade.h"
#include "planner/frame_probing.h"
#include "planner/steering.h"
#include "techniques/auto.h"
#include "techniques/auto_children.h"
#include "techniques/auto_times.h"
#include "techniques/auto_view.h"

namespace lightwell {

// Pixels of a view before one has been seen.
constexpr double kAutoPixels = 1280.0 * 720.0;

// Of these another technique may make light where the first could not; the rest are the device's.
inline bool isItsOwn(LWStatus status) {
    return status == LW_ERROR_INVALID_ARGUMENT || status == LW_ERROR_OUT_OF_MEMORY || status == LW_ERROR_UNSUPPORTED ||
           status == LW_ERROR_BUILD_FAILED;
}

class Auto final : public Technique {
public:
    Auto(Device& device, const LWAutoDesc& desc);  // with the planner's tables
    Auto(Device& device, const LWAutoDesc& desc, AutoPlanner planner);

    void update(Executor& executor, const LWFrame& frame) override;
    void render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer, const LWOutput& output) override;
    void lose() override {
        continuity_.lose();
        children_.lose();
        times_.discard();
    }
    void prewarm(Executor& executor, const std::shared_ptr<View>& view) override;
    Report report() override;
    std::vector<DebugView> debugViews(const View* view) override {
        return children_.running() ? children_.running()->technique().debugViews(view) : std::vector<DebugView>();
    }
    std::uint64_t bytes() const override;

private:
    struct ViewState {
        std::unique_ptr<AutoView> through;  // from the first picture that is kept
        bool cannotKeep = false;
    };

    void prewarmAround(Executor& executor);
    void learn();
    FrameTraits traitsNow(const LWFrame& frame);
    std::vector<Prediction> predictions(const FrameTraits& traits) const;
    std::unique_ptr<AutoChild> obtain(std::size_t candidate);
    void updateWith(Executor& executor, const LWFrame& frame, const SteeringStep& step, std::uint32_t inputs);
    SteeringStep choose(Executor& executor, const LWFrame& frame, const FrameTraits& traits);
    bool failsWith(std::size_t candidate, std::size_t failed, LWStatus status) const;
    void bar(std::size_t failed, LWStatus status);
    void updateOther(Executor& executor, const LWFrame& frame, std::uint32_t inputs);
    void startFrame(const LWFrame& frame, const SteeringStep& step, bool forgets);
    std::uint32_t fadeFor(const SteeringStep& step) const;
    void renderChild(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer, const LWOutput& output);
    void renderTimed(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer, const LWOutput& output);
    void probe(const std::function<void()>& record);
    AutoView* keptView(ViewState& state, const View& view);
    void noteFailure(std::size_t candidate, const Error& error);
    void noteView(const View& view, const LWGBuffer& gbuffer);
    std::string nameOf(std::size_t candidate) const;
    std::string reason() const;

    Device& device_;
    LWAutoDesc desc_;
    AutoPlanner planner_;
    Steering steering_;
    AutoChildren children_;
    std::set<std::size_t> proven_;   // candidates that have been prewarmed, or have lit a view
    std::set<std::size_t> skipped_;  // that prewarming left out at some time; of what was proven later that says nothing
    AutoTimes times_;
    CrossFade fade_;
    FrameProbing probing_;
    Continuity continuity_;
    PerView<ViewState> states_;

    // What is known of the host's frames.
    LWGBuffer seen_{};  // of the last lwRender: which images it has
    bool hasSeen_ = false, hasHadRsms_ = false, hasProbes_ = false;
    FrameTraits brought_;        // by the last frame
    std::vector<float> placed_;  // where the last frame's lights stood, and its geometry's version
    double pixels_ = kAutoPixels;
    FrameFigures probes_;

    // Of the frame at hand.
    bool isWhole_ = false, keeps_ = false, wantsProbes_ = false;
    bool forgets_ = false;     // what earlier frames have left, since some frame that no candidate took
    bool probesDue_ = true;    // for the first time, for another scene, or again
    bool hasOther_ = false;  // the resting technique has this frame too, should the new one fail
    std::uint32_t fadeLeft_ = 0, inputs_ = 0;
    double fadeCost_ = 0.0;  // ms, of a frame whose picture is kept, in the mean
    SteeringStep step_, stepBefore_;  // before the last change
    SteeringCause lastCause_ = SteeringCause::kStart;
    std::size_t before_ = 0;  // candidate
    bool hasBefore_ = false;

    std::uint64_t updates_ = 0, switches_ = 0, measured_ = 0, over_ = 0, failed_ = 0;
};

}  // namespace lightwell
