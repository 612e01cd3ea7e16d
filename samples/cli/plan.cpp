// `lightwell plan`: what lwPlan would run for a view of a scene, and what it expects of it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli.h"
#include "frame_vpls.h"
#include "open_device.h"
#include "render_inputs.h"
#include "run_facts.h"

namespace cli {
namespace {

struct PlanOptions {
    ViewOptions view;
    std::string budget, error, device;
    int rsmSize = 512, cascades = 1, views = 1, width = 0;
    bool asJson = false, listsAll = false, hasGeometry = true, isAtRest = false;
    CLI::Option *budgetGiven = nullptr, *errorGiven = nullptr;
    bool hasBudget() const { return budgetGiven->count() > 0; }
    bool hasError() const { return errorGiven->count() > 0; }
};

// A probe as JSON has it: no number is null.
nlohmann::ordered_json probesJson(const LWPlan& plan) {
    const LWPlanProbes& probes = plan.probes;
    return {{"indirect_share", probes.indirectShare}, {"flux_on_screen", probes.fluxOnScreen},
            {"flux_concentration", probes.fluxConcentration}, {"depth_complexity", probes.depthComplexity},
            {"extent", probes.extent}, {"albedo", probes.albedo}, {"facing", probes.facing}, {"hidden", probes.hidden},
            {"coverage", plan.coverage}};
}

nlohmann::ordered_json planJson(const LWPlan& plan) {
    return {{"technique", plan.technique},          {"parameters", plan.parameters},
            {"predicted_ms", plan.predictedMs},     {"predicted_error", plan.predictedError},
            {"confidence", plan.confidence},        {"within_budget", plan.withinBudget != 0},
            {"reaches_error", plan.reachesError != 0}};
}

LWPlanDesc describe(const PlanOptions& options) {
    auto desc = lightwell::make<LWPlanDesc>();
    if (options.hasBudget()) desc.budgetMs = parsePositive("--budget-ms", options.budget);
    if (options.hasError()) desc.errorTarget = parsePositive("--error", options.error);
    desc.views = std::uint32_t(options.views);
    desc.atRest = options.isAtRest ? 1 : 0;
    return desc;
}

void printTable(const std::vector<LWPlan>& plans) {
    std::size_t wide = 0;
    const auto name = [](const LWPlan& plan) { return fmt::format("{} {}", plan.technique, plan.parameters); };
    for (const LWPlan& plan : plans) wide = std::max(wide, name(plan).size());
    fmt::print("{:>9} {:>9} {:>10}  {}\n", "ms", "relMSE", "confidence", "technique and parameters");
    double best = HUGE_VAL;  // of all that are quicker
    for (const LWPlan& plan : plans) {
        const bool isFront = double(plan.predictedError) < best;
        if (isFront) best = double(plan.predictedError);
        fmt::print("{:>9.2f} {:>9.3g} {:>9.0f}%  {:<{}}{}\n", plan.predictedMs, plan.predictedError, 100.0f * plan.confidence, name(plan),
                   wide, isFront ? "  *" : "");
    }
    fmt::print("* nothing quicker is predicted to be as accurate\n");
}

void printText(const LWPlan& plan) {
    fmt::print("{} {}\n  predicted {:.2f} ms, relMSE {:.3g}, within a factor of two with {:.0f} %\n  {}\n", plan.technique, plan.parameters,
               plan.predictedMs, plan.predictedError, 100.0f * plan.confidence, plan.reason);
}

// The frame as a host of the library would give it, and as `lightwell render` does: the view itself is a source view.
struct PlannedFrame {
    PlannedFrame(const RenderInputs& inputs, LWView view, bool hasGeometry) : source{view, &inputs.lwGBuffer()} {
        frame.lights = inputs.versionedLights().data();
        frame.lightCount = std::uint32_t(inputs.versionedLights().size());
        if (hasGeometry) frame.geometry = &inputs.geometry();
        std::copy_n(inputs.environment(), 3, frame.environment);
        frame.focus = inputs.focus();
        frame.sourceViews = &source;
        frame.sourceViewCount = 1;
    }
    PlannedFrame(const PlannedFrame&) = delete;
    PlannedFrame& operator=(const PlannedFrame&) = delete;
    LWSourceView source;
    LWFrame frame = lightwell::make<LWFrame>();
};

void print(const PlanOptions& options, const std::string& scene, const std::string& camera, const Size& size,
           const lightwell::Device& device, const LWFrame& frame, const LWPlan& plan, const std::vector<LWPlan>& all) {
    const bool isChoice = options.hasBudget() || options.hasError();
    const LWPlanDesc desc = describe(options);
    if (!options.asJson) {
        if (isChoice) printText(plan);
        if (!isChoice || options.listsAll) printTable(all);
        return;
    }
    nlohmann::ordered_json document = planJson(plan);
    document["reason"] = plan.reason;
    document["scene"] = scene;
    document["camera"] = camera;
    document["size"] = {size.width, size.height};
    document["budget_ms"] = options.hasBudget() ? nlohmann::ordered_json(desc.budgetMs) : nlohmann::ordered_json();
    document["error_target"] = options.hasError() ? nlohmann::ordered_json(desc.errorTarget) : nlohmann::ordered_json();
    document["at_rest"] = options.isAtRest;
    document["probes"] = probesJson(plan);
    document["triangles"] = frame.geometry ? frame.geometry->triangleCount : 0;
    document["device"] = deviceJson(device.info());
    if (!isChoice || options.listsAll) {
        document["candidates"] = nlohmann::ordered_json::array();
        for (const LWPlan& each : all) document["candidates"].push_back(planJson(each));
    }
    fmt::print("{}\n", document.dump(2));
}

void planScene(const PlanOptions& options) {
    const LWPlanDesc desc = describe(options);
    const Size size = parseSize(options.view.size);
    if (options.width != 0) requireOneOf("--width", std::to_string(options.width), {"1", "4", "8", "16"});
    if (options.cascades > 1 && options.rsmSize % 2 != 0)
        throw UsageError(fmt::format("--rsm-size '{}': expected an even number with --cascades", options.rsmSize));
    const auto scene = loadScene(options.view);
    const studio::Camera camera = findCamera(*scene, options.view);
    InputOptions inputOptions;
    inputOptions.width = size.width;
    inputOptions.height = size.height;
    inputOptions.time = inputOptions.previousTime = float(options.view.time);
    inputOptions.rsm.size = options.rsmSize;
    inputOptions.rsm.cascades = options.cascades;
    const auto rayScene = asUsage([&] { return std::make_unique<studio::RayScene>(scene, inputOptions.time); });
    const RenderInputs inputs(*rayScene, camera, inputOptions);

    const lightwell::Device device = openDevice(options.device, std::uint32_t(options.width));
    const lightwell::View view(device, std::uint32_t(size.width), std::uint32_t(size.height));
    const PlannedFrame planned(inputs, view.get(), options.hasGeometry);
    const LWPlan plan = lightwell::plan(view, planned.frame, inputs.lwGBuffer(), desc);
    print(options, scene->name, camera.name, size, device, planned.frame, plan,
          lightwell::listPlans(view, planned.frame, inputs.lwGBuffer(), desc));
}

}  // namespace

void addPlan(CLI::App& app) {
    CLI::App* command = app.add_subcommand("plan", "Which technique, with which parameters, for a budget or an error");
    auto options = std::make_shared<PlanOptions>();
    options->view.declare(*command);
    options->budgetGiven = command->add_option("--budget-ms", options->budget, "Milliseconds that a frame may take; with --error: at most");
    options->errorGiven = command->add_option("--error", options->error, "relMSE against all bounces to reach, as cheaply as can be");
    command->add_option("--views", options->views, "Views that a frame renders: 2 for stereo")->check(CLI::Range(1, 64))->capture_default_str();
    command->add_flag("--at-rest", options->isAtRest, "Of frames whose light and geometry stand still, of a host that tells versions (LWPlanDesc::atRest)");
    command->add_option("--rsm-size", options->rsmSize, "Texels along each side of an RSM")->check(CLI::Range(1, kMaxSize))->capture_default_str();
    command->add_option("--cascades", options->cascades, "Nested RSMs of a sun")->check(CLI::Range(1, 8))->capture_default_str();
    command->add_flag("!--no-geometry", options->hasGeometry, "As a host that gives neither triangles nor surfels");
    command->add_option("--width", options->width, "Lanes per work-item: 1, 4, 8, 16; default: by probe");
    command->add_option("--device", options->device,
                        "gpu, cpu, PLATFORM:DEVICE indices or part of a name; default: LIGHTWELL_DEVICE, else the best");
    command->add_flag("--all", options->listsAll, "Also all that could be run; without --budget-ms and --error they always are");
    command->add_flag("--json", options->asJson, "JSON on stdout: technique, parameters, predicted_ms, predicted_error, confidence, reason, ...");
    command->callback([options] { planScene(*options); });
}

}  // namespace cli
