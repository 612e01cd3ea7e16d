// What the results files of all instruments (chart, split, stability) do alike: one writer at a time, a
// head that keeps what this run lacks, replaced in one step.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "file_lock.h"

namespace cli {

class ResultsFile {
public:
    // UsageError while another run holds the file: each would lose what the other measures.
    explicit ResultsFile(const std::string& path);

    const std::string& path() const { return path_; }
    // So that a run cut off while saving leaves the results before. std::runtime_error when it cannot
    // be written.
    void replace(const nlohmann::ordered_json& json) const;

private:
    std::string path_;
    FileLock lock_;
};

// `header` becomes `known`; the device of earlier results stays where this run needs none.
void replaceHeader(nlohmann::ordered_json& known, const nlohmann::ordered_json& header);

}  // namespace cli
