// Reflective shadow maps as texels: layout, cleaning, areas against radiometry, cascades.
#include "inputs/rsm_input.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "compute/error.h"
#include "inputs/read_planes.h"
#include "support/camera_matrices.h"
#include "support/host_image.h"
#include "support/kernel_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using Catch::Matchers::Contains;

namespace {

// Areas and cosines pass through a dozen float roundings.
constexpr double kAreaTolerance = 3e-6;
// A perspective texel's area is taken at its centre: second order in its angle, (1.4 / 33)^2 / 4 at most.
constexpr double kCentreTolerance = 1e-3;
// Coordinates at distances of 4 units, where a float's last place is 5e-7: four of them.
constexpr double kDistanceRounding = 2e-6;
// Texels' fluxes are floats, added up in double.
constexpr double kFluxSumRounding = 1e-7;
// The same midpoint rule over the 64 x 64 texels of a cube's face: (2 / 64)^2 / 12.
constexpr double kSphereTolerance = 1e-4;

// A camera that looks straight down from `height` above (x, z), image +x = world +x, image down = world
// +z.
TestCamera downward(double x, double z, double height, double half, bool orthographic) {
    TestCamera camera =
        testCamera(orthographic ? kOrthographic : kRightHanded, glm::dvec3(x, height, z));
    camera.right = {1, 0, 0};
    camera.up = {0, 0, -1};
    camera.forward = {0, -1, 0};
    camera.left = camera.bottom = -half;
    camera.rightEdge = camera.top = half;
    return camera;
}

// One map whose pixels lie on a plane through the origin.
struct Map {
    Map(std::uint32_t w, std::uint32_t h, const TestCamera& from, const glm::dvec3& planeNormal)
        : camera(from),
          position(LW_FORMAT_FLOAT3, w, h),
          normal(LW_FORMAT_FLOAT3, w, h),
          flux(LW_FORMAT_FLOAT3, w, h),
          points(w * h) {
        for (std::uint32_t y = 0; y < h; ++y)
            for (std::uint32_t x = 0; x < w; ++x) {
                const glm::dvec3 a = camera.point((x + 0.5) / w, (y + 0.5) / h, 0);
                const glm::dvec3 b = camera.point((x + 0.5) / w, (y + 0.5) / h, 1);
                const double t = -glm::dot(a, planeNormal) / glm::dot(b - a, planeNormal);
                const glm::dvec3 p = a + (b - a) * t;
                points[y * w + x] = p;
                position.set(x, y, p.x, p.y, p.z);
                normal.set(x, y, planeNormal.x, planeNormal.y, planeNormal.z);
                flux.set(x, y, 1, 2, 3);
            }
    }
    LWRsm rsm() {
        LWRsm result{};
        result.position = position.image();
        result.normal = normal.image();
        result.flux = flux.image();
        result.camera = camera.matrices();
        return result;
    }
    TestCamera camera;
    HostImage position, normal, flux;
    std::vector<glm::dvec3> points;
};

struct Imported {
    std::vector<float> texels;
    std::size_t total = 0;
    std::uint64_t rejected = 0, covered = 0;
    double at(int plane, std::size_t texel) const {
        return double(texels[std::size_t(plane) * total + texel]);
    }
    double sum(int plane) const {
        double result = 0;
        for (std::size_t i = 0; i < total; ++i) result += at(plane, i);
        return result;
    }
};

Imported importLights(KernelRig& rig, const std::vector<LWLight>& lights, RsmInput& input) {
    LWFrame frame{};
    frame.lightCount = std::uint32_t(lights.size());
    frame.lights = lights.data();
    input.import(rig.executor(), frame);
    rig.device().finish();
    Imported result;
    result.total = input.texels.width;
    result.texels.resize(result.total * RsmInput::kPlaneCount);
    if (input.texels) readPlanes(rig.device(), input.texels, result.texels.data());
    Report report;
    input.report(report);
    rig.device().finish();
    report.resolve();
    for (const LWCount& count : report.counts) {
        if (std::string(count.name) == "rejected_texels") result.rejected = count.value;
        if (std::string(count.name) == "covered_texels") result.covered = count.value;
    }
    return result;
}

LWLight sun(const std::vector<LWRsm>& rsms) {
    LWLight light{};
    light.kind = LW_LIGHT_DIRECTIONAL;
    light.direction[1] = -2.0f;
    light.rsmCount = std::uint32_t(rsms.size());
    light.rsms = rsms.data();
    return light;
}

LWLight spot(const LWRsm& rsm) {
    LWLight light{};
    light.kind = LW_LIGHT_SPOT;
    light.direction[1] = -1.0f;
    light.rsmCount = 1;
    light.rsms = &rsm;
    return light;
}

std::string refusal(const LWLight& light) {
    KernelRig rig(16);
    RsmInput input;
    try {
        importLights(rig, {light}, input);
    } catch (const Error& error) {
        CHECK(error.status() == LW_ERROR_INVALID_ARGUMENT);
        return error.what();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("maps of several lights lie row after row, padded with darkness", "[rsm_input]") {
    KernelRig rig(GENERATE(1u, 16u));
    Map first(37, 5, downward(0, 0, 4, 2, true), {0, 1, 0}),
        second(3, 2, downward(1, 1, 2, 0.5, false), {0, 1, 0});
    const std::vector<LWRsm> firstRsm{first.rsm()};
    const LWRsm secondRsm = second.rsm();
    LWLight analytic{};
    analytic.kind = LW_LIGHT_POINT;
    RsmInput input;
    const Imported got = importLights(rig, {sun(firstRsm), analytic, spot(secondRsm)}, input);
    REQUIRE(input.spans.size() == 2);
    CHECK(input.spans[1].light == 2);
    CHECK(input.spans[1].firstTexel == 48 * 5);
    CHECK(input.spans[1].firstRow == 5);
    CHECK(input.rowCount == 7);
    CHECK(input.texelCount == 37 * 5 + 3 * 2);
    CHECK(got.total == 48 * 5 + 16 * 2);
    std::vector<std::int32_t> rows(input.rowCount * 4);
    input.rows.download(0, rows.size() * 4, rows.data());
    CHECK(std::vector<std::int32_t>(rows.begin() + 16, rows.begin() + 24) ==
          std::vector<std::int32_t>{48 * 4, 37, 0, 0, 48 * 5, 3, 1, 0});
    int wrong = 0;
    for (std::size_t texel = 0; texel < got.total; ++texel) {
        const bool inSecond = texel >= 48 * 5;
        const std::size_t in = inSecond ? texel - 48 * 5 : texel;
        const std::size_t x = inSecond ? in % 16 : in % 48, y = inSecond ? in / 16 : in / 48;
        const Map& map = inSecond ? second : first;
        const bool valid = x < map.flux.width();
        for (int c = 0; c < 3; ++c) {
            if (got.at(RsmInput::kFluxR + c, texel) != (valid ? c + 1.0 : 0.0)) ++wrong;
            const double p = valid ? map.position.value(std::uint32_t(x), std::uint32_t(y), c) : 0.0;
            if (got.at(RsmInput::kPositionX + c, texel) != p) ++wrong;
        }
        if (got.at(RsmInput::kNormalY, texel) != (valid ? 1.0 : 0.0)) ++wrong;
        if ((got.at(RsmInput::kArea, texel) > 0.0) != valid) ++wrong;
    }
    CHECK(wrong == 0);
    CHECK(got.rejected == 0);
    CHECK(got.covered == 0);

    const Imported none = importLights(rig, {analytic}, input);
    CHECK(none.total == 0);
    CHECK_FALSE(input.texels);
    CHECK(input.rowCount == 0);
}

TEST_CASE("texels that can't be used are dark and counted", "[rsm_input]") {
    KernelRig rig(GENERATE(1u, 16u));
    Map map(20, 3, downward(0, 0, 4, 2, true), {0, 1, 0});
    const double nan = std::nan(""), inf = HUGE_VAL;
    map.flux.set(0, 0, nan, 1, 1);
    map.flux.set(1, 0, 1, -1e-3, 1);
    map.flux.set(19, 2, 1, 1, inf);
    map.flux.set(18, 2, 2e38, 1, 1);  // sums of such would be infinite
    map.position.set(2, 0, nan, 0, 0);
    map.position.set(3, 1, 0, -inf, 0);
    map.position.set(4, 1, 1.01e9, 0, 0);  // out of reach
    map.position.set(9, 1, 0.99e9, 0, 0);  // within
    map.normal.set(5, 1, nan, 1, 0);
    map.normal.set(6, 1, 0, 0, 0);  // nothing lit: not an error
    map.position.set(6, 1, nan, nan, nan);
    map.normal.set(7, 1, 0, 3, 4);  // not unit
    map.flux.set(8, 1, 0, 0, 0);    // dark, but a surface
    const std::vector<LWRsm> rsms{map.rsm()};
    RsmInput input;
    const Imported got = importLights(rig, {sun(rsms)}, input);
    CHECK(got.rejected == 8);
    for (const float value : got.texels) REQUIRE(std::isfinite(value));
    const auto texel = [](std::uint32_t x, std::uint32_t y) { return std::size_t(32 * y + x); };
    for (const auto& bad : {texel(0, 0), texel(1, 0), texel(19, 2), texel(18, 2), texel(2, 0), texel(3, 1),
                            texel(4, 1), texel(5, 1), texel(6, 1)})
        for (int plane = 0; plane < RsmInput::kPlaneCount; ++plane) CHECK(got.at(plane, bad) == 0.0);
    CHECK(got.at(RsmInput::kNormalY, texel(7, 1)) == Approx(0.6));
    CHECK(got.at(RsmInput::kNormalZ, texel(7, 1)) == Approx(0.8));
    CHECK(got.at(RsmInput::kNormalY, texel(8, 1)) == 1.0);
    CHECK(got.at(RsmInput::kFluxB, texel(9, 1)) == 3.0);
}

TEST_CASE("texels without a finite area are dark and counted", "[rsm_input]") {
    KernelRig rig(GENERATE(1u, 16u));
    // Texels 1e24 units wide, or so narrow and so far from the eye that their area is 0 times infinity.
    const bool orthographic = GENERATE(true, false);
    TestCamera camera = downward(0, 0, 4, orthographic ? 1e25 : 1e-24, orthographic);
    if (!orthographic) camera.eye.y = 1e25;
    Map map(20, 3, camera, {0, 1, 0});
    for (std::uint32_t y = 0; y < 3; ++y)
        for (std::uint32_t x = 0; x < 20; ++x) map.position.set(x, y, x, 0, y);
    const std::vector<LWRsm> rsms{map.rsm()};
    RsmInput input;
    const Imported got = importLights(rig, {orthographic ? sun(rsms) : spot(rsms[0])}, input);
    CHECK(got.rejected == 20 * 3);
    for (const float value : got.texels) REQUIRE(value == 0.0f);
}

TEST_CASE("flux over area is albedo times direct irradiance", "[rsm_input]") {
    KernelRig rig(GENERATE(1u, 16u));
    constexpr std::uint32_t size = 33;
    constexpr double albedo = 0.6;
    const glm::dvec3 tilted = glm::normalize(glm::dvec3(0.3, 1.0, -0.2));
    const bool orthographic = GENERATE(true, false);
    Map map(size, size, downward(0.3, -0.2, 4, orthographic ? 2 : 0.7, orthographic), tilted);
    constexpr double sunIrradiance = 5, intensity = 7;
    double worst = 0;
    const double texel = (orthographic ? 4.0 : 1.4) / size;  // side, at distance 1 for perspective
    std::vector<double> direct(size * size);
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x) {
            const glm::dvec3 toLight =
                orthographic ? glm::dvec3(0, 1, 0) : map.camera.eye - map.points[y * size + x];
            const double distance = glm::length(toLight), cosine = glm::dot(tilted, toLight) / distance;
            const double onAxis = toLight.y / distance;
            const double flux =
                albedo * (orthographic ? sunIrradiance * texel * texel
                                       : intensity * texel * texel * onAxis * onAxis * onAxis);
            direct[y * size + x] =
                cosine * (orthographic ? sunIrradiance : intensity / (distance * distance));
            map.flux.set(x, y, flux, flux, flux);
        }
    const LWRsm rsm = map.rsm();
    const std::vector<LWRsm> rsms{rsm};
    RsmInput input;
    const Imported got = importLights(rig, {orthographic ? sun(rsms) : spot(rsm)}, input);
    double area = 0;
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x) {
            const std::size_t at = 48 * y + x;
            const double exitance = got.at(RsmInput::kFluxR, at) / got.at(RsmInput::kArea, at);
            const double expected = albedo * direct[y * size + x];
            worst = std::fmax(worst, std::fabs(exitance / expected - 1));
            area += got.at(RsmInput::kArea, at);
        }
    CHECK(worst < kAreaTolerance);
    // The texels' areas tile the part of the plane that the map sees: its corners by intersection.
    const auto corner = [&](double u, double v) {
        const glm::dvec3 a = map.camera.point(u, v, 0), b = map.camera.point(u, v, 1);
        return a - (b - a) * (glm::dot(a, tilted) / glm::dot(b - a, tilted));
    };
    const glm::dvec3 c00 = corner(0, 0), c10 = corner(1, 0), c01 = corner(0, 1), c11 = corner(1, 1);
    const double seen =
        (glm::length(glm::cross(c10 - c00, c11 - c00)) + glm::length(glm::cross(c11 - c00, c01 - c00))) /
        2;
    CHECK(std::fabs(area / seen - 1.0) < (orthographic ? kAreaTolerance : kCentreTolerance));
}

TEST_CASE("six faces of a point light see the whole sphere", "[rsm_input][large]") {
    KernelRig rig(16);
    // On a unit sphere around the light every cosine is 1: areas sum to 4 pi.
    constexpr std::uint32_t size = 64;
    Map map(size, size, downward(0, 0, 2, 1, false), {0, 1, 0});
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x) {
            const glm::dvec3 out = glm::normalize(map.points[y * size + x] - map.camera.eye),
                             p = map.camera.eye + out;
            map.position.set(x, y, p.x, p.y, p.z);
            map.normal.set(x, y, -out.x, -out.y, -out.z);
        }
    const LWRsm rsm = map.rsm();
    RsmInput input;
    const Imported got = importLights(rig, {spot(rsm)}, input);
    CHECK(std::fabs(6 * got.sum(RsmInput::kArea) / (4 * 3.14159265358979) - 1.0) < kSphereTolerance);
}

