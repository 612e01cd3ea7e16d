// Phantom VPLs and those of the second bounce: inverse squares over all places in double precision, and
// conservation of flux.
#include "passes/phantom_vpl.h"
#include "passes/static_vpl_light.h"
#include "passes/static_vpl_weights.h"
#include "support/static_vpl_pass_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr std::size_t kCount = 21;
constexpr float kHit[3] = {2.0f, 0.0f, 2.0f};
constexpr double kEps = 0.01, kDistance = 2.0, kReflectance = 0.5;

struct Made {
    std::vector<lw_vpl> vpls;                              // places, phantom, its opposite, theirs
    glm::dvec3 placesFlux{0.0}, middle{0.0}, normal{0.0};  // sums by flux of the places
};

Made make(std::uint32_t width, const PassScene& scene, float secondArea) {
    KernelRig rig(width);
    const std::uint32_t count = std::uint32_t(scene.vpls.size());
    lw_phantom phantom{};
    phantom.light = 1;
    phantom.hit = {{kHit[0], kHit[1], kHit[2], 1.0f}};
    StaticVplInput input;
    import(rig, input, scene, {phantom});
    StaticVplWeights weights(rig.device(), 1);
    weights.reserve(count, input.anyAutomatic());
    StaticVplLight light(rig.device());
    light.record(rig.executor(), input.memory(), input.frame(), weights.areas());
    LightListOptions options;
    options.threshold = 0.0f;
    LightList list(rig.device(), options);
    list.reserve(count, PhantomVpl::others(1, true), 1);
    list.recordCull(rig.executor(), input.memory(), input.frame(), light.lit(), true);
    lw_phantom_options look{};
    look.eps = float(kEps);
    look.reflectance = float(kReflectance);
    look.distance = float(kDistance);
    look.area = secondArea;
    look.opposite = 1;
    look.lists = 1;
    PhantomVpl phantoms(rig.device());
    phantoms.record(rig.executor(), input.memory(), input.frame(), light.lit(), {}, look, list);
    Made made;
    made.vpls = contents<lw_vpl>(rig, list.vpls(), count + 3);
    for (std::size_t i = 0; i < count; ++i) {
        const lw_vpl& vpl = made.vpls[i];
        made.placesFlux += vec(vpl.flux);
        made.middle += fluxOf(vpl) * vec(vpl.positionArea);
        made.normal += fluxOf(vpl) * vec(vpl.normal);
    }
    return made;
}

// Of places that all face up and down, so that they have a mean normal.
void near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-4) {
    for (int c = 0; c < 3; ++c) CHECK(a[c] == Approx(b[c]).epsilon(tolerance).margin(1e-5));
}

}  // namespace

TEST_CASE("a phantom is the places around its hit, by inverse squares", "[phantom_vpl]") {
    PassScene scene(kCount);
    for (std::size_t i = 0; i < kCount; ++i) scene.vpls[i].weight = float(0.2 + 0.02 * double(i));
    const Made made = make(GENERATE(1u, 16u), scene, 0.0f);
    double sum = 0.0, area = 0.0;
    glm::dvec3 normal(0.0), rho(0.0), x(2.0, 0.0, 2.0);
    for (const LWStaticVpl& vpl : scene.vpls) {
        const glm::dvec3 d = vec(vpl.position) - x;
        const double b = 1.0 / (kEps + glm::dot(d, d));
        sum += b;
        area += b * double(vpl.weight);
        normal += b * vec(vpl.normal);
        rho += b * vec(vpl.reflectance);
    }
    area /= sum;
    rho /= sum;
    normal = glm::normalize(normal);
    const lw_vpl& phantom = made.vpls[kCount];
    near(vec(phantom.positionArea), x);
    near(vec(phantom.normal), normal);
    CHECK(double(phantom.positionArea.s[3]) == Approx(area).epsilon(1e-4));
    // 20 W/sr two metres above, on its axis.
    near(vec(phantom.flux), rho * area * (20.0 / 4.0 * normal.y));
    // Half of its flux comes back from 1.5 times as far, towards the hit.
    const lw_vpl& back = made.vpls[kCount + 1];
    near(vec(back.flux), kReflectance * vec(phantom.flux));
    near(vec(back.positionArea), {2.0, 3.0, 2.0});
    near(vec(back.normal), {0.0, -1.0, 0.0});
    CHECK(double(back.positionArea.s[3]) == Approx(kRigPi * 9.0).epsilon(1e-4));
}

TEST_CASE("what lies opposite the places gets their flux, however they are split", "[phantom_vpl]") {
    const std::uint32_t width = GENERATE(1u, 16u);
    PassScene scene(kCount);
    for (LWStaticVpl& vpl : scene.vpls) vpl.weight = 0.3f;
    const double caught = GENERATE(1.0, 0.25);
    const float area = caught < 1.0 ? float(caught * kRigPi * kDistance * kDistance) : 0.0f;
    const Made made = make(width, scene, area);
    const lw_vpl& back = made.vpls[kCount + 2];
    const double flux = made.placesFlux.x + made.placesFlux.y + made.placesFlux.z;
    const glm::dvec3 normal = glm::normalize(made.normal);
    near(vec(back.flux), kReflectance * caught * made.placesFlux);
    near(vec(back.positionArea), made.middle / flux + kDistance * normal);
    near(vec(back.normal), -normal);
    // Each place as two of half its area.
    PassScene split(kCount);
    split.vpls.insert(split.vpls.end(), scene.vpls.begin(), scene.vpls.end());
    for (std::size_t i = 0; i < split.vpls.size(); ++i)
        (split.vpls[i] = scene.vpls[i % kCount]).weight = 0.15f;
    const Made halves = make(width, split, area);
    near(vec(halves.vpls[2 * kCount + 2].flux), vec(back.flux));
    near(vec(halves.vpls[2 * kCount + 2].positionArea), vec(back.positionArea));
}
