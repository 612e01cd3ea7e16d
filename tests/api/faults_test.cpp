// A driver that fails: at any call, and while executing. Whatever fails, the call says so, nothing is lost or
// left waiting, and the next frame is right.
#include <catch2/catch.hpp>
#include <chrono>
#include <future>
#include <thread>

#include "api/api_rig.h"
#include "support/cl_faults.h"
#include "support/scoped.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;

namespace {

// Time for another thread to get into a call's wait; and for a call that must not wait, on a busy machine.
constexpr auto kIntoWait = std::chrono::milliseconds(300);
constexpr auto kPatience = std::chrono::seconds(20);
// A frame makes fewer calls than that.
constexpr int kMostCalls = 1000;

LWDevice deviceWith(const char* unified) {
    const ScopedVariable variable("LIGHTWELL_UNIFIED_MEMORY", unified);
    return makeDevice(16, [](void*, LWLogLevel, const char*) {});
}

std::vector<double> pixelsOf(const ApiScene& scene) {
    std::vector<double> all;
    for (std::uint32_t y = 0; y < scene.irradiance.height(); ++y)
        for (std::uint32_t x = 0; x < scene.irradiance.width(); ++x) {
            for (int c = 0; c < 3; ++c) all.push_back(scene.irradiance.value(x, y, c));
            all.push_back(scene.validity.value(x, y, 0));
        }
    return all;
}

bool isDriverError(LWStatus status) {
    return status == LW_ERROR_OUT_OF_MEMORY || status == LW_ERROR_DEVICE || status == LW_ERROR_INTERNAL;
}

// A frame with all that a host can ask for.
struct Whole : ApiScene {
    Whole() {
        vpl.normal[1] = 1;
        vpl.flux[0] = 0.1f;
        frame.vpls = &vpl;
        frame.vplCount = 1;
        rsm.version = 1;
    }
    // In the map's own memory.
    void scaleFlux(double factor) {
        for (std::uint32_t y = 0; y < rsmFlux.height(); ++y)
            for (std::uint32_t x = 0; x < rsmFlux.width(); ++x)
                rsmFlux.set(x, y, factor * rsmFlux.value(x, y, 0), factor * rsmFlux.value(x, y, 1), factor * rsmFlux.value(x, y, 2));
        ++rsm.version;
    }
    LWVpl vpl{};
};

}  // namespace

TEST_CASE("whichever OpenCL call of a frame fails, it is told, and the next frame is right", "[faults]") {
    const char* unified = GENERATE(as<const char*>{}, "1", "0");
    const auto resolution = GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_HALF);
    LWRsmDesc desc;
    lwDefaultRsm(&desc);
    desc.resolution = resolution;
    Whole scene;
    ApiRig rig(deviceWith(unified), scene, &desc);
    rig.frame(scene);
    const std::vector<double> expected = pixelsOf(scene);
    const std::uint64_t held = rig.info().allocatedBytes;
    lwReleaseTechnique(rig.technique);
    int faults = 0;
    for (int call = 0; call < kMostCalls; ++call) {
        REQUIRE(lwCreateRsm(rig.device, &desc, &rig.technique) == LW_SUCCESS);
        const bool again = call % 2 == 0;  // the fault in the second frame, or in the first
        if (again) {
            scene.scaleFlux(0.5);  // so that texels that stay where they should not are seen
            rig.frame(scene);
            scene.scaleFlux(2.0);
        }
        LWStats stats{};
        stats.structSize = sizeof stats;
        std::vector<float> list(1 << 14);
        LWStatus all[5];
        bool happened = false;
        std::string function;
        {
            const ClFault fault(call / 2, CL_OUT_OF_RESOURCES);
            all[0] = lwUpdate(rig.technique, &scene.frame);
            all[1] = lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output);
            all[2] = lwGetStats(rig.technique, &stats);
            all[3] = lwReadDebugView(rig.technique, nullptr, "vpls", list.data(), list.size());
            all[4] = lwFinish(rig.device);
            happened = fault.happened();
            function = fault.function();
        }
        CAPTURE(unified, resolution, call, again, function, all[0], all[1], all[2], all[3], all[4]);
        if (!happened) {
            for (const LWStatus status : all) CHECK(status == LW_SUCCESS);
            lwReleaseTechnique(rig.technique);
            if (again) continue;
            break;
        }
        ++faults;
        int told = 0;
        for (const LWStatus status : all) told += isDriverError(status);
        CHECK(told == 1);
        CHECK(lastError(rig.device) != "");
        if (isDriverError(all[0])) {
            CHECK(all[1] == LW_ERROR_NOT_UPDATED);
            CHECK(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_ERROR_NOT_UPDATED);
            CHECK(all[3] == LW_ERROR_INVALID_ARGUMENT);  // no such view: it may hold anything
        } else {
            // The world part is whole.
            REQUIRE(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
            REQUIRE(lwFinish(rig.device) == LW_SUCCESS);
            REQUIRE(pixelsOf(scene) == expected);
        }
        rig.frame(scene);
        REQUIRE(pixelsOf(scene) == expected);
        REQUIRE(rig.info().allocatedBytes == held);
        lastError(rig.device);
        lwReleaseTechnique(rig.technique);
    }
    CHECK(faults > 60);
    REQUIRE(lwCreateRsm(rig.device, &desc, &rig.technique) == LW_SUCCESS);
}

