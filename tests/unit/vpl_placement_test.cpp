// Placement of static VPLs: walks through free space, merging by hand, areas of known surfaces; several runs and what
// hands have set stand in vpl_placement_hands_test.cpp.
#include <catch2/catch.hpp>
#include <cmath>

#include "../support/placement_room.h"

using namespace studio;
using glm::vec3;
using test::QuadScene;
using test::fewPaths;
using test::hit;
using test::kCos45;
using test::merging;
using test::room;
using test::same;

TEST_CASE("placement: a walk stays inside, and one outside is refused") {
    const RayScene scene = room().build();
    const auto points = exploreFreeSpace(scene, {0.5f, 0.5f, 0.5f}, 200, 5);
    REQUIRE(points.size() == 200);
    bool seesBothEnds[2] = {};
    for (const vec3& p : points) {
        REQUIRE(glm::all(glm::greaterThan(p, vec3(0.0f))));
        REQUIRE(glm::all(glm::lessThan(p, vec3(2, 1, 1))));
        seesBothEnds[p.x > 1.0f ? 1 : 0] = true;
    }
    CHECK((seesBothEnds[0] && seesBothEnds[1]));
    QuadScene open;
    open.quad(open.material(vec3(0.5f)), {0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1});
    CHECK_THROWS_WITH(exploreFreeSpace(open.build(), {0.5f, 1e4f, 0.5f}, 2, 1), Catch::Contains("sees none"));
}

TEST_CASE("placement: paths go on from the surface that they met") {
    // Under the ceiling's slit a path that began again at its origin would meet the floor below it only.
    const RayScene scene = room().build();
    PathOptions options;
    options.paths = 500;
    options.depth = 3;
    const auto hits = findSurfaces(scene, {{0.5f, 0.5f, 0.5f}}, options);
    REQUIRE(hits.size() == 1500);  // a closed room; no light, so from the point alone
    for (std::size_t i = 0; i + 1 < hits.size(); ++i) {
        if (i % 3 == 2) continue;
        // The next hit lies on the side that this one's normal shows, and elsewhere.
        const vec3 way = hits[i + 1].position - hits[i].position;
        REQUIRE(glm::dot(way, hits[i].normal) > -1e-4f);
        REQUIRE(glm::dot(way, hits[i + 1].normal) < 1e-4f);
        REQUIRE(hits[i + 1].reflectance != hits[i].reflectance);  // flat walls do not see themselves
    }
}

TEST_CASE("placement: hits are merged by distance, normal, reflectance and object, as means by population") {
    std::vector<VplPlace> places;
    REQUIRE(mergeHits({hit({0, 0, 0}), hit({1, 0, 0}, {0, 1, 0}, 0.56f), hit({2, 0, 0}, {0, 1, 0}, 0.53f),
                       hit({0, 0, 0}, {1, 0.9f, 0}), hit({0, 0, 0}, {0, 1, 0}, 0.7f),
                       hit({0, 0, 0}, {0, 1, 0}, 0.5f, 1)},
                      merging(1.8), 10, places));
    REQUIRE(places.size() == 4);
    CHECK(places[0].population == 3);
    CHECK(glm::length(places[0].position - vec3(1, 0, 0)) < 1e-6f);
    CHECK(double(places[0].reflectance.x) == Approx(0.53));
    CHECK(places[1].population == 1);  // 48 degrees off
    CHECK(double(places[2].reflectance.x) == Approx(0.7));
    CHECK(places[3].object == 1);

    // To the nearest, not the first; too many end the work.
    places.clear();
    CHECK(mergeHits({hit({0, 0, 0}), hit({1.5f, 0, 0}), hit({0.9f, 0, 0})}, merging(1.0), 2, places));
    CHECK(places[0].population == 1);
    CHECK(places[1].population == 2);
    places.clear();
    CHECK_FALSE(mergeHits({hit({0, 0, 0}), hit({5, 0, 0}), hit({9, 0, 0})}, merging(1.0), 2, places));
}

