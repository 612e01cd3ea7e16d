// The light of VPLs at points, in two bands, against a serial sum in double and closed forms; which points have any.
#include <catch2/catch.hpp>
#include <limits>

#include "inputs/points_input.h"
#include "passes/interleaved_gather.h"
#include "reference/surfaces.h"
#include "shared/input_limits.h"
#include "support/kernel_rig.h"
#include "support/vpl_slots.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Image;
using reference::Vec;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
const double kPi = 3.14159265358979323846, kY0 = 0.5 / std::sqrt(kPi), kY1 = std::sqrt(3.0 / (4.0 * kPi));

struct Bands {
    std::vector<float> values;  // c0, c1.x, c1.y, c1.z one below the other; three planes
    int saturated = 0;
};

// `normal` null: points without normals.
Bands harmonicsOn(KernelRig& rig, const Image& position, const Image* normal, const std::vector<lw_vpl>& vpls, std::uint32_t n) {
    const std::uint32_t w = position.width, h = position.height;
    const Guarded p = rig.uploadPlanes(position.planes, w, h, 3, kNaN), list = rig.upload(vpls);
    const Guarded counts = rig.upload(std::vector<cl_int>{0, 0, 0}), out = rig.makePlanes(w, 4 * h, 3);
    const Guarded nr = rig.uploadPlanes(normal ? normal->planes : position.planes, w, h, 3, 1.0f);
    const Planes all = rig.planes(out, w, 4 * h, 3);
    Harmonics harmonics{all, cl_int(all.rowStride * h)};
    VplHarmonics pass(rig.device());
    pass.record(rig.executor(), rig.planes(p, w, h, 3), normal ? rig.planes(nr, w, h, 3) : Planes{}, list, orderOf(vpls.size(), n),
                harmonics, counts);
    rig.device().finish();
    return {rig.downloadPlanes(all), rig.download<cl_int>(counts)[2]};
}

// The irradiance of a surface that faces the VPL, and its direction.
Vec twin(const std::vector<lw_vpl>& vpls, Vec at, int band, bool valid) {
    Vec sum;
    if (!valid) return sum;
    for (const lw_vpl& vpl : vpls) {
        const Vec to = Vec{vpl.positionArea.s[0], vpl.positionArea.s[1], vpl.positionArea.s[2]} - at;
        if (dot(to, to) == 0.0) continue;
        const Vec d = unit(to), e = reference::vplIrradiance(vpl, {at, d, true});
        sum = sum + e * (band == 0 ? kY0 : kY1 * (band == 1 ? d.x : band == 2 ? d.y : d.z));
    }
    return sum;
}

std::vector<float> twins(const std::vector<lw_vpl>& vpls, const Image& position, const Image* normal) {
    Image out(position.width, 4 * position.height);
    for (std::uint32_t y = 0; y < position.height; ++y)
        for (std::uint32_t x = 0; x < position.width; ++x) {
            const bool valid = normal ? reference::surfaceAt(position, *normal, x, y).valid
                                      : std::isfinite(position.get(x, y).x + position.get(x, y).y + position.get(x, y).z);
            for (int b = 0; b < 4; ++b) out.set(x, y + std::uint32_t(b) * position.height, twin(vpls, position.get(x, y), b, valid));
        }
    return out.planes;
}

}  // namespace

TEST_CASE("VPLs' light in two bands equals its serial sum, dealt out or not, at every width", "[vpl_harmonics]") {
    const auto n = GENERATE(1u, 4u);
    const bool hasNormals = GENERATE(true, false);
    const auto size = testSize({67, 23});
    Image position(size.first, size.second), normal(size.first, size.second);
    reference::fillCorner(position, normal);
    position.set(3, 1, {kNaN, 0.0, 0.0});
    const auto vpls = reference::randomVpls(128, 7);
    const auto expected = twins(vpls, position, hasNormals ? &normal : nullptr);
    std::vector<float> first;
    for (const std::uint32_t width : {1u, 16u}) {
        CAPTURE(n, hasNormals, width);
        KernelRig rig(width);
        const Bands got = harmonicsOn(rig, position, hasNormals ? &normal : nullptr, vpls, n);
        CHECK(disagreement(got.values, expected) == "");
        CHECK(got.saturated == 0);
        if (first.empty()) first = got.values;
        CHECK(bitDifference(got.values, first) == "");
    }
}

