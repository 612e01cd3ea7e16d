// `lightwell chart`: times every point of every view, judges it against the view's truth, keeps results.json.
// A little over 300 lines: one class whose members share the run's state; the views, frames, references and
// sweeps it works on have files of their own.
#include "chart_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "build_identity.h"
#include "chart_frames.h"
#include "chart_judge.h"
#include "chart_results.h"
#include "cli.h"
#include "film.h"
#include "interrupt.h"
#include "layers.h"
#include "open_device.h"
#include "parallel.h"
#include "progress.h"
#include "sweep.h"

namespace cli {
namespace {

using Json = nlohmann::ordered_json;

// Part of every point's key: raise it when the way of measuring changes.
constexpr const char* kProtocol = "2";
constexpr std::size_t kBatch =
    6;  // points timed before their errors are computed, on all cores, and saved

struct ChartedPoint {
    std::string technique;
    SweepPoint sweep;
};

Json parametersJson(const Parameters& parameters) {
    Json json = Json::object();
    for (const auto& [name, value] : parameters.resolved())
        std::visit([&, key = name](const auto& held) { json[key] = held; }, value);
    return json;
}

// `text` is one of the values of "a,b,c".
bool isListed(const std::string& text, const std::string& list) {
    return ("," + list + ",").find("," + text + ",") != std::string::npos;
}

bool isWanted(const Parameters& parameters, const std::vector<std::string>& only) {
    const auto values = parameters.resolved();
    return std::all_of(only.begin(), only.end(), [&](const std::string& assignment) {
        const auto [name, text] = splitAssignment("--only", assignment);
        return std::all_of(values.begin(), values.end(),
                           [&, key = name, list = text](const auto& value) {
                               return value.first != key || isListed(valueText(value.second), list);
                           });
    });
}

std::string shortHash(const std::string& text) {
    return fmt::format("{:016x}", studio::hashBytes(text.data(), text.size(), 5));
}

double loadAverage() {
    double load = -1.0;
    return getloadavg(&load, 1) == 1 ? load : -1.0;
}

std::string utcNow() {
    const std::time_t now = std::time(nullptr);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
    return text;
}

Json timesJson(const TimeFigures& times) {
    if (times.median < 0.0) return nullptr;
    return {{"median", times.median}, {"p99", times.p99}};
}

class Charter {
public:
    explicit Charter(const ChartOptions& options);
    void run();

private:
    struct Pending {
        Json point;
        JudgedPicture picture;
    };

    Json describeRun() const;
    void chartScene(const std::string& name);
    void chartView(ChartView& view);
    void traceTruths(ChartView& view);
    Json describeView(const ChartView& view);
    std::string pointId(const ChartView& view, const ChartedPoint& point) const;
    std::string pointKey(const ChartView& view, const ChartedPoint& point) const;
    Pending timePoint(const ChartView& view, const ChartedPoint& point);
    void judgeAll(const ChartView& view, std::vector<Pending>& pending);
    void report(double ofView, const std::string& note);

