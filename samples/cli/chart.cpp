// `lightwell chart`: every technique x its parameter sweep x scene x view, error against time.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
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
// Irradiance is judged at one pixel of 4 x 4: a sixteenth of the paths, or sixteen times as many for
// each.
constexpr int kBlock = 4;
// Of the whole pictures, which composites are judged by: most composites forgive more than their
// irradiance.
constexpr double kPictureNoise = 2e-2;

struct Arguments {
    ChartOptions chart;
    std::string size, cameras = "all", noise, pictureNoise;
    int block = 0;
    bool skipsReport = false, onlyReport = false;
};

std::vector<std::string> allScenes() {
    std::vector<std::string> names;
    for (const studio::SceneEntry& entry : studio::listScenes()) names.push_back(entry.name);
    return names;
}

// Refuses unknown names at once, not after hours with those before them.
void requireScenes(const std::vector<std::string>& scenes) {
    const std::vector<std::string> known = allScenes();
    for (const std::string& scene : scenes)
        if (std::find(known.begin(), known.end(), scene) == known.end() &&
            !std::filesystem::exists(scene))
            asUsage([&] { studio::loadScene(scene); });  // says what it expected
}

// Picks along the shorter side of a picture: fewer would not tell its error.
constexpr int kFewestPicks = 32;

// Bytes for each pixel: the path tracer's sums, a view's buffers and truths, pictures that are judged.
constexpr double kPixelBytes = 1500.0;

void complete(Arguments& arguments) {
    ChartOptions& chart = arguments.chart;
    if (chart.scenes.empty())
        chart.scenes = chart.quick
                           ? std::vector<std::string>(std::begin(kQuickScenes), std::end(kQuickScenes))
                           : allScenes();
    if (chart.techniques.empty()) chart.techniques = techniqueNames();
    for (const std::string& technique : chart.techniques)
        requireOneOf("technique", technique, techniqueNames());
    requireOneOf("--cameras", arguments.cameras, {"all", "first"});
    for (const std::string& only : chart.only) splitAssignment("--only", only);
    if (chart.deviceWidth != 0)
        requireOneOf("--width", std::to_string(chart.deviceWidth), {"1", "4", "8", "16"});
    chart.firstCameraOnly = arguments.cameras == "first" || chart.quick;
    const Size size = parseSize(!arguments.size.empty() ? arguments.size
                                : chart.quick           ? kQuickSize
                                                        : "1280x720");
    requireMemory("--size", arguments.size, kPixelBytes * size.width * size.height);
    requireScenes(chart.scenes);
    chart.width = size.width;
    chart.height = size.height;
    chart.truth.noise = chart.quick ? kQuickNoise : kNoise;
    if (!arguments.noise.empty()) chart.truth.noise = parseNumber("--noise", arguments.noise);
    if (chart.truth.noise <= 0.0) throw UsageError("--noise: expected a relMSE above 0");
    chart.truth.pictureNoise = kPictureNoise;
    if (!arguments.pictureNoise.empty())
        chart.truth.pictureNoise = parseNumber("--picture-noise", arguments.pictureNoise);
    if (chart.truth.pictureNoise <= 0.0) throw UsageError("--picture-noise: expected a relMSE above 0");
    const int side = std::min(size.width, size.height);
    const bool hasRoom = side >= kBlock * kFewestPicks;
    chart.truth.block = arguments.block > 0 ? arguments.block : chart.quick || !hasRoom ? 1 : kBlock;
    if (chart.truth.block > 1 && side / chart.truth.block < kFewestPicks)
        throw UsageError(fmt::format("--judge-one-of {}: expected at most {} at {}x{}",
                                     chart.truth.block, std::max(1, side / kFewestPicks), size.width,
                                     size.height));
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
    command->add_option("--techniques", options.techniques, "Techniques by name; default: all");
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
        "irradiance is judged at fewer pixels; default: 2e-2");
    command
        ->add_option(
            "--truth-seconds", options.truth.seconds,
            "Most time for the truths of one view; the next chart goes on from there. 0: no limit")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    command->add_flag("--kept-truths", options.truth.takesKept,
                      "Take the cache's truths as they are; trace only where it has none");
    command->add_flag("--only-truths", options.onlyTruths,
                      "Trace the truths into the cache, measure nothing");
    command->add_flag("--no-all-bounces", options.skipsAllBounces,
                      "Judge only against as many bounces as a technique models");
    command->add_option(
        "--truth-cache", options.truth.directory,
        "Folder of the truths; default: references/ in LIGHTWELL_CACHE_DIR or the user's cache");
    command->add_option("--device", options.device, "As for render");
    command->add_option("--width", options.deviceWidth,
                        "Lanes per work-item: 1, 4, 8 or 16; default: by probe");
    command->add_flag("--no-report", arguments->skipsReport,
                      "Measure only; results.json is written all the same");
    command->add_flag("--report-only", arguments->onlyReport, "Plots and report of the results in DIR");
    command->callback([arguments] { chart(*arguments); });
}

}  // namespace cli
