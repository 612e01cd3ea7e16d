// What a technique's stats say of a choice, and of a pass.
#pragma once

#include <string>

#include "support/scoped_api.h"

namespace lightwell::test {

// The reason beside the choice of that name; "" where there is none.
inline std::string reasonOf(TestTechnique& technique, const std::string& name) {
    const LWStats stats = technique.stats();
    for (std::uint32_t i = 0; i < stats.choiceCount; ++i)
        if (stats.choices[i].name == name) return stats.choices[i].reason;
    return "";
}

// Launches of the passes of that name since the last lwUpdate.
inline std::uint32_t launchesOf(TestTechnique& technique, const std::string& pass) {
    const LWStats stats = technique.stats();
    std::uint32_t launches = 0;
    for (std::uint32_t i = 0; i < stats.passCount; ++i)
        if (stats.passes[i].name == pass) launches += stats.passes[i].launches;
    return launches;
}

}  // namespace lightwell::test