TEST_CASE("whichever OpenCL call of a creation or a prewarming fails, it is told and can be repeated", "[faults]") {
    ApiScene scene;
    for (int call = 0;; ++call) {
        REQUIRE(call < kMostCalls);
        ApiRig rig(deviceWith("1"), scene);
        LWTechnique technique = nullptr;
        LWStatus created = LW_SUCCESS, warmed = LW_SUCCESS;
        bool happened = false;
        std::string function;
        {
            const ClFault fault(call * 7, CL_OUT_OF_HOST_MEMORY);  // some of many alike
            LWRsmDesc desc;
            lwDefaultRsm(&desc);
            desc.interleave = 2;
            created = lwCreateRsm(rig.device, &desc, &technique);
            if (created == LW_SUCCESS) warmed = lwPrewarm(technique, rig.view);
            happened = fault.happened();
            function = fault.function();
        }
        CAPTURE(call, function);
        if (technique) {
            // A binary that the driver refuses is built again from source.
            if (happened && function != "clBuildProgram") CHECK(warmed != LW_SUCCESS);
            REQUIRE(lwPrewarm(technique, rig.view) == LW_SUCCESS);
            lwReleaseTechnique(technique);
        } else {
            CHECK(created != LW_SUCCESS);
        }
        rig.frame(scene);
        REQUIRE(scene.lit());
        if (!happened) {
            CHECK(call > 10);
            break;
        }
    }
}

TEST_CASE("whichever OpenCL call of lwCheckInputs fails, it is told, and the next call finds the same", "[faults]") {
    ApiScene scene;
    for (std::uint32_t y = 0; y < scene.normal.height(); ++y)
        for (std::uint32_t x = 0; x < scene.normal.width(); ++x) scene.normal.set(x, y, 0, -0.5, 0);
    ApiRig rig(deviceWith("1"), scene);
    HostImage overlay(LW_FORMAT_FLOAT4, scene.normal.width(), scene.normal.height());
    const LWImage image = overlay.image();
    LWInputFinding finding;
    std::uint32_t count = 0;
    const auto check = [&] { return lwCheckInputs(rig.view, &scene.frame, &scene.gbuffer, &finding, 1, &count, &image); };
    REQUIRE(check() == LW_SUCCESS);
    REQUIRE(count == 1);
    REQUIRE(finding.fault == LW_FAULT_NORMAL_LENGTH);
    const std::uint64_t held = rig.info().allocatedBytes;
    for (int call = 0;; ++call) {
        REQUIRE(call < kMostCalls);
        LWStatus status = LW_SUCCESS;
        bool happened = false;
        {
            const ClFault fault(call, CL_OUT_OF_HOST_MEMORY);
            status = check();
            happened = fault.happened();
        }
        CAPTURE(call, status);
        if (status != LW_SUCCESS) CHECK(count == 0);
        REQUIRE(check() == LW_SUCCESS);
        REQUIRE(count == 1);
        REQUIRE(finding.fault == LW_FAULT_NORMAL_LENGTH);
        REQUIRE(rig.info().allocatedBytes == held);
        lastError(rig.device);
        if (!happened) {
            CHECK(call > 20);
            break;
        }
        CHECK(status != LW_SUCCESS);
    }
}

TEST_CASE("after a command failed on the device, techniques ask for another update", "[faults]") {
    ApiScene scene;
    ApiRig rig(makeDevice(16), scene);
    rig.frame(scene);
    REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
    const bool atFinish = GENERATE(true, false);
    {
        const FailedEvents failed;
        CHECK((atFinish ? lwFinish(rig.device) : lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output)) ==
              LW_ERROR_DEVICE);
    }
    CHECK_THAT(lastError(rig.device), Contains("failed on the device"));
    // What the update should have made may be anything.
    CHECK(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_ERROR_NOT_UPDATED);
    CHECK_THAT(lastError(rig.device), Contains("another lwUpdate"));
    std::uint32_t count = 1;
    CHECK(lwCountDebugViews(rig.technique, rig.view, &count) == LW_SUCCESS);
    CHECK(count == 0);
    CHECK(rig.stats().countCount == 0);
    rig.frame(scene);
    CHECK(scene.lit());
}

