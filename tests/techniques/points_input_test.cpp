// What a host relies on with lwRenderPoints: refusals that say what was expected, points that cannot be used, any layout of images.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "support/host_image.h"
#include "support/points_makers.h"
#include "support/points_rig.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 33, kHeight = 32;

double evenProfile(double, double) { return 1.0; }

struct Room : PointRoom {
    Room() : PointRoom(32, evenProfile, kWidth, kHeight) {}
};

// Of a list of `count` points, all outputs as one host image would have them.
struct Call {
    std::vector<float> positions, normals, irradiance, harmonics, validity;
    LWImage position{}, normal{};
    LWPointOutput output{};
    explicit Call(std::uint32_t count)
        : positions(3 * count), normals(3 * count), irradiance(3 * count), harmonics(12 * count), validity(count) {
        for (std::uint32_t i = 0; i < count; ++i) normals[3 * i + 1] = -1.0f, positions[3 * i + 1] = 0.5f, positions[3 * i + 2] = 0.5f;
        position = listImage(positions, count, 1, LW_FORMAT_FLOAT3);
        normal = listImage(normals, count, 1, LW_FORMAT_FLOAT3);
        output.structSize = sizeof output;
        output.irradiance = listImage(irradiance, count, 1, LW_FORMAT_FLOAT3);
        output.harmonics = listImage(harmonics, count, 4, LW_FORMAT_FLOAT3);
        output.validity = listImage(validity, count, 1, LW_FORMAT_FLOAT1);
    }
    Call(const Call&) = delete;
};

}  // namespace

TEST_CASE("bad arguments are refused by name, and leave the technique as it was", "[points]") {
    TestDevice device(16);
    const Room room;
    TestTechnique technique(device, rsmDesc());
    Call call(5);
    const auto refuse = [&](LWStatus expected, const LWImage* position, const LWImage* normal, std::uint32_t count, const char* message) {
        CHECK(lwRenderPoints(technique, position, normal, count, &call.output) == expected);
        CHECK_THAT(lastError(device), Contains(message));
    };
    refuse(LW_ERROR_NOT_UPDATED, &call.position, &call.normal, 5, "lwUpdate");
    technique.update(room.frame);
    CHECK(lwRenderPoints(nullptr, &call.position, &call.normal, 5, &call.output) == LW_ERROR_INVALID_HANDLE);
    CHECK(lwRenderPoints(technique, &call.position, &call.normal, 5, nullptr) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("output: expected a struct, got null"));
    refuse(LW_ERROR_INVALID_ARGUMENT, nullptr, &call.normal, 5, "positions");
    refuse(LW_ERROR_INVALID_ARGUMENT, &call.position, nullptr, 5, "normals");
    refuse(LW_ERROR_INVALID_ARGUMENT, &call.position, &call.normal, 0, "count");
    refuse(LW_ERROR_INVALID_ARGUMENT, &call.position, &call.normal, 65535 * 64 + 1, "4194240");
    refuse(LW_ERROR_INVALID_ARGUMENT, &call.position, &call.normal, 6, "positions: expected 6 x 1 pixels, got 5 x 1");
    LWImage bad = call.position;
    bad.format = LW_FORMAT_FLOAT1;
    refuse(LW_ERROR_INVALID_ARGUMENT, &bad, &call.normal, 5, "positions");
    bad = call.normal;
    bad.height = 2;
    refuse(LW_ERROR_INVALID_ARGUMENT, &call.position, &bad, 5, "normals: expected 5 x 1 pixels, got 5 x 2");
    const LWPointOutput good = call.output;
    call.output.harmonics.height = 1;
    refuse(LW_ERROR_INVALID_ARGUMENT, &call.position, &call.normal, 5, "output.harmonics: expected 5 x 4 pixels, got 5 x 1");
    call.output = good;
    call.output.validity.host = nullptr;
    refuse(LW_ERROR_INVALID_ARGUMENT, &call.position, &call.normal, 5, "output.validity");
    call.output = LWPointOutput{};
    call.output.structSize = sizeof call.output;
    refuse(LW_ERROR_INVALID_ARGUMENT, &call.position, &call.normal, 5, "irradiance, harmonics or validity");
    call.output.structSize = 3;
    refuse(LW_ERROR_INVALID_ARGUMENT, &call.position, &call.normal, 5, "structSize");
    // No trace of it in the next good call.
    call.output = good;
    REQUIRE(lwRenderPoints(technique, &call.position, &call.normal, 5, &call.output) == LW_SUCCESS);
    CHECK(technique.count("points") == 5);
    CHECK(technique.count("rejected_points") == 0);
    CHECK(call.irradiance[0] > 0.0f);
}

TEST_CASE("techniques that look at a view's pixels say so, and which ones have light at points", "[points]") {
    TestDevice device(16);
    const Room room;
    Call call(3);
    std::vector<std::string> able;
    for (std::uint32_t i = 0; i < lwCountTechniques(); ++i) {
        LWTechniqueInfo info{};
        info.structSize = sizeof info;
        REQUIRE(lwDescribeTechnique(i, &info) == LW_SUCCESS);
        if (info.points) able.emplace_back(info.name);
    }
    for (const char* name : {"rsm", "ssvp", "lpv", "cone_tracing", "static_vpl", "fallback"}) CHECK(std::count(able.begin(), able.end(), name) == 1);
    CHECK(able.size() == 6);
    for (const char* name : {"screen_space", "horizon", "ao"}) {
        CAPTURE(name);
        TestTechnique technique(device, name, nullptr);
        technique.update(room.frame);
        CHECK(lwRenderPoints(technique, &call.position, &call.normal, 3, &call.output) == LW_ERROR_UNSUPPORTED);
        const std::string message = lastError(device);
        for (const char* part : {name, "rsm", "ssvp", "lpv", "fallback"}) CHECK_THAT(message, Contains(part));
        // Nor together with one that has.
        TestTechnique second(device, rsmDesc());
        LWFallbackDesc desc;
        lwDefaultFallback(&desc);
        desc.first = technique;
        desc.second = second;
        TestTechnique both(device, "fallback", &desc);
        CHECK(lwRenderPoints(both, &call.position, &call.normal, 3, &call.output) == LW_ERROR_UNSUPPORTED);
        CHECK_THAT(lastError(device), Contains(name));
    }
}

