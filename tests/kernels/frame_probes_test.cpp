// Probes of a frame: the serial twin, figures known by construction, no dependence on units, light's strength or resolution.
#include "passes/frame_probes.h"

#include <catch2/catch.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>

#include "shared/vpl_types.h"
#include "support/frame_probes_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr double kPi = 3.14159265358979323846;
// Sums of some thousand floats; and what a place on the edge of a pixel or of a tolerance decides otherwise than in double, of
// 2,304 pixels and 4,096 texels.
constexpr double kRounding = 2e-4, kDecisions = 2e-3;

// A level floor or ceiling of n x n texels over [-1,1]^2 at `height`; flux even.
ProbedMap floorMap(std::uint32_t n, double height = 0.0, double up = 1.0) {
    ProbedMap map;
    map.width = map.height = n;
    for (std::uint32_t y = 0; y < n; ++y)
        for (std::uint32_t x = 0; x < n; ++x) {
            ProbedTexel t;
            t.position = rounded({2.0 * (x + 0.5) / n - 1.0, height, 2.0 * (y + 0.5) / n - 1.0});
            t.normal = {0.0, up, 0.0};
            t.flux = glm::dvec3(double(float(1.0 / (n * n))));
            t.area = 4.0 / (n * n);
            t.isSurface = true;
            map.texels.push_back(t);
        }
    return map;
}

}  // namespace

TEST_CASE("probes are those of the serial twin", "[frame_probes]") {
    const auto width = GENERATE(1u, 16u);
    Probing probing(width);
    ProbedSetup setup;
    std::tie(setup.width, setup.height) = testSize({320, 180});
    SECTION("one map") {
        const ProbedPicture picture = drawPicture(setup);
        const std::vector<ProbedMap> maps{drawMap(setup)};
        const LWCamera camera = setup.camera.matrices();
        const FrameFigures expected = FrameProbesTwin(picture, maps).probes();
        checkNear(probing.run(picture, maps, &camera), expected, kRounding, kDecisions);
        // The scene has all that the probes look for.
        CHECK(expected.indirectShare > 0.05f);
        CHECK(expected.fluxOnScreen > 0.2f);
        CHECK(expected.depthComplexity > 0.005f);
        CHECK(expected.hidden > 0.01f);
    }
    SECTION("an orthographic view, maps of other sizes, background") {
        setup.scene.quads.resize(1);
        setup.camera.orthographic = true;
        setup.camera.eye = {0.0, 1.5, 2.5};
        setup.camera.left = -3.0, setup.camera.rightEdge = 3.0, setup.camera.bottom = -1.7, setup.camera.top = 1.7;
        ProbedSetup other = setup;
        other.texels = 37;
        const ProbedPicture picture = drawPicture(setup);
        const std::vector<ProbedMap> maps{drawMap(setup), drawMap(other), floorMap(16, 2.0, -1.0)};
        const LWCamera camera = setup.camera.matrices();
        checkNear(probing.run(picture, maps, &camera), FrameProbesTwin(picture, maps).probes(), kRounding, kDecisions);
    }
    SECTION("a picture smaller than the grid, a map of one texel") {
        setup.width = 24, setup.height = 10, setup.texels = 1;
        const ProbedPicture picture = drawPicture(setup);
        const std::vector<ProbedMap> maps{drawMap(setup)};
        const LWCamera camera = setup.camera.matrices();
        checkNear(probing.run(picture, maps, &camera), FrameProbesTwin(picture, maps).probes(), kRounding, kDecisions);
    }
}

TEST_CASE("probes depend on no unit, no strength of light and no resolution", "[frame_probes][large]") {
    Probing probing(16);
    const ProbedSetup plain;
    const FrameFigures probes = probe(probing, plain);
    ProbedSetup long_ = plain, bright = plain, coarse = plain, fine = plain;
    long_.length = 10.0;
    bright.light = 100.0;
    coarse.width /= 2, coarse.height /= 2, coarse.texels /= 2;
    fine.width *= 2, fine.height *= 2, fine.texels *= 2;
    checkNear(probe(probing, long_), probes, kRounding, kDecisions);
    checkNear(probe(probing, bright), probes, kRounding, kDecisions);
    // Other places within a pixel or texel: of the widest, half a pixel of 160 in width.
    constexpr double kHalfPixel = 0.03, kPlaces = 0.015;
    checkNear(probe(probing, coarse), probes, kHalfPixel, kPlaces);
    checkNear(probe(probing, fine), probes, kHalfPixel, kPlaces);
    // Very bright, very long and very short units leave float's range nowhere.
    for (const double extreme : {1e-6, 1e6}) {
        ProbedSetup far = plain;
        far.length = extreme;
        checkNear(probe(probing, far), probes, 10 * kRounding, kDecisions);
        far.length = 1.0;
        far.light = extreme * extreme;
        checkNear(probe(probing, far), probes, kRounding, kDecisions);
    }
}

