// Technique auto: a view's part, and what it tells of its choices.
#include <cstdio>
#include <utility>

#include "compute/device.h"
#include "inputs/output_target.h"
#include "techniques/auto_technique.h"

namespace lightwell {

void Auto::render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer, const LWOutput& output) {
    if (!isWhole_) fail(LW_ERROR_NOT_UPDATED, "technique: expected an lwUpdate that a technique accepts before, got none");
    checkLightOutputs(device_, *view, output, "auto");
    FrameProbing::checkView(device_, *view, gbuffer);
    noteView(*view, gbuffer);
    times_.begin(executor, false);
    try {
        renderTimed(executor, view, gbuffer, output);
        if (wantsProbes_) {
            probe([&] { probing_.recordView(executor, *view, gbuffer); });
            wantsProbes_ = probesDue_ = false;
        }
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
    AutoView* through = keptView(state, *view);
    if (!through) return child(output);
    times_.keep();
    through->render(executor, *view, gbuffer, output, fade_, fadeLeft_ > 1 ? 1.0f / float(fadeLeft_) : 1.0f, child);
}

// Null where there is no memory for it: changes then come at once.
AutoView* Auto::keptView(ViewState& state, const View& view) {
    if (state.through || state.cannotKeep) return state.through.get();
    try {
        state.through = std::make_unique<AutoView>(device_, view);
    } catch (const Error& error) {
        if (!isItsOwn(error.status())) throw;
        state.cannotKeep = true;
        device_.log(LW_LOG_WARNING, std::string("auto: changes are not faded: ") + error.what());
    }
    return state.through.get();
}

void Auto::renderChild(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer, const LWOutput& output) {
    AutoChild& running = *children_.running();
    times_.begin(executor, true);
    try {
        running.render(executor, view, gbuffer, output);
        proven_.insert(running.candidate());
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
            step_ = stepBefore_;
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

std::string Auto::reason() const {
    char figures[160];
    int length = std::snprintf(figures, sizeof figures, ": a relMSE of %.2g predicted", step_.prediction.error);
    const auto add = [&](const char* format, auto... values) {
        if (length < int(sizeof figures)) length += std::snprintf(figures + length, sizeof figures - std::size_t(length), format, values...);
    };
    add(", %.1f ms expected", step_.expected);
    if (desc_.budgetMs > 0.0f) add(" of %.1f (%.1f at most in 95 %% of frames)", double(desc_.budgetMs), step_.highest);
    if (!step_.isWithinBudget) add("; over the budget at present");
    else if (!step_.reachesError) add("; does not reach %.2g", double(desc_.errorTarget));
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

}  // namespace lightwell
