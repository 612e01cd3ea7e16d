#include "stability_judge.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace cli {
namespace {

using Json = nlohmann::ordered_json;

Json number(const std::optional<double>& value) {
    return value && std::isfinite(*value) ? Json(*value) : Json();
}

template <class Indices>
Json indicesJson(const Indices& indices) {
    return {{"error", indices.error},         {"flicker", number(indices.flicker)},
            {"ghost", number(indices.ghost)}, {"leak", number(indices.leak)},
            {"drift", number(indices.drift)}, {"spike", number(indices.spike)}};
}

// Over the frames that have errors.
struct ErrorMeans {
    FrameErrors sum;
    double sizeOfBias = 0.0;
    int count = 0;
    void add(const std::optional<FrameErrors>& errors, double factor) {
        if (!errors) return;
        sum.relMse += factor * errors->relMse;
        sum.nrmse += factor * errors->nrmse;
        sum.bias += factor * errors->bias;
        sizeOfBias += factor * std::abs(errors->bias);
        ++count;
    }
    Json of(double figure) const { return count > 0 ? Json(figure / count) : Json(); }
};

}  // namespace

std::optional<FrameErrors> frameErrors(const studio::StabilityFrame& frame) {
    constexpr double kDark = 0.01;  // of the squared mean: keeps dark pixels from deciding alone
    const std::size_t count = std::size_t(frame.width) * std::size_t(frame.height);
    const auto eachValue = [&](const auto& body) {
        for (std::size_t i = 0; i < 3 * count; ++i)
            if (frame.surface[i % count] != 0) body(double(frame.image[i]), double(frame.truth[i]));
    };
    double values = 0.0, sum = 0.0;
    eachValue([&](double, double truth) {
        values += 1.0;
        sum += truth;
    });
    if (values == 0.0 || sum == 0.0) return std::nullopt;
    const double mean = sum / values;
    FrameErrors errors;
    eachValue([&](double image, double truth) {
        const double squared = (image - truth) * (image - truth);
        errors.relMse += squared / (truth * truth + kDark * mean * mean) / values;
        errors.nrmse += squared / values;
        errors.bias += (image - truth) / values;
    });
    errors.nrmse = std::sqrt(errors.nrmse) / mean;
    errors.bias /= mean;
    return errors;
}

Verdict judgeSequence(const std::vector<JudgedFrame>& frames) {
    std::vector<studio::StabilityFrame> ours, noise;
    for (const JudgedFrame& judged : frames) {
        ours.push_back(judged.frame);
        ours.back().truth = judged.truth->mean;
        noise.push_back(judged.frame);
        noise.back().image = judged.truth->first;
        noise.back().truth = judged.truth->second;
    }
    Verdict verdict;
    verdict.indices = studio::stabilityIndices(ours);
    verdict.floors = studio::stabilityIndices(noise);
    for (const studio::StabilityFrame& frame : ours) verdict.errors.push_back(frameErrors(frame));
    for (const studio::StabilityFrame& frame : noise) verdict.noise.push_back(frameErrors(frame));
    return verdict;
}

Json Verdict::toJson(const std::vector<JudgedFrame>& frames) const {
    ErrorMeans means, noiseMeans;
    double truthNoise = 0.0;
    std::size_t notFinite = 0;
    float largest = 0.0f;
    Json perFrame = Json::array();
    for (std::size_t f = 0; f < frames.size(); ++f) {
        const JudgedFrame& judged = frames[f];
        means.add(errors[f], 1.0);
        noiseMeans.add(noise[f], 0.5);  // the references differ by twice the error of their mean
        if (errors[f]) truthNoise += judged.truth->noise;
        notFinite += judged.notFinite;
        largest = std::max(largest, judged.largest);
        Json json = indicesJson(indices.frames[f]);
        json["floors"] = indicesJson(floors.frames[f]);
        json["relMSE"] = errors[f] ? Json(errors[f]->relMse) : Json();
        json["nrmse"] = errors[f] ? Json(errors[f]->nrmse) : Json();
        json["bias"] = errors[f] ? Json(errors[f]->bias) : Json();
        json["noise"] = judged.truth->noise;
        json["ms"] = judged.milliseconds;
        perFrame.push_back(json);
    }
    Json json;
    json["indices"] = indicesJson(indices);
    json["floors"] = indicesJson(floors);
    json["errors"] = {{"relMSE", means.of(means.sum.relMse)},
                      {"nrmse", means.of(means.sum.nrmse)},
                      {"bias", means.of(means.sum.bias)}};
    json["error_floors"] = {{"relMSE", means.of(truthNoise)},
                            {"nrmse", noiseMeans.of(noiseMeans.sum.nrmse)},
                            {"bias", noiseMeans.of(noiseMeans.sizeOfBias)}};
    json["not_finite"] = notFinite;
    json["largest"] = largest;
    json["worst_frame"] = indices.worstFrame;
    json["worst_reason"] = studio::stabilityReasonName(indices.worstReason);
    json["frames"] = perFrame;
    return json;
}

}  // namespace cli
