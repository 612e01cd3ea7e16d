#include "chart_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "cli.h"
#include "results_file.h"

namespace cli {
namespace {

using Json = nlohmann::ordered_json;

bool hasText(const Json& item, const char* key) {
    return item.is_object() && item.contains(key) && item[key].is_string();
}

// All that is read of it here: what else is wrong with an item comes to light in the report.
bool isResults(const Json& json, const std::string& format) {
    if (!hasText(json, "format") || json["format"] != format) return false;
    if (!json.contains("header") || !json["header"].is_object()) return false;
    for (const char* list : {"views", "points"})
        if (!json.contains(list) || !json[list].is_array()) return false;
    const auto isView = [](const Json& view) { return hasText(view, "id"); };
    const auto isPoint = [](const Json& point) { return hasText(point, "id") && hasText(point, "key"); };
    return std::all_of(json["views"].begin(), json["views"].end(), isView) &&
           std::all_of(json["points"].begin(), json["points"].end(), isPoint);
}

Json readResults(const std::string& path, const std::string& format) {
    std::ifstream file(path);
    const std::string text = std::filesystem::is_regular_file(path)
                                 ? std::string(std::istreambuf_iterator<char>(file), {})
                                 : std::string();
    const Json json = Json::parse(text, nullptr, false);
    if (!isResults(json, format))
        throw UsageError(fmt::format(
            "{}: expected results in the format \"{}\"; another --out, or remove it", path, format));
    return json;
}

}  // namespace

struct ChartResults::Impl {
    explicit Impl(const std::string& path) : file(path) {}

    ResultsFile file;
    Json json;
    std::unordered_map<std::string, std::size_t> views, points;  // index by id

    void put(const char* list, std::unordered_map<std::string, std::size_t>& index, Json item) {
        const std::string id = item.at("id");
        const auto [at, isNew] = index.emplace(id, json[list].size());
        if (isNew)
            json[list].push_back(std::move(item));
        else
            json[list][at->second] = std::move(item);
    }
};

ChartResults::ChartResults(const std::string& path, const std::string& format)
    : impl_(std::make_unique<Impl>(path)) {
    if (!std::filesystem::exists(path)) {
        impl_->json = {{"format", format},
                       {"header", Json::object()},
                       {"views", Json::array()},
                       {"points", Json::array()}};
        return;
    }
    impl_->json = readResults(path, format);
    for (const Json& view : impl_->json["views"])
        impl_->views.emplace(view.at("id"), impl_->views.size());
    for (const Json& point : impl_->json["points"])
        impl_->points.emplace(point.at("id"), impl_->points.size());
}

ChartResults::~ChartResults() = default;

void ChartResults::setHeader(const Json& header) {
    replaceHeader(impl_->json["header"], header);
}

const Json* ChartResults::find(const std::string& id, const std::string& key) const {
    const auto found = impl_->points.find(id);
    if (found == impl_->points.end()) return nullptr;
    const Json& point = impl_->json["points"][found->second];
    return point.at("key") == key ? &point : nullptr;
}

void ChartResults::putView(Json view) {
    impl_->put("views", impl_->views, std::move(view));
}

void ChartResults::putPoint(Json point) {
    impl_->put("points", impl_->points, std::move(point));
}

void ChartResults::save() const {
    impl_->file.replace(impl_->json);
}

std::size_t ChartResults::pointCount() const {
    return impl_->points.size();
}

}  // namespace cli
