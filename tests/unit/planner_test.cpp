// The planner's arithmetic: what a frame allows, what that costs and errs by, what is chosen and why; and the device's rates, kept.
#include "planner/planner.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <fstream>
#include <set>

#include "compute/roofline.h"
#include "planner/plan_tables.h"
#include "support/errors.h"
#include "support/kernel_rig.h"
#include "support/scoped.h"
#include "support/test_device.h"
#include "techniques/from_text.h"

using namespace lightwell;
using namespace lightwell::test;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

const LWPlanProbes kNoProbes = [] {
    const float none = std::nanf("");
    return LWPlanProbes{none, none, none, none, none, none, none, none};
}();

// A frame that brings all that a technique can ask for.
FrameTraits everything() {
    FrameTraits traits;
    traits.pixels = 1280.0 * 720.0;
    traits.rsmTexels = 512.0 * 512.0;
    traits.triangles = 1e4;
    traits.lights = 1;
    traits.staticVpls = 100;
    traits.hasRsms = traits.hasVpls = traits.hasDirectRadiance = traits.hasAlbedo = traits.hasCamera = traits.hasMotion = traits.hasViews = true;
    return traits;
}

const Prediction* find(const std::vector<Prediction>& predictions, std::size_t candidate) {
    for (const Prediction& each : predictions)
        if (each.candidate == candidate) return &each;
    return nullptr;
}

// Of made-up candidates, quickest first: milliseconds and errors.
std::vector<Prediction> made(const std::vector<std::pair<double, double>>& figures) {
    std::vector<Prediction> predictions;
    for (std::size_t i = 0; i < figures.size(); ++i) predictions.push_back({i, figures[i].first, figures[i].second, 0.5});
    return predictions;
}

std::string keyPath(Device& device) { return device.programs().store().path(rooflineKey(device)); }

// Devices of one description, with a cache of their own.
struct CachedDevices {
    ScopedDirectory cache;
    std::string directory = cache.string();
    Log log;
    LWDeviceDesc desc = plainDesc();

    CachedDevices() {
        desc.width = 16;
        desc.cacheDirectory = directory.c_str();
        log.attach(desc);
    }
};

}  // namespace

TEST_CASE("the planner's table holds techniques that can be made, each once, and figures that can be", "[planner]") {
    std::set<std::pair<std::string, std::string>> seen;
    REQUIRE(std::size(kPlanRows) > 5);
    CHECK(candidates().size() == std::size(kPlanRows));
    for (const PlanRow& row : kPlanRows) {
        INFO(row.technique << " " << row.settings);
        CHECK_NOTHROW(parseTechnique(row.technique, row.settings));
        CHECK(seen.insert({row.technique, row.settings}).second);
        CHECK(std::string(row.technique).size() < sizeof LWPlan::technique);
        CHECK(std::string(row.settings).size() < sizeof LWPlan::parameters);
        CHECK((row.needs & ~127u) == 0);
        for (const double cost : row.cost) CHECK((cost >= 0.0 && std::isfinite(cost)));
        CHECK((std::isfinite(row.rest[0]) && row.rest[1] >= 0.0 && row.rest[1] <= 1.0));
        // What keeps all of its light at rest reads no texel, however large the maps.
        const std::string technique = row.technique, settings = row.settings;
        const bool keeps = technique == "ssvp" && settings.find("sampling=view") == std::string::npos;
        CHECK((row.rest[1] == 0.0) == keeps);
        CHECK((row.rest[0] == 0.0 || keeps));
        CHECK(row.cost[0] + row.cost[1] > 0.0);
        CHECK((row.launches >= 0.0 && std::isfinite(row.errorMean)));
        CHECK((row.errorSigma > 0.0 && row.errorSigma < 5.0));
        for (const double slope : row.errorSlopes) CHECK(std::isfinite(slope));
    }
    for (const PlanProbeScale& scale : kPlanScales) {
        INFO(scale.name);
        CHECK(scale.floor > 0.0);
        CHECK(scale.deviation > 0.0);
        CHECK(scale.lowest < scale.highest);
    }
    CHECK(kPlanReference.multiplyAddGflops > 0.0);
    CHECK(kPlanReference.bandwidthGBps > 0.0);
    CHECK(kPlanReference.launchMicroseconds > 0.0);
    CHECK((kPlanReference.usualFacing > 0.0 && kPlanReference.usualFacing <= 1.0));
    CHECK((kPlanReference.usualCoverage > 0.0 && kPlanReference.usualCoverage <= 1.0));
}

