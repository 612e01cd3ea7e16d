// Every combination of what lies around the interleaved gather: half resolution, filter, history, compensation, and which of
// the outputs are wanted. A picture of odd size.
#include <catch2/catch.hpp>
#include <cmath>

#include "support/camera_matrices.h"
#include "support/lit_room.h"
#include "support/scoped_api.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 45, kHeight = 37;

double evenly(double, double) { return 0.8; }

// WallAndCeiling, its wall lit, before a camera; positions need not be those of its pixels.
struct Scene : WallAndCeiling {
    Scene() : WallAndCeiling(kWidth, kHeight), radiance(kWidth, kHeight, 3) {
        for (std::uint32_t y = 0; y < kHeight; ++y)
            for (std::uint32_t x = 1; x < kWidth; ++x) radiance.set(x, y, normal.get(x, y).z > 0.5 ? Vec{0.2, 0.2, 0.2} : Vec{});
        gbuffer.directRadiance = radiance.image();
        gbuffer.camera = testCamera(kRightHanded, {0.3, 0.5, 3.0}).matrices();
    }
    PlanarPixels radiance;
};

struct Picture {
    std::vector<float> irradiance, validity;
    std::uint64_t bytes = 0;
};

// The first frame after a cut.
Picture render(LWDevice device, const LWSsvpDesc& desc, const LitFloor& floor, const Scene& scene, bool irradiance, bool validity) {
    TestTechnique technique(device, desc);
    TestView view(device, kWidth, kHeight);
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.lightCount = 1;
    frame.lights = &floor.light;
    frame.reset = 1;
    technique.update(frame);
    PlanarPixels light(kWidth, kHeight, 3), share(kWidth, kHeight, 1);
    LWOutput output{};
    output.structSize = sizeof output;
    if (irradiance) output.irradiance = light.image();
    if (validity) output.validity = share.image();
    const LWStatus status = lwRender(technique, view, &scene.gbuffer, &output);
    INFO(lastError(device));
    REQUIRE(status == LW_SUCCESS);
    REQUIRE(lwFinish(device) == LW_SUCCESS);
    return {light.packed(), share.packed(), technique.stats().deviceBytes};
}

std::uint64_t estimate(LWDevice device, const LWSsvpDesc& desc) {
    LWViewDesc view{};
    view.structSize = sizeof view;
    view.maxWidth = kWidth;
    view.maxHeight = kHeight;
    std::uint64_t bytes = 0;
    REQUIRE(lwEstimateMemory(device, "ssvp", &desc, &view, 32 * 32, &bytes) == LW_SUCCESS);
    return bytes;
}

}  // namespace

TEST_CASE("fewer pixels, filter, history, compensation and outputs in every combination", "[ssvp][interleaved_view]") {
    TestDevice device(GENERATE(1u, 16u));
    const LitFloor floor(32, evenly);
    const Scene scene;
    const LWResolution reduced = GENERATE(LW_RESOLUTION_HALF, LW_RESOLUTION_QUARTER);
    for (int bits = reduced == LW_RESOLUTION_HALF ? 0 : 1; bits < 16; bits += reduced == LW_RESOLUTION_HALF ? 1 : 2) {
        LWSsvpDesc desc;
        lwDefaultSsvp(&desc);
        desc.vpls = 64;
        desc.bounces = 1;
        desc.visibility = LW_VISIBILITY_NONE;
        desc.resolution = (bits & 1) ? reduced : LW_RESOLUTION_FULL;
        desc.filter = (bits & 2) ? 1 : 0;
        desc.interleave = (bits & 4) ? 4 : 1;
        desc.compensation = (bits & 8) ? 4 : 0;
        CAPTURE(bits);
        const Picture both = render(device, desc, floor, scene, true, true);
        double sum = 0.0;
        for (std::size_t i = 0; i < both.irradiance.size(); ++i) {
            const bool surface = i % kWidth != 0;
            REQUIRE(both.validity[i % both.validity.size()] == (surface ? 1.0f : 0.0f));
            REQUIRE((both.irradiance[i] >= 0.0f && both.irradiance[i] < 10.0f));
            if (!surface) REQUIRE(both.irradiance[i] == 0.0f);
            sum += double(both.irradiance[i]);
        }
        CHECK(sum > 0.0);
        CHECK(both.bytes <= estimate(device, desc));
        // Neither output depends on the other being wanted.
        CHECK(render(device, desc, floor, scene, true, false).irradiance == both.irradiance);
        CHECK(render(device, desc, floor, scene, false, true).validity == both.validity);
        // A history that has just begun is the frame alone.
        LWSsvpDesc kept = desc;
        kept.history = 8;
        const Picture begun = render(device, kept, floor, scene, true, true);
        CHECK(begun.irradiance == both.irradiance);
        CHECK(begun.validity == both.validity);
        CHECK(begun.bytes <= estimate(device, kept));
        CHECK(render(device, kept, floor, scene, false, true).validity == both.validity);
    }
}
