// Memory: what is estimated is what is held, on devices that share memory with the host and on others; and both
// give the same bits.
#include <algorithm>
#include <catch2/catch.hpp>
#include <memory>

#include "api/api_rig.h"
#include "support/camera_matrices.h"
#include "support/scoped.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;

namespace {

// `unified`: LIGHTWELL_UNIFIED_MEMORY.
LWDevice deviceWith(const char* unified) {
    const ScopedVariable variable("LIGHTWELL_UNIFIED_MEMORY", unified);
    return makeDevice(16);
}

LWRsmDesc descOf(std::uint32_t vpls, std::uint32_t interleave, std::uint32_t filter, LWResolution resolution,
                 std::uint32_t history = 0) {
    LWRsmDesc desc;
    lwDefaultRsm(&desc);
    desc.vpls = vpls;
    desc.interleave = interleave;
    desc.filter = filter;
    desc.resolution = resolution;
    desc.history = history;
    return desc;
}

// The scene's images in the bulkiest formats; none can be used in place.
struct Bulky {
    explicit Bulky(ApiScene& scene) {
        const auto replace = [&](LWImage& image, const HostImage& from) {
            images.push_back(std::make_unique<HostImage>(LW_FORMAT_FLOAT4, from.width(), from.height()));
            HostImage& to = *images.back();
            for (std::uint32_t y = 0; y < from.height(); ++y)
                for (std::uint32_t x = 0; x < from.width(); ++x)
                    to.set(x, y, from.value(x, y, 0), from.value(x, y, 1), from.value(x, y, 2));
            image = to.image();
        };
        replace(scene.gbuffer.position, scene.position);
        replace(scene.gbuffer.normal, scene.normal);
        replace(scene.rsm.position, scene.rsmPosition);
        replace(scene.rsm.normal, scene.rsmNormal);
        replace(scene.rsm.flux, scene.rsmFlux);
        replace(scene.output.irradiance, scene.irradiance);
    }
    std::vector<std::unique_ptr<HostImage>> images;
};

}  // namespace

TEST_CASE("the estimate is what a frame comes to hold", "[api][memory]") {
    const char* unified = GENERATE(as<const char*>{}, "1", "0");
    const auto desc = GENERATE(descOf(256, 4, 1, LW_RESOLUTION_FULL), descOf(0, 1, 0, LW_RESOLUTION_FULL),
                               descOf(1000, 8, 0, LW_RESOLUTION_HALF), descOf(64, 2, 1, LW_RESOLUTION_HALF),
                               descOf(4096, 1, 1, LW_RESOLUTION_HALF), descOf(256, 4, 1, LW_RESOLUTION_FULL, 8),
                               descOf(256, 1, 1, LW_RESOLUTION_FULL, 8), descOf(256, 2, 1, LW_RESOLUTION_HALF, 8),
                               descOf(256, 1, 1, LW_RESOLUTION_HALF, 8));
    const std::uint32_t authored = GENERATE(0u, 1u, 77u);
    CAPTURE(unified, desc.vpls, desc.interleave, desc.filter, desc.resolution, authored);
    ApiScene scene(25, 11);
    const Bulky bulky(scene);
    std::vector<LWVpl> vpls(authored);
    for (LWVpl& vpl : vpls) {
        vpl.normal[1] = 1.0f;
        vpl.flux[0] = 0.1f;
    }
    scene.frame.vpls = vpls.data();
    scene.frame.vplCount = authored;
    // Histories take both; the motion's memory is counted also where none is given, so the bulkiest is.
    HostImage motion(LW_FORMAT_FLOAT2, 25, 11);
    scene.gbuffer.camera = testCamera(kRightHanded, {0, 0, 3}).matrices();
    scene.gbuffer.motion = motion.image();
    ApiRig rig(deviceWith(unified), scene, &desc);
    const LWViewDesc viewDesc = scene.viewDesc();
    std::uint64_t square = 0, exact = 0;
    const std::uint64_t before = rig.info().allocatedBytes;
    REQUIRE(lwEstimateMemory(rig.device, "rsm", &desc, &viewDesc, ApiScene::kRsm * ApiScene::kRsm, &square) ==
            LW_SUCCESS);
    REQUIRE(lwEstimateFrameMemory(rig.device, "rsm", &desc, &viewDesc, &scene.frame, &exact) == LW_SUCCESS);
    CHECK(rig.info().allocatedBytes == before);
    rig.frame(scene);
    CHECK(rig.stats().deviceBytes == exact);
    if (authored == 0) CHECK(square == exact);
    // And stays so: nothing is made anew each frame.
    const std::uint64_t held = rig.info().allocatedBytes;
    for (int i = 0; i < 3; ++i) rig.frame(scene);
    CHECK(rig.stats().deviceBytes == exact);
    CHECK(rig.info().allocatedBytes == held);
    CHECK(held - before == exact);
}

