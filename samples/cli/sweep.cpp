#include "sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "cli.h"

namespace cli {
namespace {

using Assignments = std::vector<std::string>;

const LWTechniqueInfo& infoOf(const std::string& technique) {
    static const std::vector<LWTechniqueInfo> infos = describeTechniques();
    for (const LWTechniqueInfo& info : infos)
        if (technique == info.name) return info;
    throw UsageError("unknown technique '" + technique + "'; valid: " + joinNames(techniqueNames()));
}

// "resolution=half", the `index`th value of a parameter's sweep.
std::string sweepAssignment(const LWParameter& parameter, std::uint32_t index) {
    const double value = parameter.sweep[index];
    std::string text = fmt::format("{}", value);
    if (parameter.kind == LW_PARAMETER_UINT) text = fmt::format("{:.0f}", value);  // no exponent
    if (parameter.kind == LW_PARAMETER_ENUM || parameter.kind == LW_PARAMETER_TECHNIQUE)
        text = parameter.choices[std::size_t(value)];
    if (parameter.kind == LW_PARAMETER_BOOL) text = value != 0.0 ? "on" : "off";
    return fmt::format("{}={}", parameter.name, text);
}

std::vector<Assignments> fullGrid(const LWTechniqueInfo& info) {
    std::vector<Assignments> grid{{}};
    for (std::uint32_t p = 0; p < info.parameterCount; ++p) {
        const LWParameter& parameter = info.parameters[p];
        if (parameter.sweepCount == 0) continue;
        std::vector<Assignments> wider;
        for (const Assignments& point : grid)
            for (std::uint32_t i = 0; i < parameter.sweepCount; ++i) {
                wider.push_back(point);
                wider.back().push_back(sweepAssignment(parameter, i));
            }
        grid = std::move(wider);
    }
    return grid;
}

std::vector<Assignments> oneByOne(const LWTechniqueInfo& info) {
    std::vector<Assignments> grid;
    for (std::uint32_t p = 0; p < info.parameterCount; ++p)
        for (std::uint32_t i = 0; i < info.parameters[p].sweepCount; ++i)
            grid.push_back({sweepAssignment(info.parameters[p], i)});
    return grid;
}

Parameters assigned(const std::string& technique, const Assignments& assignments) {
    Parameters parameters(technique);
    for (const std::string& assignment : assignments) parameters.set(assignment);
    return parameters;
}

// Adds a point unless its twin is there; a label goes to the twin.
void addPoint(std::vector<SweepPoint>& points, Parameters parameters, const std::string& label) {
    const auto resolved = parameters.resolved();
    const auto twin = std::find_if(points.begin(), points.end(), [&](const SweepPoint& point) {
        return point.parameters.resolved() == resolved;
    });
    if (twin == points.end()) {
        points.push_back({std::move(parameters), label});
    } else if (!label.empty()) {
        twin->label += (twin->label.empty() ? "" : ", ") + label;
    }
}

Assignments splitWords(const char* text) {
    std::istringstream stream(text);
    Assignments words;
    for (std::string word; stream >> word;) words.push_back(word);
    return words;
}

// Whether a value is the name of a technique that is not the usual one in its place.
bool isOther(const Parameters& parameters, const std::pair<std::string, ParameterValue>& value,
             const std::vector<std::pair<std::string, ParameterValue>>& usual) {
    return parameters.parts().count(value.first) != 0 && std::find(usual.begin(), usual.end(), value) == usual.end();
}

}  // namespace

std::string valueText(const ParameterValue& value) {
    if (const bool* isOn = std::get_if<bool>(&value)) return *isOn ? "on" : "off";
    // A descriptor's number is a float: 0.1, not the double nearest to it.
    if (const double* number = std::get_if<double>(&value)) return fmt::format("{}", float(*number));
    return std::visit([](const auto& held) { return fmt::format("{}", held); }, value);
}

std::vector<SweepPoint> sweepOf(const std::string& technique, bool quick) {
    const LWTechniqueInfo& info = infoOf(technique);
    std::vector<SweepPoint> points;
    for (const Assignments& assignments : quick ? oneByOne(info) : fullGrid(info))
        addPoint(points, assigned(technique, assignments), "");
    addPoint(points, Parameters(technique), "default");
    for (std::uint32_t i = 0; i < info.settingCount; ++i)
        addPoint(points, assigned(technique, splitWords(info.settings[i].assignments)),
                 info.settings[i].name);
    return points;
}

SweepPoint pointOf(const std::string& variant) {
    SweepPoint point{parseVariant(variant), ""};
    const std::string& technique = point.parameters.technique();
    const LWTechniqueInfo& info = infoOf(technique);
    std::vector<SweepPoint> named;
    addPoint(named, Parameters(technique), "default");
    for (std::uint32_t i = 0; i < info.settingCount; ++i)
        addPoint(named, assigned(technique, splitWords(info.settings[i].assignments)),
                 info.settings[i].name);
    for (const SweepPoint& twin : named)
        if (twin.parameters.resolved() == point.parameters.resolved()) point.label = twin.label;
    return point;
}

int modelledBounces(const Parameters& parameters) {
    for (const auto& [name, value] : parameters.resolved())
        if (const auto* count = std::get_if<std::uint64_t>(&value);
            name == "bounces" && count != nullptr)
            return *count > 2 ? 0 : int(*count);
    if (parameters.parts().empty()) return int(infoOf(parameters.technique()).bounces);
    // Of techniques joined: the most that one of them models. 0, all of them, is the most of all.
    int most = 1;
    for (const auto& [name, part] : parameters.parts()) {
        const int bounces = modelledBounces(part);
        most = bounces == 0 || most == 0 ? 0 : std::max(most, bounces);
    }
    return most;
}

bool knowsPictureOnly(const Parameters& parameters) {
    const std::string& technique = parameters.technique();
    if (parameters.parts().empty())
        return technique == "screen_space" || technique == "horizon" || technique == "ao";
    return std::all_of(parameters.parts().begin(), parameters.parts().end(),
                       [](const auto& part) { return knowsPictureOnly(part.second); });
}

std::string describeDifference(const Parameters& parameters) {
    // Values that only the command line knows (a file of VPLs) have no default to stand beside.
    const auto defaults = parameters.defaults().resolved();
    const auto usual = Parameters(parameters.technique()).resolved();
    std::string text;
    for (const auto& value : parameters.resolved())
        if (std::find(defaults.begin(), defaults.end(), value) == defaults.end() ||
            isOther(parameters, value, usual))
            text +=
                fmt::format("{}{}={}", text.empty() ? "" : " ", value.first, valueText(value.second));
    return text.empty() ? "defaults" : text;
}

}  // namespace cli
