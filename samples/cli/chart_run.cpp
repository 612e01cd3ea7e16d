// `lightwell chart`: times every point of every view, judges it against the view's truth, keeps
// results.json. The views, points, truths and results that it works on have files of their own.
#include "chart_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "build_identity.h"
#include "chart_judge.h"
#include "chart_point.h"
#include "chart_results.h"
#include "chart_truths.h"
#include "cli.h"
#include "film.h"
#include "interrupt.h"
#include "layers.h"
#include "open_device.h"
#include "parallel.h"
#include "progress.h"
#include "run_facts.h"

namespace cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "lightwell-chart 1";
// Part of every point's key: raise it when the way of measuring changes.
constexpr const char* kProtocol = "4";
constexpr std::size_t kBatch =
    6;  // points timed before their errors are computed, on all cores, and saved

// Adds the seconds of its life to a sum.
class Stopwatch {
public:
    explicit Stopwatch(double& sum) : sum_(sum) {}
    ~Stopwatch() { sum_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;

private:
    using Clock = std::chrono::steady_clock;
    double& sum_;
    Clock::time_point start_ = Clock::now();
};

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
    std::string timeKey(const ChartView& view, const ChartedPoint& point) const;
    std::string truthKey(const ChartView& view, const ChartedPoint& point) const;
    void chartPoint(const ChartView& view, const ChartedPoint& point, std::vector<Pending>& pending);
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
    struct {
        double scenes = 0.0, inputs = 0.0, truths = 0.0, points = 0.0, judging = 0.0;
    } seconds_;  // where the run's own time goes
};

Charter::Charter(const ChartOptions& options)
    : options_(options),
      results_((std::filesystem::path(options.folder) / "results.json").string(), kFormat),
      points_(chartedPoints(options.techniques, options.quick, options.only)) {
    const bool judgesOnScreen =
        std::any_of(points_.begin(), points_.end(),
                    [](const ChartedPoint& point) { return knowsPictureOnly(point.sweep.parameters); });
    if (options.truth.onScreen && !judgesOnScreen)
        throw UsageError(
            "--on-screen: expected a technique that takes its light from the picture alone, got " +
            joinNames(options.techniques));
    const bool needsDevice = std::any_of(points_.begin(), points_.end(), [](const ChartedPoint& point) {
        return point.sweep.parameters.needsDevice();
    });
    if (needsDevice && !options.onlyTruths) {
        device_ = openDevice(options.device, std::uint32_t(options.deviceWidth));
        info_ = device_->info();
    }
    if (options.quick) {
        limits_.seconds = 0.2;
        limits_.patience = 1.5;
    }
    limits_.warmUp = options.warmUp;
    if (options.frames > 0) {
        limits_.fewest = limits_.most = options.frames;
        limits_.seconds = 0.0;
    }
}

Json Charter::describeRun() const {
    Json header;
    header["written"] = utcNow();
    header["size"] = {options_.width, options_.height};
    header["quick"] = options_.quick;
    header["device"] = nullptr;
    if (device_) header["device"] = deviceJson(info_);
    header["versions"] = versionsJson();
    header["build"] = build_;
    header["noise_target"] = options_.truth.noise;
    header["judged_block"] = options_.truth.block;
    header["noise_share"] = kNoiseShare;
    header["frames"] = {{"warm_up", limits_.warmUp},
                        {"fewest", limits_.fewest},
                        {"most", limits_.most},
                        {"seconds", limits_.seconds},
                        {"patience", limits_.patience}};
    header["techniques"] = options_.techniques;
    header["run_seconds"] = {{"scenes", seconds_.scenes},
                             {"inputs", seconds_.inputs},
                             {"truths", seconds_.truths},
                             {"points", seconds_.points},
                             {"judging", seconds_.judging}};
    return header;
}

void Charter::run() {
    results_.setHeader(describeRun());
    for (std::size_t i = 0; i < options_.scenes.size(); ++i) {
        viewsBefore_ = double(i) / double(options_.scenes.size());
        chartScene(options_.scenes[i]);
    }
    results_.setHeader(describeRun());
    if (!options_.onlyTruths) results_.save();
    line_.finish(fmt::format("{} points", results_.pointCount()));
}

