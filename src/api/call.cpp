#include "api/call.h"

#include <new>
#include <string>
#include <utility>

#include "compute/error.h"

namespace lightwell {
namespace {

// This thread's errors without a device, and the message that it fetched last.
struct ThreadErrors {
    LWStatus status = LW_SUCCESS;
    std::string message;
    std::string fetched;
};
thread_local ThreadErrors threadErrors;

void refuseInsideLog() {
    if (Device::insideAnyLog()) fail(LW_ERROR_REENTRANT, "a log callback must not call Lightwell");
}

}  // namespace

void Call::lock(std::shared_ptr<DeviceObject> device) {
    device_ = std::move(device);
    lock_ = std::unique_lock<std::mutex>(device_->mutex);
}

Device& Call::device(LWDevice handle) {
    lock(findDevice(handle, "device"));
    return device_->device;
}

std::shared_ptr<ViewObject> Call::view(LWView handle) {
    auto object = findView(handle, "view");
    lock(object->device);
    return object;
}

std::shared_ptr<TechniqueObject> Call::technique(LWTechnique handle) {
    auto object = findTechnique(handle, "technique");
    lock(object->device);
    return object;
}

std::shared_ptr<TechniqueObject> Call::techniqueOfDevice(LWTechnique handle, const char* argument) {
    auto object = findTechnique(handle, argument);
    if (object->device != device_)
        fail(LW_ERROR_INVALID_HANDLE, argument, ": expected a technique of the same device, got another device's");
    return object;
}

std::shared_ptr<View> Call::viewOfDevice(LWView handle, const char* argument, bool optional) {
    if (!handle && optional) return nullptr;
    const auto object = findView(handle, argument);
    if (object->device != device_)
        fail(LW_ERROR_INVALID_HANDLE, argument,
             ": expected a view of the technique's device, got another device's");
    return object->view;
}

void Call::wait() {
    // Neither the queue nor the context can go away: this call holds the device.
    const Marker marker = device_->device.mark();
    lock_.unlock();
    // After a failure the standard leaves open what a marker waits for: then for all.
    if (!marker.wait()) clFinish(device_->device.queue());
    lock_.lock();
}

void Call::settle() {
    wait();
    device_->device.settle();
}

void Call::dispose(std::shared_ptr<ViewObject> object) {
    lock(object->device);
    object.reset();
}

void Call::dispose(std::shared_ptr<TechniqueObject> object) {
    lock(object->device);
    object.reset();
}

void beginCall() {
    threadErrors.fetched.clear();
    refuseInsideLog();
}

LWStatus keepError(const char* function, const std::shared_ptr<DeviceObject>& device) noexcept {
    LWStatus status = LW_ERROR_INTERNAL;
    try {
        std::string message;
        try {
            throw;
        } catch (const Error& error) {
            status = error.status();
            message = error.what();
        } catch (const std::bad_alloc&) {
            status = LW_ERROR_OUT_OF_MEMORY;
            message = "host memory is exhausted";
        } catch (const std::exception& error) {
            message = error.what();
        } catch (...) {
            message = "an unknown exception";
        }
        message = std::string(function) + ": " + message;
        if (device) {
            device->keepError(status, message);
        } else {
            threadErrors.status = status;
            threadErrors.message = std::move(message);
        }
    } catch (...) {
        // No memory for the message: the status alone is kept.
        if (!device) threadErrors.status = status;
    }
    return status;
}

LWStatus takeError(LWDevice handle, const char** message) noexcept {
    LWStatus status = LW_SUCCESS;
    std::string& fetched = threadErrors.fetched;
    try {
        beginCall();
        if (!handle) {
            status = std::exchange(threadErrors.status, LW_SUCCESS);
            fetched = std::exchange(threadErrors.message, std::string());
        } else {
            const auto device = findDevice(handle, "device");
            const std::lock_guard<std::mutex> lock(device->errorMutex);
            status = std::exchange(device->errorStatus, LW_SUCCESS);
            fetched = std::exchange(device->errorMessage, std::string());
        }
    } catch (const Error& error) {
        // About this call itself: an invalid handle, or a call from a log callback.
        status = error.status();
        try {
            fetched = std::string("lwGetLastError: ") + error.what();
        } catch (...) {
            fetched.clear();
        }
    } catch (...) {
        status = LW_ERROR_INTERNAL;
    }
    if (message) *message = fetched.c_str();
    return status;
}

}  // namespace lightwell
