#include "techniques/auto.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <utility>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/image_check.h"
#include "inputs/rsm_input.h"
#include "planner/frame_probing.h"
#include "planner/steering.h"
#include "techniques/auto_children.h"
#include "techniques/auto_parameters.h"
#include "techniques/auto_times.h"
#include "techniques/auto_view.h"
#include "techniques/from_text.h"
#include "techniques/prewarm.h"
#include "techniques/technique_entry.h"

namespace lightwell {
namespace {

// Updates from one reading of the probes to the next. More: the choice follows a scene later. Fewer: reading takes a part of the budget
// in more frames.
constexpr std::uint64_t kProbeEvery = 32;
// Candidates that are tried in one frame at most: each that fails may have taken memory and time.
constexpr int kMostTries = 8;
// Pixels of a view before one has been seen.
constexpr double kPixels = 1280.0 * 720.0;
// Prewarmed is what may be chosen: dearer *and* worse than another by this much on each side is not.
constexpr double kDominated = 1.5;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Of these another technique may make light where the first could not; the rest are the device's.
bool isItsOwn(LWStatus status) {
    return status == LW_ERROR_INVALID_ARGUMENT || status == LW_ERROR_OUT_OF_MEMORY || status == LW_ERROR_UNSUPPORTED ||
           status == LW_ERROR_BUILD_FAILED;
}

LWPlanProbes unknownProbes() {
    const auto none = float(kNone);
    return {none, none, none, none, none, none, none, none};
}

SteeringOptions steeringOptions(const LWAutoDesc& desc) {
    return {double(desc.budgetMs), double(desc.errorTarget), desc.patience, double(desc.gain)};
}

// What decides which techniques are possible, as a word.
std::uint32_t inputsOf(const FrameTraits& traits) {
    const bool has[] = {traits.hasRsms,   traits.hasVpls,   traits.hasDirectRadiance,             traits.hasAlbedo,
                        traits.hasCamera, traits.hasMotion, traits.triangles + traits.surfels > 0, traits.staticVpls > 0};
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < std::size(has); ++i) word |= has[i] ? 1u << i : 0u;
    return word;
}

AutoPlanner realPlanner(Device& device) {
    const Calibration calibration = calibrationOf(device);
    return {candidates(), [calibration](const FrameTraits& traits, const LWPlanProbes& probes) { return predict(calibration, traits, probes); }, true};
}

class Auto final : public Technique {
public:
    Auto(Device& device, const LWAutoDesc& desc) : Auto(device, desc, realPlanner(device)) {}
    Auto(Device& device, const LWAutoDesc& desc, AutoPlanner planner)
        : device_(device), desc_(desc), planner_(std::move(planner)), steering_(steeringOptions(desc)), fade_(device), probing_(device), continuity_(device) {}

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
    };

    void learn();
    FrameTraits traitsNow(const LWFrame& frame);
    std::vector<Prediction> predictions(const FrameTraits& traits) const;
    std::unique_ptr<AutoChild> obtain(std::size_t candidate);
    void updateWith(Executor& executor, const LWFrame& frame, const SteeringStep& step, std::uint32_t inputs);
    SteeringStep choose(Executor& executor, const LWFrame& frame, const FrameTraits& traits);
    void updateOther(Executor& executor, const LWFrame& frame, std::uint32_t inputs);
    void startFrame(const LWFrame& frame, const SteeringStep& step, bool forgets);
    void renderChild(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer, const LWOutput& output);
    void renderTimed(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer, const LWOutput& output);
    void noteFailure(std::size_t candidate, const Error& error);
    void noteView(const View& view, const LWGBuffer& gbuffer);
    std::string nameOf(std::size_t candidate) const;
    std::string reason() const;

    Device& device_;
    LWAutoDesc desc_;
    AutoPlanner planner_;
    Steering steering_;
    AutoChildren children_;
    AutoTimes times_;
    CrossFade fade_;
    FrameProbing probing_;
    Continuity continuity_;
    PerView<ViewState> states_;

    // What is known of the host's frames.
    LWGBuffer seen_{};  // of the last lwRender: which images it has
    bool hasSeen_ = false, hasHadRsms_ = false, hasProbes_ = false;
    double pixels_ = kPixels;
    LWPlanProbes probes_ = unknownProbes();

