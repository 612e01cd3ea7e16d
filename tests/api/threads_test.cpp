// Host threads on one device: frames, waits, reads and releases beside each other.
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <future>
#include <thread>

#include "api/api_rig.h"

using namespace lightwell::test;

namespace {

// Time for another thread to get into a call's wait; and for a call that must not wait, on a busy machine.
constexpr auto kIntoWait = std::chrono::milliseconds(300);
constexpr auto kPatience = std::chrono::seconds(20);

}  // namespace

TEST_CASE("many threads use one device, and devices of their own", "[api]") {
    ApiScene first;
    Rig shared(first);
    std::atomic<int> failures{0};
    const auto work = [&](LWDevice device) {
        ApiScene scene;
        LWView view = nullptr;
        LWTechnique technique = nullptr;
        const LWViewDesc desc = scene.viewDesc();
        if (lwCreateView(device, &desc, &view) || lwCreateRsm(device, nullptr, &technique)) ++failures;
        for (int i = 0; i < 10; ++i) {
            if (lwUpdate(technique, &scene.frame) ||
                lwRender(technique, view, &scene.gbuffer, &scene.output))
                ++failures;
            if (lwFinish(device) || !scene.lit()) ++failures;
            if (lwFinish(nullptr) != LW_ERROR_INVALID_HANDLE) ++failures;
            if (lastError().find("lwFinish") != 0) ++failures;  // each thread its own
        }
        if (lwReleaseView(view) || lwReleaseTechnique(technique)) ++failures;
    };
    std::vector<std::thread> threads;
    for (int i = 0; i < 3; ++i) threads.emplace_back(work, shared.device);
    threads.emplace_back([&] {
        const LWDevice own = makeDevice(1);
        work(own);
        lwReleaseDevice(own);
    });
    for (std::thread& thread : threads) thread.join();
    CHECK(failures == 0);
}

TEST_CASE("one thread releases what another uses", "[api]") {
    for (int round = 0; round < 10; ++round) {
        ApiScene scene;
        const LWDevice device = makeDevice(16);
        LWTechnique technique = nullptr;
        REQUIRE(lwCreateRsm(device, nullptr, &technique) == LW_SUCCESS);
        std::thread user([&] {
            for (int i = 0; i < 20; ++i) {
                const LWStatus status = lwUpdate(technique, &scene.frame);
                if (status != LW_SUCCESS && status != LW_ERROR_INVALID_HANDLE)
                    FAIL("unexpected " << lwStatusName(status));
            }
        });
        CHECK(lwReleaseTechnique(technique) == LW_SUCCESS);
        user.join();
        CHECK(lwFinish(device) == LW_SUCCESS);
        lwReleaseDevice(device);
    }
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

