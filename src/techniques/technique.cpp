#include "techniques/technique.h"

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

}  // namespace lightwell
