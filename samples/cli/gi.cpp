// `lightwell gi`: a frame that another program wrote as EXR (G-buffer, RSMs) lit by a technique, as EXR or PNG. docs/hosts.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>

#include "check_findings.h"
#include "cli.h"
#include "gi_run.h"
#include "layers.h"
#include "render_picture.h"

namespace cli {
namespace {

constexpr const char* kDirectOnly = "none";  // no indirect light
constexpr const char* kTruth = "truth";      // the host's own

struct GiOptions {
    std::string gbuffer, camera, technique, device, exposure;
    std::vector<std::string> rsms, lights, truths, assignments, channels, rsmChannels, truthChannels, outs;
    int frames = 1, width = 0;
    bool twoSided = false, noCheck = false, asJson = false;
};

bool usesLibrary(const GiOptions& options) {
    return options.technique != kDirectOnly && options.technique != kTruth;
}

// What is written over an input is gone, and the same call a second time would read its own result.
void requireOtherThanInputs(const GiOptions& options) {
    std::vector<std::pair<std::string, std::string>> inputs = {{"--gbuffer", options.gbuffer}, {"--camera", options.camera}};
    for (const std::string& path : options.rsms) inputs.emplace_back("--rsm", path);
    for (const std::string& path : options.lights) inputs.emplace_back("--light", path);
    for (const std::string& path : options.truths) inputs.emplace_back("--truth", path);
    for (const std::string& out : options.outs)
        for (const auto& [option, path] : inputs) {
            std::error_code missing;
            if (std::filesystem::equivalent(out, path, missing))
                throw UsageError(fmt::format("--out '{}': expected another file than {} '{}', which is read", out, option, path));
        }
}

void checkOptions(const GiOptions& options) {
    std::vector<std::string> techniques = techniqueNames();
    techniques.insert(techniques.end(), {kDirectOnly, kTruth});
    requireOneOf("technique", options.technique, techniques);
    if (options.width != 0) requireOneOf("--width", std::to_string(options.width), {"1", "4", "8", "16"});
    if (!options.exposure.empty()) parsePositive("--exposure", options.exposure);
    if (options.outs.empty() && !options.asJson) throw UsageError("--out is required: a file name ending in .exr or .png");
    std::vector<std::pair<std::string, std::string>> outputs;
    for (const std::string& out : options.outs) {
        requireOutputPath("--out", out, {".exr", ".png"});
        outputs.emplace_back("--out", out);
    }
    requireDistinct(outputs);
    requireOtherThanInputs(options);
    if (!usesLibrary(options) && !options.assignments.empty())
        throw UsageError(fmt::format("--set: technique {} has no parameters", options.technique));
    if (options.technique == kTruth && options.truths.empty()) throw UsageError("--technique truth: expected --truth FILE.exr with it");
    if (options.technique != kTruth && !options.truths.empty()) throw UsageError("--truth: expected --technique truth with it");
}

Parameters parseParameters(const GiOptions& options) {
    Parameters parameters(options.technique);
    for (const std::string& assignment : options.assignments) parameters.set(assignment);
    requireFrameTechnique(parameters);
    return parameters;
}

void noteOddities(const std::string& path, const HostSurfaces& surfaces, bool twoSided) {
    const std::uint64_t shown = std::uint64_t(surfaces.width) * std::uint64_t(surfaces.height) - surfaces.background;
    if (!surfaces.hasOwnNormals)
        fmt::print(stderr, "note: {}: no layer with the normal; they are made of neighbouring pixels' places, turned to the camera{}{}\n", path,
                   surfaces.hasHalfPlaces ? "; places in half floats are rounded to 1/2048 of themselves, which tilts the normals of pixels that lie "
                                            "close together: full floats avoid that"
                                          : "",
                   surfaces.lonely == 0 ? ""
                                        : fmt::format("; {} surface pixels without a usable neighbour are taken as background", surfaces.lonely));
    if (surfaces.spoiled > 0)
        fmt::print(stderr, "note: {}: {} surface pixels whose albedo or direct radiance is negative or no number are taken as background\n", path,
                   surfaces.spoiled);
    if (!twoSided && surfaces.away * 100 > shown)
        fmt::print(stderr, "note: {}: {} of {} normals point away from the camera; --two-sided turns them about\n", path, surfaces.away, shown);
    if (surfaces.mixed * 100 > shown)
        fmt::print(stderr,
                   "note: {}: {} of {} pixels are means over several surfaces (normals shorter than 1); one sample through each pixel's centre "
                   "avoids that\n",
                   path, surfaces.mixed, shown);
}

// --light by --light, each with as many of the --rsm files as it has cameras.
void addLights(const GiOptions& options, HostFrame& frame) {
    std::vector<HostLight> lights;
    std::vector<std::string> needs;
    std::size_t wanted = 0;
    for (const std::string& path : options.lights) {
        lights.push_back(asUsage([&] { return readLightFile(path); }));
        needs.push_back(fmt::format("{} ({})", path, lights.back().cameras.size()));
        wanted += lights.back().cameras.size();
    }
    if (wanted != options.rsms.size())
        throw UsageError(fmt::format("--rsm: expected {} file{}, one for each camera of the --light files{}{}, got {}", wanted, wanted == 1 ? "" : "s",
                                     needs.empty() ? "" : " ", joinNames(needs), options.rsms.size()));
    const bool ownChannels = !options.rsmChannels.empty();
    const ChannelMap channels(ownChannels ? "--rsm-channels" : "--channels", ownChannels ? options.rsmChannels : options.channels);
    auto path = options.rsms.begin();
    for (HostLight& light : lights) {
        std::vector<HostSurfaces> maps;
        for (const HostCamera& camera : light.cameras) {
            maps.push_back(asUsage([&] { return readSurfaces(*path, camera, channels, options.twoSided, !light.fluxFromDirect); }));
            if (light.fluxFromDirect && !maps.back().hasDirect)
                throw UsageError(fmt::format("{}: expected direct radiance, as \"flux_from\": \"direct\" asks for it; it has no such layer", *path));
            noteOddities(*path, maps.back(), options.twoSided);
            ++path;
        }
        frame.addLight(std::move(light), std::move(maps));
    }
}

nlohmann::ordered_json surfacesJson(const HostSurfaces& surfaces) {
    return {{"size", {surfaces.width, surfaces.height}}, {"background", surfaces.background}, {"spoiled", surfaces.spoiled},
            {"away", surfaces.away},                     {"mixed", surfaces.mixed},           {"normals_made", !surfaces.hasOwnNormals},
            {"lonely", surfaces.lonely}};
}

// As `lightwell render` writes it, and what the light adds to the picture where the albedo is known.
studio::Image assemble(const HostFrame& frame, const GiLight& light, const RenderReport& report, studio::Image image) {
    const HostSurfaces& view = frame.view();
    addLayer(image, "", light.irradiance);
    addLayer(image, "validity", light.validity);
    addLayer(image, "normal.", view.normal);
    if (view.hasAlbedo) addLayer(image, "albedo.", view.albedo);
    if (view.hasDirect) addLayer(image, "direct.", view.direct);
    if (view.hasAlbedo) {
        studio::PlanarBuffer added(view.width, view.height, 3);
        for (int y = 0; y < view.height; ++y)
            for (int x = 0; x < view.width; ++x)
                added.setRgb(x, y, view.albedo.rgb(x, y) / studio::kPi * light.irradiance.rgb(x, y));
        addLayer(image, "indirect.", added);
    }
    image.metadata = {{"layer", "irradiance"}, {"gbuffer", report.scene}, {"camera", report.camera}, {"technique", report.technique}};
    if (report.hasDevice) image.metadata["device"] = report.device.name;
    for (const auto& [name, value] : report.parameters)
        image.metadata["set." + name] = std::visit([](const auto& held) { return fmt::format("{}", held); }, value);
    return image;
}

void writeOutputs(const GiOptions& options, const HostFrame& frame, const studio::Image& image, RenderReport& report) {
    for (const std::string& out : options.outs) {
        if (hasExtension(out, ".exr")) {
            studio::writeExr(out, image);
        } else {
            if (!frame.view().hasAlbedo || !frame.view().hasDirect)
                throw UsageError(fmt::format("--out {}: a PNG shows direct and indirect light together; {} has no layer with the {}", out,
                                             options.gbuffer, frame.view().hasAlbedo ? "direct radiance" : "albedo"));
            const studio::Image lit = shownRadiance(image);
            report.exposure = options.exposure.empty() ? studio::autoExposure(lit) : parsePositive("--exposure", options.exposure);
            studio::writePng(out, studio::toneMap(lit, float(report.exposure)));
        }
        report.outputs.push_back(out);
    }
}

void print(const GiOptions& options, const HostFrame& frame, const RenderReport& report, const std::vector<LWInputFinding>& findings) {
    for (const LWInputFinding& finding : findings)
        if (finding.severity != LW_SEVERITY_NOTE)
            fmt::print(stderr, "{}: {} {}: {}\n", severityName(finding), faultName(finding.fault), finding.argument, finding.message);
    if (!options.asJson) {
        fmt::print("{}", toText(report));
        return;
    }
    nlohmann::ordered_json json = nlohmann::ordered_json::parse(toJson(report));
    json.erase("scene");
    json["gbuffer"] = surfacesJson(frame.view());
    json["rsms"] = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < frame.lights().size(); ++i)
        for (const HostSurfaces& map : frame.maps(i)) json["rsms"].push_back(surfacesJson(map));
    json["findings"] = nlohmann::ordered_json::array();
    for (const LWInputFinding& finding : findings) json["findings"].push_back(findingJson(finding));
    fmt::print("{}\n", json.dump(2));
}

bool isZero(const studio::PlanarBuffer& light) {
    for (int y = 0; y < light.height(); ++y)
        for (int x = 0; x < light.width(); ++x)
            if (light.rgb(x, y) != glm::vec3(0.0f)) return false;
    return true;
}

void runGi(const GiOptions& options) {
    checkOptions(options);
    if (usesLibrary(options)) parseParameters(options);  // refuse before reading anything
    const ChannelMap channels("--channels", options.channels), truthChannels("--truth-channels", options.truthChannels);
    const HostCamera camera = asUsage([&] { return readCameraFile(options.camera); });
    HostFrame frame(asUsage([&] { return readSurfaces(options.gbuffer, camera, channels, options.twoSided, false); }), camera);
    noteOddities(options.gbuffer, frame.view(), options.twoSided);
    addLights(options, frame);

    RenderReport report;
    report.scene = options.gbuffer;
    report.camera = options.camera;
    report.technique = options.technique;
    report.size = {frame.view().width, frame.view().height};
    studio::Image image(report.size.width, report.size.height);
    std::vector<LWInputFinding> findings;
    GiLight light{studio::PlanarBuffer(report.size.width, report.size.height, 3), studio::PlanarBuffer(report.size.width, report.size.height, 1)};
    if (usesLibrary(options))
        light = renderGi(frame, parseParameters(options), DeviceOptions{options.device, std::uint32_t(options.width)}, options.frames, report,
                         options.noCheck ? nullptr : &findings);
    else if (options.technique == kTruth)
        light.irradiance = asUsage([&] { return readTruth(options.truths, truthChannels, frame.view(), image); });
    if (usesLibrary(options) && frame.lights().empty() && isZero(light.irradiance))
        fmt::print(stderr, "note: the light is zero everywhere: {} lights by lamps' maps, and there is no --light\n", options.technique);
    report.hash = hashBits(light.irradiance);
    writeOutputs(options, frame, assemble(frame, light, report, std::move(image)), report);
    print(options, frame, report, findings);
}

void declareInputs(CLI::App& command, GiOptions& options) {
    command.add_option("--gbuffer", options.gbuffer, "EXR with position or depth, and where known normal, albedo and direct radiance")->required();
    command.add_option("--camera", options.camera, "Camera file (JSON) of that picture")->required();
    command.add_option("--rsm", options.rsms, "EXR rendered from a lamp, with albedo; one for each camera of the --light files, in order");
    command.add_option("--light", options.lights, "Light file (JSON): a lamp and the cameras of its maps; may be repeated");
    command.add_option("--channels", options.channels, "ROLE=CHANNEL,CHANNEL,CHANNEL, one or several: which channels hold what (below)");
    command.add_option("--rsm-channels", options.rsmChannels, "The same for the --rsm files; default: --channels");
    command.add_flag("--two-sided", options.twoSided, "Normals that point away from the camera are turned about");
    command.add_option("--truth", options.truths,
                       "EXR with the host's own path-traced indirect light, one or several to average, for --technique truth");
    command.add_option("--truth-channels", options.truthChannels, "As --channels, of the --truth files");
}

}  // namespace

