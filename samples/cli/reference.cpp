// `lightwell reference`: the truth by path tracing (studio/path_tracer.h), as an EXR with its noise.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "cli.h"
#include "gbuffer.h"
#include "interrupt.h"
#include "layers.h"
#include "path_tracer.h"
#include "progress.h"
#include "reference_layers.h"

namespace cli {
namespace {

// For each pixel: double sums of four layers and two halves, the layers of the picture, twice on
// writing.
constexpr double kPixelBytes = 900.0;
constexpr int kMostSamples = 1 << 20;  // per pixel; more only hides a mistake

struct ReferenceOptions {
    ViewOptions view;
    std::string bounces, vpls, until, out, checkpoint;
    std::string samples = "256", seed = "1";
    std::string quantity = "irradiance", radius = "0.2", weighting = "cosine", roughness = "0.5";
    std::vector<std::string> sourceViews;
    bool unshadowed = false, half = false, compact = false, onScreen = false;
    CLI::Option *radiusGiven = nullptr, *weightingGiven = nullptr, *roughnessGiven = nullptr;
    bool isAmbient() const { return quantity == "ambient-occlusion"; }
    bool isSpecular() const { return quantity == "specular-radiance"; }
};

void checkQuantity(const ReferenceOptions& options) {
    requireOneOf("--quantity", options.quantity,
                 {"irradiance", "ambient-occlusion", "specular-radiance"});
    if (!options.isSpecular() && options.roughnessGiven->count() > 0)
        throw UsageError("--roughness: expected --quantity specular-radiance with it");
    if (options.isSpecular() &&
        (options.bounces != "1" || options.unshadowed || options.onScreen || !options.vpls.empty()))
        throw UsageError(
            "--quantity specular-radiance: expected --bounces 1 without --unshadowed, --on-screen, "
            "--vpls");
    requireOneOf("--weighting", options.weighting, {"cosine", "uniform"});
    if (!options.sourceViews.empty() && !options.onScreen)
        throw UsageError("--source-view: expected --on-screen with it, whose light it adds to");
    if (options.onScreen && !options.vpls.empty())
        throw UsageError("--on-screen: --vpls has senders of its own; leave one of them out");
    if (options.isAmbient() &&
        (!options.bounces.empty() || options.unshadowed || options.onScreen || !options.vpls.empty()))
        throw UsageError(
            "--quantity ambient-occlusion: knows no light; leave out --bounces, --unshadowed, "
            "--on-screen and --vpls");
    for (const CLI::Option* given : {options.radiusGiven, options.weightingGiven})
        if (!options.isAmbient() && given->count() > 0)
            throw UsageError(fmt::format(
                "{}: expected --quantity ambient-occlusion with it, which alone it says something of",
                given->get_name()));
}

// The traced layers whose sum stands in R, G, B.
std::vector<std::string> chosenLayers(const ReferenceOptions& options) {
    if (options.isAmbient()) return {"ambient"};
    if (options.isSpecular()) return {"specular"};
    if (options.bounces.empty()) throw UsageError("--bounces is required; valid: 1, 2, all");
    requireOneOf("--bounces", options.bounces, {"1", "2", "all"});
    if (options.bounces != "1" && (options.unshadowed || options.onScreen || !options.vpls.empty()))
        throw UsageError(fmt::format("--bounces {}: {} knows one bounce only; expected --bounces 1",
                                     options.bounces,
                                     options.unshadowed ? "--unshadowed"
                                     : options.onScreen ? "--on-screen"
                                                        : "--vpls"));
    if (options.bounces == "1") return {"bounce1"};
    if (options.bounces == "2") return {"bounce1", "bounce2"};
    return {"all"};
}

double parseUntil(const std::string& text) {
    constexpr std::string_view kKey = "relMSE=";
    if (text.rfind(kKey, 0) != 0) throw UsageError(fmt::format("--until '{}': expected relMSE=X", text));
    const double target = parseNumber("--until relMSE", text.substr(kKey.size()));
    if (target <= 0.0) throw UsageError(fmt::format("--until '{}': expected X above 0", text));
    return target;
}

studio::PathTracerOptions tracerOptions(const ReferenceOptions& options) {
    studio::PathTracerOptions tracer;
    const std::uint64_t samples = parseUnsigned("--spp", options.samples);
    if (samples < 2 || samples % 2 != 0 || samples > std::uint64_t(kMostSamples))
        throw UsageError(
            fmt::format("--spp '{}': expected an even number from 2 to {} (half of the samples to "
                        "each of two independent pictures)",
                        options.samples, kMostSamples));
    tracer.samplesPerPixel = int(samples);
    tracer.seed = parseUnsigned("--seed", options.seed);
    tracer.unshadowed = options.unshadowed;
    tracer.judgedLayers = chosenLayers(options);
    // Nobody keeps what later bounces bring: the same light of the first ones for less time, by other
    // samples where sky or emission shine.
    if (options.compact && options.bounces != "all" && !options.isAmbient())
        tracer.maxBounces = options.bounces == "1" ? 1 : 2;
    if (!options.until.empty()) {
        if (!options.vpls.empty())
            throw UsageError("--until: --vpls sums without noise; leave --until out");
        tracer.untilRelMse = parseUntil(options.until);
        tracer.samplesPerPixel = 16;  // look at the halves early; the target decides
        tracer.maxSamplesPerPixel = kMostSamples;
    }
    return tracer;
}

void describe(studio::Image& image, const ReferenceOptions& options, const studio::Camera& camera,
              const std::vector<std::string>& chosen, double noise) {
    const std::string layer = fmt::format("{}", fmt::join(chosen, "+"));
    image.metadata["layer"] = layer;
    image.metadata["scene"] = std::filesystem::path(options.view.scene).stem().string();
    image.metadata["camera"] = camera.name;
    image.metadata["size"] = options.view.size;
    if (options.unshadowed) image.metadata["unshadowed"] = "1";
    if (options.onScreen) {
        std::vector<std::string> names = options.sourceViews;
        names.insert(names.begin(), camera.name);
        image.metadata["senders"] = fmt::format("{}", fmt::join(names, ", "));
    }
    if (options.isAmbient()) {
        image.metadata["radius"] = options.radius;
        image.metadata["weighting"] = options.weighting;
    }
    if (options.isSpecular()) image.metadata["roughness"] = options.roughness;
    if (!options.vpls.empty())
        image.metadata["vpls_file"] = std::filesystem::path(options.vpls).filename().string();
    if (noise >= 0.0) image.metadata["noise." + layer] = fmt::format("{:.9g}", noise);
}

// The pictures whose surfaces send light; none: all surfaces do.
std::vector<studio::PictureView> sendersSeenBy(const ReferenceOptions& options,
                                               const studio::Scene& scene, const studio::Camera& camera,
                                               const Size& size) {
    std::vector<studio::PictureView> views;
    if (!options.onScreen) return views;
    views.push_back({camera, size.width, size.height});
    for (const std::string& name : options.sourceViews) {
        ViewOptions other = options.view;
        other.camera = name;
        views.push_back({findCamera(scene, other), size.width, size.height});
    }
    return views;
}

std::string checkpointPath(const ReferenceOptions& options) {
    return options.checkpoint.empty() ? options.out + ".part" : options.checkpoint;
}

studio::Image traceWithProgress(const studio::RayScene& rayScene, const studio::GBuffer& gbuffer,
                                studio::PathTracerOptions tracer) {
    const InterruptGuard guard;
    studio::ProgressLine line("tracing " + rayScene.scene().name);
    tracer.progress = [&](double fraction, double relMse) {
        line.update(fraction, relMse < 0.0 ? "" : fmt::format("noise (relMSE) {:.2e}", relMse));
        if (InterruptGuard::wasRaised())
            throw Interrupted("interrupted; the same command goes on from " + tracer.checkpoint);
    };
    try {
        studio::Image traced = studio::tracePaths(rayScene, gbuffer, tracer);
        line.finish();
        return traced;
    } catch (const studio::CheckpointError& error) {
        throw UsageError(fmt::format("{}; delete it or name another with --checkpoint", error.what()));
    }
}

void traceReference(const ReferenceOptions& options) {
    checkQuantity(options);
    studio::PathTracerOptions tracer = tracerOptions(options);
    const studio::AmbientOptions ambient{parsePositive("--radius", options.radius),
                                         options.weighting == "uniform"};
    if (options.isAmbient()) tracer.ambient = &ambient;
    const studio::SpecularOptions specular{double(parseRoughness(options.roughness))};
    if (options.isSpecular()) tracer.specular = &specular;
    tracer.checkpoint = checkpointPath(options);
    const Size size = parseSize(options.view.size);
    requireOutputPath("--out", options.out, {".exr"});
    requireOutputPath("--checkpoint", tracer.checkpoint, {});
    requireDistinct(
        {{"--vpls", options.vpls}, {"--checkpoint", tracer.checkpoint}, {"--out", options.out}});
    requireMemory("--size", options.view.size, kPixelBytes * size.width * size.height);
    std::vector<studio::VplRecord> vpls;
    if (!options.vpls.empty()) {
        vpls = asUsage([&] { return studio::readVpls(options.vpls); });
        tracer.vpls = &vpls;
    }
    const auto scene = loadScene(options.view);
    const studio::Camera camera = findCamera(*scene, options.view);
    tracer.sendersSeenBy = sendersSeenBy(options, *scene, camera, size);

    const float time = float(options.view.time);
    const auto rayScenePointer =
        asUsage([&] { return std::make_unique<studio::RayScene>(scene, time); });
    const studio::RayScene& rayScene = *rayScenePointer;
    const studio::GBuffer gbuffer =
        studio::renderGBuffer(rayScene, camera, size.width, size.height, camera, time);
    const studio::Image traced = traceWithProgress(rayScene, gbuffer, tracer);

    const bool hasHalves = traced.has("a." + tracer.judgedLayers.front() + ".R");
    const double noise = hasHalves ? studio::estimateNoise(traced, tracer.judgedLayers) : -1.0;
    studio::Image image = assembleReference(traced, tracer.judgedLayers, options.compact);
    addLayer(image, "direct.", gbuffer.direct);
    addLayer(image, "albedo.", gbuffer.albedo);
    if (!options.compact) addLayer(image, "normal.", gbuffer.normal);
    describe(image, options, camera, tracer.judgedLayers, noise);
    studio::writeExr(options.out, image, options.half);
    std::remove(tracer.checkpoint.c_str());
    if (tracer.untilRelMse > 0.0 && noise > tracer.untilRelMse)
        fmt::print(stderr,
                   "note: {} samples per pixel are the most that are traced; the noise is above {}\n",
                   image.metadata["spp"], options.until);
    const std::string effort = tracer.vpls == nullptr ? image.metadata["spp"] + " samples per pixel"
                                                      : fmt::format("{} VPLs", vpls.size());
    fmt::print("{}: {}x{}, {}, {}{}\n", options.out, size.width, size.height, image.metadata["layer"],
               effort, noise < 0.0 ? "" : fmt::format(", noise (relMSE) {:.3g}", noise));
}

// What is asked: a quantity, and whose light.
void declareTruth(CLI::App& command, ReferenceOptions& options) {
    command.add_option(
        "--bounces", options.bounces,
        "Required of irradiance; what stands in R,G,B: 1 = one indirect bounce; 2 = first and second "
        "together; all");
    command
        .add_option("--quantity", options.quantity,
                    "irradiance; ambient-occlusion: the open share of the hemisphere, 1 = open; or "
                    "specular-radiance: what arrives along glossy lobes, W/(sr m^2)")
        ->capture_default_str();
    options.roughnessGiven =
        command
            .add_option("--roughness", options.roughness, "Of specular-radiance: of all pixels, 0..1")
            ->capture_default_str();
    options.radiusGiven =
        command
            .add_option(
                "--radius", options.radius,
                "Of ambient-occlusion: what counts lies nearer, in heights of the picture at the "
                "pixel's depth")
            ->capture_default_str();
    options.weightingGiven =
        command
            .add_option("--weighting", options.weighting,
                        "Of ambient-occlusion: directions by their cosine, or uniform")
            ->capture_default_str();
    command.add_flag("--on-screen", options.onScreen,
                     "Only surfaces that the picture shows send light (one bounce): what a technique of "
                     "the picture alone can know");
    command
        .add_option("--source-view", options.sourceViews,
                    "Cameras whose pictures' surfaces send light too, with --on-screen")
        ->take_all();
    command.add_flag("--unshadowed", options.unshadowed,
                     "Every lit surface along a pixel's ray sends light, none blocks it (one bounce)");
    command.add_option(
        "--vpls", options.vpls,
        "VPLs of `lightwell render --vpls-out`, summed with exact visibility (one bounce)");
}

}  // namespace

void addReference(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "reference",
        "Path-trace the true indirect irradiance (W/m^2) of a view, with its own noise estimate");
    auto options = std::make_shared<ReferenceOptions>();
    options->view.declare(*command);
    declareTruth(*command, *options);
    CLI::Option* spp = command->add_option("--spp", options->samples, "Paths per pixel, an even number");
    spp->capture_default_str();
    command
        ->add_option("--until", options->until, "relMSE=X: trace until the noise estimate is X or less")
        ->excludes(spp);
    command->add_option("--seed", options->seed, "Seed of the random numbers")->capture_default_str();
    command->add_flag("--half", options->half, "Half-float channels instead of 32 bits");
    command->add_flag(
        "--compact", options->compact,
        "Only R,G,B, direct.* and albedo.*, as a comparison needs them; the noise as metadata");
    command->add_option("--checkpoint", options->checkpoint,
                        "File to resume from; default: OUT.part, removed when done");
    command->add_option("--out", options->out, "EXR to write")->required();
    command->callback([options] { traceReference(*options); });
}

}  // namespace cli
