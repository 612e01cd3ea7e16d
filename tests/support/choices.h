// What a technique's stats say of a choice.
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

}  // namespace lightwell::test
