// Technique static_vpl: automatic weights, phantom VPLs, second bounces.
#include <catch2/catch.hpp>

#include "support/camera_matrices.h"
#include "support/static_vpl_rig.h"
#include "support/view_scene.h"

using namespace lightwell::test;

namespace {

constexpr double kRounding = 2e-6;

// Areas by the distance to the nearest other place, all pairs.
std::vector<double> bruteAreas(const std::vector<LWStaticVpl>& vpls) {
    std::vector<double> areas;
    for (std::size_t i = 0; i < vpls.size(); ++i) {
        double least = HUGE_VAL;
        for (std::size_t j = 0; j < vpls.size(); ++j) {
            const glm::dvec3 d = vec(vpls[i].position) - vec(vpls[j].position);
            if (j != i) least = std::min(least, glm::dot(d, d));
        }
        areas.push_back(vpls.size() > 1 ? kRigPi / 4.0 * least : 0.0);
    }
    return areas;
}

void checkAreas(const std::vector<double>& got, const std::vector<double>& expected) {
    REQUIRE(got.size() == expected.size());
    for (std::size_t i = 0; i < got.size(); ++i) {
        CAPTURE(i);
        CHECK(got[i] == Approx(expected[i]).epsilon(kRounding));
    }
}

LWLight torch(const glm::dvec3& position, const glm::dvec3& direction) {
    return spotLight(position, direction, {20, 20, 20}, 0.2, 0.4);
}

LWStaticVplDesc phantomDesc() {
    LWStaticVplDesc desc = staticDesc();
    desc.variant = LW_STATIC_VPL_PHANTOM;
    return desc;
}

}  // namespace

TEST_CASE("automatic weights equal all pairs after a round at rest, and at once for new places",
          "[static_vpl]") {
    LWStaticVplDesc desc = staticDesc();
    desc.automaticWeights = 1;
    desc.comparisons = 1;  // 16 places a frame: a round of 7 for 100
    StaticRig rig(GENERATE(1u, 16u), desc);
    StaticScene scene;
    scene.vpls = roomOfPlaces(100, 3);
    rig.update(scene);
    checkAreas(rig.areas(), bruteAreas(scene.vpls));
    // All move in the middle of a round: whatever the frame, one round at rest later all are exact.
    for (int frame = 0; frame < 3; ++frame) rig.update(scene);
    const std::vector<double> before = bruteAreas(scene.vpls);
    scene.vpls = roomOfPlaces(100, 4);
    const std::vector<double> after = bruteAreas(scene.vpls);
    for (int frame = 0; frame < 7; ++frame) {
        rig.update(scene);
        const std::vector<double> areas = rig.areas();
        for (std::size_t i = 0; i < areas.size(); ++i)
            CHECK((areas[i] == Approx(before[i]).epsilon(kRounding) ||
                   areas[i] == Approx(after[i]).epsilon(kRounding)));
    }
    checkAreas(rig.areas(), after);
    // One frame is enough where nothing is known.
    scene.vpls = roomOfPlaces(33, 5);
    rig.update(scene);
    checkAreas(rig.areas(), bruteAreas(scene.vpls));
    scene.vpls = roomOfPlaces(33, 6);
    scene.reset = true;
    rig.update(scene);
    checkAreas(rig.areas(), bruteAreas(scene.vpls));
}

TEST_CASE("only places with a weight of 0 go by their distance", "[static_vpl]") {
    StaticRig rig(16, staticDesc());
    StaticScene scene;
    scene.vpls = roomOfPlaces(20, 3);
    const std::vector<double> brute = bruteAreas(scene.vpls);
    for (std::size_t i = 0; i < 20; i += 3) scene.vpls[i].weight = 0.0f;
    rig.update(scene);
    const std::vector<double> areas = rig.areas();
    for (std::size_t i = 0; i < 20; ++i)
        CHECK(areas[i] == (i % 3 == 0 ? Approx(brute[i]).epsilon(kRounding) : Approx(1.0)));
    scene.vpls.resize(1);  // one that is alone stands for nothing
    rig.update(scene);
    CHECK(rig.areas()[0] == 0.0);
}

