// What must not change a picture's bits: a reset where a technique keeps no history, and the number of
// compute units.
#include <catch2/catch.hpp>

#include "api/api_rig.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;

namespace {

std::uint64_t differing(const HostImage& one, const HostImage& other) {
    std::uint64_t count = 0;
    for (std::uint32_t y = 0; y < one.height(); ++y)
        for (std::uint32_t x = 0; x < one.width(); ++x)
            for (int c = 0; c < 3; ++c) count += one.value(x, y, c) != other.value(x, y, c);
    return count;
}

}  // namespace

TEST_CASE("a reset changes nothing where there is no history", "[api]") {
    ApiScene scene, again;
    Rig rig(scene);
    rig.frame(scene);
    again.frame.reset = 1;
    rig.frame(again);
    CHECK(again.lit());
    CHECK(differing(scene.irradiance, again.irradiance) == 0);
}

TEST_CASE("one compute unit gives the bits of all of them", "[api]") {
    ApiScene scene(65, 33), again(65, 33);
    Rig whole(scene);
    whole.frame(scene);
    LWDeviceDesc desc;
    lwDefaultDevice(&desc);
    desc.width = 16;
    desc.maxComputeUnits = 1;
    LWDevice device = nullptr;
    const LWStatus status = lwCreateDevice(&desc, &device);
    if (status != LW_SUCCESS) {  // a device that cannot be split says so
        CHECK(status == LW_ERROR_UNSUPPORTED);
        CHECK_THAT(lastError(), Contains("maxComputeUnits"));
        return;
    }
    ApiRig part(device, again);
    CHECK(part.info().computeUnits == 1);
    part.frame(again);
    CHECK(again.lit());
    CHECK(differing(scene.irradiance, again.irradiance) == 0);
}
