// Areas of static VPLs by the nearest other one: all pairs in double precision.
#include "passes/light_list.h"
#include "passes/static_vpl_light.h"
#include "passes/static_vpl_weights.h"
#include "support/static_vpl_pass_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

std::vector<double> allPairs(const StaticScene& scene) {
    std::vector<double> areas;
    for (std::size_t i = 0; i < scene.vpls.size(); ++i) {
        double nearest = 1e30;
        for (std::size_t j = 0; j < scene.vpls.size(); ++j)
            if (j != i)
                nearest = std::min(
                    nearest, glm::length(vec(scene.vpls[i].position) - vec(scene.vpls[j].position)));
        areas.push_back(kRigPi * nearest * nearest / 4.0);
    }
    return areas;
}

}  // namespace

TEST_CASE("areas are those of all pairs, a block of places a frame", "[static_vpl_weights]") {
    KernelRig rig(GENERATE(1u, 16u));
    constexpr std::size_t kCount = 37;
    PassScene scene(kCount);
    for (LWStaticVpl& vpl : scene.vpls) vpl.weight = 0.0f;
    StaticVplInput input;
    StaticVplWeights weights(rig.device(), 1);
    const auto step = [&] {
        import(rig, input, scene);
        weights.reserve(kCount, input.anyAutomatic());
        weights.record(rig.executor(), input.memory(), input.frame());
        return contents<float>(rig, weights.areas(), kCount);
    };
    const auto agree = [&](const std::vector<float>& areas, std::size_t first, std::size_t end,
                           const std::vector<double>& expected) {
        for (std::size_t i = first; i < end; ++i) {
            CAPTURE(i);
            CHECK(double(areas[i]) == Approx(expected[i]).epsilon(1e-5));
        }
    };
    // New places are done at once.
    const auto before = allPairs(scene);
    agree(step(), 0, kCount, before);
    REQUIRE(weights.cycle() == 3);
    // Moved ones block by block: sixteen a frame, exact after a round.
    scene.vpls = roomOfPlaces(kCount, 6, glm::dvec3(4, 3, 5), 0.0);
    const auto after = allPairs(scene);
    auto areas = step();
    agree(areas, 0, 16, after);
    agree(areas, 16, kCount, before);
    areas = step();
    agree(areas, 0, 32, after);
    agree(areas, 32, kCount, before);
    agree(step(), 0, kCount, after);
    // What is forgotten is done at once again.
    scene.vpls = roomOfPlaces(kCount, 7, glm::dvec3(4, 3, 5), 0.0);
    weights.forget();
    agree(step(), 0, kCount, allPairs(scene));
}

TEST_CASE("a place that is alone stands for nothing", "[static_vpl_weights]") {
    KernelRig rig(GENERATE(1u, 16u));
    PassScene scene(1);
    scene.vpls[0].weight = 0.0f;
    StaticVplInput input;
    import(rig, input, scene);
    StaticVplWeights weights(rig.device(), 1);
    weights.reserve(1, true);
    weights.record(rig.executor(), input.memory(), input.frame());
    CHECK(contents<float>(rig, weights.areas(), 1)[0] == 0.0f);
}

TEST_CASE("what memory holds behind the last place is nobody's area", "[static_vpl_weights]") {
    KernelRig rig(GENERATE(1u, 16u));
    constexpr std::size_t kCount = 21;  // not a whole number of lanes
    StaticScene scene;
    scene.vpls = roomOfPlaces(kCount, 5);
    scene.lights = {pointLight({2, 1.5, 2.5}, {10, 12, 14})};
    StaticVplInput input;
    input.import(rig.executor(), scene.frame(), 1.0f, true, {});
    StaticVplWeights weights(rig.device(), 1);
    weights.reserve(kCount, true);
    rig.executor().fill("test.poison", weights.areas(), 0x7fc00000u, 0, weights.areas().bytes());  // no numbers
    weights.record(rig.executor(), input.memory(), input.frame());
    StaticVplLight light(rig.device());
    light.record(rig.executor(), input.memory(), input.frame(), weights.areas());
    LightList list(rig.device(), {});
    list.reserve(kCount, 0, 1);
    list.recordCull(rig.executor(), input.memory(), input.frame(), light.lit(), true);
    CHECK(contents<cl_int>(rig, input.memory(), LW_FRAME_WORDS)[LW_FRAME_KEPT] == int(kCount));
}
