// `lightwell split`: for each view and set of parameters a few patterns of VPLs, each rendered as asked
// for, at full resolution, and summed with exact visibility; shares go to split.json, point by point.
#include "split_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "build_identity.h"
#include "chart_point.h"
#include "chart_results.h"
#include "cli.h"
#include "error_split.h"
#include "indirect_renderer.h"
#include "interrupt.h"
#include "layers.h"
#include "open_device.h"
#include "path_tracer.h"
#include "progress.h"
#include "run_facts.h"
#include "vpl_view.h"

namespace cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSplitFormat = "lightwell-split 1";
constexpr const char* kProtocol = "split 2";  // raise it when the way of measuring changes

// Values at which a technique's pictures are not coarsened, of whichever of the parameters it has
// (docs/adding-a-technique.md).
constexpr std::pair<const char*, const char*> kFullResolution[] = {{"resolution", "full"},
                                                                   {"interleave", "1"}};

Parameters withSeed(Parameters parameters, int seed) {
    parameters.setEverywhere("seed", std::to_string(seed));
    return parameters;
}

Parameters atFullResolution(Parameters parameters) {
    for (const auto& [name, value] : kFullResolution)
        parameters.setEverywhere(name, value);
    return parameters;
}

class Splitter {
public:
    explicit Splitter(const SplitOptions& options);
    void run();

private:
    Json describeRun() const;
    void splitView(ChartView& view);
    void dropOthers(const ChartView& view);
    void traceTruths(ChartView& view);
    std::string pointKey(const ChartView& view, const ChartedPoint& point) const;
    Json splitPoint(const ChartView& view, const ChartedPoint& point,
                    const std::function<void(double ofPoint, const std::string& of)>& progress);
    studio::Image render(const ChartView& view, const Parameters& parameters,
                         std::vector<studio::VplRecord>* vpls);
    studio::Image sumExactly(const ChartView& view, const studio::GBuffer& judged,
                             const std::vector<studio::VplRecord>& vpls,
                             const std::function<void(double)>& progress) const;
    void report(double ofView, const std::string& note);
    const JudgedTruth& allBounces(const ChartView& view, const JudgedTruth& own) const;

    const SplitOptions& options_;
    ChartResults results_;
    std::vector<ChartedPoint> points_;
    std::set<std::string> knownToSplit_;  // techniques
    std::optional<lightwell::Device> device_;
    LWDeviceInfo info_{};
    std::string build_ = buildIdentity();
    studio::ProgressLine line_{"splitting"};
    double viewsBefore_ = 0.0, viewShare_ = 1.0;  // of the whole, in [0,1]
};

Splitter::Splitter(const SplitOptions& options)
    : options_(options),
      results_((std::filesystem::path(options.folder) / "split.json").string(), kSplitFormat),
      points_(chartedPoints(options.techniques, options.only.empty(), options.only)) {
    if (options.only.empty())
        points_.erase(
            std::remove_if(points_.begin(), points_.end(),
                           [](const ChartedPoint& point) { return point.sweep.label.empty(); }),
            points_.end());
    device_ = openDevice(options.device, std::uint32_t(options.deviceWidth));
    info_ = device_->info();
}

Json Splitter::describeRun() const {
    Json header;
    header["written"] = utcNow();
    header["device"] = deviceJson(info_);
    header["versions"] = versionsJson();
    header["load_average"] = loadAverage();
    header["size"] = {options_.width, options_.height};
    header["patterns"] = options_.patterns;
    header["build"] = build_;
    header["noise_target"] = options_.truth.noise;
    header["judged_block"] = options_.truth.block;
    return header;
}

