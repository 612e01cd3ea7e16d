// A device with a view and a technique for one scene; and a host's own context, queue and events.
#pragma once

#define CL_TARGET_OPENCL_VERSION 120
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#include <CL/cl.h>

#include <catch2/catch.hpp>

#include "api/api_scene.h"

namespace lightwell::test {

struct ApiRig {
    // Takes the device over. `desc` null: the technique's defaults.
    ApiRig(LWDevice from, const ApiScene& scene, const LWRsmDesc* desc = nullptr) : device(from) {
        const LWViewDesc viewDesc = scene.viewDesc();
        REQUIRE(lwCreateView(device, &viewDesc, &view) == LW_SUCCESS);
        REQUIRE(lwCreateRsm(device, desc, &technique) == LW_SUCCESS);
    }
    ~ApiRig() {
        lwReleaseTechnique(technique);
        lwReleaseView(view);
        lwReleaseDevice(device);
    }
    ApiRig(const ApiRig&) = delete;
    ApiRig& operator=(const ApiRig&) = delete;

    void frame(const ApiScene& scene) {
        REQUIRE(lwUpdate(technique, &scene.frame) == LW_SUCCESS);
        REQUIRE(lwRender(technique, view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
        REQUIRE(lwFinish(device) == LW_SUCCESS);
    }
    LWStats stats() {
        LWStats result{};
        result.structSize = sizeof result;
        CHECK(lwGetStats(technique, &result) == LW_SUCCESS);
        return result;
    }
    LWDeviceInfo info() {
        LWDeviceInfo result{};
        result.structSize = sizeof result;
        CHECK(lwGetDeviceInfo(device, &result) == LW_SUCCESS);
        return result;
    }
    std::uint32_t launches() {
        const LWStats all = stats();
        std::uint32_t sum = 0;
        for (std::uint32_t i = 0; i < all.passCount; ++i) sum += all.passes[i].launches;
        return sum;
    }
    LWDevice device;
    LWView view = nullptr;
    LWTechnique technique = nullptr;
};

// On a device of the library's own.
struct Rig : ApiRig {
    explicit Rig(const ApiScene& scene, std::uint32_t width = 16) : ApiRig(makeDevice(width), scene) {}
};

// A context and a queue as a host would have them.
class HostQueue {
public:
    explicit HostQueue(cl_command_queue_properties properties = 0) {
        cl_platform_id platform = nullptr;
        REQUIRE(clGetPlatformIDs(1, &platform, nullptr) == CL_SUCCESS);
        REQUIRE(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &id_, nullptr) == CL_SUCCESS);
        cl_int status = 0;
        context_ = clCreateContext(nullptr, 1, &id_, nullptr, nullptr, &status);
        REQUIRE(status == CL_SUCCESS);
        queue_ = clCreateCommandQueue(context_, id_, properties, &status);
        REQUIRE(status == CL_SUCCESS);
    }
    ~HostQueue() {
        clReleaseCommandQueue(queue_);
        clReleaseContext(context_);
    }
    HostQueue(const HostQueue&) = delete;
    HostQueue& operator=(const HostQueue&) = delete;

    LWDevice adopt() const {
        LWDeviceDesc desc;
        lwDefaultDevice(&desc);
        desc.width = 16;
        desc.clContext = context_;
        desc.clQueue = queue_;
        LWDevice device = nullptr;
        REQUIRE(lwCreateDevice(&desc, &device) == LW_SUCCESS);
        return device;
    }
    cl_context context() const { return context_; }
    cl_command_queue queue() const { return queue_; }

private:
    cl_device_id id_ = nullptr;
    cl_context context_ = nullptr;
    cl_command_queue queue_ = nullptr;
};

// An event of the host's that has not happened yet; happens at the end of the scope at the latest.
class Gate {
public:
    explicit Gate(const HostQueue& host) : event_(clCreateUserEvent(host.context(), nullptr)) {
        sync_.structSize = sizeof sync_;
        sync_.waitEventCount = 1;
        sync_.waitEvents = &event_;
    }
    ~Gate() {
        open();
        clReleaseEvent(static_cast<cl_event>(event_));
    }
    Gate(const Gate&) = delete;
    Gate& operator=(const Gate&) = delete;
    const LWSync* sync() const { return &sync_; }
    void open(cl_int status = CL_COMPLETE) {
        if (!opened_) clSetUserEventStatus(static_cast<cl_event>(event_), status);
        opened_ = true;
    }
    cl_uint references() const {
        cl_uint count = 0;
        clGetEventInfo(static_cast<cl_event>(event_), CL_EVENT_REFERENCE_COUNT, sizeof count, &count, nullptr);
        return count;
    }

private:
    void* event_;
    LWSync sync_{};
    bool opened_ = false;
};

struct WithHostQueue {
    explicit WithHostQueue(cl_command_queue_properties properties) : host(properties) {}
    HostQueue host;
};

// On a queue of the host's.
struct AdoptedRig : WithHostQueue, ApiRig {
    explicit AdoptedRig(const ApiScene& scene, cl_command_queue_properties properties = 0)
        : WithHostQueue(properties), ApiRig(host.adopt(), scene) {}
};

}  // namespace lightwell::test