TEST_CASE("a call that reports a failure holds up nobody", "[faults][threads]") {
    ApiScene scene, other;
    AdoptedRig rig(scene);
    LWTechnique second = nullptr;
    REQUIRE(lwCreateRsm(rig.device, nullptr, &second) == LW_SUCCESS);
    rig.frame(scene);
    REQUIRE(lwUpdate(second, &other.frame) == LW_SUCCESS);
    REQUIRE(lwFinish(rig.device) == LW_SUCCESS);
    const int kind = GENERATE(0, 1, 2);
    CAPTURE(kind);
    Gate first(rig.host), later(rig.host);
    scene.frame.sync = first.sync();
    other.frame.sync = later.sync();
    REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
    REQUIRE(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    LWStats stats{};
    stats.structSize = sizeof stats;
    std::vector<float> pixels(24 * 10 * 3);
    auto waiting = std::async(std::launch::async, [&] {
        if (kind == 0) return lwFinish(rig.device);
        if (kind == 1) return lwGetStats(rig.technique, &stats);
        return lwReadDebugView(rig.technique, rig.view, "position", pixels.data(), pixels.size());
    });
    std::this_thread::sleep_for(kIntoWait);
    REQUIRE(lwUpdate(second, &other.frame) == LW_SUCCESS);
    {
        const FailedEvents failed;
        first.open();
        // Not for what was enqueued after it, whose gate is still closed.
        CHECK(waiting.wait_for(kPatience) == std::future_status::ready);
        auto asked = std::async(std::launch::async, [&] { return rig.info().computeUnits > 0; });
        CHECK(asked.wait_for(kPatience) == std::future_status::ready);
        later.open();
        CHECK(asked.get());
        CHECK(waiting.get() == LW_ERROR_DEVICE);
        clFinish(rig.host.queue());
    }
    lwReleaseTechnique(second);
    lwFinish(rig.device);
}

TEST_CASE("a log callback that throws locks nobody out", "[faults]") {
    LWDeviceDesc desc;
    lwDefaultDevice(&desc);
    desc.width = 16;
    desc.cacheDirectory = "/dev/null/no/such/directory";  // unwritable: the device warns
    desc.log = [](void*, LWLogLevel, const char*) { throw 5; };
    LWDevice device = nullptr;
    REQUIRE(lwCreateDevice(&desc, &device) == LW_SUCCESS);
    LWTechnique technique = nullptr;
    ApiScene scene;
    REQUIRE(lwCreateRsm(device, nullptr, &technique) == LW_SUCCESS);
    REQUIRE(lwUpdate(technique, &scene.frame) == LW_SUCCESS);
    CHECK(lwFinish(device) == LW_ERROR_INTERNAL);
    CHECK(lwFinish(device) == LW_SUCCESS);
    CHECK(lwReleaseTechnique(technique) == LW_SUCCESS);
    CHECK(lwReleaseDevice(device) == LW_SUCCESS);
}

TEST_CASE("an update that fails half-way is one of all that hold the technique", "[faults]") {
    Whole scene;
    ApiRig rig(deviceWith("1"), scene);
    LWFallbackDesc desc;
    lwDefaultFallback(&desc);
    desc.first = rig.technique;
    REQUIRE(lwCreateSsvp(rig.device, nullptr, &desc.second) == LW_SUCCESS);
    LWTechnique joined = nullptr;
    REQUIRE(lwCreateFallback(rig.device, &desc, &joined) == LW_SUCCESS);
    const auto renders = [&](LWTechnique technique) { return lwRender(technique, rig.view, &scene.gbuffer, &scene.output); };
    for (const bool byPart : {true, false}) {
        for (const LWTechnique technique : {rig.technique, joined}) REQUIRE(lwUpdate(technique, &scene.frame) == LW_SUCCESS);
        {
            const ClFault fault(0, CL_OUT_OF_RESOURCES);
            CHECK(isDriverError(lwUpdate(byPart ? rig.technique : joined, &scene.frame)));
        }
        for (const LWTechnique technique : {rig.technique, joined}) CHECK(renders(technique) == LW_ERROR_NOT_UPDATED);
        REQUIRE(lwUpdate(joined, &scene.frame) == LW_SUCCESS);
        CHECK(renders(joined) == LW_SUCCESS);
        CHECK(lwFinish(rig.device) == LW_SUCCESS);
    }
    lwReleaseTechnique(joined);
    lwReleaseTechnique(desc.second);
}
