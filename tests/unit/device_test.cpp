// Devices: selection, width, adoption of the host's queue, limits, log, errors of execution.
#include <catch2/catch.hpp>

#include "support/errors.h"
#include "support/kernel_rig.h"
#include "support/scoped.h"
#include "support/test_device.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

Thrown openWith(const LWDeviceDesc& desc) {
    return thrown([&] { Device device(desc); });
}

std::string nameOf(const Device& device) {
    LWDeviceInfo info{};
    device.describe(info);
    return info.name;
}

}  // namespace

TEST_CASE("devices are listed and described without being opened", "[device]") {
    const std::uint32_t count = countDevices();
    REQUIRE(count > 0);
    for (std::uint32_t i = 0; i < count; ++i) {
        LWDeviceInfo info{};
        describeDevice(i, info);
        CHECK(std::string(info.name) != "");
        CHECK(info.computeUnits > 0);
        CHECK(info.globalMemoryBytes > 0);
        CHECK(info.width == 0);
    }
    LWDeviceInfo info{};
    const Thrown past = thrown([&] { describeDevice(count, info); });
    CHECK(past.status == LW_ERROR_INVALID_ARGUMENT);
    CHECK(past.says("got " + std::to_string(count)));
}

TEST_CASE("a device is selected by index, name or kind", "[device]") {
    const std::string name = nameOf(sharedDevice(1));
    LWDeviceDesc desc = plainDesc();
    desc.selector = name.c_str();
    CHECK(nameOf(Device(desc)) == name);

    // The variable speaks where the descriptor does not.
    const ScopedVariable variable("LIGHTWELL_DEVICE", name.c_str());
    desc.selector = nullptr;
    CHECK(nameOf(Device(desc)) == name);
    const ScopedVariable wrong("LIGHTWELL_DEVICE", "no such device");
    const Thrown environment = openWith(desc);
    CHECK(environment.status == LW_ERROR_NO_DEVICE);
    CHECK(environment.says("LIGHTWELL_DEVICE"));
    desc.selector = name.c_str();
    CHECK(nameOf(Device(desc)) == name);

    desc.selector = "7:99";
    const Thrown index = openWith(desc);
    CHECK(index.status == LW_ERROR_NO_DEVICE);
    CHECK(index.says("7:99"));
    CHECK(index.says(name));  // what was found is listed
}

TEST_CASE("the width is forced by descriptor or variable", "[device]") {
    LWDeviceDesc desc = plainDesc();
    for (const std::uint32_t width : {1u, 4u, 8u, 16u}) {
        desc.width = width;
        CHECK(Device(desc).width() == width);
    }
    for (const std::uint32_t width : {2u, 3u, 32u, 0xffffffffu}) {
        desc.width = width;
        const Thrown wrong = openWith(desc);
        CHECK(wrong.status == LW_ERROR_INVALID_ARGUMENT);
        CHECK(wrong.says("width"));
        CHECK(wrong.says(std::to_string(width)));
    }
    desc.width = 0;
    {
        const ScopedVariable variable("LIGHTWELL_WIDTH", "8");
        CHECK(Device(desc).width() == 8);
        desc.width = 4;
        CHECK(Device(desc).width() == 4);
        desc.width = 0;
    }
    for (const char* text : {"5", "16 lanes", "0", "-1"}) {
        const ScopedVariable variable("LIGHTWELL_WIDTH", text);
        const Thrown wrong = openWith(desc);
        CHECK(wrong.status == LW_ERROR_INVALID_ARGUMENT);
        CHECK(wrong.says("LIGHTWELL_WIDTH"));
        CHECK(wrong.says("1, 4, 8 or 16"));
        CHECK(wrong.says(text));
    }
}

TEST_CASE("a host's context and queue are adopted", "[device]") {
    const HostQueue host(CL_QUEUE_PROFILING_ENABLE), other(0);
    {
        const auto device = host.adopt();
        CHECK(device->context() == host.context());
        CHECK(device->queue() == host.queue());
        CHECK(device->profiling());
        CHECK_FALSE(device->outOfOrder());
        CHECK_FALSE(other.adopt()->profiling());
    }
    // The host's references are its own: its queue still works.
    CHECK(clFinish(host.queue()) == CL_SUCCESS);
    cl_uint references = 0;
    clGetCommandQueueInfo(host.queue(), CL_QUEUE_REFERENCE_COUNT, sizeof references, &references,
                          nullptr);
    CHECK(references == 1);

    LWDeviceDesc desc = plainDesc();
    desc.clContext = host.context();
    Thrown wrong = openWith(desc);
    CHECK(wrong.status == LW_ERROR_INVALID_ARGUMENT);
    CHECK(wrong.says("clQueue"));
    desc.clContext = nullptr;
    desc.clQueue = host.queue();
    wrong = openWith(desc);
    CHECK(wrong.status == LW_ERROR_INVALID_ARGUMENT);
    CHECK(wrong.says("clContext"));
    desc.clContext = other.context();
    wrong = openWith(desc);
    CHECK(wrong.status == LW_ERROR_INVALID_ARGUMENT);
    CHECK(wrong.says("another context"));
    desc.clContext = host.context();
    desc.maxComputeUnits = 1;
    wrong = openWith(desc);
    CHECK(wrong.status == LW_ERROR_INVALID_ARGUMENT);
    CHECK(wrong.says("maxComputeUnits"));
}

