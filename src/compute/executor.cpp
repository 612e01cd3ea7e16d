// Enqueues commands in order and hands their events to the profile and to the device's error check.
#include "compute/executor.h"

#include <limits>
#include <utility>

#include "compute/device.h"
#include "compute/error.h"

namespace lightwell {
namespace {

int asInt(std::int64_t value, const char* what) {
    if (value > std::numeric_limits<int>::max() || value < std::numeric_limits<int>::min())
        fail(LW_ERROR_UNSUPPORTED, "an image's ", what, " of ", value,
             " floats exceeds the 32-bit indices of the kernels");
    return int(value);
}

void checkRange(const char* pass, const Buffer& buffer, std::size_t byteOffset, std::size_t bytes) {
    if (byteOffset > buffer.bytes() || bytes > buffer.bytes() - byteOffset)
        fail(LW_ERROR_INTERNAL, pass, ": bytes ", byteOffset, " to ", byteOffset + bytes,
             " of a buffer of ", buffer.bytes());
}

void CL_CALLBACK dropCopy(cl_event, cl_int, void* copy) { delete static_cast<std::vector<unsigned char>*>(copy); }

}  // namespace

void Executor::setRaw(Kernel& kernel, cl_uint& index, std::size_t bytes, const void* value) {
    const cl_int status = clSetKernelArg(kernel.get(), index, bytes, value);
    if (status != CL_SUCCESS)
        fail(LW_ERROR_INTERNAL, "kernel ", kernel.name(), ": argument ", index, " of ", bytes,
             " bytes is refused: ", clErrorName(status));
    ++index;
}

void Executor::setArg(Kernel& kernel, cl_uint& index, const Planes& planes) {
    const cl_int4 layout = {{asInt(planes.offset, "offset"), asInt(planes.rowStride, "row stride"),
                             asInt(planes.planeStride, "plane stride"), 0}};
    setArg(kernel, index, planes.memory);
    setRaw(kernel, index, sizeof layout, &layout);
}

void Executor::enqueue(const char* pass, Kernel& kernel, Range global, Range local,
                       cl_uint argumentCount) {
    startWaits();
    if (argumentCount != kernel.argumentCount())
        fail(LW_ERROR_INTERNAL, pass, ": kernel ", kernel.name(), " takes ", kernel.argumentCount(),
             " arguments, got ", argumentCount);
    for (int axis = 0; axis < 2; ++axis) {
        if (global[axis] == 0 || local[axis] == 0)
            fail(LW_ERROR_INTERNAL, pass, ": kernel ", kernel.name(), " over ", global[0], " x ",
                 global[1], " work-items in groups of ", local[0], " x ", local[1]);
        global[axis] = (global[axis] + local[axis] - 1) / local[axis] * local[axis];
    }
    cl_event event = nullptr;
    const cl_int status = clEnqueueNDRangeKernel(device_.queue(), kernel.get(), 2, nullptr,
                                                 global.data(), local.data(), 0, nullptr, &event);
    // Not asked for beforehand: CL_KERNEL_WORK_GROUP_SIZE understates what some drivers run (Rusticl).
    if (status == CL_INVALID_WORK_GROUP_SIZE || status == CL_INVALID_WORK_ITEM_SIZE)
        fail(LW_ERROR_UNSUPPORTED, pass, ": kernel ", kernel.name(), " needs groups of ", local[0],
             " x ", local[1], " work-items, more than this device allows");
    checkCl(status, kernel.name().c_str());
    if (kernel.noteLaunch(global, local)) device_.countSpecialisation();
    done(pass, event);
}

void Executor::done(const char* pass, cl_event event) {
    device_.watch(event);
    if (device_.outOfOrder())
        checkCl(clEnqueueBarrierWithWaitList(device_.queue(), 0, nullptr, nullptr),
                "clEnqueueBarrierWithWaitList");
    if (!device_.profiling()) {
        clReleaseEvent(event);
        event = nullptr;
    }
    profile_.add(pass, event);
}

void Executor::write(const char* pass, const Buffer& to, std::size_t byteOffset, std::size_t bytes,
                     const void* from) {
    startWaits();
    checkRange(pass, to, byteOffset, bytes);
    cl_event event = nullptr;
    checkCl(clEnqueueWriteBuffer(device_.queue(), to.get(), CL_FALSE, byteOffset, bytes, from, 0,
                                 nullptr, &event),
            "clEnqueueWriteBuffer");
    copiedBytes_ += bytes;
    done(pass, event);
}

void Executor::writeCopy(const char* pass, const Buffer& to, std::size_t byteOffset, std::size_t bytes,
                         const void* from) {
    startWaits();
    checkRange(pass, to, byteOffset, bytes);
    const auto* first = static_cast<const unsigned char*>(from);
    auto copy = std::make_unique<std::vector<unsigned char>>(first, first + bytes);
    cl_event event = nullptr;
    checkCl(clEnqueueWriteBuffer(device_.queue(), to.get(), CL_FALSE, byteOffset, bytes, copy->data(), 0, nullptr,
                                 &event),
            "clEnqueueWriteBuffer");
    // A driver without memory even for that: then wait, as the copy must not go before the command has ended.
    if (clSetEventCallback(event, CL_COMPLETE, dropCopy, copy.get()) == CL_SUCCESS)
        copy.release();
    else
        clWaitForEvents(1, &event);
    copiedBytes_ += bytes;
    done(pass, event);
}

void Executor::read(const char* pass, cl_mem from, std::size_t byteOffset, std::size_t bytes, void* to) {
    startWaits();
    cl_event event = nullptr;
    checkCl(
        clEnqueueReadBuffer(device_.queue(), from, CL_FALSE, byteOffset, bytes, to, 0, nullptr, &event),
        "clEnqueueReadBuffer");
    copiedBytes_ += bytes;
    done(pass, event);
}

void Executor::fill(const char* pass, const Buffer& buffer, std::uint32_t pattern,
                    std::size_t byteOffset, std::size_t bytes) {
    startWaits();
    checkRange(pass, buffer, byteOffset, bytes);
    cl_event event = nullptr;
    checkCl(clEnqueueFillBuffer(device_.queue(), buffer.get(), &pattern, sizeof pattern, byteOffset,
                                bytes, 0, nullptr, &event),
            "clEnqueueFillBuffer");
    done(pass, event);
}

void Executor::copy(const char* pass, cl_mem from, cl_mem to, std::size_t fromOffset,
                    std::size_t toOffset, std::size_t bytes) {
    startWaits();
    cl_event event = nullptr;
    checkCl(
        clEnqueueCopyBuffer(device_.queue(), from, to, fromOffset, toOffset, bytes, 0, nullptr, &event),
        "clEnqueueCopyBuffer");
    done(pass, event);
}

void Executor::publish(const char* pass, const Buffer& buffer) {
    startWaits();
    cl_int status = CL_SUCCESS;
    cl_event event = nullptr;
    void* host = clEnqueueMapBuffer(device_.queue(), buffer.get(), CL_FALSE, CL_MAP_READ, 0,
                                    buffer.bytes(), 0, nullptr, &event, &status);
    checkCl(status, "clEnqueueMapBuffer");
    done(pass, event);
    cl_event unmapped = nullptr;
    status = clEnqueueUnmapMemObject(device_.queue(), buffer.get(), host, 0, nullptr, &unmapped);
    if (status == CL_INVALID_VALUE) {
        // Rusticl of Mesa 22.3 knows a mapping only once it has happened: the one place that waits.
        checkCl(clFinish(device_.queue()), "clFinish");
        status = clEnqueueUnmapMemObject(device_.queue(), buffer.get(), host, 0, nullptr, &unmapped);
    }
    checkCl(status, "clEnqueueUnmapMemObject");
    done(pass, unmapped);
}

void Executor::waitFor(const LWSync* sync) {
    if (!sync) return;
    for (std::uint32_t i = 0; i < sync->waitEventCount; ++i) {
        if (!sync->waitEvents || !sync->waitEvents[i])
            fail(LW_ERROR_INVALID_ARGUMENT, "sync.waitEvents[", i, "]: expected a cl_event, got null");
        waits_.push_back(static_cast<cl_event>(sync->waitEvents[i]));
    }
}

void Executor::startWaits() {
    if (waits_.empty()) return;
    const std::vector<cl_event> events = std::exchange(waits_, {});
    cl_event event = nullptr;
    const cl_int status =
        clEnqueueBarrierWithWaitList(device_.queue(), cl_uint(events.size()), events.data(), &event);
    if (status == CL_INVALID_EVENT_WAIT_LIST || status == CL_INVALID_CONTEXT ||
        status == CL_INVALID_EVENT)
        fail(LW_ERROR_INVALID_ARGUMENT,
             "sync.waitEvents: expected events of the device's context: ", clErrorName(status));
    checkCl(status, "clEnqueueBarrierWithWaitList");
    device_.watch(event);
    clReleaseEvent(event);
}

void Executor::signal(const LWSync* sync) {
    startWaits();
    if (!sync || !sync->signalEvent) return;
    cl_event event = nullptr;
    checkCl(clEnqueueMarkerWithWaitList(device_.queue(), 0, nullptr, &event),
            "clEnqueueMarkerWithWaitList");
    *sync->signalEvent = event;
    flush();  // the host may wait on it from another queue
}

void Executor::flush() {
    startWaits();
    checkCl(clFlush(device_.queue()), "clFlush");
}

}  // namespace lightwell
