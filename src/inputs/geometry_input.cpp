// All of it is done on the host, once for a version of the geometry: what is static costs nothing per frame.
#include "inputs/geometry_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <glm/glm.hpp>

#include "compute/device.h"
#include "compute/error.h"
#include "inputs/triangle_tree.h"
#include "shared/input_limits.h"

namespace lightwell {
namespace {

// Indices of floats in the planes are 32-bit in kernels.
constexpr std::uint32_t kMaxTriangles = 0x7fffffffu / LW_TRIANGLE_EMISSIVE_PLANES / 256 * 256;
constexpr float kDefaultAlbedo = 0.5f;

using Triangle = HostTriangle;

std::uint32_t vertexOf(const LWGeometry& g, std::size_t corner) {
    return g.indices ? g.indices[corner] : std::uint32_t(corner);
}

Triangle readTriangle(const LWGeometry& g, std::uint32_t t, bool withEmission) {
    Triangle triangle{t, {}};
    for (std::size_t corner = 0; corner < 3; ++corner)
        for (std::size_t c = 0; c < 3; ++c)
            triangle.values[3 * corner + c] = g.vertices[3 * std::size_t(vertexOf(g, 3 * std::size_t(t) + corner)) + c];
    const float* albedo = g.triangleAlbedo ? g.triangleAlbedo + 3 * std::size_t(t) : nullptr;
    for (std::size_t c = 0; c < 3; ++c) triangle.values[LW_TRIANGLE_ALBEDO + c] = albedo ? albedo[c] : kDefaultAlbedo;
    const float* emission = withEmission && g.triangleEmission ? g.triangleEmission + 3 * std::size_t(t) : nullptr;
    for (std::size_t c = 0; c < 3; ++c) triangle.values[LW_TRIANGLE_EMISSION + c] = emission ? emission[c] : 0.0f;
    return triangle;
}

glm::dvec3 cornerOf(const Triangle& t, std::size_t corner) {
    return {double(t.values[3 * corner]), double(t.values[3 * corner + 1]), double(t.values[3 * corner + 2])};
}

bool isWithinReach(const Triangle& t) {
    for (std::size_t corner = 0; corner < 3; ++corner)
        if (!(glm::length(cornerOf(t, corner)) <= double(LW_LARGEST_DISTANCE))) return false;
    return true;
}

double areaOf(const Triangle& t) {
    const glm::dvec3 a = cornerOf(t, 0);
    return 0.5 * glm::length(glm::cross(cornerOf(t, 1) - a, cornerOf(t, 2) - a));
}

struct Bounds {
    glm::dvec3 lower{std::numeric_limits<double>::infinity()}, upper{-std::numeric_limits<double>::infinity()};
    void add(const Triangle& t) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            lower = glm::min(lower, cornerOf(t, corner));
            upper = glm::max(upper, cornerOf(t, corner));
        }
    }
    double diagonal() const { return glm::length(upper - lower); }
};

TriangleBox boxOf(const Triangle& t) {
    TriangleBox box;
    const auto& v = t.values;
    for (std::size_t c = 0; c < 3; ++c) {
        box.lower[c] = std::min({v[c], v[3 + c], v[6 + c]});
        box.upper[c] = std::max({v[c], v[3 + c], v[6 + c]});
    }
    return box;
}

// Of what differs between two lists in the host's order, there before and now.
std::vector<TriangleBox> changedBoxes(const std::vector<Triangle>& before, const std::vector<Triangle>& now) {
    std::vector<TriangleBox> boxes;
    std::size_t i = 0, j = 0;
    while (i < before.size() || j < now.size()) {
        const bool went = j == now.size() || (i < before.size() && before[i].host <= now[j].host);
        const bool came = i == before.size() || (j < now.size() && now[j].host <= before[i].host);
        if (!went || !came || before[i].values != now[j].values) {
            if (went) boxes.push_back(boxOf(before[i]));
            if (came) boxes.push_back(boxOf(now[j]));
        }
        if (went) ++i;
        if (came) ++j;
    }
    return boxes;
}

// The tree over the triangles, whose order depends on their own values alone: maps then hold the same bits in whatever
// order the host keeps them.
TriangleTree growTree(const std::vector<Triangle>& drawn) {
    std::vector<TriangleBox> boxes(drawn.size());
    std::transform(drawn.begin(), drawn.end(), boxes.begin(), boxOf);
    return triangleTreeOf(boxes, [&](std::uint32_t a, std::uint32_t b) {
        return drawn[a].values != drawn[b].values ? drawn[a].values < drawn[b].values : drawn[a].host < drawn[b].host;
    });
}