void addGi(CLI::App& app) {
    CLI::App* command = app.add_subcommand("gi", "Indirect light of a frame that another program wrote as EXR");
    auto options = std::make_shared<GiOptions>();
    declareInputs(*command, *options);
    command
        ->add_option("--technique", options->technique,
                     "A technique (below); none: direct light only; truth: what --truth holds, for `lightwell compare` and `triptych`")
        ->required();
    command->add_option("--set", options->assignments, "key=value, one or several: parameters of the technique (below)");
    command->add_option("--frames", options->frames, "Frames of the same picture, for techniques that gather light over time; the last counts")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    command->add_option("--out", options->outs, "EXR or PNG; may be repeated");
    command->add_option("--exposure", options->exposure, "PNG: factor on radiance before Reinhard's L/(1+L); default: log-average luminance to 0.18");
    command->add_option("--device", options->device, "gpu, cpu, PLATFORM:DEVICE indices or part of a name; default: LIGHTWELL_DEVICE, else the best");
    command->add_option("--width", options->width, "Lanes per work-item: 1, 4, 8 or 16; default: by probe");
    command->add_flag("--no-check", options->noCheck, "Leave out the check of the inputs (a good part of a second for a million pixels)");
    command->add_flag("--json", options->asJson, "JSON on stdout (docs/cli.md)");
    command->footer([] { return describeRoles() + "\n" + describeParameters(); });
    command->callback([options] { runGi(*options); });
}

}  // namespace cli
