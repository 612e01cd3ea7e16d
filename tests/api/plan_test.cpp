// lwPlan and lwListPlans: what they pick can be run; bad arguments are named; nothing else changes.
#include <catch2/catch.hpp>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <thread>

#include "api/api_rig.h"
#include "lightwell/lightwell.hpp"

using namespace lightwell::test;
using Catch::Matchers::Contains;

namespace {

LWPlanDesc budget(float milliseconds, float error = 0.0f) {
    auto desc = lightwell::make<LWPlanDesc>();
    desc.budgetMs = milliseconds;
    desc.errorTarget = error;
    return desc;
}

struct PlanRig : Rig {
    explicit PlanRig(ApiScene& from) : Rig(from), scene(from) {}
    LWPlan plan(const LWPlanDesc& desc) {
        auto plan = lightwell::make<LWPlan>();
        CHECK(lwPlan(view, &scene.frame, &scene.gbuffer, &desc, &plan) == LW_SUCCESS);
        CHECK(lastError(device) == "");
        return plan;
    }
    std::string refuse(LWStatus status, const LWFrame* frame, const LWGBuffer* gbuffer, const LWPlanDesc* desc) {
        LWPlan plan = lightwell::make<LWPlan>(), before = plan;
        CHECK(lwPlan(view, frame, gbuffer, desc, &plan) == status);
        CHECK(std::memcmp(&plan, &before, sizeof plan) == 0);
        return lastError(device);
    }
    std::string refuse(const LWPlanDesc& desc) { return refuse(LW_ERROR_INVALID_ARGUMENT, &scene.frame, &scene.gbuffer, &desc); }
    ApiScene& scene;
};

}  // namespace