    const ChartOptions& options_;
    ChartResults results_;
    std::vector<ChartedPoint> points_;
    std::optional<lightwell::Device> device_;
    LWDeviceInfo info_{};
    std::string build_ = buildIdentity();
    FrameLimits limits_;
    studio::ProgressLine line_{"charting"};
    double viewsBefore_ = 0.0, viewShare_ = 1.0;  // of the whole, in [0,1]
};

Charter::Charter(const ChartOptions& options)
    : options_(options), results_((std::filesystem::path(options.folder) / "results.json").string()) {
    bool needsDevice = false;
    for (const std::string& technique : options.techniques)
        for (SweepPoint& sweep : sweepOf(technique, options.quick)) {
            if (!isWanted(sweep.parameters, options.only)) continue;
            needsDevice = needsDevice || sweep.parameters.needsDevice();
            points_.push_back({technique, std::move(sweep)});
        }
    if (needsDevice) {
        device_ = openDevice(options.device, std::uint32_t(options.deviceWidth));
        info_ = device_->info();
    }
    if (options.quick) {
        limits_.seconds = 0.2;
        limits_.patience = 1.5;
    }
}

Json Charter::describeRun() const {
    Json header;
    header["written"] = utcNow();
    header["size"] = {options_.width, options_.height};
    header["quick"] = options_.quick;
    header["device"] = nullptr;
    if (device_)
        header["device"] = {{"name", info_.name},
                            {"platform", info_.platform},
                            {"driver", info_.driver},
                            {"opencl", info_.openclVersion},
                            {"compute_units", info_.computeUnits},
                            {"width", info_.width}};
    Json versions = Json::object();
    for (const auto& [name, version] : buildVersions()) versions[name] = version;
    header["versions"] = versions;
    header["build"] = build_;
    header["noise_target"] = options_.truth.noise;
    header["noise_share"] = kNoiseShare;
    header["frames"] = {{"warm_up", limits_.warmUp},
                        {"fewest", limits_.fewest},
                        {"most", limits_.most},
                        {"seconds", limits_.seconds},
                        {"patience", limits_.patience}};
    header["techniques"] = options_.techniques;
    return header;
}

void Charter::run() {
    results_.setHeader(describeRun());
    for (std::size_t i = 0; i < options_.scenes.size(); ++i) {
        viewsBefore_ = double(i) / double(options_.scenes.size());
        chartScene(options_.scenes[i]);
    }
    line_.finish(fmt::format("{} points", results_.pointCount()));
}

void Charter::chartScene(const std::string& name) {
    const auto scene = asUsage([&] { return std::make_shared<studio::Scene>(studio::loadScene(name)); });
    const auto rayScene = std::make_shared<studio::RayScene>(scene, 0.0f);
    std::vector<std::size_t> cameras;
    for (std::size_t i = 0; i < scene->cameras.size(); ++i) {
        const bool moves =
            std::any_of(scene->cameraTracks.begin(), scene->cameraTracks.end(),
                        [&](const auto& track) { return std::size_t(track.target) == i; });
        if (!moves && (cameras.empty() || !options_.firstCameraOnly)) cameras.push_back(i);
    }
    viewShare_ = 1.0 / double(options_.scenes.size()) / double(std::max<std::size_t>(1, cameras.size()));
    for (const std::size_t camera : cameras) {
        InputOptions input;
        input.width = options_.width;
        input.height = options_.height;
        ChartView view(rayScene, scene->cameras[camera], input);
        traceTruths(view);
        if (!options_.onlyTruths) chartView(view);
        viewsBefore_ += viewShare_;
    }
}

void Charter::report(double ofView, const std::string& note) {
    line_.update(viewsBefore_ + ofView * viewShare_, note);
    if (InterruptGuard::wasRaised())
        throw Interrupted("interrupted; the same command goes on from " + options_.folder +
                          "/results.json");
}

void Charter::traceTruths(ChartView& view) {
    std::set<int> bounces;
    for (const ChartedPoint& point : points_) bounces.insert(modelledBounces(point.sweep.parameters));
    if (!options_.skipsAllBounces && !options_.quick) bounces.insert(0);
    TruthOptions truth = options_.truth;
    studio::ProgressLine line("truth of " + view.id());
    truth.progress = [&](double fraction, double noise) {
        line.update(fraction, noise < 0.0 ? "" : fmt::format("noise (relMSE) {:.2e}", noise));
        if (InterruptGuard::wasRaised())
            throw Interrupted("interrupted; the same command goes on with this truth");
    };
    view.obtainTruths(bounces, truth);
    std::string note;
    for (const auto& [count, judged] : view.truths())
        note += fmt::format("{}{}: {} samples per pixel, noise {:.2e}", note.empty() ? "" : "; ",
                            bouncesText(count), judged.truth.samples, judged.truth.noise);
    line.finish(note);
}

Json Charter::describeView(const ChartView& view) {
    Json truths = Json::array();
    for (const auto& [bounces, judged] : view.truths())
        truths.push_back({{"bounces", bounces},
                          {"noise", judged.truth.noise},
                          {"samples", judged.truth.samples},
                          {"name", judged.truth.name},
                          {"shipped", judged.isShipped}});
    return {{"id", view.id()},
            {"scene", view.sceneName()},
            {"camera", view.cameraName()},
            {"size", {options_.width, options_.height}},
            {"rsm_texels", view.inputs().rsmTexelCount()},
            {"truths", truths},
            {"images", writeViewPictures(view, options_.folder)}};
}

std::string Charter::pointId(const ChartView& view, const ChartedPoint& point) const {
    return fmt::format("{}/{}/{}", view.id(), point.technique,
                       shortHash(parametersJson(point.sweep.parameters).dump()).substr(0, 8));
}

std::string Charter::pointKey(const ChartView& view, const ChartedPoint& point) const {
    std::string text =
        fmt::format("{} {} {} {} {}x{} {}", kProtocol, build_, view.hash(), pointId(view, point),
                    options_.width, options_.height, describeRun()["frames"].dump());
    if (point.sweep.parameters.needsDevice())
        text += fmt::format(" {} {} {}", info_.name, info_.driver, info_.width);
    for (const int bounces : {modelledBounces(point.sweep.parameters), 0})
        if (const auto truth = view.truths().find(bounces); truth != view.truths().end())
            text += fmt::format(" {} {}", truth->second.truth.name, truth->second.truth.samples);
    return shortHash(text);
}

void Charter::chartView(ChartView& view) {
    results_.putView(describeView(view));
    std::vector<Pending> pending;
    for (std::size_t i = 0; i < points_.size(); ++i) {
        const ChartedPoint& point = points_[i];
        if (!results_.isFresh(pointId(view, point), pointKey(view, point))) {
            report(double(i) / double(points_.size()),
                   fmt::format("{}, {} {}", view.id(), point.technique,
                               describeDifference(point.sweep.parameters)));
            pending.push_back(timePoint(view, point));
        }
        if (pending.size() == kBatch || i + 1 == points_.size()) judgeAll(view, pending);
    }
}

Charter::Pending Charter::timePoint(const ChartView& view, const ChartedPoint& point) {
    const double load = loadAverage();
    const auto renderer =
        makeRenderer(point.sweep.parameters, view.inputs(), device_ ? &*device_ : nullptr);
    const ChartedFrames frames = timeFrames(*renderer, view.inputs(), limits_);

    Pending pending;
    Json& json = pending.point;
    json["id"] = pointId(view, point);
    json["key"] = pointKey(view, point);
    json["build"] = build_;
    json["scene"] = view.sceneName();
    json["camera"] = view.cameraName();
    json["technique"] = point.technique;
    json["label"] = point.sweep.label;
    json["settings"] = describeDifference(point.sweep.parameters);
    json["parameters"] = parametersJson(point.sweep.parameters);
    json["bounces"] = modelledBounces(point.sweep.parameters);
    json["size"] = {options_.width, options_.height};
    json["device"] = point.sweep.parameters.needsDevice() ? Json(info_.name) : Json();
    json["frames"] = frames.frames;
    json["ms"] = timesJson(frames.wall);
    json["device_ms"] = timesJson(frames.device);
    json["bytes"] = {{"device", frames.last.deviceBytes}, {"host_copies", frames.last.hostCopyBytes}};
    json["load_average"] = load;
    pending.picture.bounces = json["bounces"];
    pending.picture.imageName = json["id"];
    std::replace(pending.picture.imageName.begin(), pending.picture.imageName.end(), '/', '_');
    pending.picture.irradiance = studio::Image(options_.width, options_.height);
    addLayer(pending.picture.irradiance, "", renderer->irradiance());
    return pending;
}

void Charter::judgeAll(const ChartView& view, std::vector<Pending>& pending) {
    studio::parallelFor(pending.size(), 0, [&](std::size_t i) {
        const Json judged = judge(pending[i].picture, view, options_.folder);
        pending[i].point["errors"] = {{"own", judged["own"]}, {"all", judged["all"]}};
        pending[i].point["images"] = judged["images"];
    });
    for (Pending& each : pending) results_.putPoint(std::move(each.point));
    pending.clear();
    results_.save();
}

}  // namespace

void runChart(const ChartOptions& options) {
    Charter(options).run();
}

}  // namespace cli