TEST_CASE("one VPL: a disc's light on its axis", "[vpl_harmonics]") {
    KernelRig rig(GENERATE(1u, 16u));
    Image position(3, 1);
    const double radiance = 3.0, radius = 0.5, area = kPi * radius * radius, flux = kPi * radiance * area;
    const std::vector<lw_vpl> vpls = {reference::makeVpl({0, 0, 0}, {0, 0, 1}, {flux, 0.0, 2.0 * flux}, area),
                                      reference::makeVpl({0, 0, 0}, {0, 0, -1}, {flux, flux, flux}, area)};  // faces away
    for (const double r : {0.01, 0.5, 100.0}) {
        for (std::uint32_t x = 0; x < 3; ++x) position.set(x, 0, {0, 0, x == 2 ? 0.0 : r});
        const Bands got = harmonicsOn(rig, position, nullptr, vpls, 1);
        const double e = kPi * radiance * radius * radius / (r * r + radius * radius);
        const auto value = [&](std::size_t colour, std::size_t band, std::size_t x) { return double(got.values[3 * (4 * colour + band) + x]); };
        CHECK(value(0, 0, 1) == Approx(kY0 * e).epsilon(1e-5));
        CHECK(value(0, 3, 1) == Approx(-kY1 * e).epsilon(1e-5));  // towards the light: down
        CHECK(value(0, 1, 1) == 0.0);
        CHECK(value(1, 0, 1) == 0.0);
        CHECK(value(2, 0, 1) == Approx(2.0 * kY0 * e).epsilon(1e-5));
        CHECK(value(0, 0, 2) == 0.0);  // the VPL itself
    }
}

TEST_CASE("light beyond float's range is brought down and counted, opposite light of that kind is none", "[vpl_harmonics]") {
    KernelRig rig(GENERATE(1u, 16u));
    Image position(2, 1);
    position.set(1, 0, {1.0, 0.0, 0.0});
    const double flux = LW_LARGEST_FLUX;
    const std::vector<lw_vpl> vpls = {reference::makeVpl({0, 0, -1e-8}, {0, 0, 1}, {flux, flux, 1.0}, 0.0),
                                      reference::makeVpl({0, 0, 1e-8}, {0, 0, -1}, {flux, flux, 1.0}, 0.0)};
    const Bands got = harmonicsOn(rig, position, nullptr, vpls, 1);
    CHECK(got.saturated == 1);
    CHECK(got.values[0] == LW_LARGEST_IRRADIANCE);
    for (const float v : got.values) CHECK(std::abs(v) <= LW_LARGEST_IRRADIANCE);
}

TEST_CASE("which points can have light: lists in every number of rows", "[points_input]") {
    KernelRig rig(GENERATE(1u, 16u));
    const std::uint32_t count = GENERATE(1u, 5u, 255u, 256u, 257u, 1000u);
    const bool hasNormals = GENERATE(true, false);
    CAPTURE(count, hasNormals);
    std::vector<float> positions(4 * count, 1.0f), normals(4 * count);  // float4, whose fourth number is skipped
    std::vector<float> expected(count, 1.0f);
    cl_int bad = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        normals[4 * i + 1] = i % 7 == 3 ? 0.0f : 1.0f;
        if (i % 5 == 4) positions[4 * i + i % 3] = i % 2 ? kNaN : 2e9f;
        const bool isBad = i % 5 == 4 || (hasNormals && i % 7 == 3);
        if (isBad) expected[i] = 0.0f;
        bad += isBad ? 1 : 0;
    }
    LWImage position{}, normal{};
    position.host = positions.data();
    position.format = LW_FORMAT_FLOAT4;
    position.width = count;
    position.height = 1;
    if (hasNormals) {
        normal = position;
        normal.host = normals.data();
    }
    PointsInput points;
    points.import(rig.executor(), position, normal, count);
    const Guarded validity = rig.makePlanes(count, 1, 1), rejected = rig.upload(std::vector<cl_int>{0});
    const Planes planes = rig.planes(validity, count, 1, 1);
    points.recordCheck(rig.executor(), planes, rejected);
    points.recordCheck(rig.executor(), {}, rejected);
    rig.device().finish();
    CHECK(rig.downloadPlanes(planes) == expected);
    CHECK(rig.download<cl_int>(rejected)[0] == 2 * bad);
    CHECK(bool(points.normal) == hasNormals);
    CHECK(points.bytes() <= PointsInput::estimateBytes(count, !rig.device().unifiedMemory()));

    // A shorter list takes no more memory.
    const std::uint64_t before = points.bytes();
    position.width = 1;
    points.import(rig.executor(), position, {}, 1);
    rig.device().finish();
    CHECK(points.bytes() == before);
    CHECK(points.position.width == 1);
}

TEST_CASE("a list as rows: each point once, none beyond the list", "[points_input]") {
    for (const std::uint32_t count : {1u, 256u, 257u, 1048576u, 1048577u, PointsInput::kMost}) {
        std::uint64_t next = 0;
        eachPointRows(count, [&](const PointRows& rows) {
            CHECK(rows.first == next);
            CHECK(rows.first % 16 == 0);
            CHECK(rows.width <= PointRows::kWidth);
            CHECK(rows.height <= PointRows::kMostRows);
            CHECK((rows.height == 1 || rows.width == PointRows::kWidth));
            next += std::uint64_t(rows.width) * rows.height;
        });
        CHECK(next == count);
    }
}
