#include "render_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace cli {
namespace {

using Json = nlohmann::ordered_json;
constexpr double kMegabyte = 1e6;

// -1 stands for "unavailable" (a queue without profiling): null in JSON.
Json milliseconds(double value) {
    return value < 0.0 ? Json() : Json(value);
}

template <class T>
Json toObject(const std::vector<std::pair<std::string, T>>& pairs) {
    Json object = Json::object();
    for (const auto& [name, value] : pairs) object[name] = value;
    return object;
}

Json parametersJson(const RenderReport& report) {
    Json object = Json::object();
    for (const auto& [name, value] : report.parameters)
        std::visit([&, key = name](const auto& held) { object[key] = held; }, value);
    return object;
}

// Of each measured frame, in order: times, and what technique auto ran.
void addFrames(Json& json, const FrameFigures& figures) {
    Json totals = Json::array(), techniques = Json::array();
    for (const double total : figures.frameTotals) totals.push_back(milliseconds(total));
    json["frame_ms"] = totals;
    const auto isNone = [](const std::string& technique) { return technique.empty(); };
    if (std::all_of(figures.frameTechniques.begin(), figures.frameTechniques.end(), isNone)) return;
    for (const std::string& technique : figures.frameTechniques) techniques.push_back(technique);
    json["frame_techniques"] = techniques;
}

Json passesJson(const FrameFigures& figures) {
    Json passes = Json::array();
    for (const PassTime& pass : figures.passes)
        passes.push_back(
            {{"name", pass.name}, {"ms", milliseconds(pass.milliseconds)}, {"launches", pass.launches}});
    return passes;
}

std::string parametersText(const RenderReport& report) {
    std::string text;
    for (const auto& [name, value] : report.parameters)
        text += std::visit(
            [&, key = name](const auto& held) { return fmt::format(" {}={}", key, held); }, value);
    return text;
}

std::string millisecondsText(double value) {
    return value < 0.0 ? "unavailable" : fmt::format("{:.3f} ms", value);
}

std::string figuresText(const RenderReport& report) {
    const FrameFigures& figures = report.figures;
    std::string text;
    for (const PassTime& pass : figures.passes)
        text += fmt::format("  {:<34} {:>14}  {} launches\n", pass.name,
                            millisecondsText(pass.milliseconds), pass.launches);
    text += fmt::format("  {:<34} {:>14}  median of {} frames\n", "total",
                        millisecondsText(figures.totalMilliseconds), report.frames);
    text += fmt::format("  {:<34} {:>14}\n", "host clock", millisecondsText(figures.wallMilliseconds));
    text +=
        fmt::format("device memory {:.1f} MB, copied per frame {:.1f} MB\n",
                    double(figures.deviceBytes) / kMegabyte, double(figures.hostCopyBytes) / kMegabyte);
    for (const auto& [name, value] : figures.counts)
        text += fmt::format("  {:<34} {:>14}\n", name, value);
    for (const auto& [name, reason] : figures.choices) text += fmt::format("  {}: {}\n", name, reason);
    return text;
}

}  // namespace

std::string hashText(std::uint64_t hash) {
    return fmt::format("{:016x}", hash);
}

std::string toJson(const RenderReport& report) {
    const FrameFigures& figures = report.figures;
    Json json;
    if (report.hasDevice) {
        json["device"] = report.device.name;
        json["platform"] = report.device.platform;
        json["driver"] = report.device.driver;
        json["compute_units"] = report.device.computeUnits;
        json["width"] = report.device.width;
    } else {
        json["device"] = nullptr;
        json["width"] = nullptr;
    }
    json["scene"] = report.scene;
    json["camera"] = report.camera;
    json["size"] = {report.size.width, report.size.height};
    json["technique"] = report.technique;
    json["parameters"] = parametersJson(report);
    json["frames"] = report.frames;
    json["passes"] = passesJson(figures);
    json["total_ms"] = milliseconds(figures.totalMilliseconds);
    json["wall_ms"] = milliseconds(figures.wallMilliseconds);
    addFrames(json, figures);
    json["bytes"] = {{"device", figures.deviceBytes},
                     {"estimated", figures.estimatedBytes},
                     {"host_copies", figures.hostCopyBytes}};
    json["counts"] = toObject(figures.counts);
    json["choices"] = toObject(figures.choices);
    json["hash"] = hashText(report.hash);
    if (report.exposure > 0.0) json["exposure"] = report.exposure;
    json["outputs"] = report.outputs;
    return json.dump(2) + "\n";
}

std::string toText(const RenderReport& report) {
    std::string text =
        fmt::format("{}, camera {}, {}x{}, {}{}\n", report.scene, report.camera, report.size.width,
                    report.size.height, report.technique, parametersText(report));
    if (report.hasDevice) {
        text += fmt::format("{} ({}, driver {}), width {}\n", report.device.name, report.device.platform,
                            report.device.driver, report.device.width);
    }
    if (report.frames > 0) text += figuresText(report);
    if (report.exposure > 0.0) text += fmt::format("exposure {:.4g}\n", report.exposure);
    for (const std::string& output : report.outputs) text += fmt::format("wrote {}\n", output);
    return text;
}

}  // namespace cli
