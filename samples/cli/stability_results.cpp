#include "stability_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <nlohmann/json.hpp>

#include "cli.h"
#include "results_file.h"

namespace cli {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* kFormat = "lightwell-stability 1";

void putById(Json& list, Json item) {
    for (Json& known : list)
        if (known.at("id") == item.at("id")) {
            known = std::move(item);
            return;
        }
    list.push_back(std::move(item));
}

// "0.034 (0.002)": the figure and its floor.
std::string cell(const Json& figures, const Json& floors, const char* name, const char* format) {
    if (!figures.contains(name) || figures.at(name).is_null()) return "-";
    std::string text = fmt::format(fmt::runtime(format), figures.at(name).get<double>());
    if (floors.contains(name) && !floors.at(name).is_null())
        text += fmt::format(" ({:.2g})", floors.at(name).get<double>());
    return text;
}

bool hasAll(const Json& object, std::initializer_list<const char*> fields) {
    return object.is_object() && std::all_of(fields.begin(), fields.end(),
                                             [&](const char* field) { return object.contains(field); });
}

bool isText(const Json& object, const char* field) {
    return object.contains(field) && object.at(field).is_string();
}

bool isResult(const Json& item) {
    return hasAll(item, {"parameters", "passes"}) && isText(item, "id") && isText(item, "key") &&
           isText(item, "technique") && isText(item, "sequence") &&
           hasAll(item.value("indices", Json()), {}) && hasAll(item.value("floors", Json()), {}) &&
           hasAll(item.value("errors", Json()), {}) && hasAll(item.value("error_floors", Json()), {});
}

bool isStability(const Json& json) {
    if (!hasAll(json, {"header", "sequences", "results"}) || !isText(json, "format")) return false;
    const Json &sequences = json.at("sequences"), &results = json.at("results");
    return json.at("format") == kFormat && hasAll(json.at("header"), {"size", "frames"}) &&
           sequences.is_array() && results.is_array() &&
           std::all_of(sequences.begin(), sequences.end(),
                       [](const Json& item) { return isText(item, "id"); }) &&
           std::all_of(results.begin(), results.end(), isResult);
}

}  // namespace

Json readStability(const std::string& path) {
    std::ifstream file(path);
    if (!file) throw UsageError(fmt::format("{}: can't be read", path));
    const Json json = Json::parse(file, nullptr, false);
    if (!isStability(json))
        throw UsageError(fmt::format("{}: expected the results of `lightwell stability` (format \"{}\")",
                                     path, kFormat));
    return json;
}

struct StabilityResults::Impl {
    explicit Impl(const std::string& path) : file(path) {}

    ResultsFile file;
    Json json;
};

StabilityResults::StabilityResults(const std::string& path) : impl_(std::make_unique<Impl>(path)) {
    if (std::filesystem::exists(path))
        impl_->json = readStability(path);
    else
        impl_->json = {{"format", kFormat},
                       {"header", Json::object()},
                       {"sequences", Json::array()},
                       {"results", Json::array()}};
}

StabilityResults::~StabilityResults() = default;

void StabilityResults::setHeader(const Json& header) {
    Json& known = impl_->json["header"];
    for (const char* field : {"size", "frames"})
        if (known.contains(field) && known[field] != header.at(field))
            throw UsageError(fmt::format("{}: its {} is {}, this run's {}; another --out, or remove it",
                                         impl_->file.path(), field, known[field].dump(),
                                         header.at(field).dump()));
    replaceHeader(known, header);
}

bool StabilityResults::isFresh(const std::string& id, const std::string& key) const {
    for (const Json& result : impl_->json["results"])
        if (result.at("id") == id) return result.at("key") == key;
    return false;
}

void StabilityResults::putSequence(Json sequence) {
    putById(impl_->json["sequences"], std::move(sequence));
}

void StabilityResults::putResult(Json result) {
    putById(impl_->json["results"], std::move(result));
}

void StabilityResults::save() const {
    impl_->file.replace(impl_->json);
}

const Json& StabilityResults::json() const {
    return impl_->json;
}

Json describeSequence(const studio::FailureSequence& sequence, int samples) {
    Json json;
    json["id"] = sequence.name;
    json["failure"] = sequence.failure;
    json["frames"] = sequence.frames.size();
    json["size"] = {sequence.frames[0].width, sequence.frames[0].height};
    json["scale"] = sequence.scale;
    json["sweeps"] = sequence.sweeps;
    const bool isDark = sequence.truth == studio::SequenceTruth::Dark;
    json["truth"] = isDark ? "dark" : "traced";
    json["samples"] = isDark ? 0 : samples;
    Json values = Json::array(), sizes = Json::array(), cuts = Json::array();
    for (std::size_t f = 0; f < sequence.frames.size(); ++f) {
        const studio::SequenceFrame& frame = sequence.frames[f];
        values.push_back(frame.value);
        sizes.push_back({frame.width, frame.height});
        if (f > 0 && frame.isCut) cuts.push_back(f);
    }
    json["values"] = sequence.sweeps.empty() ? Json() : values;
    json["sizes"] = sizes;
    json["cuts"] = cuts;
    return json;
}

std::string stabilityTable(const Json& results) {
    constexpr const char* kRow = "{:{}} {:{}} {:>16} {:>16} {:>16} {:>16} {:>16} {:>18} {:>7}\n";
    std::size_t width = 19,
                by = 7;  // of the first columns; scenes' sequences and variants have long names
    for (const Json& sequence : results.at("sequences"))
        width = std::max(width, sequence.at("id").get<std::string>().size());
    for (const Json& result : results.at("results"))
        by = std::max(by, result.at("technique").get<std::string>().size());
    std::string table = fmt::format(fmt::runtime(kRow), "failure", width, "by", by, "flicker", "ghost",
                                    "leak", "drift", "spike", "relMSE", "bias");
    for (const Json& sequence : results.at("sequences"))
        for (const Json& result : results.at("results")) {
            if (result.at("sequence") != sequence.at("id")) continue;
            const Json &indices = result.at("indices"), &floors = result.at("floors"),
                       &errors = result.at("errors");
            const auto index = [&](const char* name) { return cell(indices, floors, name, "{:.3g}"); };
            std::string bias = cell(errors, Json::object(), "bias", "{:+.3f}");
            if (result.at("passes") == false) bias += "  FAILS: light or NaN where there must be none";
            table += fmt::format(fmt::runtime(kRow), sequence.at("id").get<std::string>(), width,
                                 result.at("technique").get<std::string>(), by, index("flicker"),
                                 index("ghost"), index("leak"), index("drift"), index("spike"),
                                 cell(errors, result.at("error_floors"), "relMSE", "{:.3g}"), bias);
        }
    return table;
}

}  // namespace cli
