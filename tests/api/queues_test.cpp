// Queues of the host's: order, waits that a refused call leaves behind, threads that wait while others go on,
// kernels kept for the next start.
#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <future>
#include <thread>

#include "api/api_rig.h"
#include "support/scoped.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;

namespace {

// Time for another thread to get into a call's wait; and for a call that must not wait, on a busy machine.
constexpr auto kIntoWait = std::chrono::milliseconds(300);
constexpr auto kPatience = std::chrono::seconds(20);

bool supports(cl_command_queue_properties properties) {
    cl_platform_id platform = nullptr;
    cl_device_id id = nullptr;
    cl_command_queue_properties supported = 0;
    clGetPlatformIDs(1, &platform, nullptr);
    clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &id, nullptr);
    clGetDeviceInfo(id, CL_DEVICE_QUEUE_PROPERTIES, sizeof supported, &supported, nullptr);
    return (supported & properties) == properties;
}

std::vector<double> pixelsOf(const ApiScene& scene) {
    std::vector<double> all;
    for (std::uint32_t y = 0; y < scene.irradiance.height(); ++y)
        for (std::uint32_t x = 0; x < scene.irradiance.width(); ++x)
            for (int c = 0; c < 3; ++c) all.push_back(scene.irradiance.value(x, y, c));
    return all;
}

}  // namespace

TEST_CASE("a refused call leaves no wait in the host's queue", "[api][queues]") {
    ApiScene scene;
    AdoptedRig rig(scene);
    REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
    REQUIRE(lwFinish(rig.device) == LW_SUCCESS);
    Gate gate(rig.host);
    SECTION("lwUpdate") {
        LWFrame frame = scene.frame;
        LWRsm rsm = scene.rsm;
        LWLight light = scene.light;
        rsm.flux.width = 3;  // found out after the waits were noted
        light.rsms = &rsm;
        frame.lights = &light;
        frame.sync = gate.sync();
        CHECK(lwUpdate(rig.technique, &frame) == LW_ERROR_INVALID_ARGUMENT);
    }
    SECTION("lwRender") {
        LWGBuffer gbuffer = scene.gbuffer;
        gbuffer.normal.width = 3;
        LWOutput output = scene.output;
        output.sync = gate.sync();
        CHECK(lwRender(rig.technique, rig.view, &gbuffer, &output) == LW_ERROR_INVALID_ARGUMENT);
    }
    SECTION("lwRender without lwUpdate") {
        LWTechnique fresh = nullptr;
        REQUIRE(lwCreateRsm(rig.device, nullptr, &fresh) == LW_SUCCESS);
        LWOutput output = scene.output;
        output.sync = gate.sync();
        CHECK(lwRender(fresh, rig.view, &scene.gbuffer, &output) == LW_ERROR_NOT_UPDATED);
        lwReleaseTechnique(fresh);
    }
    CHECK(gate.references() == 1);  // the host's alone
    // The host's own commands, and later frames, do not wait for an event that may never come.
    auto finished = std::async(std::launch::async, [&] { clFinish(rig.host.queue()); });
    CHECK(finished.wait_for(kPatience) == std::future_status::ready);
    auto rendered = std::async(std::launch::async, [&] {
        return lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS &&
               lwFinish(rig.device) == LW_SUCCESS;
    });
    CHECK(rendered.wait_for(kPatience) == std::future_status::ready);
    gate.open();  // in case it did wait
    CHECK(rendered.get());
    CHECK(scene.lit());
}

