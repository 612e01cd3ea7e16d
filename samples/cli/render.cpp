// `lightwell render`: one view of a scene with a technique, measured. Some lines over 300: most are the command's options and what
// they mean, which are to be read in one place.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "cli.h"
#include "indirect_renderer.h"
#include "layers.h"
#include "path_tracer.h"
#include "render_inputs.h"
#include "render_picture.h"
#include "render_report.h"
#include "render_sequence.h"
#include "vpl_view.h"

namespace cli {
namespace {

// Direct light only: no device, no technique.
constexpr const char* kNoTechnique = "none";

struct RenderOptions {
    ViewOptions view;
    std::string quantity = "irradiance", technique, seed, vplsOut, device, debugView, exposure,
                scale = "1", step = "0", focus = "eye", roughness = "0.5";
    std::vector<std::string> assignments, outs, sourceViews;
    int frames = 9, warmup = 3, width = 0, rsmSize = 512, cascades = 1;
    bool asJson = false, printsHash = false;
    CLI::Option* roughnessGiven = nullptr;
    const QuantityEntry& asked() const {
        for (const QuantityEntry& entry : quantityEntries())
            if (quantity == entry.name) return entry;
        throw UsageError("--quantity '" + quantity + "': expected one of " + joinNames(quantityNames()));
    }
};

void checkDistinctOutputs(const RenderOptions& options) {
    std::vector<std::pair<std::string, std::string>> outputs{{"--vpls-out", options.vplsOut}};
    if (!options.debugView.empty())
        outputs.emplace_back("--debug-view", splitAssignment("--debug-view", options.debugView).second);
    for (const std::string& out : options.outs) outputs.emplace_back("--out", out);
    requireDistinct(outputs);
}

// Bytes for each pixel and RSM texel: the studio's and the device's buffers, layers and their copies; no bound.
constexpr double kPixelBytes = 300.0, kTexelBytes = 72.0;

void checkMemory(const RenderOptions& options, const Size& size, const studio::Scene& scene) {
    requireMemory("--size", options.view.size,
                  kPixelBytes * size.width * size.height * double(1 + options.sourceViews.size()));
    double maps = 0.0;
    for (const studio::Light& light : scene.lights)
        maps += light.kind == studio::LightKind::Sun     ? options.cascades
                : light.kind == studio::LightKind::Point ? 6
                                                         : 1;
    requireMemory("--rsm-size", std::to_string(options.rsmSize),
                  maps * kTexelBytes * options.rsmSize * options.rsmSize);
}

void checkOptions(const RenderOptions& options) {
    std::vector<std::string> techniques = techniqueNames();
    techniques.push_back(kNoTechnique);
    if (options.technique.empty())
        throw UsageError("--technique is required; valid: " + joinNames(techniques));
    requireOneOf("technique", options.technique, techniques);
    requireOneOf("--quantity", options.quantity, quantityNames());
    if (!options.asked().hasRoughness && options.roughnessGiven->count() > 0)
        throw UsageError("--roughness: expected --quantity specular-radiance or refracted-radiance with it");
    parseRoughness(options.roughness);
    if (options.width != 0)
        requireOneOf("--width", std::to_string(options.width), {"1", "4", "8", "16"});
    for (const std::string& assignment : options.assignments) splitAssignment("--set", assignment);
    if (!options.exposure.empty()) parsePositive("--exposure", options.exposure);
    if (!options.exposure.empty() && options.asked().isShare)
        throw UsageError("--exposure: " + options.quantity + " is drawn as it is, 1 = white; leave it out");
    parsePositive("--scale", options.scale);
    parseFocus("--focus", options.focus);
    const double step = parseNumber("--step", options.step);
    if (step < 0.0 || !std::isfinite(float(step)))
        throw UsageError(fmt::format("--step '{}': expected seconds, 0 or more", options.step));
    if (options.cascades > 1 && options.rsmSize % 2 != 0)
        throw UsageError(
            fmt::format("--rsm-size '{}': expected an even number with --cascades", options.rsmSize));
    for (const std::string& out : options.outs) requireOutputPath("--out", out, {".exr", ".png"});
    if (!options.vplsOut.empty()) requireOutputPath("--vpls-out", options.vplsOut, {});
    if (!options.debugView.empty())
        requireOutputPath("--debug-view", splitAssignment("--debug-view", options.debugView).second,
                          {".exr"});
    checkDistinctOutputs(options);
    const bool hasResult =
        !options.outs.empty() || !options.vplsOut.empty() || options.asJson || options.printsHash;
    if (!hasResult) throw UsageError("--out is required: a file name ending in .exr or .png");
    if (options.technique == kNoTechnique) {
        if (!options.vplsOut.empty() || !options.debugView.empty() || !options.assignments.empty() || !options.sourceViews.empty())
            throw UsageError("--technique none has no VPLs, debug views, parameters or source views");
        if (const Quantity asked = options.asked().quantity; asked != Quantity::Irradiance)
            throw UsageError("--quantity " + std::string(entryOf(asked).name) + ": --technique none has irradiance alone");
    }
}

Parameters parseParameters(const RenderOptions& options) {
    Parameters parameters(options.technique);
    for (const std::string& assignment : options.assignments) parameters.set(assignment);
    if (!options.seed.empty()) {
        parseUnsigned("--seed", options.seed);
        if (!parameters.setEverywhere("seed", options.seed))
            fmt::print(stderr, "note: technique {} draws no random numbers; --seed changes nothing\n",
                       options.technique);
    }
    return parameters;
}

void writeOutputs(const RenderOptions& options, const studio::Image& image, RenderReport& report) {
    for (const std::string& out : options.outs) {
        if (hasExtension(out, ".exr")) {
            studio::writeExr(out, image);
        } else if (options.asked().isShare) {
            studio::writePng(out, image);  // already in [0,1]
        } else {
            const studio::Image lit = shownRadiance(image);
            const float exposure = options.exposure.empty()
                                       ? studio::autoExposure(lit)
                                       : parsePositive("--exposure", options.exposure);
            studio::writePng(out, studio::toneMap(lit, exposure));
            report.exposure = exposure;
        }
        report.outputs.push_back(out);
    }
}

// The technique's picture into `report` and `image`.
studio::Image renderWithTechnique(const RenderOptions& options, Sequence& sequence,
                                  RenderReport& report) {
    const Parameters parameters = parseParameters(options);
    const auto renderer =
        makeRenderer(parameters, sequence.at(0),
                     DeviceOptions{options.device, std::uint32_t(options.width), options.asked().quantity,
                                   parseRoughness(options.roughness)});
    report.parameters = parameters.resolved();
    report.figures = measure(
        *renderer, [&](int frame) -> const RenderInputs& { return sequence.at(frame); }, options.warmup,
        options.frames);
    report.frames = options.frames;
    if (renderer->device() != nullptr) {
        report.hasDevice = true;
        report.device = *renderer->device();
    }
    report.hash = hashBits(renderer->irradiance());
    if (!options.vplsOut.empty()) {
        studio::writeVpls(options.vplsOut, readVplView(*renderer));
        report.outputs.push_back(options.vplsOut);
    }
    if (!options.debugView.empty()) writeDebugView(*renderer, options.debugView);
    return assemblePicture(sequence.last(), renderer->irradiance(), renderer->validity(),
                           options.asked().quantity, report);
}

studio::Image renderDirectOnly(const RenderInputs& inputs, RenderReport& report) {
    const studio::PlanarBuffer nothing(report.size.width, report.size.height, 3);
    const studio::PlanarBuffer invalid(report.size.width, report.size.height, 1);
    report.hash = hashBits(nothing);
    return assemblePicture(inputs, nothing, invalid, Quantity::Irradiance, report);
}

// `--set a=1 b=2 SCENE`: the last word is no assignment, so it is the scene.
void takeSceneFromAssignments(RenderOptions& options) {
    std::vector<std::string>& words = options.assignments;
    if (options.view.scene.empty() && !words.empty() && words.back().find('=') == std::string::npos) {
        options.view.scene = words.back();
        words.pop_back();
    }
    if (options.view.scene.empty())
        throw UsageError("render: SCENE is required; `lightwell scenes` lists them");
}

bool hasSun(const studio::Scene& scene) {
    return std::any_of(scene.lights.begin(), scene.lights.end(),
                       [](const studio::Light& light) { return light.kind == studio::LightKind::Sun; });
}

void render(RenderOptions& options) {
    takeSceneFromAssignments(options);
    checkOptions(options);
    RenderReport report;
    report.size = parseSize(options.view.size);
    if (options.technique != kNoTechnique) parseParameters(options);  // refuse before loading anything
    const auto scene = loadScene(options.view);
    if (options.cascades > 1 && !hasSun(*scene))
        throw UsageError(fmt::format("--cascades '{}': expected 1, scene {} has no sun",
                                     options.cascades, scene->name));
    checkMemory(options, report.size, *scene);
    const float scale = parsePositive("--scale", options.scale);
    if (scale != 1.0f) scaleScene(*scene, scale);
    report.scene = scene->name;
    report.camera = findCamera(*scene, options.view).name;
    report.technique = options.technique;

    SequenceOptions sequenceOptions;
    sequenceOptions.camera = options.view.camera;
    sequenceOptions.sources = options.sourceViews;
    sequenceOptions.time = options.view.time;
    sequenceOptions.step = parseNumber("--step", options.step);
    sequenceOptions.frames = options.technique == kNoTechnique ? 1 : options.warmup + options.frames;
    sequenceOptions.inputs.width = report.size.width;
    sequenceOptions.inputs.height = report.size.height;
    sequenceOptions.inputs.rsm.size = options.rsmSize;
    sequenceOptions.inputs.rsm.cascades = options.cascades;
    sequenceOptions.inputs.focus = parseFocus("--focus", options.focus);
    sequenceOptions.inputs.focus.point *= scale;
    sequenceOptions.inputs.scale = scale;
    Sequence sequence(scene, sequenceOptions);
    sequence.at(0);
    if (scene->lights.empty())
        fmt::print(stderr, "note: scene {} has no sun, spot or point light\n", scene->name);
    const studio::Image image = options.technique == kNoTechnique
                                    ? renderDirectOnly(sequence.last(), report)
                                    : renderWithTechnique(options, sequence, report);
    writeOutputs(options, image, report);
    if (options.asJson)
        fmt::print("{}", toJson(report));
    else
        fmt::print("{}", toText(report));
    if (options.printsHash && !options.asJson) fmt::print("hash {}\n", hashText(report.hash));
}

void declareExtras(CLI::App& command, RenderOptions& options) {
    command.add_option(
        "--device", options.device,
        "gpu, cpu, PLATFORM:DEVICE indices or part of a name; default: LIGHTWELL_DEVICE, else the best");
    command.add_option("--width", options.width,
                       "Lanes per work-item: 1, 4, 8 or 16; default: by probe");
    command
        .add_option("--source-view", options.sourceViews,
                    "Cameras whose pictures are further source views of the frame, one or several")
        ->take_all();
    command.add_option("--rsm-size", options.rsmSize, "Texels along each side of an RSM")
        ->check(CLI::Range(1, kMaxSize))
        ->capture_default_str();
    command.add_option("--cascades", options.cascades, "Nested RSMs of a sun")
        ->check(CLI::Range(1, 8))
        ->capture_default_str();
    command.add_option(
        "--exposure", options.exposure,
        "PNG: factor on radiance before Reinhard's L/(1+L); default: log-average luminance to 0.18");
    command
        .add_option("--scale", options.scale,
                    "Scene in another unit: lengths times S, point and spot intensities times S^2")
        ->capture_default_str();
    command
        .add_option("--step", options.step,
                    "Seconds from frame to frame: the frames run up to --time, with true motion vectors "
                    "and previous cameras; 0: all frames are at --time")
        ->capture_default_str();
    command
        .add_option("--focus", options.focus,
                    "What a technique's grids lie around that do not hold all of the scene: eye, a "
                    "point X,Y,Z, or none, for its own center_x, ...")
        ->capture_default_str();
    command.add_flag("--hash", options.printsHash,
                     "Print a hash of the irradiance's bits (always in JSON)");
    command.add_option("--debug-view", options.debugView, "NAME=FILE.exr: write an intermediate buffer");
}

}  // namespace

void addRender(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("render", "Indirect light of a view with a technique of the library");
    auto options = std::make_shared<RenderOptions>();
    options->view.declare(*command)->required(false);
    command->add_option("--technique", options->technique,
                        "Required: a technique (below), or none: direct light only");
    command
        ->add_option("--quantity", options->quantity,
                     "irradiance, or of techniques that make it ambient-occlusion (1 = open), specular-radiance "
                     "(along glossy lobes, W/(sr m^2)), refracted-radiance (along the refracted view) or shadow "
                     "(of one light; 1 = lit)")
        ->capture_default_str();
    options->roughnessGiven = command->add_option("--roughness", options->roughness,
                                                  "Of all pixels, 0..1, of specular-radiance and refracted-radiance; default 0.5");
    command->add_option("--set", options->assignments,
                        "key=value, one or several: parameters of the technique (below)");
    command->add_option("--frames", options->frames, "Frames measured; times are medians")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    command->add_option("--warmup", options->warmup, "Frames rendered before these, not measured")
        ->check(CLI::Range(0, 100000))
        ->capture_default_str();
    command->add_option("--seed", options->seed, "Seed of the technique's samples; default: its own");
    command->add_option("--vpls-out", options->vplsOut,
                        "Write the VPLs, for `lightwell reference --vpls`");
    command
        ->add_option(
            "--out", options->outs,
            "FILE.exr: linear irradiance (W/m^2) R,G,B with layers direct.* (W/(sr m^2)), albedo.*, "
            "normal.*, validity; FILE.png: the tone-mapped composite. May be repeated")
        ->allow_extra_args(false);
    command->add_flag("--json", options->asJson,
                      "JSON on stdout: device, width, parameters, passes, total_ms, bytes, counts ...");
    declareExtras(*command, *options);
    command->footer([] { return describeParameters(); });
    command->callback([options] { render(*options); });
}

}  // namespace cli
