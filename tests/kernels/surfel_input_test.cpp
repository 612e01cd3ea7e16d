// Surfels of a host's arrays, of RSM texels and of G-buffer pixels: what they stand for, what is left out, what is refused.
#include "inputs/surfel_input.h"

#include <catch2/catch.hpp>
#include <limits>

#include "inputs/screen_surfels.h"
#include "support/errors.h"
#include "support/host_image.h"
#include "support/kernel_rig.h"
#include "support/lit_room.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

constexpr double kPi = 3.14159265358979323846;

struct Surfel {
    Vec position, normal;
    double area;  // 0: none
    std::uint32_t albedo;
    double channel(int c) const { return (albedo >> (10 * c) & 1023u) / 1023.0; }
};

std::vector<Surfel> downloaded(KernelRig& rig, const SurfelSet& set) {
    rig.device().finish();
    const std::size_t stride = set.planes.width;
    std::vector<float> v(stride * LW_SURFEL_PLANES);
    if (!v.empty()) Buffer::retained(rig.device(), set.planes.memory).download(0, v.size() * 4, v.data());
    std::vector<Surfel> surfels;
    for (std::size_t i = 0; i < stride; ++i) {
        const auto at = [&](std::size_t p) { return double(v[p * stride + i]); };
        Surfel s{{at(0), at(1), at(2)}, {at(3), at(4), at(5)}, kPi * at(6) * at(6), 0};
        std::memcpy(&s.albedo, &v[LW_SURFEL_ALBEDO * stride + i], 4);
        surfels.push_back(s);
    }
    return surfels;
}

std::uint64_t rejectedOf(KernelRig& rig, const SurfelInput& input) {
    Report report;
    input.report(report);
    rig.device().finish();
    report.resolve();
    for (const LWCount& c : report.counts)
        if (std::string(c.name) == "rejected_surfels") return c.value;
    return ~0ull;
}

double diagonalOf(KernelRig& rig, const SurfelSet& set) {
    rig.device().finish();
    float diagonal = 0.0f;
    set.diagonal->download(0, sizeof diagonal, &diagonal);
    return double(diagonal);
}

// A host's arrays in interleaved formats.
struct HostSurfels {
    HostImage position, normal, albedo, area;
    explicit HostSurfels(std::uint32_t count)
        : position(LW_FORMAT_FLOAT3, count, 1), normal(LW_FORMAT_FLOAT4, count, 1), albedo(LW_FORMAT_UNORM8X4, count, 1),
          area(LW_FORMAT_FLOAT1, count, 1) {
        for (std::uint32_t i = 0; i < count; ++i) {
            position.set(i, 0, i, 2.0 * i, -1.0);
            normal.set(i, 0, 0.0, 0.9, 0.0);
            albedo.set(i, 0, 0.2, 0.4, 1.0);
            area.set(i, 0, 0.01 * (i + 1));
        }
    }
    LWGeometry geometry() {
        LWGeometry g{};
        g.structSize = sizeof g;
        g.surfelCount = position.width();
        g.surfelPosition = position.image();
        g.surfelNormal = normal.image();
        g.surfelAlbedo = albedo.image();
        g.surfelArea = area.image();
        g.version = 1;
        return g;
    }
};

LWFrame frameOf(const LWLight* light, const LWSourceView* source) {
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.lights = light;
    frame.lightCount = light ? 1 : 0;
    frame.sourceViews = source;
    frame.sourceViewCount = source ? 1 : 0;
    return frame;
}

}  // namespace

TEST_CASE("a host's surfels as it described them; what cannot be used is left out and counted", "[surfel_input]") {
    KernelRig rig(GENERATE(1u, 16u));
    HostSurfels host(45);
    host.normal.set(3, 0, 0, 0, 0);  // none, not rejected
    host.normal.set(4, 0, 9, 0, 0);
    host.position.set(5, 0, std::numeric_limits<double>::quiet_NaN(), 0, 0);
    host.position.set(6, 0, 2e9, 0, 0);
    host.area.set(7, 0, 0.0);
    host.area.set(8, 0, -1.0);
    host.area.set(9, 0, std::numeric_limits<double>::infinity());
    host.area.set(10, 0, std::numeric_limits<double>::quiet_NaN());
    SurfelInput input;
    LWGeometry g = host.geometry();
    input.import(rig.executor(), &g);
    const std::vector<Surfel> surfels = downloaded(rig, input.surfels());
    CHECK(surfels.size() == 64);
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        CAPTURE(i);
        const bool is = i < 45 && (i < 3 || i > 10);
        CHECK((surfels[i].area > 0.0) == is);
        if (!is) continue;
        CHECK(surfels[i].area == Approx(0.01 * double(i + 1)).epsilon(1e-5));
        CHECK(surfels[i].position.y == 2.0 * double(i));
        CHECK(surfels[i].normal.y == Approx(1.0).epsilon(1e-5));
        CHECK(surfels[i].channel(0) == Approx(0.2).margin(0.003));
        CHECK(surfels[i].channel(2) == 1.0);
    }
    CHECK(rejectedOf(rig, input) == 7);
    CHECK(diagonalOf(rig, input.surfels()) == Approx(44.0 * std::sqrt(5.0)).epsilon(1e-6));
    CHECK(input.bytes() <= SurfelInput::estimateBytes(45, true));
}