TEST_CASE("a second bounce that catches all carries the average reflectance of the first",
          "[static_vpl]") {
    LWStaticVplDesc desc = staticDesc();
    desc.bounces = 2;
    desc.averageReflectance = 0.6f;
    desc.secondDistance = 2.5f;
    desc.cullRelative = 0.0f;
    StaticRig rig(GENERATE(1u, 16u), desc);
    StaticScene scene;
    scene.vpls = roomOfPlaces(24, 7);
    scene.lights = {spotLight({2, 2.8, 2.5}, {0.1, -1, 0.05}, {30, 20, 10}, 0.3, 0.8)};
    rig.update(scene);
    auto vpls = rig.vpls();
    const StaticRig::Vpl second = vpls.back();
    vpls.pop_back();
    glm::dvec3 flux(0.0), place(0.0), normal(0.0);
    double sum = 0.0;
    for (const auto& vpl : vpls) {
        const double weight = vpl.flux.x + vpl.flux.y + vpl.flux.z;
        flux += vpl.flux;
        place += weight * vpl.position;
        normal += weight * vpl.normal;
        sum += weight;
    }
    for (int c = 0; c < 3; ++c) CHECK(second.flux[c] == Approx(0.6 * flux[c]).epsilon(1e-5));
    normal = glm::normalize(normal);
    CHECK(glm::length(second.position - (place / sum + 2.5 * normal)) < 1e-5);
    CHECK(glm::length(second.normal + normal) < 1e-5);
    CHECK(second.area == Approx(kRigPi * 2.5 * 2.5).epsilon(1e-5));

    SECTION("splitting VPLs changes nothing") {
        StaticScene split = scene;
        for (LWStaticVpl& vpl : split.vpls) vpl.weight *= 0.5f;
        split.vpls.insert(split.vpls.end(), split.vpls.begin(), split.vpls.end());
        rig.update(split);
        const StaticRig::Vpl same = rig.vpls().back();
        for (int c = 0; c < 3; ++c) CHECK(same.flux[c] == Approx(second.flux[c]).epsilon(1e-5));
        CHECK(glm::length(same.position - second.position) < 1e-5);
        CHECK(glm::length(same.normal - second.normal) < 1e-5);
        CHECK(same.area == Approx(second.area).epsilon(1e-5));
    }
    SECTION("less area opposite catches its share") {
        desc.secondArea = float(kRigPi * 2.5 * 2.5 / 4.0);
        StaticRig smaller(16, desc);
        smaller.update(scene);
        CHECK(smaller.vpls().back().flux.x == Approx(second.flux.x / 4.0).epsilon(1e-5));
        CHECK(smaller.vpls().back().area == Approx(double(desc.secondArea)).epsilon(1e-5));
    }
    SECTION("light from all around has nothing opposite") {
        scene.vpls = {staticVpl({0, 0, 0}, {0, 1, 0}), staticVpl({0, 2, 0}, {0, -1, 0})};
        scene.lights = {pointLight({0, 1, 0}, {5, 5, 5})};
        rig.update(scene);
        CHECK(rig.vpls().size() == 2);
    }
}

TEST_CASE("a phantom stands where the host says, and looks like the places around", "[static_vpl]") {
    LWStaticVplDesc desc = phantomDesc();
    desc.bounces = 2;
    StaticRig rig(GENERATE(1u, 16u), desc);
    StaticScene scene;
    scene.vpls = roomOfPlaces(30, 9);
    scene.vpls.push_back(staticVpl({2, 0, 2.5}, {0, 1, 0}, 0.7, {0.9, 0.1, 0.3}));
    const float hit[3] = {2.0f, 0.0f, 2.5f};
    scene.lights = {torch({2, 2, 2.5}, {0, -1, 0})};
    scene.lights[0].hit = hit;
    rig.update(scene);
    CHECK(rig.technique.count("phantom_vpls") == 1);
    CHECK(rig.technique.count("kept_vpls") == 0);  // the spot lights no static VPL
    auto vpls = rig.vpls();
    // Its own flux, and that of the one opposite.
    REQUIRE(vpls.size() == 2);
    CHECK(glm::length(vpls[0].position - vec(hit)) == 0.0);
    glm::dvec3 n(0.0), rho(0.0);
    double sum = 0.0, area = 0.0, low = 1e9, high = -1e9;
    glm::dvec3 least(1e9), most(-1e9);
    for (const LWStaticVpl& vpl : scene.vpls)
        least = glm::min(least, vec(vpl.position)), most = glm::max(most, vec(vpl.position));
    const double eps = 2e-4 * glm::dot(most - least, most - least);
    for (const LWStaticVpl& vpl : scene.vpls) {
        const glm::dvec3 d = vec(vpl.position) - vec(hit);
        const double b = 1.0 / (eps + glm::dot(d, d));
        sum += b;
        n += b * vec(vpl.normal);
        rho += b * vec(vpl.reflectance);
        area += b * double(vpl.weight);
    }
    low = glm::length(n);
    n /= low;
    CHECK(glm::length(vpls[0].normal - n) < 1e-5);
    CHECK(vpls[0].area == Approx(area / sum).epsilon(1e-5));
    for (int c = 0; c < 3; ++c)
        CHECK(vpls[0].flux[c] == Approx(rho[c] / sum * area / sum * 20.0 / 4.0 * n.y).epsilon(1e-5));
    // Most of its look is that of the place it lies on.
    CHECK(vpls[0].flux.x > 2.0 * vpls[0].flux.y);
    // Opposite: half the distance behind the lamp, facing the hit, all the light times 0.5.
    CHECK(glm::length(vpls[1].position - glm::dvec3(2, 3, 2.5)) < 1e-5);
    CHECK(glm::length(vpls[1].normal - glm::dvec3(0, -1, 0)) < 1e-6);
    CHECK(vpls[1].flux.x == Approx(0.5 * vpls[0].flux.x).epsilon(1e-5));
    (void)high;
}

