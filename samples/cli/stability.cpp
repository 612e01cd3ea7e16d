// `lightwell stability`: the catalogue of failures, every technique driven through it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "chart_script.h"
#include "cli.h"
#include "interrupt.h"
#include "parameters.h"
#include "stability_results.h"
#include "stability_run.h"

namespace cli {
namespace {

struct Arguments {
    StabilityOptions stability;
    std::vector<std::string> scenes, sequences;
    std::string size, compare;
    int frames = 0;
    bool onlyReport = false, skipsReport = false;
};

// A frame of a real scene costs several times one of the catalogue's (rays, suns' shadow maps, paths): a
// quarter of the pixels and half of the frames, of which the ghost index, from 14 on, can still tell.
constexpr const char *kSize = "320x180", *kSceneSize = "160x90";
constexpr int kFrames = 32, kSceneFrames = 16, kQuickFrames = 8;

// More would overflow the number of paths long after the time of anybody who waits for them.
void requireEffort(double effort) {
    constexpr double kLeast = 1e-3, kMost = 1e4;
    if (!(effort >= kLeast && effort <= kMost))  // NaN is neither
        throw UsageError(fmt::format("--truth-effort {}: expected {} to {}", effort, kLeast, kMost));
}

// What is held of a sequence until it is judged, and the copies that the judges make.
void requireMemoryFor(const StabilityOptions& options) {
    constexpr double kOfTruth = 40.0, kOfTechnique = 25.0, kOfJudges = 120.0;  // bytes per pixel
    const double pixels = double(options.size.frames) * options.size.width * options.size.height;
    requireMemory("--size, --frames",
                  fmt::format("{}x{}, {}", options.size.width, options.size.height, options.size.frames),
                  pixels * (kOfTruth + kOfTechnique * double(options.techniques.size()) + kOfJudges));
}

void complete(Arguments& arguments) {
    StabilityOptions& options = arguments.stability;
    if (options.techniques.empty()) options.techniques = techniqueNames();
    for (const std::string& technique : options.techniques)
        requireOneOf("technique", technique, techniqueNames());
    for (const std::string& assignment : options.assignments) {
        const std::string key = assignment.substr(0, assignment.find('='));
        if (std::none_of(options.techniques.begin(), options.techniques.end(),
                         [&](const std::string& technique) { return Parameters(technique).has(key); }))
            throw UsageError(fmt::format("--set {}: none of the techniques has a parameter of this name", assignment));
    }
    options.sequences = chooseSequences(arguments.scenes, arguments.sequences, options.quick);
    const bool hasScene = std::any_of(options.sequences.begin(), options.sequences.end(),
                                      [](const SequenceChoice& c) { return !c.scene.empty(); });
    requireEffort(options.truthEffort);
    if (options.deviceWidth != 0)
        requireOneOf("--width", std::to_string(options.deviceWidth), {"1", "4", "8", "16"});
    const Size size = parseSize(!arguments.size.empty()     ? arguments.size
                                : hasScene || options.quick ? kSceneSize
                                                            : kSize);
    options.size = {arguments.frames != 0 ? arguments.frames
                    : options.quick       ? kQuickFrames
                    : hasScene            ? kSceneFrames
                                          : kFrames,
                    size.width, size.height};
    requireMemoryFor(options);
}

// Throws when anything has become worse, so that the command's exit code says so.
void reportComparison(const nlohmann::ordered_json& before, const nlohmann::ordered_json& now,
                      const std::string& path) {
    const StabilityComparison comparison = compareStability(before, now);
    if (comparison.results == 0)  // nothing worse among nothing would pass for a check
        throw UsageError(
            fmt::format("--compare {}: expected results of the same techniques and sequences, got none "
                        "in common",
                        path));
    fmt::print("\nAgainst {}: {} figures compared, {} worse beyond noise, {} better\n", path,
               comparison.compared, comparison.regressions.size(), comparison.improvements.size());
    for (const std::string& text : comparison.regressions) fmt::print("WORSE   {}\n", text);
    for (const std::string& text : comparison.improvements) fmt::print("better  {}\n", text);
    for (const std::string& text : comparison.notes) fmt::print("note    {}\n", text);
    if (!comparison.regressions.empty())
        throw std::runtime_error(fmt::format("{} figure(s) worse than in {}, the first: {}",
                                             comparison.regressions.size(), path,
                                             comparison.regressions.front()));
}

void stability(Arguments& arguments) {
    complete(arguments);
    const StabilityOptions& options = arguments.stability;
    nlohmann::ordered_json before;
    if (!arguments.compare.empty()) {
        before = readStability(arguments.compare);
        // Before an hour of measuring, not after it.
        if (!arguments.onlyReport) requireComparable(before, options.size);
    }
    const std::filesystem::path folder(options.folder);
    asUsage([&] { std::filesystem::create_directories(folder / "images"); });
    if (!arguments.onlyReport) {
        const InterruptGuard guard;
        runStability(options);
    }
    if (options.onlyTruths) return;
    const std::string path = (folder / "stability.json").string();
    const nlohmann::ordered_json now = readStability(path);
    fmt::print("{}{}\n", stabilityTable(now), path);
    if (!arguments.skipsReport) runChartScript("report.py", {options.folder});
    if (!arguments.compare.empty()) reportComparison(before, now, arguments.compare);
}

}  // namespace

void addStability(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "stability",
        "The catalogue of failures, or movements of scenes: how techniques behave from frame to frame");
    auto arguments = std::make_shared<Arguments>();
    StabilityOptions& options = arguments->stability;
    command
        ->add_option("--out", options.folder,
                     "Folder (made when missing) of stability.json and the worst frames' pictures")
        ->required();
    command->add_option("--techniques", options.techniques, "Techniques by name; default: all");
    command->add_option("--set", options.assignments,
                        "key=value, one or several: parameters (see render), of the techniques that have them");
    command->add_option("--scenes", arguments->scenes,
                        "Scenes by name or path: instead of the catalogue their first cameras and "
                        "lights, moved");
    command->add_option("--sequences", arguments->sequences,
                        "Sequences by name, or SCENE.MOVEMENT; with --scenes movements of these; "
                        "default: the catalogue, or all movements");
    command->add_flag("--quick", options.quick,
                      "8 frames of 160x90; of the catalogue, about a minute, the sequences that say "
                      "most");
    command
        ->add_option("--frames", arguments->frames,
                     "Frames of each sequence; default: 32, with scenes 16")
        ->check(CLI::Range(2, 10000));
    command->add_option("--size", arguments->size,
                        "Picture size, WIDTHxHEIGHT; default: 320x180, with scenes 160x90");
    CLI::Option* compare = command->add_option(
        "--compare", arguments->compare,
        "stability.json of an earlier run: says what is worse beyond the noise of both; exit "
        "code 1 when anything is");
    command
        ->add_option("--truth-effort", options.truthEffort,
                     "Times the paths per pixel that each sequence's truth is traced with")
        ->capture_default_str();
    CLI::Option* onlyTruths = command->add_flag("--only-truths", options.onlyTruths,
                                                "Trace the truths into the cache, measure nothing");
    command->add_option(
        "--truth-cache", options.truthDirectory,
        "Folder of the truths; default: references/ in LIGHTWELL_CACHE_DIR or the user's cache");
    command->add_flag("--no-report", arguments->skipsReport,
                      "Without the report; stability.json is written");
    command
        ->add_flag("--report-only", arguments->onlyReport,
                   "Table, comparison and report of the results in DIR; nothing is measured")
        ->excludes(onlyTruths);
    onlyTruths->excludes(compare);
    command->add_option("--device", options.device, "As for render");
    command->add_option("--width", options.deviceWidth,
                        "Lanes per work-item: 1, 4, 8 or 16; default: by probe");
    command->callback([arguments] { stability(*arguments); });
}

}  // namespace cli