    // Of the frame at hand.
    bool isWhole_ = false, keeps_ = false, wantsProbes_ = false;
    bool hasOther_ = false;  // the resting technique has this frame too, should the new one fail
    std::uint32_t fadeLeft_ = 0, inputs_ = 0;
    SteeringStep step_;
    SteeringCause lastCause_ = SteeringCause::kStart;
    std::size_t before_ = 0;  // candidate
    bool hasBefore_ = false;

    std::uint64_t updates_ = 0, switches_ = 0, measured_ = 0, over_ = 0, failed_ = 0;
};

// ------------------------------------------------------------------------------------- what is known

void Auto::learn() {
    while (const std::optional<AutoTimes::Frame> frame = times_.take()) {
        if (frame->whole > 0.0) ++measured_;
        if (desc_.budgetMs > 0.0f && frame->whole > double(desc_.budgetMs)) ++over_;
        steering_.ran(frame->candidate, frame->predicted, frame->part, frame->whole);
    }
    if (const LWPlanProbes* probes = probing_.take()) {
        if (!hasProbes_) steering_.forgetChoice();  // what runs was chosen without them
        probes_ = *probes;
        hasProbes_ = true;
    }
}

// The G-buffer is that of the last frame: this one's comes after the choice.
FrameTraits Auto::traitsNow(const LWFrame& frame) {
    FrameTraits traits = traitsOf(frame, seen_, pixels_, desc_.views);
    // Lamps that go out for a while ask for no other technique.
    hasHadRsms_ |= traits.hasRsms;
    traits.hasRsms = hasHadRsms_;
    return traits;
}

std::vector<Prediction> Auto::predictions(const FrameTraits& traits) const {
    std::vector<Prediction> possible = planner_.predict(traits, probes_);
    if (!possible.empty() || hasSeen_) return possible;
    // Nothing is possible without what the first G-buffer has yet to show: it may have all.
    FrameTraits all = traits;
    all.hasDirectRadiance = all.hasAlbedo = all.hasCamera = all.hasMotion = true;
    return planner_.predict(all, probes_);
}

void Auto::noteView(const View& view, const LWGBuffer& gbuffer) {
    // The first one shows what is possible: the choice before was blind to it.
    if (!hasSeen_) steering_.forgetChoice();
    hasSeen_ = true;
    pixels_ = double(view.width) * view.height;
    seen_ = gbuffer;
}

std::string Auto::nameOf(std::size_t candidate) const {
    const Candidate& one = planner_.candidates[candidate];
    return std::string(one.technique) + (*one.settings ? " " : "") + one.settings;
}

// ------------------------------------------------------------------------------------- the frame

void Auto::update(Executor& executor, const LWFrame& frame) {
    RsmInput::check(device_, frame);  // the host's mistakes are no technique's
    const bool forgets = continuity_.beginLost() || frame.reset;
    learn();
    const FrameTraits traits = traitsNow(frame);
    const bool wasWhole = std::exchange(isWhole_, false);
    try {
        const SteeringStep step = choose(executor, frame, traits);
        startFrame(frame, step, forgets);
    } catch (const Error& error) {
        times_.discard();
        // A frame that is refused as it is leaves the one before.
        isWhole_ = wasWhole && error.status() == LW_ERROR_INVALID_ARGUMENT && children_.running();
        throw;
    }
}

void Auto::startFrame(const LWFrame& frame, const SteeringStep& step, bool forgets) {
    step_ = step;
    const bool changes = hasBefore_ && before_ != step.prediction.candidate;
    if (changes) {
        ++switches_;
        device_.log(LW_LOG_INFO, "auto: " + reason());
    }
    if (changes || !hasBefore_) lastCause_ = step.cause;
    before_ = step.prediction.candidate;
    hasBefore_ = true;
    fadeLeft_ = forgets ? 0 : changes ? desc_.fade : fadeLeft_ > 0 ? fadeLeft_ - 1 : 0;
    // A change is told a frame ahead, so that only then the picture has to be kept; and the first choices are soon made again.
    keeps_ = desc_.fade > 1 && (fadeLeft_ > 1 || step.isLeaving || steering_.mayLeave() || (planner_.usesProbes && !hasProbes_));
    states_.purge();
    states_.each([&](ViewState& state) {
        if (state.through) state.through->startFrame(forgets);
    });
    if (children_.resting() && !hasOther_) children_.resting()->miss(frame.reset != 0);
    ++updates_;
    isWhole_ = true;
}

