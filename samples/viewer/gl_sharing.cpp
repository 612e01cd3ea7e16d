// cl_khr_gl_sharing (Khronos OpenCL extension specification): without cl_khr_gl_event the host waits at each change of hands,
// by glFinish before an acquire and clFinish after a release.
#include "gl_sharing.h"

#include <CL/cl.h>
#include <CL/cl_gl.h>
#include <dlfcn.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <stdexcept>
#include <utility>
#include <vector>

namespace viewer {
namespace {

constexpr const char* kExtension = "cl_khr_gl_sharing";

void require(cl_int status, const char* call) {
    if (status != CL_SUCCESS) throw std::runtime_error(fmt::format("sharing OpenGL's buffers: {}: OpenCL error {}", call, status));
}

// By way of a library that this process has loaded already; null where it has not.
void* currentOf(const char* library, const char* function) {
    void* handle = dlopen(library, RTLD_LAZY | RTLD_NOLOAD);
    if (handle == nullptr) return nullptr;
    using Getter = void* (*)();
    const auto get = reinterpret_cast<Getter>(dlsym(handle, function));
    void* current = get != nullptr ? get() : nullptr;
    dlclose(handle);
    return current;
}

// What clCreateContext must know of the current OpenGL context; empty where it is neither EGL's nor GLX's.
std::vector<cl_context_properties> contextProperties() {
    const auto number = [](void* address) { return reinterpret_cast<cl_context_properties>(address); };
    if (void* context = currentOf("libEGL.so.1", "eglGetCurrentContext"))
        return {CL_GL_CONTEXT_KHR, number(context), CL_EGL_DISPLAY_KHR, number(currentOf("libEGL.so.1", "eglGetCurrentDisplay"))};
    for (const char* library : {"libGLX.so.0", "libGL.so.1"})
        if (void* context = currentOf(library, "glXGetCurrentContext"))
            return {CL_GL_CONTEXT_KHR, number(context), CL_GLX_DISPLAY_KHR, number(currentOf(library, "glXGetCurrentDisplay"))};
    return {};
}

template <class Object, class Query>
std::string textOf(Query query, Object object, cl_uint name) {
    std::size_t size = 0;
    if (query(object, name, 0, nullptr, &size) != CL_SUCCESS || size == 0) return {};
    std::string text(size, '\0');
    if (query(object, name, size, &text[0], nullptr) != CL_SUCCESS) return {};
    return text.c_str();
}

struct Candidate {
    cl_platform_id platform;
    cl_device_id device;
};

// LWDeviceInfo's strings may be cut short.
std::vector<Candidate> devicesLike(const LWDeviceInfo& info) {
    const auto isLike = [](const std::string& whole, const char* known) { return *known != '\0' && whole.rfind(known, 0) == 0; };
    std::vector<Candidate> found;
    cl_uint platformCount = 0;
    if (clGetPlatformIDs(0, nullptr, &platformCount) != CL_SUCCESS) return found;
    std::vector<cl_platform_id> platforms(platformCount);
    clGetPlatformIDs(platformCount, platforms.data(), nullptr);
    for (const cl_platform_id platform : platforms) {
        cl_uint count = 0;
        if (!isLike(textOf(clGetPlatformInfo, platform, CL_PLATFORM_NAME), info.platform) ||
            clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &count) != CL_SUCCESS)
            continue;
        std::vector<cl_device_id> devices(count);
        clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, count, devices.data(), nullptr);
        for (const cl_device_id device : devices)
            if (isLike(textOf(clGetDeviceInfo, device, CL_DEVICE_NAME), info.name)) found.push_back({platform, device});
    }
    return found;
}

}  // namespace

std::shared_ptr<GlSharing> GlSharing::open(const LWDeviceInfo& device, bool wantsCopies, std::string& reason) {
    reason = "asked for by --copies";
    if (wantsCopies) return nullptr;
    reason = fmt::format("the device does not offer {}", kExtension);
    const std::vector<cl_context_properties> current = contextProperties();
    for (const Candidate& candidate : devicesLike(device)) {
        if (!epoxy_extension_in_string(textOf(clGetDeviceInfo, candidate.device, CL_DEVICE_EXTENSIONS).c_str(), kExtension)) continue;
        reason = fmt::format("the device offers {}, but OpenGL's context is neither of EGL nor of GLX", kExtension);
        if (current.empty()) return nullptr;
        std::vector<cl_context_properties> properties = current;
        properties.insert(properties.end(), {CL_CONTEXT_PLATFORM, reinterpret_cast<cl_context_properties>(candidate.platform), 0});
        cl_int status = CL_SUCCESS;
        cl_context context = clCreateContext(properties.data(), 1, &candidate.device, nullptr, nullptr, &status);
        reason = fmt::format("the device offers {}, but not with this OpenGL context (clCreateContext: error {})", kExtension, status);
        if (status != CL_SUCCESS) continue;
        cl_command_queue queue = clCreateCommandQueue(context, candidate.device, CL_QUEUE_PROFILING_ENABLE, &status);
        if (status != CL_SUCCESS) clReleaseContext(context);
        require(status, "clCreateCommandQueue");
        reason = kExtension;
        return std::shared_ptr<GlSharing>(new GlSharing(context, queue));
    }
    return nullptr;
}

GlSharing::~GlSharing() {
    clReleaseCommandQueue(static_cast<cl_command_queue>(queue_));
    clReleaseContext(static_cast<cl_context>(context_));
}

SharedBuffer::SharedBuffer(std::shared_ptr<GlSharing> sharing, unsigned buffer, bool isWritten) : sharing_(std::move(sharing)) {
    cl_int status = CL_SUCCESS;
    glFinish();
    memory_ = clCreateFromGLBuffer(static_cast<cl_context>(sharing_->context()), isWritten ? CL_MEM_READ_WRITE : CL_MEM_READ_ONLY, buffer, &status);
    require(status, "clCreateFromGLBuffer");
}

SharedBuffer::~SharedBuffer() {
    release();
    clReleaseMemObject(static_cast<cl_mem>(memory_));
}

void SharedBuffer::acquire() {
    require(releaseStatus_, "clEnqueueReleaseGLObjects");
    const cl_mem memory = static_cast<cl_mem>(memory_);
    glFinish();
    require(clEnqueueAcquireGLObjects(static_cast<cl_command_queue>(sharing_->queue()), 1, &memory, 0, nullptr, nullptr), "clEnqueueAcquireGLObjects");
    isAcquired_ = true;
}

void SharedBuffer::release() noexcept {
    if (!isAcquired_) return;
    isAcquired_ = false;
    const cl_mem memory = static_cast<cl_mem>(memory_);
    const auto queue = static_cast<cl_command_queue>(sharing_->queue());
    releaseStatus_ = clEnqueueReleaseGLObjects(queue, 1, &memory, 0, nullptr, nullptr);
    const cl_int finished = clFinish(queue);
    if (releaseStatus_ == CL_SUCCESS) releaseStatus_ = finished;
}

}  // namespace viewer