TEST_CASE("compute units are limited by a sub-device, or the refusal is clear", "[device]") {
    LWDeviceDesc desc = plainDesc();
    desc.maxComputeUnits = 100000;
    CHECK(Device(desc).computeUnits() == sharedDevice(1).computeUnits());
    if (sharedDevice(1).computeUnits() < 2) return;
    desc.maxComputeUnits = 1;
    std::unique_ptr<Device> device;
    const Thrown refused = thrown([&] { device = freshDevice(desc); });
    if (refused.status) {
        CHECK(refused.status == LW_ERROR_UNSUPPORTED);
        CHECK(refused.says("maxComputeUnits"));
        return;
    }
    CHECK(device->computeUnits() == 1);
    Profile profile;
    Executor executor(*device, profile);
    const Buffer values(*device, 256, "values");
    std::vector<cl_int> read(64);
    executor.fill("test.fill", values, 4, 0, 256);
    executor.run("test.add", device->programs().kernel("executor_test", "add_one"), {64, 1}, {16, 1},
                 values, cl_int(64));
    executor.read("test.read", values.get(), 0, 256, read.data());
    device->finish();
    CHECK(read == std::vector<cl_int>(64, 5));
}

TEST_CASE("a device can be opened without event timing", "[device]") {
    LWDeviceDesc desc = plainDesc();
    desc.noProfiling = 1;
    const Device device(desc);
    CHECK_FALSE(device.profiling());
    LWDeviceInfo info{};
    device.describe(info);
    CHECK(info.hasProfiling == 0);
}

TEST_CASE("the log reaches the callback, which is known to be inside", "[device]") {
    struct State {
        const Device* device = nullptr;
        bool inside = false;
        std::string text;
    } state;
    LWDeviceDesc desc = plainDesc();
    desc.logUser = &state;
    desc.log = [](void* user, LWLogLevel, const char* message) {
        State& s = *static_cast<State*>(user);
        s.inside = s.device && s.device->insideLog();
        s.text = message;
    };
    const Device device(desc);
    state.device = &device;
    CHECK_FALSE(device.insideLog());
    device.log(LW_LOG_WARNING, "hello");
    CHECK(state.inside);
    CHECK(state.text == "hello");
    CHECK_FALSE(device.insideLog());
}

TEST_CASE("errors of execution surface at finish or the next call, once", "[device]") {
    const bool atFinish = GENERATE(true, false);
    const auto device = freshDevice();
    Profile profile;
    Executor executor(*device, profile);
    const Buffer values(*device, 256, "values");
    cl_event gate = clCreateUserEvent(device->context(), nullptr);
    void* waits[] = {gate};
    LWSync sync{};
    sync.structSize = sizeof sync;
    sync.waitEventCount = 1;
    sync.waitEvents = waits;
    executor.waitFor(&sync);
    executor.run("test.add", device->programs().kernel("executor_test", "add_one"), {64, 1}, {16, 1},
                 values, cl_int(64));
    clSetUserEventStatus(gate, -7777);
    if (!atFinish) clFinish(device->queue());
    const Thrown failed = thrown([&] { atFinish ? device->finish() : device->raiseFailure(); });
    CHECK(failed.status == LW_ERROR_DEVICE);
    CHECK(failed.says("failed"));
    clReleaseEvent(gate);
    CHECK(thrown([&] { device->raiseFailure(); }).status == LW_SUCCESS);
    CHECK(thrown([&] { device->finish(); }).status == LW_SUCCESS);
}

TEST_CASE("many frames without a finish keep few events", "[device]") {
    KernelRig rig(1);
    const Guarded values = rig.upload(std::vector<cl_int>(16, 0));
    Kernel& add = rig.kernel("executor_test", "add_one");
    constexpr int kLaunches = 3000;
    for (int i = 0; i < kLaunches; ++i) {
        rig.executor().run("test.add", add, {16, 1}, {16, 1}, values, cl_int(16));
        if (i % 100 == 0) rig.executor().flush();
    }
    CHECK(rig.download<cl_int>(values) == std::vector<cl_int>(16, kLaunches));
}

TEST_CASE("watching a command costs the same, however many are pending", "[device]") {
    const auto device = freshDevice();
    cl_event gate = clCreateUserEvent(device->context(), nullptr);
    EventWatch watch;
    constexpr std::uint64_t kEvents = 20000;
    for (std::uint64_t i = 0; i < kEvents; ++i) watch.add(gate);
    CHECK(watch.pending() == kEvents);
    CHECK(watch.queries() <= kEvents);  // looking through all of them each time would take 2e8
    clSetUserEventStatus(gate, CL_COMPLETE);
    watch.collect();
    CHECK(watch.pending() == 0);
    CHECK(watch.queries() <= 2 * kEvents);
    CHECK(watch.failure().empty());
    // While commands end, few are held.
    for (std::uint64_t i = 0; i < kEvents; ++i) watch.add(gate);
    CHECK(watch.pending() <= 1024);
    CHECK(watch.queries() <= 3 * kEvents);
    clReleaseEvent(gate);
}

TEST_CASE("of failed commands the first is told", "[device]") {
    const auto device = freshDevice();
    EventWatch watch;
    for (const cl_int status : {CL_COMPLETE, CL_OUT_OF_RESOURCES, CL_INVALID_VALUE}) {
        cl_event event = clCreateUserEvent(device->context(), nullptr);
        clSetUserEventStatus(event, status);
        watch.add(event);
        clReleaseEvent(event);
    }
    watch.collect();
    CHECK(watch.takeFailure() == "CL_OUT_OF_RESOURCES");
    CHECK(watch.failure().empty());
    CHECK(watch.pending() == 0);
}
