// Handles, errors, struct sizes: everything a careless host can do without a frame.
#include <catch2/catch.hpp>
#include <cstring>

#include "api/api_scene.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;

extern "C" int lwTestHeaderFromC(void);

TEST_CASE("the header works from C99", "[api]") {
    CHECK(lwTestHeaderFromC() == 0);
}

TEST_CASE("null, released and foreign handles are refused", "[api]") {
    CHECK(lwFinish(nullptr) == LW_ERROR_INVALID_HANDLE);
    CHECK_THAT(lastError(), Contains("lwFinish") && Contains("got null"));
    CHECK(lastError() == "");
    int stranger = 0;
    CHECK(lwFinish(reinterpret_cast<LWDevice>(&stranger)) == LW_ERROR_INVALID_HANDLE);
    CHECK(lwReleaseView(reinterpret_cast<LWView>(&stranger)) == LW_ERROR_INVALID_HANDLE);
    CHECK(lwReleaseTechnique(reinterpret_cast<LWTechnique>(std::uintptr_t(-1))) ==
          LW_ERROR_INVALID_HANDLE);

    const LWDevice device = makeDevice(16);
    REQUIRE(device);
    CHECK(lwReleaseView(reinterpret_cast<LWView>(device)) == LW_ERROR_INVALID_HANDLE);
    CHECK_THAT(lastError(), Contains("expected a view, got a device"));
    CHECK(lwRetainDevice(device) == LW_SUCCESS);
    CHECK(lwReleaseDevice(device) == LW_SUCCESS);
    CHECK(lwFinish(device) == LW_SUCCESS);
    CHECK(lwReleaseDevice(device) == LW_SUCCESS);
    CHECK(lwReleaseDevice(device) == LW_ERROR_INVALID_HANDLE);
    CHECK(lwFinish(device) == LW_ERROR_INVALID_HANDLE);
    CHECK_THAT(lastError(), Contains("released or never made"));
    const char* message = nullptr;
    CHECK(lwGetLastError(device, &message) == LW_ERROR_INVALID_HANDLE);
    CHECK_THAT(message, Contains("lwGetLastError"));
    LWDevice second = makeDevice(16);
    CHECK(second != device);  // a number is never used again
    CHECK(lwReleaseDevice(second) == LW_SUCCESS);
}

