// Large worlds: light does not depend on where the world's origin is, nor on when the host moves the origin of its positions.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>

#include "../samples/large_world.h"
#include "support/cone_box.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;

namespace {

constexpr std::uint32_t kWidth = 48, kHeight = 32, kTexels = 16;
// Of the box: its walls lie on no border of cells, where a rounding decides.
constexpr double kScale = 0.93;
constexpr int kFrames = 7, kMoves = 4;  // the origin moves before this frame
// By how much light may differ when the origin moves, as the root of the mean square relative to the mean: positions are rounded elsewhere,
// and a few texels and samples then fall into other cells.
constexpr double kMost = 1e-3;
// Where a rounding decides more, measured with an origin that stays elsewhere all along: which of 16 clusters 64 VPLs are in (0.039), or
// what 8 of them see (0.019); what lies a pixel before another on the screen (0.0033); which voxels a cluster's light passes (0.0025).
constexpr double kClusters = 0.05, kDecided = 0.006;

using Place = glm::dvec3;

void shift(PlanarPixels& pixels, const Place& by) {
    for (std::uint32_t y = 0; y < pixels.height(); ++y)
        for (std::uint32_t x = 0; x < pixels.width(); ++x) {
            const lightwell::reference::Vec p = pixels.get(x, y);
            pixels.set(x, y, {p.x + by.x, p.y + by.y, p.z + by.z});
        }
}
// As docs/integration.md has it: what lies at `by` from the origin is seen from an origin at -by.
void shift(LWCamera& camera, const Place& by) {
    const double from[3] = {0.0, 0.0, 0.0}, to[3] = {-by.x, -by.y, -by.z};
    moveCamera(&camera, from, to);
}
void shift(float (&p)[3], const Place& by) {
    for (int a = 0; a < 3; ++a) p[a] = float(double(p[a]) + by[a]);
}

// Frame f of a box whose lights, a lamp and the camera move, with everything relative to an origin from which the box lies at `by`.
struct MovingFrame {
    ConeBox box;
    DrawnView drawn;
    std::vector<LWStaticVpl> places;
    float hit[3], focus[3];
    LWFrame frame{};