TEST_CASE("probes have the same bits in every run", "[frame_probes][large]") {
    Probing probing(16);
    ProbedSetup setup;
    std::tie(setup.width, setup.height) = testSize({320, 180});
    const LWCamera camera = setup.camera.matrices();
    const ProbedPicture picture = drawPicture(setup);
    const std::vector<ProbedMap> maps{drawMap(setup)};
    probing.run(picture, maps, &camera);
    const LwFrameProbes first = probing.sums;
    for (int i = 0; i < 4; ++i) {
        probing.run(picture, maps, &camera);
        CHECK(std::memcmp(&first, &probing.sums, sizeof first) == 0);
    }
}

TEST_CASE("probes of figures known by construction", "[frame_probes][large]") {
    Probing probing(GENERATE(1u, 16u));
    // A ceiling at 2 m, seen from below all over, over an evenly lit floor.
    ProbedSetup setup;
    setup.scene.quads.clear();
    setup.scene.quad({-8, 2, -8}, {16, 0, 0}, {0, 0, 16}, 0.0);
    setup.camera = lookAt({0, 0.5, 0}, {0, 2, 0.001}, 0.5, 1.0);
    setup.width = setup.height = 64;
    ProbedPicture picture = drawPicture(setup);
    const LWCamera camera = setup.camera.matrices();
    std::fill(picture.albedo.begin(), picture.albedo.end(), glm::dvec3(0.25));
    ProbedMap map = floorMap(64);

    SECTION("an even floor under a ceiling") {
        const FrameFigures probes = probing.run(picture, {map}, &camera);
        CHECK(double(probes.fluxConcentration) == Approx(1.0 / LW_PROBE_TEXELS).epsilon(1e-5));
        CHECK(double(probes.albedo) == Approx(0.25));
        CHECK(probes.facing == 1.0f);
        CHECK(probes.hidden == 0.0f);
        CHECK(probes.depthComplexity == 0.0f);
        CHECK(probes.fluxOnScreen == 0.0f);
        // The view shows 1.5 m of ceiling along each side, the map 2 m of floor.
        CHECK(double(probes.extent) == Approx(0.75).epsilon(0.01));
    }
    SECTION("half of the light is far away from the view's own point of the same flux") {
        // All light in one texel: a disc of no size, straight below at 2 m: E = flux / pi c^4 / d^2, d the distance along the axis.
        for (ProbedTexel& t : map.texels) t.flux = glm::dvec3(0.0), t.area = 0.0;
        map = floorMap(1);
        map.texels[0].area = 0.0;
        map.texels[0].flux = glm::dvec3(3.0);
        for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
            const glm::dvec3 d = picture.pixels[i].position - map.texels[0].position;
            const double squared = glm::dot(d, d), cosine = d.y / std::sqrt(squared);
            picture.radiance[i] = glm::dvec3(0.25 / kPi * 3.0 / kPi * cosine * cosine / squared);
        }
        const FrameFigures probes = probing.run(picture, {map}, &camera);
        CHECK(double(probes.indirectShare) == Approx(0.5).epsilon(1e-4));
        CHECK(std::isnan(probes.extent));
        CHECK(double(probes.fluxConcentration) == Approx(1.0 / LW_PROBE_TEXELS).epsilon(1e-5));  // cells of one texel share it
    }
    SECTION("all flux in a point") {
        // Of the cells of a map with as many texels each has its own.
        for (std::size_t i = 0; i < map.texels.size(); ++i) map.texels[i].flux = glm::dvec3(i == 1000 ? 1.0 : 0.0);
        CHECK(probing.run(picture, {map}, &camera).fluxConcentration == 1.0f);
    }
    SECTION("the view shows half of the flux, where it is what lights") {
        ProbedMap above = floorMap(64, 2.0, -1.0);  // the ceiling's own texels, of which the view shows 1.5 m x 1.5 m of 2 m x 2 m
        const FrameFigures probes = probing.run(picture, {above}, &camera);
        CHECK(double(probes.fluxOnScreen) == Approx(0.5625).epsilon(0.01));
        CHECK(probes.facing == 0.0f);
        CHECK(std::isnan(probes.hidden));  // no pair to look between
        for (ProbedTexel& t : above.texels) t.normal = -t.normal;  // its upper side
        CHECK(probing.run(picture, {above}, &camera).fluxOnScreen == 0.0f);
    }
    SECTION("half of the picture is sky") {
        CHECK(probing.run(picture, {map}, &camera).coverage == 1.0f);
        for (std::uint32_t y = 0; y < 32; ++y)
            for (std::uint32_t x = 0; x < 64; ++x) picture.pixels[y * 64 + x].normal = glm::dvec3(0.0);
        CHECK(probing.run(picture, {map}, nullptr).coverage == 0.5f);
    }
    SECTION("steps between neighbours") {
        // Stripes of the picture at two depths: every eighth pair across differs, none along.
        for (std::uint32_t y = 0; y < 64; ++y)
            for (std::uint32_t x = 0; x < 64; ++x)
                if (x / 8 % 2) picture.pixels[y * 64 + x].position *= 2.0;
        const double across = 7.0 * 36.0, pairs = 63.0 * 36.0 + 64.0 * 35.0;
        CHECK(double(probing.run(picture, {map}, &camera).depthComplexity) == Approx(across / pairs).epsilon(1e-5));
    }
}