std::unique_ptr<AutoChild> Auto::obtain(std::size_t candidate) {
    if (std::unique_ptr<AutoChild> child = children_.takeResting(candidate)) return child;
    const Candidate& one = planner_.candidates[candidate];
    try {
        return std::make_unique<AutoChild>(candidate, makeTechnique(device_, one.technique, one.settings));
    } catch (const Error& error) {
        if (error.status() != LW_ERROR_OUT_OF_MEMORY || !children_.resting()) throw;
        children_.dropResting();
        return std::make_unique<AutoChild>(candidate, makeTechnique(device_, one.technique, one.settings));
    }
}

// Updates the step's candidate, which then is the one that runs.
void Auto::updateWith(Executor& executor, const LWFrame& frame, const SteeringStep& step, std::uint32_t inputs) {
    AutoChild* running = children_.running();
    times_.startFrame(step.prediction.candidate, step.prediction.milliseconds);
    times_.begin(executor, false);
    if (running && running->candidate() == step.prediction.candidate) {
        times_.begin(executor, true);
        running->update(executor, frame, inputs);
        times_.end(executor, true);
    } else {
        std::unique_ptr<AutoChild> child = obtain(step.prediction.candidate);
        times_.begin(executor, true);
        child->update(executor, frame, inputs);
        times_.end(executor, true);
        children_.start(std::move(child));
        // Should its first lwRender fail, the one before takes its place in the same frame.
        if (!children_.running()->hasRendered()) updateOther(executor, frame, inputs);
    }
    wantsProbes_ = planner_.usesProbes && !probing_.isReading() && (!hasProbes_ || updates_ % kProbeEvery == 0);
    if (wantsProbes_) probing_.beginFrame(executor, frame);
    times_.end(executor, false);
}

void Auto::updateOther(Executor& executor, const LWFrame& frame, std::uint32_t inputs) {
    if (!children_.resting() || !children_.resting()->hasRendered()) return;
    try {
        children_.resting()->update(executor, frame, inputs);
        hasOther_ = true;
    } catch (const Error& error) {
        if (!isItsOwn(error.status())) throw;
        children_.dropResting();  // whatever it holds of this frame
    }
}

void Auto::noteFailure(std::size_t candidate, const Error& error) {
    ++failed_;
    device_.log(LW_LOG_WARNING, "auto: " + nameOf(candidate) + " is left out for a while, as it failed: " + error.what());
}

// The first of the candidates, best first, that takes the frame. Those before it are barred; where none does, none is, since then the
// frame is to blame.
SteeringStep Auto::choose(Executor& executor, const LWFrame& frame, const FrameTraits& traits) {
    const std::uint32_t inputs = inputsOf(traits);
    std::vector<Prediction> possible = predictions(traits);
    if (possible.empty())
        fail(LW_ERROR_INVALID_ARGUMENT, "frame, gbuffer: expected what a technique can make light of, got none of: ", missingFor(traits));
    hasOther_ = false;
    inputs_ = inputs;
    const std::optional<std::size_t> ran = children_.running() ? std::optional(children_.running()->candidate()) : std::nullopt;
    std::vector<std::pair<std::size_t, Error>> failures;
    for (int tries = 0; tries < kMostTries; ++tries) {
        const bool mayLeave = desc_.fade < 2 || keeps_ || !hasCamera(seen_);
        const std::optional<SteeringStep> step = possible.empty() ? std::nullopt : steering_.next(possible, mayLeave);
        if (!step) break;
        const std::size_t candidate = step->prediction.candidate;
        const bool isKnown = ran == candidate && children_.running() && children_.running()->knows(inputs);
        try {
            updateWith(executor, frame, *step, inputs);
            for (const auto& [failed, error] : failures) {
                steering_.fail(failed);
                noteFailure(failed, error);
            }
            return *step;
        } catch (const Error& error) {
            times_.discard();
            // One that has taken such frames is believed.
            if (!isItsOwn(error.status()) || (isKnown && error.status() == LW_ERROR_INVALID_ARGUMENT)) throw;
            failures.emplace_back(candidate, error);
            if (ran == candidate && error.status() != LW_ERROR_INVALID_ARGUMENT) children_.fallBack();  // half made
            // All settings of a technique ask for the same inputs.
            const std::string technique = planner_.candidates[candidate].technique;
            possible.erase(std::remove_if(possible.begin(), possible.end(), [&](const Prediction& one) {
                return one.candidate == candidate || (error.status() == LW_ERROR_INVALID_ARGUMENT && planner_.candidates[one.candidate].technique == technique);
            }), possible.end());
        }
    }
    if (children_.running()) steering_.resume(children_.running()->candidate());
    else steering_.forgetChoice();
    if (failures.empty()) fail(LW_ERROR_UNSUPPORTED, "auto: all that the frame allows has failed before and is left out for a while; the log says why");
    throw failures.front().second;
}