TEST_CASE("placement: the places of most hits are kept, and those set by hand") {
    std::vector<VplPlace> places(5);
    const std::uint32_t populations[5] = {3, 9, 0, 9, 1};
    for (std::size_t i = 0; i < 5; ++i) places[i].population = populations[i];
    CHECK(keepHeaviest(5, places) == 0);
    CHECK(keepHeaviest(3, places) == 4);
    REQUIRE(places.size() == 3);
    CHECK(places[0].population == 9);
    CHECK(places[1].population == 0);
    CHECK(places[2].population == 9);
}

TEST_CASE("placement: areas are shared out by the nearest place that sees a surface") {
    // Two places on the floor, at a quarter and a half of its length: bounds at 3/8 of it. The walls belong to none.
    const RayScene scene = room().build();
    std::vector<VplPlace> places = {{{0.5f, 0, 0.5f}, {0, 1, 0}, vec3(0.1f), 0, 1, 0.0},
                                    {{1.0f, 0, 0.5f}, {0, 1, 0}, vec3(0.1f), 0, 1, 0.0}};
    WeighOptions options;
    options.reach = 10.0, options.lift = 0.05, options.leastCosine = kCos45;
    const auto weigh = [&](const RayScene& rays) {
        // A thousand samples on 10 m^2: 0.01 m^2 each, stratified; a deviation of some 0.04 m^2.
        weighPlaces(rays, options, places);
    };
    weigh(scene);
    CHECK(places[0].area == Approx(0.75).margin(0.12));
    CHECK(places[1].area == Approx(1.25).margin(0.12));

    // A wall at 0.75 keeps the first from what lies behind it, and the second from what lies before it; a floor below
    // the floor is hidden.
    QuadScene divided = room();
    divided.quad(divided.material(vec3(0.5f)), {0.6f, 0, 0}, {0.6f, 1, 0}, {0.6f, 1, 1}, {0.6f, 0, 1});
    divided.quad(divided.material(vec3(0.5f)), {0, -0.5f, 0}, {2, -0.5f, 0}, {2, -0.5f, 1}, {0, -0.5f, 1});
    weigh(divided.build());
    CHECK(places[0].area == Approx(0.6).margin(0.12));
    CHECK(places[1].area == Approx(1.4).margin(0.12));
}

TEST_CASE("placement in a closed room: all of its area, all of its walls, by any number of threads") {
    const RayScene scene = room().build();
    PlacementOptions options = fewPaths();
    const Placement placement = placeVpls(scene, options, {});
    CHECK(placement.vpls.vpls.size() <= 60);
    CHECK(placement.vpls.vpls.size() > 30);
    CHECK(placement.report.hits == 6000);
    CHECK(placement.report.lostHits == 0);
    CHECK(placement.report.area == Approx(10.0).epsilon(0.02));
    double area[7] = {};
    for (const StaticVpl& v : placement.vpls.vpls) {
        const auto wall = std::size_t(std::lround(v.reflectance.x * 10.0f));
        REQUIRE(std::abs(v.reflectance.x - 0.1f * float(wall)) < 1e-4f);  // no two walls are mixed
        area[wall] += double(*v.weight);
    }
    for (std::size_t wall = 1; wall <= 6; ++wall) {
        CAPTURE(wall);
        CHECK(area[wall] == Approx(wall <= 4 ? 2.0 : 1.0).epsilon(0.08));
    }
    for (const int threads : {1, 2, 5}) {
        options.threads = threads;
        CHECK(same(placement.vpls, placeVpls(scene, options, {}).vpls));
    }
    options.seed = 2;
    CHECK_FALSE(same(placement.vpls, placeVpls(scene, options, {}).vpls));
}

TEST_CASE("placement in another unit of length is the same placement") {
    QuadScene large = room();
    for (Mesh& mesh : large.scene.meshes)
        for (vec3& p : mesh.positions) p *= 1024.0f;
    PlacementOptions options = fewPaths();
    const Placement one = placeVpls(room().build(), options, {});
    options.from = {{512, 512, 512}};
    const Placement other = placeVpls(large.build(), options, {});
    REQUIRE(one.vpls.vpls.size() == other.vpls.vpls.size());
    for (std::size_t i = 0; i < one.vpls.vpls.size(); ++i) {
        const StaticVpl &a = one.vpls.vpls[i], &b = other.vpls.vpls[i];
        REQUIRE(glm::length(a.position * 1024.0f - b.position) < 0.05f);
        REQUIRE(double(*b.weight) == Approx(double(*a.weight) * 1024.0 * 1024.0).epsilon(1e-3));
    }
}

