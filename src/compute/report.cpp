#include "compute/report.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "compute/device.h"
#include "compute/executor.h"

namespace lightwell {

Report::~Report() {
    if (!pending_.empty() || !pendingChoices_.empty())
        clFinish(device_->queue());  // the device may still write the values
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
    pending_.push_back({indexOf(name), std::make_unique<cl_uint>(0)});
    enqueueRead(device, buffer, byteOffset, pending_.back().value.get());
}

void Report::readChoice(Device& device, const char* name, const Buffer& buffer, std::size_t byteOffset,
                        const char* const* reasons, std::uint32_t reasonCount) {
    pendingChoices_.push_back({name, reasons, reasonCount, std::make_unique<cl_uint>(reasonCount)});
    enqueueRead(device, buffer, byteOffset, pendingChoices_.back().value.get());
}

void Report::enqueueRead(Device& device, const Buffer& buffer, std::size_t byteOffset, cl_uint* value) {
    device_ = &device;
    Profile untimed;
    Executor(device, untimed).read("report.read", buffer.get(), byteOffset, sizeof(cl_uint), value);
}

void Report::choose(const char* name, const char* reason) {
    for (const LWChoice& choice : choices)
        if (std::strcmp(choice.name, name) == 0 && std::strcmp(choice.reason, reason) == 0) return;
    choices.push_back({name, reason});
}

void Report::chooseText(const char* name, std::string reason) { choose(name, keep(std::move(reason))); }

const char* Report::keep(std::string name) {
    names_.push_back(std::move(name));
    return names_.back().c_str();
}

void Report::add(const std::string& part, Report other) {
    const auto named = [&](const char* name) { return keep(part + "." + name); };
    const std::size_t first = counts.size();
    if (other.device_) device_ = other.device_;  // before what is pending: should memory run out here, both wait for it
    for (const LWCount& count : other.counts) counts.push_back({named(count.name), count.value});
    for (const LWChoice& choice : other.choices) choices.push_back({named(choice.name), choice.reason});
    for (Pending& pending : other.pending_) pending_.push_back({first + pending.count, std::move(pending.value)});
    for (PendingChoice& pending : other.pendingChoices_) {
        pending.name = named(pending.name);
        pendingChoices_.push_back(std::move(pending));
    }
    other.pending_.clear();  // now read for this report
    other.pendingChoices_.clear();
    names_.splice(names_.end(), other.names_);  // reasons may be of a part's own part
}

void Report::resolve() {
    for (const Pending& pending : pending_) counts[pending.count].value += *pending.value;
    pending_.clear();
    for (const PendingChoice& pending : pendingChoices_)
        if (*pending.value < pending.reasonCount) choose(pending.name, pending.reasons[*pending.value]);
    pendingChoices_.clear();
}

}  // namespace lightwell
