// Technique ssvp with careful look-ups: strict ones, to the bit, wherever there is no bounce without shadows to be held against two or more
// with them; no more memory anywhere; and what a lid keeps in of four bounces.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "support/lit_room.h"
#include "support/packed_light.h"
#include "support/scoped_api.h"
#include "support/small_ssvp.h"
#include "support/walls.h"

using namespace lightwell::test;

namespace {

constexpr std::uint32_t kWidth = 48, kHeight = 32;

double tiledProfile(double x, double z) { return (int(std::floor(x * 5.0)) + int(std::floor(z * 5.0))) % 2 != 0 ? 0.2 : 0.8; }

// A room lit from its floor, with walls that the caller adds.
struct Rig {
    TestDevice device{16};
    LitFloor floor{64, tiledProfile};
    WallAndCeiling scene{kWidth, kHeight};
    Walls room = Walls::room();
    std::vector<LWLight> lights{floor.light};
    LWFrame frame{};

    struct Result {
        std::vector<float> light;
        std::uint64_t bytes = 0, estimate = 0;
    };
    Result render(const LWSsvpDesc& desc) {
        frame.structSize = sizeof frame;
        frame.lightCount = 1;
        frame.lights = lights.data();
        frame.geometry = room.describe();
        TestTechnique technique(device, desc);
        TestView view(device, kWidth, kHeight);
        LWViewDesc viewDesc{};
        viewDesc.structSize = sizeof viewDesc;
        viewDesc.maxWidth = kWidth;
        viewDesc.maxHeight = kHeight;
        technique.update(frame);
        Result result;
        result.light = technique.render(view, scene.gbuffer);
        result.bytes = technique.stats().deviceBytes;
        REQUIRE(lwEstimateFrameMemory(device, "ssvp", &desc, &viewDesc, &frame, &result.estimate) == LW_SUCCESS);
        return result;
    }
};

}  // namespace

TEST_CASE("careful look-ups are strict ones, but for bounces without shadows after two or more with them", "[ssvp][careful]") {
    Rig rig;
    rig.room.add({-0.2, 0.3, 0.2}, {0.4, 0, 0}, {0, 0, 0.4});  // rims, and so doubt
    struct Case {
        std::uint32_t bounces, shadowed;
        bool isStrict;
    };
    // Each pixel for itself; by the filter, also at half resolution; with pixels gathered by themselves.
    struct Gather {
        std::uint32_t interleave;
        LWResolution resolution;
        float autoResolution;
    };
    const Gather gather = GENERATE(Gather{1, LW_RESOLUTION_FULL, 0.0f}, Gather{4, LW_RESOLUTION_FULL, 0.0f},
                                   Gather{4, LW_RESOLUTION_HALF, 0.0f}, Gather{4, LW_RESOLUTION_FULL, 0.3f});
    for (const Case& c : {Case{1, 1, true}, Case{1, 4, true}, Case{2, 1, true}, Case{2, 2, true}, Case{4, 1, true}, Case{4, 4, true}, Case{3, 2, false},
                          Case{4, 3, false}}) {
        LWSsvpDesc desc = smallSsvp(LW_VISIBILITY_HARD, c.bounces, c.shadowed);
        desc.interleave = gather.interleave;
        desc.resolution = gather.resolution;
        desc.autoResolution = gather.autoResolution;
        CAPTURE(c.bounces, c.shadowed, gather.interleave, int(gather.resolution), gather.autoResolution);
        const Rig::Result hard = rig.render(desc);
        desc.visibility = LW_VISIBILITY_STRICT;
        const Rig::Result strict = rig.render(desc);
        desc.visibility = LW_VISIBILITY_CAREFUL;
        const Rig::Result careful = rig.render(desc);
        CHECK(strict.light != hard.light);
        CHECK((careful.light == strict.light) == c.isStrict);
        CHECK(careful.bytes == strict.bytes);
        CHECK(careful.estimate == strict.estimate);
        CHECK(careful.bytes <= careful.estimate);
    }
}

TEST_CASE("careful look-ups: with four bounces, two of them shadowed, an open room blocks nothing, a lid all that is shadowed and three quarters of the rest", "[ssvp][careful]") {
    Rig open, closed;
    closed.room.add({-0.6, 0.05, -0.1}, {1.2, 0, 0}, {0, 0, 1.2});
    LWSsvpDesc desc = smallSsvp(LW_VISIBILITY_CAREFUL, 4, 2);
    desc.clusters = GENERATE(1u, 8u, 0u);
    LWSsvpDesc hard = desc;
    hard.visibility = LW_VISIBILITY_HARD;
    const double lit = meanOf(open.render(desc).light), all = meanOf(open.render(hard).light), dark = meanOf(closed.render(desc).light),
                 leak = meanOf(closed.render(hard).light);
    CAPTURE(desc.clusters, lit, all, dark, leak);
    CHECK(lit > 0.95 * all);
    // Of the two bounces that nothing shadows a quarter.
    CHECK(dark < 0.25 * leak + 0.005 * lit);
    CHECK(dark > 0.2 * leak);
    CHECK(leak > 0.02 * all);
}
