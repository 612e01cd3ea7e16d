#include "chart_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "film.h"
#include "layers.h"

namespace cli {

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
    const studio::GBuffer& gbuffer = inputs_.gbuffer();
    picks_.emplace(gbuffer.width, gbuffer.height, options.block);
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
                                    const TruthOptions& options, double noise) const {
    TruthRequest request;
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

void ChartView::addTruth(JudgedTruth judged) {
    judged.isBlack = true;
    for (const char* channel : {"R", "G", "B"})
        for (const float value : judged.picture().image.plane(channel))
            judged.isBlack = judged.isBlack && value == 0.0f;
    studio::Image layers(inputs_.gbuffer().width, inputs_.gbuffer().height);
    addLayers(layers);
    const auto complete = [](studio::Image& image, studio::Image from) {
        for (auto& [name, plane] : from.channels) image.channels[name] = std::move(plane);
    };
    complete(judged.truth.image, picks_->pick(layers));
    if (judged.whole) complete(judged.whole->image, std::move(layers));
    judged.exposure = studio::autoExposure(studio::composite(judged.picture().image));
    truths_[judged.truth.bounces] = std::move(judged);
}

}  // namespace cli
