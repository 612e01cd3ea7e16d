// Entry points: library, devices.
#include "api/call.h"
#include "api/structs.h"
#include "compute/roofline.h"

using namespace lightwell;

#define LW_TEXT_(x) #x
#define LW_TEXT(x) LW_TEXT_(x)

const char* lwStatusName(LWStatus status) {
    switch (status) {
        case LW_SUCCESS:
            return "LW_SUCCESS";
        case LW_ERROR_INVALID_ARGUMENT:
            return "LW_ERROR_INVALID_ARGUMENT";
        case LW_ERROR_INVALID_HANDLE:
            return "LW_ERROR_INVALID_HANDLE";
        case LW_ERROR_OUT_OF_MEMORY:
            return "LW_ERROR_OUT_OF_MEMORY";
        case LW_ERROR_UNSUPPORTED:
            return "LW_ERROR_UNSUPPORTED";
        case LW_ERROR_NO_DEVICE:
            return "LW_ERROR_NO_DEVICE";
        case LW_ERROR_BUILD_FAILED:
            return "LW_ERROR_BUILD_FAILED";
        case LW_ERROR_DEVICE:
            return "LW_ERROR_DEVICE";
        case LW_ERROR_NOT_UPDATED:
            return "LW_ERROR_NOT_UPDATED";
        case LW_ERROR_REENTRANT:
            return "LW_ERROR_REENTRANT";
        case LW_ERROR_INTERNAL:
            return "LW_ERROR_INTERNAL";
    }
    return "unknown LWStatus";
}

const char* lwVersion(void) {
    return LW_TEXT(LW_VERSION_MAJOR) "." LW_TEXT(LW_VERSION_MINOR) "." LW_TEXT(LW_VERSION_PATCH);
}

LWStatus lwGetLastError(LWDevice device, const char** message) {
    return takeError(device, message);
}

void lwDefaultDevice(LWDeviceDesc* desc) {
    if (desc) LW_INIT(*desc);
}

LWStatus lwCreateDevice(const LWDeviceDesc* desc, LWDevice* device) {
    return enter("lwCreateDevice", [&](Call&) {
        if (!device)
            fail(LW_ERROR_INVALID_ARGUMENT, "device: expected an address for the handle, got null");
        *device = nullptr;
        LWDeviceDesc own{};
        lwDefaultDevice(&own);
        if (desc) own = readStruct(desc, "desc");
        if (!own.clContext != !own.clQueue)
            fail(LW_ERROR_INVALID_ARGUMENT,
                 "desc.clContext, desc.clQueue: expected both or neither, got one");
        *device =
            static_cast<LWDevice>(addHandle(HandleKind::kDevice, std::make_shared<DeviceObject>(own)));
    });
}

LWStatus lwRetainDevice(LWDevice device) {
    return enter("lwRetainDevice", [&](Call&) { retainHandle(HandleKind::kDevice, device, "device"); });
}

LWStatus lwReleaseDevice(LWDevice device) {
    return enter("lwReleaseDevice",
                 [&](Call&) { releaseHandle(HandleKind::kDevice, device, "device"); });
}

LWStatus lwGetDeviceInfo(LWDevice device, LWDeviceInfo* info) {
    return enter("lwGetDeviceInfo", [&](Call& call) {
        Device& own = call.device(device);
        const std::uint32_t size = checkedStructSize(info, "info");
        LWDeviceInfo result{};
        own.describe(result);
        writeStruct(info, size, result);
    });
}

LWStatus lwCountDevices(std::uint32_t* count) {
    return enter("lwCountDevices", [&](Call&) {
        if (!count) fail(LW_ERROR_INVALID_ARGUMENT, "count: expected an address, got null");
        *count = countDevices();
    });
}

LWStatus lwDescribeDevice(std::uint32_t index, LWDeviceInfo* info) {
    return enter("lwDescribeDevice", [&](Call&) {
        const std::uint32_t size = checkedStructSize(info, "info");
        LWDeviceInfo result{};
        describeDevice(index, result);
        writeStruct(info, size, result);
    });
}

LWStatus lwProbeDevice(LWDevice device, LWRoofline* roofline) {
    return enter("lwProbeDevice", [&](Call& call) {
        Device& own = call.device(device);
        const std::uint32_t size = checkedStructSize(roofline, "roofline");
        writeStruct(roofline, size, renewRoofline(own));
    });
}

LWStatus lwFinish(LWDevice device) {
    return enter("lwFinish", [&](Call& call) {
        call.device(device);
        call.settle();
    });
}
