// The host's triangles on the device, ordered, in a tree of boxes for kernels that send rays.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/report.h"
#include "lightwell/lightwell.h"
#include "shared/geometry_types.h"

namespace lightwell {

// As the host gave it.
struct HostTriangle {
    std::uint32_t host;  // its number among the host's
    std::array<float, LW_TRIANGLE_EMISSIVE_PLANES> values;  // emission 0 where it is not asked for
};

class GeometryInput {
public:
    // Planes of `triangles`: the vertices a, b, c of each, and its albedo.
    enum Plane {
        kVertexA = LW_TRIANGLE_A,
        kVertexB = LW_TRIANGLE_B,
        kVertexC = LW_TRIANGLE_C,
        kAlbedo = LW_TRIANGLE_ALBEDO,
        kPlaneCount = LW_TRIANGLE_PLANES,
        kEmission = LW_TRIANGLE_EMISSION
    };

    // Throws what import() would say of this geometry (null: none). Of what is in force already, relative to the same origin, nothing is
    // read.
    void check(const LWGeometry* geometry, bool withEmission = false, const WorldOrigin& origin = {}) const;
    void check(const LWFrame& frame, bool withEmission = false) const;

    // Brings the geometry to the device (pass "geometry_input.upload") when its version, a pointer, a count or the executor's origin
    // differs from the last and some triangle does; host memory is read during the call only. Triangles are ordered by
    // place, by their own values alone: their order in the host's arrays does not matter. Those with a vertex that is not
    // finite or beyond LW_LARGEST_DISTANCE are left out and counted, those without area left out. Refused
    // geometry leaves the last one in force. withEmission: what the host's triangles emit too, if it says so.
    void import(Executor& executor, const LWGeometry* geometry, bool withEmission = false);
    void forget();  // the next import() brings all again, whatever its key

    Planes triangles;  // kPlaneCount planes, height 1, width = triangles padded; none without triangles
    bool hasEmission = false;      // then three more from kEmission on
    float largestEmission = 0.0f;  // of a colour of a triangle, W/(sr m^2)
    Buffer nodes;      // of the tree of boxes over the triangles, see geometry_types.h
    std::uint32_t nodeCount = 0;
    Buffer changes;    // a node of boxes around all that the last revision changed: triangles that came, and that went
    std::uint32_t triangleCount = 0;  // drawn
    float diagonal = 0.0f;            // of the bounding box of what is drawn, m
    double area = 0.0;                // of all that is drawn, m^2
    // For each drawn triangle the share of the area up to and with it, of 2^32; the last one's is the largest number.
    std::vector<std::uint32_t> areaShares;
    std::uint64_t revision = 0;       // one more with every change of the triangles; by more where `changes` does not say what
    std::vector<std::uint32_t> hostIndices;  // of each drawn triangle: its number among the host's

    void report(Report& report) const;  // triangles, rejected_triangles
    std::uint64_t bytes() const { return memory_.bytes() + nodes.bytes() + changes.bytes(); }
    // The most that bytes() becomes for so many triangles, and the refusal of more than kernels can index.
    static std::uint64_t estimateBytes(std::uint32_t triangleCount, bool withEmission = false);

private:
    struct Key {
        const void *vertices = nullptr, *indices = nullptr, *albedo = nullptr, *emission = nullptr;
        std::uint32_t vertexCount = 0, triangleCount = 0;
        std::uint64_t version = 0;
        bool operator==(const Key& other) const;
    };
    static Key keyOf(const LWGeometry* geometry, bool withEmission);
    void upload(Executor& executor, const std::vector<HostTriangle>& drawn, const std::vector<std::uint32_t>& order,
                const std::vector<float>& treeNodes, const std::vector<float>& changed, bool withEmission);

    Buffer memory_;
    std::vector<HostTriangle> drawn_;  // in the host's order, to tell what a new version changes
    Key key_;
    std::uint32_t rejected_ = 0;
    bool isForgotten_ = false;
    WorldOrigin origin_{};  // of the last import
};

}  // namespace lightwell
