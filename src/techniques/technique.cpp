#include "techniques/technique.h"

#include <cstring>
#include <string>

#include "compute/device.h"

namespace lightwell {

Continuity::Continuity(Device& device) : device_(device), failures_(device.failures()) {}

bool Continuity::beginLost() {
    const std::uint64_t failures = device_.failures();  // once: another may happen meanwhile, which the next update's is
    const bool lost = isLost_ || failures != failures_;
    failures_ = failures;
    isLost_ = false;
    return lost;
}

const TechniqueEntry& findTechniqueEntry(const char* name) {
    if (!name) fail(LW_ERROR_INVALID_ARGUMENT, "name: expected a technique's name, got null");
    std::string names;
    for (const TechniqueEntry& entry : techniqueEntries()) {
        if (std::strcmp(entry.info.name, name) == 0) return entry;
        names += (names.empty() ? "" : ", ") + std::string(entry.info.name);
    }
    fail(LW_ERROR_INVALID_ARGUMENT, "name: expected one of ", names, ", got \"",
         std::string(name).substr(0, 64), "\"");
}

}  // namespace lightwell
