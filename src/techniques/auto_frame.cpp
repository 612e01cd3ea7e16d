// Technique auto: which candidate runs in a frame, and its world part.
#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "compute/device.h"
#include "inputs/rsm_input.h"
#include "techniques/auto_technique.h"
#include "techniques/from_text.h"

namespace lightwell {
namespace {

// Updates from one reading of the probes to the next. More: the choice follows a scene later. Fewer: reading takes a part of the budget
// in more frames.
constexpr std::uint64_t kProbeEvery = 32;
// Candidates that are tried in one frame at most: each that fails may have taken memory and time.
constexpr int kMostTries = 8;
// Frames of a fade that the budget has no room for. More: as many frames over it. Fewer: the change is seen.
constexpr std::uint32_t kTightFade = 3;
// So much longer than expected a frame is taken to last at most, when room is sought for its fade: what the first choice is doubted by is no
// noise of frames. Larger: fades are shortened that would have fit.
constexpr double kFadeMargin = 1.3;
// Share of a frame in the mean of what fading takes. Larger: a hiccup shortens fades. Smaller: a load is known later.
constexpr double kFadeShare = 0.25;
constexpr std::size_t kNobody = ~std::size_t(0);

// What decides which techniques are possible, as a word.
std::uint32_t inputsOf(const FrameTraits& traits) {
    const bool has[] = {traits.hasRsms,   traits.hasVpls,   traits.hasDirectRadiance,             traits.hasAlbedo,
                        traits.hasCamera, traits.hasMotion, traits.triangles + traits.surfels > 0, traits.staticVpls > 0};
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < std::size(has); ++i) word |= has[i] ? 1u << i : 0u;
    return word;
}

// As if views were given: of them nothing is made here, so that their lack is no reason.
FrameTraits asWithViews(FrameTraits traits) {
    traits.hasViews = true;
    return traits;
}

// Where lights stand, and which geometry there is: what maps of a frame are drawn of. Light that only grows or fades moves nothing.
std::vector<float> placesOf(const LWFrame& frame) {
    std::vector<float> places;
    const auto add = [&](const auto& values) { places.insert(places.end(), std::begin(values), std::end(values)); };
    const std::uint64_t version = frame.geometry ? frame.geometry->version : 0;
    places.push_back(float(version & 0xffff));
    for (std::uint32_t l = 0; l < frame.lightCount; ++l) {
        const LWLight& light = frame.lights[l];
        add(light.position);
        add(light.direction);
        for (std::uint32_t r = 0; r < light.rsmCount; ++r) {
            add(light.rsms[r].camera.view);
            add(light.rsms[r].camera.projection);
        }
    }
    for (std::uint32_t v = 0; v < frame.vplCount; ++v) add(frame.vpls[v].position);
    return places;
}

}  // namespace

void Auto::learn() {
    while (const std::optional<AutoTimes::Frame> frame = times_.take()) {
        if (frame->whole > 0.0) ++measured_;
        if (desc_.budgetMs > 0.0f && frame->whole > double(desc_.budgetMs)) ++over_;
        if (frame->isKept && frame->whole > frame->part) {
            const double cost = frame->whole - frame->part;
            fadeCost_ += (fadeCost_ > 0.0 ? kFadeShare : 1.0) * (cost - fadeCost_);
        }
        steering_.ran(frame->candidate, frame->predicted, frame->part, frame->whole);
    }
    if (const FrameFigures* probes = probing_.take()) {
        if (!hasProbes_) steering_.forgetChoice();  // what runs was chosen without them
        probes_ = *probes;
        // How much of the view is sky changes faster than probes come. Steering learns what frames take as it is; told as well, now and then, it
        // would correct for the same thing twice.
        probes_.coverage = std::numeric_limits<float>::quiet_NaN();
        hasProbes_ = true;
    }
}

