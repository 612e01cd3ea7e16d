// Opens a device or adopts the host's, and keeps its limits, width, log and pending errors.
#include "compute/device.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

#include "compute/device_select.h"
#include "compute/error.h"

namespace lightwell {
namespace {

thread_local const Device* insideLogOf = nullptr;

template <class T>
T queueValue(cl_command_queue queue, cl_command_queue_info what) {
    T value{};
    const cl_int status = clGetCommandQueueInfo(queue, what, sizeof value, &value, nullptr);
    if (status == CL_INVALID_COMMAND_QUEUE)
        fail(LW_ERROR_INVALID_ARGUMENT, "clQueue: expected a valid cl_command_queue");
    checkCl(status, "clGetCommandQueueInfo");
    return value;
}

// LIGHTWELL_UNIFIED_MEMORY=0 sends host memory through copies on the device, as where it is not shared: for
// tests. 1, or nothing: the driver's word.
bool unifiedMemoryDenied() {
    const char* text = std::getenv("LIGHTWELL_UNIFIED_MEMORY");
    if (!text || !*text || std::string(text) == "1") return false;
    if (std::string(text) != "0")
        fail(LW_ERROR_INVALID_ARGUMENT, "LIGHTWELL_UNIFIED_MEMORY: expected 0 or 1, got \"", text, "\"");
    return true;
}

// A sub-device with `units` of the device's compute units.
cl_device_id subDeviceOf(cl_device_id device, std::uint32_t units) {
    const cl_device_partition_property byCounts[] = {CL_DEVICE_PARTITION_BY_COUNTS,
                                                     cl_device_partition_property(units),
                                                     CL_DEVICE_PARTITION_BY_COUNTS_LIST_END, 0};
    const cl_device_partition_property equally[] = {CL_DEVICE_PARTITION_EQUALLY,
                                                    cl_device_partition_property(units), 0};
    cl_int status = CL_INVALID_DEVICE_PARTITION_COUNT;
    // Asked first, as drivers without partitions (Rusticl of Mesa 22.3) may crash on the attempt.
    const bool splits = deviceValue<cl_uint>(device, CL_DEVICE_PARTITION_MAX_SUB_DEVICES) > 1;
    for (const cl_device_partition_property* properties : {byCounts, equally}) {
        if (!splits) break;
        cl_uint count = 0;
        status = clCreateSubDevices(device, properties, 0, nullptr, &count);
        if (status != CL_SUCCESS || count == 0) continue;
        std::vector<cl_device_id> parts(count);
        status = clCreateSubDevices(device, properties, count, parts.data(), nullptr);
        if (status != CL_SUCCESS) continue;
        for (cl_uint i = 1; i < count; ++i) clReleaseDevice(parts[i]);
        return parts[0];
    }
    fail(LW_ERROR_UNSUPPORTED, "maxComputeUnits: this device cannot be split into ", units, " of its ",
         deviceValue<cl_uint>(device, CL_DEVICE_MAX_COMPUTE_UNITS),
         " compute units (clCreateSubDevices: ", clErrorName(status), ")");
}

}  // namespace

bool isWidth(std::uint32_t width) {
    return width == 1 || width == 4 || width == 8 || width == 16;
}

Device::Device(const LWDeviceDesc& desc) : log_(desc.log), logUser_(desc.logUser) {
    if (desc.width && !isWidth(desc.width))
        fail(LW_ERROR_INVALID_ARGUMENT, "width: expected 1, 4, 8, 16 or 0 for the default, got ",
             desc.width);
    try {
        if (desc.clContext || desc.clQueue)
            adopt(desc);
        else
            open(desc);
        readLimits();
        programs_ = std::make_unique<ProgramCache>(
            *this, desc.cacheDirectory ? desc.cacheDirectory : defaultCacheDirectory());
        width_ = chooseWidth(desc);
    } catch (...) {
        release();
        throw;
    }
}

Device::~Device() {
    try {
        // For hosts that wait on events of their own and never finish. No waiting here: the queue may be the
        // host's, behind something that only the host can set off.
        watch_.collect();
        if (watch_.pending() == 0) programs_->saveBinaries();
    } catch (...) {
        // No memory, or a log callback that throws: kernels are then compiled again next time.
    }
    release();
}

void Device::release() {
    watch_.clear();
    programs_.reset();
    if (queue_) clReleaseCommandQueue(queue_);
    if (context_) clReleaseContext(context_);
    if (subDevice_) clReleaseDevice(subDevice_);
    queue_ = nullptr;
    context_ = nullptr;
    subDevice_ = nullptr;
}

void Device::open(const LWDeviceDesc& desc) {
    const FoundDevice found = selectDevice(desc.selector);
    id_ = found.id;
    platform_ = found.platform;
    if (desc.maxComputeUnits &&
        desc.maxComputeUnits < deviceValue<cl_uint>(id_, CL_DEVICE_MAX_COMPUTE_UNITS))
        id_ = subDevice_ = subDeviceOf(id_, desc.maxComputeUnits);
    cl_int status = CL_SUCCESS;
    const cl_context_properties properties[] = {CL_CONTEXT_PLATFORM, cl_context_properties(platform_),
                                                0};
    context_ = clCreateContext(properties, 1, &id_, nullptr, nullptr, &status);
    checkCl(status, "clCreateContext");
    const bool canProfile = (deviceValue<cl_command_queue_properties>(id_, CL_DEVICE_QUEUE_PROPERTIES) &
                             CL_QUEUE_PROFILING_ENABLE) != 0;
    profiling_ = canProfile && !desc.noProfiling;
    queue_ = clCreateCommandQueue(context_, id_, profiling_ ? CL_QUEUE_PROFILING_ENABLE : 0, &status);
    checkCl(status, "clCreateCommandQueue");
}

void Device::adopt(const LWDeviceDesc& desc) {
    if (!desc.clContext || !desc.clQueue)
        fail(LW_ERROR_INVALID_ARGUMENT, desc.clContext ? "clQueue" : "clContext",
             ": expected clContext and clQueue together, got null");
    if (desc.maxComputeUnits)
        fail(LW_ERROR_INVALID_ARGUMENT,
             "maxComputeUnits: expected 0 with a queue of the host's (create that queue on a "
             "sub-device), got ",
             desc.maxComputeUnits);
    cl_command_queue queue = static_cast<cl_command_queue>(desc.clQueue);
    cl_context context = static_cast<cl_context>(desc.clContext);
    if (queueValue<cl_context>(queue, CL_QUEUE_CONTEXT) != context)
        fail(LW_ERROR_INVALID_ARGUMENT,
             "clQueue: expected a queue of clContext, got one of another context");
    id_ = queueValue<cl_device_id>(queue, CL_QUEUE_DEVICE);
    platform_ = deviceValue<cl_platform_id>(id_, CL_DEVICE_PLATFORM);
    const auto properties = queueValue<cl_command_queue_properties>(queue, CL_QUEUE_PROPERTIES);
    profiling_ = (properties & CL_QUEUE_PROFILING_ENABLE) && !desc.noProfiling;
    outOfOrder_ = (properties & CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE) != 0;
    checkCl(clRetainContext(context), "clRetainContext");
    context_ = context;
    checkCl(clRetainCommandQueue(queue), "clRetainCommandQueue");
    queue_ = queue;
}

void Device::readLimits() {
    computeUnits_ = deviceValue<cl_uint>(id_, CL_DEVICE_MAX_COMPUTE_UNITS);
    unifiedMemory_ = deviceValue<cl_bool>(id_, CL_DEVICE_HOST_UNIFIED_MEMORY) != 0 && !unifiedMemoryDenied();
    hasFma_ = (deviceValue<cl_device_fp_config>(id_, CL_DEVICE_SINGLE_FP_CONFIG) & CL_FP_FMA) != 0;
    maxAllocation_ = deviceValue<cl_ulong>(id_, CL_DEVICE_MAX_MEM_ALLOC_SIZE);
    globalMemory_ = deviceValue<cl_ulong>(id_, CL_DEVICE_GLOBAL_MEM_SIZE);
    for (const std::string& part :
         {platformString(platform_, CL_PLATFORM_NAME), platformString(platform_, CL_PLATFORM_VERSION),
          deviceString(id_, CL_DEVICE_NAME), deviceString(id_, CL_DEVICE_VERSION),
          deviceString(id_, CL_DRIVER_VERSION)})
        identity_ += part + '\n';
}

std::uint32_t Device::chooseWidth(const LWDeviceDesc& desc) {
    if (desc.width) return desc.width;
    if (const char* text = std::getenv("LIGHTWELL_WIDTH"); text && *text) {
        for (const char* choice : {"1", "4", "8", "16"})
            if (std::string(text) == choice) return std::uint32_t(std::atoi(choice));
        fail(LW_ERROR_INVALID_ARGUMENT, "LIGHTWELL_WIDTH: expected 1, 4, 8 or 16, got \"", text, "\"");
    }
    // The probe's verdict holds for this device, this driver and this probe.
    const BinaryStore& store = programs_->store();
    const StoreKey key =
        hashKey({"width", programSource("probe/width"), identity_, std::to_string(computeUnits_)});
    BinaryStore::Bytes bytes;
    if (store.read(key, bytes) == BinaryStore::Found::kYes && bytes.size() == 1 && isWidth(bytes[0]))
        return bytes[0];
    const std::uint32_t width = probeWidth(*this);
    if (const auto problem = store.write(key, {static_cast<unsigned char>(width)}))
        warnOfCache(*problem);
    return width;
}

void Device::log(LWLogLevel level, const std::string& message) const {
    if (!log_) {
        if (level != LW_LOG_INFO) std::fprintf(stderr, "lightwell: %s\n", message.c_str());
        return;
    }
    // Also put back when the callback throws, which it must not: the thread would be locked out for good.
    struct Inside {
        const Device* outer;
        ~Inside() { insideLogOf = outer; }
    };
    const Inside inside{std::exchange(insideLogOf, this)};
    log_(logUser_, level, message.c_str());
}

bool Device::insideLog() const {
    return insideLogOf == this;
}

bool Device::insideAnyLog() {
    return insideLogOf != nullptr;
}

void Device::warnOfCache(const std::string& problem) {
    if (std::exchange(warnedOfCache_, true)) return;
    log(LW_LOG_WARNING, "cache: " + problem +
                            "; kernels will be compiled again next time (set LIGHTWELL_CACHE_DIR to a "
                            "writable directory)");
}

void Device::describe(LWDeviceInfo& info) const {
    describeHardware(id_, info);
    info.width = width_;
    info.hostUnifiedMemory = unifiedMemory_;
    info.hasProfiling = profiling_;
    info.allocatedBytes = allocatedBytes_;
    info.programsBuilt = programs_->built();
    info.programsLoaded = programs_->loaded();
    info.kernelsSpecialised = kernelsSpecialised_;
}

void Device::raiseFailure() {
    watch_.collect();
    if (!watch_.failure().empty())
        fail(LW_ERROR_DEVICE, "a command failed on the device: ", watch_.takeFailure());
}

void Device::finish() {
    const cl_int status = clFinish(queue_);
    watch_.collect();
    if (status != CL_SUCCESS) watch_.noteFailure(clErrorName(status));
    watch_.clear();  // nothing unless the queue itself has failed
    settle();
}

Marker Device::mark() {
    cl_event event = nullptr;
    checkCl(clEnqueueMarkerWithWaitList(queue_, 0, nullptr, &event), "clEnqueueMarkerWithWaitList");
    const cl_int status = clFlush(queue_);
    if (status != CL_SUCCESS) clReleaseEvent(event);
    checkCl(status, "clFlush");
    return Marker(event);
}

void Device::settle() {
    raiseFailure();
    // Other threads' commands may be on their way by now; drivers compile at first launches, and what is being
    // compiled is not to be read.
    if (watch_.pending() == 0) programs_->saveBinaries();
}

}  // namespace lightwell
