// `lightwell place-vpls`: static VPLs where a scene's lights reach, by rays (studio/vpl_placement.h).
#include "place_vpls.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli.h"
#include "gbuffer.h"
#include "image.h"
#include "interrupt.h"
#include "progress.h"
#include "vpl_picture.h"
#include "vpl_placement.h"

namespace cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMostPaths = 1 << 24, kMostPoints = 1 << 16, kMostDepth = 64;

struct PlaceOptions {
    ViewOptions view;
    studio::PlacementOptions placement;
    std::vector<std::string> from;
    std::string out, png, spacing, degrees = "45", reflectance = "0.2", offset = "0", seed = "1";
    bool appends = false, asJson = false;
};

glm::vec3 parsePoint(const std::string& text) {
    glm::vec3 point;
    std::size_t at = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t end = axis < 2 ? text.find(',', at) : text.size();
        if (end == std::string::npos)
            throw UsageError(fmt::format("--from '{}': expected a point X,Y,Z", text));
        point[axis] = float(parseNumber("--from", std::string_view(text).substr(at, end - at)));
        at = end + 1;
    }
    return point;
}

double parseWithin(std::string_view option, const std::string& text, double least, double below) {
    const double value = parseNumber(option, text);
    if (!(value >= least && value < below))
        throw UsageError(
            fmt::format("{} '{}': expected a number from {} to under {}", option, text, least, below));
    return value;
}

void readNumbers(PlaceOptions& options) {
    studio::PlacementOptions& placement = options.placement;
    if (!options.spacing.empty()) placement.spacing = double(parsePositive("--spacing", options.spacing));
    placement.degrees = parseWithin("--angle", options.degrees, 0.0, 90.0);
    placement.reflectance = parseWithin("--reflectance", options.reflectance, 0.0, 1e9);
    placement.offset = parseWithin("--offset", options.offset, 0.0, 1e9);
    placement.seed = parseUnsigned("--seed", options.seed);
    for (const std::string& text : options.from) placement.from.push_back(parsePoint(text));
}

// Where a lamp is, it is empty; a sun is nowhere, and the camera stands for whoever looks.
std::vector<glm::vec3> placesOfLights(const studio::RayScene& scene, const ViewOptions& view) {
    std::vector<glm::vec3> places;
    for (const studio::Light& light : scene.lights())
        if (light.kind != studio::LightKind::Sun) places.push_back(light.position);
    if (places.empty()) places.push_back(findCamera(scene.scene(), view).position);
    return places;
}

studio::StaticVpls earlierVpls(const PlaceOptions& options) {
    if (!options.appends) return {};
    if (!std::filesystem::exists(options.out))
        throw UsageError(
            fmt::format("--append: expected VPLs of an earlier run, there is no file {}", options.out));
    return asUsage([&] { return studio::readStaticVpls(options.out); });
}

Json triple(const glm::vec3& v) {
    return Json::array({v.x, v.y, v.z});
}

Json describe(const PlaceOptions& options, const std::string& scene, const studio::Placement& placement,
              double milliseconds) {
    const studio::PlacementOptions& asked = options.placement;
    const studio::PlacementReport& report = placement.report;
    Json json{{"scene", scene}, {"time", options.view.time}, {"seed", asked.seed}};
    json["from"] = Json::array();
    for (const glm::vec3& point : asked.from) json["from"].push_back(triple(point));
    json["points"] = report.points;
    json["paths"] = asked.paths;
    json["light_paths"] = asked.lightPaths;
    json["depth"] = asked.depth;
    json["hits"] = report.hits;
    json["spacing"] = report.spacing;
    json["places"] = report.places;
    json["lost_hits"] = report.lostHits;
    json["without_area"] = report.withoutArea;
    json["earlier"] = report.earlier;
    json["by_hand"] = report.byHand;
    json["vpls"] = placement.vpls.vpls.size();
    json["blockers"] = placement.vpls.blockers.size();
    json["area"] = report.area;
    json["ms"] = milliseconds;
    json["out"] = options.out;
    if (!options.png.empty()) json["png"] = options.png;
    return json;
}

void writePicture(const PlaceOptions& options, const studio::RayScene& scene,
                  const studio::StaticVpls& vpls) {
    const Size size = parseSize(options.view.size);
    const studio::Camera camera = findCamera(scene.scene(), options.view);
    const studio::GBuffer gbuffer =
        studio::renderGBuffer(scene, camera, size.width, size.height, camera, scene.time());
    studio::StaticVpls posed = studio::posedVpls(vpls, scene.scene(), scene.time());
    studio::fillWeights(posed);
    studio::writePng(options.png, drawVpls(gbuffer, posed));
}

