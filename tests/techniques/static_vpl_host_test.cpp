// Technique static_vpl as a host uses it: pictures, several views, points, receivers with baked light,
// units, bits, nothing built late.
#include <catch2/catch.hpp>

#include "support/kernel_rig.h"
#include "support/packed_light.h"
#include "support/points_rig.h"
#include "support/static_vpl_rig.h"

using namespace lightwell::test;

namespace {

constexpr std::uint32_t kWidth = 45, kHeight = 32;
constexpr double kRounding = 1e-5;

// Places on a floor under wall and ceiling (lit_room.h), a lamp and a sun.
StaticScene litFloor(std::size_t count, double scale = 1.0) {
    StaticScene scene;
    for (std::size_t i = 0; i < count; ++i) {
        const double u = double(i) * 0.6180339887498949, x = u - std::floor(u) - 0.5,
                     z = (double(i) + 0.5) / double(count);
        scene.vpls.push_back(staticVpl({x * scale, 0, z * scale}, {0, 1, 0},
                                       scale * scale / double(count), {0.8, 0.5 + 0.4 * x, 0.3}));
    }
    scene.lights = {
        pointLight({0.1 * scale, 0.6 * scale, 0.4 * scale}, glm::dvec3(3, 2, 1) * scale * scale),
        sunLight({0.1, -1, 0}, {0.5, 1, 2})};
    scene.block({-0.2 * scale, 0.3 * scale, 0.3 * scale}, 0.15 * scale);
    return scene;
}

std::vector<float> render(std::uint32_t width, const LWStaticVplDesc& desc, const StaticScene& scene,
                          const WallAndCeiling& view) {
    StaticRig rig(width, desc);
    TestView target(rig.device, view.position.width(), view.position.height());
    rig.update(scene);
    return rig.technique.render(target, view.gbuffer);
}

}  // namespace

TEST_CASE("the picture is the VPLs' light", "[static_vpl]") {
    StaticRig rig(GENERATE(1u, 16u), staticDesc());
    WallAndCeiling view(kWidth, kHeight);
    TestView target(rig.device, kWidth, kHeight);
    rig.update(litFloor(50));
    const auto e = rig.technique.render(target, view.gbuffer);
    const auto vpls = rig.vpls();
    const std::size_t size = kWidth * kHeight;
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = 0; x < kWidth; ++x)
            for (std::size_t c = 0; c < 3; ++c) {
                double expected = 0.0;
                const auto p = view.position.get(x, y), n = view.normal.get(x, y);
                if (x > 0)
                    for (const auto& vpl : vpls)
                        expected += twinLight(vpl, {p.x, p.y, p.z}, {n.x, n.y, n.z}, int(c));
                CAPTURE(x, y, c);
                REQUIRE(double(e[c * size + y * kWidth + x]) ==
                        Approx(expected).epsilon(kRounding).margin(1e-7));
            }
}

TEST_CASE("static_vpl: same input, same bits; widths agree; units change nothing", "[static_vpl]") {
    WallAndCeiling view(kWidth, kHeight);
    LWStaticVplDesc desc = staticDesc();
    desc.bounces = 2;
    desc.automaticWeights = GENERATE(0u, 1u);
    desc.interleave = GENERATE(1u, 4u);
    const auto first = render(16, desc, litFloor(100), view);
    for (int run = 0; run < 10; ++run) {
        CAPTURE(run);
        CHECK(bitDifference(render(16, desc, litFloor(100), view), first) == "");
    }
    CHECK(difference(render(1, desc, litFloor(100), view), first) < kRounding);
    for (const double scale : {10.0, 0.01, 1000.0}) {
        CAPTURE(scale);
        WallAndCeiling scaled(kWidth, kHeight, scale);
        CHECK(difference(render(16, desc, litFloor(100, scale), scaled), first) < kRounding);
    }
}

TEST_CASE("static_vpl: interleaving and half resolution keep the light", "[static_vpl]") {
    WallAndCeiling view(96, 64);
    const StaticScene scene = litFloor(400);
    LWStaticVplDesc desc = staticDesc();
    const auto full = render(16, desc, scene, view);
    desc.interleave = 2;
    CHECK(difference(render(16, desc, scene, view), full) < 0.04);
    desc.interleave = 1;
    desc.resolution = LW_RESOLUTION_HALF;
    CHECK(difference(render(16, desc, scene, view), full) < 0.05);
}

