#include "device_handles.h"

#include <fmt/format.h>

#include "cli.h"

namespace cli {
namespace {

std::string lastError(LWDevice device, LWStatus status) {
    const char* message = nullptr;
    lwGetLastError(device, &message);
    return fmt::format("{}: {}", lwStatusName(status), message == nullptr ? "" : message);
}

std::string deviceNames() {
    std::uint32_t count = 0;
    check(nullptr, lwCountDevices(&count));
    std::vector<std::string> names;
    for (std::uint32_t i = 0; i < count; ++i) {
        LWDeviceInfo info = sized<LWDeviceInfo>();
        check(nullptr, lwDescribeDevice(i, &info));
        names.push_back(fmt::format("'{}' of '{}'", info.name, info.platform));
    }
    return names.empty() ? "none; install an OpenCL driver, e.g. pocl-opencl-icd" : joinNames(names);
}

}  // namespace

void check(LWDevice device, LWStatus status) {
    if (status != LW_SUCCESS) throw std::runtime_error(lastError(device, status));
}

DeviceHandle openDevice(const std::string& selector, std::uint32_t width) {
    LWDeviceDesc desc = sized<LWDeviceDesc>();
    lwDefaultDevice(&desc);
    if (!selector.empty()) desc.selector = selector.c_str();
    desc.width = width;
    LWDevice device = nullptr;
    const LWStatus status = lwCreateDevice(&desc, &device);
    if (status == LW_ERROR_NO_DEVICE && !selector.empty())
        throw UsageError(
            fmt::format("--device '{}': no such device; valid: gpu, cpu, PLATFORM:DEVICE indices, or "
                        "part of a name; present: {}",
                        selector, deviceNames()));
    check(nullptr, status);
    return DeviceHandle(device);
}

LWDeviceInfo deviceInfo(LWDevice device) {
    LWDeviceInfo info = sized<LWDeviceInfo>();
    check(device, lwGetDeviceInfo(device, &info));
    return info;
}

}  // namespace cli