TEST_CASE("areas are bounded at grazing incidence", "[rsm_input]") {
    KernelRig rig(GENERATE(1u, 16u));
    Map map(16, 1, downward(0, 0, 4, 2, true), {0, 1, 0});
    map.normal.set(3, 0, 1, 0.01, 0);
    const std::vector<LWRsm> rsms{map.rsm()};
    RsmInput input;
    const Imported got = importLights(rig, {sun(rsms)}, input);
    const double texelArea = 4.0 * 4.0 / 16;
    CHECK(got.at(RsmInput::kArea, 2) == Approx(texelArea).epsilon(kAreaTolerance));
    CHECK(got.at(RsmInput::kArea, 3) == Approx(texelArea * 20).epsilon(kAreaTolerance));
}

TEST_CASE("nested cascades carry the flux of one map", "[rsm_input]") {
    KernelRig rig(GENERATE(1u, 16u));
    const glm::dvec3 floor{0, 1, 0};
    constexpr double exitance = 3;
    // The finest covers [-1,1]^2, the next [-2,2]^2, the coarsest [-4,4] x [-4,4] around (0.5, 0.5).
    std::vector<Map> maps;
    maps.emplace_back(40, 40, downward(0, 0, 3, 1, true), floor);
    maps.emplace_back(32, 32, downward(0, 0, 5, 2, true), floor);
    maps.emplace_back(32, 32, downward(0.5, 0.5, 6, 4, true), floor);
    std::vector<LWRsm> rsms;
    for (Map& map : maps) {
        const double side = (map.camera.rightEdge - map.camera.left) / map.flux.width();
        const double flux = exitance * side * side;
        for (std::uint32_t y = 0; y < map.flux.height(); ++y)
            for (std::uint32_t x = 0; x < map.flux.width(); ++x) map.flux.set(x, y, flux, flux, flux);
        rsms.push_back(map.rsm());
    }
    RsmInput input;
    const Imported split = importLights(rig, {sun(rsms)}, input);
    const Imported whole = importLights(rig, {sun({rsms[2]})}, input);
    // The coarsest map's texels are 1/4 wide: borders of the finer ones fall on texel borders.
    CHECK(std::fabs(split.sum(RsmInput::kFluxR) / whole.sum(RsmInput::kFluxR) - 1.0) < kFluxSumRounding);
    CHECK(std::fabs(whole.sum(RsmInput::kFluxR) / (exitance * 64) - 1.0) < kFluxSumRounding);
    CHECK(split.covered == 16 * 16 + 16 * 16);
    CHECK(whole.covered == 0);
    // Light of another light is not covered.
    const Imported two = importLights(rig, {sun({rsms[0]}), sun({rsms[2]})}, input);
    CHECK(two.covered == 0);
}

