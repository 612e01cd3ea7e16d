// How techniques write the tables of their parameters.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lightwell/lightwell.h"

namespace lightwell {

inline LWParameter parameter(const char* name, const char* description, LWParameterKind kind, std::size_t byteOffset,
                             double minimum, double maximum, double defaultValue) {
    LWParameter p{};
    p.name = name;
    p.description = description;
    p.kind = kind;
    p.byteOffset = std::uint32_t(byteOffset);
    p.minimum = minimum;
    p.maximum = maximum;
    p.defaultValue = defaultValue;
    return p;
}

// `values` must live as long as the table.
template <std::size_t N>
LWParameter swept(LWParameter p, const double (&values)[N]) {
    p.sweep = values;
    p.sweepCount = std::uint32_t(N);
    return p;
}

template <std::size_t N>
LWParameter allowing(LWParameter p, const double (&values)[N]) {
    p.allowed = values;
    p.allowedCount = std::uint32_t(N);
    return p;
}

// `names`: null-terminated, of an enum's values from 0 on.
inline LWParameter choosing(LWParameter p, const char* const* names) {
    p.choices = names;
    return p;
}

}  // namespace lightwell