TEST_CASE("a host's surfels are read again when their version or an image changed", "[surfel_input]") {
    KernelRig rig(16);
    HostSurfels host(40);
    SurfelInput input;
    LWGeometry g = host.geometry();
    input.import(rig.executor(), &g);
    const std::uint64_t first = input.surfels().revision;
    input.import(rig.executor(), &g);
    CHECK(input.surfels().revision == first);
    ++g.version;
    input.import(rig.executor(), &g);
    CHECK(input.surfels().revision != first);
    g.surfelAlbedo = LWImage{};
    input.import(rig.executor(), &g);
    CHECK(downloaded(rig, input.surfels())[0].channel(1) == Approx(0.5).margin(0.001));
    input.import(rig.executor(), nullptr);
    CHECK(input.surfels().count == 0);
    CHECK(diagonalOf(rig, input.surfels()) == 0.0);
}

TEST_CASE("surfels that are refused are refused by name, and the last stay in force", "[surfel_input]") {
    KernelRig rig(16);
    HostSurfels host(40);
    SurfelInput input;
    LWGeometry g = host.geometry();
    input.import(rig.executor(), &g);
    const std::uint64_t revision = input.surfels().revision;
    ++g.version;
    g.surfelArea = LWImage{};
    CHECK(thrown([&] { input.import(rig.executor(), &g); })
              .says("frame.geometry.surfelArea: expected an image of 40 x 1 pixels, one for each surfel, got none"));
    g = host.geometry();
    ++g.version;
    g.surfelCount = 39;
    CHECK(thrown([&] { SurfelInput::check(rig.device(), &g); }).says("frame.geometry.surfelPosition"));
    g.surfelCount = 1u << 30;
    CHECK(thrown([&] { SurfelInput::check(rig.device(), &g); }).says("frame.geometry.surfelCount: expected at most"));
    g = host.geometry();
    g.surfelNormal.format = LW_FORMAT_UINT8;
    CHECK(thrown([&] { SurfelInput::check(rig.device(), &g); }).says("frame.geometry.surfelNormal.format"));
    CHECK(input.surfels().revision == revision);
    CHECK(downloaded(rig, input.surfels())[0].area > 0.0);
}

TEST_CASE("RSM texels as surfels: their area is the floor's, their albedo what reflects", "[surfel_input]") {
    KernelRig rig(GENERATE(1u, 16u));
    LitFloor floor(40, [](double x, double) { return x < 0.0 ? 2.0 * 0.25 : 2.0 * 0.75; });
    const bool known = GENERATE(true, false);
    if (known) std::fill(std::begin(floor.light.irradiance), std::end(floor.light.irradiance), 2.0f);
    floor.normal.set(7, 7, {0, 0, 0});
    const LWFrame frame = frameOf(&floor.light, nullptr);
    RsmInput rsms;
    rsms.import(rig.executor(), frame);
    ScreenSurfels screen;
    screen.import(rig.executor(), frame, rsms);
    double area = 0.0;
    int count = 0, wrong = 0;
    for (const Surfel& s : downloaded(rig, screen.surfels())) {
        area += s.area;
        if (!(s.area > 0.0)) continue;
        ++count;
        const double expected = known ? (s.position.x < 0.0 ? 0.25 : 0.75) : 0.5;
        if (std::abs(s.channel(1) - expected) > 2e-3 || s.normal.y < 0.999) ++wrong;
    }
    CHECK(count == 40 * 40 - 1);
    CHECK(wrong == 0);
    CHECK(area == Approx(1.0 - 1.0 / 1600.0).epsilon(1e-4));
}