TEST_CASE("several maps, and frames without light, are estimated too", "[api][memory]") {
    const char* unified = GENERATE(as<const char*>{}, "1", "0");
    ApiScene scene(25, 11);
    const Bulky bulky(scene);
    const LWRsmDesc desc = descOf(256, 4, 1, LW_RESOLUTION_FULL);
    const LWViewDesc viewDesc = scene.viewDesc();
    std::vector<LWLight> lights(3, scene.light);
    LWRsm narrow = scene.rsm;
    for (LWImage* image : {&narrow.position, &narrow.normal, &narrow.flux}) image->width = 5;
    lights[1].rsms = &narrow;
    scene.frame.lights = lights.data();
    scene.frame.lightCount = GENERATE(0u, 1u, 3u);
    ApiRig rig(deviceWith(unified), scene, &desc);
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateFrameMemory(rig.device, "rsm", &desc, &viewDesc, &scene.frame, &estimate) == LW_SUCCESS);
    rig.frame(scene);
    CHECK(rig.stats().deviceBytes == estimate);
}

TEST_CASE("texels that no frame may have are refused by the estimate", "[api][memory]") {
    ApiScene scene;
    const LWRsmDesc desc = descOf(256, 4, 1, LW_RESOLUTION_FULL);
    ApiRig rig(deviceWith(nullptr), scene, &desc);
    const LWViewDesc viewDesc = scene.viewDesc();
    const auto estimate = [&](std::uint64_t texels) {
        std::uint64_t bytes = 0;
        return lwEstimateMemory(rig.device, "rsm", &desc, &viewDesc, texels, &bytes);
    };
    CHECK(estimate(0) == LW_SUCCESS);
    // 32-bit indices over ten planes: 214,748,352 texels, which is 14,654 squared and a little.
    CHECK(estimate(14640ull * 14640) == LW_SUCCESS);
    CHECK(estimate(14672ull * 14672) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(rig.device), Contains("rsmTexels") && Contains("214748352"));
    CHECK(estimate(std::uint64_t(1) << 41) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(estimate(UINT64_MAX) == LW_ERROR_INVALID_ARGUMENT);
    lastError(rig.device);
    // Sizes alone decide; there are no such pixels.
    std::uint64_t bytes = 0;
    scene.rsm.flux.width = scene.rsm.flux.height = 16384;
    CHECK(lwEstimateFrameMemory(rig.device, "rsm", &desc, &viewDesc, &scene.frame, &bytes) ==
          LW_ERROR_INVALID_ARGUMENT);
    scene.rsm.flux.width = 0;  // lwUpdate refuses it, too
    CHECK(lwEstimateFrameMemory(rig.device, "rsm", &desc, &viewDesc, &scene.frame, &bytes) ==
          LW_ERROR_INVALID_ARGUMENT);
    scene.rsm.flux.width = 16;
    const std::vector<LWRsm> faces(2, scene.rsm);
    scene.light.kind = LW_LIGHT_SPOT;
    scene.light.rsms = faces.data();
    scene.light.rsmCount = 2;
    lastError(rig.device);
    CHECK(lwEstimateFrameMemory(rig.device, "rsm", &desc, &viewDesc, &scene.frame, &bytes) ==
          LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(rig.device), Contains("frame.lights[0].rsmCount"));
    scene.light.rsmCount = 1;
    scene.rsm.flux.width = 0xffffffffu;
    scene.light.rsms = &scene.rsm;
    CHECK(lwEstimateFrameMemory(rig.device, "rsm", &desc, &viewDesc, &scene.frame, &bytes) ==
          LW_ERROR_INVALID_ARGUMENT);
    CHECK(lwEstimateFrameMemory(rig.device, "rsm", &desc, &viewDesc, nullptr, &bytes) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lwEstimateFrameMemory(rig.device, "rsm", &desc, &viewDesc, &scene.frame, nullptr) ==
          LW_ERROR_INVALID_ARGUMENT);
}

TEST_CASE("a device without shared memory gives the same bits", "[api][memory]") {
    // Widths in and off multiples of 16; planar (in place, where memory is shared), interleaved, with gaps.
    const std::uint32_t width = GENERATE(32u, 37u);
    const LWFormat format = GENERATE(LW_FORMAT_FLOAT3, LW_FORMAT_PLANAR_FLOAT3, LW_FORMAT_HALF4);
    HostLayout layout;
    layout.aligned = format == LW_FORMAT_PLANAR_FLOAT3;
    layout.pixelGap = format == LW_FORMAT_FLOAT3 ? 4 : 0;
    layout.rowGap = format == LW_FORMAT_HALF4 ? 24 : 0;
    layout.bottomUp = format == LW_FORMAT_FLOAT3;
    CAPTURE(width, format);
    const auto render = [&](const char* unified) {
        ApiScene scene(width, 21);
        HostImage position(format, width, 21, layout), normal(format, width, 21, layout),
            irradiance(format, width, 21, layout);
        for (std::uint32_t y = 0; y < 21; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                position.set(x, y, scene.position.value(x, y, 0), scene.position.value(x, y, 1),
                             scene.position.value(x, y, 2));
                normal.set(x, y, 0, -1, 0);
            }
        scene.gbuffer.position = position.image();
        scene.gbuffer.normal = normal.image();
        scene.output.irradiance = irradiance.image();
        const LWRsmDesc desc = descOf(256, 4, 1, LW_RESOLUTION_HALF);
        ApiRig rig(deviceWith(unified), scene, &desc);
        if (unified[0] == '0') CHECK(rig.info().hostUnifiedMemory == 0);
        for (int i = 0; i < 2; ++i) rig.frame(scene);
        CHECK(irradiance.damagedBytes(layout.aligned) == 0);
        const LWStats stats = rig.stats();
        if (unified[0] == '0') CHECK(stats.hostCopyBytes > width * 21 * 8 * 3);
        std::vector<double> pixels;
        for (std::uint32_t y = 0; y < 21; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                for (int c = 0; c < 3; ++c) pixels.push_back(irradiance.value(x, y, c));
                pixels.push_back(scene.validity.value(x, y, 0));
            }
        CHECK(*std::max_element(pixels.begin(), pixels.end()) > 0.0);
        return pixels;
    };
    CHECK(render("0") == render("1"));
}

TEST_CASE("LIGHTWELL_UNIFIED_MEMORY takes 0 or 1", "[api][memory]") {
    const ScopedVariable variable("LIGHTWELL_UNIFIED_MEMORY", "no");
    CHECK(makeDevice(16) == nullptr);
    CHECK_THAT(lastError(), Contains("LIGHTWELL_UNIFIED_MEMORY") && Contains("\"no\""));
}
