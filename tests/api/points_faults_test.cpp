// A driver that fails at any call of lwRenderPoints, or of a view's radiance along glossy lobes: it is told, the call may be repeated,
// and the next frame is right.
#include <catch2/catch.hpp>
#include <functional>
#include <string>
#include <vector>

#include "api/api_rig.h"
#include "support/cl_faults.h"

using namespace lightwell::test;

namespace {

constexpr int kMostCalls = 400;
constexpr std::uint32_t kPoints = 300;  // a row of 256, and a part of one

bool isDriverError(LWStatus status) {
    return status == LW_ERROR_OUT_OF_MEMORY || status == LW_ERROR_DEVICE || status == LW_ERROR_INTERNAL;
}

LWImage imageOf(std::vector<float>& values, std::uint32_t rows, LWFormat format) {
    LWImage image{};
    image.host = values.data();
    image.format = format;
    image.width = kPoints;
    image.height = rows;
    return image;
}

// Surfaces above the rig's floor that look down on it.
struct PointCall {
    std::vector<float> positions = std::vector<float>(3 * kPoints), normals = positions, irradiance = positions,
                       harmonics = std::vector<float>(12 * kPoints), validity = std::vector<float>(kPoints);
    LWImage position{}, normal{};
    LWPointOutput output{};
    PointCall() {
        for (std::uint32_t i = 0; i < kPoints; ++i) {
            positions[3 * i] = 0.3f - 0.002f * float(i);
            positions[3 * i + 1] = 0.5f;
            normals[3 * i + 1] = -1.0f;
        }
        position = imageOf(positions, 1, LW_FORMAT_FLOAT3);
        normal = imageOf(normals, 1, LW_FORMAT_FLOAT3);
        output.structSize = sizeof output;
        output.irradiance = imageOf(irradiance, 1, LW_FORMAT_FLOAT3);
        output.harmonics = imageOf(harmonics, 4, LW_FORMAT_FLOAT3);
        output.validity = imageOf(validity, 1, LW_FORMAT_FLOAT1);
    }
    PointCall(const PointCall&) = delete;
    LWStatus run(LWTechnique technique) { return lwRenderPoints(technique, &position, &normal, kPoints, &output); }
    std::vector<float> result() const {
        std::vector<float> all = irradiance;
        all.insert(all.end(), harmonics.begin(), harmonics.end());
        all.insert(all.end(), validity.begin(), validity.end());
        return all;
    }
    void clear() {
        for (std::vector<float>* values : {&irradiance, &harmonics, &validity}) values->assign(values->size(), -1.0f);
    }
};

LWLpvDesc lpvDesc(LWLpvTransport transport, std::uint32_t cascades = 1) {
    LWLpvDesc desc;
    lwDefaultLpv(&desc);
    desc.size = 16;
    desc.steps = 4;
    desc.directions = 24;
    desc.transport = transport;
    desc.extent = 3.0f;
    desc.cascades = cascades;
    return desc;
}

struct Maker {
    const char* name;
    std::function<LWStatus(LWDevice, LWTechnique*)> make;
};

std::vector<Maker> makers() {
    const auto lpv = [](LWLpvTransport transport, std::uint32_t cascades) {
        return [=](LWDevice device, LWTechnique* technique) {
            const LWLpvDesc desc = lpvDesc(transport, cascades);
            return lwCreateLpv(device, &desc, technique);
        };
    };
    const auto rsm = [](LWDevice device, LWTechnique* technique) { return lwCreateRsm(device, nullptr, technique); };
    const auto ssvp = [](LWDevice device, LWTechnique* technique) {
        LWSsvpDesc desc;
        lwDefaultSsvp(&desc);
        desc.vpls = 16;
        desc.clusters = 2;
        desc.bounces = 1;
        desc.mapSize = 64;
        return lwCreateSsvp(device, &desc, technique);
    };
    const auto joined = [=](LWDevice device, LWTechnique* technique) {
        LWTechnique first = nullptr, second = nullptr;
        LWFallbackDesc desc;
        lwDefaultFallback(&desc);
        LWStatus status = lpv(LW_LPV_TRANSPORT_PROPAGATE, 1)(device, &first);
        if (status == LW_SUCCESS) status = rsm(device, &second);
        desc.first = first;
        desc.second = second;
        if (status == LW_SUCCESS) status = lwCreateFallback(device, &desc, technique);
        lwReleaseTechnique(first);
        lwReleaseTechnique(second);
        return status;
    };
    return {{"rsm", rsm},
            {"ssvp", ssvp},
            {"lpv", lpv(LW_LPV_TRANSPORT_PROPAGATE, 1)},
            {"lpv sweep", lpv(LW_LPV_TRANSPORT_SWEEP, 1)},
            {"lpv cascaded", lpv(LW_LPV_TRANSPORT_PROPAGATE, 2)},
            {"fallback", joined}};
}

// Fails one OpenCL call of `call` after another, each of a new technique's first frame.
void failEach(LWDevice device, const LWFrame& frame, const Maker& maker, const std::function<LWStatus(LWTechnique)>& call,
              const std::function<std::vector<float>()>& result) {
    CAPTURE(maker.name);
    std::vector<float> expected;
    int faults = -1;
    for (int failing = 0; failing < kMostCalls; ++failing) {
        LWTechnique technique = nullptr;
        REQUIRE(maker.make(device, &technique) == LW_SUCCESS);
        REQUIRE(lwUpdate(technique, &frame) == LW_SUCCESS);
        REQUIRE(lwFinish(device) == LW_SUCCESS);
        if (failing == 0) {
            REQUIRE(call(technique) == LW_SUCCESS);
            REQUIRE(lwFinish(device) == LW_SUCCESS);
            expected = result();
            lwReleaseTechnique(technique);
            REQUIRE(maker.make(device, &technique) == LW_SUCCESS);
            REQUIRE(lwUpdate(technique, &frame) == LW_SUCCESS);
        }
        LWStatus status, finished;
        bool happened;
        std::string function;
        {
            const ClFault fault(failing, CL_OUT_OF_RESOURCES);
            status = call(technique);
            finished = lwFinish(device);
            happened = fault.happened();
            function = fault.function();
        }
        CAPTURE(failing, function, status, finished);
        if (!happened) {
            CHECK(status == LW_SUCCESS);
            faults = failing;
        } else {
            CHECK(int(isDriverError(status)) + int(isDriverError(finished)) == 1);
            if (isDriverError(status)) {
                REQUIRE(call(technique) == LW_SUCCESS);
                REQUIRE(lwFinish(device) == LW_SUCCESS);
                REQUIRE((result() == expected));
            }
            REQUIRE(lwUpdate(technique, &frame) == LW_SUCCESS);
            REQUIRE(call(technique) == LW_SUCCESS);
            REQUIRE(lwFinish(device) == LW_SUCCESS);
            REQUIRE((result() == expected));
        }
        lwReleaseTechnique(technique);
        if (!happened) break;
    }
    CHECK(faults > 10);
    double most = 0.0;
    for (const float value : expected) most = std::max(most, double(value));
    CHECK(most > 1e-3);
}

}  // namespace

