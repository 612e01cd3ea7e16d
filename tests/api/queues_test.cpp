// Queues of the host's: order, waits that a refused call leaves behind, failures, kernels kept for the next start.
#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <future>

#include "api/api_rig.h"
#include "support/scoped.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;

namespace {

// Time for a call that must not wait, on a busy machine.
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
    SECTION("lwRenderPoints") {
        LWImage positions = scene.position.image();  // 2-D: no list
        LWPointOutput output{};
        output.structSize = sizeof output;
        output.validity = scene.validity.image();
        output.sync = gate.sync();
        CHECK(lwRenderPoints(rig.technique, &positions, nullptr, 24, &output) == LW_ERROR_INVALID_ARGUMENT);
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
