#include "results_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "cli.h"

namespace cli {

using Json = nlohmann::ordered_json;

ResultsFile::ResultsFile(const std::string& path)
    : path_(path), lock_(path + ".lock", [] { return false; }) {
    if (!lock_.isHeld())
        throw UsageError(
            fmt::format("{}: another run is writing it; expected another --out, or to wait", path));
}

void ResultsFile::replace(const Json& json) const {
    const std::string unfinished = path_ + ".part";
    std::ofstream file(unfinished, std::ios::trunc);
    file << json.dump(1) << '\n';
    file.close();
    if (!file) throw std::runtime_error(unfinished + ": cannot be written");
    std::filesystem::rename(unfinished, path_);
}

void replaceHeader(Json& known, const Json& header) {
    const Json device = known.value("device", Json());
    known = header;
    if (known["device"].is_null()) known["device"] = device;
}

}  // namespace cli
