// Enums that a C host has filled in: they may hold anything, and reading such a value as the enum is undefined.
#pragma once

#include <cstdint>
#include <cstring>

namespace lightwell {

template <class Enum>
std::uint32_t rawEnum(const Enum& field) {
    static_assert(sizeof field == sizeof(std::uint32_t), "an LW enum has 32 bits");
    std::uint32_t value = 0;
    std::memcpy(&value, &field, sizeof value);
    return value;
}

}  // namespace lightwell
