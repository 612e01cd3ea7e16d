// The executor: arguments, ranges, order, transfers, events, timings, counters.
#include <catch2/catch.hpp>

#include "support/errors.h"
#include "support/kernel_rig.h"
#include "support/test_device.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr const char* kProgram = "executor_test";

std::uint64_t specialised(const Device& device) {
    LWDeviceInfo info{};
    device.describe(info);
    return info.kernelsSpecialised;
}

// The value after `steps` of v -> 2 v + 1 from 0, modulo 2^32.
std::uint32_t doubled(int steps) {
    std::uint32_t value = 0;
    for (int i = 0; i < steps; ++i) value = 2 * value + 1;
    return value;
}

// `steps` launches that each read what the one before wrote; returns the first value.
std::uint32_t pingPong(Device& device, int steps) {
    Profile profile;
    Executor executor(device, profile);
    Kernel& kernel = device.programs().kernel(kProgram, "twice_and_one");
    Buffer a(device, 64 * 4, "a"), b(device, 64 * 4, "b");
    executor.fill("test.fill", a, 0, 0, a.bytes());
    for (int i = 0; i < steps; ++i) {
        executor.run("test.step", kernel, {64, 1}, {16, 1}, a, b);
        std::swap(a, b);
    }
    std::uint32_t value = 0;
    executor.read("test.read", a.get(), 0, sizeof value, &value);
    device.finish();
    return value;
}

}  // namespace

TEST_CASE("every kind of argument reaches the kernel", "[executor]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    const std::uint32_t w = 20, h = 3;
    std::vector<float> packed(w * h * 2);
    for (std::size_t i = 0; i < packed.size(); ++i) packed[i] = float(i);
    const Guarded from = rig.uploadPlanes(packed, w, h, 2, -1.0f), to = rig.makePlanes(w, h, 2);
    // The source upside down: a start at the last row and a negative row stride.
    Planes flipped = rig.planes(from, w, h, 2);
    flipped.offset = flipped.rowStride * (h - 1);
    flipped.rowStride = -flipped.rowStride;
    const cl_float4 quad = {{0, 0, 0, 4.0f}};
    rig.run("test.kinds", rig.kernel(kProgram, "all_kinds"), {paddedWidth(w) / width, h}, {1, 1},
            flipped, rig.planes(to, w, h, 2), 0.5f, cl_int(-3), cl_uint(2), quad);
    std::vector<float> expected;
    for (std::uint32_t plane = 0; plane < 2; ++plane)
        for (std::uint32_t y = 0; y < h; ++y)
            for (std::uint32_t x = 0; x < w; ++x)
                expected.push_back(0.5f * packed[(plane * h + (h - 1 - y)) * w + x] - 3 + 2 + 4);
    CHECK(rig.downloadPlanes(rig.planes(to, w, h, 2)) == expected);
    CHECK(rig.downloadPlanes(flipped).front() == packed[(h - 1) * w]);
}

TEST_CASE("wrong launches are refused", "[executor]") {
    KernelRig rig(1);
    Executor& executor = rig.executor();
    Kernel& add = rig.kernel(kProgram, "add_one");
    const Guarded values = rig.make<cl_int>(64);
    const Thrown few = thrown([&] { executor.run("test.add", add, {64, 1}, {1, 1}, values); });
    CHECK(few.status == LW_ERROR_INTERNAL);
    CHECK(few.says("takes 2 arguments, got 1"));
    CHECK(thrown([&] {
              executor.run("t", add, {64, 1}, {1, 1}, values, cl_int(1), cl_int(1));
          }).status == LW_ERROR_INTERNAL);
    CHECK(thrown([&] {
              executor.run("t", add, {64, 1}, {1, 1}, values, 1.0);
          }).status == LW_ERROR_INTERNAL);
    CHECK(thrown([&] {
              executor.run("t", add, {0, 1}, {1, 1}, values, cl_int(64));
          }).status == LW_ERROR_INTERNAL);
    CHECK(thrown([&] {
              executor.run("t", add, {64, 0}, {1, 1}, values, cl_int(64));
          }).status == LW_ERROR_INTERNAL);
    CHECK(thrown([&] {
              executor.run("t", add, {64, 1}, {0, 1}, values, cl_int(64));
          }).status == LW_ERROR_INTERNAL);
    const Thrown group = thrown([&] {
        executor.run("t", add, {64, 1}, {1 << 20, 1}, values, cl_int(64));
    });
    CHECK(group.status == LW_ERROR_UNSUPPORTED);
    CHECK(group.says("add_one"));
    Planes far;
    far.memory = values.get();
    far.planeStride = std::int64_t(1) << 31;
    CHECK(thrown([&] {
              executor.run("t", rig.kernel(kProgram, "all_kinds"), {1, 1}, {1, 1}, far);
          }).status == LW_ERROR_UNSUPPORTED);
}

