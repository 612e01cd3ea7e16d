// What every file of measured results states about the run: when, on what, how busy, with what settings.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "parameters.h"

namespace cli {

double loadAverage();  // of the last minute; -1: unknown
std::string utcNow();  // "2026-11-22T21:30:00Z"
// Hash of a text, as 16 hexadecimal digits.
std::string shortHash(const std::string& text);
// Of what is in the files that parameters name (vpls_file), for keys of results that are kept: ""
// without any. std::runtime_error where one cannot be read.
std::string filesKey(const Parameters& parameters);

nlohmann::ordered_json parametersJson(const Parameters& parameters);
nlohmann::ordered_json deviceJson(const LWDeviceInfo& info);
nlohmann::ordered_json versionsJson();  // of buildVersions()

}  // namespace cli
