#include "api/parameters.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "api/call.h"
#include "compute/error.h"

namespace lightwell {
namespace {

template <class T>
T fieldAs(const char* desc, const LWParameter& parameter) {
    T value;
    std::memcpy(&value, desc + parameter.byteOffset, sizeof value);
    return value;
}

double valueOf(const char* desc, const LWParameter& parameter) {
    switch (parameter.kind) {
        case LW_PARAMETER_FLOAT:
            return double(fieldAs<float>(desc, parameter));
        case LW_PARAMETER_ENUM:
            return double(fieldAs<std::int32_t>(desc, parameter));
        default:
            return double(fieldAs<std::uint32_t>(desc, parameter));
    }
}

bool allows(const LWParameter& parameter, double value) {
    if (!(value >= parameter.minimum && value <= parameter.maximum)) return false;  // also NaN
    if (!parameter.allowed) return true;
    return std::any_of(parameter.allowed, parameter.allowed + parameter.allowedCount,
                       [&](double allowed) { return allowed == value; });
}

[[noreturn]] void refuse(const LWParameter& parameter, double value) {
    std::ostringstream expected;
    if (parameter.allowed) {
        for (std::uint32_t i = 0; i < parameter.allowedCount; ++i)
            expected << (i ? ", " : "one of ") << parameter.allowed[i];
    } else if (parameter.choices) {
        for (int i = 0; parameter.choices[i]; ++i)
            expected << (i ? ", " : "one of ") << i << " (" << parameter.choices[i] << ")";
    } else {
        expected << parameter.minimum << " .. " << parameter.maximum;
    }
    fail(LW_ERROR_INVALID_ARGUMENT, "desc.", parameter.name, ": expected ", expected.str(), ", got ",
         value);
}

using Members = std::vector<std::pair<const TechniqueObject*, const char*>>;  // and the parameter that they came by

// A technique that stands in a tree twice would be updated twice a frame, and its history take the second for another
// frame: each of `part` and its parts must be new.
void addMembers(Members& members, const TechniqueObject& part, const char* name) {
    for (const auto& [member, before] : members)
        if (member == &part)
            fail(LW_ERROR_INVALID_ARGUMENT, "desc.", name, ": expected another technique than desc.", before,
                 " and what it is made of, got one that both hold");
    members.emplace_back(&part, name);
    for (const auto& inner : part.parts) addMembers(members, *inner, name);
}

}  // namespace

std::vector<std::uint64_t> readDescriptor(const TechniqueEntry& entry, const void* desc) {
    const LWTechniqueInfo& info = entry.info;
    // Whole 8-byte words, so that the descriptor is aligned for any of its fields.
    std::vector<std::uint64_t> defaults((info.descSize + 7) / 8);
    info.setDefaults(defaults.data());
    if (!desc) return defaults;
    std::vector<std::uint64_t> result = defaults;
    std::uint32_t size = 0;
    std::memcpy(&size, desc, sizeof size);
    if (size != info.descSize)
        fail(LW_ERROR_INVALID_ARGUMENT, "desc.structSize: expected ", info.descSize,
             " (set it with the technique's lwDefault function or LW_INIT), got ", size);
    std::memcpy(result.data(), desc, size);
    char* fields = reinterpret_cast<char*>(result.data());
    const char* defaultFields = reinterpret_cast<const char*>(defaults.data());
    for (std::uint32_t i = 0; i < info.parameterCount; ++i) {
        const LWParameter& parameter = info.parameters[i];
        if (parameter.kind == LW_PARAMETER_TECHNIQUE) continue;  // partsOf's
        const double value = valueOf(fields, parameter);
        if (allows(parameter, value)) continue;
        if (value != 0.0) refuse(parameter, value);
        std::memcpy(fields + parameter.byteOffset, defaultFields + parameter.byteOffset, 4);
    }
    return result;
}

std::vector<std::shared_ptr<TechniqueObject>> partsOf(Call& call, const TechniqueEntry& entry,
                                                      const std::vector<std::uint64_t>& descriptor) {
    std::vector<std::shared_ptr<TechniqueObject>> parts;
    Members members;
    for (std::uint32_t i = 0; i < entry.info.parameterCount; ++i) {
        const LWParameter& parameter = entry.info.parameters[i];
        if (parameter.kind != LW_PARAMETER_TECHNIQUE) continue;
        const auto handle = fieldAs<LWTechnique>(reinterpret_cast<const char*>(descriptor.data()), parameter);
        const std::string argument = std::string("desc.") + parameter.name;
        if (!handle) fail(LW_ERROR_INVALID_ARGUMENT, argument, ": expected a technique, got null");
        parts.push_back(call.techniqueOfDevice(handle, argument.c_str()));
        addMembers(members, *parts.back(), parameter.name);
    }
    return parts;
}

}  // namespace lightwell
