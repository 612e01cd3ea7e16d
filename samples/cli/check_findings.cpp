// See check_findings.h.
#include "check_findings.h"

#include <fmt/format.h>

#include <cmath>

#include "image.h"
#include "lightwell/lightwell.hpp"

namespace cli {

const char* severityName(const LWInputFinding& finding) {
    constexpr const char* kSeverities[] = {"note", "warning", "error"};
    return kSeverities[finding.severity];
}

const char* faultName(LWInputFault fault) {
    auto info = lightwell::make<LWInputFaultInfo>();
    lightwell::check(lwDescribeInputFault(std::uint32_t(fault), &info));
    return info.name;
}

std::string colourText(const float (&colour)[3]) {
    const auto byte = [&](int c) { return int(std::lround(255.0f * studio::srgbEncode(colour[c]))); };
    return fmt::format("#{:02x}{:02x}{:02x}", byte(0), byte(1), byte(2));
}

nlohmann::ordered_json findingJson(const LWInputFinding& f) {
    return {{"fault", faultName(f.fault)},    {"severity", severityName(f)},
            {"argument", f.argument},         {"affected", f.affected},
            {"examined", f.examined},         {"measured", f.measured},
            {"expected", f.expected},         {"confidence", f.confidence},
            {"colour", colourText(f.colour)}, {"message", f.message}};
}

}  // namespace cli
