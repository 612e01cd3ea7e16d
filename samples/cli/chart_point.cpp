#include "chart_point.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli.h"
#include "run_facts.h"

namespace cli {
namespace {

using Json = nlohmann::ordered_json;

// `text` is one of the values of "a,b,c".
bool isListed(const std::string& text, const std::string& list) {
    return ("," + list + ",").find("," + text + ",") != std::string::npos;
}

bool isWanted(const Parameters& parameters, const std::vector<std::string>& only) {
    const auto values = parameters.resolved();
    return std::all_of(only.begin(), only.end(), [&](const std::string& assignment) {
        const auto [name, text] = splitAssignment("--only", assignment);
        return std::all_of(values.begin(), values.end(),
                           [&, key = name, list = text](const auto& value) {
                               return value.first != key || isListed(valueText(value.second), list);
                           });
    });
}

Json timesJson(const TimeFigures& times) {
    if (times.median < 0.0) return nullptr;
    return {{"median", times.median}, {"p99", times.p99}};
}

}  // namespace

std::string pointId(const ChartView& view, const ChartedPoint& point) {
    return fmt::format("{}/{}/{}", view.id(), point.technique,
                       shortHash(parametersJson(point.sweep.parameters).dump()).substr(0, 8));
}

std::vector<ChartedPoint> chartedPoints(const std::vector<std::string>& techniques, bool quick,
                                        const std::vector<std::string>& only) {
    std::vector<ChartedPoint> points;
    const auto add = [&](SweepPoint sweep) {
        const bool isKnown = std::any_of(points.begin(), points.end(), [&](const ChartedPoint& known) {
            return known.technique == sweep.parameters.technique() &&
                   known.sweep.parameters.resolved() == sweep.parameters.resolved();
        });
        if (!isKnown) points.push_back({sweep.parameters.technique(), std::move(sweep)});
    };
    for (const std::string& text : techniques)
        if (text.find(',') != std::string::npos)
            add(pointOf(text));
        else
            for (SweepPoint& sweep : sweepOf(text, quick)) add(std::move(sweep));
    for (const std::string& assignment : only) {
        const bool picks = std::any_of(points.begin(), points.end(), [&](const ChartedPoint& point) {
            return point.sweep.parameters.has(splitAssignment("--only", assignment).first) &&
                   isWanted(point.sweep.parameters, {assignment});
        });
        if (!picks)
            throw UsageError(fmt::format(
                "--only {}: expected a parameter and values of a charted technique's sweep ({}); no "
                "point has such",
                assignment, joinNames(techniques)));
    }
    points.erase(std::remove_if(
                     points.begin(), points.end(),
                     [&](const ChartedPoint& point) { return !isWanted(point.sweep.parameters, only); }),
                 points.end());
    return points;
}

Json timePoint(const ChartView& view, const ChartedPoint& point, IndirectRenderer& renderer,
               const FrameLimits& limits) {
    const double load = loadAverage();
    const ChartedFrames frames = timeFrames(renderer, view.inputs(), limits);
    Json json;
    json["id"] = pointId(view, point);
    json["scene"] = view.sceneName();
    json["camera"] = view.cameraName();
    json["technique"] = point.technique;
    json["label"] = point.sweep.label;
    json["settings"] = describeDifference(point.sweep.parameters);
    json["parameters"] = parametersJson(point.sweep.parameters);
    json["bounces"] = modelledBounces(point.sweep.parameters);
    json["size"] = {view.inputs().gbuffer().width, view.inputs().gbuffer().height};
    json["warm_up"] = frames.warmUp;
    json["frames"] = frames.frames;
    json["ms"] = timesJson(frames.wall);
    json["processor_ms"] = timesJson(frames.processor);
    json["device_ms"] = timesJson(frames.device);
    json["bytes"] = {{"device", frames.last.deviceBytes}, {"host_copies", frames.last.hostCopyBytes}};
    json["load_average"] = load;
    return json;
}

}  // namespace cli
