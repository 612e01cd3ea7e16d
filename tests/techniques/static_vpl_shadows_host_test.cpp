// Technique static_vpl with visibility as a host uses it: points, receivers with baked light, bits,
// nothing built late, memory.
#include <catch2/catch.hpp>

#include "support/static_vpl_plates.h"

using namespace lightwell::test;
using namespace lightwell::test::plates;

TEST_CASE("static_vpl: points are shadowed as pixels are", "[static_vpl][shadows]") {
    const LWVisibility visibility = GENERATE(LW_VISIBILITY_HARD, LW_VISIBILITY_VOXEL);
    LWStaticVplDesc desc = descOf(visibility);
    desc.bounces = 2;
    desc.secondDistance = 0.6f;
    StaticRig rig(16, desc);
    WallAndCeiling view(kWidth, kHeight);
    TestView target(rig.device, kWidth, kHeight);
    Walls walls = withPlate();
    rig.update(litFloor(20, walls.describe()));
    const auto picture = rig.technique.render(target, view.gbuffer);
    const PointLights lights = renderPoints(rig.device, rig.technique, PointList::ofScene(view));
    const std::size_t size = kWidth * kHeight;
    for (std::size_t i = 0; i < size; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            CAPTURE(i, c);
            REQUIRE(lights.e(i, c) ==
                    Approx(double(picture[c * size + i])).epsilon(kRounding).margin(1e-7));
        }
    // Its bands see the plate too: what they give the brightest part of the ceiling is nearer to the
    // shadowed light.
    LWStaticVplDesc off = desc;
    off.visibility = LW_VISIBILITY_NONE;
    StaticRig open(16, off);
    open.update(litFloor(20, walls.describe()));
    const PointLights lit = renderPoints(open.device, open.technique, PointList::ofScene(view));
    double shadowed = 0.0, unshadowed = 0.0;
    for (std::size_t i = size / 2; i < size; ++i)
        shadowed += lights.band(0, i), unshadowed += lit.band(0, i);
    CHECK(shadowed < 0.9 * unshadowed);
    CHECK(shadowed > 0.0);
}

TEST_CASE("static_vpl: receivers with baked light are shadowed too", "[static_vpl][shadows]") {
    WallAndCeiling view(kWidth, kHeight);
    Walls walls = withPlate();
    StaticScene both = litFloor(20, walls.describe()), lamp = both;
    lamp.lights.resize(1);
    LWStaticVplDesc desc = descOf(LW_VISIBILITY_HARD);
    desc.cullRelative = 0.0f;
    desc.clusters = GENERATE(0u, 8u);
    const auto all = render(16, desc, both, view), byLamp = render(16, desc, lamp, view);
    both.lights[1].receivers = LW_RECEIVERS_UNBAKED;
    PlanarPixels mask(kWidth, kHeight, 1);
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = kWidth / 2; x < kWidth; ++x) mask.at(x, y, 0) = 1.0f;
    StaticRig rig(16, desc);
    TestView target(rig.device, kWidth, kHeight);
    rig.update(both);
    LWGBuffer masked = view.gbuffer;
    masked.bakedMask = mask.image();
    const auto split = rig.technique.render(target, masked);
    for (std::size_t i = 0; i < split.size(); ++i) {
        CAPTURE(i);
        REQUIRE(
            double(split[i]) ==
            Approx(double((i % kWidth < kWidth / 2 ? all : byLamp)[i])).epsilon(kRounding).margin(1e-7));
    }
    // A place that only receivers with baked light see has its own look.
    StaticScene baked = lamp;
    for (LWStaticVpl& vpl : baked.vpls) vpl.receivers = LW_RECEIVERS_BAKED;
    rig.update(baked);
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = 0; x < kWidth; ++x) mask.at(x, y, 0) = 1.0f;
    masked.bakedMask = mask.image();
    CHECK(difference(rig.technique.render(target, masked), byLamp) < (desc.clusters ? 0.05 : kRounding));
}

TEST_CASE("static_vpl with shadows: same input, same bits; widths agree", "[static_vpl][shadows]") {
    WallAndCeiling view(kWidth, kHeight);
    Walls walls = withPlate();
    const StaticScene scene = litFloor(60, walls.describe());
    LWStaticVplDesc desc = descOf(GENERATE(LW_VISIBILITY_HARD, LW_VISIBILITY_VOXEL));
    desc.bounces = 2;
    desc.shadowedBounces = 2;
    desc.interleave = GENERATE(1u, 4u);
    const auto first = render(16, desc, scene, view);
    for (int run = 0; run < 3; ++run) CHECK(bitDifference(render(16, desc, scene, view), first) == "");
    // Texels on an edge may fall to either side of it.
    CHECK(difference(render(1, desc, scene, view), first) < 1e-3);
}

TEST_CASE("static_vpl with shadows: after lwPrewarm nothing is built, and memory is as estimated",
          "[static_vpl][shadows]") {
    LWStaticVplDesc desc = descOf(GENERATE(LW_VISIBILITY_SOFT, LW_VISIBILITY_VOXEL), 64);
    desc.bounces = 2;
    desc.voxels = 32;
    StaticRig rig(16, desc);
    WallAndCeiling view(kWidth, kHeight);
    TestView target(rig.device, kWidth, kHeight);
    REQUIRE(lwPrewarm(rig.technique, target) == LW_SUCCESS);
    const LWDeviceInfo before = rig.device.info();
    Walls triangles = withPlate(), surfels = withPlate();
    const LWGeometry* geometries[2] = {triangles.describe(), surfels.describeSurfels(0.05)};
    const PointList list = PointList::ofScene(view);
    LWViewDesc size;
    LW_INIT(size);
    size.maxWidth = kWidth;
    size.maxHeight = kHeight;
    for (const std::size_t count : {1u, 300u})
        for (const LWGeometry* geometry : geometries) {
            const StaticScene scene = litFloor(count, geometry);
            rig.update(scene);
            rig.technique.render(target, view.gbuffer);
            renderPoints(rig.device, rig.technique, list);
            rig.lights();
            const LWFrame frame = scene.frame();
            std::uint64_t most = 0;
            REQUIRE(lwEstimateFrameMemory(rig.device, "static_vpl", &desc, &size, &frame, &most) ==
                    LW_SUCCESS);
            StaticRig alone(16, desc);
            TestView aloneTarget(alone.device, kWidth, kHeight);
            alone.update(scene);
            alone.technique.render(aloneTarget, view.gbuffer);
            const std::uint64_t held = alone.technique.stats().deviceBytes;
            CAPTURE(count, geometry == geometries[1]);
            CHECK(held <= most);
            // Inputs that lie in place take none of what unpacking would.
            CHECK(held + std::uint64_t(6 + 3 + 1) * 4 * 48 * kHeight + 4096 >= most);
        }
    const LWDeviceInfo after = rig.device.info();
    CHECK(after.programsBuilt == before.programsBuilt);
    CHECK(after.kernelsSpecialised == before.kernelsSpecialised);
}