void checkArrays(const LWGeometry& g, bool withEmission) {
    constexpr const char* kName = "frame.geometry";
    if (g.triangleCount > kMaxTriangles)
        fail(LW_ERROR_INVALID_ARGUMENT, kName, ".triangleCount: expected at most ", kMaxTriangles, ", got ",
             g.triangleCount);
    if (!g.vertices)
        fail(LW_ERROR_INVALID_ARGUMENT, kName, ".vertices: expected the vertices of ", g.triangleCount,
             " triangles, got null");
    if (!g.indices && g.vertexCount != 3 * std::uint64_t(g.triangleCount))
        fail(LW_ERROR_INVALID_ARGUMENT, kName, ".vertexCount: expected ", 3 * std::uint64_t(g.triangleCount),
             ", three for each triangle as there are no indices, got ", g.vertexCount);
    if (g.indices)
        for (std::size_t i = 0; i < 3 * std::size_t(g.triangleCount); ++i)
            if (g.indices[i] >= g.vertexCount)
                fail(LW_ERROR_INVALID_ARGUMENT, kName, ".indices[", i, "]: expected less than the vertexCount of ",
                     g.vertexCount, ", got ", g.indices[i]);
    if (g.triangleAlbedo)
        for (std::size_t i = 0; i < 3 * std::size_t(g.triangleCount); ++i)
            if (!(g.triangleAlbedo[i] >= 0.0f && g.triangleAlbedo[i] <= 1.0f))
                fail(LW_ERROR_INVALID_ARGUMENT, kName, ".triangleAlbedo[", i, "]: expected 0 .. 1, got ",
                     g.triangleAlbedo[i]);
    if (withEmission && g.triangleEmission)
        for (std::size_t i = 0; i < 3 * std::size_t(g.triangleCount); ++i)
            if (!(g.triangleEmission[i] >= 0.0f && g.triangleEmission[i] <= LW_LARGEST_EMISSION))
                fail(LW_ERROR_INVALID_ARGUMENT, kName, ".triangleEmission[", i, "]: expected 0 .. ", LW_LARGEST_EMISSION, ", got ",
                     g.triangleEmission[i]);
}

// The triangles that cover anything.
std::vector<Triangle> drawnTriangles(const LWGeometry& g, bool withEmission, Bounds& bounds, std::uint32_t& rejected) {
    std::vector<Triangle> triangles;
    triangles.reserve(g.triangleCount);
    for (std::uint32_t t = 0; t < g.triangleCount; ++t) {
        const Triangle triangle = readTriangle(g, t, withEmission);
        if (!isWithinReach(triangle)) {
            ++rejected;
        } else if (areaOf(triangle) > 0.0) {
            bounds.add(triangle);
            triangles.push_back(triangle);
        }
    }
    return triangles;
}

void shareOut(const std::vector<Triangle>& drawn, const std::vector<std::uint32_t>& order, double& area,
              std::vector<std::uint32_t>& shares) {
    area = 0.0;
    for (const std::uint32_t t : order) area += areaOf(drawn[t]);
    shares.clear();
    shares.reserve(drawn.size());
    double upTo = 0.0;
    for (const std::uint32_t t : order) {
        upTo += areaOf(drawn[t]);
        shares.push_back(std::uint32_t(std::min(upTo / area * 4294967296.0, 4294967295.0)));
    }
    if (!shares.empty()) shares.back() = 0xffffffffu;
}

std::uint32_t paddedTo16(std::uint64_t count) { return std::uint32_t((count + 15) / 16 * 16); }

}  // namespace

bool GeometryInput::Key::operator==(const Key& other) const {
    return vertices == other.vertices && indices == other.indices && albedo == other.albedo &&
           emission == other.emission && vertexCount == other.vertexCount && triangleCount == other.triangleCount && version == other.version;
}

GeometryInput::Key GeometryInput::keyOf(const LWGeometry* g, bool withEmission) {
    if (!g || g->triangleCount == 0) return Key{};
    return {g->vertices,    g->indices,       g->triangleAlbedo, withEmission ? g->triangleEmission : nullptr,
            g->vertexCount, g->triangleCount, g->version};
}

void GeometryInput::check(const LWFrame& frame, bool withEmission) const {
    const double(&at)[3] = frame.worldOrigin;
    check(frame.geometry, withEmission, {at[0], at[1], at[2]});
}

void GeometryInput::check(const LWGeometry* geometry, bool withEmission, const WorldOrigin& origin) const {
    const bool isInForce = keyOf(geometry, withEmission) == key_ && origin == origin_;
    if (geometry && geometry->triangleCount && !isInForce) checkArrays(*geometry, withEmission);
}

void GeometryInput::forget() {
    key_ = Key{};
    isForgotten_ = true;
}