TEST_CASE("ranges are rounded up to whole groups", "[executor]") {
    KernelRig rig(1);
    const cl_int w = 37, h = 11;
    const Guarded cells = rig.upload(std::vector<cl_int>(std::size_t(w * h), 0));
    rig.run("test.visit", rig.kernel(kProgram, "visit"), {37, 11}, {8, 4}, cells, w, h);
    CHECK(rig.download<cl_int>(cells) == std::vector<cl_int>(std::size_t(w * h), 1));
}

TEST_CASE("transfers move the right bytes and count them", "[executor]") {
    KernelRig rig(1);
    Executor& executor = rig.executor();
    const std::vector<cl_int> values{1, 2, 3, 4, 5, 6, 7, 8};
    const Guarded a = rig.upload(values), b = rig.upload(std::vector<cl_int>(8, 0));
    const std::uint64_t before = executor.copiedBytes();
    executor.copy("test.copy", a.get(), b.get(), 4, 8, 12);
    executor.fill("test.fill", b, 77, 24, 8);
    const cl_int nine = 9;
    executor.write("test.write", b, 0, 4, &nine);
    rig.device().finish();
    CHECK(executor.copiedBytes() == before + 4);
    CHECK(rig.download<cl_int>(b) == std::vector<cl_int>{9, 0, 2, 3, 4, 0, 77, 77});
    CHECK(thrown([&] { executor.write("t", b, b.bytes() - 2, 4, &nine); }).status == LW_ERROR_INTERNAL);
    CHECK(thrown([&] { executor.fill("t", b, 0, b.bytes() + 4, 4); }).status == LW_ERROR_INTERNAL);
}

TEST_CASE("launches run in order on in-order and out-of-order queues", "[executor]") {
    constexpr int kSteps = 300;
    CHECK(pingPong(sharedDevice(1), kSteps) == doubled(kSteps));
    if (!HostQueue::supports(CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE)) return;
    const HostQueue host(CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE);
    const auto device = host.adopt();
    CHECK(device->outOfOrder());
    CHECK_FALSE(device->profiling());
    CHECK(pingPong(*device, kSteps) == doubled(kSteps));
}

TEST_CASE("passes are timed and summed by name", "[executor]") {
    KernelRig rig(1);
    REQUIRE(rig.device().profiling());
    const Guarded values = rig.upload(std::vector<cl_int>(1 << 16, 0));
    Profile profile;
    CHECK(profile.passes().empty());
    CHECK(profile.totalMilliseconds() == -1.0);
    Executor executor(rig.device(), profile);
    Kernel& add = rig.kernel(kProgram, "add_one");
    executor.run("test.first", add, {1 << 16, 1}, {64, 1}, values, cl_int(1 << 16));
    executor.fill("test.second", values, 0, 0, values.dataBytes());
    executor.run("test.first", add, {1 << 16, 1}, {64, 1}, values, cl_int(1 << 16));
    rig.device().finish();
    const std::vector<LWPassTime> passes = profile.passes();
    REQUIRE(passes.size() == 2);
    CHECK(std::string(passes[0].name) == "test.first");
    CHECK(passes[0].launches == 2);
    CHECK(passes[1].launches == 1);
    CHECK(passes[0].milliseconds > 0.0);
    CHECK(passes[1].milliseconds > 0.0);
    if (driverIs("rusticl")) return;  // Mesa 22.3's Rusticl stamps every command 1 ns long
    // In order: the commands do not overlap, so the whole takes at least their sum (1 % for clock
    // steps).
    CHECK(profile.totalMilliseconds() >= 0.99 * (passes[0].milliseconds + passes[1].milliseconds));
    profile.clear();
    CHECK(profile.passes().empty());
}

