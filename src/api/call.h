// The frame of every entry point: refuse calls from log callbacks, find and lock the device, turn
// exceptions into a status and a kept message.
#pragma once

#include <memory>
#include <mutex>

#include "api/handles.h"
#include "api/objects.h"

namespace lightwell {

// One API call. Objects that a call's body holds are let go before its lock, the lock before the device.
class Call {
public:
    // Finds a handle, and locks its device until the call ends. Once per call.
    Device& device(LWDevice handle);
    std::shared_ptr<ViewObject> view(LWView handle);
    std::shared_ptr<TechniqueObject> technique(LWTechnique handle);
    // A second handle: must belong to the device that is locked. Null stays null where `optional`.
    std::shared_ptr<View> viewOfDevice(LWView handle, const char* argument, bool optional = false);

    std::shared_ptr<TechniqueObject> techniqueOfDevice(LWTechnique handle, const char* argument);

    // Waits for what is enqueued so far, with the lock open, so that other threads' calls go on meanwhile. Objects
    // may change while the lock is open: take what is to be reported before. Throws before it waits, or not at all.
    void wait();
    // The same, then throws what failed.
    void settle();
    // Drops the last reference of an object under its device's lock.
    void dispose(std::shared_ptr<ViewObject> object);
    void dispose(std::shared_ptr<TechniqueObject> object);

    const std::shared_ptr<DeviceObject>& owner() const { return device_; }

private:
    void lock(std::shared_ptr<DeviceObject> device);

    std::shared_ptr<DeviceObject> device_;
    std::unique_lock<std::mutex> lock_;
};

// Starts a call: forgets this thread's message. Throws REENTRANT inside a log callback.
void beginCall();
// The one catch site: call inside a catch block. Keeps the message with `device`, or this thread.
LWStatus keepError(const char* function, const std::shared_ptr<DeviceObject>& device) noexcept;
// lwGetLastError.
LWStatus takeError(LWDevice device, const char** message) noexcept;

// Runs body(Call&) as the entry point `function`.
template <class Body>
LWStatus enter(const char* function, Body body) noexcept {
    Call call;
    try {
        beginCall();
        body(call);
        return LW_SUCCESS;
    } catch (...) {
        return keepError(function, call.owner());
    }
}

}  // namespace lightwell
