// Finds OpenCL devices and reads their properties.
#pragma once

#include <string>
#include <vector>

#include "compute/cl.h"
#include "compute/error.h"
#include "lightwell/lightwell.h"

namespace lightwell {

struct FoundDevice {
    cl_platform_id platform = nullptr;
    cl_device_id id = nullptr;
    std::uint32_t platformIndex = 0, deviceIndex = 0;
};

// Every device of every platform, in the ICD loader's order.
std::vector<FoundDevice> findDevices();

// The device that `selector` (null: LIGHTWELL_DEVICE, else the best) names. Throws NO_DEVICE with a list
// of what was found.
FoundDevice selectDevice(const char* selector);

std::string deviceString(cl_device_id device, cl_device_info what);
std::string platformString(cl_platform_id platform, cl_platform_info what);
template <class T>
T deviceValue(cl_device_id device, cl_device_info what) {
    T value{};
    checkCl(clGetDeviceInfo(device, what, sizeof value, &value, nullptr), "clGetDeviceInfo");
    return value;
}

// Fills what can be known of a device without a context.
void describeHardware(cl_device_id device, LWDeviceInfo& info);

}  // namespace lightwell
