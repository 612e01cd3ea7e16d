// Flux of static VPLs, planes by place: the serial twin in double precision, for both kinds of
// receivers.
#include "passes/static_vpl_light.h"
#include "passes/static_vpl_weights.h"
#include "support/static_vpl_pass_rig.h"

using namespace lightwell;
using namespace lightwell::test;

TEST_CASE("flux, areas and the strongest are the twin's", "[static_vpl_light]") {
    KernelRig rig(GENERATE(1u, 16u));
    constexpr std::size_t kCount = 37;
    PassScene scene(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
        scene.vpls[i].weight = float(0.1 + 0.01 * double(i));
        scene.vpls[i].receivers = std::uint32_t(i % 3);
        if (i % 4 == 1) scene.vpls[i].lightMask = 2;
    }
    scene.lights[1].mask = 2;
    StaticVplInput input;
    import(rig, input, scene);
    CHECK(input.bakedReceivers());
    StaticVplWeights weights(rig.device(), 1);
    weights.reserve(kCount, input.anyAutomatic());
    StaticVplLight light(rig.device());
    light.record(rig.executor(), input.memory(), input.frame(), weights.areas());
    const std::size_t stride = std::size_t(input.frame().stride);
    const auto lit = contents<float>(rig, light.lit(), stride * LW_LIT_PLANES);
    double strongest = 0.0;
    for (std::size_t i = 0; i < kCount; ++i) {
        CAPTURE(i);
        const LWStaticVpl& vpl = scene.vpls[i];
        const double area = double(vpl.weight);
        CHECK(double(lit[LW_LIT_AREA * stride + i]) == Approx(area).epsilon(1e-6));
        const std::uint32_t mask = vpl.lightMask ? vpl.lightMask : ~0u;
        glm::dvec3 unbaked(0.0), baked(0.0), open(0.0);
        for (const LWLight& one : scene.lights) {
            if (!((one.mask ? one.mask : ~0u) & mask)) continue;
            const glm::dvec3 e = twinIrradiance(scene, vpl, one);
            unbaked += e;
            if (one.receivers != LW_RECEIVERS_UNBAKED) baked += e;
            open += twinIrradiance(scene, vpl, one, false);
        }
        const glm::dvec3 rho = vec(vpl.reflectance);
        for (int c = 0; c < 3; ++c) {
            const std::size_t plane = std::size_t(c);
            const double first = vpl.receivers == LW_RECEIVERS_BAKED ? 0.0 : rho[c] * area * unbaked[c],
                         second = vpl.receivers == LW_RECEIVERS_UNBAKED ? 0.0 : rho[c] * area * baked[c];
            CHECK(double(lit[plane * stride + i]) == Approx(first).epsilon(1e-4).margin(1e-6));
            CHECK(double(lit[(LW_LIT_BAKED + plane) * stride + i]) ==
                  Approx(second).epsilon(1e-4).margin(1e-6));
        }
        strongest = std::max(strongest, area / kRigPi * glm::dot(rho, open) / 3.0);
    }
    const auto words = contents<float>(rig, input.memory(), LW_FRAME_WORDS);
    CHECK(double(words[LW_FRAME_STRONGEST]) == Approx(strongest).epsilon(1e-4));
}