// ------------------------------------------------------------------------------------- the view

void Auto::render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer, const LWOutput& output) {
    if (!isWhole_) fail(LW_ERROR_NOT_UPDATED, "technique: expected an lwUpdate that a technique accepts before, got none");
    checkLightOutputs(device_, *view, output, "auto");
    FrameProbing::checkView(device_, *view, gbuffer);
    noteView(*view, gbuffer);
    times_.begin(executor, false);
    try {
        renderTimed(executor, view, gbuffer, output);
        if (wantsProbes_) probing_.recordView(executor, *view, gbuffer);
        wantsProbes_ = false;
    } catch (...) {
        times_.discard();
        throw;
    }
    times_.end(executor, false);
}

void Auto::renderTimed(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer, const LWOutput& output) {
    ViewState& state = states_.get(view, [] { return std::make_unique<ViewState>(); });
    const auto child = [&](const LWOutput& images) { renderChild(executor, view, gbuffer, images); };
    if (!keeps_ || !hasCamera(gbuffer)) {
        if (state.through) state.through->skip();
        return child(output);
    }
    if (!state.through) state.through = std::make_unique<AutoView>(device_, *view);
    state.through->render(executor, *view, gbuffer, output, fade_, fadeLeft_ > 1 ? 1.0f / float(fadeLeft_) : 1.0f, child);
}

void Auto::renderChild(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer, const LWOutput& output) {
    AutoChild& running = *children_.running();
    times_.begin(executor, true);
    try {
        running.render(executor, view, gbuffer, output);
    } catch (const Error& error) {
        if (!isItsOwn(error.status())) throw;
        if (hasOther_) {
            // Where the one before fails too it is the host's frame, or there is no memory for either.
            children_.resting()->render(executor, view, gbuffer, output);
            const std::size_t failed = running.candidate();
            children_.fallBack();
            hasOther_ = false;
            steering_.fail(failed);
            steering_.resume(children_.running()->candidate());
            noteFailure(failed, error);
            times_.discard();
            before_ = children_.running()->candidate();
            step_.prediction.candidate = before_;
            lastCause_ = SteeringCause::kNotPossible;
        } else if (!running.knows(inputs_) || error.status() != LW_ERROR_INVALID_ARGUMENT) {
            steering_.fail(running.candidate());
            noteFailure(running.candidate(), error);
            throw;
        } else {
            throw;
        }
    }
    times_.end(executor, true);
}

// ------------------------------------------------------------------------------------- what it tells

std::string Auto::reason() const {
    char figures[160];
    int length = std::snprintf(figures, sizeof figures, ": a relMSE of %.2g predicted", step_.prediction.error);
    const auto add = [&](const char* format, auto... values) {
        if (length < int(sizeof figures)) length += std::snprintf(figures + length, sizeof figures - std::size_t(length), format, values...);
    };
    add(", %.1f ms expected", step_.expected);
    if (desc_.budgetMs > 0.0f) add(" of %.1f (%.1f at most in 95 %% of frames)", double(desc_.budgetMs), step_.highest);
    if (!step_.isWithinBudget) add("; nothing quicker is possible");
    else if (!step_.reachesError) add("; nothing reaches %.2g", double(desc_.errorTarget));
    static const char* const causes[] = {"the best for the frame that it began with",
                                         "",
                                         "less error than the one before",
                                         "reaches the target for less than the one before",
                                         "the one before broke the budget",
                                         "the one before was about to break the budget",
                                         "the one before is not possible"};
    return nameOf(step_.prediction.candidate) + figures + "; chosen as " + causes[int(lastCause_)];
}