TEST_CASE("a phantom lies at the middle of the light's map", "[static_vpl]") {
    StaticRig rig(16, phantomDesc());
    const std::uint32_t size = GENERATE(16u, 17u);
    const bool byDepth = GENERATE(false, true);
    const bool planar = GENERATE(true, false);
    CAPTURE(size, byDepth, planar);
    // A slanted floor under a lamp that looks at its point (0.3, 0, 0.2).
    ViewScene world;
    world.quad({-5, -1, -5}, {10, 2, 0}, {0, 0, 10}, 1.0);
    const glm::dvec3 eye(1, 3, -1), target(0.3, 0.06, 0.2);
    const TestCamera camera = lookAt(eye, target, 0.4, 1.0);
    DrawnView map(world, camera, size, size);
    PlanarPixels flux(size, size, 3), depth(size, size, 1);
    std::vector<float> packed(std::size_t(size) * size * 3);
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x) {
            flux.set(x, y, {1, 1, 1});
            const auto p = map.position.get(x, y);
            depth.at(x, y, 0) = float(glm::length(glm::dvec3(p.x, p.y, p.z) - eye));
            for (std::uint32_t c = 0; c < 3; ++c)
                packed[(std::size_t(y) * size + x) * 3 + c] = map.position.at(x, y, c);
        }
    LWRsm rsm;
    LW_INIT(rsm);
    rsm.camera = map.gbuffer.camera;
    rsm.normal = map.normal.image();
    rsm.flux = flux.image();
    if (byDepth) {
        rsm.depth = depth.image();
        rsm.depthKind = LW_DEPTH_RADIAL;
    } else {
        rsm.position = map.position.image();
        if (!planar) {
            rsm.position = LWImage{};
            rsm.position.host = packed.data();
            rsm.position.format = LW_FORMAT_FLOAT3;
            rsm.position.width = rsm.position.height = size;
        }
    }
    StaticScene scene;
    scene.vpls = {staticVpl({0, 0, 0}, {0, 1, 0}), staticVpl({1, 0, 0}, {0, 1, 0})};
    scene.lights = {pointLight({0, 1, 0}, {0, 0, 0}), torch(eye, target - eye)};
    scene.lights[1].rsmCount = 1;
    scene.lights[1].rsms = &rsm;
    rig.update(scene);
    REQUIRE(rig.vpls().size() == 1);
    const glm::dvec3 place = rig.vpls()[0].position;
    const auto middle = map.position.get(size / 2, size / 2);
    const glm::dvec3 texel(middle.x, middle.y, middle.z);
    // Depth leads to a point of the axis as far away as the middle texel's surface; a map of positions
    // has that texel's.
    if (byDepth)
        CHECK(glm::length(place - (eye + glm::normalize(target - eye) * glm::length(texel - eye))) <
              1e-5);
    else
        CHECK(glm::length(place - texel) < 1e-6);
    if (size % 2) CHECK(glm::length(place - glm::dvec3(target.x, 0.2 * target.x, target.z)) < 1e-4);
}

TEST_CASE("phantoms: no hit, no light; without aim the static VPLs are lit; smoothing lags",
          "[static_vpl]") {
    LWStaticVplDesc desc = phantomDesc();
    desc.smoothing = 0.75f;
    StaticRig rig(16, desc);
    StaticScene scene;
    scene.vpls = roomOfPlaces(30, 9);
    scene.lights = {spotLight({2, 2, 2.5}, {0, -1, 0}, {20, 20, 20}, 1.0, 1.4)};
    rig.update(scene);
    CHECK(rig.technique.count("phantom_vpls") == 0);
    CHECK(rig.technique.count("kept_vpls") > 0);
    float hit[3] = {1.0f, 0.0f, 2.5f};
    scene.lights[0].hit = hit;
    rig.update(scene);
    CHECK(rig.vpls()[0].position.x == 1.0);
    hit[0] = 2.0f;
    rig.update(scene);
    CHECK(rig.vpls()[0].position.x == Approx(1.25));
    rig.update(scene);
    CHECK(rig.vpls()[0].position.x == Approx(1.4375));
    scene.reset = true;
    rig.update(scene);
    CHECK(rig.vpls()[0].position.x == 2.0);
}
