// G-buffers in every format and layout against plain host loops; depth of every kind against an
// independent projection in double precision.
#include "inputs/gbuffer_input.h"

#include <array>
#include <catch2/catch.hpp>
#include <random>

#include "compute/error.h"
#include "inputs/read_planes.h"
#include "shared/srgb_table.h"
#include "support/camera_matrices.h"
#include "support/host_image.h"
#include "support/kernel_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

// Quantised normals are divided by their length: three roundings of float.
constexpr double kUnitTolerance = 4e-7;

std::vector<float> fetch(Device& device, const Planes& planes) {
    std::vector<float> values(std::size_t(planes.width) * planes.height * planes.count);
    readPlanes(device, planes, values.data());
    return values;
}

struct Triple {
    double v[3];
};

Triple randomUnit(std::mt19937& random) {
    std::normal_distribution<double> normal;
    Triple n{{normal(random), normal(random), normal(random)}};
    const double length = std::sqrt(n.v[0] * n.v[0] + n.v[1] * n.v[1] + n.v[2] * n.v[2]);
    for (double& c : n.v) c /= length;
    return n;
}

Triple normalised(Triple n) {
    const double length = std::sqrt(n.v[0] * n.v[0] + n.v[1] * n.v[1] + n.v[2] * n.v[2]);
    if (length < 0.5) return {{0, 0, 0}};
    for (double& c : n.v) c /= length;
    return n;
}

// What the bytes of a stored normal mean.
Triple decodeNormal(const HostImage& image, LWFormat format, std::uint32_t x, std::uint32_t y) {
    if (format == LW_FORMAT_UNORM8X4) {
        Triple n;
        for (int c = 0; c < 3; ++c) n.v[c] = image.get<std::uint8_t>(x, y, 0, c) / 255.0 * 2 - 1;
        return normalised(n);
    }
    if (format == LW_FORMAT_OCT16X2) {
        const int iu = image.get<std::int16_t>(x, y, 0, 0), iv = image.get<std::int16_t>(x, y, 0, 2);
        if (iu == -32768 && iv == -32768) return {{0, 0, 0}};
        const double u = std::fmax(iu / 32767.0, -1.0), v = std::fmax(iv / 32767.0, -1.0);
        Triple n{{u, v, 1 - std::fabs(u) - std::fabs(v)}};
        if (n.v[2] < 0) {
            n.v[0] = (1 - std::fabs(v)) * (u < 0 ? -1 : 1);
            n.v[1] = (1 - std::fabs(u)) * (v < 0 ? -1 : 1);
        }
        return normalised(n);
    }
    Triple n;
    for (int c = 0; c < 3; ++c) n.v[c] = image.value(x, y, c);
    return format == LW_FORMAT_HALF4 ? normalised(n) : n;
}

const std::array<HostLayout, 4> kLayouts = {HostLayout{}, HostLayout{12, 0, 32, false, false},
                                            HostLayout{0, 4, 0, true, false},
                                            HostLayout{0, 0, 0, false, true}};

