// `lightwell split`: which of its approximations a VPL technique's error comes from.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "chart_script.h"
#include "cli.h"
#include "interrupt.h"
#include "parameters.h"
#include "scene.h"
#include "split_run.h"

namespace cli {
namespace {

constexpr const char* kQuickScenes[] = {"cornell", "rooms"};
constexpr const char* kSize = "1280x720";
constexpr const char* kQuickSize = "320x180";  // of the shipped references
constexpr double kNoise = 1e-3, kQuickNoise = 4e-3;
constexpr int kBlock = 4;  // as a chart's, so that both share their truths

struct Arguments {
    SplitOptions split;
    std::string size, cameras = "all", noise;
    bool isQuick = false, skipsReport = false, onlyReport = false;
};

void complete(Arguments& arguments) {
    SplitOptions& split = arguments.split;
    if (split.scenes.empty() && arguments.isQuick)
        split.scenes.assign(std::begin(kQuickScenes), std::end(kQuickScenes));
    if (split.scenes.empty())
        for (const studio::SceneEntry& entry : studio::listScenes()) split.scenes.push_back(entry.name);
    for (const std::string& technique : split.techniques)
        requireOneOf("technique", technique, techniqueNames());
    if (split.techniques.empty())
        for (const std::string& technique : techniqueNames())
            if (Parameters(technique).needsDevice()) split.techniques.push_back(technique);
    requireOneOf("--cameras", arguments.cameras, {"all", "first"});
    for (const std::string& only : split.only) splitAssignment("--only", only);
    if (split.deviceWidth != 0)
        requireOneOf("--width", std::to_string(split.deviceWidth), {"1", "4", "8", "16"});
    split.firstCameraOnly = arguments.cameras == "first" || arguments.isQuick;
    split.skipsAllBounces = split.skipsAllBounces || arguments.isQuick;
    const Size size = parseSize(!arguments.size.empty() ? arguments.size
                                : arguments.isQuick     ? kQuickSize
                                                        : kSize);
    split.width = size.width;
    split.height = size.height;
    split.truth.noise = arguments.isQuick ? kQuickNoise : kNoise;
    if (!arguments.noise.empty()) split.truth.noise = parseNumber("--noise", arguments.noise);
    if (!(split.truth.noise > 0.0)) throw UsageError("--noise: expected a relMSE above 0");
    if (split.truth.block == 0) split.truth.block = arguments.isQuick ? 1 : kBlock;
    split.truth.takesShipped = arguments.isQuick;
}

void split(Arguments& arguments) {
    complete(arguments);
    const std::string& folder = arguments.split.folder;
    asUsage([&] { std::filesystem::create_directories(folder); });
    if (!arguments.onlyReport) {
        const InterruptGuard guard;
        runSplit(arguments.split);
        fmt::print("{}\n", (std::filesystem::path(folder) / "split.json").string());
    }
    if (!arguments.skipsReport) runChartScript("report.py", {folder});
}

}  // namespace

void addSplit(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "split",
        "Where a VPL technique's error comes from: each approximation replaced by exact in turn");
    auto arguments = std::make_shared<Arguments>();
    SplitOptions& options = arguments->split;
    command
        ->add_option(
            "--out", options.folder,
            "Folder (made when missing) of split.json and the report; a chart's folder gets one "
            "report of both")
        ->required();
    command->add_option("--scenes", options.scenes,
                        "Scenes by name or path; default: all that are found");
    command->add_option("--techniques", options.techniques,
                        "Techniques by name; default: all of the library");
    command->add_option("--only", options.only,
                        "key=value,value ...: these points of the whole sweep, as for chart; default: "
                        "the defaults and the named settings");
    command
        ->add_option("--patterns", options.patterns,
                     "Seeds that tell the sampling's share from the bounding's")
        ->check(CLI::Range(2, 64))
        ->capture_default_str();
    command->add_flag("--quick", arguments->isQuick,
                      "About a minute: 320x180, two scenes with shipped references, one bounce");
    command->add_option("--cameras", arguments->cameras, "all (but keyframed ones) or first")
        ->capture_default_str();
    command->add_option("--size", arguments->size, "Picture size, WIDTHxHEIGHT; default: 1280x720");
    options.truth.block = 0;
    command
        ->add_option(
            "--judge-one-of", options.truth.block,
            "N: split the error at one pixel of each N x N; default: 4 (with --quick 1, all pixels)")
        ->check(CLI::Range(1, 64));
    command->add_flag("--kept-truths", options.truth.takesKept,
                      "Take the cache's truths as they are; trace only where it has none");
    command->add_option("--noise", arguments->noise, "relMSE to which truths are traced; default: 1e-3");
    command
        ->add_option("--truth-seconds", options.truth.seconds,
                     "Most time for one truth; the next run goes on from there. 0: no limit")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    command->add_flag("--no-all-bounces", options.skipsAllBounces,
                      "Without the model's share, and the truth of all bounces that it needs");
    command->add_option("--truth-cache", options.truth.directory, "As for chart");
    command->add_option("--device", options.device, "As for render");
    command->add_option("--width", options.deviceWidth,
                        "Lanes per work-item: 1, 4, 8 or 16; default: by probe");
    command->add_flag("--no-report", arguments->skipsReport,
                      "Measure only; split.json is written all the same");
    command->add_flag("--report-only", arguments->onlyReport, "Plots and report of the results in DIR");
    command->callback([arguments] { split(*arguments); });
}

}  // namespace cli