void Charter::chartScene(const std::string& name) {
    std::shared_ptr<const studio::Scene> scene;
    std::shared_ptr<studio::RayScene> rayScene;
    {
        const Stopwatch watch(seconds_.scenes);
        scene = asUsage([&] { return std::make_shared<studio::Scene>(studio::loadScene(name)); });
        rayScene = asUsage([&] { return std::make_shared<studio::RayScene>(scene, 0.0f); });
    }
    const std::vector<std::size_t> cameras = stillCameras(*scene, options_.firstCameraOnly);
    viewShare_ = 1.0 / double(options_.scenes.size()) / double(std::max<std::size_t>(1, cameras.size()));
    for (const std::size_t camera : cameras) {
        InputOptions input;
        input.width = options_.width;
        input.height = options_.height;
        std::optional<ChartView> view;
        {
            const Stopwatch watch(seconds_.inputs);
            view.emplace(rayScene, scene->cameras[camera], input);
        }
        {
            const Stopwatch watch(seconds_.truths);
            traceTruths(*view);
        }
        if (view->isBlack())
            fmt::print(stderr, "note: {} has no indirect light and is left out\n", view->id());
        else if (!options_.onlyTruths)
            chartView(*view);
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
    line.finish(truthNote(view));
}

// What the times depend on.
std::string Charter::timeKey(const ChartView& view, const ChartedPoint& point) const {
    std::string text =
        fmt::format("{} {} {} {} {}x{} {}", kProtocol, build_, view.hash(), pointId(view, point),
                    options_.width, options_.height, describeRun()["frames"].dump());
    if (point.sweep.parameters.needsDevice())
        text += fmt::format(" {} {} {}", info_.name, info_.driver, info_.width);
    return shortHash(filesKey(point.sweep.parameters) + text);
}

// What the errors depend on besides.
std::string Charter::truthKey(const ChartView& view, const ChartedPoint& point) const {
    return shortHash(std::string(kProtocol) + truthNames(view, point.sweep.parameters));
}

void Charter::chartView(ChartView& view) {
    results_.putView(describeView(view, options_.folder));
    std::vector<Pending> pending;
    for (std::size_t i = 0; i < points_.size(); ++i) {
        report(double(i) / double(points_.size()),
               fmt::format("{}, {} {}", view.id(), points_[i].technique,
                           describeDifference(points_[i].sweep.parameters)));
        chartPoint(view, points_[i], pending);
        if (pending.size() == kBatch || i + 1 == points_.size()) judgeAll(view, pending);
    }
}

// Nothing for a point that is measured already; where only the truth is another one, the picture is
// rendered again and the times stay.
void Charter::chartPoint(const ChartView& view, const ChartedPoint& point,
                         std::vector<Pending>& pending) {
    const std::string truth = truthKey(view, point);
    const Json* known = results_.find(pointId(view, point), timeKey(view, point));
    if (known != nullptr && known->at("truth") == truth) return;

    const Stopwatch watch(seconds_.points);
    const auto renderer =
        makeRenderer(point.sweep.parameters, view.inputs(), device_ ? &*device_ : nullptr);
    Pending made;
    if (known == nullptr) {
        made.point = timePoint(view, point, *renderer, limits_);
        made.point["key"] = timeKey(view, point);
        made.point["build"] = build_;
        made.point["device"] = point.sweep.parameters.needsDevice() ? Json(info_.name) : Json();
    } else {
        made.point = *known;
        renderAgain(*renderer, view.inputs(), int(made.point["warm_up"]) + int(made.point["frames"]));
    }
    made.point["truth"] = truth;
    made.picture.bounces = made.point["bounces"];
    made.picture.knowsPictureOnly = knowsPictureOnly(point.sweep.parameters);
    made.picture.imageName = made.point["id"];
    made.picture.irradiance = studio::Image(options_.width, options_.height);
    addLayer(made.picture.irradiance, "", renderer->irradiance());
    pending.push_back(std::move(made));
}

void Charter::judgeAll(const ChartView& view, std::vector<Pending>& pending) {
    const Stopwatch watch(seconds_.judging);
    studio::parallelFor(pending.size(), 0, [&](std::size_t i) {
        const Json judged = judge(pending[i].picture, view, options_.folder);
        pending[i].point["errors"] = {
            {"own", judged["own"]}, {"all", judged["all"]}, {"screen", judged["screen"]}};
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