TEST_CASE("static_vpl: one update serves two eyes", "[static_vpl]") {
    WallAndCeiling left(kWidth, kHeight), right(61, 40);
    const StaticScene scene = litFloor(60);
    const auto leftAlone = render(16, staticDesc(), scene, left),
               rightAlone = render(16, staticDesc(), scene, right);
    StaticRig rig(16, staticDesc());
    TestView leftView(rig.device, kWidth, kHeight), rightView(rig.device, 61, 40);
    rig.update(scene);
    CHECK(bitDifference(rig.technique.render(leftView, left.gbuffer), leftAlone) == "");
    CHECK(bitDifference(rig.technique.render(rightView, right.gbuffer), rightAlone) == "");
    CHECK(bitDifference(rig.technique.render(leftView, left.gbuffer), leftAlone) == "");
    // One update, however many views.
    const LWStats stats = rig.technique.stats();
    for (std::uint32_t i = 0; i < stats.passCount; ++i)
        if (std::string(stats.passes[i].name) == "static_vpl_light.update")
            CHECK(stats.passes[i].launches == 1);
}

TEST_CASE("static_vpl: points have the picture's light", "[static_vpl]") {
    StaticRig rig(16, staticDesc());
    WallAndCeiling view(kWidth, kHeight);
    TestView target(rig.device, kWidth, kHeight);
    rig.update(litFloor(60));
    const auto picture = rig.technique.render(target, view.gbuffer);
    const PointList list = PointList::ofScene(view);
    std::vector<float> e(3 * std::size_t(list.count()));
    const LWImage positions = listImage(list.positions, list.count(), 1, LW_FORMAT_FLOAT3),
                  normals = listImage(list.normals, list.count(), 1, LW_FORMAT_FLOAT3);
    LWPointOutput output;
    LW_INIT(output);
    output.irradiance = listImage(e, list.count(), 1, LW_FORMAT_FLOAT3);
    REQUIRE(lwRenderPoints(rig.technique, &positions, &normals, list.count(), &output) == LW_SUCCESS);
    REQUIRE(lwFinish(rig.device) == LW_SUCCESS);
    const std::size_t size = kWidth * kHeight;
    for (std::size_t i = 0; i < size; ++i)
        for (std::size_t c = 0; c < 3; ++c)
            REQUIRE(double(e[3 * i + c]) ==
                    Approx(double(picture[c * size + i])).epsilon(kRounding).margin(1e-7));
}

