// Over 300 lines: values as text, of the library's tables and of the command line's own keys, belong side by side.
#include "parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "cli.h"
#include "host_techniques.h"
#include "open_device.h"
#include "static_vpls.h"

namespace cli {
namespace {

std::vector<std::string> choicesOf(const LWParameter& parameter) {
    std::vector<std::string> names;
    for (const char* const* choice = parameter.choices; choice != nullptr && *choice != nullptr;
         ++choice)
        names.emplace_back(*choice);
    return names;
}

constexpr const char* kSwitchValues = "on, off, true, false, 1, 0";

std::optional<bool> switchOf(const std::string& text) {
    if (text == "on" || text == "true" || text == "1") return true;
    if (text == "off" || text == "false" || text == "0") return false;
    return std::nullopt;
}

std::string validValues(const LWParameter& parameter) {
    if (parameter.kind == LW_PARAMETER_ENUM || parameter.kind == LW_PARAMETER_TECHNIQUE)
        return fmt::format("{}", fmt::join(choicesOf(parameter), ", "));
    if (parameter.kind == LW_PARAMETER_BOOL) return kSwitchValues;
    if (parameter.allowedCount > 0)
        return fmt::format(
            "{}", fmt::join(parameter.allowed, parameter.allowed + parameter.allowedCount, ", "));
    // UINT limits are whole: no exponent.
    if (parameter.kind == LW_PARAMETER_UINT)
        return fmt::format("{:.0f} to {:.0f}", parameter.minimum, parameter.maximum);
    return fmt::format("{} to {}", parameter.minimum, parameter.maximum);
}

bool isValid(const LWParameter& parameter, double value) {
    const double* const end = parameter.allowed + parameter.allowedCount;
    if (parameter.allowedCount > 0) return std::find(parameter.allowed, end, value) != end;
    return value >= parameter.minimum && value <= parameter.maximum;
}

// The field's value as a number: an enum's index, a bool's 0 or 1.
double parseValue(const LWParameter& parameter, const std::string& text) {
    const auto refuse = [&]() -> double {
        throw UsageError(fmt::format("--set {}: '{}' is not valid; expected {}", parameter.name, text,
                                     validValues(parameter)));
    };
    if (parameter.kind == LW_PARAMETER_ENUM) {
        const std::vector<std::string> names = choicesOf(parameter);
        const auto name = std::find(names.begin(), names.end(), text);
        return name == names.end() ? refuse() : double(name - names.begin());
    }
    if (parameter.kind == LW_PARAMETER_BOOL) {
        const std::optional<bool> value = switchOf(text);
        return value ? double(*value) : refuse();
    }
    const std::string option = fmt::format("--set {}", parameter.name);
    const double value = parameter.kind == LW_PARAMETER_UINT ? double(parseUnsigned(option, text))
                                                             : parseNumber(option, text);
    return isValid(parameter, value) ? value : refuse();
}

// What the library has no parameter for: what a frame holds, which is the host's.
constexpr const char *kVplsFile = "vpls_file", *kVplsCap = "vpls_cap", *kRsmVersions = "rsm_versions";
bool takesVpls(const std::string& technique) { return technique == "static_vpl"; }

std::string defaultText(const LWParameter& parameter) {
    if (parameter.kind == LW_PARAMETER_ENUM || parameter.kind == LW_PARAMETER_TECHNIQUE)
        return choicesOf(parameter).at(std::size_t(parameter.defaultValue));
    if (parameter.kind == LW_PARAMETER_BOOL) return parameter.defaultValue != 0.0 ? "on" : "off";
    return fmt::format("{}", parameter.defaultValue);
}

}  // namespace

bool Parameters::takesVpls() const {
    return cli::takesVpls(technique_) || std::any_of(parts_.begin(), parts_.end(), [](const auto& part) { return part.second.takesVpls(); });
}

bool Parameters::tellsRsmVersions() const {
    return tellsRsmVersions_ || std::any_of(parts_.begin(), parts_.end(), [](const auto& part) { return part.second.tellsRsmVersions(); });
}

std::string Parameters::vplsFile() const {
    if (!vplsFile_.empty()) return vplsFile_;
    for (const auto& [name, part] : parts_)
        if (const std::string file = part.vplsFile(); !file.empty()) return file;
    return {};
}

std::uint32_t Parameters::vplsCap() const {
    if (vplsCap_ != 0) return vplsCap_;
    for (const auto& [name, part] : parts_)
        if (const std::uint32_t cap = part.vplsCap(); cap != 0) return cap;
    return 0;
}

std::vector<LWTechniqueInfo> describeTechniques() {
    std::vector<LWTechniqueInfo> infos(lwCountTechniques(), lightwell::make<LWTechniqueInfo>());
    for (std::size_t i = 0; i < infos.size(); ++i)
        lightwell::check(lwDescribeTechnique(std::uint32_t(i), &infos[i]));
    for (const HostTechnique& technique : hostTechniques()) infos.push_back(*technique.info);
    return infos;
}

std::vector<std::string> techniqueNames() {
    std::vector<std::string> names;
    for (const LWTechniqueInfo& info : describeTechniques()) names.emplace_back(info.name);
    return names;
}

std::string describeParameters() {
    std::string text = fmt::format("Techniques and what --set takes (key=default: valid values; meaning):\n"
                                   "  each of the library's techniques:\n"
                                   "    {}=off: {}; RSMs' versions are told, so that a still light's are read once\n",
                                   kRsmVersions, kSwitchValues);
    for (const LWTechniqueInfo& info : describeTechniques()) {
        text += fmt::format("  {}: {}\n", info.name, info.summary);
        if (takesVpls(info.name))
            text += fmt::format(
                "    {}=: a file; static VPLs and blockers (docs/vpls-file.md); without it placed as by "
                "place-vpls\n"
                "    {}=: 1 to {}; without a file, VPLs placed at most, as place-vpls --cap\n",
                kVplsFile, kVplsCap, studio::kMostStaticVpls);
        for (std::uint32_t i = 0; i < info.parameterCount; ++i) {
            const LWParameter& parameter = info.parameters[i];
            text += fmt::format("    {}={}: {}; {}\n", parameter.name, defaultText(parameter),
                                validValues(parameter), parameter.description);
        }
    }
    return text;
}

Parameters::Parameters(const std::string& technique) : technique_(technique) {
    requireOneOf("technique", technique, techniqueNames());
    for (const LWTechniqueInfo& info : describeTechniques())
        if (technique == info.name) info_ = info;
    bytes_.resize((info_.descSize + sizeof(std::uint64_t) - 1) / sizeof(std::uint64_t));
    info_.setDefaults(bytes_.data());
    for (std::uint32_t i = 0; i < info_.parameterCount; ++i)
        if (info_.parameters[i].kind == LW_PARAMETER_TECHNIQUE)
            parts_.emplace(info_.parameters[i].name, Parameters(defaultText(info_.parameters[i])));
}

bool Parameters::needsDevice() const {
    return findHostTechnique(technique_) == nullptr;
}

const LWParameter* Parameters::find(const std::string& name) const {
    for (std::uint32_t i = 0; i < info_.parameterCount; ++i)
        if (name == info_.parameters[i].name) return &info_.parameters[i];
    return nullptr;
}

void Parameters::set(const std::string& assignment) {
    const auto [name, value] = splitAssignment("--set", assignment);
    const std::size_t dot = name.find('.');
    if (const auto part = parts_.find(name.substr(0, dot)); dot != std::string::npos && part != parts_.end()) {
        part->second.set(assignment.substr(dot + 1));
        return;
    }
    if (setOwn(name, value)) return;
    const LWParameter* parameter = find(name);
    if (parameter == nullptr) {
        std::vector<std::string> names;
        if (cli::takesVpls(technique_)) names = {kVplsFile, kVplsCap};
        if (needsDevice()) names.emplace_back(kRsmVersions);
        for (std::uint32_t i = 0; i < info_.parameterCount; ++i)
            names.emplace_back(info_.parameters[i].name);
        for (const auto& [part, parameters] : parts_) names.push_back(part + ".KEY");
        requireOneOf(fmt::format("--set key of technique {}", info_.name), name, names);
    }
    assign(*parameter, value);
}

bool Parameters::setOwn(const std::string& name, const std::string& value) {
    if (name == kRsmVersions && needsDevice()) {
        const std::optional<bool> tells = switchOf(value);
        if (!tells) throw UsageError(fmt::format("--set {}: '{}' is not valid; expected {}", name, value, kSwitchValues));
        tellsRsmVersions_ = *tells;
        return true;
    }
    if (!cli::takesVpls(technique_) || (name != kVplsFile && name != kVplsCap)) return false;
    if (name == kVplsFile ? vplsCap_ != 0 : !vplsFile_.empty())
        throw UsageError(
            fmt::format("--set {}: expected {} or {}, got both: a file's VPLs are all taken", name,
                        kVplsFile, kVplsCap));
    if (name == kVplsFile) {
        if (value.empty()) throw UsageError("--set vpls_file: expected a file's name, got none");
        vplsFile_ = value;
        return true;
    }
    const std::uint64_t cap = parseUnsigned("--set vpls_cap", value);
    if (cap < 1 || cap > studio::kMostStaticVpls)
        throw UsageError(fmt::format("--set vpls_cap: '{}' is not valid; expected 1 to {}", value,
                                     studio::kMostStaticVpls));
    vplsCap_ = std::uint32_t(cap);
    return true;
}

bool Parameters::setEverywhere(const std::string& name, const std::string& value) {
    bool isAny = has(name);
    if (isAny) assign(*find(name), value);
    for (auto& [place, part] : parts_) isAny = part.setEverywhere(name, value) || isAny;
    return isAny;
}

bool Parameters::hasAnywhere(const std::string& name) const {
    return has(name) || std::any_of(parts_.begin(), parts_.end(), [&](const auto& part) { return part.second.hasAnywhere(name); });
}

void Parameters::assign(const LWParameter& parameter, const std::string& text) {
    if (parameter.kind == LW_PARAMETER_TECHNIQUE) {
        requireOneOf(fmt::format("--set {}", parameter.name), text, choicesOf(parameter));
        Parameters& part = parts_.at(parameter.name);
        if (part.technique() == text) return;
        if (part.resolved() != part.defaults().resolved())
            throw UsageError(fmt::format("--set {0}={1}: expected before {0}.KEY=VALUE, whose values are those of {2}",
                                         parameter.name, text, part.technique()));
        part = Parameters(text);
        return;
    }
    const double value = parseValue(parameter, text);
    char* field = reinterpret_cast<char*>(bytes_.data()) + parameter.byteOffset;
    if (parameter.kind == LW_PARAMETER_FLOAT) {
        const float real = float(value);
        std::memcpy(field, &real, sizeof real);
    } else {  // UINT, BOOL: uint32_t; ENUM: int32_t, never negative
        const std::uint32_t whole = std::uint32_t(value);
        std::memcpy(field, &whole, sizeof whole);
    }
}

ParameterValue Parameters::valueOf(const LWParameter& parameter) const {
    const char* field = reinterpret_cast<const char*>(bytes_.data()) + parameter.byteOffset;
    float real = 0.0f;
    std::uint32_t whole = 0;
    std::memcpy(&real, field, sizeof real);
    std::memcpy(&whole, field, sizeof whole);
    switch (parameter.kind) {
        case LW_PARAMETER_UINT:
            return std::uint64_t(whole);
        case LW_PARAMETER_FLOAT:
            return double(real);
        case LW_PARAMETER_ENUM:
            return choicesOf(parameter).at(whole);
        case LW_PARAMETER_BOOL:
            return whole != 0;
        case LW_PARAMETER_TECHNIQUE:
            return parts_.at(parameter.name).technique();
    }
    throw std::logic_error("a parameter of unknown kind");
}

std::vector<std::pair<std::string, ParameterValue>> Parameters::resolved() const {
    std::vector<std::pair<std::string, ParameterValue>> values;
    for (std::uint32_t i = 0; i < info_.parameterCount; ++i) {
        const LWParameter& parameter = info_.parameters[i];
        values.emplace_back(parameter.name, valueOf(parameter));
        if (parameter.kind != LW_PARAMETER_TECHNIQUE) continue;
        for (auto& [name, value] : parts_.at(parameter.name).resolved())
            values.emplace_back(std::string(parameter.name) + "." + name, std::move(value));
    }
    if (!vplsFile_.empty()) values.emplace_back(kVplsFile, vplsFile_);
    if (vplsCap_ != 0) values.emplace_back(kVplsCap, std::uint64_t(vplsCap_));
    if (tellsRsmVersions_) values.emplace_back(kRsmVersions, true);
    return values;
}

Parameters Parameters::defaults() const {
    Parameters result(technique_);
    for (const auto& [name, part] : parts_) result.parts_.at(name) = part.defaults();
    return result;
}

Parameters parseVariant(const std::string& text) {
    std::istringstream words(text);
    std::string word;
    std::getline(words, word, ',');
    Parameters parameters(word);
    while (std::getline(words, word, ',')) parameters.set(word);
    return parameters;
}

Descriptor::Descriptor(const lightwell::Device& device, const Parameters& parameters) : bytes_(parameters.bytes_) {
    for (std::uint32_t i = 0; i < parameters.info_.parameterCount; ++i) {
        const LWParameter& parameter = parameters.info_.parameters[i];
        if (parameter.kind != LW_PARAMETER_TECHNIQUE) continue;
        const Parameters& part = parameters.parts_.at(parameter.name);
        parts_.emplace_back(device, part.technique().c_str(), Descriptor(device, part).get());
        const LWTechnique handle = parts_.back().get();
        std::memcpy(reinterpret_cast<char*>(bytes_.data()) + parameter.byteOffset, &handle, sizeof handle);
    }
}

}  // namespace cli
