#include "compute/report.h"

#include <algorithm>
#include <cstring>

#include "compute/device.h"
#include "compute/executor.h"

namespace lightwell {

Report::~Report() {
    if (!pending_.empty()) clFinish(device_->queue());  // the device may still write the values
}

std::size_t Report::indexOf(const char* name) {
    const auto found = std::find_if(counts.begin(), counts.end(), [&](const LWCount& count) {
        return std::strcmp(count.name, name) == 0;
    });
    if (found != counts.end()) return std::size_t(found - counts.begin());
    counts.push_back({name, 0});
    return counts.size() - 1;
}

void Report::read(Device& device, const char* name, const Buffer& buffer, std::size_t byteOffset) {
    device_ = &device;
    pending_.push_back({indexOf(name), std::make_unique<cl_uint>(0)});
    Profile untimed;
    Executor(device, untimed)
        .read("report.read", buffer.get(), byteOffset, sizeof(cl_uint), pending_.back().value.get());
}

void Report::choose(const char* name, const char* reason) {
    for (const LWChoice& choice : choices)
        if (std::strcmp(choice.name, name) == 0 && std::strcmp(choice.reason, reason) == 0) return;
    choices.push_back({name, reason});
}

void Report::resolve() {
    for (const Pending& pending : pending_) counts[pending.count].value += *pending.value;
    pending_.clear();
}

}  // namespace lightwell
