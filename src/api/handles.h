// The table of handles. A handle is not a pointer but a number that is never used twice, so that a
// released, foreign or invented handle is refused instead of followed. This table is the library's only
// global state; it is never destroyed, since OpenCL may be unloaded before our destructors would run.
#pragma once

#include <cstdint>
#include <memory>

#include "api/objects.h"

namespace lightwell {

enum class HandleKind { kDevice, kView, kTechnique };

// A new handle with one reference.
void* addHandle(HandleKind kind, std::shared_ptr<Object> object);
// Throw INVALID_HANDLE naming `argument`: null, unknown, or of another kind.
std::shared_ptr<Object> findHandle(HandleKind kind, const void* handle, const char* argument);
void retainHandle(HandleKind kind, const void* handle, const char* argument);
// Takes one reference; returns the object when that was the last and the handle is gone, else null.
std::shared_ptr<Object> releaseHandle(HandleKind kind, const void* handle, const char* argument);

inline std::shared_ptr<DeviceObject> findDevice(LWDevice handle, const char* argument) {
    return std::static_pointer_cast<DeviceObject>(findHandle(HandleKind::kDevice, handle, argument));
}
inline std::shared_ptr<ViewObject> findView(LWView handle, const char* argument) {
    return std::static_pointer_cast<ViewObject>(findHandle(HandleKind::kView, handle, argument));
}
inline std::shared_ptr<TechniqueObject> findTechnique(LWTechnique handle, const char* argument) {
    return std::static_pointer_cast<TechniqueObject>(
        findHandle(HandleKind::kTechnique, handle, argument));
}

}  // namespace lightwell
