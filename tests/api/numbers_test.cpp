// Whatever floats a host hands over, in structs and in pixels: a frame is refused with a reason, or its picture
// holds finite numbers of 0 or more.
#include <array>
#include <catch2/catch.hpp>
#include <cfloat>
#include <cmath>
#include <random>

#include "api/api_rig.h"

using namespace lightwell::test;

namespace {

constexpr float kNaN = __builtin_nanf(""), kInfinity = __builtin_inff();
// The borders of every check, and what lies beyond them.
constexpr float kValues[] = {kNaN,    kInfinity, -kInfinity, FLT_MAX, -FLT_MAX, 1e30f,  9.9e18f, 4e18f,  -1e10f, 1.1e9f,
                             0.9e9f,  1e5f,      1e-10f,     1e-20f,  -1e-30f,  1e-40f, 0.0f,    -0.0f,  1.0f,   -1.0f};

LWRsmDesc descOf(std::uint32_t interleave, LWResolution resolution) {
    LWRsmDesc desc;
    lwDefaultRsm(&desc);
    desc.vpls = 64;
    desc.interleave = interleave;
    desc.resolution = resolution;
    return desc;
}

struct NumbersRig : ApiRig {
    NumbersRig(const ApiScene& scene, std::uint32_t width, const LWRsmDesc& desc) : ApiRig(makeDevice(width), scene, &desc) {}

    // What is wrong with the frame's picture, or nothing.
    std::string fault(ApiScene& scene) {
        LWStatus status = lwUpdate(technique, &scene.frame);
        if (status == LW_SUCCESS) status = lwRender(technique, view, &scene.gbuffer, &scene.output);
        if (status == LW_ERROR_INVALID_ARGUMENT) {
            ++refused;
            return lastError(device).empty() ? "refused without a reason" : "";
        }
        if (status != LW_SUCCESS || lwFinish(device) != LW_SUCCESS) return lastError(device);
        ++rendered;
        for (std::uint32_t y = 0; y < scene.irradiance.height(); ++y)
            for (std::uint32_t x = 0; x < scene.irradiance.width(); ++x)
                for (int c = 0; c < 3; ++c) {
                    const double value = scene.irradiance.value(x, y, c);
                    if (!(std::isfinite(value) && value >= 0.0)) return "irradiance of " + std::to_string(value);
                }
        return "";
    }
    int refused = 0, rendered = 0;
};

// A frame in which every struct with floats takes part; the first VPL lies in a pixel.
struct FullScene : ApiScene {
    explicit FullScene(bool perspective) {
        for (LWVpl& vpl : vpls) {
            vpl.normal[1] = 1;
            vpl.flux[0] = 1;
        }
        vpls[0].position[0] = float(12.5 / 24 - 0.5);
        vpls[0].position[1] = 0.5f;
        vpls[0].position[2] = float(5.5 / 10 - 0.5);
        vpls[1].area = 0.01f;
        frame.vpls = vpls.data();
        frame.vplCount = std::uint32_t(vpls.size());
        frame.blockers = &blocker;
        frame.blockerCount = 1;
        if (!perspective) return;
        TestCamera camera = testCamera(kRightHanded, glm::dvec3(0, 2, 0));
        camera.right = {1, 0, 0};
        camera.up = {0, 0, -1};
        camera.forward = {0, -1, 0};
        rsm.camera = camera.matrices();
        light.kind = LW_LIGHT_SPOT;
        light.outerConeAngle = 1;
    }
    std::array<LWVpl, 2> vpls{};
    LWBlocker blocker{};
};

}  // namespace

TEST_CASE("any float in any struct: refused, or a picture of finite numbers", "[api][numbers]") {
    const auto width = GENERATE(1u, 16u);
    const bool perspective = GENERATE(false, true);
    FullScene scene(perspective);
    NumbersRig rig(scene, width, descOf(4, LW_RESOLUTION_FULL));
    REQUIRE(rig.fault(scene) == "");
    const auto sweep = [&](const char* name, float* values, int count) {
        for (int i = 0; i < count; ++i) {
            const float before = values[i];
            for (const float value : kValues) {
                CAPTURE(name, i, value, width, perspective);
                values[i] = value;
                CHECK(rig.fault(scene) == "");
            }
            values[i] = before;
        }
    };
    sweep("vpls", scene.vpls[0].position, int(sizeof(LWVpl) / sizeof(float)));
    sweep("view", scene.rsm.camera.view, 16);
    sweep("projection", scene.rsm.camera.projection, 16);
    if (width == 16 && !perspective) {  // checked on the host, or not used
        sweep("light", scene.light.position, 14);
        sweep("blocker", scene.blocker.center, 4);
        sweep("environment", scene.frame.environment, 3);
    }
    // The strongest light that is accepted, at hardly any distance, and nothing that bounds it.
    scene.vpls[0].flux[0] = 1e30f;
    scene.vpls[0].position[1] = 0.49999997f;
    CHECK(rig.fault(scene) == "");
    CHECK(rig.rendered > 300);
    CHECK(rig.refused > 200);
}

TEST_CASE("any float in pixels: a picture of finite numbers", "[api][numbers]") {
    const auto width = GENERATE(1u, 16u);
    const auto interleave = GENERATE(1u, 4u);
    const auto resolution = GENERATE(LW_RESOLUTION_FULL, LW_RESOLUTION_HALF);
    std::mt19937 random(7);
    const FullScene clean(false);
    NumbersRig rig(clean, width, descOf(interleave, resolution));
    const auto spoil = [&](HostImage& image, unsigned every) {
        const auto value = [&] { return double(kValues[random() % (sizeof kValues / sizeof kValues[0])]); };
        for (std::uint32_t y = 0; y < image.height(); ++y)
            for (std::uint32_t x = 0; x < image.width(); ++x)
                if (random() % every == 0) {
                    const double a = value(), b = value();
                    image.set(x, y, a, b, value());
                }
    };
    for (int round = 0; round < 40; ++round) {
        CAPTURE(round, width, interleave, resolution);
        FullScene scene(false);
        for (HostImage* image : {&scene.rsmFlux, &scene.rsmPosition, &scene.rsmNormal, &scene.position, &scene.normal})
            spoil(*image, round % 2 ? 3 : 40);
        REQUIRE(rig.fault(scene) == "");
    }
    CHECK(rig.rendered == 40);
}
