// How long the commands that were recorded between two moments took, looked at later: nothing waits for it.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "compute/cl.h"

namespace lightwell {

class Executor;

// On the device's clock where its queue profiles: from the first command's start to the last one's end. Else on the host's: from begin()
// to when the device is done with what was recorded before end(), less what it was still busy with at begin().
class CallSpan {
public:
    CallSpan() = default;
    ~CallSpan();
    CallSpan(CallSpan&& other) noexcept;
    CallSpan& operator=(CallSpan&& other) noexcept;

    void begin(Executor& executor);
    void end(Executor& executor);  // before the queue is flushed

    bool isDone() const;  // the device has, or has failed
    // Once that is so; NaN where it cannot be told. `doneBefore`: when the span before was done on the host's clock, and then this one
    // was; 0: never.
    double milliseconds(std::int64_t& doneBefore) const;

private:
    void release();

    std::size_t firstEntry_ = 0;
    cl_event first_ = nullptr, last_ = nullptr;  // on the device's clock
    cl_event marker_ = nullptr;                  // on the host's
    std::int64_t begun_ = 0;                     // ns
    std::shared_ptr<std::atomic<std::int64_t>> done_;  // ns; 0: not yet
    bool isEmpty_ = true;
};

}  // namespace lightwell
