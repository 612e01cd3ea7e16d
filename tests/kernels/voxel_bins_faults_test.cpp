// A driver that fails at any call of the voxel grid's lists of surfels: the next record's lists hold every surfel once.
#include "passes/voxel_grid_bins.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <exception>
#include <numeric>
#include <vector>

#include "shared/grid_types.h"
#include "shared/surfel_types.h"
#include "shared/voxel_bins.h"
#include "shared/voxel_grid_types.h"
#include "support/cl_faults.h"
#include "support/kernel_rig.h"

using namespace lightwell;
using namespace lightwell::test;

TEST_CASE("whichever call fails, surfels are counted from nothing in the next record", "[voxel_grid][faults]") {
    constexpr int kSize = 16, kCount = 96, kMostCalls = 200;
    KernelRig rig(16);
    LwGridPlace place{};
    place.origin = {{0.0f, 0.0f, 0.0f, 1.0f}};
    place.cell = {{1.0f, 1.0f, 1.0f, 0.0f}};
    LwVoxelGrid state{};
    state.stale = 1;
    std::vector<float> planes(kCount * LW_SURFEL_EMISSIVE_PLANES);
    for (std::size_t i = 0; i < kCount; ++i) {
        for (std::size_t a = 0; a < 3; ++a) planes[a * kCount + i] = 0.5f + float((5 * a + 7) * i % kSize);
        planes[LW_SURFEL_NORMAL * kCount + i] = 1.0f;
        planes[LW_SURFEL_RADIUS * kCount + i] = 0.3f;
    }
    const Guarded placed = rig.upload(std::vector<LwGridPlace>{place}), stated = rig.upload(std::vector<LwVoxelGrid>{state}),
                  memory = rig.upload(planes);
    SurfelSet set;
    set.count = kCount;
    set.planes.memory = memory.get();
    set.planes.planeStride = set.planes.width = kCount;
    int faults = 0;
    for (int call = 0; call < kMostCalls; ++call) {
        VoxelGridBins bins(rig.device(), kSize);
        bool happened;
        {
            const ClFault fault(call, CL_OUT_OF_RESOURCES);
            try {
                bins.record(rig.executor(), set, placed, stated);
            } catch (const std::exception&) {
            }
            happened = fault.happened();
        }
        rig.device().finish();
        bins.record(rig.executor(), set, placed, stated);
        rig.device().finish();
        cl_int listed = 0;
        bins.begins().download(std::size_t(bin_lists(kSize)) * sizeof listed, sizeof listed, &listed);
        CAPTURE(call, happened);
        REQUIRE(listed == kCount);
        std::vector<cl_int> order(kCount), every(kCount);
        bins.order().download(0, order.size() * sizeof(cl_int), order.data());
        std::iota(every.begin(), every.end(), 0);
        CHECK(std::is_permutation(order.begin(), order.end(), every.begin()));
        if (!happened) break;
        ++faults;
    }
    CHECK(faults > 20);
    CHECK(faults < kMostCalls);
}
