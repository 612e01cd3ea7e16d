// `lightwell stability`: sequence by sequence and frame by frame, truth first, then every technique.
#include "stability_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "build_identity.h"
#include "cli.h"
#include "film.h"
#include "indirect_renderer.h"
#include "interrupt.h"
#include "layers.h"
#include "open_device.h"
#include "progress.h"
#include "run_facts.h"
#include "stability_frame.h"
#include "stability_judge.h"
#include "stability_pictures.h"
#include "stability_results.h"
#include "stability_scaled.h"
#include "sweep.h"

namespace cli {
namespace {

using Json = nlohmann::ordered_json;
using studio::FailureSequence;
using studio::SequenceFrame;
using Truths = std::map<int, std::shared_ptr<const FrameTruth>>;  // by bounces; 0: all
constexpr const char* kProtocol = "1";  // part of every key: raise it when the way of measuring changes

// One technique on its way through one sequence.
struct Runner {
    std::string technique;  // or a variant, as the user wrote it
    Parameters parameters;
    int bounces = 1;
    std::unique_ptr<IndirectRenderer> renderer;
    std::vector<JudgedFrame> frames;

    explicit Runner(const std::string& variant)
        : technique(variant), parameters(parseVariant(variant)), bounces(modelledBounces(parameters)) {}
};

class Stability {
public:
    explicit Stability(const StabilityOptions& options);
    void run();

private:
    Json describeRun() const;
    // Techniques whose result is missing or of another key; all where only truths are wanted.
    std::vector<Runner*> dueIn(const FailureSequence& sequence);
    std::string keyOf(const FailureSequence& sequence, const Runner& runner) const;
    void runSequence(const FailureSequence& sequence);
    void runFrame(const FailureSequence& sequence, const FrameScene& now, const FrameScene* before);
    void renderFrame(const FailureSequence& sequence, const FrameScene& now, const FrameScene* before,
                     const studio::StabilityFrame& judged, const Truths& truths);
    Truths truthsOf(const FailureSequence& sequence, const FrameScene& now, const studio::GBuffer& view);
    void judge(const FailureSequence& sequence, Runner& runner);
    int samplesOf(const FailureSequence& sequence) const;
    void report(double ofFrame, const std::string& note = "");

    const StabilityOptions& options_;
    std::vector<FailureSequence> sequences_;
    std::vector<Runner> runners_;
    std::optional<lightwell::Device> device_;
    LWDeviceInfo info_{};
    StabilityResults results_;
    SequenceTruths truths_;
    std::string build_ = buildIdentity();
    studio::ProgressLine line_{"stability"};
    double done_ = 0.0, all_ = 0.0, frameCost_ = 0.0;  // in units of one sample of one frame

