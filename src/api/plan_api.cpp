// Entry point: planning.
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "api/call.h"
#include "api/frame_arguments.h"
#include "api/structs.h"
#include "planner/frame_probing.h"
#include "planner/planner.h"

using namespace lightwell;

namespace {

constexpr std::uint32_t kMostViews = 64;

LWPlanDesc checkedDesc(const LWPlanDesc* desc) {
    LWPlanDesc own = readStruct(desc, "desc");
    const auto check = [](float value, const char* name) {
        if (!(value >= 0.0f && std::isfinite(value)))
            fail(LW_ERROR_INVALID_ARGUMENT, "desc.", name, ": expected a finite number of 0 or more, got ", value);
    };
    check(own.budgetMs, "budgetMs");
    check(own.errorTarget, "errorTarget");
    if (own.views > kMostViews) fail(LW_ERROR_INVALID_ARGUMENT, "desc.views: expected 0 .. ", kMostViews, ", got ", own.views);
    if (own.views == 0) own.views = 1;
    if (own.atRest > 1) fail(LW_ERROR_INVALID_ARGUMENT, "desc.atRest: expected 0 or 1, got ", own.atRest);
    return own;
}

// Nothing is kept of light that the host does not say stands still.
void checkRest(const LWFrame& frame) {
    if (frame.vplCount > 0) fail(LW_ERROR_INVALID_ARGUMENT, "frame.vplCount: expected 0 with desc.atRest, as VPLs have no version, got ", frame.vplCount);
    for (std::uint32_t l = 0; l < frame.lightCount; ++l)
        for (std::uint32_t r = 0; r < frame.lights[l].rsmCount; ++r)
            if (frame.lights[l].rsms[r].version == 0)
                fail(LW_ERROR_INVALID_ARGUMENT, "frame.lights[", l, "].rsms[", r, "].version: expected a version with desc.atRest, got 0");
}

// Cut where it does not fit.
template <std::size_t size>
void copyText(char (&to)[size], const std::string& text) {
    std::snprintf(to, size, "%s", text.c_str());
}

// Waits with the device's lock open.
FrameFigures probe(Call& call, const View& view, const LWFrame& frame, const LWGBuffer& gbuffer, const LWSync* sync) {
    Device& device = call.owner()->device;
    FrameProbing probing(device);
    FrameRecord record(device);
    record.executor.waitFor(sync);
    try {
        probing.record(record.executor, view, frame, gbuffer);
        record.executor.signal(sync);
        record.executor.flush();
        call.settle();
    } catch (...) {
        record.executor.forgetWaits();
        clFinish(device.queue());  // what is still being read must not outlive its memory
        throw;
    }
    const FrameFigures* probes = probing.take();
    if (!probes) fail(LW_ERROR_DEVICE, "the frame's probes: expected their read to end, got none");
    return *probes;
}

// What lwPlan and lwListPlans share: their arguments, checked, and the predictions for them.
struct Planning {
    LWPlanDesc desc{};
    FrameFigures probes;
    std::string missing;  // for techniques that are not possible
    std::vector<Prediction> predictions;
};

Planning planFor(Call& call, const View& view, const LWFrame* frame, const LWGBuffer* gbuffer, const LWPlanDesc* desc) {
    Device& device = call.owner()->device;
    Planning planning;
    planning.desc = checkedDesc(desc);
    const FrameArgument ownFrame(call, frame);
    const LWGBuffer ownGBuffer = readStruct(gbuffer, "gbuffer");
    const SyncArgument sync(ownFrame.get().sync, device.context(), "frame.sync");
    device.raiseFailure();
    FrameProbing::check(device, view, ownFrame.get(), ownGBuffer);
    if (planning.desc.atRest) checkRest(ownFrame.get());
    FrameTraits traits = traitsOf(ownFrame.get(), ownGBuffer, double(view.width) * view.height, planning.desc.views);
    traits.isAtRest = planning.desc.atRest != 0;
    planning.missing = missingFor(traits);
    if (predict({}, traits, {}).empty())
        fail(LW_ERROR_INVALID_ARGUMENT, "frame, gbuffer: expected what a technique can make light of, got none of: ", planning.missing);
    const Calibration calibration = calibrationOf(device);
    planning.probes = probe(call, view, ownFrame.get(), ownGBuffer, sync.get());
    planning.predictions = predict(calibration, traits, planning.probes);
    return planning;
}

LWPlan planOf(const Choice& choice, const FrameFigures& probes) {
    const Prediction& prediction = choice.prediction;
    const Candidate& candidate = candidates()[prediction.candidate];
    LWPlan plan{};
    plan.withinBudget = choice.isWithinBudget ? 1 : 0;
    plan.reachesError = choice.reachesError ? 1 : 0;
    plan.predictedMs = float(prediction.milliseconds);
    plan.predictedError = float(prediction.error);
    plan.confidence = float(prediction.confidence);
    copyText(plan.technique, candidate.technique);
    copyText(plan.parameters, candidate.settings);
    copyText(plan.reason, choice.reason);
    plan.probes = probes;
    plan.coverage = probes.coverage;
    return plan;
}

}  // namespace

LWStatus lwPlan(LWView view, const LWFrame* frame, const LWGBuffer* gbuffer, const LWPlanDesc* desc, LWPlan* plan) {
    return enter("lwPlan", [&](Call& call) {
        const auto object = call.view(view);
        const std::uint32_t size = checkedStructSize(plan, "plan");
        const Planning planning = planFor(call, *object->view, frame, gbuffer, desc);
        Choice choice = choose(planning.predictions, double(planning.desc.budgetMs), double(planning.desc.errorTarget));
        const std::string lacking = planning.missing.empty() ? "" : " (not given: " + planning.missing + ")";
        // What decided comes first; what is missing is told where there is room.
        if (choice.reason.size() + lacking.size() < sizeof LWPlan::reason) choice.reason += lacking;
        writeStruct(plan, size, planOf(choice, planning.probes));
    });
}

LWStatus lwListPlans(LWView view, const LWFrame* frame, const LWGBuffer* gbuffer, const LWPlanDesc* desc, LWPlan* plans,
                     std::uint32_t capacity, std::uint32_t* count) {
    return enter("lwListPlans", [&](Call& call) {
        const auto object = call.view(view);
        if (!count) fail(LW_ERROR_INVALID_ARGUMENT, "count: expected an address, got null");
        if (capacity > 0 && !plans) fail(LW_ERROR_INVALID_ARGUMENT, "plans: expected room for ", capacity, " plans, got null");
        const std::vector<LWPlan> given = readStructs(plans, capacity, "plans");  // their sizes alone matter
        const Planning planning = planFor(call, *object->view, frame, gbuffer, desc);
        const double budget = double(planning.desc.budgetMs), target = double(planning.desc.errorTarget);
        const std::size_t stride = capacity ? checkedStructSize(plans, "plans[0]") : 0;
        for (std::size_t i = 0; i < planning.predictions.size() && i < capacity; ++i) {
            Choice each;
            each.prediction = planning.predictions[i];
            each.isWithinBudget = !(budget > 0.0) || each.prediction.milliseconds <= budget;
            each.reachesError = !(target > 0.0) || each.prediction.error <= target;
            auto* to = reinterpret_cast<LWPlan*>(reinterpret_cast<char*>(plans) + i * stride);
            writeStruct(to, std::uint32_t(stride), planOf(each, planning.probes));
        }
        *count = std::uint32_t(planning.predictions.size());
    });
}
