#define CL_TARGET_OPENCL_VERSION 120
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#include "support/cl_faults.h"

#include <dlfcn.h>

#include <atomic>
#include <cstring>

namespace {

std::atomic<int> countdown{-1};  // calls before the one that fails; below 0: none
std::atomic<cl_int> failure{CL_SUCCESS};
std::atomic<const char*> failed{""};
std::atomic<bool> eventsFail{false};

bool fails(const char* function) {
    if (countdown.load() < 0 || countdown.fetch_sub(1) != 0) return false;
    failed = function;
    return true;
}

template <class Function>
Function real(const char* name) {
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

// A function that returns a status, and one that returns an object and a status through its last argument.
#define LW_STATUS_CALL(name, parameters, arguments)                       \
    extern "C" cl_int CL_API_CALL name parameters {                       \
        static const auto next = real<decltype(&name)>(#name);            \
        return fails(#name) ? failure.load() : next arguments;            \
    }
#define LW_OBJECT_CALL(type, name, parameters, arguments)                 \
    extern "C" type CL_API_CALL name parameters {                         \
        static const auto next = real<decltype(&name)>(#name);            \
        if (!fails(#name)) return next arguments;                         \
        if (status) *status = failure;                                    \
        return nullptr;                                                   \
    }

LW_OBJECT_CALL(cl_mem, clCreateBuffer, (cl_context c, cl_mem_flags f, size_t n, void* p, cl_int* status), (c, f, n, p, status))
LW_OBJECT_CALL(cl_kernel, clCreateKernel, (cl_program p, const char* n, cl_int* status), (p, n, status))
LW_OBJECT_CALL(void*, clEnqueueMapBuffer,
               (cl_command_queue q, cl_mem m, cl_bool b, cl_map_flags f, size_t o, size_t n, cl_uint w, const cl_event* l,
                cl_event* e, cl_int* status),
               (q, m, b, f, o, n, w, l, e, status))
LW_STATUS_CALL(clSetKernelArg, (cl_kernel k, cl_uint i, size_t n, const void* v), (k, i, n, v))
LW_STATUS_CALL(clBuildProgram,
               (cl_program p, cl_uint n, const cl_device_id* d, const char* o, void(CL_CALLBACK* f)(cl_program, void*), void* u),
               (p, n, d, o, f, u))
LW_STATUS_CALL(clEnqueueNDRangeKernel,
               (cl_command_queue q, cl_kernel k, cl_uint d, const size_t* o, const size_t* g, const size_t* s, cl_uint w,
                const cl_event* l, cl_event* e),
               (q, k, d, o, g, s, w, l, e))
LW_STATUS_CALL(clEnqueueWriteBuffer,
               (cl_command_queue q, cl_mem m, cl_bool b, size_t o, size_t n, const void* p, cl_uint w, const cl_event* l, cl_event* e),
               (q, m, b, o, n, p, w, l, e))
LW_STATUS_CALL(clEnqueueReadBuffer,
               (cl_command_queue q, cl_mem m, cl_bool b, size_t o, size_t n, void* p, cl_uint w, const cl_event* l, cl_event* e),
               (q, m, b, o, n, p, w, l, e))
LW_STATUS_CALL(clEnqueueFillBuffer,
               (cl_command_queue q, cl_mem m, const void* p, size_t s, size_t o, size_t n, cl_uint w, const cl_event* l, cl_event* e),
               (q, m, p, s, o, n, w, l, e))
LW_STATUS_CALL(clEnqueueUnmapMemObject, (cl_command_queue q, cl_mem m, void* p, cl_uint w, const cl_event* l, cl_event* e),
               (q, m, p, w, l, e))
LW_STATUS_CALL(clEnqueueMarkerWithWaitList, (cl_command_queue q, cl_uint w, const cl_event* l, cl_event* e), (q, w, l, e))
LW_STATUS_CALL(clEnqueueBarrierWithWaitList, (cl_command_queue q, cl_uint w, const cl_event* l, cl_event* e), (q, w, l, e))
LW_STATUS_CALL(clFlush, (cl_command_queue q), (q))

extern "C" cl_int CL_API_CALL clGetEventInfo(cl_event event, cl_event_info what, size_t size, void* value, size_t* written) {
    static const auto next = real<decltype(&clGetEventInfo)>("clGetEventInfo");
    if (!eventsFail || what != CL_EVENT_COMMAND_EXECUTION_STATUS || size < sizeof(cl_int))
        return next(event, what, size, value, written);
    const cl_int state = CL_OUT_OF_RESOURCES;
    std::memcpy(value, &state, sizeof state);
    return CL_SUCCESS;
}

namespace lightwell::test {

ClFault::ClFault(int failing, cl_int code) {
    failure = code;
    failed = "";
    countdown = failing;
}
ClFault::~ClFault() { countdown = -1; }
bool ClFault::happened() const { return *failed.load() != '\0'; }
const char* ClFault::function() const { return failed; }

FailedEvents::FailedEvents() { eventsFail = true; }
FailedEvents::~FailedEvents() { eventsFail = false; }

}  // namespace lightwell::test
