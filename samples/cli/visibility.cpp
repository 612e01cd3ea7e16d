// `lightwell visibility`: the share of pairs of pixel and VPL whose visibility a clustered technique
// misjudges.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "cli.h"
#include "false_colour.h"
#include "visibility_run.h"

namespace cli {
namespace {

constexpr const char* kSize = "320x180";
constexpr double kNoise = 5e-3;
// Panels of a picture: what the map misjudges, and what rays to the clusters' medoids do.
constexpr const char* kPanels[] = {"map.light", "map.shadow", "medoid.light", "medoid.shadow"};

struct Arguments {
    VisibilityOptions options;
    std::string out, noise, seconds = "0";
    bool asJson = false;
};

// Misjudged light relative to the pixel's own, as relMSE weighs it, side by side.
studio::Image panels(const studio::VisibilityVerdict& verdict) {
    const studio::Image& exact = verdict.irradiance[int(studio::Sight::exact)];
    const std::size_t count = exact.pixelCount();
    std::vector<double> light(count, 0.0);
    double mean = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        for (const char* channel : {"R", "G", "B"}) light[i] += double(exact.plane(channel)[i]) / 3.0;
        mean += light[i] / double(count);
    }
    const int columns = int(std::size(kPanels));
    std::vector<float> values(count * std::size(kPanels));
    for (int panel = 0; panel < columns; ++panel)
        for (std::size_t i = 0; i < count; ++i) {
            const double scale = std::sqrt(light[i] * light[i] + 0.01 * mean * mean);
            const std::size_t row = i / std::size_t(exact.width), column = i % std::size_t(exact.width);
            values[(row * std::size_t(columns) + std::size_t(panel)) * std::size_t(exact.width) +
                   column] =
                scale > 0.0 ? float(double(verdict.pictures.plane(kPanels[panel])[i]) / scale) : 0.0f;
        }
    return studio::falseColour(values, exact.width * columns, exact.height);
}

studio::Image layersOf(const studio::VisibilityVerdict& verdict) {
    studio::Image image = verdict.pictures;
    for (std::size_t way = 0; way < studio::kSightCount; ++way)
        for (const char* channel : {"R", "G", "B"})
            image.plane(fmt::format("{}.{}", studio::kSightNames[way], channel)) =
                verdict.irradiance[way].plane(channel);
    return image;
}

void printText(const nlohmann::ordered_json& json) {
    fmt::print("{}, {}\n", json["scene"].get<std::string>(), json["camera"].get<std::string>());
    for (const auto& point : json["points"]) {
        fmt::print("\n{}: {} VPLs, {} clusters, {} pairs, {:.1f} % of their light arrives\n",
                   point["settings"].get<std::string>(), point["vpls"].get<int>(),
                   point["clusters"].get<int>(), point["pairs"].get<std::uint64_t>(),
                   100.0 * point["lit_weighted"].get<double>());
        fmt::print("{:<20} {:>12} {:>12} {:>12} {:>12} {:>10}\n", "", "false light", "false shadow",
                   "of light", "of light", point.contains("error") ? "relMSE" : "");
        for (const auto& [way, wrong] : point["misjudged"].items()) {
            fmt::print("{:<20}", way);
            for (const auto& [key, share] : wrong.items())
                fmt::print(" {:>10.3f} %", 100.0 * share.get<double>());
            if (point.contains("error") && point["error"].contains(way))
                fmt::print(" {:>10.4g}", point["error"][way]["relMSE"].get<double>());
            fmt::print("\n");
        }
        if (point.contains("error"))
            fmt::print("{:<72} {:>10.4g}\n", "exact", point["error"]["exact"]["relMSE"].get<double>());
    }
}

void visibility(Arguments& arguments) {
    VisibilityOptions& options = arguments.options;
    requireOneOf("technique", options.technique, techniqueNames());
    if (options.deviceWidth != 0)
        requireOneOf("--width", std::to_string(options.deviceWidth), {"1", "4", "8", "16"});
    const std::vector<Parameters> points = visibilityPoints(options);
    if (!arguments.out.empty()) {
        requireOutputPath("--out", arguments.out, {".exr", ".png"});
        if (points.size() > 1)
            throw UsageError(
                fmt::format("--out '{}': expected one point, got {}", arguments.out, points.size()));
    }
    setTruthLimits(options.truth, arguments.noise, kNoise, arguments.seconds);
    options.truth.block = judgedBlock(options.truth.block, parseSize(options.view.size), false);
    const VisibilityResult result = runVisibility(options, points);
    if (hasExtension(arguments.out, ".exr")) studio::writeExr(arguments.out, layersOf(result.last));
    if (hasExtension(arguments.out, ".png")) studio::writePng(arguments.out, panels(result.last));
    if (arguments.asJson)
        fmt::print("{}\n", result.json.dump(2));
    else
        printText(result.json);
}

}  // namespace

void addVisibility(CLI::App& app) {
    CLI::App* command = app.add_subcommand("visibility",
                                           "What a technique with clustered VPLs takes to be visible, "
                                           "against rays: false light, false shadow");
    auto arguments = std::make_shared<Arguments>();
    VisibilityOptions& options = arguments->options;
    options.view.size = kSize;
    options.view.declare(*command);
    command
        ->add_option("--technique", options.technique,
                     "With debug views vpls, vpl_clusters, clusters, visibility")
        ->capture_default_str();
    command
        ->add_option("--set", options.assignments,
                     "key=value, one or several: parameters of every point")
        ->allow_extra_args(false);
    command
        ->add_option("--sweep", options.sweeps,
                     "key=value,value: points of every combination; may be repeated")
        ->allow_extra_args(false);
    options.truth.block = 0;
    command
        ->add_option("--judge-one-of", options.truth.block,
                     "N: one pixel of each N x N; default: 4 (small pictures 1)")
        ->check(CLI::Range(1, 64));
    command->add_flag("--no-truth", options.skipsTruth,
                      "Without the path-traced truth, and the errors against it");
    command->add_option("--noise", arguments->noise,
                        "relMSE to which the truth is traced; default: 5e-3");
    command->add_option("--truth-seconds", arguments->seconds, "Most time for the truth; 0: no limit")
        ->capture_default_str();
    command->add_flag("--kept-truths", options.truth.takesKept, "Take the cache's truth as it is");
    command->add_option("--truth-cache", options.truth.directory, "As for chart");
    command->add_option("--device", options.device, "As for render");
    command->add_option("--width", options.deviceWidth,
                        "Lanes per work-item: 1, 4, 8 or 16; default: by probe");
    command->add_option("--out", arguments->out,
                        "FILE.exr: irradiance and misjudged light of each judged pixel, by each way; "
                        "FILE.png: misjudged light in false "
                        "colour, map's and medoids' rays'. One point only");
    command->add_flag("--json", arguments->asJson, "JSON on stdout");
    command->callback([arguments] { visibility(*arguments); });
}

}  // namespace cli