TEST_CASE("waiting threads wait for what came before them, and hold up nobody", "[api][queues][threads]") {
    ApiScene scene, other;
    AdoptedRig rig(scene);
    LWTechnique second = nullptr;
    REQUIRE(lwCreateRsm(rig.device, nullptr, &second) == LW_SUCCESS);
    // The first launches compile, which is no part of this.
    REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
    REQUIRE(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    REQUIRE(lwUpdate(second, &other.frame) == LW_SUCCESS);
    REQUIRE(lwRender(second, rig.view, &other.gbuffer, &other.output) == LW_SUCCESS);
    REQUIRE(lwFinish(rig.device) == LW_SUCCESS);

    const int kind = GENERATE(0, 1, 2);
    CAPTURE(kind);
    Gate first(rig.host), later(rig.host);
    LWFrame frame = scene.frame;
    frame.sync = first.sync();
    frame.frameIndex = 77;
    REQUIRE(lwUpdate(rig.technique, &frame) == LW_SUCCESS);
    REQUIRE(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    LWStats stats{};
    stats.structSize = sizeof stats;
    std::vector<float> pixels(24 * 10 * 3, -1.0f);
    auto waiting = std::async(std::launch::async, [&] {
        if (kind == 0) return lwFinish(rig.device);
        if (kind == 1) return lwGetStats(rig.technique, &stats);
        return lwReadDebugView(rig.technique, rig.view, "position", pixels.data(), pixels.size());
    });
    std::this_thread::sleep_for(kIntoWait);
    // Everything else goes on: queries, a whole frame behind a second gate, even the end of the handle.
    auto others = std::async(std::launch::async, [&] {
        LWDeviceInfo info{};
        info.structSize = sizeof info;
        if (lwGetDeviceInfo(rig.device, &info)) return false;
        LWFrame next = other.frame;
        next.sync = later.sync();
        return !lwUpdate(second, &next) && !lwRender(second, rig.view, &other.gbuffer, &other.output) &&
               !lwReleaseTechnique(rig.technique);
    });
    CHECK(others.wait_for(kPatience) == std::future_status::ready);
    CHECK(waiting.wait_for(std::chrono::seconds(0)) == std::future_status::timeout);
    first.open();
    // Not for the second gate, which is still closed.
    CHECK(waiting.wait_for(kPatience) == std::future_status::ready);
    later.open();
    CHECK(others.get());
    CHECK(waiting.get() == LW_SUCCESS);
    if (kind == 1) {
        CHECK(stats.frameIndex == 77);
        CHECK(stats.passCount > 0);
    }
    if (kind == 2) CHECK(pixels[24 * 10] == 0.5f);
    CHECK(lwFinish(rig.device) == LW_SUCCESS);
    CHECK(scene.lit());
    CHECK(other.lit());
    CHECK(lwReleaseTechnique(rig.technique) == LW_ERROR_INVALID_HANDLE);
    rig.technique = second;
}

TEST_CASE("threads wait, read and release beside each other", "[api][queues][threads]") {
    ApiScene scene;
    const LWDevice device = makeDevice(16);
    LWTechnique technique = nullptr;
    LWView view = nullptr;
    const LWViewDesc desc = scene.viewDesc();
    REQUIRE(lwCreateView(device, &desc, &view) == LW_SUCCESS);
    REQUIRE(lwCreateRsm(device, nullptr, &technique) == LW_SUCCESS);
    std::atomic<int> failures{0}, left{3};
    const auto expect = [&](LWStatus status) {
        if (status != LW_SUCCESS) ++failures;
    };
    std::vector<std::thread> threads;
    threads.emplace_back([&] {  // frames
        for (int i = 0; i < 40; ++i) {
            expect(lwUpdate(technique, &scene.frame));
            expect(lwRender(technique, view, &scene.gbuffer, &scene.output));
        }
        --left;
    });
    threads.emplace_back([&] {  // readers
        std::vector<float> pixels(1 << 16);
        for (int i = 0; i < 40; ++i) {
            LWStats stats{};
            stats.structSize = sizeof stats;
            expect(lwGetStats(technique, &stats));
            for (std::uint32_t p = 0; p < stats.passCount; ++p)
                if (stats.passes[p].milliseconds < 0.0) ++failures;
            std::uint32_t count = 0;
            expect(lwCountDebugViews(technique, view, &count));
            // "none yet" until the first frame
            if (count) expect(lwReadDebugView(technique, nullptr, "vpls", pixels.data(), pixels.size()));
        }
        --left;
    });
    threads.emplace_back([&] {  // techniques and views come and go
        for (int i = 0; i < 10; ++i) {
            ApiScene own;
            LWTechnique passing = nullptr;
            LWView passingView = nullptr;
            expect(lwCreateView(device, &desc, &passingView));
            expect(lwCreateRsm(device, nullptr, &passing));
            expect(lwUpdate(passing, &own.frame));
            expect(lwRender(passing, passingView, &own.gbuffer, &own.output));
            expect(lwReleaseView(passingView));
            expect(lwReleaseTechnique(passing));
            expect(lwFinish(device));
        }
        --left;
    });
    threads.emplace_back([&] {
        while (left > 0) expect(lwFinish(device));
    });
    for (std::thread& thread : threads) thread.join();
    CHECK(failures == 0);
    CHECK(scene.lit());
    lwReleaseTechnique(technique);
    lwReleaseView(view);
    lwReleaseDevice(device);
}

TEST_CASE("a failed wait surfaces at every call that waits", "[api][queues]") {
    ApiScene scene;
    AdoptedRig rig(scene);
    Gate gate(rig.host);
    scene.frame.sync = gate.sync();
    REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
    gate.open(-7777);
    LWStats stats{};
    stats.structSize = sizeof stats;
    switch (GENERATE(0, 1, 2)) {
        case 0: CHECK(lwFinish(rig.device) == LW_ERROR_DEVICE); break;
        case 1: CHECK(lwGetStats(rig.technique, &stats) == LW_ERROR_DEVICE); break;
        default: {
            std::vector<float> pixels(1 << 16);
            CHECK(lwReadDebugView(rig.technique, nullptr, "vpls", pixels.data(), pixels.size()) == LW_ERROR_DEVICE);
        }
    }
    CHECK_THAT(lastError(rig.device), Contains("failed on the device"));
    clFinish(rig.host.queue());
}

TEST_CASE("debug views are counted and described without a trace", "[api]") {
    ApiScene scene;
    AdoptedRig rig(scene);
    REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
    REQUIRE(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    REQUIRE(lwFinish(rig.device) == LW_SUCCESS);
    const LWDeviceInfo before = rig.info();
    // A frame that cannot run yet: whoever waits for the queue stays here.
    Gate gate(rig.host);
    scene.frame.sync = gate.sync();
    REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
    REQUIRE(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    auto asked = std::async(std::launch::async, [&] {
        std::uint32_t count = 0;
        if (lwCountDebugViews(rig.technique, rig.view, &count) || count == 0) return false;
        for (std::uint32_t i = 0; i < count; ++i) {
            LWDebugView view{};
            view.structSize = sizeof view;
            if (lwDescribeDebugView(rig.technique, rig.view, i, &view) || view.width == 0) return false;
        }
        return true;
    });
    CHECK(asked.wait_for(kPatience) == std::future_status::ready);
    gate.open();
    CHECK(asked.get());
    const LWDeviceInfo after = rig.info();
    CHECK(after.allocatedBytes == before.allocatedBytes);
    CHECK(after.kernelsSpecialised == before.kernelsSpecialised);
    // Reading makes the view, and leaves nothing behind either.
    std::vector<float> pixels(1 << 16);
    REQUIRE(lwReadDebugView(rig.technique, nullptr, "vpls", pixels.data(), pixels.size()) == LW_SUCCESS);
    CHECK(rig.info().allocatedBytes == before.allocatedBytes);
}

TEST_CASE("an out-of-order queue gives the bits of an in-order one", "[api][queues]") {
    if (!supports(CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE)) {
        WARN("this device has no out-of-order queues");
        return;
    }
    const auto frames = [](cl_command_queue_properties properties) {
        ApiScene scene(131, 57);
        AdoptedRig rig(scene, properties);
        // Frames that overwrite each other's buffers, all enqueued before any may start.
        Gate gate(rig.host);
        ApiScene dark(131, 57);
        for (std::uint32_t y = 0; y < ApiScene::kRsm; ++y)
            for (std::uint32_t x = 0; x < ApiScene::kRsm; ++x) dark.rsmFlux.set(x, y, 0, 0, 0);
        scene.frame.sync = gate.sync();
        // The last frame's result goes to memory of the host's on the device.
        std::vector<float> seen(131 * 57 * 3, -1.0f);
        cl_int status = 0;
        const cl_mem result =
            clCreateBuffer(rig.host.context(), CL_MEM_READ_WRITE, seen.size() * 4, nullptr, &status);
        REQUIRE(status == CL_SUCCESS);
        for (int i = 0; i < 5; ++i) {
            REQUIRE(lwUpdate(rig.technique, i % 2 ? &dark.frame : &scene.frame) == LW_SUCCESS);
            ApiScene& into = i % 2 ? dark : scene;
            if (i == 4) {
                into.output.irradiance.host = nullptr;
                into.output.irradiance.clMem = result;
                into.output.irradiance.byteOffset = 0;
            }
            REQUIRE(lwRender(rig.technique, rig.view, &into.gbuffer, &into.output) == LW_SUCCESS);
        }
        // The host's own command, enqueued after them without an event, runs after them too.
        REQUIRE(clEnqueueReadBuffer(rig.host.queue(), result, CL_FALSE, 0, seen.size() * 4, seen.data(), 0, nullptr,
                                    nullptr) == CL_SUCCESS);
        gate.open();
        REQUIRE(lwFinish(rig.device) == LW_SUCCESS);
        clFinish(rig.host.queue());
        clReleaseMemObject(result);
        const std::vector<double> black = pixelsOf(dark);
        CHECK(std::count(black.begin(), black.end(), 0.0) == std::ptrdiff_t(black.size()));
        const std::vector<double> last(seen.begin(), seen.end());
        CHECK(last == pixelsOf(scene));  // of the frame before: the same input
        return last;
    };
    CHECK(frames(CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE) == frames(0));
}

TEST_CASE("a host that never finishes finds its kernels at the next start", "[api][queues]") {
    const ScopedDirectory directory;
    const std::string path = directory.string();
    const auto start = [&](bool waits) {
        LWDeviceDesc desc;
        lwDefaultDevice(&desc);
        desc.width = 16;
        desc.cacheDirectory = path.c_str();
        LWDevice device = nullptr;
        REQUIRE(lwCreateDevice(&desc, &device) == LW_SUCCESS);
        ApiScene scene;
        LWTechnique technique = nullptr;
        LWView view = nullptr;
        const LWViewDesc viewDesc = scene.viewDesc();
        REQUIRE(lwCreateView(device, &viewDesc, &view) == LW_SUCCESS);
        REQUIRE(lwCreateRsm(device, nullptr, &technique) == LW_SUCCESS);
        void* signal = nullptr;
        LWSync sync{};
        sync.structSize = sizeof sync;
        sync.signalEvent = &signal;
        scene.output.sync = &sync;
        REQUIRE(lwUpdate(technique, &scene.frame) == LW_SUCCESS);
        REQUIRE(lwRender(technique, view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
        LWDeviceInfo info{};
        info.structSize = sizeof info;
        REQUIRE(lwGetDeviceInfo(device, &info) == LW_SUCCESS);
        const cl_event done = static_cast<cl_event>(signal);
        REQUIRE(clWaitForEvents(1, &done) == CL_SUCCESS);
        clReleaseEvent(done);
        if (waits) REQUIRE(lwFinish(device) == LW_SUCCESS);
        REQUIRE(lwReleaseDevice(device) == LW_SUCCESS);
        REQUIRE(lwReleaseView(view) == LW_SUCCESS);
        REQUIRE(lwReleaseTechnique(technique) == LW_SUCCESS);  // the last that holds the device
        return info;
    };
    const LWDeviceInfo first = start(false);
    CHECK(first.programsBuilt > 0);
    const LWDeviceInfo second = start(false);
    CHECK(second.programsBuilt == 0);
    CHECK(second.programsLoaded == first.programsBuilt);
}
