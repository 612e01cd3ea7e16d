// The box around the host's triangles.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "inputs/geometry_input.h"
#include "shared/input_limits.h"

namespace lightwell {

// Of all vertices that are not too far away to count; read again when the geometry's version, pointer or count changes.
class TriangleBox {
public:
    // Throws what GeometryInput says of such triangles.
    void look(const LWGeometry* geometry) {
        const bool some = geometry && geometry->triangleCount;
        if (some && vertices_ == geometry->vertices && count_ == geometry->vertexCount && version_ == geometry->version) return;
        GeometryInput().check(geometry);
        vertices_ = some ? geometry->vertices : nullptr;
        count_ = some ? geometry->vertexCount : 0;
        version_ = some ? geometry->version : 0;
        isSome_ = false;
        for (std::uint32_t i = 0; i < count_; ++i) add(vertices_ + 3 * std::size_t(i));
    }
    bool isSome() const { return isSome_; }
    const float* low() const { return low_; }
    const float* high() const { return high_; }

private:
    void add(const float* p) {
        if (!(std::hypot(p[0], p[1], p[2]) <= LW_LARGEST_DISTANCE)) return;
        for (int a = 0; a < 3; ++a) {
            low_[a] = isSome_ ? std::min(low_[a], p[a]) : p[a];
            high_[a] = isSome_ ? std::max(high_[a], p[a]) : p[a];
        }
        isSome_ = true;
    }

    const float* vertices_ = nullptr;
    std::uint32_t count_ = 0;
    std::uint64_t version_ = 0;
    bool isSome_ = false;
    float low_[3] = {}, high_[3] = {};
};

}  // namespace lightwell