TEST_CASE("a frame allows what it brings the inputs for", "[planner]") {
    CHECK(predict({}, everything(), kNoProbes).size() == candidates().size());
    CHECK(missingFor(everything()).empty());
    CHECK(predict({}, FrameTraits{}, kNoProbes).empty());
    // Without each input exactly those are out that need it.
    const auto without = [](std::uint32_t need, auto take) {
        FrameTraits traits = everything();
        take(traits);
        const auto predictions = predict({}, traits, kNoProbes);
        for (std::size_t i = 0; i < std::size(kPlanRows); ++i) CHECK((find(predictions, i) != nullptr) == ((kPlanRows[i].needs & need) == 0));
        bool isNeeded = false;
        for (const PlanRow& row : kPlanRows) isNeeded = isNeeded || (row.needs & need) != 0;
        CHECK(missingFor(traits).empty() == !isNeeded);
    };
    without(kPlanNeedsRsms, [](FrameTraits& t) { t.hasRsms = t.hasVpls = false; });
    without(0, [](FrameTraits& t) { t.hasRsms = false; });  // the host's VPLs do as well
    without(kPlanNeedsRadiance, [](FrameTraits& t) { t.hasDirectRadiance = false; });
    without(kPlanNeedsCamera, [](FrameTraits& t) { t.hasCamera = false; });
    without(kPlanNeedsGeometry, [](FrameTraits& t) { t.triangles = 0.0; });
    without(kPlanNeedsStaticVpls, [](FrameTraits& t) { t.staticVpls = 0; });
    without(kPlanNeedsMotion, [](FrameTraits& t) { t.hasMotion = false; });
    without(kPlanNeedsViews, [](FrameTraits& t) { t.hasViews = false; });
    FrameTraits bare = everything();
    bare.hasRsms = bare.hasVpls = false;
    CHECK_THAT(missingFor(bare), StartsWith("RSMs"));
}