    MovingFrame(int f, const Place& by, const Place& origin)
        : box(1.0 + 0.3 * (f % 3), false, kScale, 0.5, kTexels),
          drawn(box.walls, lookAt({0.2 + 0.02 * f, 0.1, 0.8 - 0.03 * f}, {0.01 * f, 0, -1}, 1.0), kWidth, kHeight, kScale) {
        for (auto& wall : box.lit) {
            shift(wall->position, by);
            shift(wall->rsm.camera, by);
        }
        addLamp(f, by);
        addPlaces(by);
        shift(drawn.position, by);
        shift(drawn.gbuffer.camera, by);
        for (std::size_t i = 0; i < box.triangles.vertices.size(); ++i)
            box.triangles.vertices[i] = float(double(box.triangles.vertices[i]) + by[int(i % 3)]);
        const float middle[3] = {0.11f + 0.05f * float(f), 0.03f, -0.2f};
        std::copy_n(middle, 3, focus);
        shift(focus, by);
        frame = box.frame;
        frame.lights = box.lights.data();
        frame.lightCount = std::uint32_t(box.lights.size());
        frame.staticVpls = places.data();
        frame.staticVplCount = std::uint32_t(places.size());
        frame.focus = focus;
        for (int a = 0; a < 3; ++a) frame.worldOrigin[a] = origin[a];
    }
    MovingFrame(const MovingFrame&) = delete;

private:
    void addLamp(int f, const Place& by) {
        LWLight lamp{};
        lamp.structSize = sizeof lamp;
        lamp.kind = LW_LIGHT_SPOT;
        const float at[3] = {0.1f, 0.2f, 0.15f}, way[3] = {0.1f + 0.04f * float(f), -0.05f, -1.0f};
        for (int a = 0; a < 3; ++a) {
            lamp.position[a] = at[a];
            lamp.direction[a] = way[a];
            lamp.radiantIntensity[a] = 2.0f;
            hit[a] = at[a] + way[a] * float(kScale + 0.15);
        }
        lamp.innerConeAngle = 0.2f;
        lamp.outerConeAngle = 0.4f;
        shift(lamp.position, by);
        shift(hit, by);
        lamp.hit = hit;
        box.lights.push_back(lamp);
    }
    void addPlaces(const Place& by) {
        for (std::size_t q = 0; q < 6; ++q)
            for (int k = 0; k < 9; ++k) {
                const auto& wall = box.walls.quads[q];
                // No two as far from a third: which is nearer must not be up to a rounding.
                const double across = (k % 3 + 0.3 + 0.07 * double((5 * k + 3 * int(q)) % 7)) / 3, up = (k / 3 + 0.35 + 0.05 * double((3 * k + 2 * int(q)) % 7)) / 3;
                const Place p = kScale * (wall.corner + wall.u * across + wall.v * up);
                LWStaticVpl place{};
                for (int a = 0; a < 3; ++a) {
                    place.position[a] = float(p[a] + by[a]);
                    place.normal[a] = float(-p[a] > 0.9 ? 1 : -p[a] < -0.9 ? -1 : 0);
                    place.reflectance[a] = 0.5f;
                }
                places.push_back(place);
            }
    }
};

// The last of some frames of a box at `place` of the world, of positions relative to origin(f).
std::vector<float> lightAt(LWDevice device, const char* name, const char* settings, const Place& place, const std::function<Place(int)>& origin,
                           const std::function<Place(int)>& ship = {}) {
    LWTechnique raw = nullptr;
    REQUIRE(lwCreateTechniqueFromText(device, name, settings, &raw) == LW_SUCCESS);
    TestView view(device, kWidth, kHeight);
    PlanarPixels irradiance(kWidth, kHeight, 3);
    for (int f = 0; f < kFrames; ++f) {
        const Place o = origin(f);
        // Of a ship nothing moves in it.
        const MovingFrame moving(ship ? 0 : f, place - o, ship ? ship(f) : o);
        LWOutput output{};
        output.structSize = sizeof output;
        output.irradiance = irradiance.image();
        const bool isRight = lwUpdate(raw, &moving.frame) == LW_SUCCESS && lwRender(raw, view, &moving.drawn.gbuffer, &output) == LW_SUCCESS &&
                             lwFinish(device) == LW_SUCCESS;
        INFO(lastError(device));
        REQUIRE(isRight);
    }
    lwReleaseTechnique(raw);
    return irradiance.packed();
}

void compare(LWDevice device, const char* name, const char* settings, double most = kMost) {
    // Whole cells of the grids below.
    const Place far(1e5, -3e4, 2.5e5), odd(12.37, -4.71, 8.93);
    const std::vector<float> here = lightAt(device, name, settings, Place(0), [](int) { return Place(0); });
    // The same floats, elsewhere.
    CHECK(lightAt(device, name, settings, far, [&](int) { return far; }) == here);
    // By no multiple of any cell, once and in every frame: of what is kept nothing may be left where it was.
    const auto error = [&](const std::function<Place(int)>& origin) { return difference(lightAt(device, name, settings, far, origin), here); };
    const double once = error([&](int f) { return f < kMoves ? far : far + odd; }), always = error([&](int f) { return far + odd * double(f + 1); });
    CAPTURE(name, settings, once, always);
    CHECK(std::max(once, always) <= most);
}

}  // namespace

TEST_CASE("light is the same at 1e5 m, and goes on where the origin of positions moves", "[world_origin]") {
    TestDevice device(16);
    compare(device, "rsm", "vpls=64 history=8");
    compare(device, "lpv", "size=16 transport=sweep directions=24 bounces=2 frames=4");
    compare(device, "static_vpl", "variant=phantom bounces=2 smoothing=0.9");
}

TEST_CASE("so it is with all that keep something", "[world_origin][long]") {
    TestDevice device(16);
    compare(device, "rsm", "vpls=64 visibility=voxel voxels=32", kDecided);
    compare(device, "ssvp", "vpls=64 clusters=8 bounces=2 shadowed_bounces=2 history=8", kClusters);
    compare(device, "ssvp", "vpls=64 clusters=16 auto_error=0.2", kClusters);
    compare(device, "screen_space", "history=8");
    compare(device, "horizon", "history=8", kDecided);
    compare(device, "lpv", "size=16 extent=4 cascades=2");
    compare(device, "lpv", "size=16 transport=coarse_to_fine");
    compare(device, "lpv", "size=16 extent=4 cascades=3 transport=sweep directions=24 bounces=2 frames=4");
    compare(device, "cone_tracing", "size=32 bounces=0");
    compare(device, "cone_tracing", "size=32 bounces=0 extent=4 cascades=2");
    compare(device, "static_vpl", "visibility=hard clusters=8");
    compare(device, "fallback", "first=horizon first.history=8 second=rsm second.history=8");
}