TEST_CASE("maps by depth equal maps by position", "[rsm_input]") {
    KernelRig rig(GENERATE(1u, 16u));
    const bool orthographic = GENERATE(true, false);
    Map map(21, 9, downward(0.5, 0.25, 4, orthographic ? 2 : 0.7, orthographic),
            glm::normalize(glm::dvec3(0.1, 1, 0.2)));
    HostImage depth(LW_FORMAT_FLOAT1, 21, 9);
    for (std::uint32_t y = 0; y < 9; ++y)
        for (std::uint32_t x = 0; x < 21; ++x)
            depth.set(x, y,
                      x == 4 && y == 4 ? 0.0 : map.camera.depth(map.points[y * 21 + x], LW_DEPTH_AXIAL));
    LWRsm byPosition = map.rsm(), byDepth = byPosition;
    byDepth.position = LWImage{};
    byDepth.depth = depth.image();
    byDepth.depthKind = LW_DEPTH_AXIAL;
    const auto light = [&](const LWRsm& rsm) {
        LWLight result = spot(rsm);
        if (orthographic) result.kind = LW_LIGHT_DIRECTIONAL;
        return result;
    };
    RsmInput input;
    const Imported a = importLights(rig, {light(byPosition)}, input),
                   b = importLights(rig, {light(byDepth)}, input);
    double worst = 0;
    for (std::size_t i = 0; i < a.texels.size(); ++i)
        if (i % a.total != 4 * 32 + 4)
            worst = std::fmax(worst, std::fabs(double(a.texels[i]) - double(b.texels[i])));
    CHECK(worst < kDistanceRounding);
    CHECK(b.at(RsmInput::kFluxR, 4 * 32 + 4) == 0.0);
    CHECK(b.rejected == 0);
}