TEST_CASE("predicted times follow the frame's sizes and the device's rates", "[planner]") {
    const FrameTraits traits = everything();
    const auto plain = predict({}, traits, kNoProbes);
    for (std::size_t i = 1; i < plain.size(); ++i) CHECK(plain[i - 1].milliseconds <= plain[i].milliseconds);
    FrameTraits stereo = traits, bare = traits, moved = traits, resting = traits;
    moved.hasMoved = true;
    resting.isAtRest = true;
    bool hasMaps = false, keeps = false;
    stereo.views = 2;
    bare.pixels = bare.rsmTexels = bare.triangles = 0.0;
    bare.surfels = 1e-30;  // there, but next to none
    for (const Prediction& each : plain) {
        const PlanRow& row = kPlanRows[each.candidate];
        INFO(row.technique << " " << row.settings);
        const double whole = traits.pixels * 1e-6, texels = traits.rsmTexels * 1e-6, triangles = traits.triangles * 1e-6;
        // Not told how many pixels show a surface, nor how many pairs face each other: as many as usual.
        const double pixels = whole * (row.cost[5] + (1.0 - row.cost[5]) * kPlanReference.usualCoverage);
        const double perPixel = row.cost[1] + row.cost[4] * kPlanReference.usualFacing;
        CHECK(each.milliseconds == Approx(row.cost[0] + perPixel * pixels + row.cost[2] * triangles + row.cost[3] * texels));
        LWPlanProbes all = kNoProbes;
        all.facing = 1.0f;
        const auto faced = predict({}, traits, all);
        CHECK(find(faced, each.candidate)->milliseconds - each.milliseconds ==
              Approx(row.cost[4] * (1.0 - kPlanReference.usualFacing) * pixels).margin(1e-9));
        // Sky takes its share of what a surface takes, no more than that.
        FrameFigures half = all, sky = all;
        half.coverage = 0.5f;
        sky.coverage = 0.0f;
        CHECK(find(predict({}, traits, half), each.candidate)->milliseconds - find(predict({}, traits, sky), each.candidate)->milliseconds ==
              Approx(0.5 * (1.0 - row.cost[5]) * (row.cost[1] + row.cost[4]) * whole).margin(1e-9));
        CHECK(find(predict({}, traits, sky), each.candidate)->milliseconds ==
              Approx(row.cost[0] + row.cost[5] * (row.cost[1] + row.cost[4]) * whole + row.cost[2] * triangles + row.cost[3] * texels));
        CHECK(row.cost[5] <= 1.0);
        hasMaps = hasMaps || row.maps > 0.0;
        CHECK(find(predict({}, moved, kNoProbes), each.candidate)->milliseconds - each.milliseconds ==
              Approx(row.maps * (kPlanMaps.fixed + kPlanMaps.perMtriangles * triangles)).margin(1e-9));
        // At rest less is computed and fewer texels are read, whatever the views; never more than else.
        const double rested = find(predict({}, resting, kNoProbes), each.candidate)->milliseconds;
        const double saved = row.rest[0] + (1.0 - row.rest[1]) * row.cost[3] * texels;
        keeps = keeps || saved > 1.0;
        CHECK(each.milliseconds - rested == Approx(std::max(saved, 0.0)).margin(1e-9));
        FrameTraits restingStereo = resting, large = resting;
        restingStereo.views = 2;
        large.rsmTexels *= 6.0;
        CHECK(find(predict({}, restingStereo, kNoProbes), each.candidate)->milliseconds - rested == Approx(perPixel * pixels).margin(1e-9));
        CHECK(find(predict({}, large, kNoProbes), each.candidate)->milliseconds - rested == Approx(5.0 * row.rest[1] * row.cost[3] * texels).margin(1e-9));
        CHECK(find(predict({2.0, 2.0, 2.0}, resting, kNoProbes), each.candidate)->milliseconds == Approx(2.0 * rested));
        CHECK(find(predict({1.0, 2.0, 1.0}, resting, kNoProbes), each.candidate)->milliseconds - rested == Approx(row.rest[1] * row.cost[3] * texels).margin(1e-9));
        const auto twice = predict({}, stereo, kNoProbes), none = predict({}, bare, kNoProbes);
        CHECK(find(twice, each.candidate)->milliseconds - each.milliseconds == Approx(perPixel * pixels).margin(1e-12));
        CHECK(find(none, each.candidate)->milliseconds == Approx(row.cost[0]).margin(1e-12));
        // All rates half: all twice as long. Only memory half: only the texels.
        const auto slow = predict({2.0, 2.0, 2.0}, traits, kNoProbes), starved = predict({1.0, 2.0, 1.0}, traits, kNoProbes);
        CHECK(find(slow, each.candidate)->milliseconds == Approx(2.0 * each.milliseconds));
        CHECK(find(starved, each.candidate)->milliseconds - each.milliseconds == Approx(row.cost[3] * texels).margin(1e-12));
    }
    CHECK((hasMaps && keeps));
    resting.pixels = resting.triangles = 0.0;
    resting.surfels = 1e-30;
    const auto quiet = predict({}, resting, kNoProbes);
    resting.isAtRest = false;
    for (const Prediction& each : quiet) CHECK((each.milliseconds >= 0.0 && each.milliseconds <= find(predict({}, resting, kNoProbes), each.candidate)->milliseconds));
}

TEST_CASE("predicted errors follow the probes, within the fit's range", "[planner]") {
    const auto unknown = predict({}, everything(), kNoProbes);
    for (const Prediction& each : unknown) {
        const PlanRow& row = kPlanRows[each.candidate];
        INFO(row.technique << " " << row.settings);
        CHECK(std::log10(each.error) == Approx(row.errorMean).margin(1e-12));
        double variance = row.errorSigma * row.errorSigma;
        for (const double slope : row.errorSlopes) variance += slope * slope;
        CHECK(each.confidence == Approx(std::erf(std::log10(2.0) / std::sqrt(2.0 * variance))));
    }
    // The mean of all probes of the fit says the same, with the fit's own confidence; beyond its range nothing changes.
    float means[kPlanProbes], low[kPlanProbes], lower[kPlanProbes];
    for (std::size_t k = 0; k < kPlanProbes; ++k) {
        const PlanProbeScale& s = kPlanScales[k];
        means[k] = float(std::pow(10.0, s.mean));
        low[k] = float(std::pow(10.0, s.mean + s.lowest * s.deviation));
        lower[k] = 0.0f;
    }
    const auto probes = [](const float (&v)[kPlanProbes]) { return LWPlanProbes{v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7]}; };
    const auto known = predict({}, everything(), probes(means)), least = predict({}, everything(), probes(low)),
               none = predict({}, everything(), probes(lower));
    for (const Prediction& each : known) {
        const PlanRow& row = kPlanRows[each.candidate];
        CHECK(std::log10(each.error) == Approx(row.errorMean).margin(1e-5));
        CHECK(each.confidence == Approx(std::erf(std::log10(2.0) / (row.errorSigma * std::sqrt(2.0)))));
        double expected = row.errorMean;
        for (std::size_t k = 0; k < kPlanProbes; ++k) {
            const PlanProbeScale& s = kPlanScales[k];
            expected += row.errorSlopes[k] * std::max(s.lowest, (std::log10(s.floor) - s.mean) / s.deviation);
        }
        CHECK(std::log10(find(none, each.candidate)->error) == Approx(expected).margin(1e-5));
        CHECK(std::isfinite(find(least, each.candidate)->error));
    }
}

