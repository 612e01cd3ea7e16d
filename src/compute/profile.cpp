// Device times of passes, from event timestamps.
#include <algorithm>
#include <cstring>

#include "compute/executor.h"

namespace lightwell {
namespace {

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
}

void Profile::add(const char* pass, cl_event event) {
    entries_.push_back({pass, event});
}

std::vector<LWPassTime> Profile::passes() const {
    std::vector<LWPassTime> passes;
    for (const Entry& entry : entries_) {
        auto pass = std::find_if(passes.begin(), passes.end(), [&](const LWPassTime& candidate) {
            return std::strcmp(candidate.name, entry.pass) == 0;
        });
        if (pass == passes.end()) pass = passes.insert(passes.end(), LWPassTime{entry.pass, 0.0, 0});
        ++pass->launches;
        cl_ulong start = 0, end = 0;
        if (pass->milliseconds >= 0.0 && times(entry.event, start, end))
            pass->milliseconds += double(end - start) * 1e-6;
        else
            pass->milliseconds = -1.0;
    }
    return passes;
}

double Profile::totalMilliseconds() const {
    cl_ulong first = ~cl_ulong(0), last = 0;
    for (const Entry& entry : entries_) {
        cl_ulong start = 0, end = 0;
        if (!times(entry.event, start, end)) return -1.0;
        first = std::min(first, start);
        last = std::max(last, end);
    }
    return entries_.empty() ? -1.0 : double(last - first) * 1e-6;
}

}  // namespace lightwell
