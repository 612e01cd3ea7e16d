// stability.json of `lightwell stability` (stability_run.h): what is measured so far, the table of it,
// and what has become worse since another one.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "sequence.h"

namespace cli {

// UsageError when the file is something else, or lacks what table, comparison and resumption read.
nlohmann::ordered_json readStability(const std::string& path);

class StabilityResults {
public:
    // Goes on from the file where there is one. UsageError when it is something else.
    explicit StabilityResults(const std::string& path);
    ~StabilityResults();

    void setHeader(const nlohmann::ordered_json& header);
    bool isFresh(const std::string& id, const std::string& key) const;
    // Replace what has the same "id", or come last.
    void putSequence(nlohmann::ordered_json sequence);
    void putResult(nlohmann::ordered_json result);
    void save() const;
    const nlohmann::ordered_json& json() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

nlohmann::ordered_json describeSequence(const studio::FailureSequence& sequence, int samples);

// Technique x failure: one line per sequence and technique, each index with its floor in brackets.
std::string stabilityTable(const nlohmann::ordered_json& results);

// What became worse from `before` to `now` by more than the noise of both, one line each; and notes on
// what cannot be compared. UsageError where sizes or lengths of the two differ.
struct StabilityComparison {
    std::vector<std::string> regressions, improvements, notes;
    int results = 0, compared = 0;  // that both have; their figures
};
StabilityComparison compareStability(const nlohmann::ordered_json& before,
                                     const nlohmann::ordered_json& now);

// The same refusal before anything is measured.
void requireComparable(const nlohmann::ordered_json& before, const studio::SequenceSize& size);

}  // namespace cli
