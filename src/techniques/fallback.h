// Technique "fallback": two techniques joined by what the first one vouches for. Where the first has seen the share v of a
// pixel's hemisphere, the second lights the rest: E = E1 + (1 - v) E2. docs/techniques/fallback.md derives it.
#pragma once

#include <memory>
#include <vector>

#include "techniques/technique.h"

namespace lightwell {

const TechniqueEntry& fallbackEntry();

// `techniques`: first and second, in the order of LWFallbackDesc's fields.
std::unique_ptr<Technique> joinTechniques(Device& device, const std::vector<std::shared_ptr<Technique>>& techniques);

}  // namespace lightwell
