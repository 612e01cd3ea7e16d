#include "chart_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "film.h"
#include "layers.h"

namespace cli {
namespace {

// Bytes for each pixel: the path tracer's sums, a view's buffers and truths, pictures that are judged.
constexpr double kPixelBytes = 1500.0;

}  // namespace

std::vector<std::string> sceneNames() {
    std::vector<std::string> names;
    for (const studio::SceneEntry& entry : studio::listScenes()) names.push_back(entry.name);
    return names;
}

void requireScenes(const std::vector<std::string>& scenes) {
    const std::vector<std::string> known = sceneNames();
    std::map<std::string, std::string> byName;
    for (const std::string& scene : scenes) {
        const bool isName = std::find(known.begin(), known.end(), scene) != known.end();
        if (!isName && !std::filesystem::exists(scene))
            asUsage([&] { studio::loadScene(scene); });  // says what it expected
        const std::string name = isName ? scene : std::filesystem::path(scene).stem().string();
        const std::string& first = byName.emplace(name, scene).first->second;
        if (first != scene)
            throw UsageError(
                fmt::format("--scenes '{}': expected another name than that of '{}', by which results "
                            "are told apart",
                            scene, first));
    }
}

Size chartedSize(const std::string& text, const std::string& standard) {
    const std::string& chosen = text.empty() ? standard : text;
    const Size size = parseSize(chosen);
    requireMemory("--size", chosen, kPixelBytes * size.width * size.height);
    return size;
}

void setTruthLimits(TruthOptions& truth, const std::string& noise, double standardNoise,
                    const std::string& seconds) {
    truth.noise = noise.empty() ? standardNoise : parseNumber("--noise", noise);
    if (truth.noise <= 0.0) throw UsageError("--noise: expected a relMSE above 0");
    truth.seconds = parseNumber("--truth-seconds", seconds);
    if (truth.seconds < 0.0) throw UsageError("--truth-seconds: expected seconds, 0 or more");
}

std::string bouncesText(int bounces) {
    if (bounces == 0) return "all bounces";
    return bounces == 1 ? "one bounce" : fmt::format("{} bounces", bounces);
}

std::vector<std::size_t> stillCameras(const studio::Scene& scene, bool firstOnly) {
    std::vector<std::size_t> cameras;
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        const bool moves =
            std::any_of(scene.cameraTracks.begin(), scene.cameraTracks.end(),
                        [&](const auto& track) { return std::size_t(track.target) == i; });
        if (!moves && (cameras.empty() || !firstOnly)) cameras.push_back(i);
    }
    return cameras;
}

ChartView::ChartView(std::shared_ptr<studio::RayScene> scene, const studio::Camera& camera,
                     const InputOptions& options)
    : scene_(std::move(scene)), camera_(camera.name), inputs_(*scene_, camera, options) {}

std::string ChartView::hash() const {
    return fmt::format("{:016x}{:016x}", studio::hashScene(*scene_),
                       studio::hashView(inputs_.gbuffer()));
}

void ChartView::addLayers(studio::Image& image) const {
    addViewLayers(image, inputs_.gbuffer());
}

studio::Image ChartView::withLayers(const studio::PlanarBuffer& irradiance) const {
    studio::Image image(inputs_.gbuffer().width, inputs_.gbuffer().height);
    addLayer(image, "", irradiance);
    addLayers(image);
    return image;
}

// The one-bounce references beside the shipped scenes: 320x180, the first camera.
bool ChartView::loadShipped(JudgedTruth& judged) const {
    const std::filesystem::path scene(scene_->scene().path);
    const std::filesystem::path path = scene.parent_path() / "references" / (sceneName() + ".exr");
    if (judged.truth.bounces != 1 || scene.extension() != ".json" || !std::filesystem::exists(path))
        return false;
    const studio::Image shipped = studio::readImage(path.string());
    const auto metadata = [&](const char* key) {
        const auto found = shipped.metadata.find(key);
        return found == shipped.metadata.end() ? std::string() : found->second;
    };
    const bool fits = shipped.width == inputs_.gbuffer().width &&
                      shipped.height == inputs_.gbuffer().height && metadata("camera") == camera_ &&
                      metadata("layer") == "bounce1" && !metadata("noise.bounce1").empty();
    if (!fits) return false;
    judged.isShipped = true;
    judged.truth.name = path.filename().string();
    judged.truth.noise = std::stod(metadata("noise.bounce1"));
    judged.truth.samples = std::stoi(metadata("spp"));
    judged.truth.image = studio::Image(shipped.width, shipped.height);
    judged.truth.image.metadata = shipped.metadata;
    for (const char* channel : {"R", "G", "B"})
        judged.truth.image.plane(channel) = shipped.plane(channel);
    return true;
}

void ChartView::obtainTruths(const std::set<int>& bounces, const TruthOptions& options) {
    TruthRequest request;
    request.bounces.clear();
    for (const int count : bounces) {
        JudgedTruth shipped;
        shipped.truth.bounces = count;
        if (options.takesShipped && loadShipped(shipped))
            addTruth(std::move(shipped));
        else
            request.bounces.push_back(count);
    }
    if (request.bounces.empty()) return;
    request.noise = options.noise;
    request.seconds = options.seconds;
    request.takesKept = options.takesKept;
    request.directory = options.directory;
    request.progress = options.progress;
    for (Truth& truth : cli::obtainTruths(*scene_, inputs_.gbuffer(), request)) {
        JudgedTruth judged;
        judged.truth = std::move(truth);
        addTruth(std::move(judged));
    }
}

bool ChartView::isBlack() const {
    return std::all_of(truths_.begin(), truths_.end(),
                       [](const auto& truth) { return truth.second.isBlack; });
}

void ChartView::addTruth(JudgedTruth judged) {
    judged.isBlack = true;
    for (const char* channel : {"R", "G", "B"})
        for (const float value : judged.truth.image.plane(channel))
            judged.isBlack = judged.isBlack && value == 0.0f;
    addLayers(judged.truth.image);
    judged.exposure = studio::autoExposure(studio::composite(judged.truth.image));
    truths_[judged.truth.bounces] = std::move(judged);
}

}  // namespace cli