// One round trip per width, format and layout.
void checkFormats(const std::array<std::uint32_t, 2>& size) {
    const auto width = GENERATE(1u, 16u);
    const auto format = GENERATE(LW_FORMAT_FLOAT3, LW_FORMAT_FLOAT4, LW_FORMAT_HALF4,
                                 LW_FORMAT_PLANAR_FLOAT3, LW_FORMAT_UNORM8X4, LW_FORMAT_OCT16X2);
    const auto layoutIndex = GENERATE(0u, 1u, 2u, 3u);
    KernelRig rig(width);
    const HostLayout& layout = kLayouts[layoutIndex];
    const bool quantised = format == LW_FORMAT_UNORM8X4 || format == LW_FORMAT_OCT16X2;
    HostImage position(quantised ? LW_FORMAT_FLOAT3 : format, size[0], size[1], layout);
    HostImage normal(format, size[0], size[1], layout);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-50.0, 50.0);
    for (std::uint32_t y = 0; y < size[1]; ++y)
        for (std::uint32_t x = 0; x < size[0]; ++x) {
            position.set(x, y, any(random), any(random), any(random));
            const Triple n = randomUnit(random);
            const double scale = (x + y) % 5 == 4 ? 0.0 : 1.0;  // some pixels without a surface
            normal.set(x, y, n.v[0] * scale, n.v[1] * scale, n.v[2] * scale, true);
        }
    View view(size[0] + 5, size[1] + 3);
    view.width = size[0];
    view.height = size[1];
    LWGBuffer gbuffer{};
    gbuffer.position = position.image();
    gbuffer.normal = normal.image();
    GBufferInput input;
    input.import(rig.executor(), view, gbuffer, 0, "gbuffer");
    rig.device().finish();
    const auto p = fetch(rig.device(), input.position), n = fetch(rig.device(), input.normal);
    const std::size_t plane = std::size_t(size[0]) * size[1];
    double worstPosition = 0, worstNormal = 0;
    for (std::uint32_t y = 0; y < size[1]; ++y)
        for (std::uint32_t x = 0; x < size[0]; ++x) {
            const Triple expected = decodeNormal(normal, format, x, y);
            for (int c = 0; c < 3; ++c) {
                const std::size_t at = c * plane + y * size[0] + x;
                worstPosition =
                    std::fmax(worstPosition, std::fabs(double(p[at]) - position.value(x, y, c)));
                worstNormal = std::fmax(worstNormal, std::fabs(double(n[at]) - expected.v[c]));
            }
        }
    CAPTURE(width, size[0], size[1], int(format), layoutIndex);
    CHECK(worstPosition == 0.0);
    const bool exact = !quantised && format != LW_FORMAT_HALF4;
    CHECK(worstNormal <= (exact ? 0.0 : kUnitTolerance));
    CHECK(position.damagedBytes() == 0);
    CHECK(normal.damagedBytes() == 0);
}

}  // namespace

TEST_CASE("positions and normals arrive in every format", "[gbuffer_input]") {
    checkFormats({33, 3});
}
TEST_CASE("one pixel arrives in every format", "[gbuffer_input]") {
    checkFormats({1, 1});
}
TEST_CASE("an image of odd size arrives in every format", "[gbuffer_input][large]") {
    checkFormats({257, 89});
}