TEST_CASE("lights that can't be used are refused by name", "[rsm_input]") {
    Map ortho(8, 8, downward(0, 0, 4, 2, true), {0, 1, 0}),
        persp(8, 8, downward(0, 0, 4, 1, false), {0, 1, 0});
    std::vector<LWRsm> rsms{ortho.rsm()};
    LWRsm perspRsm = persp.rsm();
    CHECK(refusal(sun(rsms)) == "accepted");
    CHECK(refusal(spot(perspRsm)) == "accepted");
    CHECK_THAT(refusal(spot(rsms[0])),
               Contains("frame.lights[0].rsms[0].camera.projection: expected perspective"));
    CHECK_THAT(refusal(sun({perspRsm})), Contains("expected orthographic"));
    LWLight light = sun(rsms);
    light.direction[0] = 1.0f;
    CHECK_THAT(refusal(light), Contains("frame.lights[0].rsms[0].camera.view") && Contains("direction"));
    light = sun(rsms);
    setEnum(light.kind, 5);
    CHECK_THAT(refusal(light), Contains("frame.lights[0].kind"));
    const std::vector<LWRsm> two{perspRsm, perspRsm};
    light = spot(perspRsm);
    light.rsmCount = 2;
    light.rsms = two.data();
    CHECK_THAT(refusal(light), Contains("rsmCount"));
    Map wide(8, 8, downward(0, 0, 4, 4, true), {0, 1, 0});
    const std::vector<LWRsm> coarseFirst{wide.rsm(), ortho.rsm()};
    CHECK_THAT(refusal(sun(coarseFirst)), Contains("finest cascade first"));
    rsms[0].flux.height = 7;
    CHECK_THAT(refusal(sun(rsms)),
               Contains("frame.lights[0].rsms[0].flux") && Contains("8 x 8") && Contains("8 x 7"));
    rsms[0] = ortho.rsm();
    rsms[0].normal = LWImage{};
    CHECK_THAT(refusal(sun(rsms)), Contains("rsms[0].normal"));
    rsms[0] = ortho.rsm();
    rsms[0].position.width = 0;
    CHECK_THAT(refusal(sun(rsms)), Contains("0 x 8"));
    rsms[0] = ortho.rsm();
    rsms[0].camera = LWCamera{};
    CHECK_THAT(refusal(sun(rsms)), Contains("rsms[0].camera.view"));
}

TEST_CASE("a refused frame leaves the last one's texels", "[rsm_input]") {
    KernelRig rig(16);
    Map map(8, 8, downward(0, 0, 4, 2, true), {0, 1, 0});
    std::vector<LWRsm> rsms{map.rsm(), map.rsm()};
    RsmInput input;
    const std::vector<LWRsm> good{rsms[0]};
    importLights(rig, {sun(good)}, input);
    rsms[1].flux.format = LW_FORMAT_UINT8;
    CHECK_THROWS(importLights(rig, {sun(rsms)}, input));
    CHECK(input.spans.size() == 1);
    CHECK(input.texelCount == 64);
    CHECK(input.texels.width == 128);
}
