#include "chart_truths.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "chart_judge.h"
#include "sweep.h"

namespace cli {

using Json = nlohmann::ordered_json;

Json describeView(const ChartView& view, const std::string& folder) {
    Json truths = Json::array();
    for (const auto& [bounces, judged] : view.truths())
        truths.push_back({{"bounces", bounces},
                          {"noise", judged.truth.noise},
                          {"samples", judged.truth.samples},
                          {"name", judged.truth.name},
                          {"picture_noise", judged.picture().noise},
                          {"picture_samples", judged.picture().samples},
                          {"shipped", judged.isShipped}});
    Json onScreen;
    if (view.onScreen() != nullptr)
        onScreen = {{"noise", view.onScreen()->truth.noise},
                    {"samples", view.onScreen()->truth.samples},
                    {"name", view.onScreen()->truth.name}};
    return {{"id", view.id()},
            {"scene", view.sceneName()},
            {"camera", view.cameraName()},
            {"size", {view.inputs().gbuffer().width, view.inputs().gbuffer().height}},
            {"rsm_texels", view.inputs().rsmTexelCount()},
            {"truths", truths},
            {"on_screen", onScreen},
            {"images", writeViewPictures(view, folder)}};
}

std::string truthNote(const ChartView& view) {
    std::string note;
    for (const auto& [count, judged] : view.truths())
        note += fmt::format("{}{}: {} samples per pixel, noise {:.2e}", note.empty() ? "" : "; ",
                            bouncesText(count), judged.truth.samples, judged.truth.noise);
    if (view.onScreen() != nullptr)
        note += fmt::format("; one bounce of what the view shows: {} samples per pixel, noise {:.2e}",
                            view.onScreen()->truth.samples, view.onScreen()->truth.noise);
    return note;
}

std::string truthNames(const ChartView& view, const Parameters& parameters) {
    std::string text;
    for (const int bounces : {modelledBounces(parameters), 0})
        if (const auto truth = view.truths().find(bounces); truth != view.truths().end())
            text += fmt::format(" {} {} {}", truth->second.truth.name, truth->second.truth.samples,
                                truth->second.picture().samples);
    if (view.onScreen() != nullptr && knowsPictureOnly(parameters))
        text += fmt::format(" {} {}", view.onScreen()->truth.name, view.onScreen()->truth.samples);
    return text;
}

}  // namespace cli
