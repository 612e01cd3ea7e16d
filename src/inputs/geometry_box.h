// The box around the host's triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>

#include "inputs/geometry_input.h"
#include "shared/input_limits.h"

namespace lightwell {

// Of all triangles' vertices that are not too far away to count; read again when the geometry's version, a pointer, a count or
// the frame's origin changes. A vertex that no triangle has is none of the scene's: hosts share buffers among meshes.
class GeometryBox {
public:
    // Throws what GeometryInput says of such triangles.
    void look(const LWFrame& frame) {
        const LWGeometry* geometry = frame.geometry;
        const Key key = keyOf(frame);
        if (key == key_) return;
        GeometryInput().check(frame);
        key_ = key;
        isSome_ = false;
        if (key == Key{}) return;
        for (std::size_t i = 0; i < 3 * std::size_t(geometry->triangleCount); ++i)
            add(geometry->vertices + 3 * (geometry->indices ? std::size_t(geometry->indices[i]) : i));
    }
    bool isSome() const { return isSome_; }
    const float* low() const { return low_; }
    const float* high() const { return high_; }
    float longest() const { return isSome_ ? std::max({high_[0] - low_[0], high_[1] - low_[1], high_[2] - low_[2]}) : 0.0f; }

private:
    // Vertices, indices, numbers of triangles and vertices, version, the origin.
    using Key = std::tuple<const float*, const std::uint32_t*, std::uint32_t, std::uint32_t, std::uint64_t, std::array<double, 3>>;
    static Key keyOf(const LWFrame& frame) {
        const LWGeometry* g = frame.geometry;
        const double(&o)[3] = frame.worldOrigin;
        return g && g->triangleCount ? Key{g->vertices, g->indices, g->triangleCount, g->vertexCount, g->version, {o[0], o[1], o[2]}} : Key{};
    }
    void add(const float* p) {
        if (!(std::hypot(p[0], p[1], p[2]) <= LW_LARGEST_DISTANCE)) return;
        for (int a = 0; a < 3; ++a) {
            low_[a] = isSome_ ? std::min(low_[a], p[a]) : p[a];
            high_[a] = isSome_ ? std::max(high_[a], p[a]) : p[a];
        }
        isSome_ = true;
    }

    Key key_{};
    bool isSome_ = false;
    float low_[3] = {}, high_[3] = {};
};

}  // namespace lightwell