TEST_CASE("children keep their device", "[api]") {
    ApiScene scene;
    LWDevice device = makeDevice(16);
    LWView view = nullptr;
    LWTechnique technique = nullptr;
    const LWViewDesc desc = scene.viewDesc();
    REQUIRE(lwCreateView(device, &desc, &view) == LW_SUCCESS);
    REQUIRE(lwCreateRsm(device, nullptr, &technique) == LW_SUCCESS);
    REQUIRE(lwReleaseDevice(device) == LW_SUCCESS);
    CHECK(lwUpdate(technique, &scene.frame) == LW_SUCCESS);
    CHECK(lwRender(technique, view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    LWStats stats{};
    stats.structSize = sizeof stats;
    CHECK(lwGetStats(technique, &stats) == LW_SUCCESS);  // waits
    CHECK(scene.lit());
    CHECK(lwReleaseView(view) == LW_SUCCESS);
    CHECK(lwRender(technique, view, &scene.gbuffer, &scene.output) == LW_ERROR_INVALID_HANDLE);
    CHECK(lwUpdate(technique, &scene.frame) == LW_SUCCESS);
    CHECK(lwReleaseTechnique(technique) == LW_SUCCESS);
    CHECK(lwUpdate(technique, &scene.frame) == LW_ERROR_INVALID_HANDLE);
}

TEST_CASE("the first error of a device is kept until it is fetched", "[api]") {
    const LWDevice device = makeDevice(16);
    CHECK(lwCreateView(device, nullptr, nullptr) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lwCreateTechnique(device, "fog", nullptr, nullptr) == LW_ERROR_INVALID_ARGUMENT);
    LWDeviceInfo info{};
    info.structSize = sizeof info;
    CHECK(lwGetDeviceInfo(device, &info) == LW_SUCCESS);  // a success in between changes nothing
    const char* message = nullptr;
    CHECK(lwGetLastError(device, &message) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(message, Contains("lwCreateView") && Contains("view"));
    CHECK(lwGetLastError(device, &message) == LW_SUCCESS);
    CHECK(std::string(message) == "");
    LWTechnique technique = nullptr;
    CHECK(lwCreateTechnique(device, "fog", nullptr, &technique) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("\"fog\"") && Contains("rsm"));
    CHECK(lwCreateTechnique(device, nullptr, nullptr, &technique) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(technique == nullptr);
    // Errors of one device are not another's.
    const LWDevice other = makeDevice(16);
    CHECK(lwGetLastError(other, nullptr) == LW_SUCCESS);
    lwReleaseDevice(other);
    lwReleaseDevice(device);
}

TEST_CASE("struct sizes are checked", "[api]") {
    const LWDevice device = makeDevice(16);
    for (const std::uint32_t size :
         {0u, 1u, 0xffffffffu, 0x80000000u, unsigned(sizeof(LWViewDesc) + 4)}) {
        LWViewDesc desc{};
        desc.structSize = size;
        desc.maxWidth = desc.maxHeight = 8;
        LWView view = nullptr;
        CHECK(lwCreateView(device, &desc, &view) == LW_ERROR_INVALID_ARGUMENT);
        CHECK(view == nullptr);
        CHECK_THAT(lastError(device), Contains("desc.structSize") && Contains(std::to_string(size)));
        LWDeviceInfo info{};
        info.structSize = size;
        CHECK(lwGetDeviceInfo(device, &info) == LW_ERROR_INVALID_ARGUMENT);
        LWDeviceDesc deviceDesc{};
        deviceDesc.structSize = size;
        LWDevice made = nullptr;
        CHECK(lwCreateDevice(&deviceDesc, &made) == LW_ERROR_INVALID_ARGUMENT);
        LWRsmDesc rsm;
        lwDefaultRsm(&rsm);
        rsm.structSize = size;
        LWTechnique technique = nullptr;
        CHECK(lwCreateRsm(device, &rsm, &technique) == LW_ERROR_INVALID_ARGUMENT);
        lastError(device);  // the info's, which came first
    }
    CHECK(lwGetDeviceInfo(device, nullptr) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lwProbeDevice(device, nullptr) == LW_ERROR_INVALID_ARGUMENT);
    lwReleaseDevice(device);
}

TEST_CASE("views have sizes", "[api]") {
    const LWDevice device = makeDevice(16);
    LWView view = nullptr;
    LWViewDesc desc{};
    desc.structSize = sizeof desc;
    for (const auto& bad : {std::pair<std::uint32_t, std::uint32_t>{0, 8},
                            {8, 0},
                            {16385, 8},
                            {0xffffffffu, 0xffffffffu}}) {
        desc.maxWidth = bad.first;
        desc.maxHeight = bad.second;
        CHECK(lwCreateView(device, &desc, &view) == LW_ERROR_INVALID_ARGUMENT);
        CHECK_THAT(lastError(device), Contains("16384") && Contains(std::to_string(bad.first)));
    }
    desc.maxWidth = 100;
    desc.maxHeight = 50;
    REQUIRE(lwCreateView(device, &desc, &view) == LW_SUCCESS);
    std::uint32_t w = 0, h = 0;
    CHECK(lwGetViewSize(view, &w, &h) == LW_SUCCESS);
    CHECK(w == 100);
    CHECK(h == 50);
    CHECK(lwSetViewSize(view, 101, 50) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lwSetViewSize(view, 0, 50) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lwSetViewSize(view, 64, 1) == LW_SUCCESS);
    CHECK(lwGetViewSize(view, nullptr, &h) == LW_SUCCESS);
    CHECK(h == 1);
    CHECK(lwReleaseView(view) == LW_SUCCESS);
    lwReleaseDevice(device);
}

TEST_CASE("technique parameters are checked by name", "[api]") {
    const LWDevice device = makeDevice(16);
    LWTechniqueInfo info{};
    info.structSize = sizeof info;
    CHECK(lwDescribeTechnique(lwCountTechniques(), &info) == LW_ERROR_INVALID_ARGUMENT);
    for (std::uint32_t t = 0; t < lwCountTechniques(); ++t) {
        REQUIRE(lwDescribeTechnique(t, &info) == LW_SUCCESS);
        for (std::uint32_t p = 0; p < info.parameterCount; ++p) {
            const LWParameter& parameter = info.parameters[p];
            const auto create = [&](const void* value) {
                std::vector<std::uint64_t> desc(info.descSize / 8 + 1);
                info.setDefaults(desc.data());
                std::memcpy(reinterpret_cast<char*>(desc.data()) + parameter.byteOffset, value, 4);
                LWTechnique technique = nullptr;
                const LWStatus status = lwCreateTechnique(device, info.name, desc.data(), &technique);
                if (technique) lwReleaseTechnique(technique);
                return status;
            };
            CAPTURE(info.name, parameter.name);
            const std::uint32_t huge = 0xffffffffu;
            const float nan = std::nanf("");
            if (parameter.kind == LW_PARAMETER_TECHNIQUE) {
                // No technique, or none in the field before.
                const LWStatus status = create(&huge);
                CHECK((status == LW_ERROR_INVALID_HANDLE || status == LW_ERROR_INVALID_ARGUMENT));
                CHECK_THAT(lastError(device), Contains("desc.first: expected"));
                continue;
            }
            if (parameter.kind == LW_PARAMETER_FLOAT) {
                CHECK(create(&nan) == LW_ERROR_INVALID_ARGUMENT);
                CHECK_THAT(lastError(device), Contains(parameter.name) && Contains("nan"));
            } else if (parameter.maximum < double(huge)) {
                CHECK(create(&huge) == LW_ERROR_INVALID_ARGUMENT);
                CHECK_THAT(lastError(device),
                           Contains(std::string("desc.") + parameter.name) && Contains("expected"));
            }
            if (parameter.kind == LW_PARAMETER_ENUM) {  // techniques that share an enumeration need not take all of it
                std::uint32_t names = 0;
                while (parameter.choices[names]) ++names;
                CHECK(parameter.maximum == double(names - 1));
                CHECK(create(&names) == LW_ERROR_INVALID_ARGUMENT);
                CHECK_THAT(lastError(device), Contains(std::string("desc.") + parameter.name) && Contains("got " + std::to_string(names)));
            }
            if (parameter.allowed) {
                const std::uint32_t three = 3;
                CHECK(create(&three) == LW_ERROR_INVALID_ARGUMENT);
                CHECK_THAT(lastError(device), Contains("one of") && Contains("got 3"));
            }
            const std::uint32_t zero = 0;
            CHECK(create(&zero) == LW_SUCCESS);  // the default, or a value of its own
        }
    }
    lwReleaseDevice(device);
}

TEST_CASE("memory is estimated without creating anything", "[api]") {
    ApiScene scene(320, 180);
    const LWDevice device = makeDevice(16);
    LWDeviceInfo before{}, after{};
    before.structSize = after.structSize = sizeof before;
    lwGetDeviceInfo(device, &before);
    const LWViewDesc desc = scene.viewDesc();
    std::uint64_t bytes = 0;
    CHECK(lwEstimateMemory(device, "rsm", nullptr, &desc, ApiScene::kRsm * ApiScene::kRsm, &bytes) ==
          LW_SUCCESS);
    lwGetDeviceInfo(device, &after);
    CHECK(before.allocatedBytes == after.allocatedBytes);
    LWView view = nullptr;
    LWTechnique technique = nullptr;
    lwCreateView(device, &desc, &view);
    lwCreateRsm(device, nullptr, &technique);
    REQUIRE(lwUpdate(technique, &scene.frame) == LW_SUCCESS);
    REQUIRE(lwRender(technique, view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    LWStats stats{};
    stats.structSize = sizeof stats;
    REQUIRE(lwGetStats(technique, &stats) == LW_SUCCESS);
    CHECK(stats.deviceBytes <= bytes);
    CHECK(double(stats.deviceBytes) > 0.6 * double(bytes));  // interleaved inputs: nearly all is needed
    CHECK(lwEstimateMemory(device, "rsm", nullptr, &desc, UINT64_MAX, &bytes) ==
          LW_ERROR_INVALID_ARGUMENT);
    CHECK(lwEstimateMemory(device, "rsm", nullptr, nullptr, 1, &bytes) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lwEstimateMemory(device, "rsm", nullptr, &desc, 1, nullptr) == LW_ERROR_INVALID_ARGUMENT);
    lwReleaseTechnique(technique);
    lwReleaseView(view);
    lwReleaseDevice(device);
}

TEST_CASE("devices are counted and described", "[api]") {
    std::uint32_t count = 0;
    REQUIRE(lwCountDevices(&count) == LW_SUCCESS);
    REQUIRE(count > 0);
    LWDeviceInfo info{};
    info.structSize = sizeof info;
    CHECK(lwDescribeDevice(0, &info) == LW_SUCCESS);
    CHECK(info.name[0] != 0);
    CHECK(info.width == 0);
    CHECK(lwDescribeDevice(count, &info) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lwCountDevices(nullptr) == LW_ERROR_INVALID_ARGUMENT);
    LWDeviceDesc desc;
    lwDefaultDevice(&desc);
    desc.selector = "no such device";
    LWDevice device = nullptr;
    CHECK(lwCreateDevice(&desc, &device) == LW_ERROR_NO_DEVICE);
    CHECK(device == nullptr);
    lwDefaultDevice(&desc);
    desc.width = 3;
    CHECK(lwCreateDevice(&desc, &device) == LW_ERROR_INVALID_ARGUMENT);
    lwDefaultDevice(&desc);
    desc.clContext = &count;
    CHECK(lwCreateDevice(&desc, &device) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lwCreateDevice(nullptr, nullptr) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(std::string(lwStatusName(LW_ERROR_DEVICE)) == "LW_ERROR_DEVICE");
    CHECK(std::string(lwVersion()) == "0.1.0");
}
