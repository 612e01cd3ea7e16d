// What the host's triangles and surfels emit, on the device.
#include <catch2/catch.hpp>
#include <limits>
#include <string>
#include <vector>

#include "inputs/geometry_input.h"
#include "inputs/surfel_input.h"
#include "support/errors.h"
#include "support/host_image.h"
#include "support/paraboloid_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

std::uint64_t rejectedOf(KernelRig& rig, const SurfelInput& input) {
    Report report;
    input.report(report);
    rig.device().finish();
    report.resolve();
    for (const LWCount& c : report.counts)
        if (std::string(c.name) == "rejected_surfels") return c.value;
    return ~0ull;
}

}  // namespace

TEST_CASE("emission comes where it is asked for and given; what is no radiance is refused", "[geometry_input]") {
    KernelRig rig(16);
    Mesh mesh;
    for (int i = 0; i < 37; ++i) mesh.add(Vec{i * 1.0, 0, 0}, Vec{i + 0.5, 0, 0}, Vec{i * 1.0, 0.5, 0.25});
    std::vector<float> emission(3 * 37);
    for (std::size_t i = 0; i < emission.size(); ++i) emission[i] = 0.25f * float(i);
    GeometryInput input;
    LWGeometry g = mesh.geometry();
    input.import(rig.executor(), &g, true);
    CHECK(!input.hasEmission);
    CHECK(input.triangles.count == GeometryInput::kPlaneCount);
    CHECK(input.bytes() == GeometryInput::estimateBytes(37));
    g.triangleEmission = emission.data();
    input.import(rig.executor(), &g, false);
    CHECK(!input.hasEmission);
    input.import(rig.executor(), &g, true);
    rig.device().finish();
    CHECK(input.hasEmission);
    CHECK(input.revision > 1);
    CHECK(input.largestEmission == 0.25f * 110.0f);
    const std::size_t stride = input.triangles.width;
    std::vector<float> planes(stride * LW_TRIANGLE_EMISSIVE_PLANES);
    Buffer::retained(rig.device(), input.triangles.memory).download(0, planes.size() * sizeof(float), planes.data());
    for (std::size_t t = 0; t < 37; ++t)
        for (std::size_t c = 0; c < 3; ++c)
            CHECK(planes[(GeometryInput::kEmission + c) * stride + t] == emission[3 * input.hostIndices[t] + c]);
    CHECK(input.bytes() <= GeometryInput::estimateBytes(37, true));
    // Another emission is a change like any other.
    emission[7] = 100.0f;
    ++g.version;
    const std::uint64_t revision = input.revision;
    input.import(rig.executor(), &g, true);
    CHECK(input.revision == revision + 1);
    CHECK(input.largestEmission == 100.0f);
    for (const float bad : {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 2e20f}) {
        std::vector<float> wrong = emission;
        wrong[5] = bad;
        LWGeometry h = g;
        h.triangleEmission = wrong.data();
        const Thrown t = thrown([&] { input.import(rig.executor(), &h, true); });
        CHECK(t.status == LW_ERROR_INVALID_ARGUMENT);
        CHECK(t.says("frame.geometry.triangleEmission[5]: expected 0 .. 1e+20, got"));
        CHECK(thrown([&] { input.check(&h, true); }).message == t.message);
        input.check(&h);  // nobody asks
    }
    g.triangleEmission = nullptr;
    ++g.version;
    input.import(rig.executor(), &g, true);
    CHECK(!input.hasEmission);
    CHECK(input.largestEmission == 0.0f);
    rig.device().finish();
}

TEST_CASE("surfels' emission comes where it is asked for and given; those whose emission is no radiance are left out", "[surfel_input]") {
    KernelRig rig(GENERATE(1u, 16u));
    HostImage position(LW_FORMAT_FLOAT3, 45, 1), normal(LW_FORMAT_FLOAT3, 45, 1), area(LW_FORMAT_FLOAT1, 45, 1);
    HostImage emission(LW_FORMAT_FLOAT3, 45, 1);
    for (std::uint32_t i = 0; i < 45; ++i) {
        position.set(i, 0, i, 2.0 * i, -1.0);
        normal.set(i, 0, 0.0, 1.0, 0.0);
        area.set(i, 0, 0.01 * (i + 1));
        emission.set(i, 0, 0.5 * i, 0.0, 1.0);
    }
    emission.set(3, 0, -1.0, 0, 0);
    emission.set(4, 0, 0, std::numeric_limits<double>::quiet_NaN(), 0);
    emission.set(5, 0, 0, 0, std::numeric_limits<double>::infinity());
    SurfelInput input;
    LWGeometry g{};
    g.structSize = sizeof g;
    g.surfelCount = 45;
    g.surfelPosition = position.image();
    g.surfelNormal = normal.image();
    g.surfelArea = area.image();
    g.version = 1;
    input.import(rig.executor(), &g, true);
    CHECK(input.surfels().emission == nullptr);
    g.surfelEmission = emission.image();
    input.import(rig.executor(), &g);
    CHECK(input.surfels().emission == nullptr);
    CHECK(rejectedOf(rig, input) == 0);
    input.import(rig.executor(), &g, true);
    CHECK(rejectedOf(rig, input) == 3);
    const SurfelSet set = input.surfels();
    REQUIRE(set.emission);
    CHECK(set.revision > 1);
    float largest = 0.0f;
    set.emission->download(LW_SURFEL_LARGEST * sizeof(float), sizeof largest, &largest);
    CHECK(largest == 22.0f);
    const std::size_t stride = set.planes.width;
    std::vector<float> v(stride * LW_SURFEL_EMISSIVE_PLANES);
    Buffer::retained(rig.device(), set.planes.memory).download(0, v.size() * 4, v.data());
    for (std::size_t i = 0; i < stride; ++i) {
        const bool is = i < 45 && (i < 3 || i > 5);
        CHECK((v[LW_SURFEL_RADIUS * stride + i] > 0.0f) == is);
        CHECK(v[LW_SURFEL_EMISSION * stride + i] == (is ? 0.5f * float(i) : 0.0f));
        CHECK(v[(LW_SURFEL_EMISSION + 2) * stride + i] == (is ? 1.0f : 0.0f));
    }
    CHECK(input.bytes() <= SurfelInput::estimateBytes(45, true, true));
    HostImage grey(LW_FORMAT_FLOAT1, 45, 1);
    g.surfelEmission = grey.image();
    const Thrown t = thrown([&] { SurfelInput::check(rig.device(), &g, true); });
    CHECK(t.status == LW_ERROR_INVALID_ARGUMENT);
    CHECK(t.says("frame.geometry.surfelEmission"));
    SurfelInput::check(rig.device(), &g);
}