void Splitter::run() {
    results_.setHeader(describeRun());
    results_.save();
    for (std::size_t i = 0; i < options_.scenes.size(); ++i) {
        const auto scene = asUsage(
            [&] { return std::make_shared<studio::Scene>(studio::loadScene(options_.scenes[i])); });
        const auto rayScene = asUsage([&] { return std::make_shared<studio::RayScene>(scene, 0.0f); });
        const auto cameras = stillCameras(*scene, options_.firstCameraOnly);
        viewShare_ = 1.0 / double(options_.scenes.size()) / double(cameras.size());
        for (std::size_t c = 0; c < cameras.size(); ++c) {
            viewsBefore_ = double(i) / double(options_.scenes.size()) + double(c) * viewShare_;
            InputOptions input;
            input.width = options_.width;
            input.height = options_.height;
            ChartView view(rayScene, scene->cameras[cameras[c]], input);
            dropOthers(view);
            if (points_.empty()) return;  // the notes have said why; no truth is needed
            traceTruths(view);
            if (view.isBlack())
                fmt::print(stderr, "note: {} has no indirect light and is left out\n", view.id());
            else
                splitView(view);
        }
    }
    line_.finish(fmt::format("{} splits", results_.pointCount()));
}

void Splitter::report(double ofView, const std::string& note) {
    line_.update(viewsBefore_ + ofView * viewShare_, note);
    if (InterruptGuard::wasRaised())
        throw Interrupted("interrupted; the same command goes on from " + options_.folder +
                          "/split.json");
}

// Techniques that gather from no VPLs, as their first frame tells.
void Splitter::dropOthers(const ChartView& view) {
    std::map<std::string, bool> hasVpls;
    for (const ChartedPoint& point : points_) {
        const std::string& technique = point.sweep.parameters.technique();
        if (knownToSplit_.count(technique) != 0 || hasVpls.count(technique) != 0) continue;
        const auto renderer = makeRenderer(point.sweep.parameters, view.inputs(), &*device_);
        renderer->renderFrame(view.inputs(), true);
        hasVpls[technique] = renderer->hasDebugView(kVplView);
        if (hasVpls[technique])
            knownToSplit_.insert(technique);
        else
            fmt::print(stderr, "note: {} has no debug view \"{}\"; its error is not split\n", technique,
                       kVplView);
    }
    points_.erase(std::remove_if(points_.begin(), points_.end(),
                                 [&](const ChartedPoint& point) {
                                     return knownToSplit_.count(point.sweep.parameters.technique()) == 0;
                                 }),
                  points_.end());
}

void Splitter::traceTruths(ChartView& view) {
    std::set<int> bounces;
    for (const ChartedPoint& point : points_) bounces.insert(modelledBounces(point.sweep.parameters));
    if (!options_.skipsAllBounces) bounces.insert(0);
    TruthOptions truth = options_.truth;
    studio::ProgressLine line("truth of " + view.id());
    truth.progress = [&](double fraction, double noise) {
        line.update(fraction, noise < 0.0 ? "" : fmt::format("noise (relMSE) {:.2e}", noise));
        if (InterruptGuard::wasRaised())
            throw Interrupted("interrupted; the same command goes on with this truth");
    };
    view.obtainTruths(bounces, truth);
    line.finish();
}

std::string Splitter::pointKey(const ChartView& view, const ChartedPoint& point) const {
    std::string text = fmt::format("{} {} {} {} {} {} {} {}", kProtocol, build_, view.hash(),
                                   options_.patterns, parametersJson(point.sweep.parameters).dump(),
                                   info_.name, info_.driver, info_.width);
    for (const auto& [bounces, judged] : view.truths())
        text += fmt::format(" {} {}", judged.truth.name, judged.truth.samples);
    return shortHash(filesKey(point.sweep.parameters) + text);
}

void Splitter::splitView(ChartView& view) {
    Json truths = Json::array();
    for (const auto& [bounces, judged] : view.truths())
        truths.push_back(
            {{"bounces", bounces}, {"noise", judged.truth.noise}, {"samples", judged.truth.samples}});
    results_.putView({{"id", view.id()},
                      {"scene", view.sceneName()},
                      {"camera", view.cameraName()},
                      {"truths", truths}});
    for (std::size_t i = 0; i < points_.size(); ++i) {
        const ChartedPoint& point = points_[i];
        const JudgedTruth& own = view.truths().at(modelledBounces(point.sweep.parameters));
        if (allBounces(view, own).isBlack) continue;  // nothing that the error could be relative to
        const std::string id = pointId(view, point), key = pointKey(view, point);
        if (results_.find(id, key) != nullptr) continue;
        const std::string note = fmt::format("{}, {} {}", view.id(), point.sweep.parameters.technique(),
                                             describeDifference(point.sweep.parameters));
        const auto progress = [&](double ofPoint, const std::string& of) {
            report((double(i) + ofPoint) / double(points_.size()), note + of);
        };
        Json json = splitPoint(view, point, progress);
        json["id"] = id;
        json["key"] = key;
        results_.putPoint(std::move(json));
        results_.save();
    }
}

