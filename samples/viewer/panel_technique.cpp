// The panel of a technique: everything in it comes from lwDescribeTechnique.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <stdexcept>

#include "app.h"
#include "panel_parts.h"
#include "panels.h"

namespace viewer {
namespace {

std::vector<std::string> choicesOf(const LWParameter& parameter) {
    std::vector<std::string> names;
    for (const char* const* choice = parameter.choices; choice != nullptr && *choice != nullptr; ++choice) names.emplace_back(*choice);
    return names;
}

// std::invalid_argument where there is none of this name.
LWParameter parameterOf(const std::string& technique, const std::string& name) {
    const LWTechniqueInfo info = describeTechnique(technique);
    for (std::uint32_t i = 0; i < info.parameterCount; ++i)
        if (name == info.parameters[i].name) return info.parameters[i];
    throw std::invalid_argument(fmt::format("technique {} has no parameter {}", technique, name));
}

// PoCL's names are long.
std::string shortName(const std::string& name) {
    constexpr std::size_t kLongest = 32;
    return name.size() > kLongest ? name.substr(0, kLongest - 3) + "..." : name;
}

}  // namespace

void Panels::drawTechnique(App& app) {
    const LWDeviceInfo& device = app.indirect().deviceInfo();
    wrapped(kGrey, fmt::format("{}, width {}", shortName(device.name), device.width));
    Settings settings = app.settings();
    std::vector<std::string> names;
    for (std::uint32_t i = 0; i < lwCountTechniques(); ++i) {
        LWTechniqueInfo info{};
        info.structSize = sizeof info;
        if (lwDescribeTechnique(i, &info) == LW_SUCCESS) names.emplace_back(info.name);
    }
    if (pick("technique", settings.technique, names)) {
        settings.assignments.clear();
        app.choose(settings);
    }
    tip(describeTechnique(app.settings().technique).summary);
    drawPlanner(app);
    settings = app.settings();
    if (ImGui::CollapsingHeader("Parameters", ImGuiTreeNodeFlags_DefaultOpen)) {
        const bool isReset = !settings.assignments.empty() && ImGui::SmallButton("defaults");
        if (isReset) settings.assignments.clear();
        if (drawParameters(describeTechnique(settings.technique), "", settings) || isReset) app.choose(settings);
    }
    if (!app.message().empty()) wrapped(kBad, app.message());
    if (!app.notice().empty()) wrapped(kGrey, app.notice());
}

// On: technique "auto" in place of the one that was chosen, which comes back.
void Panels::drawPlanner(App& app) {
    Settings settings = app.settings();
    bool isOn = settings.technique == LW_TECHNIQUE_AUTO;
    if (ImGui::Checkbox("planner", &isOn)) {
        if (isOn) before_ = settings.technique;
        settings = Settings{isOn ? LW_TECHNIQUE_AUTO : before_, {}};
        app.choose(settings);
    }
    tip("Technique \"auto\": in each frame what the planner finds best within the budget");
    if (!isOn) return;
    ImGui::SameLine();
    const auto given = settings.assignments.find("budget_ms");
    const std::string text = given != settings.assignments.end() ? given->second : defaultText(parameterOf(settings.technique, "budget_ms"));
    float budget = held_.count("budget") != 0 ? held_["budget"] : std::strtof(text.c_str(), nullptr);
    if (ImGui::SliderFloat("ms", &budget, 0.0f, 200.0f, budget > 0.0f ? "budget %.1f" : "no budget")) held_["budget"] = budget;
    if (ImGui::IsItemDeactivatedAfterEdit()) {
        held_.erase("budget");
        settings.assignments["budget_ms"] = fmt::format("{}", budget);
        app.choose(settings);
    }
    for (const auto& [name, reason] : app.indirect().figures().choices)
        if (name == LW_TECHNIQUE_AUTO) wrapped(kWarm, reason);
}

bool Panels::drawParameters(const LWTechniqueInfo& info, const std::string& prefix, Settings& settings) {
    bool isChanged = false;
    for (std::uint32_t i = 0; i < info.parameterCount; ++i) {
        const LWParameter& parameter = info.parameters[i];
        const std::string key = prefix + parameter.name;
        ImGui::PushID(key.c_str());
        isChanged = drawParameter(parameter, key, settings) || isChanged;
        tip(parameter.description);
        if (parameter.kind == LW_PARAMETER_TECHNIQUE) {
            const auto chosen = settings.assignments.find(key);
            const std::string name = chosen != settings.assignments.end() ? chosen->second : defaultText(parameter);
            ImGui::Indent();
            if (ImGui::TreeNode("parameters of", "parameters of %s", name.c_str())) {
                isChanged = drawParameters(describeTechnique(name), key + ".", settings) || isChanged;
                ImGui::TreePop();
            }
            ImGui::Unindent();
        }
        ImGui::PopID();
    }
    return isChanged;
}

bool Panels::drawParameter(const LWParameter& parameter, const std::string& key, Settings& settings) {
    const auto given = settings.assignments.find(key);
    const std::string before = given != settings.assignments.end() ? given->second : defaultText(parameter);
    std::string text = before;
    if (parameter.kind == LW_PARAMETER_ENUM || parameter.kind == LW_PARAMETER_TECHNIQUE) {
        pick(parameter.name, text, choicesOf(parameter));
    } else if (parameter.kind == LW_PARAMETER_BOOL) {
        bool isOn = text == "on" || text == "true" || text == "1";
        if (ImGui::Checkbox(parameter.name, &isOn)) text = isOn ? "on" : "off";
    } else if (parameter.allowedCount > 0) {
        std::vector<std::string> names;
        for (std::uint32_t i = 0; i < parameter.allowedCount; ++i) names.push_back(fmt::format("{}", parameter.allowed[i]));
        pick(parameter.name, text, names);
    } else if (!drawNumber(parameter, key, text)) {
        return false;
    }
    if (text == before) return false;
    if (parameter.kind == LW_PARAMETER_TECHNIQUE)  // what was set of the technique before goes with it
        for (auto at = settings.assignments.begin(); at != settings.assignments.end();)
            at = at->first.rfind(key + ".", 0) == 0 ? settings.assignments.erase(at) : std::next(at);
    if (text == defaultText(parameter))
        settings.assignments.erase(key);
    else
        settings.assignments[key] = text;
    return true;
}

// A change counts when the slider is let go: it may mean other kernels.
bool Panels::drawNumber(const LWParameter& parameter, const std::string& key, std::string& text) {
    const bool isWhole = parameter.kind == LW_PARAMETER_UINT;
    const auto held = held_.find(key);
    float value = held != held_.end() ? held->second : std::strtof(text.c_str(), nullptr);
    const float low = float(parameter.minimum), high = float(parameter.maximum);
    const bool isWide = high > 1000.0f * std::max(1.0f, std::abs(low));
    const float speed = isWhole ? std::max(0.1f, 0.01f * std::abs(value)) : std::max(1e-4f, 0.005f * std::abs(value) + (isWide ? 0.0f : 0.0005f * (high - low)));
    const char* const format = isWhole ? "%.0f" : "%.4g";
    if (ImGui::DragFloat(parameter.name, &value, speed, low, high, format, ImGuiSliderFlags_AlwaysClamp))
        held_[key] = isWhole ? std::round(value) : value;
    if (!ImGui::IsItemDeactivatedAfterEdit()) return false;
    const auto last = held_.find(key);
    if (last == held_.end()) return false;
    text = isWhole ? fmt::format("{:.0f}", last->second) : fmt::format("{}", last->second);
    held_.erase(last);
    return true;
}

}  // namespace viewer