TEST_CASE("the choice is the most accurate within the budget, or the cheapest that is accurate enough", "[planner]") {
    // The quickest is not the worst, and two are as good as each other.
    const auto predictions = made({{2.0, 0.8}, {4.0, 0.9}, {8.0, 0.3}, {16.0, 0.1}, {17.0, 0.0995}, {40.0, 0.05}});
    const auto chosen = [&](double budget, double target) { return choose(predictions, budget, target); };
    CHECK(chosen(0.0, 0.0).prediction.candidate == 5);
    CHECK(chosen(33.0, 0.0).prediction.candidate == 3);  // within two hundredths as accurate as the next, and quicker
    CHECK(chosen(16.0, 0.0).prediction.candidate == 3);
    CHECK(chosen(15.9, 0.0).prediction.candidate == 2);
    CHECK(chosen(5.0, 0.0).prediction.candidate == 0);
    const Choice all = chosen(33.0, 0.0);
    CHECK(all.isWithinBudget);
    CHECK(all.reachesError);
    CHECK_THAT(all.reason, Contains("of 6 possible") && Contains("least predicted error (0.1)") && Contains("33 ms") && Contains("would have 0.1 in 17 ms"));

    const Choice tight = chosen(1.0, 0.0);
    CHECK(tight.prediction.candidate == 0);
    CHECK_FALSE(tight.isWithinBudget);
    CHECK(tight.reachesError);
    CHECK_THAT(tight.reason, Contains("none is predicted to stay within 1 ms") && Contains("quickest (2 ms)"));
    CHECK_FALSE(chosen(1.0, 0.5).reachesError);
    // Late anyway: a little later for much less error, and no later than that.
    const Choice late = choose(made({{2.0, 0.8}, {2.08, 0.1}, {2.2, 0.01}}), 1.0, 0.2);
    CHECK(late.prediction.candidate == 1);
    CHECK_FALSE(late.isWithinBudget);
    CHECK(late.reachesError);

    const Choice cheap = chosen(33.0, 0.35);
    CHECK(cheap.prediction.candidate == 2);
    CHECK(cheap.reachesError);
    CHECK_THAT(cheap.reason, Contains("cheapest") && Contains("0.35") && Contains("0.3"));
    CHECK(chosen(0.0, 0.06).prediction.candidate == 5);
    const Choice missed = chosen(33.0, 0.06);
    CHECK(missed.prediction.candidate == 3);
    CHECK(missed.isWithinBudget);
    CHECK_FALSE(missed.reachesError);
    CHECK_THAT(missed.reason, Contains("none reaches 0.06"));
    CHECK(choose(made({{2.0, 0.8}}), 0.0, 0.0).reason.find("would") == std::string::npos);
    CHECK_THAT(chosen(3e38, 0.0).reason, Contains("within 3e+38 ms"));
    CHECK_THAT(chosen(12345.0, 0.0).reason, Contains("within 12345 ms"));
    CHECK_THROWS_AS(choose({}, 1.0, 0.0), Error);
    // A sentence of whatever the table holds fits into LWPlan.
    for (const double budget : {0.0, 1e-3, 5.0, 33.333333})
        for (const double target : {0.0, 1e-6, 0.1, 100.0}) {
            const Choice each = choose(predict({1.234567e4, 1.0, 1.0}, everything(), kNoProbes), budget, target);
            INFO(each.reason);
            CHECK(each.reason.size() < sizeof LWPlan::reason);
        }
}

