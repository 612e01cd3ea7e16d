#include "compute/event_watch.h"

#include <utility>

#include "compute/error.h"

namespace lightwell {
namespace {

// Ended events are let go when there are so many.
constexpr std::size_t kCollectAt = 1024;

}  // namespace

void EventWatch::add(cl_event event) {
    if (events_.size() >= kCollectAt) collect();
    if (clRetainEvent(event) == CL_SUCCESS) events_.push_back(event);
}

void EventWatch::collect() {
    while (!events_.empty()) {
        cl_int status = CL_COMPLETE;
        ++queries_;
        const cl_int query = clGetEventInfo(events_.front(), CL_EVENT_COMMAND_EXECUTION_STATUS,
                                            sizeof status, &status, nullptr);
        if (query == CL_SUCCESS && status > CL_COMPLETE) return;
        if (query != CL_SUCCESS || status < 0) noteFailure(clErrorName(query != CL_SUCCESS ? query : status));
        clReleaseEvent(events_.front());
        events_.pop_front();
    }
}

void EventWatch::clear() {
    for (cl_event event : events_) clReleaseEvent(event);
    events_.clear();
}

void EventWatch::noteFailure(const char* name) {
    ++failures_;
    if (failure_.empty()) failure_ = name;
}

std::string EventWatch::takeFailure() {
    return std::exchange(failure_, std::string{});
}

}  // namespace lightwell
