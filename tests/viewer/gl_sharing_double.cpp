// The part of a driver that shares OpenGL's buffers (cl_khr_gl_sharing), played on one that doesn't: preloaded into the viewer.
// It keeps to what the extension says of who may touch memory when: what is acquired is copied over, what is released copied
// back, and memory that is OpenGL's holds rubbish in OpenCL. GL_SHARING_DOUBLE=refuse: contexts are refused.
#include <CL/cl.h>
#include <CL/cl_gl.h>
#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <vector>

namespace {

constexpr int kRubbish = 0x7f;  // as floats 3e38

struct Shared {
    GLuint buffer;
    std::size_t byteCount;
    bool isWritten, isAcquired;
};
std::map<cl_mem, Shared> buffers;

template <class Function>
Function real(const char* name) {
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

void spoil(cl_command_queue queue, cl_mem memory, const Shared& shared) {
    const std::vector<char> rubbish(shared.byteCount, kRubbish);
    clEnqueueWriteBuffer(queue, memory, CL_TRUE, 0, shared.byteCount, rubbish.data(), 0, nullptr, nullptr);
}

}  // namespace

extern "C" {

cl_int clGetDeviceInfo(cl_device_id device, cl_device_info name, size_t capacity, void* value, size_t* size) {
    static const auto next = real<decltype(&clGetDeviceInfo)>("clGetDeviceInfo");
    if (name != CL_DEVICE_EXTENSIONS) return next(device, name, capacity, value, size);
    size_t length = 0;
    next(device, name, 0, nullptr, &length);
    std::string text(length, '\0');
    next(device, name, length, &text[0], nullptr);
    text = std::string(text.c_str()) + " cl_khr_gl_sharing";
    if (size != nullptr) *size = text.size() + 1;
    if (value == nullptr) return CL_SUCCESS;
    if (capacity < text.size() + 1) return CL_INVALID_VALUE;
    std::memcpy(value, text.c_str(), text.size() + 1);
    return CL_SUCCESS;
}

cl_context clCreateContext(const cl_context_properties* properties, cl_uint count, const cl_device_id* devices,
                           void(CL_CALLBACK* notify)(const char*, const void*, size_t, void*), void* user, cl_int* status) {
    static const auto next = real<decltype(&clCreateContext)>("clCreateContext");
    const char* mode = std::getenv("GL_SHARING_DOUBLE");
    std::vector<cl_context_properties> own;
    bool isRight = true;
    for (const cl_context_properties* at = properties; at != nullptr && *at != 0; at += 2) {
        if (at[0] == CL_GL_CONTEXT_KHR)
            isRight = isRight && reinterpret_cast<EGLContext>(at[1]) == eglGetCurrentContext() && (mode == nullptr || std::strcmp(mode, "refuse") != 0);
        else if (at[0] == CL_EGL_DISPLAY_KHR)
            isRight = isRight && reinterpret_cast<EGLDisplay>(at[1]) == eglGetCurrentDisplay();
        else
            own.insert(own.end(), {at[0], at[1]});
    }
    own.push_back(0);
    if (isRight) return next(own.data(), count, devices, notify, user, status);
    if (status != nullptr) *status = CL_INVALID_GL_SHAREGROUP_REFERENCE_KHR;
    return nullptr;
}

cl_mem clCreateFromGLBuffer(cl_context context, cl_mem_flags flags, cl_GLuint buffer, cl_int* status) {
    GLint byteCount = 0;
    glBindBuffer(GL_COPY_READ_BUFFER, buffer);
    glGetBufferParameteriv(GL_COPY_READ_BUFFER, GL_BUFFER_SIZE, &byteCount);
    glBindBuffer(GL_COPY_READ_BUFFER, 0);
    const cl_mem memory = clCreateBuffer(context, CL_MEM_READ_WRITE, size_t(byteCount), nullptr, status);
    if (memory != nullptr) buffers[memory] = {buffer, std::size_t(byteCount), (flags & CL_MEM_READ_ONLY) == 0, false};
    return memory;
}

cl_int clEnqueueAcquireGLObjects(cl_command_queue queue, cl_uint count, const cl_mem* memories, cl_uint, const cl_event*, cl_event*) {
    for (cl_uint i = 0; i < count; ++i) {
        const auto found = buffers.find(memories[i]);
        if (found == buffers.end() || found->second.isAcquired) return CL_INVALID_GL_OBJECT;
        Shared& shared = found->second;
        std::vector<char> bytes(shared.byteCount);
        glBindBuffer(GL_COPY_READ_BUFFER, shared.buffer);
        glGetBufferSubData(GL_COPY_READ_BUFFER, 0, GLsizeiptr(bytes.size()), bytes.data());
        glBindBuffer(GL_COPY_READ_BUFFER, 0);
        clEnqueueWriteBuffer(queue, memories[i], CL_TRUE, 0, bytes.size(), bytes.data(), 0, nullptr, nullptr);
        shared.isAcquired = true;
    }
    return CL_SUCCESS;
}

cl_int clEnqueueReleaseGLObjects(cl_command_queue queue, cl_uint count, const cl_mem* memories, cl_uint, const cl_event*, cl_event*) {
    for (cl_uint i = 0; i < count; ++i) {
        const auto found = buffers.find(memories[i]);
        if (found == buffers.end() || !found->second.isAcquired) return CL_INVALID_GL_OBJECT;
        Shared& shared = found->second;
        if (shared.isWritten) {
            std::vector<char> bytes(shared.byteCount);
            clEnqueueReadBuffer(queue, memories[i], CL_TRUE, 0, bytes.size(), bytes.data(), 0, nullptr, nullptr);
            glBindBuffer(GL_COPY_WRITE_BUFFER, shared.buffer);
            glBufferSubData(GL_COPY_WRITE_BUFFER, 0, GLsizeiptr(bytes.size()), bytes.data());
            glBindBuffer(GL_COPY_WRITE_BUFFER, 0);
        }
        spoil(queue, memories[i], shared);
        shared.isAcquired = false;
    }
    return CL_SUCCESS;
}

}  // extern "C"
