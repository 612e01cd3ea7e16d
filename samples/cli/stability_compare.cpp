// Regressions between two files of stability's results.
//
// Techniques give the same bits for the same inputs on one device, so that what a figure may differ by
// without a change is the truth's noise (the floors of both runs; none where both used the same kept
// truth, but which truth it was is not told apart here) and the rounding of another device.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "cli.h"
#include "stability_results.h"

namespace cli {
namespace {

using Json = nlohmann::ordered_json;

// Devices and widths round differently: the picture's relative 1e-5 (docs/testing.md), of which a
// difference of nearly equal numbers shows more.
constexpr double kRoundingShare = 5e-3, kRounding = 1e-5;

double valueOf(const Json& figures, const char* name, double otherwise) {
    return figures.contains(name) && figures.at(name).is_number() ? figures.at(name).get<double>()
                                                                  : otherwise;
}

// 0 is best, and a bias as bad on either side; but a ghost below 0 is none.
double badness(const std::string& name, double value) {
    return name == "ghost" && value < 0.0 ? 0.0 : std::abs(value);
}

void compareFigure(const std::string& id, const char* name, const char* figures, const char* floors,
                   const Json& before, const Json& now, StabilityComparison& comparison) {
    const double nothing = std::nan("");
    const double was = badness(name, valueOf(before.at(figures), name, nothing)),
                 is = badness(name, valueOf(now.at(figures), name, nothing));
    if (std::isnan(was) && std::isnan(is)) return;
    if (std::isnan(was) != std::isnan(is)) {
        comparison.notes.push_back(fmt::format("{}: {} has no value in {} results", id, name,
                                               std::isnan(was) ? "the earlier" : "the new"));
        return;
    }
    ++comparison.compared;
    const double noise =
        std::abs(valueOf(before.at(floors), name, 0.0)) + std::abs(valueOf(now.at(floors), name, 0.0));
    const double slack = noise + kRoundingShare * was + kRounding;
    const std::string text =
        fmt::format("{}: {} {:.4g} -> {:.4g} (noise of both {:.2g})", id, name, was, is, noise);
    if (is > was + slack) comparison.regressions.push_back(text);
    if (is < was - slack) comparison.improvements.push_back(text);
}

void requireAlike(const Json& before, const Json& header) {
    for (const char* field : {"size", "frames"})
        if (before.at("header").at(field) != header.at(field))
            throw UsageError(fmt::format("--compare: {} is {} there and {} here; expected the same",
                                         field, before.at("header").at(field).dump(),
                                         header.at(field).dump()));
}

// Light or NaN where there must be none; more of NaN than before counts like the first.
bool failsMore(const Json& before, const Json& now) {
    if (now.at("passes") != false) return false;
    return before.at("passes") == true ||
           valueOf(now, "not_finite", 0.0) > valueOf(before, "not_finite", 0.0);
}

const Json* find(const Json& list, const Json& id) {
    for (const Json& item : list)
        if (item.at("id") == id) return &item;
    return nullptr;
}

}  // namespace

void requireComparable(const Json& before, const studio::SequenceSize& size) {
    requireAlike(before, {{"size", {size.width, size.height}}, {"frames", size.frames}});
}

StabilityComparison compareStability(const Json& before, const Json& now) {
    requireAlike(before, now.at("header"));
    StabilityComparison comparison;
    for (const Json& result : now.at("results")) {
        const std::string id = result.at("id");
        const Json* earlier = find(before.at("results"), id);
        if (earlier == nullptr) {
            comparison.notes.push_back(id + ": not in the earlier results");
            continue;
        }
        ++comparison.results;
        if (earlier->at("parameters") != result.at("parameters"))
            comparison.notes.push_back(id + ": its parameters are not the same");
        if (failsMore(*earlier, result))
            comparison.regressions.push_back(id + ": light or NaN where there must be none");
        for (const char* index : {"flicker", "ghost", "leak", "drift", "spike"})
            compareFigure(id, index, "indices", "floors", *earlier, result, comparison);
        for (const char* error : {"relMSE", "bias"})
            compareFigure(id, error, "errors", "error_floors", *earlier, result, comparison);
    }
    for (const Json& result : before.at("results"))
        if (find(now.at("results"), result.at("id")) == nullptr)
            comparison.notes.push_back(result.at("id").get<std::string>() + ": not in the new results");
    return comparison;
}

}  // namespace cli