TEST_CASE("the other images of a G-buffer", "[gbuffer_input]") {
    const auto width = GENERATE(1u, 16u);
    const auto format =
        GENERATE(LW_FORMAT_FLOAT3, LW_FORMAT_HALF4, LW_FORMAT_UNORM8X4, LW_FORMAT_UNORM8X4_SRGB);
    constexpr std::uint32_t w = 37, h = 7;
    KernelRig rig(width);
    const bool bytes = format == LW_FORMAT_UNORM8X4 || format == LW_FORMAT_UNORM8X4_SRGB;
    HostImage position(LW_FORMAT_FLOAT3, w, h), normal(LW_FORMAT_FLOAT3, w, h), albedo(format, w, h);
    HostImage radiance(bytes ? LW_FORMAT_PLANAR_FLOAT3 : format, w, h),
        roughness(LW_FORMAT_FLOAT1, w, h);
    const auto motionFormat = bytes ? LW_FORMAT_FLOAT2 : LW_FORMAT_PLANAR_FLOAT2;
    HostImage motion(motionFormat, w, h), mask(LW_FORMAT_UINT8, w, h);
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x) {
            const double code = (y * w + x) % 256 / 255.0;
            position.set(x, y, 1, 2, 3);
            normal.set(x, y, 0, 1, 0);
            albedo.set(x, y, code, 1 - code, code * code);
            radiance.set(x, y, 10 * code, code, 1e-3 * code);
            roughness.set(x, y, code);
            motion.set(x, y, x - 3.5, -1.0 * y);
            mask.set(x, y, x % 3 == 0 ? 0 : x);
        }
    LWGBuffer gbuffer{};
    gbuffer.position = position.image();
    gbuffer.normal = normal.image();
    gbuffer.albedo = albedo.image();
    gbuffer.directRadiance = radiance.image();
    gbuffer.roughness = roughness.image();
    gbuffer.motion = motion.image();
    gbuffer.receiveMask = mask.image();
    const std::uint32_t all =
        kNeedsAlbedo | kNeedsDirectRadiance | kNeedsRoughness | kNeedsMotion | kNeedsReceiveMask;
    const View view(w, h);
    GBufferInput input;
    input.import(rig.executor(), view, gbuffer, all, "gbuffer");
    rig.device().finish();
    const auto a = fetch(rig.device(), input.albedo), l = fetch(rig.device(), input.directRadiance),
               r = fetch(rig.device(), input.roughness), m = fetch(rig.device(), input.motion),
               k = fetch(rig.device(), input.receiveMask);
    constexpr std::size_t plane = w * h;
    // One rounding of the decoded byte to float.
    constexpr double kByteTolerance = 1e-7;
    double worst = 0;
    int wrong = 0;
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x) {
            const std::size_t at = y * w + x;
            for (int c = 0; c < 3; ++c) {
                double expected = 0;
                if (bytes) {
                    expected = albedo.get<std::uint8_t>(x, y, 0, c) / 255.0;
                    if (format == LW_FORMAT_UNORM8X4_SRGB)
                        expected = expected <= 0.04045 ? expected / 12.92
                                                       : std::pow((expected + 0.055) / 1.055, 2.4);
                } else {
                    expected = albedo.value(x, y, c);
                }
                worst = std::fmax(worst, std::fabs(double(a[c * plane + at]) - expected));
                if (double(l[c * plane + at]) != radiance.value(x, y, c)) ++wrong;
            }
            if (double(r[at]) != roughness.value(x, y, 0)) ++wrong;
            if (double(m[at]) != motion.value(x, y, 0) || double(m[plane + at]) != motion.value(x, y, 1))
                ++wrong;
            if (k[at] != (x % 3 == 0 ? 0.0f : 1.0f)) ++wrong;
        }
    CAPTURE(width, int(format));
    CHECK(worst <= (bytes ? kByteTolerance : 0.0));
    CHECK(wrong == 0);
}

TEST_CASE("the sRGB table is the sRGB curve", "[gbuffer_input]") {
    for (int code = 0; code < 256; ++code) {
        const double x = code / 255.0;
        const double expected = x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
        CHECK(lw_srgb_table[code] == float(expected));
    }
}

TEST_CASE("planar rows on 64-byte borders are used in place", "[gbuffer_input]") {
    const auto width = GENERATE(1u, 16u);
    const bool bottomUp = GENERATE(false, true);
    KernelRig rig(width);
    if (!rig.device().unifiedMemory()) return;
    constexpr std::uint32_t w = 33, h = 5;
    HostLayout layout;
    layout.aligned = true;
    layout.bottomUp = bottomUp;
    HostImage position(LW_FORMAT_PLANAR_FLOAT3, w, h, layout),
        normal(LW_FORMAT_PLANAR_FLOAT3, w, h, layout);
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x) {
            position.set(x, y, x, y, 5);
            normal.set(x, y, 0, 0, 1);
        }
    LWGBuffer gbuffer{};
    gbuffer.position = position.image();
    gbuffer.normal = normal.image();
    GBufferInput input;
    input.import(rig.executor(), View(w, h), gbuffer, 0, "gbuffer");
    rig.device().finish();
    CHECK(rig.profile().passes().empty());
    CHECK(input.bytes() == 0);
    CHECK(std::string(input.position.memory ? "set" : "") == "set");
    Report report;
    input.report(report);
    REQUIRE(report.choices.size() == 2);
    CHECK(std::string(report.choices[0].reason) == "planar, used in place");
    const auto p = fetch(rig.device(), input.position);
    for (std::uint32_t y = 0; y < h; ++y) CHECK(p[w * h + y * w + 7] == float(y));
}