TEST_CASE("placement: VPLs of moving things stand in their coordinates, set back by the offset") {
    QuadScene s = room();
    Object lid;
    lid.name = "lid";
    lid.keys = {{0.0f, {0.5f, 0.25f, 0.25f}, glm::angleAxis(kPi / 2.0f, vec3(0, 1, 0))}};
    s.scene.objects.push_back(lid);
    s.quad(s.material(vec3(0.9f)), {0, 0, 0}, {0.5f, 0, 0}, {0.5f, 0, 0.5f}, {0, 0, 0.5f});
    s.scene.meshes.back().object = 1;
    const RayScene scene = s.build();
    PlacementOptions options = fewPaths();
    options.offset = 0.0625;
    const Placement placement = placeVpls(scene, options, {});
    int count = 0;
    for (const StaticVpl& v : placement.vpls.vpls) {
        if (v.object.empty()) continue;
        ++count;
        CHECK(v.object == "lid");
        CHECK(double(std::abs(v.position.y)) == Approx(0.0625));  // behind its side, of either
        CHECK(v.position.y * v.normal.y < 0.0f);
        CHECK(v.position.x > 0.0f);
        CHECK(v.position.x < 0.5f);
    }
    CHECK(count >= 2);
    const StaticVpls world = posedVpls(placement.vpls, s.scene, 0.0f);
    for (std::size_t i = 0; i < world.vpls.size(); ++i)
        if (!placement.vpls.vpls[i].object.empty())
            CHECK(double(std::abs(world.vpls[i].position.y - 0.25f)) == Approx(0.0625).epsilon(1e-3));
}

TEST_CASE("without paths of the lights, places are those of a room without lights") {
    auto lit = room();
    lit.point({1.5f, 0.8f, 0.5f}, vec3(1.0f));
    const RayScene withLight = lit.build();
    auto options = fewPaths();
    const StaticVpls dark = placeVpls(room().build(), options, {}).vpls;
    CHECK_FALSE(same(placeVpls(withLight, options, {}).vpls, dark));
    options.lightPaths = 0;
    CHECK(same(placeVpls(withLight, options, {}).vpls, dark));
}

TEST_CASE("placement refuses what it cannot mean") {
    const RayScene scene = room().build();
    const auto refused = [&](const char* option, const auto& spoil) {
        PlacementOptions options = fewPaths();
        spoil(options);
        CHECK_THROWS_WITH(placeVpls(scene, options, {}), Catch::Contains(option) && Catch::Contains("expected"));
    };
    refused("points", [](auto& o) { o.points = 0; });
    refused("paths", [](auto& o) { o.paths = 0; });
    refused("lightPaths", [](auto& o) { o.lightPaths = -1; });
    refused("depth", [](auto& o) { o.depth = 0; });
    refused("cap", [](auto& o) { o.cap = 4097; });
    refused("degrees", [](auto& o) { o.degrees = 90.0; });
    refused("spacing", [](auto& o) { o.spacing = -1.0; });
    refused("offset", [](auto& o) { o.offset = -1.0; });
    refused("spacing", [](auto& o) { o.spacing = 1e30; });
    refused("from", [](auto& o) { o.from[0].y = 1e30f; });
    refused("from", [](auto& o) { o.from[0].y = NAN; });
    // Units in which no float is a place's area: what is written must read back.
    StaticVpls units;
    units.areaPerWeight = 1e38f;
    units.metresPerUnit = 1e4f;
    CHECK_THROWS_WITH(placeVpls(scene, fewPaths(), units), Catch::Contains("area_per_weight: expected"));
    StaticVpls two;
    two.vpls.resize(2);
    PlacementOptions one = fewPaths();
    one.cap = 1;
    CHECK_THROWS_WITH(placeVpls(scene, one, two), Catch::Contains("by hand"));
}
