#include "techniques/auto.h"

#include <algorithm>
#include <utility>

#include "compute/device.h"
#include "techniques/auto_parameters.h"
#include "techniques/auto_technique.h"
#include "techniques/from_text.h"
#include "techniques/prewarm.h"
#include "techniques/technique_entry.h"

namespace lightwell {
namespace {

// Prewarmed is what may be chosen of what is predicted to take up to so many budgets: this machine may be as much quicker than the tables
// say, or less loaded later. More: prewarming takes longer for what is seldom chosen.
constexpr double kBudgetsWarmed = 2.0;
// ... and what is not worse than a quicker one by so much: probes of the frame change the order of errors. More: prewarming takes longer.
// Less: what turns out to be the best is left out.
constexpr double kErrorsWarmed = 1.25;

FrameFigures unknownProbes() {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    return LWPlanProbes{kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone};
}

// Candidates of a technique are a group.
SteeringOptions steeringOptions(const LWAutoDesc& desc, const std::vector<Candidate>& candidates) {
    SteeringOptions options{double(desc.budgetMs), double(desc.errorTarget), desc.patience, double(desc.gain), {}};
    for (const Candidate& candidate : candidates) {
        const auto first = std::find_if(candidates.begin(), candidates.end(),
                                        [&](const Candidate& other) { return std::string(other.technique) == candidate.technique; });
        options.groups.push_back(std::size_t(first - candidates.begin()));
    }
    return options;
}

AutoPlanner realPlanner(Device& device) {
    const Calibration calibration = calibrationOf(device);
    return {candidates(), [calibration](const FrameTraits& traits, const FrameFigures& probes) { return predict(calibration, traits, probes); }, true};
}

std::uint64_t estimateText(const TechniqueText& text, const LWViewDesc& view, const FrameShape& shape) {
    std::uint64_t total = text.entry->estimateBytes(text.descriptor.data(), view, shape);
    for (const TechniqueText& part : text.parts) total += estimateText(part, view, shape);
    return total;
}

// What the device cannot hold is not chosen, or not faded.
template <class Estimate>
std::uint64_t ifSupported(Estimate estimate) {
    try {
        return estimate();
    } catch (const Error& error) {
        if (error.status() != LW_ERROR_UNSUPPORTED) throw;
        return 0;
    }
}

// The two largest candidates, and what lies around them.
std::uint64_t estimateBytes(const void* desc, const LWViewDesc& view, const FrameShape& shape) {
    std::uint64_t most = 0, next = 0;
    for (const Candidate& candidate : candidates()) {
        const std::uint64_t bytes =
            ifSupported([&] { return estimateText(parseTechnique(candidate.technique, candidate.settings), view, shape); });
        next = std::max(next, std::min(most, bytes));
        most = std::max(most, bytes);
    }
    const bool fades = static_cast<const LWAutoDesc*>(desc)->fade > 1;
    return most + next + FrameProbing::estimateBytes(view, shape) +
           (fades ? ifSupported([&] { return AutoView::estimateBytes(view, shape.uploads); }) : 0);
}

}  // namespace

Auto::Auto(Device& device, const LWAutoDesc& desc) : Auto(device, desc, realPlanner(device)) {}

Auto::Auto(Device& device, const LWAutoDesc& desc, AutoPlanner planner)
    : device_(device),
      desc_(desc),
      planner_(std::move(planner)),
      steering_(steeringOptions(desc, planner_.candidates)),
      fade_(device),
      probing_(device),
      continuity_(device),
      probes_(unknownProbes()) {}

// What may be chosen for what is known of the host's frames, one after the other: programs stay with the device.
void Auto::prewarm(Executor& executor, const std::shared_ptr<View>& view) {
    FrameTraits traits = traitsOf(LWFrame{}, seen_, hasSeen_ ? pixels_ : double(view ? view->width * view->height : kAutoPixels), desc_.views);
    traits.hasRsms = true;
    if (!hasSeen_) traits.hasDirectRadiance = traits.hasAlbedo = traits.hasCamera = traits.hasMotion = traits.hasVpls = true;
    if (updates_ == 0) {
        traits.triangles = traits.staticVpls = 1;
    } else {
        traits.triangles = brought_.triangles;
        traits.surfels = brought_.surfels;
        traits.rsmTexels = brought_.rsmTexels;
        traits.lights = brought_.lights;
        traits.staticVpls = brought_.staticVpls;
        traits.hasVpls = brought_.hasVpls;
    }
    std::vector<Prediction> quicker;  // that can be chosen
    int warmed = 0;
    for (const Prediction& one : planner_.predict(traits, probes_)) {
        // Dearer and worse than another is not chosen, as far as the frame is known.
        const bool isDominated = std::any_of(quicker.begin(), quicker.end(), [&](const Prediction& other) {
            return other.milliseconds < one.milliseconds && kErrorsWarmed * other.error <= one.error;
        });
        const bool isTooDear = desc_.budgetMs > 0.0f && one.milliseconds > kBudgetsWarmed * double(desc_.budgetMs) && warmed > 0;
        if (isDominated || isTooDear) {
            skipped_.insert(one.candidate);
            continue;
        }
        ++warmed;
        const Candidate& candidate = planner_.candidates[one.candidate];
        try {
            makeTechnique(device_, candidate.technique, candidate.settings)->prewarm(executor, view);
            quicker.push_back(one);
            proven_.insert(one.candidate);
        } catch (const Error& error) {
            if (!isItsOwn(error.status())) throw;
            device_.log(LW_LOG_WARNING, "auto: " + nameOf(one.candidate) + " cannot be chosen on this device: " + error.what());
        }
        device_.finish();
    }
    prewarmAround(executor);
}

// What lies around the candidates, with the first of them that can be had and asks for no geometry.
void Auto::prewarmAround(Executor& executor) {
    FrameTraits made;
    made.pixels = 1.0;
    made.hasRsms = made.hasDirectRadiance = made.hasCamera = true;
    for (const Prediction& simple : planner_.predict(made, probes_)) {
        AutoPlanner one = planner_;
        one.predict = [simple](const FrameTraits&, const FrameFigures&) { return std::vector<Prediction>{simple}; };
        Auto twin(device_, desc_, std::move(one));
        try {
            return exerciseTechnique(executor, twin);
        } catch (const Error& error) {
            if (!isItsOwn(error.status())) throw;
        }
    }
}

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
