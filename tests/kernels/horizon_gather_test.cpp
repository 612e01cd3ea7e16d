// The horizon gather against a serial twin in double precision, which works with angles and an integral where the kernel has
// polynomials and shuffles, at widths 1 and 16.
#include "passes/horizon_gather.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "inputs/camera.h"
#include "passes/weighted_filter.h"
#include "reference/horizon_twin.h"
#include "support/kernel_rig.h"
#include "support/packed_light.h"
#include "support/sphere_corner.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

// Sums of up to 40 slices in float, the segment's polynomial (6e-6) and the approximate root (5e-6).
constexpr double kTwinTolerance = 5e-4;
// Of all values: a border that rounding moves by one sector changes a pixel's slice by 1/32 of it.
constexpr double kTwinShare = 0.06;
constexpr double kTwinMean = 2e-4;

struct Case {
    HorizonPatternOptions pattern;
    HorizonRanges ranges;
    bool light, uniform, orthographic;
    std::uint32_t turn = 0;
};

std::vector<float> gathered(KernelRig& rig, DrawnView& drawn, const Case& c, std::vector<float>* twin) {
    const std::uint32_t w = drawn.position.width(), h = drawn.position.height();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Guarded p = rig.uploadPlanes(drawn.position.packed(), w, h, 3, nan), n = rig.uploadPlanes(drawn.normal.packed(), w, h, 3, nan);
    const Guarded l = rig.uploadPlanes(drawn.radiance.packed(), w, h, 3, nan), m = rig.uploadPlanes(drawn.receiveMask.packed(), w, h, 1, nan);
    const Guarded counts = rig.upload(std::vector<cl_int>{0, 0});
    const Camera camera(drawn.gbuffer.camera, w, h, "camera");
    const double reach = 0.8 * h;
    PyramidOptions options;
    options.extras = c.light ? kPyramidRadiance : 0u;
    options.firstLevel = 0;
    options.sampled = true;
    options.lastLevel = horizonLevels(c.pattern.density, reach) - 1;
    PyramidLevels levels(rig.device(), w, h, options);
    MipPyramid(rig.device(), options.extras)
        .record(rig.executor(), rig.planes(p, w, h, 3), rig.planes(n, w, h, 3), c.light ? rig.planes(l, w, h, 3) : Planes{},
                rig.planes(m, w, h, 1), camera, levels, counts);
    HorizonTables tables;
    tables.prepare(rig.executor(), c.pattern, reach, 1.0, levels);
    const std::uint32_t planes = WeightedFilter::planes(c.light);
    const Guarded out = rig.makePlanes(w, h, planes);
    HorizonGather(rig.device(), {c.pattern, c.light, c.uniform})
        .recordGather(rig.executor(), levels, h, camera, c.ranges, tables, c.turn, rig.planes(out, w, h, planes));
    rig.device().finish();
    if (twin) {
        std::vector<reference::HorizonLevel> read;
        for (std::uint32_t k = 0; k <= options.lastLevel; ++k) {
            const Planes level = levels.level(k);
            read.push_back({level.width, level.height, rig.downloadPlanes(level)});
        }
        *twin = reference::horizonGather(read, horizonPattern(c.pattern, reach, 1.0), camera, c.ranges, c.pattern, h, c.light, c.uniform, c.turn);
    }
    return rig.downloadPlanes(rig.planes(out, w, h, planes));
}

}  // namespace

TEST_CASE("the gather equals its serial twin", "[horizon_gather]") {
    const auto width = GENERATE(1u, 16u);
    const auto size = testSize(GENERATE(std::make_pair(1u, 1u), std::make_pair(67u, 45u)));
    const Case c = GENERATE(Case{{8, 2, 4}, {0.1, 0.2}, true, false, false}, Case{{16, 4, 1}, {0.0, 1.0}, true, false, true},
                            Case{{4, 1, 2}, {0.5, 0.1}, false, true, false}, Case{{8, 2, 1}, {0.1, 0.5}, false, false, false},
                            Case{{16, 2, 8}, {0.1, 0.2}, true, false, false, 13});
    CAPTURE(width, size.first, c.pattern.directions, c.light, c.uniform, c.orthographic);
    KernelRig rig(width);
    DrawnView drawn(sphereCorner(), cornerCamera(c.orthographic), size.first, size.second);
    std::vector<float> twin;
    const std::vector<float> out = gathered(rig, drawn, c, &twin);
    CHECK(disagreement(out, twin, kTwinTolerance, kTwinShare) == "");
    CHECK(std::abs(meanOf(out) - meanOf(twin)) <= kTwinMean * meanOf(twin));
}

TEST_CASE("the gather has the same bits at every width", "[horizon_gather][large]") {
    DrawnView drawn(sphereCorner(), cornerCamera(false), 83, 41);
    const Case c{{8, 2, 4}, {0.1, 0.2}, true, false, false};
    KernelRig scalar(1);
    const auto first = gathered(scalar, drawn, c, nullptr);
    for (const std::uint32_t width : {4u, 8u, 16u}) {
        KernelRig rig(width);
        CHECK(bitDifference(gathered(rig, drawn, c, nullptr), first) == "");
    }
}

TEST_CASE("every slice's share of the hemisphere sums to one", "[horizon_gather][large]") {
    KernelRig rig(16);
    DrawnView drawn(sphereCorner(), cornerCamera(false), 64, 48);
    for (const bool uniform : {false, true}) {
        const auto out = gathered(rig, drawn, {{40, 1, 1}, {0.1, 0.2}, false, uniform, false}, nullptr);
        for (std::uint32_t i = 0; i < 64 * 48; ++i)
            if (drawn.normal.get(i % 64, i / 64).y != 0.0 || drawn.normal.get(i % 64, i / 64).z != 0.0 || drawn.normal.get(i % 64, i / 64).x != 0.0)
                REQUIRE(double(out[64 * 48 + i]) == Approx(1.0).margin(0.02));  // 40 slices of unequal angle
    }
}
