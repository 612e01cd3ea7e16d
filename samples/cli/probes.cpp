// `lightwell probes`: a box of light probes over a scene, as two bands of spherical harmonics each.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli.h"
#include "image.h"
#include "layers.h"
#include "open_device.h"
#include "probe_grid.h"

namespace cli {
namespace {

using Json = nlohmann::ordered_json;

struct ProbeOptions {
    ViewOptions view;
    std::string technique = "lpv", grid = "8x4x8", out, png, device, sphere = "0.15";
    std::vector<std::string> assignments;
    int frames = 1, width = 0, rsmSize = 512;
    bool asJson = false, asSurfaces = false;
};

glm::ivec3 parseGrid(const std::string& text) {
    glm::ivec3 counts;
    std::size_t at = 0;
    for (int a = 0; a < 3; ++a) {
        const std::size_t end = a < 2 ? text.find('x', at) : text.size();
        if (end == std::string::npos)
            throw UsageError(fmt::format(
                "--grid '{}': expected a number of probes along x, y and z, as 8x4x8", text));
        const std::uint64_t count = parseUnsigned("--grid", text.substr(at, end - at));
        if (count < 1 || count > 1024)
            throw UsageError(fmt::format("--grid '{}': expected 1 .. 1024 probes along an axis", text));
        counts[a] = int(count);
        at = end + 1;
    }
    constexpr std::int64_t kMost = 4194240;  // of lwRenderPoints
    if (std::int64_t(counts.x) * counts.y * counts.z > kMost)
        throw UsageError(fmt::format("--grid '{}': expected at most {} probes", text, kMost));
    return counts;
}

Json triple(const glm::vec3& v) {
    return Json::array({v.x, v.y, v.z});
}

Json describe(const ProbeOptions& options, const Parameters& parameters, const ProbeGrid& grid,
              const ProbeTimes& times, const LWDeviceInfo& device) {
    Json json;
    json["device"] = device.name;
    json["scene"] = options.view.scene;
    json["technique"] = options.technique;
    for (const auto& [name, value] : parameters.resolved())
        std::visit([&, key = name](const auto& held) { json["parameters"][key] = held; }, value);
    json["low"] = triple(grid.low);
    json["high"] = triple(grid.high);
    json["grid"] = {grid.counts.x, grid.counts.y, grid.counts.z};
    json["frames"] = options.frames;
    json["points_ms"] = times.pointsMilliseconds;
    json["update_ms"] = times.updateMilliseconds;
    json["bytes"] = times.deviceBytes;
    for (const auto& [name, value] : times.counts) json["counts"][name] = value;
    return json;
}

void writeProbes(const std::string& path, Json json, const ProbeGrid& grid) {
    json["probes"] = Json::array();
    for (const Probe& probe : grid.probes) {
        Json entry{{"position", triple(probe.position)}, {"validity", probe.validity}};
        const char* const names[] = {"c0", "c1x", "c1y", "c1z"};
        for (std::size_t b = 0; b < probe.bands.size(); ++b) entry[names[b]] = triple(probe.bands[b]);
        json["probes"].push_back(std::move(entry));
    }
    std::ofstream file(path);
    file << json.dump(1) << "\n";
    if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

void writePicture(const ProbeOptions& options, const ProbeGrid& grid, const RenderInputs& inputs,
                  const studio::PlanarBuffer& irradiance) {
    studio::Image layers(inputs.gbuffer().width, inputs.gbuffer().height);
    addViewLayers(layers, inputs.gbuffer());
    addLayer(layers, "", irradiance);
    studio::Image picture = studio::composite(layers);
    const float exposure = studio::autoExposure(picture);
    drawProbes(grid, inputs.gbuffer(), 2.0f * parsePositive("--sphere", options.sphere) * grid.spacing(),
               picture);
    studio::writePng(options.png, studio::toneMap(picture, exposure));
}

void probes(const ProbeOptions& options) {
    requireOneOf("technique", options.technique, techniqueNames());
    Parameters parameters(options.technique);
    for (const std::string& assignment : options.assignments) parameters.set(assignment);
    if (!parameters.needsDevice())
        throw UsageError(
            fmt::format("technique '{}' is not of the library: it has no points", options.technique));
    if (options.width != 0)
        requireOneOf("--width", std::to_string(options.width), {"1", "4", "8", "16"});
    const glm::ivec3 counts = parseGrid(options.grid);
    if (!options.out.empty()) requireOutputPath("--out", options.out, {".json"});
    if (!options.png.empty()) requireOutputPath("--png", options.png, {".png"});
    parsePositive("--sphere", options.sphere);
    if (options.out.empty() && options.png.empty() && !options.asJson)
        throw UsageError("--out, --png or --json is required");
    if (options.asSurfaces && !(options.out.empty() && options.png.empty()))
        throw UsageError("--surfaces: expected neither --out nor --png with it, which are of both bands");
    const Size size = parseSize(options.view.size);
    const auto scene = loadScene(options.view);
    const studio::Camera camera = findCamera(*scene, options.view);
    const studio::RayScene rays(scene, float(options.view.time));
    InputOptions inputOptions;
    inputOptions.width = size.width;
    inputOptions.height = size.height;
    inputOptions.time = float(options.view.time);
    inputOptions.rsm.size = options.rsmSize;
    const RenderInputs inputs(rays, camera, inputOptions);
    const lightwell::Device device = openDevice(options.device, std::uint32_t(options.width));
    ProbeGrid grid = makeProbes(*scene, counts);
    studio::PlanarBuffer irradiance;
    ProbeTimes times;
    try {
        times = lightProbes(device, parameters, inputs, options.frames, options.asSurfaces, grid,
                            options.png.empty() ? nullptr : &irradiance);
    } catch (const lightwell::Error& error) {
        if (error.status() == LW_ERROR_UNSUPPORTED)
            throw UsageError(fmt::format("--technique '{}': {}", options.technique, error.what()));
        throw;
    }
    const Json json = describe(options, parameters, grid, times, device.info());
    if (!options.out.empty()) writeProbes(options.out, json, grid);
    if (!options.png.empty()) writePicture(options, grid, inputs, irradiance);
    if (options.asJson)
        fmt::print("{}\n", json.dump(2));
    else
        fmt::print("{} probes: {:.3f} ms, median of {} frames\n", grid.probes.size(),
                   times.pointsMilliseconds, options.frames);
}

}  // namespace

void addProbes(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "probes", "Indirect light at a box of points over a scene, with a technique that has any");
    auto options = std::make_shared<ProbeOptions>();
    options->view.declare(*command);
    command->add_option("--technique", options->technique, "With LWTechniqueInfo::points")
        ->capture_default_str();
    command
        ->add_option("--set", options->assignments,
                     "key=value, one or several: parameters of the technique")
        ->allow_extra_args(false);
    command
        ->add_option("--grid", options->grid,
                     "Probes along x, y and z, in the middles of the box's parts")
        ->capture_default_str();
    command->add_option(
        "--out", options->out,
        "FILE.json: position, validity, c0, c1x, c1y, c1z (r, g, b each) of every probe");
    command->add_option("--png", options->png,
                        "FILE.png: the view with each probe as a white sphere in its light");
    command
        ->add_option("--sphere", options->sphere,
                     "Radius of these, as a share of the probes' least distance")
        ->capture_default_str();
    command->add_flag("--surfaces", options->asSurfaces,
                      "Irradiance of normals that point up instead of both bands, for times");
    command->add_option("--frames", options->frames, "Frames; times are medians")
        ->check(CLI::Range(1, 10000))
        ->capture_default_str();
    command->add_option("--rsm-size", options->rsmSize, "Texels along each side of an RSM")
        ->check(CLI::Range(1, kMaxSize))
        ->capture_default_str();
    command->add_option("--device", options->device, "As for render");
    command->add_option("--width", options->width,
                        "Lanes per work-item: 1, 4, 8 or 16; default: by probe");
    command->add_flag("--json", options->asJson,
                      "JSON on stdout: parameters, points_ms, update_ms, bytes, counts");
    command->callback([options] { probes(*options); });
}

}  // namespace cli