TEST_CASE("depth of every kind becomes the position it came from", "[gbuffer_input]") {
    const auto width = GENERATE(1u, 16u);
    const int which = GENERATE(range(0, int(kTestCameraCount)));
    const int far = GENERATE(0, 1);
    KernelRig rig(width);
    constexpr std::uint32_t w = 61, h = 23;
    const TestCamera camera =
        testCamera(which, far ? glm::dvec3(4000, -2500, 8000) : glm::dvec3(1, 2, -3));
    for (const LWDepthKind kind : {LW_DEPTH_ZERO_TO_ONE, LW_DEPTH_GL, LW_DEPTH_AXIAL, LW_DEPTH_RADIAL}) {
        if (!camera.supports(kind)) continue;
        HostImage depth(LW_FORMAT_FLOAT1, w, h), normal(LW_FORMAT_OCT16X2, w, h);
        std::vector<glm::dvec3> truth(w * h);
        std::vector<double> tolerance(w * h);
        std::mt19937 random(3);
        std::uniform_real_distribution<double> distance(camera.near * 1.5, camera.far * 0.4);
        for (std::uint32_t y = 0; y < h; ++y)
            for (std::uint32_t x = 0; x < w; ++x) {
                const double axial = distance(random);
                const glm::dvec3 p = camera.point((x + 0.5) / w, (y + 0.5) / h, axial);
                depth.set(x, y, camera.depth(p, kind));
                normal.set(x, y, 0, 1, 0);
                // The depth's own rounding to float, moved through the projection, and the roundings of
                // matrices and position at the size of world coordinates (8 units in the last place).
                const double shift =
                    glm::length(camera.point((x + 0.5) / w, (y + 0.5) / h, axial * (1 + 1e-6)) - p) /
                    1e-6;
                const double slope = camera.depthSlope(axial, kind);  // depth per unit of distance
                const double rounding = std::ldexp(std::fabs(camera.depth(p, kind)) + 1e-30, -24);
                tolerance[y * w + x] =
                    3 * rounding / slope * shift / axial + std::ldexp(glm::length(p) + axial, -21);
                truth[y * w + x] = p;
            }
        LWGBuffer gbuffer{};
        gbuffer.depth = depth.image();
        gbuffer.depthKind = kind;
        gbuffer.normal = normal.image();
        gbuffer.camera = camera.matrices();
        GBufferInput input;
        input.import(rig.executor(), View(w, h), gbuffer, 0, "gbuffer");
        rig.device().finish();
        const auto p = fetch(rig.device(), input.position), n = fetch(rig.device(), input.normal);
        double worst = 0;
        int lost = 0;
        for (std::size_t i = 0; i < truth.size(); ++i) {
            const glm::dvec3 got(p[i], p[w * h + i], p[2 * w * h + i]);
            worst = std::fmax(worst, glm::length(got - truth[i]) / tolerance[i]);
            if (n[w * h + i] != 1.0f) ++lost;
        }
        CAPTURE(width, camera.name, int(kind), far);
        CHECK(worst <= 1.0);
        CHECK(lost == 0);
    }
}

TEST_CASE("background depth is no surface", "[gbuffer_input]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    constexpr std::uint32_t w = 5, h = 1;
    const float nan = std::numeric_limits<float>::quiet_NaN(),
                inf = std::numeric_limits<float>::infinity();
    const auto surfaces = [&](const TestCamera& camera, LWDepthKind kind,
                              const std::array<float, w>& depths) {
        HostImage depth(LW_FORMAT_FLOAT1, w, h), normal(LW_FORMAT_FLOAT3, w, h);
        for (std::uint32_t x = 0; x < w; ++x) {
            depth.set(x, 0, double(depths[x]));
            normal.set(x, 0, 0, 0, 1);
        }
        LWGBuffer gbuffer{};
        gbuffer.depth = depth.image();
        gbuffer.depthKind = kind;
        gbuffer.normal = normal.image();
        gbuffer.camera = camera.matrices();
        GBufferInput input;
        input.import(rig.executor(), View(w, h), gbuffer, 0, "gbuffer");
        rig.device().finish();
        const auto p = fetch(rig.device(), input.position), n = fetch(rig.device(), input.normal);
        std::string found;
        for (std::uint32_t x = 0; x < w; ++x) {
            found += n[2 * w + x] == 1.0f ? '1' : n[2 * w + x] == 0.0f ? '0' : '?';
            for (int c = 0; c < 3; ++c) CHECK(std::isfinite(p[c * w + x]));
        }
        return found;
    };
    // Infinite reversed depth: 0 lies at infinity.
    CHECK(surfaces(testCamera(kReversedInfinite, glm::dvec3(0)), LW_DEPTH_ZERO_TO_ONE,
                   {0.5f, 0.0f, nan, inf, -0.1f}) == "10000");
    CHECK(surfaces(testCamera(kRightHanded, glm::dvec3(0)), LW_DEPTH_AXIAL,
                   {2.0f, 0.0f, nan, inf, -1.0f}) == "10000");
    CHECK(surfaces(testCamera(kRightHanded, glm::dvec3(0)), LW_DEPTH_RADIAL,
                   {2.0f, 0.0f, nan, inf, 1e30f}) == "10000");
    // The reach of positions, 1e9 units from the origin.
    CHECK(surfaces(testCamera(kRightHanded, glm::dvec3(0)), LW_DEPTH_RADIAL,
                   {2.0f, 0.99e9f, 1.01e9f, 1e10f, 1.0f}) == "11001");
}

