// Placement of static VPLs onto those that are there: runs accumulate, and hands are kept.
#include <catch2/catch.hpp>

#include "../support/placement_room.h"

using namespace studio;
using glm::vec3;
using test::fewPaths;
using test::hit;
using test::merging;
using test::QuadScene;
using test::room;

TEST_CASE("placement: runs accumulate, and what a hand has set stays") {
    const RayScene scene = room().build();
    PlacementOptions options = fewPaths();
    options.spacing = 0.4;
    StaticVpls earlier;
    earlier.metresPerUnit = 0.01f;
    earlier.areaPerWeight = 100.0f;  // cm^2
    StaticVpl byHand;
    byHand.position = {100, 0, 50};  // the middle of the floor
    byHand.reflectance = vec3(0.1f);
    byHand.weight = 7.0f;
    byHand.name = "mine";
    earlier.vpls.push_back(byHand);
    earlier.blockers.push_back({{1, 2, 3}, 4.0f, "ball", ""});
    const Placement first = placeVpls(scene, options, earlier);
    CHECK(first.report.byHand == 1);
    options.seed = 2;
    const Placement second = placeVpls(scene, options, first.vpls);
    for (const StaticVpls* all : {&first.vpls, &second.vpls}) {
        CHECK(all->blockers.size() == 1);
        REQUIRE(all->vpls[0].name == "mine");
        CHECK(all->vpls[0].weight == 7.0f);
        CHECK(all->vpls[0].position == byHand.position);
        CHECK(all->vpls[0].population == 0);
        double area = 0.0;
        std::uint32_t population = 0;
        for (std::size_t i = 1; i < all->vpls.size(); ++i) {
            const StaticVpl& v = all->vpls[i];
            area += double(*v.weight) * 100.0 * 1e-4;
            population += v.population;
            // Within its spacing of the hand's VPL no other one stands on the floor.
            if (v.reflectance.x < 0.15f) CHECK(glm::length(v.position - byHand.position) > 30.0f);
        }
        CHECK(area > 9.0);
        CHECK(area < 10.0);  // the floor around the hand's VPL is its
        CHECK(population > (all == &first.vpls ? 5000u : 10000u));
    }
    CHECK(second.report.earlier == first.vpls.vpls.size());
}

TEST_CASE(
    "placement: a population of any number stays one, and a hand's VPL of a thing at rest takes hits "
    "up") {
    std::vector<VplPlace> places = {{{0, 0, 0}, {0, 1, 0}, vec3(0.5f), 0, ~0u, 0.0},
                                    {{5, 0, 0}, {0, 1, 0}, vec3(0.5f), 0, 0, 0.0}};
    mergeHits({hit({0.1f, 0, 0}), hit({0, 0, 0.1f})}, merging(0.5), 4, places);
    REQUIRE(places.size() == 2);
    CHECK(places[0].population >= ~0u - 1);
    CHECK(glm::length(places[0].position) < 1e-6f);
    keepHeaviest(1, places);
    CHECK(places[0].population == 0);

    QuadScene s = room();
    Object table;
    table.name = "table";
    s.scene.objects.push_back(table);
    s.quad(s.material(vec3(0.9f)), {0.5f, 0.3f, 0.25f}, {1.0f, 0.3f, 0.25f}, {1.0f, 0.3f, 0.75f},
           {0.5f, 0.3f, 0.75f});
    s.scene.meshes.back().object = 1;
    const RayScene scene = s.build();
    StaticVpls earlier;
    StaticVpl byHand;
    byHand.position = {0.75f, 0.3f, 0.5f};
    byHand.reflectance = vec3(0.9f);
    byHand.weight = 0.25f;
    byHand.object = "table";
    earlier.vpls.push_back(byHand);
    PlacementOptions options = fewPaths();
    options.spacing = 0.6;
    for (const StaticVpl& v : placeVpls(scene, options, earlier).vpls.vpls)
        if (v.population > 0 && v.reflectance.x > 0.8f)
            CHECK(v.normal.y < 0.0f);  // none beside the hand's
}