TEST_CASE("receivers with baked light get other lights' light only", "[static_vpl]") {
    WallAndCeiling view(kWidth, kHeight);
    StaticScene lamp = litFloor(60), sun = lamp, both = lamp;
    lamp.lights.resize(1);
    sun.lights.erase(sun.lights.begin());
    LWStaticVplDesc desc = staticDesc();
    desc.cullRelative = 0.0f;
    desc.interleave = GENERATE(1u, 2u);
    const auto all = render(16, desc, both, view), byLamp = render(16, desc, lamp, view);
    // The sun is in the baked maps of the right half.
    both.lights[1].receivers = LW_RECEIVERS_UNBAKED;
    PlanarPixels mask(kWidth, kHeight, 1);
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = kWidth / 2; x < kWidth; ++x) mask.at(x, y, 0) = 1.0f;
    StaticRig rig(16, desc);
    TestView target(rig.device, kWidth, kHeight);
    rig.update(both);
    CHECK(bitDifference(rig.technique.render(target, view.gbuffer), all) ==
          "");  // without a mask nothing is baked
    LWGBuffer masked = view.gbuffer;
    masked.bakedMask = mask.image();
    const auto split = rig.technique.render(target, masked);
    const std::size_t size = kWidth * kHeight;
    for (std::size_t i = 0; i < 3 * size; ++i) {
        const std::size_t x = i % size % kWidth;
        // Beside the border the filter knows less.
        if (desc.interleave > 1 && x + 2 > kWidth / 2 && x < kWidth / 2 + 2) continue;
        CAPTURE(i, x);
        REQUIRE(double(split[i]) ==
                Approx(double((x < kWidth / 2 ? all : byLamp)[i])).epsilon(kRounding).margin(1e-7));
    }
    // The same by the VPLs' own receivers, in the list of lights, and at points.
    const auto lights = rig.lights();
    glm::dvec3 flux(0.0), baked(0.0), lampFlux(0.0), allFlux(0.0);
    for (const auto& light : lights) flux += vec(light.flux), baked += vec(light.bakedFlux);
    StaticRig alone(16, desc);
    alone.update(lamp);
    for (const auto& vpl : alone.vpls()) lampFlux += vpl.flux;
    for (const auto& vpl : rig.vpls()) allFlux += vpl.flux;
    for (int c = 0; c < 3; ++c) {
        CHECK(flux[c] == Approx(allFlux[c]).epsilon(1e-5));
        CHECK(baked[c] == Approx(lampFlux[c]).epsilon(1e-5));
    }
    const PointList list = PointList::ofScene(view);
    std::vector<float> e(3 * std::size_t(list.count()));
    const LWImage positions = listImage(list.positions, list.count(), 1, LW_FORMAT_FLOAT3),
                  normals = listImage(list.normals, list.count(), 1, LW_FORMAT_FLOAT3);
    LWPointOutput output;
    LW_INIT(output);
    output.irradiance = listImage(e, list.count(), 1, LW_FORMAT_FLOAT3);
    output.baked = 1;
    REQUIRE(lwRenderPoints(rig.technique, &positions, &normals, list.count(), &output) == LW_SUCCESS);
    REQUIRE(lwFinish(rig.device) == LW_SUCCESS);
    if (desc.interleave == 1)
        for (std::size_t i = 0; i < size; ++i)
            REQUIRE(double(e[3 * i]) == Approx(double(byLamp[i])).epsilon(kRounding).margin(1e-7));
}

TEST_CASE("static_vpl: places may be for one kind of receiver", "[static_vpl]") {
    StaticRig rig(16, staticDesc());
    StaticScene scene = litFloor(10);
    for (std::size_t i = 0; i < 10; ++i) scene.vpls[i].receivers = std::uint32_t(i % 3);
    rig.update(scene);
    const auto unbaked = rig.flux(), baked = rig.flux(true);
    for (std::size_t i = 0; i < 10; ++i) {
        CHECK((unbaked[i].x > 0.0) == (i % 3 != 2));
        CHECK((baked[i].x > 0.0) == (i % 3 != 1));
    }
}

TEST_CASE("static_vpl: after lwPrewarm nothing is built", "[static_vpl]") {
    LWStaticVplDesc desc = staticDesc();
    desc.variant = GENERATE(LW_STATIC_VPL_STATIC, LW_STATIC_VPL_PHANTOM);
    desc.bounces = 2;
    desc.resolution = LW_RESOLUTION_HALF;
    desc.interleave = 2;
    StaticRig rig(16, desc);
    WallAndCeiling view(kWidth, kHeight);
    TestView target(rig.device, kWidth, kHeight);
    REQUIRE(lwPrewarm(rig.technique, target) == LW_SUCCESS);
    const LWDeviceInfo before = rig.device.info();
    for (const std::size_t count : {1u, 20u, 300u, 4000u}) {
        StaticScene scene = litFloor(count);
        scene.vpls[0].weight = 0.0f;
        const float hit[3] = {0, 0, 0.5f};
        scene.lights.push_back(spotLight({0, 1, 0.5}, {0, -1, 0}, {1, 1, 1}, 0.1, 0.4));
        scene.lights.back().hit = hit;
        scene.lights[0].receivers = LW_RECEIVERS_UNBAKED;
        PlanarPixels mask(kWidth, kHeight, 1);
        LWGBuffer masked = view.gbuffer;
        masked.bakedMask = mask.image();
        rig.update(scene);
        rig.technique.render(target, view.gbuffer);
        rig.technique.render(target, masked);
        rig.lights();
    }
    const LWDeviceInfo after = rig.device.info();
    CHECK(after.programsBuilt == before.programsBuilt);
    CHECK(after.kernelsSpecialised == before.kernelsSpecialised);
}

