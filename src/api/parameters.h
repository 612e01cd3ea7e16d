// A technique's descriptor, checked against the parameters that the technique declares.
#pragma once

#include <memory>
#include <vector>

#include "api/objects.h"
#include "techniques/technique.h"

namespace lightwell {

class Call;

// The descriptor at the technique's size (`desc` null: its defaults). A zero that a parameter does not
// allow means the default. Throws INVALID_ARGUMENT naming parameter, expected, got.
std::vector<std::uint64_t> readDescriptor(const TechniqueEntry& entry, const void* desc);

// The techniques that a descriptor names, in the order of the parameters. Throws INVALID_ARGUMENT for null and
// where one stands twice in the tree, INVALID_HANDLE for what is no technique of this device.
std::vector<std::shared_ptr<TechniqueObject>> partsOf(Call& call, const TechniqueEntry& entry,
                                                      const std::vector<std::uint64_t>& descriptor);

}  // namespace lightwell
