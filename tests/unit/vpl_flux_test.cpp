// Placed VPLs stand for their surfaces: what a lamp's light makes them send is what the surfaces send.
#include <catch2/catch.hpp>

#include "instant_radiosity.h"
#include "vpl_placement.h"

namespace {

using namespace studio;

// Reflected flux of placed VPLs with their own irradiance, over that of 65,536 photons; greens.
double fluxOverTruth(const RayScene& scene, int cap, std::uint64_t seed) {
    PlacementOptions options;
    options.cap = cap;
    options.seed = seed;
    for (const Light& light : scene.lights()) options.from.push_back(light.position);
    double truth = 0.0, sum = 0.0;
    for (const VplRecord& v : tracePhotons(scene, 65536, 0)) truth += double(v.flux.y);
    for (const StaticVpl& v : placeVpls(scene, options, {}).vpls.vpls)
        sum += double(v.reflectance.y * scene.directIrradiance(v.position, v.normal, v.normal).y * *v.weight);
    return sum / truth;
}

}  // namespace

TEST_CASE("placement: the reflected flux of Cornell's box, nearer to the truth the more VPLs there are") {
    const RayScene scene(std::make_shared<Scene>(loadScene("cornell")), 0.0f);
    // VPLs sample the lamp's beam: some ten of 32 lie in it, some 90 of 205, some 860 of 1,900.
    for (const std::uint64_t seed : {1u, 2u}) {
        CAPTURE(seed);
        CHECK(fluxOverTruth(scene, 32, seed) == Approx(1.0).margin(0.25));
        CHECK(fluxOverTruth(scene, 256, seed) == Approx(1.0).margin(0.12));
        CHECK(fluxOverTruth(scene, 2048, seed) == Approx(1.0).margin(0.02));
    }
}