TEST_CASE("a spot's texels: what the cone leaves of the intensity is known", "[surfel_input]") {
    KernelRig rig(GENERATE(1u, 16u));
    // A lamp 2 m above the floor, looking down; 90 degrees wide.
    constexpr std::uint32_t kSize = 32;
    PlanarPixels position(kSize, kSize, 3), normal(kSize, kSize, 3), flux(kSize, kSize, 3);
    LWLight light{};
    light.structSize = sizeof light;
    light.kind = LW_LIGHT_SPOT;
    light.position[1] = 2.0f;
    light.direction[1] = -1.0f;
    light.innerConeAngle = 0.3f;
    light.outerConeAngle = 0.6f;
    std::fill(std::begin(light.radiantIntensity), std::end(light.radiantIntensity), 5.0f);
    for (std::uint32_t j = 0; j < kSize; ++j)
        for (std::uint32_t i = 0; i < kSize; ++i) {
            const double u = (i + 0.5) / kSize * 2.0 - 1.0, v = 1.0 - (j + 0.5) / kSize * 2.0, d2 = 1.0 + u * u + v * v;
            position.set(i, j, {2.0 * u, 0.0, -2.0 * v});
            normal.set(i, j, {0, 1, 0});
            const double cosine = 1.0 / std::sqrt(d2), inner = std::cos(0.3), outer = std::cos(0.6);
            const double ramp = std::min(1.0, std::max(0.0, (cosine - outer) / (inner - outer)));
            const double incident = 5.0 * ramp * ramp * 4.0 / (kSize * kSize) / (d2 * std::sqrt(d2));
            flux.set(i, j, Vec{0.6, 0.3, 0.1} * incident);
        }
    LWRsm rsm{};
    rsm.structSize = sizeof rsm;
    rsm.position = position.image();
    rsm.normal = normal.image();
    rsm.flux = flux.image();
    const float view[16] = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, -2, 0, 0, 0, 1};
    const float projection[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1.002f, -0.2f, 0, 0, -1, 0};
    std::copy_n(view, 16, rsm.camera.view);
    std::copy_n(projection, 16, rsm.camera.projection);
    light.rsmCount = 1;
    light.rsms = &rsm;
    const LWFrame frame = frameOf(&light, nullptr);
    RsmInput rsms;
    rsms.import(rig.executor(), frame);
    ScreenSurfels screen;
    screen.import(rig.executor(), frame, rsms);
    int lit = 0, dark = 0, wrong = 0;
    double area = 0.0;
    for (const Surfel& s : downloaded(rig, screen.surfels())) {
        area += s.area;
        if (!(s.area > 0.0)) continue;
        const double angle = std::atan(std::hypot(s.position.x, s.position.z) / 2.0);
        if (std::abs(angle - 0.6) < 0.02) continue;  // next to nothing over next to nothing
        (angle < 0.6 ? lit : dark) += 1;
        const Vec expected = angle < 0.6 ? Vec{0.6, 0.3, 0.1} : Vec{0.5, 0.5, 0.5};
        if (std::abs(s.channel(0) - expected.x) > 5e-3 || std::abs(s.channel(2) - expected.z) > 5e-3) ++wrong;
    }
    CHECK(lit > 300);
    CHECK(dark > 300);
    CHECK(wrong == 0);
    CHECK(area == Approx(16.0).epsilon(1e-3));
}

TEST_CASE("pixels as surfels: the area they span, nothing across edges, no background", "[surfel_input]") {
    KernelRig rig(GENERATE(1u, 16u));
    constexpr std::uint32_t kWidth = 37, kHeight = 20;
    PlanarPixels position(kWidth, kHeight, 3), normal(kWidth, kHeight, 3), albedo(kWidth, kHeight, 3);
    const Vec across{0.1, 0, 0}, down{0.02, -0.05, 0.03}, n = reference::unit({0, 0.03, 0.05});
    const double spanned = 0.1 * std::hypot(0.05, 0.03);
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = 0; x < kWidth; ++x) {
            // Two parallel planes a metre apart, and background, whose zero position lies on the first one.
            if (x < 2) continue;
            position.set(x, y, across * double(x) + down * double(y) + (x < 20 ? Vec{} : n * -1.0));
            normal.set(x, y, n);
            albedo.set(x, y, {0.25, 0.5, y == 3 ? -1.0 : 0.75});
        }
    LWGBuffer gbuffer{};
    gbuffer.structSize = sizeof gbuffer;
    gbuffer.position = position.image();
    gbuffer.normal = normal.image();
    const bool hasAlbedo = GENERATE(true, false);
    if (hasAlbedo) gbuffer.albedo = albedo.image();
    const LWSourceView source{nullptr, &gbuffer};
    const LWFrame frame = frameOf(nullptr, &source);
    RsmInput rsms;
    rsms.import(rig.executor(), frame);
    ScreenSurfels screen;
    screen.import(rig.executor(), frame, rsms);
    const std::vector<Surfel> surfels = downloaded(rig, screen.surfels());
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = 0; x < 48; ++x) {
            CAPTURE(x, y);
            const Surfel& s = surfels[y * 48 + x];
            if (x < 2 || x >= kWidth) {
                REQUIRE(s.area == 0.0);
                continue;
            }
            REQUIRE(s.area == Approx(spanned).epsilon(1e-3));
            REQUIRE(s.channel(2) == Approx(!hasAlbedo ? 0.5 : y == 3 ? 0.0 : 0.75).margin(1e-3));
        }
    CHECK(screen.bytes() <= ScreenSurfels::estimateBytes([&] {
              FrameShape shape;
              shape.sourcePixels = 48 * kHeight;
              return shape;
          }()));
    gbuffer.normal = LWImage{};
    CHECK(thrown([&] { ScreenSurfels::check(rig.device(), frame); }).says("frame.sourceViews[0].gbuffer.normal"));
}
