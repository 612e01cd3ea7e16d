// Frames through the API: what is lit, what is refused and leaves everything as it was, a host's own memory and
// events, log callbacks.
#include <catch2/catch.hpp>
#include <cmath>

#include "api/api_rig.h"
#include "lightwell/lightwell.hpp"

using namespace lightwell::test;
using Catch::Matchers::Contains;

TEST_CASE("a frame is lit, at both widths, whatever the layout", "[api]") {
    const auto width = GENERATE(1u, 16u);
    const bool small = GENERATE(false, true);
    ApiScene scene(small ? 1 : 257, small ? 1 : 89);
    Rig rig(scene, width);
    CHECK(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_ERROR_NOT_UPDATED);
    lastError(rig.device);
    REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
    REQUIRE(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    REQUIRE(lwFinish(rig.device) == LW_SUCCESS);
    CHECK(scene.lit());
    CHECK(scene.irradiance.damagedBytes() == 0);
    CHECK(scene.validity.damagedBytes() == 0);
    const LWStats stats = rig.stats();
    CHECK(stats.frameIndex == 12345);
    CHECK(stats.deviceBytes > 0);
    std::string names;
    for (std::uint32_t i = 0; i < stats.passCount; ++i) {
        names += std::string(stats.passes[i].name) + " ";
        CHECK(stats.passes[i].milliseconds >= 0.0);
    }
    CHECK_THAT(names, Contains("rsm_input.unpack") && Contains("gbuffer_input.unpack_normal") &&
                          Contains("output.pack"));
    std::uint64_t texels = 0;
    for (std::uint32_t i = 0; i < stats.countCount; ++i)
        if (std::string(stats.counts[i].name) == "rsm_texels") texels = stats.counts[i].value;
    CHECK(texels == ApiScene::kRsm * ApiScene::kRsm);
}

TEST_CASE("refused frames name the argument and change nothing", "[api]") {
    ApiScene scene;
    Rig rig(scene);
    REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
    const auto refusal = [&](const LWFrame* frame) {
        CHECK(lwUpdate(rig.technique, frame) == LW_ERROR_INVALID_ARGUMENT);
        return lastError(rig.device);
    };
    CHECK_THAT(refusal(nullptr), Contains("frame: expected a struct, got null"));
    LWFrame frame = scene.frame;
    frame.lights = nullptr;
    CHECK_THAT(refusal(&frame), Contains("frame.lights"));
    frame = scene.frame;
    frame.lightCount = 0xffffffffu;
    CHECK_THAT(refusal(&frame), Contains("frame.lightCount") && Contains("4294967295"));
    frame = scene.frame;
    frame.vplCount = 3;
    CHECK_THAT(refusal(&frame), Contains("frame.vpls"));
    frame = scene.frame;
    frame.environment[1] = std::nanf("");
    CHECK_THAT(refusal(&frame), Contains("frame.environment") && Contains("nan"));
    LWVpl vpl{};
    vpl.flux[0] = -1;
    frame = scene.frame;
    frame.vplCount = 1;
    frame.vpls = &vpl;
    CHECK_THAT(refusal(&frame), Contains("frame.vpls[0]"));
    vpl = LWVpl{};
    vpl.normal[1] = 1;
    vpl.flux[2] = 2e30f;  // finite, but sums of such are not; of RSM texels the same is refused
    CHECK_THAT(refusal(&frame), Contains("frame.vpls[0].flux") && Contains("1e+30"));
    vpl.flux[2] = 0;
    vpl.position[2] = 1.01e9f;
    CHECK_THAT(refusal(&frame), Contains("frame.vpls[0].position") && Contains("1e+09") && Contains("1.01e+09"));
    vpl.position[2] = std::nanf("");
    CHECK_THAT(refusal(&frame), Contains("frame.vpls[0].position") && Contains("nan"));
    vpl.position[2] = 0;
    vpl.area = HUGE_VALF;
    CHECK_THAT(refusal(&frame), Contains("frame.vpls[0].area") && Contains("inf"));
    vpl.area = 0;
    vpl.normal[1] = 2;
    CHECK_THAT(refusal(&frame), Contains("frame.vpls[0].normal") && Contains("unit length, got 2"));
    frame = scene.frame;
    LWSourceView source{};
    frame.sourceViewCount = 1;
    frame.sourceViews = &source;
    CHECK(lwUpdate(rig.technique, &frame) == LW_ERROR_INVALID_HANDLE);
    CHECK_THAT(lastError(rig.device), Contains("frame.sourceViews[0].view"));

    const auto withLight = [&](auto change) {
        LWLight light = scene.light;
        change(light);
        LWFrame changed = scene.frame;
        changed.lights = &light;
        return refusal(&changed);
    };
    CHECK_THAT(withLight([](LWLight& l) { l.structSize = 0; }), Contains("frame.lights[0].structSize"));
    CHECK_THAT(withLight([](LWLight& l) { l.rsms = nullptr; }), Contains("frame.lights[0].rsms"));
    CHECK_THAT(withLight([](LWLight& l) { l.rsmCount = 1000; }), Contains("frame.lights[0].rsmCount"));
    CHECK_THAT(withLight([](LWLight& l) { l.irradiance[2] = HUGE_VALF; }),
               Contains("frame.lights[0].irradiance"));
    CHECK_THAT(withLight([](LWLight& l) { l.outerConeAngle = 2; }),
               Contains("frame.lights[0].outerConeAngle"));
    CHECK_THAT(withLight([](LWLight& l) { setEnum(l.kind, 99); }), Contains("frame.lights[0].kind"));
    LWRsm rsm = scene.rsm;
    rsm.structSize = 7;
    CHECK_THAT(withLight([&](LWLight& l) { l.rsms = &rsm; }),
               Contains("frame.lights[0].rsms[0].structSize"));
    rsm = scene.rsm;
    rsm.camera.view[3] = HUGE_VALF;
    CHECK_THAT(withLight([&](LWLight& l) { l.rsms = &rsm; }),
               Contains("frame.lights[0].rsms[0].camera.view"));

    LWGBuffer gbuffer = scene.gbuffer;
    gbuffer.normal.format = LW_FORMAT_UINT8;
    CHECK(lwRender(rig.technique, rig.view, &gbuffer, &scene.output) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(rig.device), Contains("gbuffer.normal.format"));
    CHECK(lwRender(rig.technique, rig.view, nullptr, &scene.output) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lwRender(rig.technique, rig.view, &scene.gbuffer, nullptr) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lwRender(rig.technique, nullptr, &scene.gbuffer, &scene.output) == LW_ERROR_INVALID_HANDLE);
    LWOutput output = scene.output;
    output.irradiance = output.validity = LWImage{};
    CHECK(lwRender(rig.technique, rig.view, &scene.gbuffer, &output) == LW_ERROR_INVALID_ARGUMENT);
    output = scene.output;
    output.irradiance.format = LW_FORMAT_UNORM8X4;
    CHECK(lwRender(rig.technique, rig.view, &scene.gbuffer, &output) == LW_ERROR_INVALID_ARGUMENT);
    REQUIRE(lwSetViewSize(rig.view, 20, 10) == LW_SUCCESS);
    CHECK(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_ERROR_INVALID_ARGUMENT);
    REQUIRE(lwSetViewSize(rig.view, 24, 10) == LW_SUCCESS);
    LWSync sync{};
    sync.structSize = sizeof sync;
    sync.waitEventCount = 2;
    output = scene.output;
    output.sync = &sync;
    CHECK(lwRender(rig.technique, rig.view, &scene.gbuffer, &output) == LW_ERROR_INVALID_ARGUMENT);
    void* const none[2] = {};
    sync.waitEvents = none;
    CHECK(lwRender(rig.technique, rig.view, &scene.gbuffer, &output) == LW_ERROR_INVALID_ARGUMENT);
    lastError(rig.device);

    // The last good frame is still in force.
    CHECK(rig.stats().frameIndex == 12345);
    REQUIRE(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    REQUIRE(lwFinish(rig.device) == LW_SUCCESS);
    CHECK(scene.lit());
    CHECK(lastError(rig.device) == "");
}

TEST_CASE("the host's own VPLs may change as soon as the call is back", "[api]") {
    ApiScene scene;
    scene.frame.lightCount = 0;
    std::vector<LWVpl> vpls(3);
    const auto fill = [&](float flux) {
        for (LWVpl& vpl : vpls) {
            vpl = LWVpl{};
            vpl.normal[1] = 1;
            vpl.flux[0] = flux;
        }
    };
    scene.frame.vpls = vpls.data();
    scene.frame.vplCount = std::uint32_t(vpls.size());
    AdoptedRig rig(scene);
    const auto red = [&](ApiScene& from) { return from.irradiance.value(7, 5, 0); };
    fill(1);
    rig.frame(scene);
    const double one = red(scene);
    REQUIRE(one > 0.0);
    const std::uint64_t held = rig.info().allocatedBytes;
    // Three frames behind a closed gate, each with its own list in the same array.
    Gate gate(rig.host);
    ApiScene images[3];
    scene.frame.sync = gate.sync();
    for (int i = 0; i < 3; ++i) {
        fill(float(1 << i));
        REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
        REQUIRE(lwRender(rig.technique, rig.view, &images[i].gbuffer, &images[i].output) == LW_SUCCESS);
    }
    vpls.assign(3, LWVpl{});
    gate.open();
    const std::uint64_t copied = rig.stats().hostCopyBytes;
    if (rig.info().hostUnifiedMemory) CHECK(copied == 3 * sizeof(LWVpl));  // else the images, too
    CHECK(copied >= 3 * sizeof(LWVpl));
    for (int i = 0; i < 3; ++i) CHECK(red(images[i]) == one * (1 << i));
    CHECK(rig.info().allocatedBytes == held);
}

TEST_CASE("handles of another device are refused", "[api]") {
    ApiScene scene;
    Rig rig(scene), other(scene);
    REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
    CHECK(lwRender(rig.technique, other.view, &scene.gbuffer, &scene.output) == LW_ERROR_INVALID_HANDLE);
    CHECK_THAT(lastError(rig.device), Contains("another device"));
    CHECK(lwPrewarm(rig.technique, other.view) == LW_ERROR_INVALID_HANDLE);
    lwFinish(rig.device);
}

TEST_CASE("pixels without a surface, or with garbage, get exactly nothing", "[api]") {
    ApiScene scene;
    const double nan = std::nan("");
    scene.normal.set(3, 3, 0, 0, 0);
    scene.normal.set(4, 3, nan, 0, 0);
    scene.position.set(5, 3, nan, 0, 0);
    scene.position.set(6, 3, 0, HUGE_VAL, 0);
    Rig rig(scene, GENERATE(1u, 16u));
    REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
    REQUIRE(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    REQUIRE(lwFinish(rig.device) == LW_SUCCESS);
    for (std::uint32_t x = 3; x < 7; ++x) {
        CHECK(scene.irradiance.value(x, 3, 0) == 0.0);
        CHECK(scene.validity.value(x, 3, 0) == 0.0);
    }
    CHECK(scene.irradiance.value(7, 3, 0) > 0.0);
    CHECK(std::isfinite(scene.irradiance.value(2, 3, 0)));
}

TEST_CASE("a host's context, memory and events work together", "[api]") {
    ApiScene scene;
    cl_platform_id platform = nullptr;
    cl_device_id id = nullptr;
    REQUIRE(clGetPlatformIDs(1, &platform, nullptr) == CL_SUCCESS);
    REQUIRE(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &id, nullptr) == CL_SUCCESS);
    cl_int status = 0;
    const cl_context context = clCreateContext(nullptr, 1, &id, nullptr, nullptr, &status);
    REQUIRE(status == CL_SUCCESS);
    const cl_command_queue_properties properties = GENERATE(0, CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE);
    const cl_command_queue queue = clCreateCommandQueue(context, id, properties, &status);
    REQUIRE(status == CL_SUCCESS);
    const cl_mem result = clCreateBuffer(context, CL_MEM_READ_WRITE, 24 * 10 * 16, nullptr, &status);
    REQUIRE(status == CL_SUCCESS);

    LWDeviceDesc desc;
    lwDefaultDevice(&desc);
    desc.clContext = context;
    desc.clQueue = queue;
    desc.width = 16;
    lightwell::Device device(desc);
    lightwell::View view(device, 24, 10);
    lightwell::Technique technique(device, "rsm");
    // The frame waits until the host opens the gate.
    cl_event gate = clCreateUserEvent(context, &status);
    void* const waits[1] = {gate};
    void* signal = nullptr;
    auto sync = lightwell::make<LWSync>();
    sync.waitEventCount = 1;
    sync.waitEvents = waits;
    sync.signalEvent = &signal;
    scene.frame.sync = &sync;
    technique.update(scene.frame);
    REQUIRE(signal != nullptr);
    cl_int state = 0;
    clGetEventInfo(static_cast<cl_event>(signal), CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof state,
                   &state, nullptr);
    CHECK(state > CL_COMPLETE);
    clReleaseEvent(static_cast<cl_event>(signal));
    scene.output.irradiance = LWImage{};
    scene.output.irradiance.clMem = result;
    scene.output.irradiance.format = LW_FORMAT_FLOAT4;
    scene.output.irradiance.width = 24;
    scene.output.irradiance.height = 10;
    sync.waitEventCount = 0;
    scene.output.sync = &sync;
    technique.render(view, scene.gbuffer, scene.output);
    clSetUserEventStatus(gate, CL_COMPLETE);
    cl_event done = static_cast<cl_event>(signal);
    REQUIRE(clWaitForEvents(1, &done) == CL_SUCCESS);
    std::vector<float> pixels(24 * 10 * 4);
    REQUIRE(clEnqueueReadBuffer(queue, result, CL_TRUE, 0, pixels.size() * 4, pixels.data(), 0, nullptr,
                                nullptr) == CL_SUCCESS);
    for (std::size_t i = 0; i < pixels.size(); i += 4) {
        REQUIRE(pixels[i] > 0.0f);
        REQUIRE(pixels[i + 3] == 1.0f);
    }
    device.finish();
    clReleaseEvent(done);
    clReleaseEvent(gate);
    clReleaseMemObject(result);
    clReleaseCommandQueue(queue);
    clReleaseContext(context);
}

namespace {

struct LogState {
    int calls = 0;
    LWStatus inside = LW_SUCCESS, create = LW_SUCCESS, error = LW_SUCCESS;
};

void logAndCall(void* user, LWLogLevel, const char*) {
    auto& state = *static_cast<LogState*>(user);
    ++state.calls;
    std::uint32_t count = 0;
    state.inside = lwCountDevices(&count);
    LWDevice device = nullptr;
    state.create = lwCreateDevice(nullptr, &device);
    state.error = lwGetLastError(nullptr, nullptr);
}

}  // namespace

TEST_CASE("log callbacks can't call back", "[api]") {
    LogState state;
    LWDeviceDesc desc;
    lwDefaultDevice(&desc);
    desc.width = 16;
    desc.log = logAndCall;
    desc.logUser = &state;
    desc.cacheDirectory = "/dev/null/no/such/directory";  // unwritable: the device warns
    LWDevice device = nullptr;
    REQUIRE(lwCreateDevice(&desc, &device) == LW_SUCCESS);
    ApiScene scene;
    LWTechnique technique = nullptr;
    REQUIRE(lwCreateRsm(device, nullptr, &technique) == LW_SUCCESS);
    REQUIRE(lwUpdate(technique, &scene.frame) == LW_SUCCESS);
    REQUIRE(lwFinish(device) == LW_SUCCESS);
    REQUIRE(state.calls > 0);
    CHECK(state.inside == LW_ERROR_REENTRANT);
    CHECK(state.create == LW_ERROR_REENTRANT);
    CHECK(state.error == LW_ERROR_REENTRANT);
    lwReleaseTechnique(technique);
    lwReleaseDevice(device);
}
