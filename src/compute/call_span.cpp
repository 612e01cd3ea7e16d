#include "compute/call_span.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "compute/device.h"
#include "compute/executor.h"

namespace lightwell {
namespace {

using Moment = std::shared_ptr<std::atomic<std::int64_t>>;

std::int64_t nowNanoseconds() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// From the driver's thread. It may come after the span has gone: the moment is held by both.
void CL_CALLBACK noteMoment(cl_event, cl_int, void* user) {
    const std::unique_ptr<Moment> moment(static_cast<Moment*>(user));
    (*moment)->store(nowNanoseconds());
}

bool hasEnded(cl_event event) {
    cl_int status = CL_QUEUED;
    return clGetEventInfo(event, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof status, &status, nullptr) != CL_SUCCESS || status <= CL_COMPLETE;
}

}  // namespace

CallSpan::~CallSpan() { release(); }

CallSpan::CallSpan(CallSpan&& other) noexcept { *this = std::move(other); }

CallSpan& CallSpan::operator=(CallSpan&& other) noexcept {
    if (this == &other) return *this;
    release();
    firstEntry_ = other.firstEntry_;
    first_ = std::exchange(other.first_, nullptr);
    last_ = std::exchange(other.last_, nullptr);
    marker_ = std::exchange(other.marker_, nullptr);
    begun_ = other.begun_;
    done_ = std::move(other.done_);
    isEmpty_ = other.isEmpty_;
    return *this;
}

void CallSpan::release() {
    for (cl_event* event : {&first_, &last_, &marker_}) {
        if (*event) clReleaseEvent(*event);
        *event = nullptr;
    }
}

void CallSpan::begin(Executor& executor) {
    release();
    isEmpty_ = true;
    firstEntry_ = executor.profile().heldEntries();
    begun_ = nowNanoseconds();
}

void CallSpan::end(Executor& executor) {
    if (executor.profile().heldEntries() <= firstEntry_) return;  // nothing was recorded, or it has been summed up already
    isEmpty_ = false;
    if (executor.device().profiling()) {
        executor.profile().retainEnds(firstEntry_, first_, last_);
        return;
    }
    if (clEnqueueMarkerWithWaitList(executor.device().queue(), 0, nullptr, &marker_) != CL_SUCCESS) {
        marker_ = nullptr;
        return;
    }
    done_ = std::make_shared<std::atomic<std::int64_t>>(0);
    auto moment = std::make_unique<Moment>(done_);
    if (clSetEventCallback(marker_, CL_COMPLETE, noteMoment, moment.get()) == CL_SUCCESS) moment.release();
    else done_.reset();
}

bool CallSpan::isDone() const {
    if (marker_) return hasEnded(marker_) && (!done_ || done_->load() != 0);
    return !last_ || hasEnded(last_);
}

double CallSpan::milliseconds(std::int64_t& doneBefore) const {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    if (isEmpty_) return 0.0;
    if (marker_) {
        if (!done_) return kNone;
        const std::int64_t from = std::max(begun_, doneBefore);
        doneBefore = done_->load();
        return double(doneBefore - from) * 1e-6;
    }
    cl_ulong start = 0, end = 0;
    if (!first_ || !last_ ||
        clGetEventProfilingInfo(first_, CL_PROFILING_COMMAND_START, sizeof start, &start, nullptr) != CL_SUCCESS ||
        clGetEventProfilingInfo(last_, CL_PROFILING_COMMAND_END, sizeof end, &end, nullptr) != CL_SUCCESS || end < start)
        return kNone;
    return double(end - start) * 1e-6;
}

}  // namespace lightwell