    // Of the sequence at hand.
    std::optional<SequenceGuide> guide_;
    std::vector<Runner*> due_;  // techniques that are measured
    SequencePictures pictures_;
    double load_ = -1.0;
};

// Inputs, techniques and indices of a frame cost about as much as this many samples of its truth.
constexpr double kFrameSamples = 20.0;

double costOf(const FailureSequence& sequence, int samples) {
    const double truth = sequence.truth == studio::SequenceTruth::Dark ? 0.0 : double(samples);
    return double(sequence.frames.size()) * (truth + kFrameSamples);
}

Stability::Stability(const StabilityOptions& options)
    : options_(options),
      results_((std::filesystem::path(options.folder) / "stability.json").string()),
      truths_(asUsage([&] { return SequenceTruths(options.truthDirectory); })) {
    sequences_ = makeSequences(options.sequences, options.size);
    for (const FailureSequence& sequence : sequences_) all_ += costOf(sequence, samplesOf(sequence));
    bool needsDevice = false;
    for (const std::string& technique : options.techniques) {
        runners_.emplace_back(technique);
        needsDevice = needsDevice || runners_.back().parameters.needsDevice();
    }
    if (needsDevice && !options.onlyTruths) {
        device_ = openDevice(options.device, std::uint32_t(options.deviceWidth));
        info_ = device_->info();
    }
}

int Stability::samplesOf(const FailureSequence& sequence) const {
    return std::max(2, 2 * int(std::lround(0.5 * options_.truthEffort * sequence.truthSamples)));
}

Json Stability::describeRun() const {
    Json header;
    header["written"] = utcNow();
    header["size"] = {options_.size.width, options_.size.height};
    header["frames"] = options_.size.frames;
    header["quick"] = options_.quick;
    header["device"] = device_ ? deviceJson(info_) : Json();
    header["versions"] = versionsJson();
    header["build"] = build_;
    header["techniques"] = options_.techniques;
    return header;
}

void Stability::report(double ofFrame, const std::string& note) {
    line_.update(std::min(1.0, (done_ + ofFrame * frameCost_) / std::max(1.0, all_)), note);
    if (InterruptGuard::wasRaised())
        throw Interrupted("interrupted; the same command goes on from " + options_.folder +
                          "/stability.json and the truths that are kept");
}

void Stability::run() {
    if (!options_.onlyTruths) results_.setHeader(describeRun());
    for (const FailureSequence& sequence : sequences_) {
        const double cost = costOf(sequence, samplesOf(sequence)), before = done_;
        frameCost_ = cost / double(sequence.frames.size());
        due_ = dueIn(sequence);
        if (!due_.empty()) runSequence(sequence);
        done_ = before + cost;
    }
    if (!options_.onlyTruths) results_.save();
    line_.finish(fmt::format("{} frames of truth traced", truths_.tracedCount()));
}

std::string Stability::keyOf(const FailureSequence& sequence, const Runner& runner) const {
    std::string text =
        fmt::format("{} {} {} {} {} {} {} {}", kProtocol, build_, info_.name, info_.driver, info_.width,
                    sequence.name, samplesOf(sequence), runner.bounces);
    for (const auto& [name, value] : runner.parameters.resolved())
        text += fmt::format(" {}={}", name, valueText(value));
    const auto place = [](const glm::vec3& v) { return fmt::format(" {} {} {}", v.x, v.y, v.z); };
    for (const SequenceFrame& frame : sequence.frames)
        text += fmt::format(" {}x{} {} {}", frame.width, frame.height, frame.camera.verticalFov,
                            frame.value) +
                place(frame.camera.position) + place(frame.camera.target) + place(frame.camera.up);
    // The code is in the build's identity; files of shipped scenes are not.
    const SequenceFrame& middle = sequence.frames[sequence.frames.size() / 2];
    text += fmt::format(" {:016x}", studio::hashScene(studio::RayScene(middle.scene, middle.time)));
    return shortHash(text);
}

std::vector<Runner*> Stability::dueIn(const FailureSequence& sequence) {
    std::vector<Runner*> due;
    for (Runner& runner : runners_)
        if (options_.onlyTruths || !results_.isFresh(runner.technique + "/" + sequence.name,
                                                     keyOf(sequence, runner)))
            due.push_back(&runner);
    return due;
}

void Stability::runSequence(const FailureSequence& sequence) {
    load_ = loadAverage();
    pictures_ = SequencePictures();
    for (Runner* runner : due_) {
        runner->frames.clear();
        runner->renderer.reset();
    }
    if (sequence.truth == studio::SequenceTruth::Traced) guide_.emplace(sequence);
    std::unique_ptr<FrameScene> before;
    for (const SequenceFrame& frame : sequence.frames) {
        report(0.0, fmt::format("{}, frame {} of {}", sequence.name,
                                int(&frame - sequence.frames.data()) + 1, sequence.frames.size()));
        auto now = std::make_unique<FrameScene>(frame);
        runFrame(sequence, *now, before.get());
        before = std::move(now);
        done_ += frameCost_;
    }
    if (options_.onlyTruths) return;
    // With the results that it describes: those of an earlier run may have other truths.
    results_.putSequence(describeSequence(sequence, samplesOf(sequence)));
    for (Runner* runner : due_) judge(sequence, *runner);
    results_.save();
}

Truths Stability::truthsOf(const FailureSequence& sequence, const FrameScene& now,
                           const studio::GBuffer& view) {
    Truths truths;
    for (const Runner* runner : due_) truths[runner->bounces] = nullptr;
    for (auto each = truths.rbegin(); each != truths.rend(); ++each) {
        SequenceTruths::Request request;
        request.bounces = each->first;
        request.keepsFirstBounce = each->first == 2 && truths.count(1) != 0;
        request.samples = samplesOf(sequence);
        request.sharesPoints = sequence.truthSharesPoints;
        request.guide = guide_ ? guide_->points.get() : nullptr;
        request.progress = [&](double fraction) { report(fraction); };
        each->second = sequence.truth == studio::SequenceTruth::Dark
                           ? darkTruth(now.frame.width, now.frame.height)
                           : truths_.obtain(*now.scene, view, request);
    }
    return truths;
}

void Stability::runFrame(const FailureSequence& sequence, const FrameScene& now,
                         const FrameScene* before) {
    const studio::GBuffer view =
        studio::renderGBuffer(*now.scene, now.frame.camera, now.frame.width, now.frame.height,
                              now.frame.camera, now.frame.time);
    const auto truths = truthsOf(sequence, now, view);
    if (options_.onlyTruths) return;
    pictures_.addFrame(view);
    renderFrame(sequence, now, before, frameToJudge(sequence, now, before), truths);
}

void Stability::renderFrame(const FailureSequence& sequence, const FrameScene& now,
                            const FrameScene* before, const studio::StabilityFrame& frame,
                            const Truths& truths) {
    ScaledFrame scaled(*now.scene, now.frame, sequence.scale);
    InputOptions options;
    options.width = now.frame.width;
    options.height = now.frame.height;
    options.time = now.frame.time;
    options.scale = sequence.scale;
    studio::Camera previous;
    if (before != nullptr && !now.frame.isCut) {
        previous = scaled.camera(before->frame.camera);
        options.previousCamera = &previous;
        options.previousTime = before->frame.time;
    }
    const RenderInputs inputs(scaled.scene(), scaled.camera(now.frame.camera), options);
    for (Runner* const each : due_) {
        Runner& runner = *each;
        if (runner.renderer == nullptr)
            runner.renderer = makeRenderer(runner.parameters, inputs, device_ ? &*device_ : nullptr);
        JudgedFrame judged;
        judged.milliseconds = runner.renderer->renderFrame(inputs, now.frame.reset).wallMilliseconds;
        judged.frame = frame;
        judged.truth = truths.at(runner.bounces);
        judged.frame.image = packedPlanes(runner.renderer->irradiance());
        for (float& value : judged.frame.image) {
            if (!std::isfinite(value)) {
                value = 0.0f;
                ++judged.notFinite;
            }
            judged.largest = std::max(judged.largest, std::abs(value));
        }
        if (sequence.scale != 1.0f)
            dropUnlikePixels(inputs.gbuffer(), sequence.scale, now.seen, now.frame.camera.position,
                             judged.frame.surface);
        runner.frames.push_back(std::move(judged));
    }
}

void Stability::judge(const FailureSequence& sequence, Runner& runner) {
    const std::string& technique = runner.technique;
    const Verdict verdict = judgeSequence(runner.frames);
    Json json;
    json["id"] = technique + "/" + sequence.name;
    json["key"] = keyOf(sequence, runner);
    json["technique"] = technique;
    json["sequence"] = sequence.name;
    json["settings"] = describeDifference(runner.parameters);
    json["parameters"] = parametersJson(runner.parameters);
    json["bounces"] = runner.bounces;
    json["device"] = runner.parameters.needsDevice() ? Json(info_.name) : Json();
    json["build"] = build_;
    json["load_average"] = load_;
    json.update(verdict.toJson(runner.frames));
    const bool isDark = sequence.truth == studio::SequenceTruth::Dark;
    json["is_dark_truth"] = isDark;
    json["passes"] = json["not_finite"] == 0 && (!isDark || json["largest"] == 0.0f);
    const auto worst = std::size_t(verdict.indices.worstFrame);
    json["images"] =
        pictures_.write(options_.folder, technique + "_" + sequence.name, worst, runner.frames[worst]);
    results_.putResult(json);
    runner.frames.clear();
    runner.renderer.reset();
}

}  // namespace

void runStability(const StabilityOptions& options) {
    Stability(options).run();
}

}  // namespace cli
