// A driver that fails at any call of lwPlan: it is told, nothing is left behind, and the next plan is the right one.
#include <catch2/catch.hpp>
#include <cstring>
#include <string>

#include "api/api_rig.h"
#include "support/cl_faults.h"

using namespace lightwell::test;

namespace {

constexpr int kMostCalls = 400;

bool isDriverError(LWStatus status) {
    return status == LW_ERROR_OUT_OF_MEMORY || status == LW_ERROR_DEVICE || status == LW_ERROR_INTERNAL;
}

}  // namespace

TEST_CASE("a plan survives a failure of any of its OpenCL calls", "[api]") {
    ApiScene scene;
    ApiRig rig(makeDevice(16, [](void*, LWLogLevel, const char*) {}), scene);
    LWPlanDesc desc{};
    desc.structSize = sizeof desc;
    desc.budgetMs = 16.0f;
    LWPlan before{}, plan{};
    before.structSize = plan.structSize = sizeof plan;
    REQUIRE(lwPlan(rig.view, &scene.frame, &scene.gbuffer, &desc, &before) == LW_SUCCESS);
    rig.frame(scene);
    const std::uint64_t bytes = rig.info().allocatedBytes;
    const cl_int code = GENERATE(CL_OUT_OF_RESOURCES, CL_MEM_OBJECT_ALLOCATION_FAILURE);
    int failing = 0;
    for (bool happened = true; happened && failing < kMostCalls; ++failing) {
        LWStatus status = LW_SUCCESS;
        {
            const ClFault fault(failing, code);
            status = lwPlan(rig.view, &scene.frame, &scene.gbuffer, &desc, &plan);
            happened = fault.happened();
            INFO("call " << failing << ", " << fault.function());
            CHECK((happened ? isDriverError(status) : status == LW_SUCCESS));
        }
        if (status != LW_SUCCESS) CHECK(lastError(rig.device).find("lwPlan") != std::string::npos);
        CHECK(rig.info().allocatedBytes == bytes);
        REQUIRE(lwPlan(rig.view, &scene.frame, &scene.gbuffer, &desc, &plan) == LW_SUCCESS);
        CHECK(std::memcmp(&plan.probes, &before.probes, sizeof plan.probes) == 0);
        CHECK(std::string(plan.technique) == before.technique);
    }
    CHECK(failing > 20);
    CHECK(failing < kMostCalls);
    rig.frame(scene);
    CHECK(scene.lit());
}