TEST_CASE("without profiling, passes are counted and their time is unavailable", "[executor]") {
    const HostQueue host(0);
    const auto device = host.adopt();
    Profile profile;
    Executor executor(*device, profile);
    const Buffer values(*device, 256, "values");
    executor.fill("test.fill", values, 0, 0, 256);
    device->finish();
    const std::vector<LWPassTime> passes = profile.passes();
    REQUIRE(passes.size() == 1);
    CHECK(passes[0].launches == 1);
    CHECK(passes[0].milliseconds == -1.0);
    CHECK(profile.totalMilliseconds() == -1.0);
}

TEST_CASE("commands wait for the host's events and signal one back", "[executor]") {
    KernelRig rig(1);
    Device& device = rig.device();
    const Guarded values = rig.upload(std::vector<cl_int>(16, 0));
    cl_event gate = clCreateUserEvent(device.context(), nullptr);
    void* waits[] = {gate};
    void* signalled = nullptr;
    LWSync sync{};
    sync.structSize = sizeof sync;
    sync.waitEventCount = 1;
    sync.waitEvents = waits;
    sync.signalEvent = &signalled;
    rig.executor().waitFor(&sync);
    rig.executor().run("test.add", rig.kernel(kProgram, "add_one"), {16, 1}, {16, 1}, values,
                       cl_int(16));
    rig.executor().signal(&sync);
    REQUIRE(signalled);
    cl_event event = static_cast<cl_event>(signalled);
    cl_int status = CL_COMPLETE;
    clGetEventInfo(event, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof status, &status, nullptr);
    CHECK(status > CL_COMPLETE);  // nothing can have run yet
    clSetUserEventStatus(gate, CL_COMPLETE);
    CHECK(clWaitForEvents(1, &event) == CL_SUCCESS);
    clReleaseEvent(event);
    clReleaseEvent(gate);
    CHECK(rig.download<cl_int>(values) == std::vector<cl_int>(16, 1));

    rig.executor().waitFor(nullptr);
    rig.executor().signal(nullptr);
    waits[0] = nullptr;
    const Thrown null = thrown([&] { rig.executor().waitFor(&sync); });
    CHECK(null.status == LW_ERROR_INVALID_ARGUMENT);
    CHECK(null.says("waitEvents[0]"));
}

TEST_CASE("first launches of a kernel and local size are counted", "[executor]") {
    const auto device = freshDevice();
    Profile profile;
    Executor executor(*device, profile);
    const Buffer values(*device, 256, "values");
    Kernel& add = device->programs().kernel(kProgram, "add_one");
    Kernel& same = device->programs().kernel(kProgram, "add_one");
    CHECK(&add == &same);
    const std::uint64_t before = specialised(*device);
    for (int i = 0; i < 3; ++i) executor.run("test.add", add, {64, 1}, {16, 1}, values, cl_int(64));
    CHECK(specialised(*device) == before + 1);
    executor.run("test.add", add, {48, 1}, {16, 1}, values, cl_int(64));
    CHECK(specialised(*device) == before + 1);
    executor.run("test.add", add, {64, 1}, {8, 1}, values, cl_int(64));
    CHECK(specialised(*device) == before + 2);
    device->finish();
}

TEST_CASE("times of a frame without end are summed up, not piled up", "[executor][large]") {
    const auto device = freshDevice();
    Profile profile;
    Executor executor(*device, profile);
    const Buffer values(*device, 256, "values");
    constexpr std::uint32_t kRounds = 20, kFills = 500;
    for (std::uint32_t round = 0; round < kRounds; ++round) {
        for (std::uint32_t i = 0; i < kFills; ++i) executor.fill("test.fill", values, i, 0, 256);
        device->finish();
    }
    CHECK(profile.heldEntries() < kRounds * kFills / 2);
    const auto passes = profile.passes();
    REQUIRE(passes.size() == 1);
    CHECK(passes[0].launches == kRounds * kFills);
    CHECK(passes[0].milliseconds > 0.0);
    CHECK(profile.totalMilliseconds() >= passes[0].milliseconds);
}