TEST_CASE("a screen between floor and ceiling hides them from each other, as far as the view shows it", "[frame_probes][large]") {
    Probing probing(16);
    ProbedSetup setup;
    setup.scene.quads.clear();
    setup.scene.quad({-4, 0, -4}, {8, 0, 0}, {0, 0, 8}, 0.0);   // floor
    setup.scene.quad({-4, 0, -4}, {0, 4, 0}, {8, 0, 0}, 0.0);   // wall behind
    setup.camera = lookAt({0, 2, 8}, {0, 2, 0}, 0.5, 1.0);
    setup.width = setup.height = 128;
    setup.lamp = lookAt({0, 8, -1}, {0, 0, -1.001}, 0.4, 1.0);
    const FrameFigures open = probe(probing, setup);
    setup.scene.quad({-4, 0, -1}, {8, 0, 0}, {0, 1.5, 0}, 0.0);  // before the wall, in front of most of the floor that is lit
    const FrameFigures hidden = probe(probing, setup);
    CHECK(open.hidden < 0.01f);
    CHECK(hidden.hidden > 0.2f);
    CHECK(hidden.fluxOnScreen < open.fluxOnScreen);
}

TEST_CASE("probes are NaN where nothing is given to measure them by", "[frame_probes][large]") {
    Probing probing(16);
    ProbedSetup setup;
    setup.width = 32, setup.height = 18;
    const LWCamera camera = setup.camera.matrices();
    SECTION("no light") {
        const FrameFigures probes = probing.run(drawPicture(setup), {}, &camera);
        for (const float each : {probes.indirectShare, probes.fluxOnScreen, probes.fluxConcentration, probes.extent, probes.facing, probes.hidden})
            CHECK(std::isnan(each));
        CHECK(probes.albedo > 0.0f);
        CHECK(probes.depthComplexity > 0.0f);
    }
    SECTION("no camera") {
        const FrameFigures probes = probing.run(drawPicture(setup), {drawMap(setup)}, nullptr);
        for (const float each : {probes.fluxOnScreen, probes.depthComplexity, probes.hidden}) CHECK(std::isnan(each));
        for (const float each : {probes.indirectShare, probes.fluxConcentration, probes.extent, probes.facing, probes.albedo}) CHECK(each > 0.0f);
    }
    SECTION("no albedo, no radiance") {
        setup.hasAlbedo = false;
        FrameFigures probes = probing.run(drawPicture(setup), {drawMap(setup)}, &camera);
        CHECK(std::isnan(probes.indirectShare));
        CHECK(std::isnan(probes.albedo));
        CHECK(probes.facing > 0.0f);
        setup.hasAlbedo = true, setup.hasRadiance = false;
        probes = probing.run(drawPicture(setup), {drawMap(setup)}, &camera);
        CHECK(std::isnan(probes.indirectShare));
        CHECK(probes.albedo > 0.0f);
    }
    SECTION("no surface, no flux") {
        ProbedPicture empty = drawPicture(setup);
        for (ProbeSurface& s : empty.pixels) s.normal = glm::dvec3(0.0), s.position = glm::dvec3(double(NAN));
        FrameFigures probes = probing.run(empty, {drawMap(setup)}, &camera);
        CHECK(probes.coverage == 0.0f);
        for (const float each : {probes.indirectShare, probes.depthComplexity, probes.extent, probes.facing, probes.hidden, probes.albedo})
            CHECK(std::isnan(each));
        CHECK(probes.fluxOnScreen == 0.0f);
        ProbedMap dark = drawMap(setup);
        for (ProbedTexel& t : dark.texels) t.flux = glm::dvec3(0.0);
        probes = probing.run(drawPicture(setup), {dark}, &camera);
        for (const float each : {probes.indirectShare, probes.fluxOnScreen, probes.fluxConcentration, probes.facing, probes.hidden})
            CHECK(std::isnan(each));
        CHECK(probes.extent > 0.0f);
    }
    SECTION("numbers that are none in albedo and radiance count as 0") {
        ProbedPicture picture = drawPicture(setup);
        for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
            picture.albedo[i] = glm::dvec3(double(NAN), -1.0, 0.0);
            picture.radiance[i] = glm::dvec3(double(INFINITY), double(NAN), -3.0);
        }
        const FrameFigures probes = probing.run(picture, {drawMap(setup)}, &camera);
        CHECK(probes.albedo == 0.0f);
        CHECK(probes.indirectShare == 0.0f);
    }
}

