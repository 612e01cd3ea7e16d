// Device selection by kind, index or name.
#include "compute/device_select.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "compute/device.h"

namespace lightwell {
namespace {

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    return text;
}

std::string trimmed(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t\n");
    if (first == std::string::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\n") - first + 1);
}

cl_device_type kind(cl_device_id device) {
    return deviceValue<cl_device_type>(device, CL_DEVICE_TYPE);
}

// Lightwell needs OpenCL 1.2 and a compiler. "OpenCL 1.2 ..." is the format the standard sets.
bool usable(cl_device_id device) {
    unsigned major = 0, minor = 0;
    std::sscanf(deviceString(device, CL_DEVICE_VERSION).c_str(), "OpenCL %u.%u", &major, &minor);
    return (major > 1 || (major == 1 && minor >= 2)) &&
           deviceValue<cl_bool>(device, CL_DEVICE_AVAILABLE) &&
           deviceValue<cl_bool>(device, CL_DEVICE_COMPILER_AVAILABLE);
}

// GPUs before CPUs before the rest. A software GPU calls itself a CPU, so it never outranks a real one.
int rank(cl_device_id device) {
    const cl_device_type type = kind(device);
    return type & CL_DEVICE_TYPE_GPU ? 0 : type & CL_DEVICE_TYPE_CPU ? 1 : 2;
}

std::string indices(const FoundDevice& device) {
    return std::to_string(device.platformIndex) + ":" + std::to_string(device.deviceIndex);
}

bool matches(const FoundDevice& device, const std::string& selector) {
    if (selector.empty() || selector == indices(device)) return true;
    if (selector == "gpu") return kind(device.id) & CL_DEVICE_TYPE_GPU;
    if (selector == "cpu") return kind(device.id) & CL_DEVICE_TYPE_CPU;
    return lower(deviceString(device.id, CL_DEVICE_NAME)).find(selector) != std::string::npos ||
           lower(platformString(device.platform, CL_PLATFORM_NAME)).find(selector) != std::string::npos;
}

std::string listOf(const std::vector<FoundDevice>& devices) {
    if (devices.empty()) return "no OpenCL device was found (is an OpenCL driver installed?)";
    std::string list = "found:";
    for (const FoundDevice& device : devices)
        list += "\n  " + indices(device) + "  " +
                (rank(device.id) == 0   ? "gpu  "
                 : rank(device.id) == 1 ? "cpu  "
                                        : "     ") +
                deviceString(device.id, CL_DEVICE_NAME) + " (" +
                platformString(device.platform, CL_PLATFORM_NAME) +
                (usable(device.id) ? ")" : "; unusable: needs OpenCL 1.2 with a compiler)");
    return list;
}

}  // namespace

std::vector<FoundDevice> findDevices() {
    cl_uint platformCount = 0;
    if (clGetPlatformIDs(0, nullptr, &platformCount) != CL_SUCCESS) return {};
    std::vector<cl_platform_id> platforms(platformCount);
    if (platformCount)
        checkCl(clGetPlatformIDs(platformCount, platforms.data(), nullptr), "clGetPlatformIDs");
    std::vector<FoundDevice> found;
    for (cl_uint p = 0; p < platformCount; ++p) {
        cl_uint count = 0;
        if (clGetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, 0, nullptr, &count) != CL_SUCCESS) continue;
        std::vector<cl_device_id> ids(count);
        checkCl(clGetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, count, ids.data(), nullptr),
                "clGetDeviceIDs");
        for (cl_uint d = 0; d < count; ++d) found.push_back({platforms[p], ids[d], p, d});
    }
    return found;
}

FoundDevice selectDevice(const char* selector) {
    const char* name = "LWDeviceDesc.selector";
    if (!selector || !*selector) {
        selector = std::getenv("LIGHTWELL_DEVICE");
        name = "LIGHTWELL_DEVICE";
    }
    const std::string wanted = selector ? lower(trimmed(selector)) : "";
    const std::vector<FoundDevice> devices = findDevices();
    const FoundDevice* best = nullptr;
    for (const FoundDevice& device : devices)
        if (matches(device, wanted) && usable(device.id) && (!best || rank(device.id) < rank(best->id)))
            best = &device;
    if (best) return *best;
    if (wanted.empty()) fail(LW_ERROR_NO_DEVICE, "no usable OpenCL device; ", listOf(devices));
    fail(LW_ERROR_NO_DEVICE, name, ": expected \"gpu\", \"cpu\", \"P:D\" or a part of a name, got \"",
         selector, "\" which matches no usable device; ", listOf(devices));
}

std::string deviceString(cl_device_id device, cl_device_info what) {
    std::size_t size = 0;
    checkCl(clGetDeviceInfo(device, what, 0, nullptr, &size), "clGetDeviceInfo");
    std::string text(size, '\0');
    if (size) checkCl(clGetDeviceInfo(device, what, size, text.data(), nullptr), "clGetDeviceInfo");
    return trimmed(text.c_str());
}

std::string platformString(cl_platform_id platform, cl_platform_info what) {
    std::size_t size = 0;
    checkCl(clGetPlatformInfo(platform, what, 0, nullptr, &size), "clGetPlatformInfo");
    std::string text(size, '\0');
    if (size)
        checkCl(clGetPlatformInfo(platform, what, size, text.data(), nullptr), "clGetPlatformInfo");
    return trimmed(text.c_str());
}

void describeHardware(cl_device_id device, LWDeviceInfo& info) {
    const auto copy = [](const std::string& text, char* to, std::size_t size) {
        std::snprintf(to, size, "%s", text.c_str());
    };
    info.computeUnits = deviceValue<cl_uint>(device, CL_DEVICE_MAX_COMPUTE_UNITS);
    info.isGpu = (kind(device) & CL_DEVICE_TYPE_GPU) != 0;
    info.hostUnifiedMemory = deviceValue<cl_bool>(device, CL_DEVICE_HOST_UNIFIED_MEMORY) != 0;
    info.hasProfiling = (deviceValue<cl_command_queue_properties>(device, CL_DEVICE_QUEUE_PROPERTIES) &
                         CL_QUEUE_PROFILING_ENABLE) != 0;
    info.globalMemoryBytes = deviceValue<cl_ulong>(device, CL_DEVICE_GLOBAL_MEM_SIZE);
    info.maxAllocationBytes = deviceValue<cl_ulong>(device, CL_DEVICE_MAX_MEM_ALLOC_SIZE);
    copy(deviceString(device, CL_DEVICE_NAME), info.name, sizeof info.name);
    copy(platformString(deviceValue<cl_platform_id>(device, CL_DEVICE_PLATFORM), CL_PLATFORM_NAME),
         info.platform, sizeof info.platform);
    copy(deviceString(device, CL_DRIVER_VERSION), info.driver, sizeof info.driver);
    copy(deviceString(device, CL_DEVICE_VERSION), info.openclVersion, sizeof info.openclVersion);
}

std::uint32_t countDevices() {
    return std::uint32_t(findDevices().size());
}

void describeDevice(std::uint32_t index, LWDeviceInfo& info) {
    const std::vector<FoundDevice> devices = findDevices();
    if (index >= devices.size())
        fail(LW_ERROR_INVALID_ARGUMENT, "index: expected less than ", devices.size(), ", got ", index);
    describeHardware(devices[index].id, info);
}

}  // namespace lightwell