// A ship that carries all there is, and the origin with it: nothing moves for what is relative to that.
TEST_CASE("a scene that moves along with the origin is lit as one at rest", "[world_origin]") {
    TestDevice device(16);
    const auto lit = [&](const char* name, const char* settings, const Place& moved) {
        return lightAt(device, name, settings, Place(0), [](int) { return Place(0); }, [&](int f) { return f < kMoves ? Place(0) : moved; });
    };
    const auto check = [&](const char* name, const char* settings) {
        const std::vector<float> still = lit(name, settings, Place(0));
        for (const Place& moved : {Place(320, -640, 32), Place(1e12, -1e12, 9.7e11)}) {
            CAPTURE(name, settings, moved.x);
            CHECK(difference(lit(name, settings, moved), still) <= kMost);
        }
    };
    check("cone_tracing", "size=32 bounces=0 extent=4 cascades=2");
    check("lpv", "size=16 extent=4 transport=sweep directions=24 rests=on");
}

TEST_CASE("listed lights keep their numbers and places where the origin moves", "[world_origin]") {
    TestDevice device(16);
    LWStaticVplDesc desc;
    lwDefaultStaticVpl(&desc);
    desc.lights = 5;
    const auto listed = [&](const Place& odd) {
        TestTechnique technique(device, "static_vpl", &desc);
        std::vector<LWListedLight> lights(desc.lights);
        for (int f = 0; f < kFrames; ++f) {
            const Place origin = f < kMoves ? Place(0) : odd;
            const MovingFrame moving(f, -origin, origin);
            technique.update(moving.frame);
            std::uint32_t count = 0;
            REQUIRE(lwReadLightList(technique, lights.data(), desc.lights, &count) == LW_SUCCESS);
            lights.resize(count);
            if (f + 1 < kFrames) {
                lights.resize(desc.lights);
                continue;
            }
            for (LWListedLight& light : lights)
                for (int a = 0; a < 3; ++a) light.position[a] = float(double(light.position[a]) + origin[a]);
        }
        return lights;
    };
    const std::vector<LWListedLight> stays = listed(Place(0)), moves = listed(Place(200.3, -14.71, 8.93));
    REQUIRE(moves.size() == stays.size());
    for (std::size_t i = 0; i < stays.size(); ++i) {
        CHECK(moves[i].id == stays[i].id);
        CHECK(moves[i].vpls == stays[i].vpls);
        for (int a = 0; a < 3; ++a) CHECK(double(moves[i].position[a]) == Approx(double(stays[i].position[a])).margin(1e-3));
    }
}

TEST_CASE("the origin that docs/integration.md chooses stays near the eye, and seldom moves", "[world_origin]") {
    double origin[3] = {0.0, 0.0, 0.0}, last = 0.0;
    int moves = 0;
    for (int step = 0; step < 1000; ++step) {
        const double eye[3] = {100.0 * step, 5.0, -30.0 * step};
        chooseOrigin(eye, origin);
        for (int a = 0; a < 3; ++a) REQUIRE(std::abs(eye[a] - origin[a]) <= 1024.0);
        moves += origin[0] != last;
        last = origin[0];
    }
    CHECK(moves < 100);
    CHECK(origin[1] == 0.0);
}

TEST_CASE("origins that are no place are refused by name", "[world_origin]") {
    TestDevice device(16);
    TestTechnique technique(device, "rsm", nullptr);
    LWFrame frame{};
    frame.structSize = sizeof frame;
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1.1e12}) {
        frame.worldOrigin[2] = bad;
        CHECK(lwUpdate(technique, &frame) == LW_ERROR_INVALID_ARGUMENT);
        CHECK_THAT(lastError(device), Contains("frame.worldOrigin: expected finite numbers of at most 1e+12, got"));
    }
    // A host that was built before there was one.
    frame.structSize = offsetof(LWFrame, worldOrigin);
    CHECK(lwUpdate(technique, &frame) == LW_SUCCESS);
    frame.structSize -= 8;
    CHECK(lwUpdate(technique, &frame) == LW_ERROR_INVALID_ARGUMENT);
}