TEST_CASE("static_vpl: memory is as estimated", "[static_vpl]") {
    LWStaticVplDesc desc = staticDesc();
    desc.bounces = GENERATE(1u, 2u);
    desc.variant = GENERATE(LW_STATIC_VPL_STATIC, LW_STATIC_VPL_PHANTOM);
    StaticRig rig(16, desc);
    WallAndCeiling view(kWidth, kHeight);
    TestView target(rig.device, kWidth, kHeight);
    StaticScene scene = litFloor(77);
    const float hit[3] = {0, 0, 0.5f};
    scene.lights.push_back(spotLight({0, 1, 0.5}, {0, -1, 0}, {1, 1, 1}, 0.1, 0.4));
    scene.lights.back().hit = hit;
    const LWFrame frame = scene.frame();
    LWViewDesc size;
    LW_INIT(size);
    size.maxWidth = kWidth;
    size.maxHeight = kHeight;
    std::uint64_t most = 0;
    REQUIRE(lwEstimateFrameMemory(rig.device, "static_vpl", &desc, &size, &frame, &most) == LW_SUCCESS);
    rig.update(scene);
    rig.technique.render(target, view.gbuffer);
    const std::uint64_t held = rig.technique.stats().deviceBytes;
    CHECK(held <= most);
    // Inputs that lie in place take none of what unpacking would.
    const std::uint64_t unpacked = std::uint64_t(6 + 3 + 1) * 4 * 48 * kHeight;
    CHECK(held + unpacked >= most);
}

TEST_CASE("static_vpl: no number that is accepted puts anything but numbers into a picture",
          "[static_vpl]") {
    LWStaticVplDesc desc = staticDesc();
    desc.bounces = 2;
    desc.automaticWeights = GENERATE(0u, 1u);
    desc.variant = GENERATE(LW_STATIC_VPL_STATIC, LW_STATIC_VPL_PHANTOM);
    StaticRig rig(16, desc);
    WallAndCeiling view(kWidth, kHeight);
    TestView target(rig.device, kWidth, kHeight);
    const float far[3] = {6e8f, -6e8f, 1.0f}, near[3] = {0, 0, 0};
    for (const double weight : {0.0, 1e-38, 1.0, 1e18})
        for (const double bright : {0.0, 1e-38, 3e38})
            for (const double place : {0.0, 1e-30, 1e8})
                for (const float* hit : {far, near}) {
                    CAPTURE(weight, bright, place, hit[0]);
                    StaticScene scene;
                    scene.vpls = {staticVpl({0, 0, 0.5}, {0, 1, 0}, weight, glm::dvec3(1.0)),
                                  staticVpl({place, place, place}, {0, -1, 0}, weight, {0, 1, 1}),
                                  staticVpl({0, 0, 0.5}, {0, 1, 0}, weight)};
                    scene.lights = {
                        pointLight({0, 0, 0.5}, glm::dvec3(bright)),
                        sunLight({0, 0, 0}, glm::dvec3(bright)),
                        spotLight({0, 1, 0.5}, {0, -1e-30, 0}, glm::dvec3(bright), 0.0, 0.0),
                        sunLight({0, -1, 0}, glm::dvec3(bright)),
                        spotLight({5.7e8, 5.7e8, 5.7e8}, {3e38, 3e38, 3e38}, glm::dvec3(bright), 0.1, 0.4)};
                    for (int i = 2; i < 5; i += 2) scene.lights[std::size_t(i)].hit = hit;
                    scene.block({0, 0.5, 0.5}, 3e38);
                    scene.block({0, 0.5, 0.5}, 1e-38);
                    scene.block({3e38, -3e38, 3e38}, 1.0);
                    rig.update(scene);
                    bool finite = true;
                    for (const float e : rig.technique.render(target, view.gbuffer))
                        finite = finite && std::isfinite(e) && e >= 0.0f;
                    CHECK(finite);
                    finite = true;
                    for (const LWListedLight& light : rig.lights())
                        for (const float* values :
                             {light.position, light.axis, light.flux, light.spotIntensity})
                            for (int a = 0; a < 3; ++a) finite = finite && std::isfinite(values[a]);
                    CHECK(finite);
                }
}
