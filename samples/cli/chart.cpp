// `lightwell chart`: every technique x its parameter sweep x scene x view, error against time.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "chart_run.h"
#include "chart_script.h"
#include "cli.h"
#include "interrupt.h"
#include "parameters.h"
#include "scene.h"

namespace cli {
namespace {

constexpr const char* kQuickScenes[] = {"cornell", "basic"};
constexpr const char* kQuickSize = "320x180";
constexpr double kQuickNoise = 4e-3, kNoise = 1e-3;  // relMSE of the truths
// Of the whole pictures, which composites are judged by: most composites forgive more than their
// irradiance.
constexpr double kPictureNoise = 2e-2;

struct Arguments {
    ChartOptions chart;
    std::string size, cameras = "all", noise, pictureNoise, seconds = "0";
    int block = 0;
    bool skipsReport = false, onlyReport = false;
};

void complete(Arguments& arguments) {
    ChartOptions& chart = arguments.chart;
    if (chart.scenes.empty())
        chart.scenes = chart.quick
                           ? std::vector<std::string>(std::begin(kQuickScenes), std::end(kQuickScenes))
                           : sceneNames();
    if (chart.techniques.empty()) chart.techniques = techniqueNames();
    for (const std::string& technique : chart.techniques) parseVariant(technique);
    requireOneOf("--cameras", arguments.cameras, {"all", "first"});
    for (const std::string& only : chart.only) splitAssignment("--only", only);
    if (chart.deviceWidth != 0)
        requireOneOf("--width", std::to_string(chart.deviceWidth), {"1", "4", "8", "16"});
    chart.firstCameraOnly = arguments.cameras == "first" || chart.quick;
    const Size size = chartedSize(arguments.size, chart.quick ? kQuickSize : "1280x720");
    requireScenes(chart.scenes);
    chart.width = size.width;
    chart.height = size.height;
    setTruthLimits(chart.truth, arguments.noise, chart.quick ? kQuickNoise : kNoise, arguments.seconds);
    chart.truth.block = judgedBlock(arguments.block, size, chart.quick);
    chart.truth.pictureNoise = kPictureNoise;
    if (!arguments.pictureNoise.empty())
        chart.truth.pictureNoise = parseNumber("--picture-noise", arguments.pictureNoise);
    if (!(chart.truth.pictureNoise >= 0.0))
        throw UsageError("--picture-noise: expected a relMSE above 0, or 0 for none");
    if (chart.truth.pictureNoise == 0.0 && !arguments.skipsReport)
        throw UsageError("--picture-noise 0: expected --no-report: a report shows whole pictures");
    chart.truth.takesShipped = chart.quick;
}

void chart(Arguments& arguments) {
    complete(arguments);
    const std::string& folder = arguments.chart.folder;
    if (!arguments.onlyReport) {
        std::error_code error;
        std::filesystem::create_directories(std::filesystem::path(folder) / "images", error);
        if (error)
            throw UsageError(fmt::format("--out '{}': expected a folder that can be written: {}", folder,
                                         error.message()));
        const InterruptGuard guard;
        runChart(arguments.chart);
        fmt::print("{}\n", (std::filesystem::path(folder) / "results.json").string());
    }
    if (!arguments.skipsReport) runChartScript("report.py", {folder});
}

}  // namespace

void addChart(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "chart", "Error against time: every technique, parameter sweep, scene and view; a report");
    auto arguments = std::make_shared<Arguments>();
    ChartOptions& options = arguments->chart;
    command
        ->add_option("--out", options.folder,
                     "Folder (made when missing) of results.json and the report")
        ->required();
    command->add_option("--scenes", options.scenes,
                        "Scenes by name or path; default: all that are found");
    command->add_option("--techniques", options.techniques,
                        "Techniques by name, with their whole sweep, or as NAME,KEY=VALUE,... one point "
                        "alone; default: all");
    command->add_option(
        "--only", options.only,
        "key=value,value ..., one or several: of techniques with this parameter, only the "
        "points with such a value");
    command->add_flag(
        "--quick", options.quick,
        "About a minute: 320x180, two scenes, their first cameras, parameters moved one by one");
    command->add_option("--cameras", arguments->cameras, "all (but keyframed ones) or first")
        ->capture_default_str();
    command->add_option("--size", arguments->size, "Picture size, WIDTHxHEIGHT; default: 1280x720");
    command->add_option("--noise", arguments->noise, "relMSE to which truths are traced; default: 1e-3");
    command
        ->add_option("--judge-one-of", arguments->block,
                     "N: judge the irradiance at one pixel of each N x N, whose truth is then dearer "
                     "and less noisy; "
                     "default: 4; 1, all pixels, with --quick and in small pictures")
        ->check(CLI::Range(1, 64));
    command->add_option(
        "--picture-noise", arguments->pictureNoise,
        "relMSE to which the truths of whole pictures (score, FLIP, previews) are traced where the "
        "irradiance is judged at fewer pixels; 0: none, and neither score nor FLIP nor report; default: 2e-2");
    command
        ->add_option(
            "--truth-seconds", arguments->seconds,
            "Most time for the truths of one view; the next chart goes on from there. 0: no limit")
        ->capture_default_str();
    command->add_flag("--kept-truths", options.truth.takesKept,
                      "Take the cache's truths as they are; trace only where it has none");
    command->add_flag("--only-truths", options.onlyTruths,
                      "Trace the truths into the cache, measure nothing");
    command->add_flag("--no-all-bounces", options.skipsAllBounces,
                      "Judge only against as many bounces as a technique models");
    command->add_flag(
        "--on-screen", options.truth.onScreen,
        "Judge techniques of the picture alone against the light of what the view shows as well");
    command->add_option(
        "--truth-cache", options.truth.directory,
        "Folder of the truths; default: references/ in LIGHTWELL_CACHE_DIR or the user's cache");
    command
        ->add_option("--frames", options.frames,
                     "Measured frames of each point after the unmeasured ones, whatever their time; "
                     "default: enough for steady figures")
        ->check(CLI::Range(1, 200));
    command->add_option("--warmup", options.warmUp, "Unmeasured frames before; more where something has to settle")
        ->check(CLI::Range(0, 200))
        ->capture_default_str();
    command->add_option("--device", options.device, "As for render");
    command->add_option("--width", options.deviceWidth,
                        "Lanes per work-item: 1, 4, 8 or 16; default: by probe");
    command->add_flag("--no-report", arguments->skipsReport,
                      "Measure only; results.json is written all the same");
    command->add_flag("--report-only", arguments->onlyReport, "Plots and report of the results in DIR");
    command->callback([arguments] { chart(*arguments); });
}

}  // namespace cli
