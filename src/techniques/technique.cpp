#include "techniques/technique.h"

#include "compute/device.h"

namespace lightwell {

Continuity::Continuity(Device& device) : device_(device), failures_(device.failures()) {}

bool Continuity::beginLost() {
    const bool lost = isLost_ || device_.failures() != failures_;
    failures_ = device_.failures();
    isLost_ = false;
    return lost;
}

}  // namespace lightwell
