// What stands behind the API's handles.
#pragma once

#include <algorithm>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "compute/device.h"
#include "compute/executor.h"
#include "lightwell/lightwell.h"
#include "techniques/technique.h"

namespace lightwell {

struct Object {
    virtual ~Object() = default;
};

struct DeviceObject : Object {
    explicit DeviceObject(const LWDeviceDesc& desc) : device(desc) {}

    // Keeps the first error until it is fetched.
    void keepError(LWStatus status, const std::string& message) {
        const std::lock_guard<std::mutex> lock(errorMutex);
        if (errorStatus != LW_SUCCESS) return;
        errorStatus = status;
        errorMessage = message;
    }

    std::mutex mutex;  // serialises every call on the device; taken before the errors' mutex
    Device device;

    std::mutex errorMutex;
    LWStatus errorStatus = LW_SUCCESS;
    std::string errorMessage;
};

// Children name their device first, so that it goes last.
struct ViewObject : Object {
    ViewObject(std::shared_ptr<DeviceObject> owner, std::uint32_t maxWidth, std::uint32_t maxHeight)
        : device(std::move(owner)), view(std::make_shared<View>(maxWidth, maxHeight)) {}

    std::shared_ptr<DeviceObject> device;
    std::shared_ptr<View> view;
};

// The times and copies of the frame since one lwUpdate.
struct FrameRecord {
    explicit FrameRecord(Device& device) : executor(device, profile) {}
    Profile profile;
    Executor executor;
};

struct TechniqueObject : Object {
    std::shared_ptr<DeviceObject> device;
    std::unique_ptr<Technique> technique;
    std::unique_ptr<FrameRecord> record;  // of the last lwUpdate; null before the first
    bool begun = false;    // an lwUpdate was recorded, or failed on the way
    bool updated = false;  // ... and the last one succeeded
    bool broken = false;   // the last one, its own or that of what it is part of, left its world part half made
    std::uint64_t failures = 0;  // that the device had seen at the last lwUpdate
    std::uint64_t frameIndex = 0;

    // What it was made of, to estimate its memory again as a part of another.
    const TechniqueEntry* entry = nullptr;
    std::vector<std::uint64_t> descriptor;
    std::vector<std::shared_ptr<TechniqueObject>> parts;

    // Whether the world part is what the last lwUpdate recorded. A command that failed may have been one of it.
    bool current() const { return updated && failures == device->device.failures() && isWhole(); }
    // Nothing of it, and of its parts, was left half updated.
    bool isWhole() const {
        return !broken && std::all_of(parts.begin(), parts.end(), [](const auto& part) { return part->isWhole(); });
    }
    void breakOff() {
        setBroken(true);
        lose();
    }
    // See Technique::lose.
    void lose() {
        technique->lose();
        for (const auto& part : parts) part->lose();
    }
    void setBroken(bool is) {
        broken = is;
        for (const auto& part : parts) part->setBroken(is);
    }
    // What it and its parts keep is relative to this now, whoever renders with a part next.
    void setOrigin(const WorldOrigin& origin) {
        if (record) record->executor.setWorldOrigin(origin);
        for (const auto& part : parts) part->setOrigin(origin);
    }

    // What the last lwGetStats pointed to.
    std::vector<LWPassTime> passes;
    Report report;
};

}  // namespace lightwell