studio::Image Splitter::render(const ChartView& view, const Parameters& parameters,
                               std::vector<studio::VplRecord>* vpls) {
    const auto renderer = makeRenderer(parameters, view.inputs(), &*device_);
    renderer->renderFrame(view.inputs(), true);
    if (vpls != nullptr) *vpls = readVplView(*renderer);
    studio::Image image(options_.width, options_.height);
    addLayer(image, "", renderer->irradiance());
    return image;
}

studio::Image Splitter::sumExactly(const ChartView& view, const studio::GBuffer& judged,
                                   const std::vector<studio::VplRecord>& vpls,
                                   const std::function<void(double)>& progress) const {
    studio::PathTracerOptions tracer;
    tracer.vpls = &vpls;
    tracer.progress = [&](double fraction, double) { progress(fraction); };
    const studio::Image traced = studio::tracePaths(view.inputs().scene(), judged, tracer);
    studio::Image image(judged.width, judged.height);
    for (const char* channel : {"R", "G", "B"})
        image.plane(channel) = traced.plane(std::string("bounce1.") + channel);
    return image;
}

const JudgedTruth& Splitter::allBounces(const ChartView& view, const JudgedTruth& own) const {
    const auto all = view.truths().find(0);
    return all == view.truths().end() ? own : all->second;
}

Json Splitter::splitPoint(const ChartView& view, const ChartedPoint& point,
                          const std::function<void(double ofPoint, const std::string& of)>& progress) {
    const JudgedTruth& own = view.truths().at(modelledBounces(point.sweep.parameters));
    const JudgedTruth& all = allBounces(view, own);
    studio::ErrorSplitter splitter(own.truth.image, all.truth.image);
    const int patterns = point.sweep.parameters.hasAnywhere("seed") ? options_.patterns : 1;
    const studio::GBuffer judged = view.picks().pick(view.inputs().gbuffer());
    std::size_t vplCount = 0;
    for (int seed = 0; seed < patterns; ++seed) {
        const auto ofPattern = [&](double fraction) {
            progress((seed + fraction) / patterns,
                     fmt::format(", pattern {} of {}", seed + 1, patterns));
        };
        ofPattern(0.0);
        const Parameters parameters = withSeed(point.sweep.parameters, seed);
        std::vector<studio::VplRecord> vpls;
        const studio::Image rendered = render(view, parameters, &vpls);
        const studio::Image full = render(view, atFullResolution(parameters), nullptr);
        splitter.add(view.picks().pick(rendered), view.picks().pick(full),
                     sumExactly(view, judged, vpls, ofPattern));
        vplCount = vpls.size();
    }
    const studio::ErrorSplit split = splitter.result();
    Json shares = {{"model", split.model},
                   {"resolution", split.resolution},
                   {"visibility", split.visibility},
                   {"sampling", nullptr},
                   {"bounding", split.bounding}};
    if (split.sampling) shares["sampling"] = *split.sampling;
    return {{"scene", view.sceneName()},
            {"camera", view.cameraName()},
            {"size", {options_.width, options_.height}},
            {"technique", point.sweep.parameters.technique()},
            {"label", point.sweep.label},
            {"settings", describeDifference(point.sweep.parameters)},
            {"parameters", parametersJson(point.sweep.parameters)},
            {"vpls", vplCount},
            {"patterns", patterns},
            {"bounces", own.truth.bounces},
            {"truth_of_all_bounces", all.truth.bounces == 0},
            {"total", split.total},
            {"shares", shares},
            {"noise", own.truth.noise},
            {"noise_of_total", all.truth.noise}};
}

}  // namespace

void runSplit(const SplitOptions& options) {
    Splitter(options).run();
}

}  // namespace cli