TEST_CASE("traits are those of the frame", "[planner]") {
    LWFrame frame{};
    LWGBuffer gbuffer{};
    LWLight lights[2] = {};
    LWRsm rsms[2] = {};
    rsms[0].flux.width = 64, rsms[0].flux.height = 32;
    rsms[1].flux.width = 10, rsms[1].flux.height = 10;
    lights[1].rsms = rsms;
    lights[1].rsmCount = 2;
    frame.lights = lights;
    FrameTraits traits = traitsOf(frame, gbuffer, 200.0, 0);
    CHECK((traits.views == 1 && traits.pixels == 200.0 && traits.rsmTexels == 0.0));
    CHECK_FALSE((traits.hasRsms || traits.hasVpls || traits.hasAlbedo || traits.hasDirectRadiance || traits.hasCamera || traits.hasMotion || traits.hasViews));
    frame.lightCount = 2;
    frame.sourceViewCount = 1;
    frame.vplCount = 3;
    frame.staticVplCount = 4;
    LWGeometry geometry{};
    geometry.triangleCount = 5;
    geometry.surfelCount = 6;
    frame.geometry = &geometry;
    for (LWImage* image : {&gbuffer.albedo, &gbuffer.directRadiance, &gbuffer.motion}) image->host = &frame;
    gbuffer.camera.projection[5] = 1.0f;
    traits = traitsOf(frame, gbuffer, 200.0, 2);
    CHECK((traits.rsmTexels == 64.0 * 32.0 + 100.0 && traits.views == 2 && traits.lights == 2 && traits.staticVpls == 4));
    CHECK((traits.triangles == 5.0 && traits.surfels == 6.0));
    CHECK((traits.hasRsms && traits.hasVpls && traits.hasAlbedo && traits.hasDirectRadiance && traits.hasCamera && traits.hasMotion && traits.hasViews));
}

TEST_CASE("a device's rates are measured once, and kept on disk", "[planner][large]") {
    CachedDevices devices;
    Log& log = devices.log;
    LWDeviceDesc& desc = devices.desc;
    Device first(desc);
    const LWRoofline& measured = knownRoofline(first);
    CHECK(&knownRoofline(first) == &measured);
    CHECK(std::filesystem::exists(keyPath(first)));
    const Calibration calibration = calibrationOf(first);
    CHECK(calibration.computeScale == Approx(kPlanReference.multiplyAddGflops / measured.multiplyAddGflops));
    CHECK(calibration.memoryScale == Approx(kPlanReference.bandwidthGBps / measured.bandwidthGBps));
    CHECK(calibration.launchScale == Approx(measured.launchMicroseconds / kPlanReference.launchMicroseconds));

    // Another device of the kind has the same numbers without measuring: building, let alone half a second of runs, would show.
    Device second(desc);
    CHECK(std::memcmp(&knownRoofline(second), &measured, sizeof measured) == 0);
    CHECK(second.programs().built() + second.programs().loaded() == 0);
    CHECK(log.lines.empty());
    // Whoever measures on purpose replaces them, for devices to come as well.
    const LWRoofline renewed = renewRoofline(second);
    CHECK(std::memcmp(&knownRoofline(second), &renewed, sizeof renewed) == 0);
    Device third(desc);
    CHECK(std::memcmp(&knownRoofline(third), &renewed, sizeof renewed) == 0);
    // Another width is another device.
    desc.width = 1;
    Device narrow(desc);
    CHECK(keyPath(narrow) != keyPath(first));
}

TEST_CASE("a damaged file of rates is measured anew, and logged", "[planner][large]") {
    CachedDevices devices;
    Log& log = devices.log;
    LWDeviceDesc& desc = devices.desc;
    Device device(desc);
    // Whole, by its checksum, but of another size; or holding no rates.
    const std::string path = keyPath(device);
    LWRoofline none{};
    none.structSize = sizeof none;
    none.bandwidthGBps = -1.0;
    const auto* bytes = reinterpret_cast<const unsigned char*>(&none);
    const BinaryStore& store = device.programs().store();
    SECTION("no rates") { CHECK_FALSE(store.write(rooflineKey(device), {bytes, bytes + sizeof none})); }
    SECTION("too short") { CHECK_FALSE(store.write(rooflineKey(device), {1, 2, 3})); }
    SECTION("no store's file") { std::ofstream(path) << "garbage"; }
    CHECK(knownRoofline(device).bandwidthGBps > 0.0);
    CHECK(log.count(LW_LOG_WARNING) == 1);
    CHECK(log.says("damaged"));
    BinaryStore::Bytes kept;
    CHECK(store.read(rooflineKey(device), kept) == BinaryStore::Found::kYes);
    CHECK(std::memcmp(kept.data(), &knownRoofline(device), sizeof(LWRoofline)) == 0);
}
