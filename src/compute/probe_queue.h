// An in-order queue of its own for measurements, so that a host's queue is neither waited on nor timed.
#pragma once

#include <chrono>

#include "compute/buffer.h"
#include "compute/device.h"
#include "compute/error.h"

namespace lightwell {

class ProbeQueue {
public:
    explicit ProbeQueue(Device& device) : device_(device) {
        cl_int status = CL_SUCCESS;
        queue_ = clCreateCommandQueue(device.context(), device.id(), 0, &status);
        checkCl(status, "clCreateCommandQueue");
    }
    ~ProbeQueue() { clReleaseCommandQueue(queue_); }
    ProbeQueue(const ProbeQueue&) = delete;
    ProbeQueue& operator=(const ProbeQueue&) = delete;

    cl_command_queue get() const { return queue_; }

    // Enqueues `kernel` with these arguments `times` times.
    template <class... Args>
    void enqueue(Kernel& kernel, std::size_t global, std::size_t local, int times, const Args&... args) {
        cl_uint index = 0;
        if (kernel.noteLaunch({global, 1}, {local, 1})) device_.countSpecialisation();
        (checkCl(clSetKernelArg(kernel.get(), index++, sizeof args, &args), "clSetKernelArg"), ...);
        for (int i = 0; i < times; ++i)
            checkCl(clEnqueueNDRangeKernel(queue_, kernel.get(), 1, nullptr, &global, &local, 0, nullptr,
                                           nullptr),
                    kernel.name().c_str());
    }

    void finish() { checkCl(clFinish(queue_), "clFinish"); }

private:
    Device& device_;
    cl_command_queue queue_ = nullptr;
};

class Stopwatch {
public:
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
};

}  // namespace lightwell
