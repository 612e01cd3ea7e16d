// Device times of passes, from event timestamps.
#include <algorithm>
#include <cstring>

#include "compute/executor.h"

namespace lightwell {
namespace {

// Some hundred frames; beyond them, completed commands are summed up.
constexpr std::size_t kMostEntries = 4096;

// Start and end in nanoseconds; false when the event was not timed or has not completed.
bool times(cl_event event, cl_ulong& start, cl_ulong& end) {
    return event &&
           clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_START, sizeof start, &start, nullptr) ==
               CL_SUCCESS &&
           clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof end, &end, nullptr) ==
               CL_SUCCESS;
}

}  // namespace

Profile::~Profile() {
    clear();
}

void Profile::clear() {
    for (const Entry& entry : entries_)
        if (entry.event) clReleaseEvent(entry.event);
    entries_.clear();
    folded_ = Sums{};
}

void Profile::add(const char* pass, cl_event event) {
    if (entries_.size() >= kMostEntries) fold();
    entries_.push_back({pass, event});
}

// Sums up the commands that have completed: a host that updates a still world once and renders for hours
// must not pile up events.
void Profile::fold() {
    std::size_t count = 0;
    for (; count < entries_.size(); ++count) {
        const Entry& entry = entries_[count];
        cl_int status = CL_COMPLETE;
        if (entry.event && clGetEventInfo(entry.event, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof status,
                                          &status, nullptr) == CL_SUCCESS &&
            status > CL_COMPLETE)
            break;
        folded_.add(entry);
        if (entry.event) clReleaseEvent(entry.event);
    }
    entries_.erase(entries_.begin(), entries_.begin() + std::ptrdiff_t(count));
}

void Profile::Sums::add(const Entry& entry) {
    auto pass = std::find_if(passes.begin(), passes.end(), [&](const LWPassTime& candidate) {
        return std::strcmp(candidate.name, entry.pass) == 0;
    });
    if (pass == passes.end()) pass = passes.insert(passes.end(), LWPassTime{entry.pass, 0.0, 0});
    ++pass->launches;
    cl_ulong start = 0, end = 0;
    if (!times(entry.event, start, end)) {
        pass->milliseconds = -1.0;
        untimed = true;
        return;
    }
    if (pass->milliseconds >= 0.0) pass->milliseconds += double(end - start) * 1e-6;
    first = std::min(first, start);
    last = std::max(last, end);
}

Profile::Sums Profile::sums() const {
    Sums all = folded_;
    for (const Entry& entry : entries_) all.add(entry);
    return all;
}

std::unique_ptr<Profile> Profile::snapshot() const {
    auto copy = std::make_unique<Profile>();
    copy->folded_ = folded_;
    copy->entries_.reserve(entries_.size());
    for (const Entry& entry : entries_) {
        const bool held = entry.event && clRetainEvent(entry.event) == CL_SUCCESS;
        copy->entries_.push_back({entry.pass, held ? entry.event : nullptr});
    }
    return copy;
}

void Profile::retainEnds(std::size_t firstEntry, cl_event& first, cl_event& last) const {
    const auto retained = [](cl_event event) { return event && clRetainEvent(event) == CL_SUCCESS ? event : nullptr; };
    first = last = nullptr;
    if (firstEntry >= entries_.size()) return;
    first = retained(entries_[firstEntry].event);
    last = retained(entries_.back().event);
}

std::vector<LWPassTime> Profile::passes() const {
    return sums().passes;
}

double Profile::totalMilliseconds() const {
    const Sums all = sums();
    return all.untimed || all.passes.empty() ? -1.0 : double(all.last - all.first) * 1e-6;
}

}  // namespace lightwell