TEST_CASE("whichever OpenCL call of lwRenderPoints fails, it is told, and the next call and frame are right", "[faults][points]") {
    const LWDevice device = makeDevice(16, [](void*, LWLogLevel, const char*) {});
    const ApiScene scene;
    PointCall points;
    for (const Maker& maker : makers()) failEach(device, scene.frame, maker, [&](LWTechnique technique) {
        points.clear();
        return points.run(technique);
    }, [&] { return points.result(); });
    lwReleaseDevice(device);
}

TEST_CASE("whichever OpenCL call of specular radiance fails, it is told, and the next call and frame are right", "[faults][lpv]") {
    const LWDevice device = makeDevice(16, [](void*, LWLogLevel, const char*) {});
    ApiScene scene;
    TestCamera camera = testCamera(kRightHanded, glm::dvec3(0, 0.1, 0));  // from the floor to the surfaces above
    camera.right = {1, 0, 0};
    camera.up = {0, 0, 1};
    camera.forward = {0, 1, 0};
    scene.gbuffer.camera = camera.matrices();
    HostImage specular(LW_FORMAT_FLOAT3, scene.position.width(), scene.position.height());
    scene.output.specularRadiance = specular.image();
    const LWViewDesc viewDesc = scene.viewDesc();
    LWView view = nullptr;
    REQUIRE(lwCreateView(device, &viewDesc, &view) == LW_SUCCESS);
    const auto transport = GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP, LW_LPV_TRANSPORT_COARSE_TO_FINE);
    const auto resolution = GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_HALF);
    const Maker maker{"lpv", [=](LWDevice of, LWTechnique* technique) {
                          LWLpvDesc desc = lpvDesc(transport);
                          desc.resolution = resolution;
                          return lwCreateLpv(of, &desc, technique);
                      }};
    CAPTURE(int(transport), int(resolution));
    failEach(device, scene.frame, maker, [&](LWTechnique technique) { return lwRender(technique, view, &scene.gbuffer, &scene.output); },
             [&] {
                 std::vector<float> all;
                 for (std::uint32_t y = 0; y < specular.height(); ++y)
                     for (std::uint32_t x = 0; x < specular.width(); ++x)
                         for (int c = 0; c < 3; ++c) all.push_back(float(specular.value(x, y, c)));
                 return all;
             });
    lwReleaseView(view);
    lwReleaseDevice(device);
}
