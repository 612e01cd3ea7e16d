// The host's triangles on the device: order, padding, what is refused, when it is uploaded.
#include "inputs/geometry_input.h"

#include <catch2/catch.hpp>
#include <limits>

#include "support/errors.h"
#include "support/paraboloid_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

std::vector<float> floatsOf(const cl_mem memory, Device& device, std::size_t count) {
    std::vector<float> values(count);
    Buffer::retained(device, memory).download(0, count * sizeof(float), values.data());
    return values;
}

Mesh scatter(int count) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const auto any = [&] { return Vec{unit(random), unit(random), unit(random)}; };
    Mesh mesh;
    for (int i = 0; i < count; ++i) {
        const Vec centre = any() * 10.0;
        mesh.add(centre + any(), centre + any(), centre + any());
    }
    return mesh;
}

// Whether one of the node's boxes holds the triangle.
bool isUnder(const std::vector<float>& node, const std::vector<float>& planes, std::size_t stride, std::size_t t) {
    for (std::size_t child = 0; child < LW_TREE_CHILDREN; ++child) {
        bool holds = true;
        for (std::size_t p = 0; p < 9; ++p)
            holds = holds && std::abs(planes[p * stride + t] - node[16 * (p % 3) + child]) <= node[LW_TREE_HALF + 16 * (p % 3) + child];
        if (holds) return true;
    }
    return false;
}

std::uint64_t uploads(KernelRig& rig) {
    rig.device().finish();
    std::uint64_t launches = 0;
    for (const LWPassTime& pass : rig.profile().passes())
        if (std::string(pass.name) == "geometry_input.upload") launches += pass.launches;
    return launches;
}

}  // namespace

TEST_CASE("every triangle once, as planes, under the tree's boxes", "[geometry_input]") {
    KernelRig rig(16);
    const Mesh mesh = scatter(301);
    GeometryInput input;
    const LWGeometry geometry = mesh.geometry();
    input.import(rig.executor(), &geometry);
    rig.device().finish();
    CHECK(input.triangleCount == 301);
    CHECK(input.triangles.width == 304);
    const std::size_t stride = std::size_t(input.triangles.planeStride);
    const std::vector<float> planes = floatsOf(input.triangles.memory, rig.device(), stride * GeometryInput::kPlaneCount);
    const std::vector<float> root = floatsOf(input.nodes.get(), rig.device(), LW_TREE_NODE);
    std::vector<int> seen(301);
    for (std::size_t t = 0; t < 304; ++t) {
        const std::size_t host = input.hostIndices[std::min<std::size_t>(t, 300)];
        if (t < 301) ++seen[host];
        for (std::size_t p = 0; p < 9; ++p)
            CHECK(planes[p * stride + t] == mesh.vertices[9 * host + (t < 301 ? p : p % 3)]);
        for (std::size_t c = 0; c < 3; ++c) CHECK(planes[(9 + c) * stride + t] == mesh.albedo[3 * host + c]);
        CHECK(isUnder(root, planes, stride, t));
    }
    for (const int times : seen) CHECK(times == 1);
    CHECK(input.bytes() == GeometryInput::estimateBytes(301));
}

TEST_CASE("indices, and grey where no albedo is given", "[geometry_input]") {
    KernelRig rig(16);
    const std::vector<float> corners = {0, 0, 0, 3, 0, 0, 0, 4, 0, 3, 4, 12};
    const std::vector<std::uint32_t> indices = {0, 1, 2, 1, 3, 2};
    LWGeometry g{};
    g.vertices = corners.data();
    g.indices = indices.data();
    g.vertexCount = 4;
    g.triangleCount = 2;
    GeometryInput input;
    input.import(rig.executor(), &g);
    rig.device().finish();
    REQUIRE(input.triangleCount == 2);
    CHECK(input.diagonal == 13.0f);
    const std::size_t stride = std::size_t(input.triangles.planeStride);
    const std::vector<float> planes = floatsOf(input.triangles.memory, rig.device(), stride * 12);
    for (std::size_t c = 0; c < 3; ++c) CHECK(planes[(9 + c) * stride] == 0.5f);
    for (std::size_t t = 0; t < 2; ++t)
        for (std::size_t p = 0; p < 9; ++p)
            CHECK(planes[p * stride + t] == corners[3 * indices[3 * input.hostIndices[t] + p / 3] + p % 3]);
}

