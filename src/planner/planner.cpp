#include "planner/planner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <sstream>

#include "compute/device.h"
#include "compute/error.h"
#include "compute/roofline.h"
#include "inputs/image_check.h"
#include "planner/plan_tables.h"

namespace lightwell {
namespace {

// Errors so near to each other are the same to a viewer: of those the quickest is taken.
constexpr double kSameError = 1.02;
// Where no time is short enough: of those so much longer than the shortest the most accurate is taken (docs/planner.md).
constexpr double kSameTime = 1.05;
const double kTwice = std::log10(2.0);

struct NeedName {
    std::uint32_t need;
    const char* name;
};
constexpr NeedName kNeedNames[] = {{kPlanNeedsRsms, "RSMs or VPLs"},           {kPlanNeedsRadiance, "directRadiance"},
                                   {kPlanNeedsCamera, "a camera"},             {kPlanNeedsGeometry, "triangles or surfels"},
                                   {kPlanNeedsStaticVpls, "static VPLs"},      {kPlanNeedsMotion, "motion"},
                                   {kPlanNeedsViews, "source views"}};

// PlanNeeds that the frame satisfies.
std::uint32_t broughtBy(const FrameTraits& traits) {
    const auto bit = [](bool has, std::uint32_t need) { return has ? need : 0u; };
    return bit(traits.hasRsms || traits.hasVpls, kPlanNeedsRsms) | bit(traits.hasDirectRadiance, kPlanNeedsRadiance) |
           bit(traits.hasCamera, kPlanNeedsCamera) | bit(traits.triangles + traits.surfels > 0.0, kPlanNeedsGeometry) |
           bit(traits.staticVpls > 0, kPlanNeedsStaticVpls) | bit(traits.hasMotion, kPlanNeedsMotion) |
           bit(traits.hasViews, kPlanNeedsViews);
}

bool allows(std::uint32_t brought, const PlanRow& row) {
    return (row.needs & ~brought) == 0;
}

// A probe that is a share, or what is usual where it is not known.
double shareOf(float probe, double usual) {
    return std::isnan(probe) ? usual : std::clamp(double(probe), 0.0, 1.0);
}

double millisecondsOf(const PlanRow& row, const Calibration& calibration, const FrameTraits& traits, const FrameFigures& probes) {
    const double facing = shareOf(probes.facing, kPlanReference.usualFacing);
    const double coverage = shareOf(probes.coverage, kPlanReference.usualCoverage);
    const double lit = traits.pixels * traits.views * (row.cost[5] + (1.0 - row.cost[5]) * coverage);
    const double million = 1e-6;
    // What a launch takes is part of what was measured as fixed, but grows by its own rate.
    const double launching = std::min(row.launches * kPlanReference.launchMicroseconds * 1e-3, row.cost[0]);
    const double shapes = (traits.triangles + traits.surfels) * million;
    const double drawn = traits.hasMoved ? row.maps * (kPlanMaps.fixed + kPlanMaps.perMtriangles * shapes) : 0.0;
    const double computed = row.cost[0] - launching + (row.cost[1] + row.cost[4] * facing) * lit * million + row.cost[2] * shapes + drawn;
    const auto total = [&](double compute, double texels) {
        return calibration.launchScale * launching + calibration.computeScale * compute + calibration.memoryScale * row.cost[3] * texels * million;
    };
    const double usual = total(computed, traits.rsmTexels);
    return traits.isAtRest ? std::min(usual, total(std::max(computed - row.rest[0], 0.0), row.rest[1] * traits.rsmTexels)) : usual;
}

// Each probe as the error model takes it; NaN: not known.
std::array<double, kPlanProbes> standardised(const LWPlanProbes& probes) {
    const float values[kPlanProbes] = {probes.indirectShare, probes.fluxOnScreen, probes.fluxConcentration, probes.depthComplexity,
                                       probes.extent,        probes.albedo,       probes.facing,            probes.hidden};
    std::array<double, kPlanProbes> result{};
    for (std::size_t k = 0; k < kPlanProbes; ++k) {
        const PlanProbeScale& scale = kPlanScales[k];
        const double value = double(values[k]);
        const double z = (std::log10(std::max(value, scale.floor)) - scale.mean) / scale.deviation;
        result[k] = std::isnan(value) ? value : std::clamp(z, scale.lowest, scale.highest);
    }
    return result;
}

// Probability that a normal residual of this deviation is below a factor of two.
double confidenceOf(double sigma) {
    return sigma > 0.0 ? std::erf(kTwice / (sigma * std::sqrt(2.0))) : 1.0;
}

void predictError(const PlanRow& row, const std::array<double, kPlanProbes>& z, Prediction& prediction) {
    double logarithm = row.errorMean, variance = row.errorSigma * row.errorSigma;
    for (std::size_t k = 0; k < kPlanProbes; ++k) {
        // What is not known lies anywhere among the scenes of the fit, whose mean is 0 and deviation 1.
        if (std::isnan(z[k])) variance += row.errorSlopes[k] * row.errorSlopes[k];
        else logarithm += row.errorSlopes[k] * z[k];
    }
    prediction.error = std::pow(10.0, logarithm);
    prediction.confidence = confidenceOf(std::sqrt(variance));
}

std::string number(double value) {
    char text[32];
    const bool isPlain = value >= 100.0 && value < 1e6;  // two digits would say too little, an exponent is hard to read
    std::snprintf(text, sizeof text, isPlain ? "%.0f" : "%.2g", value);
    return text;
}

std::string nameOf(const Prediction& prediction) {
    const Candidate& candidate = candidates()[prediction.candidate];
    return std::string(candidate.technique) + (*candidate.settings ? " " : "") + candidate.settings;
}

std::string limitOf(double budget) {
    return budget > 0.0 ? " within " + number(budget) + " ms" : "";
}

using Predictions = std::vector<Prediction>;

// The most accurate of the first `count`; of those that are as accurate the quickest.
const Prediction& mostAccurate(const Predictions& predictions, std::size_t count) {
    const auto end = predictions.begin() + std::ptrdiff_t(count);
    const double least = std::min_element(predictions.begin(), end, [](auto& a, auto& b) { return a.error < b.error; })->error;
    return *std::find_if(predictions.begin(), end, [&](const Prediction& one) { return one.error <= kSameError * least; });
}

// Settings that `other` has not, each after a blank; byKey: that it has not at all, whatever their value.
std::string missingIn(const std::string& settings, const std::string& other, bool byKey) {
    std::istringstream words(settings);
    std::string result;
    for (std::string word; words >> word;) {
        const std::string wanted = " " + (byKey ? word.substr(0, word.find('=') + 1) : word + " ");
        if ((" " + other + " ").find(wanted) == std::string::npos) result += " " + word;
    }
    return result;
}

// "lpv", or of the technique that is chosen how it differs, as both together are more than a sentence holds: "ssvp with clusters=32 without
// sampling=view".
std::string besides(const Prediction& other, const Prediction& chosen) {
    const Candidate &a = candidates()[other.candidate], &b = candidates()[chosen.candidate];
    if (std::strcmp(a.technique, b.technique) != 0) return nameOf(other);
    const std::string with = missingIn(a.settings, b.settings, false), without = missingIn(b.settings, a.settings, true);
    return std::string(a.technique) + (with.empty() ? "" : " with" + with) + (without.empty() ? "" : " without" + without);
}

// "; lpv would have 0.2 in 12 ms": what comes next, of the first `count`.
std::string runnerUp(const Predictions& predictions, std::size_t count, const Prediction& chosen) {
    const Prediction* next = nullptr;
    for (std::size_t i = 0; i < count; ++i)
        if (predictions[i].candidate != chosen.candidate && (!next || predictions[i].error < next->error)) next = &predictions[i];
    if (!next) return {};
    return "; " + besides(*next, chosen) + " would have " + number(next->error) + " in " + number(next->milliseconds) + " ms";
}

}  // namespace

bool hasCamera(const LWGBuffer& gbuffer) {
    const auto isSet = [](float value) { return value != 0.0f; };
    return std::any_of(std::begin(gbuffer.camera.view), std::end(gbuffer.camera.view), isSet) ||
           std::any_of(std::begin(gbuffer.camera.projection), std::end(gbuffer.camera.projection), isSet);
}

FrameTraits traitsOf(const LWFrame& frame, const LWGBuffer& gbuffer, double pixels, std::uint32_t views) {
    FrameTraits traits;
    traits.pixels = pixels;
    traits.views = std::max(views, 1u);
    traits.lights = frame.lightCount;
    traits.staticVpls = frame.staticVplCount;
    for (std::uint32_t l = 0; l < frame.lightCount; ++l)
        for (std::uint32_t r = 0; r < frame.lights[l].rsmCount; ++r) {
            const LWImage& flux = frame.lights[l].rsms[r].flux;
            traits.rsmTexels += double(flux.width) * double(flux.height);
        }
    if (frame.geometry) {
        traits.triangles = double(frame.geometry->triangleCount);
        traits.surfels = double(frame.geometry->surfelCount);
    }
    traits.hasRsms = traits.rsmTexels > 0.0;
    traits.hasVpls = frame.vplCount > 0;
    traits.hasViews = frame.sourceViewCount > 0;
    traits.hasDirectRadiance = !imageAbsent(gbuffer.directRadiance);
    traits.hasAlbedo = !imageAbsent(gbuffer.albedo);
    traits.hasMotion = !imageAbsent(gbuffer.motion);
    traits.hasCamera = hasCamera(gbuffer);
    return traits;
}

Calibration calibrationOf(Device& device) {
    const LWRoofline& rates = knownRoofline(device);
    return {kPlanReference.multiplyAddGflops / rates.multiplyAddGflops, kPlanReference.bandwidthGBps / rates.bandwidthGBps,
            rates.launchMicroseconds / kPlanReference.launchMicroseconds};
}

const std::vector<Candidate>& candidates() {
    static const std::vector<Candidate> all = [] {
        std::vector<Candidate> list;
        for (const PlanRow& row : kPlanRows) list.push_back({row.technique, row.settings});
        return list;
    }();
    return all;
}

std::vector<Prediction> predict(const Calibration& calibration, const FrameTraits& traits, const FrameFigures& probes) {
    const std::uint32_t brought = broughtBy(traits);
    const std::array<double, kPlanProbes> z = standardised(probes);
    Predictions predictions;
    for (std::size_t i = 0; i < std::size(kPlanRows); ++i) {
        if (!allows(brought, kPlanRows[i])) continue;
        Prediction prediction;
        prediction.candidate = i;
        prediction.milliseconds = millisecondsOf(kPlanRows[i], calibration, traits, probes);
        predictError(kPlanRows[i], z, prediction);
        predictions.push_back(prediction);
    }
    std::stable_sort(predictions.begin(), predictions.end(),
                     [](const Prediction& a, const Prediction& b) { return a.milliseconds < b.milliseconds; });
    return predictions;
}

std::string missingFor(const FrameTraits& traits) {
    std::uint32_t missing = 0;
    for (const PlanRow& row : kPlanRows) missing |= row.needs & ~broughtBy(traits);
    std::string names;
    for (const NeedName& need : kNeedNames)
        if (missing & need.need) names += (names.empty() ? "" : ", ") + std::string(need.name);
    return names;
}

Choice choose(const std::vector<Prediction>& predictions, double budgetMilliseconds, double errorTarget) {
    if (predictions.empty()) fail(LW_ERROR_INTERNAL, "planner: expected predictions to choose from, got none");
    const auto isDear = [&](const Prediction& one) { return budgetMilliseconds > 0.0 && one.milliseconds > budgetMilliseconds; };
    const auto affordable = std::size_t(std::find_if(predictions.begin(), predictions.end(), isDear) - predictions.begin());
    const std::string limit = limitOf(budgetMilliseconds), possible = "of " + std::to_string(predictions.size()) + " possible";
    Choice choice;
    if (affordable == 0) {
        const double quickest = predictions.front().milliseconds;
        const auto isSlow = [&](const Prediction& one) { return one.milliseconds > kSameTime * quickest; };
        choice.prediction = mostAccurate(predictions, std::size_t(std::find_if(predictions.begin(), predictions.end(), isSlow) - predictions.begin()));
        choice.isWithinBudget = false;
        choice.reachesError = !(errorTarget > 0.0) || choice.prediction.error <= errorTarget;
        choice.reason = nameOf(choice.prediction) + ": " + possible + " none is predicted to stay" + limit + "; this is about as quick (" +
                        number(choice.prediction.milliseconds) + " ms) as the quickest (" + number(quickest) + " ms), and the most accurate of those";
        return choice;
    }
    const auto affordableEnd = predictions.begin() + std::ptrdiff_t(affordable);
    const auto reaches = [&](const Prediction& one) { return one.error <= errorTarget; };
    const auto cheapest = std::find_if(predictions.begin(), affordableEnd, reaches);
    if (errorTarget > 0.0 && cheapest != affordableEnd) {
        choice.prediction = *cheapest;
        choice.reason = nameOf(*cheapest) + ": " + possible + ", the cheapest (" + number(cheapest->milliseconds) + " ms) predicted to reach " +
                        number(errorTarget) + limit + ", with " + number(cheapest->error);
        return choice;
    }
    choice.prediction = mostAccurate(predictions, affordable);
    choice.reachesError = !(errorTarget > 0.0);
    const std::string missed = choice.reachesError ? "" : " (none reaches " + number(errorTarget) + ")";
    choice.reason = nameOf(choice.prediction) + ": " + possible + ", the least predicted error (" + number(choice.prediction.error) + ")" + limit +
                    missed + runnerUp(predictions, affordable, choice.prediction);
    return choice;
}

}  // namespace lightwell
