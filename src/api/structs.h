// Versioned structs across the API's border. A caller built against an older header hands over a shorter
// struct: what it has is copied, the rest stays zero, which means "absent" or "the default" everywhere.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "compute/error.h"
#include "lightwell/lightwell.h"

namespace lightwell {

// Size of a struct in the first version that had it. When a struct grows, specialise this with the size
// it had before.
template <class T>
constexpr std::uint32_t kFirstSize = sizeof(T);
template <>
inline constexpr std::uint32_t kFirstSize<LWFrame> = offsetof(LWFrame, worldOrigin);
template <>
inline constexpr std::uint32_t kFirstSize<LWRsm> = 392;
template <>
inline constexpr std::uint32_t kFirstSize<LWPlan> = 600;
template <>
inline constexpr std::uint32_t kFirstSize<LWPlanDesc> = 16;

template <class T>
std::uint32_t checkedStructSize(const T* from, const std::string& name) {
    if (!from) fail(LW_ERROR_INVALID_ARGUMENT, name, ": expected a struct, got null");
    std::uint32_t size = 0;
    std::memcpy(&size, from, sizeof size);
    if (size < kFirstSize<T> || size > sizeof(T))
        fail(LW_ERROR_INVALID_ARGUMENT, name, ".structSize: expected ",
             kFirstSize<T> == sizeof(T) ? std::string() : std::to_string(kFirstSize<T>) + " .. ",
             sizeof(T), " (set it with LW_INIT; larger: the header is newer than the library), got ",
             size);
    return size;
}

// A caller's struct at our size.
template <class T>
T readStruct(const T* from, const std::string& name) {
    const std::uint32_t size = checkedStructSize(from, name);
    T result{};
    std::memcpy(&result, from, size);
    result.structSize = sizeof(T);
    return result;
}

// An array of them: elements lie the caller's size apart, which all of them state.
template <class T>
std::vector<T> readStructs(const T* from, std::uint32_t count, const std::string& name) {
    std::vector<T> result;
    const char* at = reinterpret_cast<const char*>(from);
    std::uint32_t stride = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::string element = name + "[" + std::to_string(i) + "]";
        const std::uint32_t size = checkedStructSize(reinterpret_cast<const T*>(at), element);
        if (i == 0) stride = size;
        if (size != stride)
            fail(LW_ERROR_INVALID_ARGUMENT, element, ".structSize: expected ", stride,
                 " as in the first, got ", size);
        result.push_back(readStruct(reinterpret_cast<const T*>(at), element));
        at += stride;
    }
    return result;
}

// Our struct back into the caller's, as far as that reaches.
template <class T>
void writeStruct(T* to, std::uint32_t callerSize, T value) {
    value.structSize = callerSize;
    std::memcpy(to, &value, callerSize);
}

}  // namespace lightwell