Report Auto::report() {
    Report report;
    const auto count = [&](const char* name, std::uint64_t value) { report.counts.push_back({name, value}); };
    count("switches", switches_);
    count("measured_frames", measured_);
    count("over_budget_frames", over_);
    count("failed_candidates", failed_);
    count("barred_candidates", steering_.barred());
    count("fading_frames_left", fadeLeft_ > 0 ? fadeLeft_ - 1 : 0);
    states_.each([&](const ViewState& state) {
        if (state.through && keeps_) state.through->report(device_, report);
    });
    if (!children_.running()) return report;
    const Candidate& candidate = planner_.candidates[children_.running()->candidate()];
    report.chooseText("auto", reason());
    report.choose("auto.technique", candidate.technique);
    report.choose("auto.parameters", candidate.settings);
    if (hasSeen_ && !hasCamera(seen_) && desc_.fade > 1) report.choose("auto.fade", "none: gbuffer.camera is missing");
    report.add("chosen", children_.running()->technique().report());
    return report;
}

std::uint64_t Auto::bytes() const {
    std::uint64_t total = children_.bytes() + probing_.bytes();
    states_.each([&](const ViewState& state) { total += state.through ? state.through->bytes() : 0; });
    return total;
}

// All that may be chosen for what is known of the host's frames, one after the other: programs stay with the device.
void Auto::prewarm(Executor& executor, const std::shared_ptr<View>& view) {
    FrameTraits traits = traitsOf(LWFrame{}, seen_, hasSeen_ ? pixels_ : double(view ? view->width * view->height : kPixels), desc_.views);
    traits.hasRsms = true;
    if (!hasSeen_) traits.hasDirectRadiance = traits.hasAlbedo = traits.hasCamera = traits.hasMotion = traits.hasVpls = true;
    if (updates_ == 0) traits.triangles = traits.staticVpls = 1;
    const std::vector<Prediction> possible = planner_.predict(traits, probes_);
    for (const Prediction& one : possible) {
        const bool isDominated = std::any_of(possible.begin(), possible.end(), [&](const Prediction& other) {
            return kDominated * other.milliseconds < one.milliseconds && kDominated * other.error < one.error;
        });
        if (isDominated) continue;
        const Candidate& candidate = planner_.candidates[one.candidate];
        makeTechnique(device_, candidate.technique, candidate.settings)->prewarm(executor, view);
        device_.finish();
    }
    // What lies around them, with one that stands for all.
    FrameTraits made;
    made.hasRsms = made.hasDirectRadiance = made.hasCamera = true;
    const std::vector<Prediction> simple = planner_.predict(made, probes_);
    if (simple.empty()) return;
    AutoPlanner one = planner_;
    one.predict = [only = simple.front()](const FrameTraits&, const LWPlanProbes&) { return std::vector<Prediction>{only}; };
    Auto twin(device_, desc_, std::move(one));
    exerciseTechnique(executor, twin);
}

// ------------------------------------------------------------------------------------- registration

std::uint64_t estimateText(const TechniqueText& text, const LWViewDesc& view, const FrameShape& shape) {
    std::uint64_t total = text.entry->estimateBytes(text.descriptor.data(), view, shape);
    for (const TechniqueText& part : text.parts) total += estimateText(part, view, shape);
    return total;
}

// The two largest candidates, and what lies around them.
std::uint64_t estimateBytes(const void*, const LWViewDesc& view, const FrameShape& shape) {
    std::uint64_t most = 0, next = 0;
    for (const Candidate& candidate : candidates()) {
        const std::uint64_t bytes = estimateText(parseTechnique(candidate.technique, candidate.settings), view, shape);
        next = std::max(next, std::min(most, bytes));
        most = std::max(most, bytes);
    }
    return most + next + AutoView::estimateBytes(view, shape.uploads) + FrameProbing::estimateBytes(view, shape);
}

}  // namespace

std::unique_ptr<Technique> makeAuto(Device& device, const LWAutoDesc& desc, AutoPlanner planner) {
    return std::make_unique<Auto>(device, desc, std::move(planner));
}

const TechniqueEntry& autoEntry() {
    static const std::vector<LWSetting> settings;
    static const TechniqueEntry entry = techniqueEntry<Auto, LWAutoDesc, lwDefaultAuto>(
        LW_TECHNIQUE_AUTO, "what the planner finds best for each frame, held to a budget, with changes cross-faded", 0, autoParameters(), settings,
        estimateBytes);
    return entry;
}

}  // namespace lightwell
