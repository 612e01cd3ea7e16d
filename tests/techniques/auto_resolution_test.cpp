// auto_resolution of rsm and ssvp: half resolution, with the pixels gathered by themselves that it does not get right.
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "support/camera_matrices.h"
#include "support/lit_room.h"
#include "support/scoped_api.h"
#include "support/walls.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 96, kHeight = 64;
// Sums of the same terms in another order.
constexpr double kRounding = 1e-5;

double spotProfile(double x, double z) {
    const double dx = x - 0.037, dz = z - 0.521, r2 = dx * dx + dz * dz;
    return r2 > 0.06 ? 0.0 : 0.8 * (1.0 - 6.0 * r2);
}

// A lit floor before a wall, with sticks one pixel wide across the wall that face aside: no half resolution has them all.
struct Sticks : WallAndCeiling {
    Sticks() : WallAndCeiling(kWidth, kHeight) {
        gbuffer.camera = testCamera(kRightHanded, {0.3, 0.5, 3.0}).matrices();
        for (std::uint32_t x = 13; x < kWidth; x += 30)
            for (std::uint32_t y = 4; y < 28; ++y) {
                position.set(x, y, {position.get(x, y).x, position.get(x, y).y, 0.2});
                normal.set(x, y, {x % 60 < 30 ? 1.0 : -1.0, 0, 0});
            }
    }
};

LWRsmDesc rsmDesc(float share) {
    LWRsmDesc desc;
    lwDefaultRsm(&desc);
    desc.autoResolution = share;
    return desc;
}

LWSsvpDesc ssvpDesc(float share) {
    LWSsvpDesc desc;
    lwDefaultSsvp(&desc);
    desc.clusters = 4;
    desc.bounces = 1;
    desc.mapSize = 64;
    desc.autoResolution = share;
    return desc;
}

// Four bounces, two of them shadowed: with occluders all around there is light of all four.
LWSsvpDesc carefulDesc(float share) {
    LWSsvpDesc desc = ssvpDesc(share);
    desc.visibility = LW_VISIBILITY_CAREFUL;
    desc.bounces = 4;
    return desc;
}

struct Result {
    std::vector<float> light, marks;
    std::uint64_t repaired = 0, unrepaired = 0;
};

template <class Desc>
Result render(LWDevice device, const Desc& desc, const LitFloor& floor, const Sticks& scene, const LWGeometry* geometry = nullptr) {
    TestTechnique technique(device, desc);
    TestView view(device, kWidth, kHeight);
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.lightCount = 1;
    frame.lights = &floor.light;
    frame.geometry = geometry;
    technique.update(frame);
    Result result;
    result.light = technique.render(view, scene.gbuffer);
    if (!(desc.autoResolution > 0.0f)) return result;
    result.repaired = technique.count("repaired_pixels");
    result.unrepaired = technique.count("unrepaired_pixels");
    return result;
}

double rootMeanSquare(const std::vector<float>& a, const std::vector<float>& b) {
    double square = 0.0, mean = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        square += std::pow(double(a[i]) - double(b[i]), 2.0);
        mean += double(b[i]);
    }
    return std::sqrt(square * double(a.size())) / mean;
}

template <class Desc>
Desc exactly(Desc desc) {
    desc.autoResolution = 0.0f;
    desc.interleave = 1;
    return desc;
}
template <class Desc>
Desc halved(Desc desc) {
    desc.autoResolution = 0.0f;
    desc.resolution = LW_RESOLUTION_HALF;
    return desc;
}

template <class Desc>
void checkTowardsExact(LWDevice device, Desc desc, const LWGeometry* geometry = nullptr) {
    const LitFloor floor(64, spotProfile);
    const Sticks scene;
    Desc fixed = desc;
    fixed.autoResolution = 0.0f;
    const std::vector<float> exact = render(device, exactly(desc), floor, scene, geometry).light;
    const double full = rootMeanSquare(render(device, fixed, floor, scene, geometry).light, exact);
    const std::vector<float> halfLight = render(device, halved(desc), floor, scene, geometry).light;
    const double half = rootMeanSquare(halfLight, exact);
    const Result found = render(device, desc, floor, scene, geometry);
    const double own = rootMeanSquare(found.light, exact);
    CAPTURE(full, half, own, found.repaired, found.unrepaired);
    CHECK(found.repaired > 0);
    CHECK(found.repaired <= (kWidth * kHeight + 31) / 32);
    CHECK(own < half);
    // The same light as half resolution's, or that of all VPLs.
    std::size_t others = 0, neither = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const bool isHalf = found.light[i] == halfLight[i];
        others += !isHalf;
        neither += !isHalf && std::abs(double(found.light[i]) - double(exact[i])) > kRounding * (1.0 + double(exact[i]));
    }
    CHECK(neither == 0);
    CHECK(others <= 3 * found.repaired);
}

}  // namespace

