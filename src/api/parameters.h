// A technique's descriptor, checked against the parameters that the technique declares.
#pragma once

#include <vector>

#include "techniques/technique.h"

namespace lightwell {

// Throws INVALID_ARGUMENT listing the valid names.
const TechniqueEntry& findTechniqueEntry(const char* name);

// The descriptor at the technique's size (`desc` null: its defaults). A zero that a parameter does not
// allow means the default. Throws INVALID_ARGUMENT naming parameter, expected, got.
std::vector<std::uint64_t> readDescriptor(const TechniqueEntry& entry, const void* desc);

}  // namespace lightwell