void GeometryInput::import(Executor& executor, const LWGeometry* geometry, bool withEmission) {
    const Key key = keyOf(geometry, withEmission);
    if (key == key_ && executor.worldOrigin() == origin_ && !isForgotten_) return;
    if (key.triangleCount) checkArrays(*geometry, withEmission);
    Bounds bounds;
    std::uint32_t rejected = 0;
    std::vector<Triangle> drawn;
    if (key.triangleCount) drawn = drawnTriangles(*geometry, withEmission, bounds, rejected);
    const std::vector<TriangleBox> changed = changedBoxes(drawn_, drawn);
    if (!changed.empty() || isForgotten_) {
        const TriangleTree tree = growTree(drawn);
        // Where about all is new, boxes around it cost the host a quarter of what the tree does, and would be everywhere.
        const bool isKnown = !isForgotten_ && changed.size() <= drawn.size();
        float largest = 0.0f;
        for (const Triangle& t : drawn)
            for (std::size_t c = 0; c < 3; ++c) largest = std::max(largest, t.values[LW_TRIANGLE_EMISSION + c]);
        upload(executor, drawn, tree.order, tree.nodes, isKnown ? boxesAround(changed) : std::vector<float>(), key.emission != nullptr);
        largestEmission = largest;
        triangleCount = std::uint32_t(drawn.size());
        nodeCount = std::uint32_t(tree.nodes.size() / LW_TREE_NODE);
        diagonal = drawn.empty() ? 0.0f : float(bounds.diagonal());
        revision += isKnown ? 1 : 2;
        isForgotten_ = false;
        hostIndices.clear();
        for (const std::uint32_t t : tree.order) hostIndices.push_back(drawn[t].host);
        shareOut(drawn, tree.order, area, areaShares);
        drawn_ = std::move(drawn);
    }
    key_ = key;
    origin_ = executor.worldOrigin();
    rejected_ = rejected;
}

void GeometryInput::upload(Executor& executor, const std::vector<Triangle>& drawn, const std::vector<std::uint32_t>& order,
                           const std::vector<float>& treeNodes, const std::vector<float>& changed, bool withEmission) {
    const std::uint32_t padded = paddedTo16(drawn.size());
    const std::size_t planeCount = withEmission ? LW_TRIANGLE_EMISSIVE_PLANES : kPlaneCount;
    std::vector<float> planes(padded * planeCount);
    // Padding repeats the last triangle's first vertex: no area.
    for (std::size_t t = 0; t < padded; ++t) {
        const Triangle& from = drawn[order[std::min(t, drawn.size() - 1)]];
        for (std::size_t p = 0; p < planeCount; ++p)
            planes[p * padded + t] = from.values[t < drawn.size() || p >= kAlbedo ? p : p % 3];
    }
    // All or none: where one fails, the last geometry stays whole.
    const auto grown = [&](const Buffer& old, std::size_t floats, const char* what) {
        const std::size_t bytes = floats * sizeof(float);
        return old.bytes() < bytes ? Buffer(executor.device(), bytes, what) : Buffer();
    };
    Buffer newMemory = grown(memory_, planes.size(), "frame.geometry's triangles");
    Buffer newNodes = grown(nodes, mostTreeNodes(drawn.size()) * LW_TREE_NODE, "frame.geometry's tree of triangles");
    Buffer newChanges = grown(changes, changed.size(), "frame.geometry's changes");
    if (newMemory) memory_ = std::move(newMemory);
    if (newNodes) nodes = std::move(newNodes);
    if (newChanges) changes = std::move(newChanges);
    if (!changed.empty())
        executor.writeCopy("geometry_input.upload", changes, 0, changed.size() * sizeof(float), changed.data());
    triangles = Planes{};
    hasEmission = withEmission && !drawn.empty();
    if (drawn.empty()) return;
    executor.writeCopy("geometry_input.upload", memory_, 0, planes.size() * sizeof(float), planes.data());
    executor.writeCopy("geometry_input.upload", nodes, 0, treeNodes.size() * sizeof(float), treeNodes.data());
    triangles.memory = memory_.get();
    triangles.rowStride = triangles.planeStride = padded;
    triangles.width = padded;
    triangles.height = 1;
    triangles.count = std::uint32_t(planeCount);
}

void GeometryInput::report(Report& report) const {
    report.counts.push_back({"triangles", triangleCount});
    report.counts.push_back({"rejected_triangles", rejected_});
}

std::uint64_t GeometryInput::estimateBytes(std::uint32_t triangleCount, bool withEmission) {
    if (triangleCount > kMaxTriangles)
        fail(LW_ERROR_INVALID_ARGUMENT, "frame.geometry.triangleCount: expected at most ", kMaxTriangles, ", got ",
             triangleCount);
    const std::uint64_t planes = std::uint64_t(paddedTo16(triangleCount)) * (withEmission ? LW_TRIANGLE_EMISSIVE_PLANES : kPlaneCount);
    const std::uint64_t nodes = triangleCount ? mostTreeNodes(triangleCount) + 1 : 0;  // and one of what changed
    return (planes + nodes * LW_TREE_NODE) * sizeof(float);
}

}  // namespace lightwell
