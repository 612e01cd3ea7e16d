#include "chart_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

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
        if (!isName && !std::filesystem::exists(scene)) try {
                studio::loadScene(scene);  // says what it expected
            } catch (const std::runtime_error& error) {
                throw UsageError(fmt::format("--scenes '{}': {}", scene, error.what()));
            }
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

// A sixteenth of the paths, or sixteen times as many for each pixel.
constexpr int kBlock = 4;
// Picks along the shorter side of a picture: fewer would not tell its error.
constexpr int kFewestPicks = 32;

int judgedBlock(int asked, const Size& size, bool isQuick) {
    const int side = std::min(size.width, size.height);
    if (asked <= 0) return isQuick || side < kBlock * kFewestPicks ? 1 : kBlock;
    if (asked > 1 && side / asked < kFewestPicks)
        throw UsageError(fmt::format("--judge-one-of {}: expected at most {} at {}x{}", asked,
                                     std::max(1, side / kFewestPicks), size.width, size.height));
    return asked;
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
    const studio::GBuffer& gbuffer = inputs_.gbuffer();
    picks_.emplace(gbuffer.width, gbuffer.height, options.block);
    if (options.onScreen) traceOnScreen(options);
    std::vector<int> wanted;
    for (const int count : bounces) {
        JudgedTruth shipped;
        shipped.truth.bounces = count;
        if (options.takesShipped && picks_->areAll() && loadShipped(shipped))
            addTruth(std::move(shipped));
        else
            wanted.push_back(count);
    }
    if (wanted.empty()) return;
    std::vector<Truth> wholes;
    if (!picks_->areAll() && options.pictureNoise > 0.0)
        wholes = trace(gbuffer, wanted, options, options.pictureNoise);
    std::vector<Truth> judged = picks_->areAll()
                                    ? trace(gbuffer, wanted, options, options.noise)
                                    : trace(picks_->pick(gbuffer), wanted, options, options.noise);
    for (std::size_t i = 0; i < judged.size(); ++i) {
        JudgedTruth truth;
        truth.truth = std::move(judged[i]);
        if (!wholes.empty()) truth.whole = std::move(wholes[i]);
        addTruth(std::move(truth));
    }
}

std::vector<Truth> ChartView::trace(const studio::GBuffer& gbuffer, const std::vector<int>& bounces,
                                    const TruthOptions& options, double noise, bool onScreen) const {
    TruthRequest request;
    const studio::GBuffer& whole = inputs_.gbuffer();  // picks have other sides, hence another aspect
    if (onScreen) request.sendersSeenBy = {{whole.camera, whole.width, whole.height}};
    request.bounces = bounces;
    request.noise = noise;
    request.seconds = options.seconds;
    request.takesKept = options.takesKept;
    request.directory = options.directory;
    request.progress = options.progress;
    return cli::obtainTruths(*scene_, gbuffer, request);
}

bool ChartView::isBlack() const {
    return std::all_of(truths_.begin(), truths_.end(),
                       [](const auto& truth) { return truth.second.isBlack; });
}

// Its composite is not judged, so that the judged pixels are enough.
void ChartView::traceOnScreen(const TruthOptions& options) {
    const studio::GBuffer& gbuffer = inputs_.gbuffer();
    JudgedTruth judged;
    judged.truth = std::move(
        picks_->areAll() ? trace(gbuffer, {1}, options, options.noise, true).front()
                         : trace(picks_->pick(gbuffer), {1}, options, options.noise, true).front());
    complete(judged);
    onScreen_ = std::move(judged);
}

void ChartView::addTruth(JudgedTruth judged) {
    complete(judged);
    truths_[judged.truth.bounces] = std::move(judged);
}

void ChartView::complete(JudgedTruth& judged) const {
    judged.isBlack = true;
    for (const char* channel : {"R", "G", "B"})
        for (const float value : judged.picture().image.plane(channel))
            judged.isBlack = judged.isBlack && value == 0.0f;
    studio::Image layers(inputs_.gbuffer().width, inputs_.gbuffer().height);
    addLayers(layers);
    const auto addTo = [](studio::Image& image, studio::Image from) {
        for (auto& [name, plane] : from.channels) image.channels[name] = std::move(plane);
    };
    addTo(judged.truth.image, picks_->pick(layers));
    if (judged.whole) addTo(judged.whole->image, std::move(layers));
    judged.exposure = studio::autoExposure(studio::composite(judged.picture().image));
}

}  // namespace cli
