// A number of the device's that the host looks at a frame late: nothing waits for it.
#pragma once

#include "compute/device.h"
#include "compute/error.h"
#include "compute/executor.h"

namespace lightwell {

// T: plain memory. At most one read is under way.
template <class T>
class LateRead {
public:
    LateRead() = default;
    ~LateRead() {  // the driver still writes what is on its way
        if (!done_) return;
        clWaitForEvents(1, &done_);
        clReleaseEvent(done_);
    }
    LateRead(const LateRead&) = delete;
    LateRead& operator=(const LateRead&) = delete;

    // Has `buffer` read as it stands when the commands enqueued so far have run; not while another read is under way.
    void record(Executor& executor, const char* pass, const Buffer& buffer, std::size_t byteOffset) {
        if (done_) return;
        executor.read(pass, buffer.get(), byteOffset, sizeof(T), &value_);
        const cl_int failed = clEnqueueMarkerWithWaitList(executor.device().queue(), 0, nullptr, &done_);
        if (failed == CL_SUCCESS) return;
        done_ = nullptr;
        clFinish(executor.device().queue());
        checkCl(failed, "clEnqueueMarkerWithWaitList");
    }
    bool isPending() const { return done_ != nullptr; }  // a read that take() has not had yet
    // What has come since the last call; null where nothing has, or commands failed.
    const T* take() {
        if (!done_) return nullptr;
        cl_int status = CL_QUEUED;
        clGetEventInfo(done_, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof status, &status, nullptr);
        if (status > CL_COMPLETE) return nullptr;
        clReleaseEvent(done_);
        done_ = nullptr;
        return status == CL_COMPLETE ? &value_ : nullptr;
    }

private:
    T value_{};
    cl_event done_ = nullptr;
};

}  // namespace lightwell
