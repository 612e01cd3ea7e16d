// Lists of static VPLs and of lights, from flux that the test writes: hysteresis by hand, what may not
// be lost by merging, where VPLs look from.
#include "passes/light_list.h"
#include "support/static_vpl_pass_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

// Planes that StaticVplLight would leave: flux of each place for both receivers, and its area.
struct Lit {
    std::size_t stride;
    std::vector<float> planes;
    Lit(const StaticVplInput& input)
        : stride(std::size_t(input.frame().stride)), planes(stride * LW_LIT_PLANES) {}
    void set(std::size_t i, double unbaked, double baked, double area = 0.5) {
        for (std::size_t c = 0; c < 3; ++c) {
            planes[c * stride + i] = float(unbaked * double(c + 1));
            planes[(LW_LIT_BAKED + c) * stride + i] = float(baked * double(c + 1));
        }
        planes[LW_LIT_AREA * stride + i] = float(area);
    }
};

}  // namespace

TEST_CASE("subset slots and indices are each other's inverse", "[light_list]") {
    for (const std::int32_t count : {1, 7, 100, 4097})
        for (const std::int32_t subsets : {1, 4, 16, 64}) {
            lw_subset_order order{subsets, 2, (count + 2 * subsets - 1) / (2 * subsets) * 2, count};
            for (std::int32_t k = 0; k < count; ++k)
                REQUIRE(lw_subset_index(order, lw_subset_slot(order, k)) == k);
        }
}

TEST_CASE("a VPL goes below the threshold and comes back above twice of it", "[light_list]") {
    KernelRig rig(16);
    PassScene scene(1);
    StaticVplInput input;
    LightListOptions options;
    options.relative = false;
    options.threshold = 1.0f;
    LightList list(rig.device(), options);
    bool restart = true;
    const auto isKept = [&](double intensity) {
        import(rig, input, scene);
        Lit lit(input);
        lit.set(0, intensity * kRigPi / 2.0, 0.0);  // the mean over the channels is twice the first's
        const Guarded memory = rig.upload(lit.planes);
        list.reserve(1, 0, 1);
        list.recordCull(rig.executor(), input.memory(), input.frame(), memory, restart);
        restart = false;
        const auto kept = contents<std::uint32_t>(rig, input.memory(), LW_FRAME_WORDS)[LW_FRAME_KEPT];
        CHECK((fluxOf(contents<lw_vpl>(rig, list.vpls(), 1)[0]) > 0.0) == (kept == 1));
        return kept == 1;
    };
    CHECK(isKept(1.5));  // in a first frame the lower one holds
    CHECK(isKept(1.01));
    CHECK_FALSE(isKept(0.99));
    CHECK_FALSE(isKept(1.5));
    CHECK_FALSE(isKept(1.98));
    CHECK(isKept(2.02));
    CHECK(isKept(1.5));
    CHECK_FALSE(isKept(0.0));
    restart = true;
    CHECK(isKept(1.5));
}

TEST_CASE("merging keeps flux, area and their middle", "[light_list]") {
    KernelRig rig(GENERATE(1u, 16u));
    constexpr std::size_t kCount = 29;
    PassScene scene(kCount);
    StaticVplInput input;
    import(rig, input, scene);
    Lit lit(input);
    for (std::size_t i = 0; i < kCount; ++i)
        lit.set(i, i % 5 ? 1.0 + double(i) : 0.0, i % 7 ? double(i) : 0.0, 0.1 * double(i));
    const Guarded memory = rig.upload(lit.planes);
    LightListOptions options;
    options.threshold = 0.0f;
    options.relative = false;
    options.subsets = 4;
    options.lights = 4;
    LightList list(rig.device(), options);
    list.reserve(kCount, 0, 2);
    list.recordCull(rig.executor(), input.memory(), input.frame(), memory, true);
    for (int frame = 0; frame < 3; ++frame) {
        list.recordLights(rig.executor(), input.diagonal());
        double flux = 0.0, baked = 0.0, area = 0.0;
        std::uint32_t members = 0;
        glm::dvec3 middle(0.0);
        for (std::size_t i = 1; i < kCount; ++i) {
            const double first = i % 5 ? 6.0 * (1.0 + double(i)) : 0.0,
                         second = i % 7 ? 6.0 * double(i) : 0.0;
            flux += first;
            baked += second;
            area += 0.1 * double(i);
            middle += (first + second) * vec(scene.vpls[i].position);
            ++members;
        }
        const auto lights = contents<lw_listed_light>(rig, list.listed(), 4);
        for (std::size_t m = 0; m < 4; ++m) {
            const lw_listed_light& light = lights[m];
            CHECK(light.id == m);
            const double first = double(light.flux[0]) + double(light.flux[1]) + double(light.flux[2]),
                         second = double(light.bakedFluxCone.s[0]) + double(light.bakedFluxCone.s[1]) +
                                  double(light.bakedFluxCone.s[2]);
            flux -= first;
            baked -= second;
            area -= double(light.positionArea.s[3]);
            middle -= (first + second) * vec(light.positionArea);
            members -= light.vpls;
            // As an even spot light of 170 degrees it sends the same.
            CHECK(double(light.spotIntensity.s[0]) * 2.0 * kRigPi *
                      (1.0 - std::cos(85.0 / 180.0 * kRigPi)) ==
                  Approx(double(light.flux[0])).epsilon(1e-5));
        }
        CHECK(flux == Approx(0.0).margin(1e-2));
        CHECK(baked == Approx(0.0).margin(1e-2));
        CHECK(area == Approx(0.0).margin(1e-3));
        CHECK(members == 0);
        for (int c = 0; c < 3; ++c) CHECK(middle[c] == Approx(0.0).margin(5e-2));
    }
}

TEST_CASE("VPLs look from above their surfaces, wherever they have flux", "[light_list]") {
    KernelRig rig(GENERATE(1u, 16u));
    PassScene scene(5);
    StaticVplInput input;
    import(rig, input, scene);
    Lit lit(input);
    lit.set(0, 1.0, 1.0, kRigPi);
    lit.set(1, 1.0, 0.0, 4.0 * kRigPi);
    lit.set(2, 0.0, 1.0, kRigPi);
    lit.set(3, 0.0, 0.0, kRigPi);
    lit.set(4, 1.0, 1.0, kRigPi);
    const Guarded memory = rig.upload(lit.planes);
    LightListOptions options;
    options.threshold = 0.0f;
    LightList list(rig.device(), options);
    list.reserve(5, 0, 2);
    list.recordCull(rig.executor(), input.memory(), input.frame(), memory, true);
    const Guarded sites = rig.make<lw_vpl>(4);  // the last one is not asked for
    list.recordSites(rig.executor(), 4, 0.25f, sites);
    rig.device().finish();
    const auto looks = rig.download<lw_vpl>(sites);
    const double raised[4] = {0.25, 0.5, 0.25, 0.0};
    for (std::size_t i = 0; i < 4; ++i) {
        CAPTURE(i);
        CHECK((fluxOf(looks[i]) > 0.0) == (i != 3));
        if (i == 3) continue;
        const glm::dvec3 expected = vec(scene.vpls[i].position) + raised[i] * vec(scene.vpls[i].normal);
        for (int a = 0; a < 3; ++a)
            CHECK(double(looks[i].positionArea.s[a]) == Approx(expected[a]).epsilon(1e-5).margin(1e-6));
    }
}
