#include "chart_results.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "cli.h"
#include "results_file.h"

namespace cli {
namespace {

using Json = nlohmann::ordered_json;

Json readResults(const std::string& path, const std::string& format) {
    std::ifstream file(path);
    const Json json = Json::parse(file, nullptr, false);
    const bool isOurs = json.is_object() && json.value("format", "") == format &&
                        json.contains("views") && json.contains("points");
    if (!isOurs)
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