TEST_CASE("auto_resolution: pixels have half resolution's light or all VPLs', and the picture is nearer to these", "[auto_resolution]") {
    TestDevice device(GENERATE(1u, 16u));
    checkTowardsExact(device, rsmDesc(0.3f));
}

TEST_CASE("auto_resolution with visibility of maps, and of lost pixels alone", "[auto_resolution]") {
    TestDevice device(16);
    checkTowardsExact(device, rsmDesc(3.0f));
    checkTowardsExact(device, ssvpDesc(0.3f));
    Walls room = Walls::room();
    checkTowardsExact(device, carefulDesc(0.3f), room.describe());
}

TEST_CASE("auto_resolution with visibility of voxels", "[auto_resolution][long]") {
    TestDevice device(16);
    LWRsmDesc voxels = rsmDesc(0.3f);
    voxels.visibility = LW_RSM_VISIBILITY_VOXEL;
    voxels.voxels = 32;
    checkTowardsExact(device, voxels);
}

TEST_CASE("auto_resolution 0 is the fixed resolution; same bits in every run and at every width", "[auto_resolution]") {
    TestDevice wide(16), scalar(1);
    const LitFloor floor(64, spotProfile);
    const Sticks scene;
    LWRsmDesc plain;
    lwDefaultRsm(&plain);
    CHECK(render(wide, rsmDesc(0.0f), floor, scene).light == render(wide, plain, floor, scene).light);
    const Result first = render(wide, rsmDesc(0.3f), floor, scene);
    for (int run = 0; run < 2; ++run) CHECK(render(wide, rsmDesc(0.3f), floor, scene).light == first.light);
    const Result narrow = render(scalar, rsmDesc(0.3f), floor, scene);
    CHECK(narrow.light == first.light);
    CHECK(narrow.repaired == first.repaired);
}

TEST_CASE("auto_resolution: memory as estimated, nothing compiled late, wrong settings refused", "[auto_resolution]") {
    TestDevice device(16);
    const LitFloor floor(64, spotProfile);
    const Sticks scene;
    LWViewDesc viewDesc{};
    viewDesc.structSize = sizeof viewDesc;
    viewDesc.maxWidth = kWidth;
    viewDesc.maxHeight = kHeight;
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.lightCount = 1;
    frame.lights = &floor.light;
    const auto check = [&](const char* name, const void* desc) {
        CAPTURE(name);
        TestView view(device, kWidth, kHeight);
        TestTechnique technique(device, name, desc);
        REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
        const LWDeviceInfo before = device.info();
        technique.update(frame);
        technique.render(view, scene.gbuffer);
        CHECK(device.info().programsBuilt == before.programsBuilt);
        CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
        std::uint64_t estimate = 0;
        REQUIRE(lwEstimateFrameMemory(device, name, desc, &viewDesc, &frame, &estimate) == LW_SUCCESS);
        CHECK(technique.stats().deviceBytes <= estimate);
    };
    const LWRsmDesc rsm = rsmDesc(0.3f);
    LWSsvpDesc ssvp = ssvpDesc(0.3f);
    check("rsm", &rsm);
    check("ssvp", &ssvp);
    Walls room = Walls::room();
    frame.geometry = room.describe();
    const LWSsvpDesc careful = carefulDesc(0.3f);
    check("ssvp", &careful);
    LWTechnique none = nullptr;
    const LWRsmDesc negative = rsmDesc(-1.0f);
    CHECK(lwCreateRsm(device, &negative, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("auto_resolution") != std::string::npos);
    ssvp.compensation = 8;
    CHECK(lwCreateSsvp(device, &ssvp, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("autoResolution") != std::string::npos);
}
