#include "techniques/from_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <sstream>

#include "compute/error.h"

namespace lightwell {
namespace {

constexpr std::size_t kShown = 64;  // of a text that is not valid, in a message

std::string quoted(const std::string& text) {
    return '"' + (text.size() > kShown ? text.substr(0, kShown) + "..." : text) + '"';
}

std::vector<std::string> choicesOf(const LWParameter& parameter) {
    std::vector<std::string> names;
    for (const char* const* choice = parameter.choices; choice && *choice; ++choice) names.emplace_back(*choice);
    return names;
}

template <class List>
std::string listed(const List& values) {
    std::ostringstream text;
    for (const auto& value : values) text << (text.tellp() > 0 ? ", " : "") << value;
    return text.str();
}

std::string validValues(const LWParameter& parameter) {
    if (parameter.choices) return "one of " + listed(choicesOf(parameter));
    if (parameter.kind == LW_PARAMETER_BOOL) return "on, off, true, false, 1 or 0";
    if (parameter.allowed)
        return "one of " + listed(std::vector<double>(parameter.allowed, parameter.allowed + parameter.allowedCount));
    std::ostringstream range;
    if (parameter.kind == LW_PARAMETER_UINT) range << "a whole number " << std::uint64_t(parameter.minimum) << " .. " << std::uint64_t(parameter.maximum);
    else range << parameter.minimum << " .. " << parameter.maximum;
    return range.str();
}

// All of the text, whatever the process's locale.
template <class T>
bool readNumber(const std::string& text, T& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
}

bool allows(const LWParameter& parameter, double value) {
    if (!(value >= parameter.minimum && value <= parameter.maximum)) return false;
    return !parameter.allowed || std::count(parameter.allowed, parameter.allowed + parameter.allowedCount, value) > 0;
}

// The field's value as a number: an enum's index, a bool's 0 or 1. False: not valid.
bool readValue(const LWParameter& parameter, const std::string& text, double& value) {
    if (parameter.choices) {
        const auto names = choicesOf(parameter);
        const auto found = std::find(names.begin(), names.end(), text);
        value = double(found - names.begin());
        return found != names.end();
    }
    if (parameter.kind == LW_PARAMETER_BOOL) {
        value = text == "on" || text == "true" || text == "1" ? 1.0 : 0.0;
        return value == 1.0 || text == "off" || text == "false" || text == "0";
    }
    if (parameter.kind == LW_PARAMETER_UINT) {
        std::uint64_t whole = 0;
        if (!readNumber(text, whole)) return false;
        value = double(whole);
    } else if (!readNumber(text, value)) {
        return false;
    }
    return allows(parameter, value);
}

TechniqueText defaultsOf(const std::string& name) {
    TechniqueText text;
    text.entry = &findTechniqueEntry(name.c_str());
    const LWTechniqueInfo& info = text.entry->info;
    text.descriptor.resize((info.descSize + 7) / 8);
    info.setDefaults(text.descriptor.data());
    for (std::uint32_t i = 0; i < info.parameterCount; ++i) {
        const LWParameter& parameter = info.parameters[i];
        if (parameter.kind == LW_PARAMETER_TECHNIQUE)
            text.parts.push_back(defaultsOf(choicesOf(parameter).at(std::size_t(parameter.defaultValue))));
    }
    return text;
}

bool isDefault(const TechniqueText& text) {
    const TechniqueText defaults = defaultsOf(text.entry->info.name);
    for (std::size_t i = 0; i < text.parts.size(); ++i)
        if (text.parts[i].entry != defaults.parts[i].entry || !isDefault(text.parts[i])) return false;
    const auto fieldOf = [](const TechniqueText& of, const LWParameter& parameter) {
        return reinterpret_cast<const char*>(of.descriptor.data()) + parameter.byteOffset;
    };
    for (std::uint32_t i = 0; i < text.entry->info.parameterCount; ++i) {
        const LWParameter& parameter = text.entry->info.parameters[i];
        if (parameter.kind != LW_PARAMETER_TECHNIQUE && std::memcmp(fieldOf(text, parameter), fieldOf(defaults, parameter), 4) != 0)
            return false;
    }
    return true;
}

// The part that stands for the technique's i-th parameter.
TechniqueText& partOf(TechniqueText& text, std::uint32_t index) {
    std::size_t part = 0;
    for (std::uint32_t i = 0; i < index; ++i) part += text.entry->info.parameters[i].kind == LW_PARAMETER_TECHNIQUE;
    return text.parts[part];
}

[[noreturn]] void refuseKey(const TechniqueText& text, const std::string& key) {
    const LWTechniqueInfo& info = text.entry->info;
    std::vector<std::string> names;
    for (std::uint32_t i = 0; i < info.parameterCount; ++i) {
        names.emplace_back(info.parameters[i].name);
        if (info.parameters[i].kind == LW_PARAMETER_TECHNIQUE) names.push_back(names.back() + ".KEY");
    }
    fail(LW_ERROR_INVALID_ARGUMENT, "settings: expected for a key of \"", info.name, "\" ",
         names.empty() ? "none" : "one of " + listed(names), ", got ", quoted(key));
}

void choosePart(TechniqueText& part, const LWParameter& parameter, const std::string& name) {
    const auto names = choicesOf(parameter);
    if (std::find(names.begin(), names.end(), name) == names.end())
        fail(LW_ERROR_INVALID_ARGUMENT, "settings: ", parameter.name, ": expected ", validValues(parameter), ", got ", quoted(name));
    if (name == part.entry->info.name) return;
    if (!isDefault(part))
        fail(LW_ERROR_INVALID_ARGUMENT, "settings: ", parameter.name, "=", name, ": expected before ", parameter.name,
             ".KEY=VALUE, whose values are those of \"", part.entry->info.name, "\", got it after");
    part = defaultsOf(name);
}

void assign(TechniqueText& text, const std::string& key, const std::string& value) {
    const LWTechniqueInfo& info = text.entry->info;
    const std::size_t dot = key.find('.');
    for (std::uint32_t i = 0; i < info.parameterCount; ++i) {
        const LWParameter& parameter = info.parameters[i];
        const bool isTechnique = parameter.kind == LW_PARAMETER_TECHNIQUE;
        if (isTechnique && dot != std::string::npos && key.compare(0, dot, parameter.name) == 0)
            return assign(partOf(text, i), key.substr(dot + 1), value);
        if (key != parameter.name) continue;
        if (isTechnique) return choosePart(partOf(text, i), parameter, value);
        double number = 0.0;
        if (!readValue(parameter, value, number))
            fail(LW_ERROR_INVALID_ARGUMENT, "settings: ", parameter.name, ": expected ", validValues(parameter), ", got ", quoted(value));
        // UINT, BOOL: uint32_t; ENUM: int32_t, never negative.
        const float real = float(number);
        const std::uint32_t whole = parameter.kind == LW_PARAMETER_FLOAT ? 0 : std::uint32_t(number);
        std::memcpy(reinterpret_cast<char*>(text.descriptor.data()) + parameter.byteOffset,
                    parameter.kind == LW_PARAMETER_FLOAT ? static_cast<const void*>(&real) : &whole, 4);
        return;
    }
    refuseKey(text, key);
}

}  // namespace

TechniqueText parseTechnique(const std::string& name, const std::string& settings) {
    TechniqueText text = defaultsOf(name);
    std::istringstream words(settings);
    words.imbue(std::locale::classic());
    for (std::string word; words >> word;) {
        const std::size_t equals = word.find('=');
        if (equals == std::string::npos || equals == 0)
            fail(LW_ERROR_INVALID_ARGUMENT, "settings: expected key=value, got ", quoted(word));
        assign(text, word.substr(0, equals), word.substr(equals + 1));
    }
    return text;
}

std::unique_ptr<Technique> makeTechnique(Device& device, const TechniqueText& text) {
    if (!text.entry->join) return text.entry->create(device, text.descriptor.data());
    std::vector<std::shared_ptr<Technique>> parts;
    for (const TechniqueText& part : text.parts) parts.push_back(makeTechnique(device, part));
    return text.entry->join(device, parts);
}

std::unique_ptr<Technique> makeTechnique(Device& device, const std::string& name, const std::string& settings) {
    return makeTechnique(device, parseTechnique(name, settings));
}

}  // namespace lightwell