TEST_CASE("points that cannot be used have no light, no validity, and are counted", "[points]") {
    TestDevice device(GENERATE(1u, 16u));
    const Room room;
    PointList list;
    const double nan = std::nan("");
    list.add({0.0, 0.5, 0.5}, {0, -1, 0});
    list.add({nan, 0.5, 0.5}, {0, -1, 0});
    list.add({0.0, HUGE_VAL, 0.5}, {0, -1, 0});
    list.add({0.0, 2e9, 0.5}, {0, -1, 0});
    list.add({0.0, 0.5, 0.5}, {0, 0, 0});
    list.add({0.0, 0.5, 0.5}, {nan, 0, 0});
    list.add({0.0, 0.5, 0.5}, {0, -1.5, 0});  // is normalised
    const LWSsvpDesc* none = nullptr;
    const LWRsmDesc rsm = rsmDesc();
    const LWLpvDesc step = lpvDesc(LW_LPV_TRANSPORT_PROPAGATE), sweep = lpvDesc(LW_LPV_TRANSPORT_SWEEP);
    for (const auto& [name, desc] : {std::pair<const char*, const void*>{"rsm", &rsm}, {"ssvp", none}, {"lpv", &step}, {"lpv", &sweep}}) {
        CAPTURE(name);
        TestTechnique technique(device, name, desc);
        technique.update(room.frame);
        const PointLights with = renderPoints(device, technique, list);
        CHECK(technique.count("rejected_points") == 5);
        CHECK(with.validity == std::vector<float>{1, 0, 0, 0, 0, 0, 1});
        const PointLights without = renderPoints(device, technique, list, kPointHarmonics | kPointValidity, false);
        CHECK(technique.count("rejected_points") == 8);
        CHECK(without.validity == std::vector<float>{1, 0, 0, 0, 1, 1, 1});
        for (std::size_t i = 0; i < list.count(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                CHECK((with.validity[i] > 0.0f ? with.e(i, c) > 0.0 : with.e(i, c) == 0.0));
                for (std::size_t b = 0; b < 4; ++b) {
                    if (with.validity[i] == 0.0f) CHECK(with.band(b, i, c) == 0.0);
                    if (without.validity[i] == 0.0f) CHECK(without.band(b, i, c) == 0.0);
                    CHECK(std::isfinite(without.band(b, i, c)));
                }
            }
        technique.update(room.frame);
        CHECK(technique.count("rejected_points") == 0);
        CHECK(technique.count("points") == 0);
    }
}

TEST_CASE("images of any layout hold the same points and the same light", "[points]") {
    TestDevice device(16);
    const Room room;
    TestTechnique technique(device, rsmDesc());
    technique.update(room.frame);
    PointList list = PointList::ofScene(room.scene).part(500, 77);
    const PointLights expected = renderPoints(device, technique, list);
    struct Layouts {
        LWFormat in, out;
        HostLayout layout;
    };
    HostLayout gaps, aligned;
    gaps.pixelGap = 8;
    gaps.rowGap = 64;
    gaps.offset = 16;
    gaps.bottomUp = true;
    aligned.aligned = true;
    for (const Layouts& l : {Layouts{LW_FORMAT_FLOAT4, LW_FORMAT_FLOAT4, gaps}, Layouts{LW_FORMAT_PLANAR_FLOAT3, LW_FORMAT_PLANAR_FLOAT3, aligned},
                             Layouts{LW_FORMAT_PLANAR_FLOAT3, LW_FORMAT_PLANAR_FLOAT3, HostLayout{}}, Layouts{LW_FORMAT_FLOAT3, LW_FORMAT_FLOAT3, gaps}}) {
        CAPTURE(l.in, l.out);
        const std::uint32_t n = list.count();
        HostImage position(l.in, n, 1, l.layout), normal(l.in, n, 1, l.layout);
        HostImage irradiance(l.out, n, 1, l.layout), harmonics(l.out, n, 4, l.layout), validity(LW_FORMAT_FLOAT1, n, 1, l.layout);
        for (std::uint32_t i = 0; i < n; ++i) {
            const float *p = &list.positions[3 * i], *m = &list.normals[3 * i];
            position.set(i, 0, p[0], p[1], p[2]);
            normal.set(i, 0, m[0], m[1], m[2]);
        }
        LWPointOutput output{};
        output.structSize = sizeof output;
        output.irradiance = irradiance.image();
        output.harmonics = harmonics.image();
        output.validity = validity.image();
        const LWImage p = position.image(), m = normal.image();
        REQUIRE(lwRenderPoints(technique, &p, &m, n, &output) == LW_SUCCESS);
        REQUIRE(lwFinish(device) == LW_SUCCESS);
        bool same = true;
        for (std::uint32_t i = 0; i < n; ++i) {
            same = same && validity.value(i, 0, 0) == double(expected.validity[i]);
            for (std::uint32_t c = 0; c < 3; ++c) {
                same = same && irradiance.value(i, 0, c) == expected.e(i, c);
                for (std::uint32_t b = 0; b < 4; ++b) same = same && harmonics.value(i, b, c) == expected.band(b, i, c);
            }
        }
        CHECK(same);
    }
}