// The G-buffer is that of the last frame: this one's comes after the choice.
FrameTraits Auto::traitsNow(const LWFrame& frame) {
    FrameTraits traits = traitsOf(frame, seen_, pixels_, desc_.views);
    // VPLs drawn for what views show are others with every step of the camera, and all maps with them: no candidate for frame after frame.
    traits.hasViews = false;
    // Lamps that go out for a while ask for no other technique.
    hasHadRsms_ = traits.hasRsms || (hasHadRsms_ && !frame.reset);
    traits.hasRsms = hasHadRsms_;
    std::vector<float> places = placesOf(frame);
    traits.hasMoved = places != std::exchange(placed_, places);
    brought_ = traits;
    return traits;
}

std::vector<Prediction> Auto::predictions(const FrameTraits& traits) const {
    std::vector<Prediction> possible = planner_.predict(traits, probes_);
    if (possible.empty() && !hasSeen_) {
        // Nothing is possible without what the first G-buffer has yet to show: it may have all.
        FrameTraits all = traits;
        all.hasDirectRadiance = all.hasAlbedo = all.hasCamera = all.hasMotion = true;
        possible = planner_.predict(all, probes_);
    }
    // What prewarming left out would compile in the midst of frames: it is taken where there is nothing else.
    std::vector<Prediction> prepared;
    std::copy_if(possible.begin(), possible.end(), std::back_inserter(prepared),
                 [&](const Prediction& one) { return proven_.count(one.candidate) || !skipped_.count(one.candidate); });
    return prepared.empty() ? possible : prepared;
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

void Auto::update(Executor& executor, const LWFrame& frame) {
    RsmInput::check(device_, frame);  // the host's mistakes are no technique's
    const bool isLost = continuity_.beginLost();
    forgets_ = forgets_ || isLost || frame.reset != 0;
    probesDue_ = probesDue_ || frame.reset != 0 || updates_ % kProbeEvery == 0;
    learn();
    const FrameTraits traits = traitsNow(frame);
    const bool wasWhole = std::exchange(isWhole_, false);
    try {
        const SteeringStep step = choose(executor, frame, traits);
        startFrame(frame, step, std::exchange(forgets_, false));
    } catch (const Error& error) {
        times_.discard();
        // A frame that is refused as it is leaves the one before.
        isWhole_ = wasWhole && error.status() == LW_ERROR_INVALID_ARGUMENT && children_.running();
        throw;
    }
}

// A fade costs as long as it lasts.
std::uint32_t Auto::fadeFor(const SteeringStep& step) const {
    const double most = std::min(step.highest, kFadeMargin * step.expected);
    const bool isTight = desc_.budgetMs > 0.0f && most + fadeCost_ > double(desc_.budgetMs);
    return isTight ? std::min(desc_.fade, kTightFade) : desc_.fade;
}

void Auto::startFrame(const LWFrame& frame, const SteeringStep& step, bool forgets) {
    const SteeringStep before = std::exchange(step_, step);
    const bool changes = hasBefore_ && before_ != step.prediction.candidate;
    if (changes) {
        ++switches_;
        stepBefore_ = before;
        device_.log(LW_LOG_INFO, "auto: " + reason());
    }
    if (changes || !hasBefore_) lastCause_ = step.cause;
    before_ = step.prediction.candidate;
    hasBefore_ = true;
    fadeLeft_ = forgets ? 0 : changes ? fadeFor(step) : fadeLeft_ > 0 ? fadeLeft_ - 1 : 0;
    // A change is told a frame ahead, so that only then the picture has to be kept; and the first choices are soon made again.
    keeps_ = desc_.fade > 1 && (fadeLeft_ > 1 || step.isLeaving || steering_.mayLeave() || (planner_.usesProbes && !hasProbes_ && (probesDue_ || probing_.isReading())));
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
    children_.dropResting();  // two at once are enough for the device's memory
    const Candidate& one = planner_.candidates[candidate];
    return std::make_unique<AutoChild>(candidate, makeTechnique(device_, one.technique, one.settings));
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
        // Should its first lwRender fail, the one before takes its place in the same frame; not where its programs are known to be there, for
        // an update of two is a frame over the budget.
        if (!children_.running()->hasRendered() && !proven_.count(step.prediction.candidate)) updateOther(executor, frame, inputs);
    }
    wantsProbes_ = planner_.usesProbes && !probing_.isReading() && probesDue_;
    if (wantsProbes_) probe([&] { probing_.beginFrame(executor, frame); });
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

// Without memory for probes the choice is made without them, until they are due again.
void Auto::probe(const std::function<void()>& record) {
    try {
        record();
    } catch (const Error& error) {
        if (!isItsOwn(error.status())) throw;
        wantsProbes_ = probesDue_ = false;
        device_.log(LW_LOG_WARNING, std::string("auto: chooses without new probes of the frame: ") + error.what());
    }
}

void Auto::noteFailure(std::size_t candidate, const Error& error) {
    ++failed_;
    device_.log(LW_LOG_WARNING, "auto: " + nameOf(candidate) + " is left out for a while, as it failed: " + error.what());
}

// Whether a candidate would fail as another has: all settings of a technique that refuses a frame's inputs, or whose kernels do not build.
bool Auto::failsWith(std::size_t candidate, std::size_t failed, LWStatus status) const {
    const bool isAlike = status == LW_ERROR_INVALID_ARGUMENT || status == LW_ERROR_BUILD_FAILED;
    return candidate == failed ||
           (isAlike && std::string(planner_.candidates[candidate].technique) == planner_.candidates[failed].technique);
}

// Kernels that do not build will not in the next frame either, whatever the settings.
void Auto::bar(std::size_t failed, LWStatus status) {
    for (std::size_t i = 0; i < planner_.candidates.size(); ++i)
        if (i == failed || (status == LW_ERROR_BUILD_FAILED && failsWith(i, failed, status))) steering_.fail(i);
}

// The first of the candidates, best first, that takes the frame. Those before it are barred. Where none does, the frame is to blame for
// what was refused, and all else is barred, so that others have their turn in the next frame.
SteeringStep Auto::choose(Executor& executor, const LWFrame& frame, const FrameTraits& traits) {
    const std::uint32_t inputs = inputsOf(traits);
    std::vector<Prediction> possible = predictions(traits);
    if (possible.empty())
        fail(LW_ERROR_INVALID_ARGUMENT, "frame, gbuffer: expected what a technique can make light of, got none of: ", missingFor(asWithViews(traits)));
    hasOther_ = false;
    inputs_ = inputs;
    const std::size_t ran = children_.running() ? children_.running()->candidate() : kNobody;
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
                bar(failed, error.status());
                noteFailure(failed, error);
            }
            return *step;
        } catch (const Error& error) {
            times_.discard();
            // One that has taken such frames is believed.
            if (!isItsOwn(error.status()) || (isKnown && error.status() == LW_ERROR_INVALID_ARGUMENT)) throw;
            failures.emplace_back(candidate, error);
            if (ran == candidate && error.status() != LW_ERROR_INVALID_ARGUMENT) children_.fallBack();  // half made
            const auto isOut = [&](const Prediction& one) { return failsWith(one.candidate, candidate, error.status()); };
            possible.erase(std::remove_if(possible.begin(), possible.end(), isOut), possible.end());
        }
    }
    if (children_.running()) steering_.resume(children_.running()->candidate());
    else steering_.forgetChoice();
    for (const auto& [failed, error] : failures) {
        if (error.status() == LW_ERROR_INVALID_ARGUMENT) continue;
        bar(failed, error.status());
        noteFailure(failed, error);
    }
    if (failures.empty()) fail(LW_ERROR_UNSUPPORTED, "auto: all that the frame allows has failed before and is left out for a while; the log says why");
    throw failures.front().second;
}

}  // namespace lightwell
