// What lwCheckInputs found, as text and as JSON.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "lightwell/lightwell.h"

namespace cli {

const char* severityName(const LWInputFinding& finding);
const char* faultName(LWInputFault fault);
std::string colourText(const float (&colour)[3]);  // "#rrggbb"
nlohmann::ordered_json findingJson(const LWInputFinding& finding);

}  // namespace cli
