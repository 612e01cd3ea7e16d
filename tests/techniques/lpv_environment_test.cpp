// Technique lpv under an even sky, through the C API: against the share of the sky that surfaces see, summed over rays in double.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "support/lpv_room.h"
#include "support/packed_light.h"
#include "support/scoped_api.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 29, kHeight = 16;
constexpr double kPi = 3.14159265358979323846;

LWLpvDesc descOf(LWLpvTransport transport, std::uint32_t size = 32) {
    LWLpvDesc desc;
    lwDefaultLpv(&desc);
    desc.size = size;
    desc.transport = transport;
    return desc;
}

LWFrame frameOf(const LWGeometry* geometry, float red, float green, float blue) {
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.geometry = geometry;
    frame.environment[0] = red;
    frame.environment[1] = green;
    frame.environment[2] = blue;
    return frame;
}

std::vector<float> render(LWDevice device, const LWLpvDesc& desc, const LWFrame& frame, const WallAndCeiling& scene) {
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    technique.update(frame);
    const LWStats stats = technique.stats();
    for (std::uint32_t i = 0; i < stats.choiceCount; ++i) CHECK(std::string(stats.choices[i].name) != "frame.environment");
    return technique.render(view, scene.gbuffer);
}

// Does a ray meet the unit room's floor (y = 0) or its back wall (z = 0)?
bool isHidden(Vec p, Vec d) {
    const auto inside = [](double x, double v) { return x > -0.5 && x < 0.5 && v > 0.0 && v < 1.0; };
    if (d.y < 0.0 && inside(p.x - d.x * p.y / d.y, p.z - d.z * p.y / d.y)) return true;
    return d.z < 0.0 && p.z > 0.0 && inside(p.x - d.x * p.z / d.z, p.y - d.y * p.z / d.z);
}

// Irradiance of a sky of radiance 1 on the ceiling's or the wall's points, of rays evenly spread over the projected hemisphere.
double skyAt(Vec p, Vec n) {
    constexpr int kRings = 64, kSteps = 256;
    const Vec u = std::abs(n.x) > 0.5 ? Vec{0, 1, 0} : Vec{1, 0, 0}, v{n.y * u.z - n.z * u.y, n.z * u.x - n.x * u.z, n.x * u.y - n.y * u.x};
    int seen = 0;
    for (int i = 0; i < kRings; ++i)
        for (int j = 0; j < kSteps; ++j) {
            const double r = std::sqrt((i + 0.5) / kRings), a = 2.0 * kPi * (j + 0.5) / kSteps;
            const Vec d = u * (r * std::cos(a)) + v * (r * std::sin(a)) + n * std::sqrt(1.0 - r * r);
            seen += !isHidden(p, d);
        }
    return kPi * seen / (kRings * kSteps);
}

}  // namespace

TEST_CASE("sweeps bring surfaces as much of the sky as they see of it", "[lpv][large]") {
    TestDevice device(GENERATE(1u, 16u));
    const RoomTriangles room(std::nullopt);
    WallAndCeiling scene(kWidth, kHeight);
    const auto light = render(device, descOf(LW_LPV_TRANSPORT_SWEEP), frameOf(&room.geometry, 2.0f, 0.0f, 0.5f), scene);
    double squared = 0.0, truths = 0.0, sum = 0.0, all = 0.0;
    for (std::uint32_t y = kHeight / 2; y < kHeight; ++y)
        for (std::uint32_t x = 1; x < kWidth; ++x) {
            const double truth = 2.0 * skyAt(scene.position.get(x, y), {0, -1, 0}), found = double(light[y * kWidth + x]);
            squared += (found - truth) * (found - truth);
            truths += truth * truth;
            sum += found;
            all += truth;
            CHECK(light[(kHeight + y) * kWidth + x] == 0.0f);
            CHECK(double(light[(2 * kHeight + y) * kWidth + x]) == Approx(found / 4.0).epsilon(1e-5));
        }
    CHECK(std::sqrt(squared / truths) < 0.1);
    CHECK(sum / all == Approx(1.0).margin(0.07));
}

TEST_CASE("a sky is linear, and what is closed under it is darker", "[lpv]") {
    TestDevice device(16);
    const auto transport = GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP);
    const RoomTriangles open(std::nullopt), closed(0.9);  // a lid just below the ceiling, over the floor
    WallAndCeiling scene(kWidth, kHeight);
    LWLpvDesc desc = descOf(transport, 16);
    const auto once = render(device, desc, frameOf(&open.geometry, 1.0f, 1.0f, 1.0f), scene),
               twice = render(device, desc, frameOf(&open.geometry, 2.0f, 2.0f, 2.0f), scene),
               lidded = render(device, desc, frameOf(&closed.geometry, 1.0f, 1.0f, 1.0f), scene);
    CHECK(meanOf(once) > 0.1);
    for (std::size_t i = 0; i < once.size(); ++i) REQUIRE(twice[i] == 2.0f * once[i]);
    CAPTURE(transport, meanOf(once), meanOf(lidded));
    CHECK(meanOf(lidded) < 0.95 * meanOf(once));
    CHECK(meanOf(render(device, desc, frameOf(&open.geometry, 0.0f, 0.0f, 0.0f), scene)) == 0.0);
}

TEST_CASE("a sky beyond all measure is refused by name, and what is just below it does no harm", "[lpv]") {
    TestDevice device(16);
    const auto transport = GENERATE(LW_LPV_TRANSPORT_PROPAGATE, LW_LPV_TRANSPORT_SWEEP);
    const LWLpvDesc desc = descOf(transport, 16);
    TestTechnique technique(device, "lpv", &desc);
    const RoomTriangles room(std::nullopt);
    for (const float radiance : {1.1e20f, std::numeric_limits<float>::max(), std::numeric_limits<float>::infinity(),
                                 std::numeric_limits<float>::quiet_NaN(), -1.0f}) {
        const LWFrame frame = frameOf(&room.geometry, 0.0f, radiance, 0.0f);
        CAPTURE(radiance);
        CHECK(lwUpdate(technique, &frame) == LW_ERROR_INVALID_ARGUMENT);
        CHECK_THAT(lastError(device), Contains("environment"));
    }
    WallAndCeiling scene(kWidth, kHeight);
    for (const float e : render(device, desc, frameOf(&room.geometry, 1e20f, 1e-20f, 1.0f), scene)) REQUIRE(std::isfinite(e));
}
