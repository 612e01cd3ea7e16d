#include "support/test_device.h"

#include "compute/device_select.h"
#include "support/test_programs.h"

namespace lightwell::test {

std::size_t Log::count(LWLogLevel level) const {
    std::size_t found = 0;
    for (const LogLine& line : lines) found += line.level == level;
    return found;
}

bool Log::says(const std::string& part) const {
    for (const LogLine& line : lines)
        if (line.text.find(part) != std::string::npos) return true;
    return false;
}

void Log::attach(LWDeviceDesc& desc) {
    desc.logUser = this;
    desc.log = [](void* user, LWLogLevel level, const char* message) {
        static_cast<Log*>(user)->lines.push_back({level, message});
    };
}

LWDeviceDesc plainDesc() {
    LWDeviceDesc desc{};
    desc.structSize = sizeof desc;
    desc.width = 1;
    desc.cacheDirectory = "";
    return desc;
}

void addTestPrograms(Device& device) {
    for (std::size_t i = 0; i < kTestProgramsCount; ++i)
        device.programs().addSource(
            kTestPrograms[i].name,
            std::string(reinterpret_cast<const char*>(kTestPrograms[i].bytes), kTestPrograms[i].size));
}

std::unique_ptr<Device> freshDevice(const LWDeviceDesc& desc) {
    auto device = std::make_unique<Device>(desc);
    addTestPrograms(*device);
    return device;
}

std::unique_ptr<Device> freshDevice(const std::string& cacheDirectory, Log* log) {
    LWDeviceDesc desc = plainDesc();
    desc.cacheDirectory = cacheDirectory.c_str();
    if (log) log->attach(desc);
    return freshDevice(desc);
}

bool driverIs(const std::string& platform) {
    return platformString(selectDevice(nullptr).platform, CL_PLATFORM_NAME) == platform;
}

bool HostQueue::supports(cl_command_queue_properties properties) {
    const auto supported =
        deviceValue<cl_command_queue_properties>(selectDevice(nullptr).id, CL_DEVICE_QUEUE_PROPERTIES);
    return (supported & properties) == properties;
}

HostQueue::HostQueue(cl_command_queue_properties properties) {
    const FoundDevice found = selectDevice(nullptr);
    cl_int status = CL_SUCCESS;
    context_ = clCreateContext(nullptr, 1, &found.id, nullptr, nullptr, &status);
    checkCl(status, "clCreateContext");
    queue_ = clCreateCommandQueue(context_, found.id, properties, &status);
    checkCl(status, "clCreateCommandQueue");
}

HostQueue::~HostQueue() {
    clReleaseCommandQueue(queue_);
    clReleaseContext(context_);
}

std::unique_ptr<Device> HostQueue::adopt() const {
    LWDeviceDesc desc = plainDesc();
    desc.clContext = context_;
    desc.clQueue = queue_;
    return freshDevice(desc);
}

}  // namespace lightwell::test
