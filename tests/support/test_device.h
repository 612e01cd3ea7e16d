// Devices of a test's own: fresh ones, and ones over a context and queue that play the host's.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "compute/device.h"

namespace lightwell::test {

struct LogLine {
    LWLogLevel level;
    std::string text;
};

// Collects what a device logs.
class Log {
public:
    std::vector<LogLine> lines;
    std::size_t count(LWLogLevel level) const;
    bool says(const std::string& part) const;
    void attach(LWDeviceDesc& desc);
};

// A descriptor of width 1 without a cache on disk.
LWDeviceDesc plainDesc();

// A device that knows the test programs. `log` (may be null) must outlive it.
std::unique_ptr<Device> freshDevice(const LWDeviceDesc& desc = plainDesc());
std::unique_ptr<Device> freshDevice(const std::string& cacheDirectory, Log* log);
void addTestPrograms(Device& device);

// Whether the platform that LIGHTWELL_DEVICE selects has this name: for defects of drivers.
bool driverIs(const std::string& platform);

// A context and a queue on the device that LIGHTWELL_DEVICE names.
class HostQueue {
public:
    explicit HostQueue(cl_command_queue_properties properties);
    static bool supports(cl_command_queue_properties properties);
    ~HostQueue();
    HostQueue(const HostQueue&) = delete;
    HostQueue& operator=(const HostQueue&) = delete;

    cl_context context() const { return context_; }
    cl_command_queue queue() const { return queue_; }
    std::unique_ptr<Device> adopt() const;  // width 1

private:
    cl_context context_ = nullptr;
    cl_command_queue queue_ = nullptr;
};

}  // namespace lightwell::test
