// An instrument's results file (a chart's results.json, split.json): what is measured so far. Written
// after every few points in one step, so that an interrupted run loses seconds; read by the next, which
// measures only what is missing or stale.
#pragma once

#include <memory>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace cli {

class ChartResults {
public:
    // Goes on from the file where there is one. `format`: "lightwell-chart 1". UsageError when the file
    // is of another.
    ChartResults(const std::string& path, const std::string& format);
    ~ChartResults();

    void setHeader(const nlohmann::ordered_json& header);
    // The point of this id if it was timed under this key (everything that its times depend on), else
    // null.
    const nlohmann::ordered_json* find(const std::string& id, const std::string& key) const;
    // Replace what has the same "id", or come last.
    void putView(nlohmann::ordered_json view);
    void putPoint(nlohmann::ordered_json point);
    void save() const;
    std::size_t pointCount() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace cli
