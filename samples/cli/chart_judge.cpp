#include "chart_judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "metrics.h"

namespace cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kPreviewWidth = 640;  // pixels at most: a report holds dozens
constexpr int kPreviewQuality = 85;

// Mean over blocks of n x n pixels, so that the picture is at most kPreviewWidth wide.
studio::Image shrink(const studio::Image& image) {
    const int n = (image.width + kPreviewWidth - 1) / kPreviewWidth;
    if (n <= 1) return image;
    studio::Image small(std::max(1, image.width / n), std::max(1, image.height / n));
    for (const char* channel : {"R", "G", "B"}) {
        const std::vector<float>& from = image.plane(channel);
        std::vector<float>& to = small.plane(channel);
        for (int y = 0; y < small.height; ++y)
            for (int x = 0; x < small.width; ++x) {
                float sum = 0.0f;
                for (int dy = 0; dy < n; ++dy)
                    for (int dx = 0; dx < n; ++dx)
                        sum += from[std::size_t(std::min(y * n + dy, image.height - 1)) *
                                        std::size_t(image.width) +
                                    std::size_t(std::min(x * n + dx, image.width - 1))];
                to[std::size_t(y) * std::size_t(small.width) + std::size_t(x)] =
                    std::min(1.0f, sum / float(n * n));
            }
    }
    return small;
}

// Returns the name below the results' folder.
std::string writePreview(const std::string& folder, std::string name, const studio::Image& display) {
    std::replace(name.begin(), name.end(), '/', '_');  // in ids, and in some cameras' names
    const std::string file = "images/" + name + ".jpg";
    studio::writeJpeg((std::filesystem::path(folder) / file).string(), shrink(display), kPreviewQuality);
    return file;
}

studio::Image lit(const studio::Image& irradiance, const studio::Image& truth) {
    studio::Image image(truth.width, truth.height);
    for (const char* channel : {"R", "G", "B"}) {
        image.plane(channel) = irradiance.plane(channel);
        for (const std::string layer : {"direct.", "albedo."})
            image.plane(layer + channel) = truth.plane(layer + channel);
    }
    return studio::composite(image);
}

// JSON has no NaN.
Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json();
}

Json irradianceErrors(const studio::Metrics& metrics, const JudgedTruth& judged) {
    Json json;
    json["bounces"] = judged.truth.bounces;
    json["relMSE"] = number(metrics.relMse);
    json["nrmse"] = number(metrics.nrmse);
    json["bias"] = number(metrics.bias);
    json["p99"] = number(metrics.p99);
    json["noise"] = number(judged.truth.noise);
    json["trusted"] = judged.truth.noise <= kNoiseShare * metrics.relMse;
    return json;
}

// The errors of the irradiance at the pixels where the view is judged.
Json irradianceErrors(const JudgedPicture& picture, const ChartView& view, const JudgedTruth& judged) {
    return irradianceErrors(
        studio::compareIrradiance(view.picks().pick(picture.irradiance), judged.truth.image), judged);
}

// Where the truth holds every pixel: score and FLIP as well, and previews.
void judgePicture(const JudgedPicture& picture, const ChartView& view, const std::string& folder, Json& json) {
    const JudgedTruth& own = view.truths().at(picture.bounces);
    const studio::Image display =
        studio::toneMap(lit(picture.irradiance, own.picture().image), own.exposure);
    json["images"]["picture"] = writePreview(folder, picture.imageName, display);
    if (!own.isBlack) {
        studio::MetricMaps maps;
        const studio::Metrics metrics =
            studio::compareImages(picture.irradiance, own.picture().image, &maps);
        Json errors = view.picks().areAll() ? irradianceErrors(metrics, own)
                                            : irradianceErrors(picture, view, own);
        errors["picture_noise"] = number(own.picture().noise);
        errors["picture_trusted"] = errors["relMSE"].is_number() &&
                                    own.picture().noise <= kNoiseShare * errors["relMSE"].get<double>();
        errors["rmse"] = number(metrics.rmse);
        errors["ssim"] = number(metrics.ssim);
        errors["score"] = number(metrics.score);
        errors["score255"] = number(metrics.score255);
        errors["flip"] = number(metrics.flip);
        json["own"] = errors;
        json["images"]["error"] = writePreview(folder, picture.imageName + "_error", maps.relativeError);
    }
}

}  // namespace

Json judge(const JudgedPicture& picture, const ChartView& view, const std::string& folder) {
    const JudgedTruth& own = view.truths().at(picture.bounces);
    Json json{{"own", nullptr}, {"all", nullptr}, {"screen", nullptr}, {"images", Json::object()}};
    if (view.picks().areAll() || own.whole)
        judgePicture(picture, view, folder, json);
    else if (!own.isBlack)
        json["own"] = irradianceErrors(picture, view, own);
    if (const auto all = view.truths().find(0); all != view.truths().end() && !all->second.isBlack)
        json["all"] = irradianceErrors(picture, view, all->second);
    const JudgedTruth* onScreen = view.onScreen();
    if (onScreen != nullptr && !onScreen->isBlack && picture.knowsPictureOnly)
        json["screen"] = irradianceErrors(picture, view, *onScreen);
    return json;
}

Json writeViewPictures(const ChartView& view, const std::string& folder) {
    Json json;
    const std::string stem = view.sceneName() + "_" + view.cameraName();
    for (const auto& [bounces, judged] : view.truths()) {
        const std::string key = bounces == 0 ? "all" : std::to_string(bounces);
        const studio::Image& truth = judged.picture().image;
        json["truth_" + key] = writePreview(folder, stem + "_truth_" + key,
                                            studio::toneMap(studio::composite(truth), judged.exposure));
        if (json.contains("direct")) continue;
        studio::Image dark(truth.width, truth.height);
        for (const char* channel : {"R", "G", "B"}) dark.plane(channel);
        json["direct"] =
            writePreview(folder, stem + "_direct", studio::toneMap(lit(dark, truth), judged.exposure));
    }
    return json;
}

}  // namespace cli