TEST_CASE("a G-buffer that can't be used is refused by name", "[gbuffer_input]") {
    KernelRig rig(16);
    constexpr std::uint32_t w = 20, h = 4;
    HostImage position(LW_FORMAT_FLOAT3, w, h), normal(LW_FORMAT_FLOAT3, w, h),
        depth(LW_FORMAT_FLOAT1, w, h);
    LWGBuffer good{};
    good.position = position.image();
    good.normal = normal.image();
    const auto refusal = [&](const LWGBuffer& gbuffer, std::uint32_t needs = 0) {
        GBufferInput input;
        try {
            input.import(rig.executor(), View(w, h), gbuffer, needs, "gbuffer");
        } catch (const Error& error) {
            CHECK(error.status() == LW_ERROR_INVALID_ARGUMENT);
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    using Catch::Matchers::Contains;
    CHECK(refusal(good) == "accepted");
    LWGBuffer bad = good;
    bad.normal = LWImage{};
    CHECK_THAT(refusal(bad), Contains("gbuffer.normal"));
    bad = good;
    bad.position = LWImage{};
    CHECK_THAT(refusal(bad), Contains("gbuffer: expected position or depth, got neither"));
    bad.depth = depth.image();  // zero matrices
    CHECK_THAT(refusal(bad), Contains("gbuffer.camera.view"));
    bad.camera = testCamera(kRightHanded, glm::dvec3(0)).matrices();
    CHECK(refusal(bad) == "accepted");
    bad.camera.projection[3] = std::numeric_limits<float>::quiet_NaN();
    CHECK_THAT(refusal(bad), Contains("gbuffer.camera.projection") && Contains("nan"));
    bad.camera = testCamera(kRightHanded, glm::dvec3(0)).matrices();
    for (int i = 8; i < 12; ++i) bad.camera.projection[i] = 0;
    CHECK_THAT(refusal(bad), Contains("invertible"));
    bad.camera = testCamera(kRightHanded, glm::dvec3(0)).matrices();
    setEnum(bad.depthKind, 9);
    CHECK_THAT(refusal(bad), Contains("gbuffer.depthKind") && Contains("9"));
    bad = good;
    bad.depth = depth.image();
    CHECK_THAT(refusal(bad), Contains("got both"));
    CHECK_THAT(refusal(good, kNeedsAlbedo), Contains("gbuffer.albedo"));

    const auto withPosition = [&](auto change) {
        LWGBuffer gbuffer = good;
        change(gbuffer.position);
        return refusal(gbuffer);
    };
    CHECK_THAT(withPosition([](LWImage& i) { i.format = LW_FORMAT_UNORM8X4; }),
               Contains("gbuffer.position.format") && Contains("LW_FORMAT_UNORM8X4"));
    CHECK_THAT(withPosition([](LWImage& i) { setEnum(i.format, 77); }), Contains("77"));
    CHECK_THAT(withPosition([](LWImage& i) { i.host = nullptr; }),
               Contains("exactly one of host and clMem"));
    CHECK_THAT(withPosition([](LWImage& i) { i.width = 19; }), Contains("20 x 4") && Contains("19 x 4"));
    CHECK_THAT(withPosition([](LWImage& i) { i.height = 0; }), Contains("20 x 0"));
    CHECK_THAT(withPosition([](LWImage& i) { i.bytePixelStride = 8; }), Contains("bytePixelStride"));
    CHECK_THAT(withPosition([](LWImage& i) { i.bytePixelStride = -12; }), Contains("bytePixelStride"));
    CHECK_THAT(withPosition([](LWImage& i) { i.bytePixelStride = 13; }),
               Contains("byteRowStride") || Contains("multiple of 4"));
    CHECK_THAT(withPosition([](LWImage& i) { i.byteRowStride = 100; }), Contains("byteRowStride"));
    CHECK_THAT(withPosition([](LWImage& i) { i.byteRowStride = -240; }), Contains("byteOffset"));
    CHECK_THAT(withPosition([](LWImage& i) { i.byteOffset = 2; }), Contains("multiple of 4"));
    CHECK_THAT(withPosition([](LWImage& i) { i.host = static_cast<const char*>(i.host) + 1; }),
               Contains("host"));
    for (const std::int64_t huge : {std::int64_t(1) << 40, std::int64_t(1) << 62, INT64_MAX, INT64_MIN,
                                    -(std::int64_t(1) << 61)}) {
        CHECK_THAT(withPosition([&](LWImage& i) { i.byteRowStride = huge; }),
                   Contains("gbuffer.position"));
        CHECK_THAT(withPosition([&](LWImage& i) { i.bytePixelStride = huge; }),
                   Contains("gbuffer.position"));
#if defined(__SANITIZE_ADDRESS__)
        // The address sanitizer has mapped terabytes around the heap: what lies 2^40 bytes on is there.
        if (huge == std::int64_t(1) << 40) continue;
#endif
        CHECK_THAT(withPosition([&](LWImage& i) { i.byteOffset = std::uint64_t(huge); }),
                   Contains("gbuffer.position"));
        CHECK_THAT(withPosition([&](LWImage& i) {
                       i.format = LW_FORMAT_PLANAR_FLOAT3;
                       i.bytePixelStride = i.byteRowStride = 0;
                       i.bytePlaneStride = huge;
                   }),
                   Contains("gbuffer.position"));
    }
}

TEST_CASE("device memory is checked and used", "[gbuffer_input]") {
    const auto width = GENERATE(1u, 16u);
    KernelRig rig(width);
    constexpr std::uint32_t w = 20, h = 4;
    std::vector<float> values(w * h * 3);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = float(i) * 0.5f;
    const Guarded memory = rig.upload(values);
    HostImage normal(LW_FORMAT_FLOAT3, w, h);
    for (std::uint32_t y = 0; y < h; ++y)
        for (std::uint32_t x = 0; x < w; ++x) normal.set(x, y, 0, 0, 1);
    LWGBuffer gbuffer{};
    gbuffer.normal = normal.image();
    gbuffer.position.clMem = memory.get();
    gbuffer.position.format = LW_FORMAT_FLOAT3;
    gbuffer.position.width = w;
    gbuffer.position.height = h;
    GBufferInput input;
    input.import(rig.executor(), View(w, h), gbuffer, 0, "gbuffer");
    rig.device().finish();
    const auto p = fetch(rig.device(), input.position);
    CHECK(p[0] == values[0]);
    CHECK(p[2 * w * h + w * h - 1] == values.back());

    using Catch::Matchers::Contains;
    gbuffer.position.byteOffset = 1 << 20;
    CHECK_THROWS_WITH(input.import(rig.executor(), View(w, h), gbuffer, 0, "gbuffer"),
                      Contains("gbuffer.position.clMem"));
    KernelRig other(width == 1 ? 16 : 1);
    gbuffer.position.byteOffset = 0;
    CHECK_THROWS_WITH(input.import(other.executor(), View(w, h), gbuffer, 0, "gbuffer"),
                      Contains("cl_context"));
}
