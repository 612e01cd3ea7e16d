// The passes of technique static_vpl one after the other on a small scene, with a canary behind what
// they write to: flux, areas, lists, phantoms, second bounce and the lights of them all. (Their oracles
// stand in tests/techniques.)
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "inputs/static_vpl_input.h"
#include "passes/light_list.h"
#include "passes/phantom_vpl.h"
#include "passes/static_vpl_light.h"
#include "passes/static_vpl_weights.h"
#include "shared/vpl_types.h"
#include "support/kernel_rig.h"
#include "support/static_vpl_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

template <class T>
std::vector<T> contents(KernelRig& rig, const Buffer& buffer, std::size_t count) {
    rig.device().finish();
    std::vector<T> values(count);
    buffer.download(0, count * sizeof(T), values.data());
    return values;
}

float fluxOf(const lw_vpl& vpl) {
    return vpl.flux.s[0] + vpl.flux.s[1] + vpl.flux.s[2];
}

}  // namespace

TEST_CASE("subset slots and indices are each other's inverse", "[static_vpl]") {
    for (const std::int32_t count : {1, 7, 100, 4097})
        for (const std::int32_t subsets : {1, 4, 16, 64}) {
            lw_subset_order order{subsets, 2, (count + 2 * subsets - 1) / (2 * subsets) * 2, count};
            for (std::int32_t k = 0; k < count; ++k)
                REQUIRE(lw_subset_index(order, lw_subset_slot(order, k)) == k);
        }
}

TEST_CASE("a frame of static VPLs through all passes", "[static_vpl]") {
    KernelRig rig(GENERATE(1u, 16u));
    StaticScene scene;
    scene.vpls = roomOfPlaces(21, 5);
    for (std::size_t i = 0; i < 21; i += 2) scene.vpls[i].weight = 0.0f;
    const float profile[4] = {1.0f, 0.5f, 0.7f, 0.0f}, hit[3] = {2.0f, 0.0f, 2.0f};
    scene.lights = {pointLight({2, 1.5, 2.5}, {10, 12, 14}),
                    spotLight({2, 2, 2}, {0, -1, 0}, {20, 20, 20}, 0.2, 0.4),
                    sunLight({0.1, -1, 0.2}, {1, 1, 1})};
    scene.lights[0].profile = profile;
    scene.lights[0].profileCount = 4;
    put(scene.lights[0].direction, {0, -1, 0});
    scene.lights[1].hit = hit;
    scene.lights[2].receivers = LW_RECEIVERS_UNBAKED;
    scene.block({1, 1, 1}, 0.8);
    const LWFrame frame = scene.frame();

    Executor& executor = rig.executor();
    lw_phantom phantom{};
    phantom.light = 1;
    phantom.hit = {{2.0f, 0.0f, 2.0f, 1.0f}};
    StaticVplInput input;
    input.import(executor, frame, 1.0f, false, {phantom});
    CHECK(input.anyAutomatic());
    CHECK(input.bakedReceivers());
    StaticVplWeights weights(rig.device(), 1);
    weights.reserve(21, true);
    CHECK(weights.cycle() == 2);
    weights.record(executor, input.memory(), input.frame());
    StaticVplLight light(rig.device());
    light.record(executor, input.memory(), input.frame(), weights.areas());
    const auto lit =
        contents<float>(rig, light.lit(), std::size_t(input.frame().stride) * LW_LIT_PLANES);

    LightListOptions options;
    options.lights = 4;
    options.subsets = 4;
    LightList list(rig.device(), options);
    list.reserve(21, PhantomVpl::others(1, true), 2);
    list.recordCull(executor, input.memory(), input.frame(), light.lit(), true);
    PhantomVpl phantoms(rig.device());
    lw_phantom_options look{};
    look.eps = 0.01f;
    look.reflectance = 0.5f;
    look.distance = 2.0f;
    look.opposite = 1;
    phantoms.record(executor, input.memory(), input.frame(), light.lit(), {}, look, list);
    const lw_subset_order order = list.order();
    const auto vpls =
        contents<lw_vpl>(rig, list.vpls(), std::size_t(order.subsets) * std::size_t(order.capacity));
    const auto baked = contents<lw_vpl>(rig, list.baked(), vpls.size());

    double sum = 0.0, bakedSum = 0.0;
    std::uint32_t members = 0;
    for (std::int32_t k = 0; k < order.count; ++k) {
        const std::size_t slot = std::size_t(lw_subset_slot(order, k));
        sum += double(fluxOf(vpls[slot]));
        bakedSum += double(fluxOf(baked[slot]));
        members += fluxOf(vpls[slot]) > 0.0f || fluxOf(baked[slot]) > 0.0f ? 1 : 0;
        if (k < 21 && fluxOf(vpls[slot]) > 0.0f) {
            CHECK(vpls[slot].flux.s[1] == lit[std::size_t(input.frame().stride) + std::size_t(k)]);
            CHECK(vpls[slot].positionArea.s[3] ==
                  lit[std::size_t(LW_LIT_AREA * input.frame().stride) + std::size_t(k)]);
        }
    }
    CHECK(sum > bakedSum);
    CHECK(fluxOf(vpls[std::size_t(lw_subset_slot(order, 21))]) > 0.0f);  // the phantom
    CHECK(fluxOf(vpls[std::size_t(lw_subset_slot(order, 22))]) ==
          Approx(0.5 * double(fluxOf(vpls[std::size_t(lw_subset_slot(order, 21))]))));

    list.recordLights(executor, input.diagonal());
    const auto listed = contents<lw_listed_light>(rig, list.listed(), 4);
    double listedSum = 0.0, listedBaked = 0.0;
    std::uint32_t listedMembers = 0;
    for (const lw_listed_light& one : listed) {
        listedSum += double(one.flux[0] + one.flux[1] + one.flux[2]);
        listedBaked += double(one.bakedFluxCone.s[0] + one.bakedFluxCone.s[1] + one.bakedFluxCone.s[2]);
        listedMembers += one.vpls;
    }
    CHECK(listedSum == Approx(sum).epsilon(1e-5));
    CHECK(listedBaked == Approx(bakedSum).epsilon(1e-5));
    CHECK(listedMembers == members);
}

TEST_CASE("what memory holds behind the last place is nobody's area", "[static_vpl]") {
    KernelRig rig(GENERATE(1u, 16u));
    Executor& executor = rig.executor();
    StaticScene scene;
    scene.vpls = roomOfPlaces(21, 5);
    scene.lights = {pointLight({2, 1.5, 2.5}, {10, 12, 14})};
    StaticVplInput input;
    input.import(executor, scene.frame(), 1.0f, true, {});
    StaticVplWeights weights(rig.device(), 1);
    weights.reserve(21, true);
    executor.fill("test.poison", weights.areas(), 0x7fc00000u, 0, weights.areas().bytes());  // no numbers
    weights.record(executor, input.memory(), input.frame());
    StaticVplLight light(rig.device());
    light.record(executor, input.memory(), input.frame(), weights.areas());
    LightList list(rig.device(), {});
    list.reserve(21, 0, 1);
    list.recordCull(executor, input.memory(), input.frame(), light.lit(), true);
    const auto words = contents<cl_int>(rig, input.memory(), LW_FRAME_WORDS);
    CHECK(words[LW_FRAME_KEPT] == 21);
}
