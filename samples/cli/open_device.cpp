#include "open_device.h"

#include <fmt/format.h>

#include <cstdlib>

#include "cli.h"

namespace cli {
namespace {

std::string deviceNames() {
    std::uint32_t count = 0;
    lightwell::check(lwCountDevices(&count));
    std::vector<std::string> names;
    for (std::uint32_t i = 0; i < count; ++i) {
        auto info = lightwell::make<LWDeviceInfo>();
        lightwell::check(lwDescribeDevice(i, &info));
        names.push_back(fmt::format("'{}' of '{}'", info.name, info.platform));
    }
    return names.empty() ? "none; install an OpenCL driver, e.g. pocl-opencl-icd" : joinNames(names);
}

}  // namespace

lightwell::Device openDevice(const std::string& selector, std::uint32_t width) {
    LWDeviceDesc desc = lightwell::Device::defaults();
    if (!selector.empty()) desc.selector = selector.c_str();
    desc.width = width;
    try {
        return lightwell::Device(desc);
    } catch (const lightwell::Error& error) {
        // Without --device the message speaks of the variable, LIGHTWELL_DEVICE or LIGHTWELL_WIDTH.
        if (error.status() == LW_ERROR_INVALID_ARGUMENT ||
            (selector.empty() && std::getenv("LIGHTWELL_DEVICE") != nullptr))
            throw UsageError(error.what());
        if (error.status() != LW_ERROR_NO_DEVICE) throw;
        throw UsageError(
            fmt::format("--device '{}': no such device; valid: gpu, cpu, PLATFORM:DEVICE indices, or "
                        "part of a name; present: {}",
                        selector, deviceNames()));
    }
}

}  // namespace cli
