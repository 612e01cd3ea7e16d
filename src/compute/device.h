// One OpenCL device: context, queue, limits, program cache, log.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "compute/cl.h"
#include "compute/event_watch.h"
#include "compute/program.h"
#include "lightwell/lightwell.h"

namespace lightwell {

// A place in the queue.
class Marker {
public:
    explicit Marker(cl_event event) : event_(event) {}  // takes the event over
    ~Marker() { clReleaseEvent(event_); }
    Marker(const Marker&) = delete;
    Marker& operator=(const Marker&) = delete;
    // Until the queue gets there, from any thread and without the API's lock. False when that is not sure, as
    // something has failed; what, is told by Device::settle.
    bool wait() const { return clWaitForEvents(1, &event_) == CL_SUCCESS; }

private:
    cl_event event_;
};

// Not thread-safe: src/api serialises the calls on one device.
class Device {
public:
    explicit Device(const LWDeviceDesc& desc);
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    cl_context context() const { return context_; }
    cl_command_queue queue() const { return queue_; }
    cl_device_id id() const { return id_; }

    std::uint32_t width() const { return width_; }  // lanes per work-item of wide kernels
    bool unifiedMemory() const { return unifiedMemory_; }
    bool hasFma() const { return hasFma_; }  // fused multiply-add in hardware, by the driver's word
    bool profiling() const { return profiling_; }
    bool outOfOrder() const { return outOfOrder_; }
    std::uint64_t maxAllocation() const { return maxAllocation_; }
    std::uint64_t globalMemory() const { return globalMemory_; }
    std::uint32_t computeUnits() const { return computeUnits_; }
    ProgramCache& programs() { return *programs_; }

    // Platform, device and driver with their versions: what a program binary depends on.
    const std::string& identity() const { return identity_; }

    void log(LWLogLevel level, const std::string& message) const;
    bool insideLog() const;        // this thread is inside the device's log callback
    static bool insideAnyLog();    // ... of any device
    void describe(LWDeviceInfo& info) const;
    void raiseFailure();  // throws DEVICE when a command is known to have failed; waits for nothing
    void finish();  // clFinish, then as settle()
    Marker mark();  // behind everything enqueued so far, on its way to the device
    // After a marker was waited for: throws DEVICE when a command has failed; saves new binaries when
    // everything enqueued has ended.
    void settle();

    void countAllocation(std::int64_t bytes) { allocatedBytes_ += std::uint64_t(bytes); }
    std::uint64_t allocatedBytes() const { return allocatedBytes_; }
    void countSpecialisation() { ++kernelsSpecialised_; }
    void watch(cl_event event) { watch_.add(event); }  // finish() reports its failure
    const EventWatch& watched() const { return watch_; }
    std::uint64_t failures() const { return watch_.failures(); }  // of commands, noticed since creation
    void warnOfCache(const std::string& problem);  // once per device
    std::optional<LWRoofline>& roofline() { return roofline_; }  // knownRoofline's (roofline.h)

private:
    void open(const LWDeviceDesc& desc);
    void adopt(const LWDeviceDesc& desc);
    void readLimits();
    std::uint32_t chooseWidth(const LWDeviceDesc& desc);
    void release();

    cl_platform_id platform_ = nullptr;
    cl_device_id id_ = nullptr;
    cl_device_id subDevice_ = nullptr;  // owned when a compute-unit limit is set
    cl_context context_ = nullptr;
    cl_command_queue queue_ = nullptr;
    std::uint32_t width_ = 0, computeUnits_ = 0;
    bool unifiedMemory_ = false, hasFma_ = false, profiling_ = false, outOfOrder_ = false;
    std::uint64_t maxAllocation_ = 0, globalMemory_ = 0, allocatedBytes_ = 0, kernelsSpecialised_ = 0;
    LWLogCallback log_ = nullptr;
    void* logUser_ = nullptr;
    bool warnedOfCache_ = false;
    std::string identity_;
    std::optional<LWRoofline> roofline_;
    EventWatch watch_;
    std::unique_ptr<ProgramCache> programs_;
};

std::uint32_t countDevices();
void describeDevice(std::uint32_t index, LWDeviceInfo& info);  // throws INVALID_ARGUMENT past the last

// The widths that kernels can be built for: 1, 4, 8, 16.
bool isWidth(std::uint32_t width);

// Times one bounded gather at widths 1, 8 and 16 on a queue of its own and returns the fastest.
std::uint32_t probeWidth(Device& device);

}  // namespace lightwell
