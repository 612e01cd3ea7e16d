// lwRenderPoints of long lists, its memory, nothing compiled after lwPrewarm, and two techniques joined.
#include <algorithm>
#include <catch2/catch.hpp>
#include <utility>
#include <vector>

#include "support/points_makers.h"
#include "support/points_rig.h"

using namespace lightwell::test;

namespace {

constexpr std::uint32_t kWidth = 33, kHeight = 32;

double evenProfile(double, double) { return 1.0; }

struct Room : PointRoom {
    Room() : PointRoom(32, evenProfile, kWidth, kHeight) {}
};

}  // namespace

TEST_CASE("a million points: the same bits as a few, memory as documented, kept for fewer", "[points]") {
    TestDevice device(16);
    const Room room;
    LWRsmDesc desc = rsmDesc();
    desc.vpls = 16;
    TestTechnique technique(device, desc);
    technique.update(room.frame);
    const PointList few = PointList::ofScene(room.scene);
    const PointLights expected = renderPoints(device, technique, few);
    constexpr std::uint32_t kMany = 1000003;
    const std::uint64_t before = technique.stats().deviceBytes;
    PointList many;
    many.positions.resize(3 * kMany);
    many.normals.resize(3 * kMany);
    for (std::size_t i = 0; i < 3 * kMany; ++i) {
        many.positions[i] = few.positions[i % few.positions.size()];
        many.normals[i] = few.normals[i % few.normals.size()];
    }
    const PointLights got = renderPoints(device, technique, many);
    bool same = true;
    for (std::size_t i = 0; i < kMany; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            same = same && got.irradiance[3 * i + c] == expected.irradiance[3 * (i % few.count()) + c];
            same = same && got.band(3, i, c) == expected.band(3, i % few.count(), c);
        }
    CHECK(same);
    // docs/points.md: 88 bytes a point unpacked, beside what a technique needs for itself.
    const std::uint64_t held = technique.stats().deviceBytes - before;
    const std::uint64_t uploads = device.info().hostUnifiedMemory ? 0 : (12 + 12 + 12 + 48 + 4) * std::uint64_t(kMany);
    CHECK(held <= 89 * std::uint64_t(kMany) + uploads);
    CHECK(held > 80 * std::uint64_t(kMany));
    renderPoints(device, technique, few.part(0, 1001));  // rows that are whole lines of memory are copied with their padding
    CHECK(technique.stats().deviceBytes - before == held);
}

TEST_CASE("the longest list there may be", "[points]") {
    TestDevice device(16);
    const Room room;
    LWLpvDesc desc = lpvDesc(LW_LPV_TRANSPORT_PROPAGATE);
    desc.steps = 1;
    TestTechnique technique(device, "lpv", &desc);
    technique.update(room.frame);
    constexpr std::uint32_t kMost = 4194240;  // lightwell.h
    std::vector<float> positions(3 * kMost), validity(kMost, -1.0f);
    for (std::size_t i = 0; i < kMost; ++i) positions[3 * i + 1] = positions[3 * i + 2] = 0.5f;
    positions[3 * kMost - 1] = 50.0f;
    const LWImage places = listImage(positions, kMost, 1, LW_FORMAT_FLOAT3);
    LWPointOutput output{};
    output.structSize = sizeof output;
    output.validity = listImage(validity, kMost, 1, LW_FORMAT_FLOAT1);
    REQUIRE(lwRenderPoints(technique, &places, nullptr, kMost, &output) == LW_SUCCESS);
    REQUIRE(lwFinish(device) == LW_SUCCESS);
    CHECK(std::count(validity.begin(), validity.end(), 1.0f) == kMost - 1);
    CHECK(validity.back() == 0.0f);
    CHECK(technique.count("points") == kMost);
    CHECK(technique.count("points_outside") == 1);
}

TEST_CASE("nothing is compiled at points after lwPrewarm", "[points]") {
    TestDevice device(16);
    const Room room;
    const LWRsmDesc rsm = rsmDesc();
    LWSsvpDesc ssvp;
    lwDefaultSsvp(&ssvp);
    ssvp.occluders = LW_OCCLUDERS_TRIANGLES;
    LWLpvDesc step = lpvDesc(LW_LPV_TRANSPORT_PROPAGATE), sweep = lpvDesc(LW_LPV_TRANSPORT_SWEEP);
    step.steps = 4;
    LWLpvDesc pyramid = lpvDesc(LW_LPV_TRANSPORT_COARSE_TO_FINE), nested = step, nestedSweep = sweep;
    nested.cascades = nestedSweep.cascades = 2;
    TestTechnique first(device, "lpv", &step), second(device, rsm);
    LWFallbackDesc joined;
    lwDefaultFallback(&joined);
    joined.first = first;
    joined.second = second;
    for (const auto& [name, desc] :
         {std::pair<const char*, const void*>{"rsm", &rsm}, {"ssvp", &ssvp}, {"lpv", &step}, {"lpv", &sweep}, {"lpv", &pyramid}, {"lpv", &nested}, {"lpv", &nestedSweep},
          {"fallback", &joined}}) {
        CAPTURE(name);
        TestTechnique technique(device, name, desc);
        TestView view(device, kWidth, kHeight);
        REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
        const LWDeviceInfo before = device.info();
        technique.update(room.frame);
        for (const std::size_t number : {1u, 300u, 1000u}) {
            const PointList list = PointList::ofScene(room.scene).part(0, number);
            renderPoints(device, technique, list);
            renderPoints(device, technique, list, kPointHarmonics | kPointValidity, false);
            renderPoints(device, technique, list, kPointValidity);
        }
        CHECK(device.info().programsBuilt == before.programsBuilt);
        CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
    }
}

TEST_CASE("two techniques joined at points: the grid's light within it, the other's elsewhere", "[points]") {
    TestDevice device(GENERATE(1u, 16u));
    const Room room;
    const LWLpvDesc grid = lpvDesc(LW_LPV_TRANSPORT_SWEEP, 1.0);  // holds a part of the room
    TestTechnique lpv(device, "lpv", &grid), rsm(device, rsmDesc());
    LWFallbackDesc desc;
    lwDefaultFallback(&desc);
    desc.first = lpv;
    desc.second = rsm;
    TestTechnique both(device, "fallback", &desc), lpvAlone(device, "lpv", &grid), rsmAlone(device, rsmDesc());
    for (TestTechnique* technique : {&both, &lpvAlone, &rsmAlone}) technique->update(room.frame);
    const PointList list = PointList::ofScene(room.scene);
    const PointLights sum = renderPoints(device, both, list), first = renderPoints(device, lpvAlone, list), second = renderPoints(device, rsmAlone, list);
    CHECK(renderPoints(device, both, list, kPointHarmonics, false).harmonics.size() == sum.harmonics.size());
    std::size_t within = 0, beyond = 0;
    for (std::size_t i = 0; i < list.count(); ++i) {
        const PointLights& expected = first.validity[i] > 0.0f ? first : second;
        (first.validity[i] > 0.0f ? within : beyond) += second.validity[i] > 0.0f ? 1 : 0;
        CHECK(sum.e(i) == expected.e(i));
        for (std::size_t b = 0; b < 4; ++b) CHECK(sum.band(b, i) == expected.band(b, i));
        CHECK(sum.validity[i] == second.validity[i]);
    }
    CHECK(within > 100);
    CHECK(beyond > 100);
    CHECK(both.count("first.points") > 0);
    CHECK(both.count("saturated_points") == 0);
}