TEST_CASE("triangles that cannot be drawn are left out, those with wild corners counted", "[geometry_input]") {
    KernelRig rig(16);
    const double infinity = std::numeric_limits<double>::infinity(), none = std::numeric_limits<double>::quiet_NaN();
    Mesh mesh;
    mesh.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    mesh.add({none, 0, 0}, {1, 0, 0}, {0, 1, 0});
    mesh.add({0, 0, 0}, {1, infinity, 0}, {0, 1, 0});
    mesh.add({0, 0, 0}, {1, 0, 0}, {0, 1.1e9, 0});
    mesh.add({0, 0, 0}, {1, 1, 1}, {2, 2, 2});  // no area
    mesh.add({1, 1, 1}, {1, 1, 1}, {1, 1, 1});
    GeometryInput input;
    const LWGeometry geometry = mesh.geometry();
    input.import(rig.executor(), &geometry);
    CHECK(input.hostIndices == std::vector<std::uint32_t>{0});
    CHECK(input.diagonal == std::sqrt(2.0f));
    Report report;
    input.report(report);
    REQUIRE(report.counts.size() == 2);
    CHECK(report.counts[0].value == 1);
    CHECK(std::string(report.counts[1].name) == "rejected_triangles");
    CHECK(report.counts[1].value == 3);
}

TEST_CASE("uploaded again only when something changed; host memory is the host's after the call", "[geometry_input]") {
    KernelRig rig(16);
    Mesh mesh = scatter(40);
    GeometryInput input;
    const auto import = [&] {
        const LWGeometry g = mesh.geometry();
        input.import(rig.executor(), &g);
        return uploads(rig);
    };
    input.import(rig.executor(), nullptr);
    CHECK(uploads(rig) == 0);
    CHECK(input.triangleCount == 0);
    CHECK(import() == 3);
    const std::uint64_t revision = input.revision;
    mesh.vertices[0] += 1.0f;  // nobody said so
    CHECK(import() == 3);
    CHECK(input.revision == revision);
    ++mesh.version;
    CHECK(import() == 6);
    CHECK(input.revision == revision + 1);
    ++mesh.version;  // and nothing else
    CHECK(import() == 6);
    CHECK(input.revision == revision + 1);
    mesh = Mesh{};
    CHECK(import() == 6);
    CHECK(input.revision > revision + 2);  // all went: no boxes around it
    CHECK((input.triangleCount == 0 && input.diagonal == 0.0f && !input.triangles));
    {
        const Mesh brief = scatter(40);
        const LWGeometry g = brief.geometry();
        input.import(rig.executor(), &g);
    }
    rig.device().finish();
    const std::vector<float> first = floatsOf(input.triangles.memory, rig.device(), 1);
    CHECK(first[0] == scatter(40).vertices[9 * input.hostIndices[0]]);
}

TEST_CASE("of a geometry in force nothing is read again", "[geometry_input]") {
    KernelRig rig(16);
    const Mesh mesh = scatter(3);
    std::vector<std::uint32_t> indices = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    LWGeometry g = mesh.geometry();
    g.indices = indices.data();
    GeometryInput input;
    input.check(&g);
    input.import(rig.executor(), &g);
    indices[5] = 9;
    input.check(&g);
    input.import(rig.executor(), &g);
    CHECK(input.revision == 1);
    ++g.version;
    CHECK(thrown([&] { input.check(&g); }).says("frame.geometry.indices[5]"));
}