TEST_CASE("the host's own VPLs are emitters like texels", "[frame_probes]") {
    Probing probing(16);
    ProbedSetup setup;
    setup.width = 64, setup.height = 36;
    const LWCamera camera = setup.camera.matrices();
    LWVpl vpl{};
    vpl.position[1] = 1.0f;
    vpl.normal[1] = -1.0f;
    for (float& part : vpl.flux) part = 2.0f;
    const FrameFigures probes = probing.run(drawPicture(setup), {}, &camera, {vpl});
    CHECK(probes.fluxConcentration == 1.0f);
    CHECK(probes.facing > 0.1f);
    CHECK(probes.indirectShare > 0.0f);
    CHECK(std::isnan(probes.extent));
    std::vector<lw_vpl> emitters(LW_PROBE_EMITTERS);
    probing.pass.emitters().download(0, emitters.size() * sizeof(lw_vpl), emitters.data());
    double flux = 0.0;
    for (const lw_vpl& each : emitters) flux += double(each.flux.s[0]);
    CHECK(flux == Approx(2.0).epsilon(1e-5));
}

// `frame_probes_test "[timing]"`: the time of each pass at full size, for docs/planner.md.
TEST_CASE("the time that probes take", "[frame_probes][large][.timing]") {
    Probing probing(16);
    ProbedSetup setup;
    setup.width = 1280, setup.height = 720, setup.texels = 512;
    const LWCamera camera = setup.camera.matrices();
    const ProbedPicture picture = drawPicture(setup);
    const std::vector<ProbedMap> maps{drawMap(setup)};
    std::map<std::string, std::vector<double>> times;
    for (int i = 0; i < 21; ++i) {
        probing.rig.profile().clear();
        probing.run(picture, maps, &camera);
        double total = 0.0;
        for (const LWPassTime& pass : probing.rig.profile().passes()) {
            if (std::string(pass.name).rfind("frame_probes", 0) != 0) continue;
            times[pass.name].push_back(pass.milliseconds);
            total += pass.milliseconds;
        }
        times["all of them"].push_back(total);
    }
    for (auto& [name, values] : times) {
        std::sort(values.begin(), values.end());
        std::printf("%-24s median %.3f ms, least %.3f ms\n", name.c_str(), values[values.size() / 2], values.front());
    }
}