studio::Placement placeWithProgress(const studio::RayScene& scene, studio::PlacementOptions options,
                                    const studio::StaticVpls& earlier) {
    const InterruptGuard guard;
    studio::ProgressLine line("placing VPLs in " + scene.scene().name);
    options.progress = [&](double fraction, const std::string& doing) {
        if (InterruptGuard::wasRaised()) throw Interrupted("interrupted: no VPLs were written");
        line.update(fraction, doing);
    };
    try {
        return studio::placeVpls(scene, options, earlier);
    } catch (const Interrupted&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {  // a walk that begins nowhere, an object that is not there
        throw UsageError(error.what());
    }
}

void placeVpls(PlaceOptions& options) {
    readNumbers(options);
    parseSize(options.view.size);
    requireOutputPath("--out", options.out, {".json"});
    if (!options.png.empty()) requireOutputPath("--png", options.png, {".png"});
    const studio::StaticVpls earlier = earlierVpls(options);
    const auto scene = loadScene(options.view);
    const auto rays = asUsage(
        [&] { return std::make_unique<studio::RayScene>(scene, float(options.view.time)); });
    if (options.placement.from.empty()) options.placement.from = placesOfLights(*rays, options.view);

    const auto start = std::chrono::steady_clock::now();
    const studio::Placement placement = placeWithProgress(*rays, options.placement, earlier);
    const double milliseconds =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    studio::writeStaticVpls(options.out, placement.vpls);
    if (!options.png.empty()) writePicture(options, *rays, placement.vpls);
    if (options.asJson) {
        fmt::print("{}\n", describe(options, scene->name, placement, milliseconds).dump(2));
        return;
    }
    const studio::PlacementReport& report = placement.report;
    fmt::print("{}: {} VPLs for {:.3g} m^2, of {} hits merged at {:.3g} m{}\n", options.out,
               placement.vpls.vpls.size(), report.area, report.hits, report.spacing,
               report.lostHits == 0 ? "" : fmt::format("; --cap left out places of {} hits", report.lostHits));
}

void declareSearch(CLI::App& command, PlaceOptions& options) {
    studio::PlacementOptions& placement = options.placement;
    command.add_option("--from", options.from,
                       "X,Y,Z, where a walk through free space begins; may be repeated; default: the "
                       "scene's spot and point lights, without any the camera")
        ->allow_extra_args(false);
    command.add_option("--points", placement.points, "Points of each walk, from which paths are traced")
        ->check(CLI::Range(1, kMostPoints))
        ->capture_default_str();
    command.add_option("--paths", placement.paths, "Paths from all points together")
        ->check(CLI::Range(1, kMostPaths))
        ->capture_default_str();
    command
        .add_option(
            "--light-paths", placement.lightPaths,
            "Paths from all lights together; 0: places do not lean towards where light falls now")
        ->check(CLI::Range(0, kMostPaths))
        ->capture_default_str();
    command.add_option("--depth", placement.depth, "Surfaces that a path meets at most")
        ->check(CLI::Range(1, kMostDepth))
        ->capture_default_str();
    command.add_option("--seed", options.seed, "Of the random numbers")->capture_default_str();
}

void declareMerging(CLI::App& command, PlaceOptions& options) {
    command.add_option("--cap", options.placement.cap, "VPLs at most")
        ->check(CLI::Range(1, int(studio::kMostStaticVpls)))
        ->capture_default_str();
    command.add_option("--spacing", options.spacing,
                       "Hits nearer than this (m) are merged; default: the least at which the cap holds");
    command.add_option("--angle", options.degrees, "Most degrees between the normals of what is merged")
        ->capture_default_str();
    command
        .add_option("--reflectance", options.reflectance,
                    "Most difference between the reflectances of what is merged, in any colour")
        ->capture_default_str();
    command.add_option("--offset", options.offset, "How far (m) VPLs are set back behind their surfaces")
        ->capture_default_str();
}

}  // namespace

void addPlaceVpls(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "place-vpls", "Static VPLs on the surfaces that a scene's lights reach, for technique static_vpl");
    auto options = std::make_shared<PlaceOptions>();
    options->view.size = "640x360";
    options->view.declare(*command);
    declareSearch(*command, *options);
    declareMerging(*command, *options);
    command->add_option("--out", options->out, "FILE.json to write (docs/vpls-file.md)")->required();
    command->add_flag("--append", options->appends,
                      "Go on from the VPLs that stand in --out; those set by hand stay as they are");
    command->add_option("--png", options->png,
                        "FILE.png: the view with each VPL as a disc in its reflectance");
    command->add_flag("--json", options->asJson, "JSON on stdout: what was found, merged and left out");
    command->callback([options] { placeVpls(*options); });
}

}  // namespace cli
