// Lightwell's handles and errors as the commands use them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "lightwell/lightwell.h"

namespace cli {

// A zeroed struct of the API with its size set.
template <class T>
T sized() {
    T value{};
    value.structSize = std::uint32_t(sizeof(T));
    return value;
}

template <class T, LWStatus (*release)(T)>
struct Releaser {
    using pointer = T;
    void operator()(T handle) const { release(handle); }
};
using DeviceHandle =
    std::unique_ptr<std::remove_pointer_t<LWDevice>, Releaser<LWDevice, lwReleaseDevice>>;
using ViewHandle = std::unique_ptr<std::remove_pointer_t<LWView>, Releaser<LWView, lwReleaseView>>;
using TechniqueHandle =
    std::unique_ptr<std::remove_pointer_t<LWTechnique>, Releaser<LWTechnique, lwReleaseTechnique>>;

// Throws std::runtime_error with the library's message unless `status` is LW_SUCCESS.
void check(LWDevice device, LWStatus status);

// `selector` as LWDeviceDesc::selector ("" = its default), `width` 0 = by probe. An unknown selector
// is a UsageError that lists the devices.
DeviceHandle openDevice(const std::string& selector, std::uint32_t width);
LWDeviceInfo deviceInfo(LWDevice device);

}  // namespace cli
