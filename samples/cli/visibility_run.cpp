#include "visibility_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "build_identity.h"
#include "indirect_renderer.h"
#include "layers.h"
#include "metrics.h"
#include "open_device.h"
#include "progress.h"
#include "run_facts.h"
#include "sweep.h"
#include "vpl_view.h"

namespace cli {
namespace {

using Json = nlohmann::ordered_json;

// Every pixel its own surface and all VPLs, of the bounce that has visibility: of whichever of these a
// technique has.
constexpr std::pair<const char*, const char*> kFixed[] = {
    {"resolution", "full"}, {"interleave", "1"}, {"bounces", "1"}};
constexpr std::uint32_t kClusterChannels = 16;
constexpr double kPixelBytes = 1500.0;

DebugPlanes requirePlanes(const IndirectRenderer& renderer, const char* name, std::uint32_t channels) {
    DebugPlanes planes = renderer.readDebugView(name);
    if (planes.channels != channels)
        throw std::runtime_error(
            fmt::format("debug view {}: expected {} channels, got {}", name, channels, planes.channels));
    return planes;
}

glm::vec3 vectorOf(const DebugPlanes& planes, std::uint32_t first, std::size_t at) {
    return {planes.plane(first)[at], planes.plane(first + 1)[at], planes.plane(first + 2)[at]};
}

// Those that carry flux and belong to a cluster.
std::vector<studio::ClusteredVpl> readVpls(const IndirectRenderer& renderer) {
    const DebugPlanes planes = requirePlanes(renderer, kVplView, kVplChannels);
    const DebugPlanes clusters = requirePlanes(renderer, kVplClustersView, 1);
    if (clusters.width != planes.width)
        throw std::runtime_error(fmt::format("debug view {}: expected {} slots, got {}",
                                             kVplClustersView, planes.width, clusters.width));
    std::vector<studio::ClusteredVpl> vpls;
    for (std::size_t i = 0; i < planes.width; ++i) {
        const studio::VplRecord vpl{vectorOf(planes, 0, i), vectorOf(planes, 3, i),
                                    vectorOf(planes, 6, i), planes.plane(9)[i]};
        const float cluster = clusters.plane(0)[i];
        if (vpl.flux != glm::vec3(0.0f) && cluster >= 0.0f)
            vpls.push_back({vpl, int(std::lround(cluster))});
    }
    return vpls;
}

std::vector<studio::ClusterPlace> readClusters(const IndirectRenderer& renderer) {
    const DebugPlanes planes = requirePlanes(renderer, kClustersView, kClusterChannels);
    std::vector<studio::ClusterPlace> clusters;
    for (std::size_t k = 0; k < planes.width; ++k)
        clusters.push_back({vectorOf(planes, 10, k), vectorOf(planes, 13, k), vectorOf(planes, 0, k),
                            vectorOf(planes, 3, k)});
    return clusters;
}

// At the picked pixels, cluster after cluster.
std::vector<float> readSeen(const IndirectRenderer& renderer, const PixelPicks& picks, int height,
                            std::size_t clusters) {
    const DebugPlanes planes = requirePlanes(renderer, kVisibilityView, 1);
    if (planes.height != std::uint32_t(height) * clusters)
        throw std::runtime_error(fmt::format("debug view {}: expected {} rows, got {}", kVisibilityView,
                                             std::size_t(height) * clusters, planes.height));
    std::vector<float> seen;
    for (std::size_t k = 0; k < clusters; ++k)
        for (int y = 0; y < picks.height(); ++y)
            for (int x = 0; x < picks.width(); ++x)
                seen.push_back(
                    planes.plane(0)[k * std::size_t(height) * planes.width + picks.pixel(x, y)]);
    return seen;
}

Json misjudgedJson(const studio::Misjudged& m) {
    return {{"false_light", m.falseLight},
            {"false_shadow", m.falseShadow},
            {"false_light_weighted", m.falseLightWeight},
            {"false_shadow_weighted", m.falseShadowWeight}};
}

Json metricsJson(const studio::Metrics& metrics) {
    return {{"relMSE", metrics.relMse}, {"nrmse", metrics.nrmse}, {"bias", metrics.bias}};
}

// Errors relative to darkness have no meaning.
bool isBlack(const studio::Image& image) {
    for (const char* channel : {"R", "G", "B"})
        for (const float value : image.plane(channel))
            if (value != 0.0f) return false;
    return true;
}

Json pointJson(const Parameters& parameters, const studio::VisibilityVerdict& verdict, std::size_t vpls,
               std::size_t clusters, const studio::Image* truth, const studio::Image& layers) {
    Json point{{"settings", describeDifference(parameters)},
               {"parameters", parametersJson(parameters)},
               {"vpls", vpls},
               {"clusters", clusters},
               {"pairs", verdict.pairs},
               {"lit", verdict.lit},
               {"lit_weighted", verdict.litWeight}};
    Json misjudged, errors, against;
    studio::Image exact = verdict.irradiance[int(studio::Sight::exact)];
    for (const auto& [name, plane] : layers.channels) exact.channels[name] = plane;
    const bool isDark = isBlack(exact);
    for (std::size_t way = 0; way < studio::kSightCount; ++way) {
        const char* name = studio::kSightNames[way];
        if (way != std::size_t(studio::Sight::exact)) {
            misjudged[name] = misjudgedJson(verdict.against[way]);
            if (!isDark)
                against[name] = metricsJson(studio::compareIrradiance(verdict.irradiance[way], exact));
        }
        if (truth != nullptr)
            errors[name] = metricsJson(studio::compareIrradiance(verdict.irradiance[way], *truth));
    }
    misjudged["map_against_medoid"] = misjudgedJson(verdict.mapAgainstMedoid);
    point["misjudged"] = misjudged;
    point["error_against_exact_rays"] = against;
    if (truth != nullptr) point["error"] = errors;
    return point;
}

std::vector<std::string> valuesOf(const std::string& text) {
    std::vector<std::string> values;
    std::istringstream stream(text);
    for (std::string value; std::getline(stream, value, ',');) values.push_back(value);
    return values;
}

void requireFree(const char* option, const std::string& key) {
    for (const auto& [name, value] : kFixed)
        if (key == name)
            throw UsageError(
                fmt::format("{} '{}': expected another parameter; here it is {}, so that every pixel "
                            "has all VPLs of "
                            "one bounce",
                            option, key, value));
}

const JudgedTruth* traceTruth(ChartView& view, const VisibilityOptions& options) {
    TruthOptions truth = options.truth;
    studio::ProgressLine line("truth of " + view.id());
    truth.progress = [&](double fraction, double noise) {
        line.update(fraction, noise < 0.0 ? "" : fmt::format("noise (relMSE) {:.2e}", noise));
    };
    view.obtainTruths(options.skipsTruth ? std::set<int>{} : std::set<int>{1}, truth);
    line.finish();
    return options.skipsTruth || view.isBlack() ? nullptr : &view.truths().at(1);
}

}  // namespace

std::vector<Parameters> visibilityPoints(const VisibilityOptions& options) {
    Parameters first(options.technique);
    for (const std::string& assignment : options.assignments) {
        requireFree("--set", splitAssignment("--set", assignment).first);
        first.set(assignment);
    }
    for (const auto& [name, value] : kFixed)
        if (first.has(name)) first.set(fmt::format("{}={}", name, value));
    std::vector<Parameters> points{first};
    for (const std::string& sweep : options.sweeps) {
        const auto [key, values] = splitAssignment("--sweep", sweep);
        requireFree("--sweep", key);
        std::vector<Parameters> wider;
        for (const Parameters& point : points)
            for (const std::string& value : valuesOf(values)) {
                wider.push_back(point);
                wider.back().set(fmt::format("{}={}", key, value));
            }
        if (wider.empty())
            throw UsageError(fmt::format("--sweep '{}': expected KEY=VALUE,VALUE", sweep));
        points = std::move(wider);
    }
    return points;
}

VisibilityResult runVisibility(const VisibilityOptions& options, const std::vector<Parameters>& points) {
    const Size size = parseSize(options.view.size);
    requireMemory("--size", options.view.size, kPixelBytes * size.width * size.height);
    const auto scene = loadScene(options.view);
    const auto rayScene =
        asUsage([&] { return std::make_shared<studio::RayScene>(scene, float(options.view.time)); });
    InputOptions input;
    input.width = size.width;
    input.height = size.height;
    input.time = float(options.view.time);
    ChartView view(rayScene, findCamera(*scene, options.view), input);
    const auto device = openDevice(options.device, std::uint32_t(options.deviceWidth));
    const JudgedTruth* truth = traceTruth(view, options);
    const studio::GBuffer judged = view.picks().pick(view.inputs().gbuffer());
    studio::VisibilityJudge judge(*rayScene, judged);
    studio::Image layers(judged.width, judged.height);
    addViewLayers(layers, judged);

    VisibilityResult result;
    Json& json = result.json;
    json = {{"scene", view.sceneName()},           {"camera", view.cameraName()},
            {"size", {size.width, size.height}},   {"judged_block", view.picks().block()},
            {"device", deviceJson(device.info())}, {"build", buildIdentity()}};
    if (truth != nullptr)
        json["truth"] = {{"noise", truth->truth.noise}, {"samples", truth->truth.samples}};
    Json list = Json::array();
    studio::ProgressLine line("judging " + view.id());
    for (const Parameters& point : points) {
        line.update(double(list.size()) / double(points.size()), describeDifference(point));
        const auto renderer = makeRenderer(point, view.inputs(), &device);
        renderer->renderFrame(view.inputs(), true);
        const auto vpls = readVpls(*renderer);
        const auto clusters = readClusters(*renderer);
        result.last =
            judge.judge(vpls, clusters, readSeen(*renderer, view.picks(), size.height, clusters.size()));
        list.push_back(pointJson(point, result.last, vpls.size(), clusters.size(),
                                 truth != nullptr ? &truth->truth.image : nullptr, layers));
    }
    line.finish();
    json["points"] = list;
    return result;
}

}  // namespace cli
