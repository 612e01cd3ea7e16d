// What is told of frames: statistics, debug views; and that prewarmed techniques compile nothing more.
#include <catch2/catch.hpp>
#include <cmath>

#include "api/api_rig.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;

TEST_CASE("a refused output leaves statistics and debug views as they were", "[api]") {
    ApiScene scene(32, 8);
    Rig rig(scene);
    LWRsmDesc desc;
    lwDefaultRsm(&desc);
    desc.interleave = 1;  // "gathered" is then the host's own image, where that is used in place
    LWTechnique technique = nullptr;
    REQUIRE(lwCreateRsm(rig.device, &desc, &technique) == LW_SUCCESS);
    std::swap(technique, rig.technique);
    HostImage planar(LW_FORMAT_PLANAR_FLOAT3, 32, 8);
    scene.output.irradiance = planar.image();
    REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
    REQUIRE(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    const auto gathered = [&] {
        std::vector<float> pixels(32 * 8 * 3);
        CHECK(lwReadDebugView(rig.technique, rig.view, "gathered", pixels.data(), pixels.size()) == LW_SUCCESS);
        return pixels;
    };
    const std::vector<float> before = gathered();
    const std::uint32_t launches = rig.launches();
    LWOutput bad = scene.output;
    HostImage other(LW_FORMAT_FLOAT3, 32, 8);
    bad.irradiance = other.image();
    bad.validity.format = LW_FORMAT_HALF4;
    CHECK(lwRender(rig.technique, rig.view, &scene.gbuffer, &bad) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(rig.device), Contains("output.validity.format"));
    CHECK(rig.launches() == launches);
    CHECK(gathered() == before);
    lwReleaseTechnique(technique);
}

TEST_CASE("inputs that a technique does not read are named in the statistics", "[api]") {
    ApiScene scene;
    Rig rig(scene);
    const auto choices = [&] {
        REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
        const LWStats stats = rig.stats();
        std::string names;
        for (std::uint32_t i = 0; i < stats.choiceCount; ++i)
            if (std::string(stats.choices[i].reason).find("not used") == 0 ||
                std::string(stats.choices[i].reason).find("some have no RSM") == 0)
                names += std::string(stats.choices[i].name) + " ";
        return names;
    };
    CHECK(choices() == "");
    LWGeometry geometry{};
    geometry.structSize = sizeof geometry;
    const LWSourceView source{rig.view, &scene.gbuffer};
    LWBlocker blocker{};
    const LWLight lights[2] = {scene.light, [&] {
                                   LWLight analytic = scene.light;
                                   analytic.rsmCount = 0;
                                   return analytic;
                               }()};
    scene.frame.geometry = &geometry;
    scene.frame.sourceViews = &source;
    scene.frame.sourceViewCount = 1;
    scene.frame.blockers = &blocker;
    scene.frame.blockerCount = 1;
    scene.frame.environment[2] = 0.5f;
    scene.frame.lights = lights;
    scene.frame.lightCount = 2;
    CHECK(choices() == "frame.sourceViews frame.geometry frame.blockers frame.environment frame.lights ");
}

TEST_CASE("the statistics say from which list on tiles skip no VPLs", "[api]") {
    ApiScene scene(16, 4);
    LWRsmDesc desc;
    lwDefaultRsm(&desc);
    desc.interleave = 1;
    const auto tiles = [&](std::uint32_t vpls) {
        desc.vpls = vpls;
        ApiRig rig(makeDevice(16), scene, &desc);
        rig.frame(scene);
        const LWStats stats = rig.stats();
        std::string passes, choice;
        for (std::uint32_t i = 0; i < stats.passCount; ++i) passes += stats.passes[i].name;
        for (std::uint32_t i = 0; i < stats.choiceCount; ++i)
            if (std::string(stats.choices[i].name) == "tiles") choice += stats.choices[i].reason;
        CHECK((passes.find("interleaved_gather.cull") != std::string::npos) == (choice.find("skipped") != std::string::npos));
        return choice;
    };
    CHECK_THAT(tiles(16384), Contains("skipped"));
    CHECK_THAT(tiles(16385), Contains("none") && Contains("16384"));
}

TEST_CASE("counts are those of the views rendered since the last update", "[api]") {
    ApiScene scene;
    Rig rig(scene);
    const auto rejected = [&] {
        const LWStats stats = rig.stats();
        for (std::uint32_t i = 0; i < stats.countCount; ++i)
            if (std::string(stats.counts[i].name) == "rejected_pixels") return int(stats.counts[i].value);
        return -1;
    };
    scene.normal.set(4, 3, std::nan(""), 0, 0);
    REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
    REQUIRE(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    CHECK(rejected() == 1);
    REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
    CHECK(rejected() == 0);
}

TEST_CASE("prewarmed techniques compile nothing more, through resizes", "[api]") {
    ApiScene scene(48, 32);
    Rig rig(scene);
    REQUIRE(lwPrewarm(rig.technique, rig.view) == LW_SUCCESS);
    LWDeviceInfo before{}, after{};
    before.structSize = after.structSize = sizeof before;
    REQUIRE(lwGetDeviceInfo(rig.device, &before) == LW_SUCCESS);
    for (std::uint32_t i = 0; i < 40; ++i) {
        ApiScene current(1 + i % 48, 1 + i % 32);
        REQUIRE(lwSetViewSize(rig.view, 1 + i % 48, 1 + i % 32) == LW_SUCCESS);
        REQUIRE(lwUpdate(rig.technique, &current.frame) == LW_SUCCESS);
        REQUIRE(lwRender(rig.technique, rig.view, &current.gbuffer, &current.output) == LW_SUCCESS);
        REQUIRE(lwFinish(rig.device) == LW_SUCCESS);
        REQUIRE(current.lit());
    }
    scene.frame.lightCount = 0;  // the lights go out
    REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
    REQUIRE(lwFinish(rig.device) == LW_SUCCESS);
    REQUIRE(lwGetDeviceInfo(rig.device, &after) == LW_SUCCESS);
    CHECK(before.programsBuilt == after.programsBuilt);
    CHECK(before.programsLoaded == after.programsLoaded);
    CHECK(before.kernelsSpecialised == after.kernelsSpecialised);
}

TEST_CASE("prewarmed techniques compile nothing more for millions of VPLs", "[api]") {
    // More than 65,535 groups of 64: drivers tell such grids apart.
    constexpr std::uint32_t kVpls = 5u << 20;
    ApiScene scene(1, 1);
    const LWDevice device = makeDevice(16);
    LWRsmDesc desc;
    lwDefaultRsm(&desc);
    desc.vpls = kVpls;
    desc.interleave = 1;
    LWTechnique technique = nullptr;
    LWView view = nullptr;
    const LWViewDesc viewDesc = scene.viewDesc();
    REQUIRE(lwCreateView(device, &viewDesc, &view) == LW_SUCCESS);
    REQUIRE(lwCreateRsm(device, &desc, &technique) == LW_SUCCESS);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    LWDeviceInfo before{}, after{};
    before.structSize = after.structSize = sizeof before;
    REQUIRE(lwGetDeviceInfo(device, &before) == LW_SUCCESS);
    REQUIRE(lwUpdate(technique, &scene.frame) == LW_SUCCESS);
    REQUIRE(lwRender(technique, view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    LWDebugView info{};
    info.structSize = sizeof info;
    REQUIRE(lwDescribeDebugView(technique, nullptr, 0, &info) == LW_SUCCESS);
    REQUIRE(info.width >= kVpls);
    std::vector<float> list(std::size_t(info.width) * info.channels);
    REQUIRE(lwReadDebugView(technique, nullptr, "vpls", list.data(), list.size()) == LW_SUCCESS);
    REQUIRE(lwGetDeviceInfo(device, &after) == LW_SUCCESS);
    CHECK(before.programsBuilt == after.programsBuilt);
    CHECK(before.kernelsSpecialised == after.kernelsSpecialised);
    // Every slot is written: all VPLs have the same flux here.
    const float* red = list.data() + std::size_t(info.width) * 6;
    const float each = float(1.0 / kVpls);
    std::uint32_t right = 0;
    for (std::uint32_t i = 0; i < kVpls; ++i) right += std::abs(red[i] / each - 1.0f) < 1e-4f;
    CHECK(right == kVpls);
    CHECK(scene.lit());
    lwReleaseTechnique(technique);
    lwReleaseView(view);
    lwReleaseDevice(device);
}

TEST_CASE("prewarmed techniques compile nothing more for hundreds of thousands of RSM rows", "[api]") {
    // More than 65,535 groups of 4 rows.
    constexpr std::uint32_t kRows = 16384, kMaps = 17;
    ApiScene scene(1, 1);
    HostImage flux(LW_FORMAT_FLOAT3, 1, kRows);
    for (std::uint32_t y = 0; y < kRows; ++y) flux.set(0, y, y % 7 == 0, 0.5, 0);
    scene.rsm.position = scene.rsm.normal = scene.rsm.flux = flux.image();
    const std::vector<LWLight> lights(kMaps, scene.light);
    scene.frame.lights = lights.data();
    scene.frame.lightCount = kMaps;
    ApiRig rig(makeDevice(16), scene);
    REQUIRE(lwPrewarm(rig.technique, rig.view) == LW_SUCCESS);
    const std::uint64_t before = rig.info().kernelsSpecialised;
    rig.frame(scene);
    CHECK(rig.info().kernelsSpecialised == before);
}

TEST_CASE("debug views are listed, described and read", "[api]") {
    ApiScene scene;
    Rig rig(scene);
    std::uint32_t count = 0;
    REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
    REQUIRE(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    REQUIRE(lwCountDebugViews(rig.technique, rig.view, &count) == LW_SUCCESS);
    REQUIRE(count > 0);
    for (std::uint32_t i = 0; i < count; ++i) {
        LWDebugView info{};
        info.structSize = sizeof info;
        REQUIRE(lwDescribeDebugView(rig.technique, rig.view, i, &info) == LW_SUCCESS);
        CHECK(info.description != nullptr);
        const std::uint64_t size = std::uint64_t(info.width) * info.height * info.channels;
        std::vector<float> pixels(size + 1, -1000.0f);
        CHECK(lwReadDebugView(rig.technique, rig.view, info.name, pixels.data(), size - 1) ==
              LW_ERROR_INVALID_ARGUMENT);
        REQUIRE(lwReadDebugView(rig.technique, rig.view, info.name, pixels.data(), size) == LW_SUCCESS);
        CHECK(pixels[size] == -1000.0f);
        if (std::string(info.name) == "position") CHECK(pixels[24 * 10] == 0.5f);
    }
    float pixel = 0;
    lastError(rig.device);
    CHECK(lwReadDebugView(rig.technique, rig.view, "fog", &pixel, 1) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(rig.device), Contains("vpls") && Contains("fog"));
    CHECK(lwReadDebugView(rig.technique, rig.view, nullptr, &pixel, 1) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lwReadDebugView(rig.technique, rig.view, "vpls", nullptr, 1) == LW_ERROR_INVALID_ARGUMENT);
    LWDebugView info{};
    info.structSize = sizeof info;
    CHECK(lwDescribeDebugView(rig.technique, rig.view, count, &info) == LW_ERROR_INVALID_ARGUMENT);
}

