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
#include "shared/input_limits.h"

namespace lightwell {
namespace {

// Indices of floats in the planes are 32-bit in kernels.
constexpr std::uint32_t kMaxTriangles = 0x7fffffffu / LW_TRIANGLE_PLANES / 256 * 256;
// A group of neighbours is as large as its largest member, so triangles are first put apart by size, in classes a
// factor of 4 wide from this share of the diagonal down. More classes thin out the neighbours in each.
constexpr double kLargestClass = 1.0 / 16.0;
constexpr int kClasses = 4;
constexpr float kDefaultAlbedo = 0.5f;

struct Triangle {
    std::uint64_t key;
    std::uint32_t host;  // its number among the host's
    std::array<float, LW_TRIANGLE_PLANES> values;
};

std::uint32_t vertexOf(const LWGeometry& g, std::size_t corner) {
    return g.indices ? g.indices[corner] : std::uint32_t(corner);
}

Triangle readTriangle(const LWGeometry& g, std::uint32_t t) {
    Triangle triangle{0, t, {}};
    for (std::size_t corner = 0; corner < 3; ++corner)
        for (std::size_t c = 0; c < 3; ++c)
            triangle.values[3 * corner + c] = g.vertices[3 * std::size_t(vertexOf(g, 3 * std::size_t(t) + corner)) + c];
    const float* albedo = g.triangleAlbedo ? g.triangleAlbedo + 3 * std::size_t(t) : nullptr;
    for (std::size_t c = 0; c < 3; ++c) triangle.values[LW_TRIANGLE_ALBEDO + c] = albedo ? albedo[c] : kDefaultAlbedo;
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

// The lowest 16 bits, each followed by two zeros.
std::uint64_t spread(std::uint64_t x) {
    x = (x | x << 16) & 0x0000ff0000ffull;
    x = (x | x << 8) & 0x00f00f00f00full;
    x = (x | x << 4) & 0x0c30c30c30c3ull;
    return (x | x << 2) & 0x249249249249ull;
}

// Its class of size, then its place along a Morton curve through the bounds.
std::uint64_t keyOfTriangle(const Triangle& t, const Bounds& all) {
    Bounds own;
    own.add(t);
    int sizeClass = 0;
    double limit = kLargestClass * all.diagonal();
    while (sizeClass < kClasses - 1 && own.diagonal() < limit) {
        ++sizeClass;
        limit *= 0.25;
    }
    const glm::dvec3 place = (own.lower + own.upper) * 0.5 - all.lower;
    const double scale = 65535.0 / all.diagonal();
    return std::uint64_t(sizeClass) << 48 | spread(std::uint64_t(place.x * scale)) |
           spread(std::uint64_t(place.y * scale)) << 1 | spread(std::uint64_t(place.z * scale)) << 2;
}

// Centre and radius, rounded up, of the triangles from `first` to `last`.
std::array<float, 4> sphereOf(const Triangle* first, const Triangle* last) {
    Bounds bounds;
    for (const Triangle* t = first; t != last; ++t) bounds.add(*t);
    const glm::vec3 centre((bounds.lower + bounds.upper) * 0.5);
    double radius = 0.0;
    for (const Triangle* t = first; t != last; ++t)
        for (std::size_t corner = 0; corner < 3; ++corner)
            radius = std::max(radius, glm::length(cornerOf(*t, corner) - glm::dvec3(centre)));
    return {centre.x, centre.y, centre.z, std::nextafter(float(radius), std::numeric_limits<float>::infinity())};
}

void checkArrays(const LWGeometry& g) {
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
}

// The triangles that cover anything, in an order that depends on their own values alone: maps then hold the same
// bits in whatever order the host keeps them.
std::vector<Triangle> drawnTriangles(const LWGeometry& g, Bounds& bounds, std::uint32_t& rejected) {
    std::vector<Triangle> triangles;
    triangles.reserve(g.triangleCount);
    for (std::uint32_t t = 0; t < g.triangleCount; ++t) {
        const Triangle triangle = readTriangle(g, t);
        if (!isWithinReach(triangle)) {
            ++rejected;
        } else if (areaOf(triangle) > 0.0) {
            bounds.add(triangle);
            triangles.push_back(triangle);
        }
    }
    for (Triangle& triangle : triangles) triangle.key = keyOfTriangle(triangle, bounds);
    std::sort(triangles.begin(), triangles.end(), [](const Triangle& a, const Triangle& b) {
        if (a.key != b.key) return a.key < b.key;
        if (a.values != b.values) return a.values < b.values;
        return a.host < b.host;
    });
    return triangles;
}

void shareOut(const std::vector<Triangle>& drawn, double& area, std::vector<std::uint32_t>& shares) {
    area = 0.0;
    for (const Triangle& t : drawn) area += areaOf(t);
    shares.clear();
    shares.reserve(drawn.size());
    double upTo = 0.0;
    for (const Triangle& t : drawn) {
        upTo += areaOf(t);
        shares.push_back(std::uint32_t(std::min(upTo / area * 4294967296.0, 4294967295.0)));
    }
    if (!shares.empty()) shares.back() = 0xffffffffu;
}

std::uint32_t paddedTo16(std::uint64_t count) { return std::uint32_t((count + 15) / 16 * 16); }

std::uint32_t groupsOf(std::uint64_t triangles) {
    return paddedTo16((triangles + LW_TRIANGLE_GROUP - 1) / LW_TRIANGLE_GROUP);
}

}  // namespace

bool GeometryInput::Key::operator==(const Key& other) const {
    return vertices == other.vertices && indices == other.indices && albedo == other.albedo &&
           vertexCount == other.vertexCount && triangleCount == other.triangleCount && version == other.version;
}

GeometryInput::Key GeometryInput::keyOf(const LWGeometry* g) {
    if (!g || g->triangleCount == 0) return Key{};
    return {g->vertices, g->indices, g->triangleAlbedo, g->vertexCount, g->triangleCount, g->version};
}

void GeometryInput::check(const LWGeometry* geometry) const {
    if (geometry && geometry->triangleCount && !(keyOf(geometry) == key_)) checkArrays(*geometry);
}

void GeometryInput::import(Executor& executor, const LWGeometry* geometry) {
    const Key key = keyOf(geometry);
    if (key == key_) return;
    check(geometry);
    Bounds bounds;
    std::uint32_t rejected = 0;
    std::vector<Triangle> drawn;
    if (key.triangleCount) drawn = drawnTriangles(*geometry, bounds, rejected);

    const std::uint32_t padded = paddedTo16(drawn.size()), paddedGroups = groupsOf(drawn.size());
    std::vector<float> planes(std::size_t(padded) * kPlaneCount), spheres(std::size_t(paddedGroups) * 4, 0.0f);
    std::fill(spheres.begin() + std::ptrdiff_t(3 * paddedGroups), spheres.end(), -1.0f);
    // Padding repeats the last triangle's first vertex: no area, and no larger group.
    for (std::size_t t = 0; t < padded; ++t) {
        const Triangle& from = drawn[std::min(t, drawn.size() - 1)];
        for (std::size_t p = 0; p < kPlaneCount; ++p)
            planes[p * padded + t] = from.values[t < drawn.size() || p >= kAlbedo ? p : p % 3];
    }
    for (std::size_t first = 0; first < drawn.size(); first += LW_TRIANGLE_GROUP) {
        const std::size_t last = std::min(drawn.size(), first + LW_TRIANGLE_GROUP);
        const std::array<float, 4> sphere = sphereOf(drawn.data() + first, drawn.data() + last);
        for (std::size_t c = 0; c < 4; ++c) spheres[c * paddedGroups + first / LW_TRIANGLE_GROUP] = sphere[c];
    }
    if (!drawn.empty()) {
        // Both or none: where one fails, the last geometry stays whole.
        const auto grown = [&](const Buffer& old, std::size_t floats, const char* what) {
            const std::size_t bytes = floats * sizeof(float);
            return old.bytes() < bytes ? Buffer(executor.device(), bytes, what) : Buffer();
        };
        Buffer newMemory = grown(memory_, planes.size(), "frame.geometry's triangles");
        Buffer newGroups = grown(groups, spheres.size(), "frame.geometry's groups of triangles");
        if (newMemory) memory_ = std::move(newMemory);
        if (newGroups) groups = std::move(newGroups);
        executor.writeCopy("geometry_input.upload", memory_, 0, planes.size() * sizeof(float), planes.data());
        executor.writeCopy("geometry_input.upload", groups, 0, spheres.size() * sizeof(float), spheres.data());
    }
    key_ = key;
    rejected_ = rejected;
    triangleCount = std::uint32_t(drawn.size());
    groupCount = paddedGroups;
    diagonal = drawn.empty() ? 0.0f : float(bounds.diagonal());
    ++revision;
    hostIndices.clear();
    for (const Triangle& t : drawn) hostIndices.push_back(t.host);
    shareOut(drawn, area, areaShares);
    triangles = Planes{};
    if (drawn.empty()) return;
    triangles.memory = memory_.get();
    triangles.rowStride = triangles.planeStride = padded;
    triangles.width = padded;
    triangles.height = 1;
    triangles.count = kPlaneCount;
}

void GeometryInput::report(Report& report) const {
    report.counts.push_back({"triangles", triangleCount});
    report.counts.push_back({"rejected_triangles", rejected_});
}

std::uint64_t GeometryInput::estimateBytes(std::uint32_t triangleCount) {
    if (triangleCount > kMaxTriangles)
        fail(LW_ERROR_INVALID_ARGUMENT, "frame.geometry.triangleCount: expected at most ", kMaxTriangles, ", got ",
             triangleCount);
    const std::uint64_t planes = std::uint64_t(paddedTo16(triangleCount)) * kPlaneCount;
    return (planes + std::uint64_t(groupsOf(triangleCount)) * 4) * sizeof(float);
}

}  // namespace lightwell