TEST_CASE("a plan can be run, and says what it rests on", "[api]") {
    ApiScene scene;
    PlanRig rig(scene);
    const LWPlan plan = rig.plan(budget(0.0f));
    CHECK((plan.withinBudget == 1 && plan.reachesError == 1));
    CHECK((plan.predictedMs > 0.0f && plan.predictedError > 0.0f && plan.confidence > 0.0f && plan.confidence <= 1.0f));
    CHECK_THAT(plan.reason, Contains(plan.technique) && Contains("least predicted error") && Contains("not given"));
    LWTechnique technique = nullptr;
    REQUIRE(lwCreateTechniqueFromText(rig.device, plan.technique, plan.parameters, &technique) == LW_SUCCESS);
    CHECK(lwUpdate(technique, &scene.frame) == LW_SUCCESS);
    CHECK(lwRender(technique, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    CHECK(lwFinish(rig.device) == LW_SUCCESS);
    lwReleaseTechnique(technique);
    // A floor seen from above; the light comes from a floor below it, so that all of it faces the pixels.
    CHECK(plan.probes.facing == 1.0f);
    CHECK(std::isnan(plan.probes.albedo));
    CHECK(std::isnan(plan.probes.indirectShare));
    CHECK(plan.probes.fluxConcentration < 0.01f);

    // A tiny budget: the quickest, and the truth about it.
    const LWPlan tight = rig.plan(budget(1e-6f));
    CHECK(tight.withinBudget == 0);
    CHECK_THAT(tight.reason, Contains("quickest"));
    const LWPlan loose = rig.plan(budget(1e-6f, 1e6f));
    CHECK(loose.reachesError == 1);
    CHECK(rig.plan(budget(0.0f, 1e-30f)).reachesError == 0);
    // Of what is nearly as quick as the quickest, the most accurate.
    const LWPlan quickest = rig.plan(budget(0.0f, 1e30f));
    CHECK((quickest.predictedMs <= tight.predictedMs && tight.predictedMs <= 1.15f * quickest.predictedMs));
    CHECK(tight.predictedError <= quickest.predictedError);
    LWPlanDesc stereo = budget(0.0f, 1e30f);
    stereo.views = 2;
    CHECK(rig.plan(stereo).predictedMs >= quickest.predictedMs);
}

TEST_CASE("a plan for frames at rest counts on what is kept, of a host that tells versions", "[api]") {
    ApiScene scene;
    PlanRig rig(scene);
    LWPlanDesc desc = budget(0.0f);
    const auto list = [&] {
        std::vector<LWPlan> plans(200, lightwell::make<LWPlan>());
        std::uint32_t count = 0;
        REQUIRE(lwListPlans(rig.view, &scene.frame, &scene.gbuffer, &desc, plans.data(), std::uint32_t(plans.size()), &count) == LW_SUCCESS);
        REQUIRE(count <= plans.size());
        plans.resize(count);
        return plans;
    };
    const std::vector<LWPlan> usual = list();
    LWLight light = scene.frame.lights[0];
    std::vector<LWRsm> maps(light.rsms, light.rsms + light.rsmCount);
    for (LWRsm& map : maps) map.version = 3;
    light.rsms = maps.data();
    scene.frame.lights = &light;
    desc.atRest = 1;
    int less = 0;
    for (const LWPlan& each : list()) {
        const auto same = std::find_if(usual.begin(), usual.end(), [&](const LWPlan& other) {
            return std::string(other.technique) == each.technique && std::string(other.parameters) == each.parameters;
        });
        REQUIRE(same != usual.end());
        CHECK(each.predictedMs <= same->predictedMs);
        CHECK(each.predictedError == same->predictedError);
        less += each.predictedMs < same->predictedMs;
    }
    CHECK(less > 0);
    // A host that was built before `atRest`.
    desc.structSize = 16;
    CHECK(list().front().predictedMs == usual.front().predictedMs);
    desc.structSize = sizeof desc;
    LWVpl vpl{};
    vpl.normal[1] = 1.0f;
    scene.frame.vpls = &vpl;
    scene.frame.vplCount = 1;
    CHECK_THAT(rig.refuse(desc), Contains("frame.vplCount") && Contains("atRest"));
}

TEST_CASE("all plans are listed, quickest first", "[api]") {
    ApiScene scene;
    PlanRig rig(scene);
    const LWPlanDesc desc = budget(20.0f, 0.2f);
    std::uint32_t count = 0;
    REQUIRE(lwListPlans(rig.view, &scene.frame, &scene.gbuffer, &desc, nullptr, 0, &count) == LW_SUCCESS);
    REQUIRE(count > 1);
    std::vector<LWPlan> plans(count + 1, lightwell::make<LWPlan>());
    std::memset(plans[count].technique, 'x', 4);
    std::uint32_t again = 0;
    REQUIRE(lwListPlans(rig.view, &scene.frame, &scene.gbuffer, &desc, plans.data(), count + 1, &again) == LW_SUCCESS);
    CHECK(again == count);
    CHECK(plans[count].technique[0] == 'x');
    for (std::uint32_t i = 0; i < count; ++i) {
        CHECK((i == 0 || plans[i - 1].predictedMs <= plans[i].predictedMs));
        CHECK(plans[i].withinBudget == (plans[i].predictedMs <= 20.0f ? 1u : 0u));
        CHECK(plans[i].reachesError == (plans[i].predictedError <= 0.2f ? 1u : 0u));
        CHECK(plans[i].reason[0] == 0);
        CHECK(plans[i].structSize == sizeof(LWPlan));
    }
    const LWPlan chosen = rig.plan(desc);
    CHECK(std::any_of(plans.begin(), plans.begin() + count, [&](const LWPlan& each) {
        return std::string(each.technique) == chosen.technique && std::string(each.parameters) == chosen.parameters &&
               each.predictedMs == chosen.predictedMs && each.predictedError == chosen.predictedError;
    }));
    CHECK(lwListPlans(rig.view, &scene.frame, &scene.gbuffer, &desc, plans.data(), 1, nullptr) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lwListPlans(rig.view, &scene.frame, &scene.gbuffer, &desc, nullptr, 1, &again) == LW_ERROR_INVALID_ARGUMENT);
    plans[1].structSize = 3;
    CHECK(lwListPlans(rig.view, &scene.frame, &scene.gbuffer, &desc, plans.data(), 2, &again) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(rig.device), Contains("lwListPlans"));
}

TEST_CASE("a plan's arguments are checked, and named", "[api]") {
    ApiScene scene;
    PlanRig rig(scene);
    constexpr LWStatus kInvalid = LW_ERROR_INVALID_ARGUMENT;
    const LWPlanDesc good = budget(16.0f);
    CHECK_THAT(rig.refuse(budget(-1.0f)), Contains("budgetMs") && Contains("-1"));
    CHECK_THAT(rig.refuse(budget(std::nanf(""))), Contains("budgetMs"));
    CHECK_THAT(rig.refuse(budget(std::numeric_limits<float>::infinity())), Contains("budgetMs"));
    CHECK_THAT(rig.refuse(budget(1.0f, -0.5f)), Contains("errorTarget") && Contains("-0.5"));
    CHECK_THAT(rig.refuse(budget(1.0f, std::nanf(""))), Contains("errorTarget"));
    LWPlanDesc bad = good;
    bad.views = 65;
    CHECK_THAT(rig.refuse(bad), Contains("views") && Contains("65"));
    bad = good;
    bad.atRest = 2;
    CHECK_THAT(rig.refuse(bad), Contains("atRest") && Contains("2"));
    bad.atRest = 1;
    CHECK_THAT(rig.refuse(bad), Contains("frame.lights[0].rsms[0].version") && Contains("atRest"));
    bad = good;
    bad.structSize = 4;
    CHECK_THAT(rig.refuse(bad), Contains("desc.structSize"));
    CHECK_THAT(rig.refuse(kInvalid, nullptr, &scene.gbuffer, &good), Contains("frame") && Contains("null"));
    CHECK_THAT(rig.refuse(kInvalid, &scene.frame, nullptr, &good), Contains("gbuffer") && Contains("null"));
    CHECK_THAT(rig.refuse(kInvalid, &scene.frame, &scene.gbuffer, nullptr), Contains("desc") && Contains("null"));
    LWPlan plan = lightwell::make<LWPlan>();
    CHECK(lwPlan(rig.view, &scene.frame, &scene.gbuffer, &good, nullptr) == kInvalid);
    CHECK_THAT(lastError(rig.device), Contains("lwPlan") && Contains("plan") && Contains("null"));
    plan.structSize = 12;
    CHECK(lwPlan(rig.view, &scene.frame, &scene.gbuffer, &good, &plan) == kInvalid);
    CHECK_THAT(lastError(rig.device), Contains("plan.structSize"));
    CHECK(lwPlan(nullptr, &scene.frame, &scene.gbuffer, &good, &plan) == LW_ERROR_INVALID_HANDLE);
    CHECK(lwPlan(reinterpret_cast<LWView>(rig.technique), &scene.frame, &scene.gbuffer, &good, &plan) == LW_ERROR_INVALID_HANDLE);
    lastError();
}

TEST_CASE("frames and G-buffers that lwRender would refuse are refused, and what nothing can light", "[api]") {
    ApiScene scene;
    PlanRig rig(scene);
    constexpr LWStatus kInvalid = LW_ERROR_INVALID_ARGUMENT;
    const LWPlanDesc good = budget(16.0f);
    LWGBuffer gbuffer = scene.gbuffer;
    gbuffer.normal.width -= 1;
    CHECK_THAT(rig.refuse(kInvalid, &scene.frame, &gbuffer, &good), Contains("gbuffer.normal"));
    gbuffer = scene.gbuffer;
    gbuffer.position.host = nullptr;
    CHECK_THAT(rig.refuse(kInvalid, &scene.frame, &gbuffer, &good), Contains("position"));
    gbuffer = scene.gbuffer;
    gbuffer.albedo = gbuffer.normal;
    gbuffer.albedo.height = 3;
    CHECK_THAT(rig.refuse(kInvalid, &scene.frame, &gbuffer, &good), Contains("gbuffer.albedo"));
    gbuffer = scene.gbuffer;
    std::fill(std::begin(gbuffer.camera.view), std::end(gbuffer.camera.view), 1.0f);
    CHECK_THAT(rig.refuse(kInvalid, &scene.frame, &gbuffer, &good), Contains("gbuffer.camera"));
    gbuffer.camera.view[3] = std::nanf("");
    CHECK_THAT(rig.refuse(kInvalid, &scene.frame, &gbuffer, &good), Contains("gbuffer.camera"));
    LWFrame frame = scene.frame;
    frame.lightCount = 0;
    gbuffer = scene.gbuffer;
    gbuffer.camera = LWCamera{};
    CHECK_THAT(rig.refuse(kInvalid, &frame, &gbuffer, &good), Contains("expected what a technique can make light of") && Contains("RSMs"));
    frame.lights = nullptr;
    frame.lightCount = 3;
    CHECK_THAT(rig.refuse(kInvalid, &frame, &scene.gbuffer, &good), Contains("frame.lights"));
}

TEST_CASE("planning changes nothing", "[api]") {
    ApiScene scene;
    PlanRig rig(scene);
    rig.frame(scene);
    rig.plan(budget(16.0f));  // whatever is made once
    const auto light = [&] {
        std::vector<float> values;
        for (std::uint32_t y = 0; y < scene.irradiance.height(); ++y)
            for (std::uint32_t x = 0; x < scene.irradiance.width(); ++x) values.push_back(scene.irradiance.get<float>(x, y, 0, 0));
        return values;
    };
    const auto before = light();
    const LWDeviceInfo info = rig.info();
    const LWPlan first = rig.plan(budget(16.0f));
    REQUIRE(lwUpdate(rig.technique, &scene.frame) == LW_SUCCESS);
    const LWPlan second = rig.plan(budget(16.0f));
    REQUIRE(lwRender(rig.technique, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    REQUIRE(lwFinish(rig.device) == LW_SUCCESS);
    CHECK(light() == before);
    CHECK(std::string(first.technique) == second.technique);
    CHECK(first.probes.facing == second.probes.facing);
    const LWDeviceInfo after = rig.info();
    CHECK(after.allocatedBytes == info.allocatedBytes);
    CHECK(after.kernelsSpecialised == info.kernelsSpecialised);
    CHECK(after.programsBuilt == info.programsBuilt);
    CHECK(rig.stats().frameIndex == 12345);
}

TEST_CASE("planning and rendering from several threads", "[api]") {
    ApiScene scene;
    PlanRig rig(scene);
    std::vector<std::thread> threads;
    std::vector<LWStatus> results(3, LW_SUCCESS);
    for (std::size_t t = 0; t < results.size(); ++t)
        threads.emplace_back([&, t] {
            const LWPlanDesc desc = budget(16.0f);
            for (int i = 0; i < 10 && results[t] == LW_SUCCESS; ++i) {
                auto plan = lightwell::make<LWPlan>();
                results[t] = t == 0 ? lwUpdate(rig.technique, &scene.frame) : lwPlan(rig.view, &scene.frame, &scene.gbuffer, &desc, &plan);
            }
        });
    for (std::thread& thread : threads) thread.join();
    for (const LWStatus result : results) CHECK(result == LW_SUCCESS);
    CHECK(lwFinish(rig.device) == LW_SUCCESS);
}

TEST_CASE("lightwell.hpp plans", "[api]") {
    ApiScene scene;
    auto desc = lightwell::Device::defaults();
    desc.width = 16;
    const lightwell::Device device(desc);
    const lightwell::View view(device, 24, 10);
    const LWPlan plan = lightwell::plan(view, scene.frame, scene.gbuffer, budget(0.0f));
    const auto all = lightwell::listPlans(view, scene.frame, scene.gbuffer, budget(0.0f));
    CHECK(std::any_of(all.begin(), all.end(), [&](const LWPlan& each) { return each.predictedError == plan.predictedError; }));
    CHECK_NOTHROW(lightwell::Technique::fromText(device, plan.technique, plan.parameters));
    CHECK_THROWS_WITH(lightwell::plan(view, scene.frame, scene.gbuffer, budget(-1.0f)), Contains("budgetMs"));
}
