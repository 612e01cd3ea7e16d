#include "run_facts.h"

#include <fmt/format.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "build_identity.h"
#include "film.h"

namespace cli {

using Json = nlohmann::ordered_json;

double loadAverage() {
    double load = -1.0;
    return getloadavg(&load, 1) == 1 ? load : -1.0;
}

std::string utcNow() {
    const std::time_t now = std::time(nullptr);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
    return text;
}

std::string shortHash(const std::string& text) {
    return fmt::format("{:016x}", studio::hashBytes(text.data(), text.size(), 5));
}

std::string filesKey(const Parameters& parameters) {
    const std::string name = parameters.vplsFile();
    if (name.empty()) return {};
    std::ifstream in(name, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in) throw std::runtime_error(fmt::format("{}: can't be read", name));
    return shortHash(text.str()) + " ";
}

Json parametersJson(const Parameters& parameters) {
    Json json = Json::object();
    for (const auto& [name, value] : parameters.resolved())
        std::visit([&, key = name](const auto& held) { json[key] = held; }, value);
    return json;
}

Json deviceJson(const LWDeviceInfo& info) {
    return {{"name", info.name},
            {"platform", info.platform},
            {"driver", info.driver},
            {"opencl", info.openclVersion},
            {"compute_units", info.computeUnits},
            {"is_gpu", info.isGpu != 0},
            {"width", info.width}};
}

Json versionsJson() {
    Json versions = Json::object();
    for (const auto& [name, version] : buildVersions()) versions[name] = version;
    return versions;
}

}  // namespace cli