TEST_CASE("what is wrong with a geometry is said, and the last one stays", "[geometry_input]") {
    KernelRig rig(16);
    const Mesh mesh = scatter(3);
    GeometryInput input;
    const LWGeometry good = mesh.geometry();
    input.import(rig.executor(), &good);
    const std::vector<std::uint32_t> indices = {0, 1, 2, 3, 4, 9, 6, 7, 8};
    std::vector<float> albedo = mesh.albedo;
    const auto refusal = [&](auto change) {
        LWGeometry g = good;
        g.version = 99;
        change(g);
        const Thrown t = thrown([&] { input.import(rig.executor(), &g); });
        CHECK(t.status == LW_ERROR_INVALID_ARGUMENT);
        CHECK(t.message == thrown([&] { input.check(&g); }).message);
        CHECK(input.triangleCount == 3);
        CHECK(input.revision == 1);
        return t.message;
    };
    CHECK(refusal([](LWGeometry& g) { g.vertices = nullptr; }) ==
          "frame.geometry.vertices: expected the vertices of 3 triangles, got null");
    CHECK(refusal([](LWGeometry& g) { g.vertexCount = 8; }) ==
          "frame.geometry.vertexCount: expected 9, three for each triangle as there are no indices, got 8");
    CHECK(refusal([&](LWGeometry& g) { g.indices = indices.data(); }) ==
          "frame.geometry.indices[5]: expected less than the vertexCount of 9, got 9");
    CHECK(refusal([](LWGeometry& g) { g.triangleCount = 0xffffffffu; }).find("triangleCount: expected at most") !=
          std::string::npos);
    albedo[4] = 1.5f;
    CHECK(refusal([&](LWGeometry& g) { g.triangleAlbedo = albedo.data(); }) ==
          "frame.geometry.triangleAlbedo[4]: expected 0 .. 1, got 1.5");
    albedo[4] = std::numeric_limits<float>::quiet_NaN();
    CHECK(refusal([&](LWGeometry& g) { g.triangleAlbedo = albedo.data(); }).find("triangleAlbedo[4]") != std::string::npos);
    CHECK(thrown([] { GeometryInput::estimateBytes(0xffffffffu); }).says("triangleCount: expected at most"));
}

TEST_CASE("boxes around what changed, between lists of any lengths", "[geometry_input]") {
    KernelRig rig(16);
    Mesh mesh = scatter(200);
    GeometryInput input;
    const auto changedAfter = [&](std::size_t first, std::size_t count, double by) {
        const Mesh before = mesh;
        for (std::size_t i = 9 * first; i < 9 * (first + count); ++i) mesh.vertices[i] += float(by);
        ++mesh.version;
        const LWGeometry g = mesh.geometry();
        input.import(rig.executor(), &g);
        rig.device().finish();
        const std::vector<float> node = floatsOf(input.changes.get(), rig.device(), LW_TREE_NODE);
        for (const Mesh* m : {&before, static_cast<const Mesh*>(&mesh)})
            for (std::size_t t = first; t < first + count; ++t) {
                std::vector<float> corners(&m->vertices[9 * t], &m->vertices[9 * t] + 9);
                CHECK(isUnder(node, corners, 1, 0));
            }
        double volume = 0.0;
        for (std::size_t child = 0; child < LW_TREE_CHILDREN; ++child)
            if (const float* const half = &node[LW_TREE_HALF + child]; half[0] >= 0.0f)
                volume += 8.0 * double(half[0]) * double(half[16]) * double(half[32]);
        return volume;
    };
    changedAfter(0, 200, 0.0);
    CHECK(changedAfter(3, 1, 0.1) < 2.2 * 2.2 * 2.2);  // a triangle reaches over at most 2 a side
    CHECK(changedAfter(0, 90, 0.5) > 100.0);
    const std::uint64_t revision = input.revision;
    mesh.vertices.resize(9 * 150);  // those after the last went
    ++mesh.version;
    const LWGeometry fewer = mesh.geometry();
    input.import(rig.executor(), &fewer);
    CHECK((input.triangleCount == 150 && input.revision == revision + 1));
}

TEST_CASE("after it was forgotten geometry is brought again, none of it too, and what changed is not known", "[geometry_input]") {
    KernelRig rig(16);
    const Mesh mesh = scatter(40);
    GeometryInput input;
    const LWGeometry g = mesh.geometry();
    input.import(rig.executor(), &g);
    const std::uint64_t revision = input.revision, before = uploads(rig);
    input.forget();
    input.import(rig.executor(), &g);
    CHECK(input.revision > revision + 1);
    CHECK(uploads(rig) > before);
    input.forget();
    input.import(rig.executor(), nullptr);
    CHECK((input.triangleCount == 0 && !input.triangles));
}
