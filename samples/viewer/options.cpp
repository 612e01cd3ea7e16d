#include "options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

namespace viewer {
namespace {

constexpr int kLargestSide = 8192;

// Words as CLI11 hands them over.
struct Words {
    std::string size = "1280x720", show = "picture", exposure, split;
    std::vector<std::string> assignments;
    int frames = 0;
    bool noPanels = false;
};

// CLI11's own range check lets "nan" through.
CLI::Validator finite() {
    return CLI::Validator(
        [](std::string& text) { return std::isfinite(std::strtod(text.c_str(), nullptr)) ? "" : "expected a finite number, got " + text; }, "");
}

void declareScene(CLI::App& app, Options& options, Words& words) {
    app.add_option("--scene", options.scene, "A scene's name or path, as `lightwell render` takes it")->capture_default_str();
    app.add_option("--camera", options.camera, "Of the scene; default: its first");
    app.add_option("--size", words.size, "WIDTHxHEIGHT")->capture_default_str();
    app.add_option("--time", options.time, "Seconds at which keyframed scenes and paths begin")->check(finite())->capture_default_str();
    app.add_option("--path", options.path, "FILE.json: a camera with keys, played back (docs/viewer.md)");
    app.add_option("--step", options.step, "Seconds from frame to frame of --headless; default: 1/30 along a --path, else 0")
        ->check(finite())
        ->check(CLI::Range(0.0, 1e6));
    app.add_option("--truth", options.truth, "FILE.exr of `lightwell reference` or `render`, of the view's size: for the split view");
}

void declareTechnique(CLI::App& app, Options& options, Words& words) {
    app.add_option("--technique", options.settings.technique, "As `lightwell render` has them; auto: the planner chooses")->capture_default_str();
    app.add_option("--set", words.assignments, "key=value, one or several: parameters of the technique");
    app.add_option("--device", options.device, "gpu, cpu, PLATFORM:DEVICE indices or part of a name; default: LIGHTWELL_DEVICE, else the best");
    app.add_flag("--copies", options.wantsCopies, "Copies through host memory, also where the device shares OpenGL's buffers");
    app.add_option("--rsm-size", options.rsmSize, "Texels along each side of an RSM")->check(CLI::Range(16, kLargestSide))->capture_default_str();
    app.add_option("--shadow-size", options.shadowSize, "Texels along each side of a shadow map")
        ->check(CLI::Range(16, kLargestSide))
        ->capture_default_str();
}

void declareOutputs(CLI::App& app, Options& options, Words& words) {
    app.add_flag("--headless", options.isHeadless, "Without a window or a display");
    app.add_option("--frames", words.frames, "End after so many measured frames; default: when the window is closed, of --headless 1")
        ->check(CLI::Range(1, 1000000));
    app.add_option("--warmup", options.warmUp, "Frames before these, not measured")->check(CLI::Range(0, 100000))->capture_default_str();
    app.add_option("--screenshot", options.screenshot, "FILE.png: the last frame as shown, panels included");
    app.add_option("--out", options.out,
                   "FILE.exr: the last frame's irradiance (W/m^2) in R,G,B with layers direct.*, albedo.*, validity, for `lightwell compare`");
    app.add_flag("--json", options.asJson, "JSON on stdout: median frame time, the host's stages and Lightwell's passes");
    app.add_option("--show", words.show, "picture, direct, indirect, irradiance, validity, albedo, normal, depth, motion, check or debug")->capture_default_str();
    app.add_option("--debug-view", options.debugView, "The technique's intermediate buffer that --show debug shows");
    app.add_option("--exposure", words.exposure, "Factor on radiance; default: by the picture");
    app.add_option("--split", words.split, "0 .. 1: right of this share of the width, the truth");
    app.add_flag("--no-panels", words.noPanels, "The picture alone");
    app.add_flag("--check", options.checks, "Check the last frame's inputs (lwCheckInputs) and report what is found");
}

float parseFloat(const char* option, const std::string& text, float low, float high) {
    std::size_t used = 0;
    float value = 0.0f;
    try {
        value = std::stof(text, &used);
    } catch (const std::exception&) {
        used = 0;
    }
    if (used != text.size() || text.empty() || !(value >= low && value <= high))
        throw UsageError(fmt::format("{} '{}': expected a number from {} to {}", option, text, low, high));
    return value;
}

void takeSize(const std::string& text, Options& options) {
    int used = 0;
    if (std::sscanf(text.c_str(), "%5dx%5d%n", &options.width, &options.height, &used) != 2 || std::size_t(used) != text.size() ||
        std::min(options.width, options.height) < 1 || std::max(options.width, options.height) > kLargestSide)
        throw UsageError(fmt::format("--size '{}': expected WIDTHxHEIGHT, 1 to {} each", text, kLargestSide));
}

void takeAssignments(const std::vector<std::string>& words, Settings& settings) {
    for (const std::string& word : words) {
        const std::size_t equals = word.find('=');
        if (equals == std::string::npos || equals == 0) throw UsageError(fmt::format("--set '{}': expected key=value", word));
        settings.assignments[word.substr(0, equals)] = word.substr(equals + 1);
    }
}

void requireEnding(const char* option, const std::string& path, const std::string& ending) {
    if (path.empty()) return;
    if (path.size() <= ending.size() || path.compare(path.size() - ending.size(), ending.size(), ending) != 0)
        throw UsageError(fmt::format("{} '{}': expected a file name ending in {}", option, path, ending));
}

void takeFrames(const Words& words, Options& options) {
    options.frames = words.frames > 0 ? words.frames : options.isHeadless ? 1 : 0;
    if (options.frames > 0) return;
    const std::pair<const char*, bool> outputs[] = {
        {"--screenshot", !options.screenshot.empty()}, {"--out", !options.out.empty()}, {"--json", options.asJson}};
    for (const auto& [name, isGiven] : outputs)
        if (isGiven) throw UsageError(fmt::format("{}: expected --frames N or --headless too: it is written after the last frame", name));
}

void takeWords(const Words& words, Options& options) {
    takeSize(words.size, options);
    takeAssignments(words.assignments, options.settings);
    describeTechnique(options.settings.technique);  // refuses unknown ones before anything is loaded
    const auto name = std::find(showNames().begin(), showNames().end(), words.show);
    if (name == showNames().end())
        throw UsageError(fmt::format("--show '{}': expected one of {}", words.show, fmt::join(showNames(), ", ")));
    options.look.show = Show(name - showNames().begin());
    if (!words.exposure.empty()) {
        options.look.exposure = parseFloat("--exposure", words.exposure, 1e-6f, 1e6f);
        options.look.isAutomatic = false;
    }
    if (!words.split.empty()) options.look.split = parseFloat("--split", words.split, 0.0f, 1.0f);
    if (!words.split.empty() && options.truth.empty()) throw UsageError("--split: expected a --truth FILE.exr to show beside");
    if (options.look.show == Show::Debug && options.debugView.empty()) throw UsageError("--show debug: expected a --debug-view NAME");
    if (options.look.show == Show::Check) options.checks = true;
    requireEnding("--screenshot", options.screenshot, ".png");
    requireEnding("--out", options.out, ".exr");
    options.hasPanels = !words.noPanels;
    takeFrames(words, options);
}

}  // namespace

bool parseOptions(int argc, char** argv, Options& options) {
    CLI::App app{"Lightwell's viewer: a deferred renderer on OpenGL 3.3 that leaves indirect light to Lightwell"};
    app.name("lightwell-viewer");
    Words words;
    declareScene(app, options, words);
    declareTechnique(app, options, words);
    declareOutputs(app, options, words);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        app.exit(success);
        return false;
    } catch (const CLI::ParseError& error) {
        throw UsageError(fmt::format("{}; see lightwell-viewer --help", error.what()));
    }
    try {
        takeWords(words, options);
    } catch (const std::invalid_argument& error) {  // an unknown technique
        throw UsageError(fmt::format("--technique: {}", error.what()));
    }
    return true;
}

}  // namespace viewer
